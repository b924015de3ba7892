#include "command/run_watch.hpp"

#include <utility>

#include "simulation/start_impact.hpp"
#include "verdict/energy_rounding.hpp"

namespace tumble::host {
namespace {

long double speed_of(const Simulation& simulation, int body) {
    const auto& v = simulation.body(body).velocity;
    return std::hypot(v[0], v[1], v[2]);
}

int fastest_body(const Simulation& simulation) {
    int fastest = 0;
    for (int b = 1; b < simulation.body_count(); ++b)
        if (speed_of(simulation, b) > speed_of(simulation, fastest)) fastest = b;
    return fastest;
}

}  // namespace

RunWatch::RunWatch(const SceneDescription& scene, const Simulation& simulation, std::vector<std::int64_t> moments)
    : simulation_(simulation),
      energy_(simulation.energy(), impact_at_start(scene).energy, EnergyRounding(scene).of(simulation)),
      recorder_(scene, simulation, std::move(moments)) {
    if (simulation.range().empty()) return;
    most_speed_ = held_by(simulation.range()).velocity / 4;
    for (int b = 0; b < simulation.body_count(); ++b)
        if (scene.is_jointed(b) && !scene.body(b).fixed) jointed_.push_back(b);
    watch_speeds();
}

void RunWatch::watch_speeds() {
    if (jointed_.empty()) return;
    if (simulation_.has_trouble("step_bound_hit")) {
        if (fastest_ > most_speed_) too_fast_ = {"velocity", most_speed_, "m/s"};
        jointed_.clear();  // only the first occurrence is reported
        return;
    }
    fastest_ = 0;
    for (const int b : jointed_) fastest_ = std::max(fastest_, static_cast<double>(speed_of(simulation_, b)));
}

void BoundedSteps::see(const Simulation& simulation) {
    bodies.resize(static_cast<std::size_t>(simulation.body_count()));
    const std::int64_t taken = simulation.steps_taken();
    bool any = false;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (!simulation.stepped_bounded(static_cast<int>(b))) continue;
        any = true;
        if (bodies[b].steps++ == 0) bodies[b].first = taken - 1;
    }
    if (!any) return;
    const double depth = simulation.deepest_overlap();
    if (!(depth > deepest)) return;
    deepest = depth;
    deepest_at = taken;
}

void RunWatch::see() {
    energy_.see(simulation_.energy());
    bounded_.see(simulation_);
    watch_speeds();
    (void)recorder_.see(simulation_);
}

bool RunWatch::is_over() const {
    return simulation_.steps_taken() >= simulation_.steps() || simulation_.has_trouble("range_left") ||
           recorder_.range_trouble().has_value();
}

std::vector<Trouble> RunWatch::troubles() const {
    std::vector<Trouble> troubles = simulation_.troubles();
    for (Trouble& trouble : troubles)
        if (trouble.issue == "step_bound_hit") trouble.number = too_fast_;
    if (recorder_.range_trouble()) add_once(troubles, *recorder_.range_trouble());
    const bool is_held = std::isfinite(static_cast<double>(energy_.end())) &&
                         std::isfinite(static_cast<double>(energy_.largest_relative_drift().value_or(0)));
    if (!is_held && simulation_.steps_taken() > 0)
        add_once(troubles, {"range_left", fastest_body(simulation_), simulation_.steps_taken() - 1});
    return troubles;
}

Record RunWatch::record() && {
    Record record = std::move(recorder_).record(simulation_);
    record.troubles = troubles();
    return record;
}

}  // namespace tumble::host

#include "verdict/record.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

#include "truth/smooth_motion.hpp"
#include "verdict/energy_budget.hpp"
#include "verdict/range_watch.hpp"

namespace tumble::host {
namespace {

// Looks at energy and at how far bodies have moved, from one moment to the next.
constexpr std::int64_t looks_per_moment = 16;
// A run is not judged dear before it has taken this long, s: loading worlds is not part of its steps.
constexpr double least_seconds = 0.02;

double thread_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// The steps in which impulses or forces act, each [first, end).
class DrivenSteps {
public:
    DrivenSteps(const SceneDescription& scene, const StepSize& step) {
        for (const ImpulseDescription& impulse : scene.impulses) {
            const std::int64_t at = nearest_step(impulse.time, step);
            spans_.push_back({at, at + 1});
        }
        for (const ForceDescription& force : scene.forces)
            spans_.push_back({nearest_step(force.from, step), nearest_step(force.until, step)});
    }
    [[nodiscard]] bool overlap(std::int64_t first, std::int64_t end) const {
        return std::any_of(spans_.begin(), spans_.end(),
                           [&](const auto& span) { return span.first < end && first < span.second; });
    }

private:
    std::vector<std::pair<std::int64_t, std::int64_t>> spans_;
};

Moment read(const Simulation& simulation) {
    Moment moment;
    for (int b = 0; b < simulation.body_count(); ++b) moment.bodies.push_back(motion_of(simulation.body(b)));
    return moment;
}

// Where bodies have been, as far as looks tell.
class Reach {
public:
    explicit Reach(Moment start) : start_(std::move(start)) {
        way_.resize(start_.bodies.size());
        turn_.resize(start_.bodies.size());
    }
    void see(const Moment& now) {
        for (std::size_t b = 0; b < now.bodies.size(); ++b) {
            const reference::Motion &from = start_.bodies[b], &at = now.bodies[b];
            way_[b] = std::max(way_[b], static_cast<double>(norm(at.x - from.x)));
            turn_[b] = std::max(turn_[b], static_cast<double>(angle_between(at.q, from.q)));
        }
    }
    void note_in(Moment& moment) const {
        moment.way_m = way_;
        moment.turn_rad = turn_;
    }

private:
    Moment start_;
    std::vector<double> way_, turn_;
};

// m: the distance of neighbouring numbers at the farthest position that the run begins or ends at.
double resolution_of(const Simulation& simulation, const Record& record) {
    if (!simulation.range().empty()) return held_by(simulation.range()).position * 0x1p-30;
    double farthest = 0;
    for (const Moment& moment : record.moments)
        for (const reference::Motion& body : moment.bodies)
            farthest = std::max(farthest, static_cast<double>(norm(body.x)));
    const bool is_float = simulation.numbers() == "f32";
    return farthest *
           (is_float ? double{std::numeric_limits<float>::epsilon()} : std::numeric_limits<double>::epsilon());
}

}  // namespace

ProcessorTime::ProcessorTime(std::optional<double> most_seconds)
    : most_seconds_(most_seconds), start_(thread_seconds()) {}

double ProcessorTime::now() const { return thread_seconds() - start_; }

void ProcessorTime::check(double begun, double share) const {
    if (!most_seconds_ || share <= 0) return;
    const double taken = now() - begun;
    if (taken > least_seconds && begun + taken / share > *most_seconds_) throw TooDear(taken / share);
}

std::vector<std::int64_t> moments_of(const SceneDescription& scene) {
    const std::int64_t steps = scene.steps(), count = std::min<std::int64_t>(steps, sample_count);
    std::vector<std::int64_t> moments;
    for (std::int64_t i = 1; i <= count; ++i) moments.push_back((steps * i + count / 2) / count);
    return moments;
}

Record record_of(const SceneDescription& scene, const Method& method, int halvings,
                 const std::vector<std::int64_t>& moments, const ProcessorTime& time, std::optional<double> most_gain) {
    SceneDescription finer = scene;
    finer.step = scaled(scene.step, -halvings);
    const double begun = time.now();
    const auto simulation = make_simulation(finer, method.integrator, method.numbers, method.carry);
    RangeWatch range(finer, *simulation);
    Reach reach(read(*simulation));
    std::optional<EnergyBudget> energy;
    if (most_gain) energy.emplace(finer, *simulation, *most_gain);
    const DrivenSteps driven(finer, finer.step);

    Record record;
    record.contact_tolerance = static_cast<double>(simulation->contact_tolerance());
    const auto is_over = [&] { return range.trouble() || simulation->has_trouble("range_left"); };
    for (std::size_t m = 0; m < moments.size() && !is_over(); ++m) {
        const std::int64_t from = simulation->steps_taken(), until = moments[m] << halvings;
        Moment now;
        for (std::int64_t look = 1; look <= looks_per_moment && !is_over(); ++look) {
            const std::int64_t next = from + (until - from) * look / looks_per_moment,
                               first = simulation->steps_taken();
            if (next == first) continue;
            while (simulation->steps_taken() < next && !is_over()) {
                simulation->step();
                range.see(*simulation);
            }
            now = read(*simulation);
            if (!std::all_of(now.bodies.begin(), now.bodies.end(), is_finite)) break;
            reach.see(now);
            if (energy) energy->see(*simulation, driven.overlap(first, next));
            time.check(begun, static_cast<double>(next) / static_cast<double>(moments.back() << halvings));
        }
        if (is_over() || now.bodies.empty() || !std::all_of(now.bodies.begin(), now.bodies.end(), is_finite)) break;
        reach.note_in(now);
        record.moments.push_back(std::move(now));
        if (energy && energy->is_exceeded() && !record.gained) record.gained = m;
    }
    record.troubles = simulation->troubles();
    if (range.trouble()) record.troubles.push_back(*range.trouble());
    record.resolution = resolution_of(*simulation, record);
    return record;
}

}  // namespace tumble::host

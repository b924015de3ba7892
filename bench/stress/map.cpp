#include "stress/map.hpp"

#include <tumble/integrators/method.hpp>
#include <tumble/numbers/systems.hpp>
#include <tumble/status.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pictures/drawing.hpp"
#include "tools/text.hpp"
#include "verdict/verdict.hpp"

namespace tumble::bench::stress {
namespace {

Method in_f64(const Method& method) { return {method.integrator, "f64", false}; }

double with_four_digits(double value) { return std::stod(text("%.4g", value)); }

std::string with_number(const char* what, double value) { return std::string{what} + " " + host::few_digits(value); }

}  // namespace

const char* words_of(Outcome outcome) {
    switch (outcome) {
    case Outcome::accurate: return "accurate";
    case Outcome::drifts: return "drifts";
    case Outcome::blows_up: return "blows up, wrong by the verdict";
    case Outcome::range_left: return "range left, told";
    case Outcome::told: return "told by another status";
    case Outcome::silent: return "silent";
    default: return "not run";
    }
}

std::vector<double> logarithmic_values(double first, double last, int count) {
    std::vector<double> values;
    for (int i = 0; i < count; ++i)
        values.push_back(with_four_digits(first * std::pow(last / first, static_cast<double>(i) / (count - 1))));
    return values;
}
std::vector<double> linear_values(double first, double last, int count) {
    std::vector<double> values;
    for (int i = 0; i < count; ++i) values.push_back(with_four_digits(first + (last - first) * i / (count - 1)));
    return values;
}

std::filesystem::path scene_directory() { return TUMBLE_STRESS_SCENES; }

Map::Map(std::string name, std::string title, Axis x, Axis y, const std::string& scene)
    : name_{std::move(name)}, title_{std::move(title)}, x_{std::move(x)}, y_{std::move(y)},
      template_{scene_directory() / ((scene.empty() ? name_ : scene) + ".toml")} {}

SceneFile Map::scene_file(double x, double y) const {
    SceneFile file{template_};
    change(file, x, y);
    return file;
}

// The error of truncation, from an f64 run at the shortest step of the coarse map at which truncation dominates
// rounding, or at the longest step if there is none.
double Map::expected_error(double x, double y, const Method& method) const {
    const auto step_at = [&](double at) { return scene(at, y).step.seconds(); };
    auto anchor = std::find_if(anchors_.begin(), anchors_.end(),
                               [&](const Anchor& a) { return a.integrator == method.integrator && a.y == y; });
    if (anchor == anchors_.end()) {
        std::vector<std::pair<double, double>> steps;  // step, x
        for (const double at : x_.coarse) steps.emplace_back(step_at(at), at);
        std::sort(steps.begin(), steps.end());
        Anchor found{method.integrator, y, 0, 0};
        for (const auto& [step, at] : steps) {
            const double error = measure(at, y, in_f64(method)).error;
            found.step = step;
            found.error = error;
            if (!(error <= floors_of_truncation() * rounding_floor(at, y, in_f64(method)))) break;
        }
        anchor = anchors_.insert(anchors_.end(), found);
    }
    const int p = order(host::find_integrator(method.integrator));
    if (p == no_truncation) return 0;
    return anchor->error * std::pow(step_at(x) / anchor->step, p);
}

Measured Map::measure(double x, double y, const Method& method) const {
    const auto simulation = host::make_simulation(scene(x, y), method.integrator, method.numbers, method.carry);
    return measure_run(x, y, *simulation);
}

std::optional<double> Map::limit_where(double y, const std::function<bool(double)>& is_beyond) const {
    std::vector<double> xs = x_.fine;  // from the shortest step on
    if (scene(xs.front(), y).step.seconds() > scene(xs.back(), y).step.seconds()) std::reverse(xs.begin(), xs.end());
    const auto first = std::find_if(xs.begin(), xs.end(), is_beyond);
    if (first == xs.end()) return std::nullopt;
    if (first == xs.begin()) return *first;
    double within = *(first - 1), beyond = *first;
    for (int halving = 0; halving < 8; ++halving) {
        const double middle = x_.logarithmic ? std::sqrt(within * beyond) : (within + beyond) / 2;
        (is_beyond(middle) ? beyond : within) = middle;
    }
    return within;
}

Judgement Map::judge(double x, double y, const Method& method) const {
    std::unique_ptr<host::Simulation> simulation;
    try {
        simulation = host::make_simulation(scene(x, y), method.integrator, method.numbers, method.carry);
    } catch (const std::exception& refusal) { return {Outcome::told, refusal.what()}; }
    return judge(x, y, method, *simulation);
}

Judgement Map::judge(double x, double y, const Method& method, host::Simulation& simulation) const {
    Expectation expectation;
    expectation.floor = rounding_floor(x, y, method);
    expectation.of_order = [&] { return expected_error(x, y, method); };
    expectation.in_f64 = [&] { return measure(x, y, in_f64(method)); };
    expectation.wrong = [&]() -> std::string {
        host::VerdictOptions options;
        options.explains = false;
        const auto cell = scene(x, y);
        const host::Verdict verdict = host::verdict_of(cell, method, options);
        // In floating point the kernel has no status for a declared [range] that a run leaves; the verdict reports it.
        const bool is_wrong = verdict.kind == host::Verdict::Kind::wrong || verdict.kind == host::Verdict::Kind::told;
        return is_wrong ? host::sentence_of(verdict, cell, method) : "";
    };
    expectation.is_f64 = method.numbers == "f64";
    expectation.floor_in_f64 = rounding_floor(x, y, in_f64(method));
    expectation.bounds = bounds(host::find_integrator(method.integrator));
    return stress::judge(measure_run(x, y, simulation), expectation);
}

Judgement judge(const Measured& run, const Expectation& expectation) {
    const Bounds& bounds = expectation.bounds;
    const auto explained_up_to = [&](double largest) {
        const auto by = [&](double expected) { return run.error <= std::min(accurate_factor * expected, largest); };
        return by(expectation.floor) || by(expectation.of_order());
    };
    const std::string error = with_number("error", run.error);
    std::string wrong;  // for a motion of the same kind
    if (!run.finite) wrong = "not finite";
    else if (run.norm_error > bounds.norm_error) wrong = with_number("norm error", run.norm_error);
    else if (run.energy_most > bounds.energy) wrong = with_number("energy ratio", run.energy_most);
    else if (run.depth > bounds.depth) wrong = with_number("depth in tolerances", run.depth);
    else if (run.error > bounds.error && !explained_up_to(Bounds::unbounded)) wrong = error;
    if (!wrong.empty() || !run.troubles.empty()) {
        if (!run.troubles.empty()) {
            const std::string& status = run.troubles.front().issue;
            return {status == name_of(Issue::range_left) ? Outcome::range_left : Outcome::told, status};
        }
        const std::string verdict = expectation.wrong();
        return verdict.empty() ? Judgement{Outcome::silent, wrong} : Judgement{Outcome::blows_up, verdict};
    }
    if (run.error <= always_accurate || explained_up_to(largest_accurate_error)) return {Outcome::accurate, {}};
    if (!expectation.is_f64 && run.error > least_silent_error && run.error > number_system_factor * expectation.floor) {
        const Measured in_f64 = expectation.in_f64();
        // Where rounding makes the error of f64 too, the method makes so much more of a rounding than the floor says.
        double of_method = in_f64.error / expectation.floor_in_f64;
        if (!(of_method > 1 && of_method < number_system_factor)) of_method = 1;
        if (in_f64.troubles.empty() && run.error > number_system_factor * in_f64.error &&
            run.error > number_system_factor * of_method * expectation.floor)
            return {Outcome::silent, error + ", far beyond its rounding and f64"};
    }
    return {Outcome::drifts, error};
}

double resolution(const host::SceneDescription& scene, const Method& method, Quantity quantity, double size) {
    if (method.numbers == "f64") return 0x1p-53;
    if (method.numbers == "f32") return 0x1p-24;
    const auto& system = host::find_number_system(scene, method.numbers, method.carry);
    double limit = 0;
    Ranges::for_each([&]<class Named>() {
        using Range = typename Named::Range;
        if (system.range == Named::name)
            limit = quantity == Quantity::position   ? Range::position
                    : quantity == Quantity::velocity ? Range::velocity
                                                     : Range::spin;
    });
    return limit / size * 0x1p-31;
}

double random_walk(const Method& method, double steps) { return method.carry ? 1 : std::sqrt(steps); }

Measured run_to_the_end(host::Simulation& simulation, std::int64_t every,
                        const std::function<void(Measured&)>& after_steps) {
    Measured run;
    while (simulation.steps_taken() < simulation.steps() && simulation.troubles().empty() && run.finite) {
        for (std::int64_t i = 0; i < every && simulation.steps_taken() < simulation.steps(); ++i) simulation.step();
        if (simulation.troubles().empty()) after_steps(run);
    }
    run.troubles = simulation.troubles();
    return run;
}

}  // namespace tumble::bench::stress

#include "verdict/accuracy.hpp"

#include <algorithm>
#include <cmath>

#include "scene/data.hpp"
#include "truth/algebra.hpp"
#include "truth/smooth_motion.hpp"

namespace tumble::host {
namespace {

constexpr std::int64_t most_steps_of_a_run = std::int64_t{1} << 20;
constexpr double fewest_steps_of_the_shortest = 4096;

// The time at which a step starts, s.
double time_of(std::int64_t step, const StepSize& length) {
    return static_cast<double>(static_cast<long double>(step) * long_seconds(length));
}

SampledRun sampled(Simulation& simulation, const SampledScene& scene, int step) {
    SampledRun run;
    for (std::size_t sample = 0; sample < run.samples.size(); ++sample) {
        const std::int64_t until = scene.sample_steps()[sample] << (scene.longest() - step);
        while (simulation.steps_taken() < until && simulation.troubles().empty()) simulation.step();
        if (!simulation.troubles().empty()) {
            run.failure = simulation.troubles().front().issue;
            return run;
        }
        for (int b = 0; b < simulation.body_count(); ++b) {
            run.samples[sample].push_back(motion_of(simulation.body(b)));
            if (!is_finite(run.samples[sample].back())) {
                run.failure = "not finite";
                return run;
            }
        }
    }
    return run;
}

// The motion without contacts; empty when a body comes so near a plane or another body that it may touch, or where a
// barrier acts at any distance, or a joint has no equations.
std::optional<Samples> smooth_samples(const SampledScene& scene, reference::Number most_error) {
    // No longer than the scene's own step, so that a body cannot dive through what it touches between two looks.
    const int number = std::min(0, scene.longest());
    const SceneDescription description = scene.with_step(number);
    const reference::Number length = long_seconds(description.step), band = description.contact.tolerance;
    if (without_equations(description.joints) != nullptr) return std::nullopt;
    SmoothMotion motion(description, shapes_meet, {.most_error = most_error});
    if (motion.can_touch() && description.contact.response == ContactResponse::spring &&
        description.contact.barrier > 0)
        return std::nullopt;
    Samples samples;
    std::int64_t now = 0;
    for (std::size_t sample = 0; sample < samples.size(); ++sample) {
        const std::int64_t until = scene.sample_steps()[sample] << (scene.longest() - number);
        if (motion.can_touch()) {
            for (; now < until; ++now) {
                motion.advance_to(now);
                if (motion.clearance() < band + motion.closing_speed() * length) return std::nullopt;
            }
        }
        motion.advance_to(until);
        samples[sample] = motion.bodies();
    }
    return samples;
}

Samples fine_samples(const SampledScene& scene, const char* integrator, int step) {
    const auto run = run_sampled(scene, {integrator, "f64", false}, step);
    if (!run) throw std::runtime_error(std::string(integrator) + " does not run in f64");
    if (!run->failure.empty())
        throw std::runtime_error(std::string("no reference: ") + integrator + " in f64 at " +
                                 std::to_string(scene.with_step(step).step.seconds()) + " s: " + run->failure);
    return run->samples;
}

}  // namespace

SceneDescription with_events_at_steps(SceneDescription scene) {
    for_each_time(scene, [&](double& time) { time = time_of(nearest_step(time, scene.step), scene.step); });
    return scene;
}

void require_no_events(const SceneDescription& scene) {
    if (std::any_of(scene.events.begin(), scene.events.end(), [](const auto& event) { return has_body(event.kind); }))
        throw std::invalid_argument(scene.path +
                                    ": event: other steps and methods have no reference for the [[event]] of a body, "
                                    "expected [[impulse]] and [[force]] in its place");
    if (std::any_of(scene.events.begin(), scene.events.end(), [](const auto& event) { return has_joint(event.kind); }))
        throw std::invalid_argument(scene.path +
                                    ": event: other steps and methods have no reference for the [[event]] of a joint, "
                                    "expected none");
}

Method method_of(const Simulation& simulation) {
    return {std::string(simulation.integrator()), std::string(simulation.numbers()), simulation.carry()};
}

bool is_finite(const reference::Motion& m) {
    return std::isfinite(norm(m.x)) && std::isfinite(norm(m.v)) && std::isfinite(m.q.norm2()) && m.q.norm2() > 0;
}

reference::Motion motion_of(const BodySnapshot& body) {
    using namespace reference;
    return {vector_of(body.position), vector_of(body.velocity), rotation_of(body.orientation),
            vector_of(body.angular_velocity)};
}

void Errors::see(const reference::Motion& one, const reference::Motion& other) {
    position_m = std::max(position_m, static_cast<double>(norm(one.x - other.x)));
    orientation_rad = std::max(orientation_rad, static_cast<double>(angle_between(one.q, other.q)));
}

Errors largest_errors(const Samples& a, const Samples& b) {
    Errors errors;
    for (std::size_t sample = 0; sample < a.size(); ++sample) {
        for (std::size_t body = 0; body < a[sample].size(); ++body) { errors.see(a[sample][body], b[sample][body]); }
    }
    return errors;
}

SampledScene::SampledScene(SceneDescription scene) : scene_(with_events_at_steps(std::move(scene))) {
    const std::int64_t steps = scene_.steps();
    if (steps == 0) throw std::invalid_argument(scene_.path + ": duration: got 0 s, expected a scene that lasts");
    require_no_events(scene_);
    // Events within the run must be at whole longer steps, too.
    std::vector<std::int64_t> event_steps;
    for_each_time(scene_, [&](double time) {
        const std::int64_t step = nearest_step(time, scene_.step);
        if (step < steps) event_steps.push_back(step);
    });
    while ((steps >> (longest_ + 1)) >= sample_count &&
           std::all_of(event_steps.begin(), event_steps.end(),
                       [&](std::int64_t step) { return step % (std::int64_t{2} << longest_) == 0; }))
        ++longest_;
    while (longest_ <= 0 && (steps << -longest_) < sample_count) --longest_;

    const double own = scene_.step.seconds();
    const auto number_of = [&](double seconds) {
        return static_cast<int>(std::floor(std::log2(seconds / own) + 1e-9));
    };
    shortest_ = std::min({-2, number_of(1.0 / 4096), number_of(scene_.duration / fewest_steps_of_the_shortest)});
    const std::int64_t runs = longest_ >= 0 ? steps >> longest_ : steps << -longest_;  // of the longest step
    while (shortest_ < longest_ && (runs << (longest_ - shortest_)) > most_steps_of_a_run) ++shortest_;
    for (int sample = 1; sample <= sample_count; ++sample) {
        sample_steps_[static_cast<std::size_t>(sample - 1)] =
            (runs * sample + sample_count / 2) / sample_count;  // to the nearest
    }
}

SceneDescription SampledScene::with_step(int number) const {
    SceneDescription scene = scene_;
    scene.step = scaled(scene_.step, number);
    scene.duration = time_of(sample_steps_.back(), scaled(scene_.step, longest_));
    return scene;
}

std::optional<SampledRun> run_sampled(const SampledScene& scene, const Method& method, int step) {
    if (!runs_in(find_integrator(method.integrator), method.numbers)) return std::nullopt;
    const auto simulation = make_simulation(scene.with_step(step), method.integrator, method.numbers, method.carry);
    return sampled(*simulation, scene, step);
}

Truth truth_of(const SampledScene& scene) {
    Truth truth;
    if (auto smooth = smooth_samples(scene, reference::tolerance)) {
        truth.samples = std::move(*smooth);
        if (scene.has_joints())
            truth.doubt = largest_errors(truth.samples, *smooth_samples(scene, 100 * reference::tolerance));
        return truth;
    }
    truth.has_contacts = true;
    truth.samples = fine_samples(scene, "rk4", scene.shortest() - 2);
    truth.doubt = largest_errors(truth.samples, fine_samples(scene, "suzuki4", scene.shortest() - 1));
    return truth;
}

std::optional<Attempt> longest_step_within(double tolerance, const SampledScene& scene, const Truth& truth,
                                           const Method& method) {
    std::optional<Attempt> best;
    for (int step = scene.longest(); step >= scene.shortest(); --step) {
        const auto run = run_sampled(scene, method, step);
        if (!run) return std::nullopt;
        Attempt attempt{method, step, scene.with_step(step).step, {}, run->failure};
        if (run->failure.empty()) attempt.errors = largest_errors(run->samples, truth.samples);
        if (!best || attempt.error() < best->error()) best = attempt;
        if (attempt.error() <= tolerance) break;
    }
    return best;
}

}  // namespace tumble::host

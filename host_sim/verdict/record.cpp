#include "verdict/record.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "scene/data.hpp"
#include "truth/smooth_motion.hpp"

namespace tumble::host {
namespace {

// Looks at energy and at how far bodies have moved, from one moment to the next.
constexpr std::int64_t looks_per_moment = 16;
// Slower than this, in m/s and rad/s, a body is at rest: its contacts take a small part of the time of others.
constexpr double speed_at_rest = 1e-3;
constexpr double share_at_rest = 0.1;

// The steps in which impulses or forces act or gravity changes. Wind acts in all.
std::vector<std::pair<std::int64_t, std::int64_t>> driven_steps_of(const SceneDescription& scene) {
    std::vector<std::pair<std::int64_t, std::int64_t>> spans;
    if (scene.wind != Triple{}) spans.emplace_back(0, scene.steps());
    for (const ImpulseDescription& impulse : scene.impulses) {
        const std::int64_t at = nearest_step(impulse.time, scene.step);
        spans.push_back({at, at + 1});
    }
    for (const EventDescription& event : scene.events) {
        // The energy is another before the first step under new gravity.
        const std::int64_t at = nearest_step(event.time, scene.step);
        spans.push_back({at, at + 1});
    }
    for (const ForceDescription& force : scene.forces)
        spans.push_back({nearest_step(force.from, scene.step), nearest_step(force.until, scene.step)});
    return spans;
}

Moment read(const Simulation& simulation) {
    Moment moment;
    for (int b = 0; b < simulation.body_count(); ++b) moment.bodies.push_back(motion_of(simulation.body(b)));
    return moment;
}

void widen(Moment& now, const Moment& start) {
    for (std::size_t b = 0; b < now.bodies.size(); ++b) {
        const reference::Motion &from = start.bodies[b], &at = now.bodies[b];
        now.way_m[b] = std::max(now.way_m[b], static_cast<double>(norm(at.x - from.x)));
        now.turn_rad[b] = std::max(now.turn_rad[b], static_cast<double>(angle_between(at.q, from.q)));
    }
}

// Bodies that move, and what acts between them.
Load load_of(const SceneDescription& scene) {
    Load load;
    const auto all = static_cast<double>(scene.bodies.size());
    for (const BodyDescription& body : scene.bodies) load.bodies += body.fixed ? 0 : 1;
    load.springs = static_cast<double>(scene.springs.size()) + (scene.gravitation > 0 ? all * (all - 1) / 2 : 0);
    load.joints = static_cast<double>(scene.joints.size());
    return load;
}

// m: the distance of neighbouring numbers. In floating point these numbers are the largest position, arm or length that
// a force is computed from.
double spacing_of(const SceneDescription& scene, const Simulation& simulation, const std::vector<Moment>& moments) {
    if (!simulation.range().empty()) return held_by(simulation.range()).position * 0x1p-30;
    double farthest = 0;
    const auto see = [&](const reference::Vector& v) { farthest = std::max(farthest, static_cast<double>(norm(v))); };
    for (const Moment& moment : moments)
        for (const reference::Motion& body : moment.bodies) see(body.x);
    for (const BodyDescription& body : scene.bodies) see(reference::vector_of(body.shape.size));
    for (const SpringDescription& spring : scene.springs) {
        see(reference::vector_of(spring.to));
        farthest = std::max(farthest, spring.rest_length);
    }
    const bool is_float = simulation.numbers() == "f32";
    return farthest *
           (is_float ? double{std::numeric_limits<float>::epsilon()} : std::numeric_limits<double>::epsilon());
}

}  // namespace

void add_once(std::vector<Trouble>& troubles, const Trouble& trouble) {
    if (std::none_of(troubles.begin(), troubles.end(), [&](const Trouble& t) { return t.issue == trouble.issue; }))
        troubles.push_back(trouble);
}

std::vector<std::int64_t> moments_of(const SceneDescription& scene) {
    const std::int64_t steps = scene.steps(), count = std::min<std::int64_t>(steps, sample_count);
    std::vector<std::int64_t> moments;
    for (std::int64_t i = 1; i <= count; ++i) moments.push_back((steps * i + count / 2) / count);
    return moments;
}

Recorder::Recorder(const SceneDescription& scene, const Simulation& simulation, std::vector<std::int64_t> moments,
                   std::optional<double> most_gain)
    : scene_(scene), rules_(scene), moments_(std::move(moments)), range_(scene, simulation),
      driven_(driven_steps_of(scene)), start_(read(simulation)), now_(start_) {
    now_.way_m.resize(start_.bodies.size());
    now_.turn_rad.resize(start_.bodies.size());
    if (most_gain) energy_.emplace(scene, simulation, *most_gain);
    plan_look();
}

void Recorder::plan_look() {
    const std::size_t m = record_.moments.size();
    if (m == moments_.size()) {
        next_look_ = -1;
        return;
    }
    const std::int64_t from = m == 0 ? 0 : moments_[m - 1], length = moments_[m] - from;
    // The least step above the last look at which a whole number of looks has passed.
    std::int64_t look = (looked_ - from) * looks_per_moment / length;
    do next_look_ = from + length * ++look / looks_per_moment;
    while (next_look_ <= looked_);
}

bool Recorder::see(const Simulation& simulation) {
    if (is_over_) return false;
    range_.see(simulation);
    is_over_ = range_.trouble() || simulation.has_trouble("range_left");
    return !is_over_ && simulation.steps_taken() == next_look_ && look(simulation);
}

bool Recorder::look(const Simulation& simulation) {
    now_.bodies = read(simulation).bodies;
    rules_.see(simulation);
    for (std::size_t b = 0; b < now_.bodies.size(); ++b) {
        const reference::Motion& at = now_.bodies[b];
        if (!is_finite(at)) {
            is_over_ = true;
            record_.not_finite = static_cast<int>(b);
            return true;
        }
        if (!scene_.bodies[b].fixed) {
            ++seen_;
            if (norm(at.v) > speed_at_rest || norm(at.w) > speed_at_rest) ++moving_;
        }
    }
    widen(now_, start_);
    const std::size_t m = record_.moments.size();
    const bool is_driven = std::any_of(driven_.begin(), driven_.end(), [&](const auto& span) {
        return span.first < next_look_ && looked_ < span.second;
    });
    if (energy_) energy_->see(simulation, is_driven);
    looked_ = next_look_;
    if (looked_ == moments_[m]) {
        record_.moments.push_back(now_);
        if (energy_ && energy_->is_exceeded() && !record_.gained) record_.gained = m;
    }
    plan_look();
    return true;
}

Record Recorder::record(const Simulation& simulation) && {
    record_.contact_tolerance = static_cast<double>(simulation.contact_tolerance());
    record_.troubles = simulation.troubles();
    if (range_.trouble()) add_once(record_.troubles, *range_.trouble());
    record_.spacing = spacing_of(scene_, simulation, {start_});
    // Half a spacing a step, in either direction.
    record_.rounding = spacing_of(scene_, simulation, record_.moments) / 2 *
                       std::sqrt(static_cast<double>(std::max<std::int64_t>(simulation.steps_taken(), 4)));
    record_.rules = rules_.rules();
    record_.load = load_of(scene_);
    const double moving = seen_ == 0 ? 1 : static_cast<double>(moving_) / static_cast<double>(seen_);
    record_.load.pairs = simulation.most_near_pairs() * std::max(moving, share_at_rest);
    return std::move(record_);
}

Record record_of(const SceneDescription& scene, const Method& method, int halvings,
                 const std::vector<std::int64_t>& moments, std::optional<double> most_gain) {
    SceneDescription finer = scene;
    finer.step = scaled(scene.step, -halvings);
    std::vector<std::int64_t> finer_moments = moments;
    for (std::int64_t& moment : finer_moments) moment <<= halvings;
    const auto simulation = make_simulation(finer, method.integrator, method.numbers, method.carry);
    const std::int64_t steps = finer_moments.back();
    Recorder recorder(finer, *simulation, std::move(finer_moments), most_gain);
    while (simulation->steps_taken() < steps && !recorder.is_over()) {
        simulation->step();
        (void)recorder.see(*simulation);
    }
    return std::move(recorder).record(*simulation);
}

SolvedRecord solved_record_of(const SceneDescription& scene, double most_error,
                              const std::vector<std::int64_t>& moments, std::optional<double> most_seconds) {
    SolvedRecord solved;
    solved.record.load = load_of(scene);
    constexpr double body = 5e-6, spring = 0.5e-6;  // s; measured
    const double evaluation = body * solved.record.load.bodies + spring * solved.record.load.springs;
    Effort effort{.most_error = most_error};
    if (most_seconds) effort.most_evaluations = static_cast<std::int64_t>(*most_seconds / evaluation);
    SmoothMotion motion(scene, shapes_meet, effort);
    const Moment start{motion.bodies(), {}, {}};
    Moment now = start;
    now.way_m.resize(start.bodies.size());
    now.turn_rad.resize(start.bodies.size());
    std::int64_t from = 0;
    try {
        for (const std::int64_t moment : moments) {
            for (std::int64_t look = 1; look <= looks_per_moment; ++look) {
                motion.advance_to(from + (moment - from) * look / looks_per_moment);
                now.bodies = motion.bodies();
                widen(now, start);
            }
            solved.record.moments.push_back(now);
            from = moment;
        }
        solved.seconds = evaluation * static_cast<double>(motion.evaluations());
    } catch (const EffortSpent&) {
        const auto end = static_cast<double>(static_cast<long double>(moments.back()) * long_seconds(scene.step)),
                   reached = static_cast<double>(motion.reached());
        solved.seconds = *most_seconds * end / std::min(std::max(reached, 1e-6 * end), end);
    }
    return solved;
}

// Measured with the scenes of this repository and their contacts, to a factor of about 3.
double estimated_seconds(const SceneDescription& scene, int halvings, const Load& load) {
    constexpr double step = 1e-6, body = 0.5e-6, spring = 1e-6, joint = 3e-6, pair = 3e-6;  // s
    return std::ldexp(static_cast<double>(scene.steps()), halvings) *
           (step + body * load.bodies + spring * load.springs + joint * load.joints + pair * load.pairs);
}

}  // namespace tumble::host

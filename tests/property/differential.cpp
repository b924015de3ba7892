#include "differential.hpp"

#include <tumble/numbers/systems.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "../kernel/random.hpp"
#include "scene/data.hpp"
#include "scene/error.hpp"
#include "scene/reader.hpp"
#include "scene_text.hpp"
#include "simulation/limits.hpp"
#include "simulation/simulation.hpp"
#include "simulation/watch.hpp"
#include "tools/text.hpp"
#include "verdict/accuracy.hpp"

namespace tumble::test {
namespace {

using namespace host;
using reference::Motion, reference::Number, reference::Vector;

constexpr Number safety = 32;
constexpr int samples_of_a_run = 24;
// Units of a number that carries its residual: of the start, the constants, and what is computed with them in a step.
constexpr double carried_units = 4;
// Parts of what the motion has reached beyond which a bound says nothing.
constexpr Number useful = 0.1L;
// Of the contact band: what impacts find their time to, and more.
constexpr Number found = 0x1p-4L;
// Of the energy that is free to move, how much a method may add.
constexpr Number most_gain = 1;
// Where a unit quaternion is no longer one.
constexpr Number unit_length = 0x1p-5L;
// Of the arms of contact points, relative: they have 24 bits.
constexpr Number lever = 0x1p-24L;
// Of the contact band: how deep the lowest point of what has been at rest or bounced may be.
constexpr Number depth = 5;

// Of each number of a body, SI units.
struct Differences {
    Number position = 0, velocity = 0, angle = 0, spin = 0;

    void see(const Differences& other) {
        position = std::max(position, other.position);
        velocity = std::max(velocity, other.velocity);
        angle = std::max(angle, other.angle);
        spin = std::max(spin, other.spin);
    }
    // The largest of each to that of the other.
    [[nodiscard]] Number over(const Differences& bound) const {
        return std::max({position / bound.position, velocity / bound.velocity, angle / bound.angle, spin / bound.spin});
    }
};
Differences between(const Motion& a, const Motion& b) {
    return {norm(a.x - b.x), norm(a.v - b.v), angle_between(a.q, b.q), norm(a.w - b.w)};
}

struct Sample {
    std::int64_t step = 0;  // steps taken
    std::vector<Motion> bodies;
    Energy energy;
};

struct Run {
    std::string integrator, numbers;
    bool carry;
    std::vector<Sample> samples{};  // before the first status
    std::string told{};             // its name and step
    std::string range{};
};

// Triples of neighbouring steps, spread over the run: an impact at the very end of a step may fall into the next one in
// another number system, and the velocities of one state differ.
std::vector<std::int64_t> sample_steps(std::int64_t steps) {
    std::vector<std::int64_t> list{0};
    for (std::int64_t i = 1; i <= samples_of_a_run; ++i) {
        const std::int64_t step = i * steps / samples_of_a_run;
        for (const std::int64_t s : {step - 1, step, step + 1}) {
            if (s > list.back() && s <= steps) list.push_back(s);
        }
    }
    return list;
}

Run run(const SceneDescription& scene, const std::string& integrator, const std::string& numbers, bool carry,
        const std::vector<std::int64_t>& at) {
    const auto simulation = make_simulation(scene, integrator, numbers, carry);
    Run run{integrator, numbers, carry};
    run.range = simulation->range();
    for (const std::int64_t step : at) {
        while (simulation->steps_taken() < step && simulation->troubles().empty()) simulation->step();
        if (!simulation->troubles().empty()) {
            const Trouble& trouble = simulation->troubles().front();
            run.told = trouble.issue + " at step " + std::to_string(trouble.step);
            return run;
        }
        Sample sample{step, {}, simulation->energy()};
        for (int b = 0; b < simulation->body_count(); ++b) { sample.bodies.push_back(motion_of(simulation->body(b))); }
        run.samples.push_back(std::move(sample));
    }
    return run;
}

// Ends a run at what the command tells in its first `steps` steps and the kernel does not: energy that only the method
// can have added, and, of a run that is judged, its [range]. False if there is nothing.
bool end_where_command_tells(Run& run, const SceneDescription& scene, std::int64_t steps, bool is_judged) {
    const auto simulation = make_simulation(scene, run.integrator, run.numbers, run.carry);
    EnergyGrowthWatch growth(scene, *simulation);
    RangeWatch range(scene, *simulation);
    while (simulation->steps_taken() < steps) {
        simulation->step();
        growth.see(*simulation, simulation->energy());
        range.see(*simulation);
        const auto& trouble = is_judged && range.trouble() ? range.trouble() : growth.trouble();
        if (!trouble) continue;
        run.told = trouble->issue + " at step " + std::to_string(trouble->step) + ", by the command";
        std::erase_if(run.samples, [&](const Sample& sample) { return sample.step > trouble->step; });
        return true;
    }
    return false;
}

double smallest_reach(const SceneDescription& scene) {
    double smallest = reach(scene.bodies.front());
    for (const BodyDescription& body : scene.bodies) smallest = std::min(smallest, reach(body));
    return smallest;
}

// What a number system resolves, SI units, and of a constant, relative.
struct Units {
    Differences of;
    Number constant;
};
Units units_of(const Trial& trial, const Run& base, const Run& other) {
    const SceneDescription& scene = trial.scene;
    const double h = scene.step.seconds();
    const double smallest = smallest_reach(scene);
    if (trial.numbers == "q32") {
        const bool has_contacts = scene.contact.response != ContactResponse::none,
                   has_loads_at_points = !scene.springs.empty() || !scene.forces.empty() || !scene.impulses.empty();
        double x = 0, v = 0, w = 0;
        Ranges::for_each([&]<class Named>() {
            if (other.range != Named::name) return;
            x = Named::Range::position;
            v = Named::Range::velocity;
            w = std::min<double>(Named::Range::spin, 0.5 / h);
        });
        Units units{{x * 0x1p-30, v * 0x1p-29, 0x1p-30, w * 0x1p-29}, 0x1p-29};
        if (has_contacts) units.of.angle = units.constant = lever;
        if (has_contacts || has_loads_at_points) units.of.spin += units.of.velocity / smallest;
        return units;
    }
    Differences largest;
    for (const Sample& sample : base.samples) {
        for (const Motion& m : sample.bodies) largest.see({norm(m.x), norm(m.v), 1, norm(m.w)});
    }
    const Number last_place = trial.numbers == "f64" ? 0x1p-52L : 0x1p-23L;
    return {{largest.position * last_place, largest.velocity * last_place, last_place,
             (largest.spin + largest.velocity / smallest) * last_place},
            last_place};
}

// m/s: what springs make of a step's rounding of places; damping forgets what the start was off by, but not this.
Number rounding_by_springs(const SceneDescription& scene, const Units& units) {
    Number stiffest = 0;  // 1/s^2
    for (const SpringDescription& spring : scene.springs) {
        for (const int b : {spring.body, spring.to_body}) {
            if (b < 0 || scene.bodies[static_cast<std::size_t>(b)].fixed) continue;
            stiffest = std::max(stiffest, Number(spring.stiffness) / *scene.bodies[static_cast<std::size_t>(b)].mass);
        }
    }
    return scene.step.seconds() * stiffest * units.of.position;
}

// The scene with everything off by up to `count` units.
SceneDescription jolted(SceneDescription scene, const Units& units, double count, Random& random) {
    const auto any = [&](Number unit) { return static_cast<double>(unit) * count * random.uniform(-1, 1); };
    const auto scale = [&](double& x) { x *= 1 + any(units.constant); };
    const auto shift = [&](auto& array, Number unit) {
        for (double& x : array) x += any(unit);
    };
    for (double& g : scene.gravity) scale(g);
    for (double* x : {&scene.gravitation, &scene.linear_drag, &scene.angular_drag, &scene.contact.friction,
                      &scene.contact.stiffness, &scene.contact.damping})
        scale(*x);
    scene.contact.restitution -= std::abs(any(units.constant)) * scene.contact.restitution;  // no more than 1
    for (PlaneDescription& plane : scene.planes) {
        shift(plane.normal, units.constant);
        plane.offset += any(units.of.position);
    }
    for (BodyDescription& body : scene.bodies) {
        scale(*body.mass);
        for (double& size : body.shape.size) scale(size);
        if (body.inertia) {
            // The last of the three may be as large as the others together.
            const double factor = 1 + any(units.constant);
            for (double& moment : *body.inertia) moment *= factor;
        }
        shift(body.position, units.of.position);
        shift(body.velocity, units.of.velocity);
        const auto& q = body.orientation;
        const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        shift(body.orientation, units.of.angle * length);
        shift(body.angular_velocity, units.of.spin);
    }
    for (SpringDescription& spring : scene.springs) {
        scale(spring.stiffness);
        scale(spring.damping);
        shift(spring.to, units.of.position);
        if (spring.rest_length > 0) scale(spring.rest_length);
    }
    for (ImpulseDescription& impulse : scene.impulses) {
        for (double& x : impulse.impulse) scale(x);
        for (double& x : impulse.angular_impulse) scale(x);
    }
    for (ForceDescription& force : scene.forces) {
        for (double& x : force.force) scale(x);
        for (double& x : force.torque) scale(x);
    }
    return scene;
}

// --- laws ------------------------------------------------------------------------------------------------------------

bool is_finite(const Motion& m) {
    const Number sum = norm(m.x) + norm(m.v) + m.q.norm2() + norm(m.w);
    return std::isfinite(sum);
}

// How far the lowest point of a sphere or a box is above a plane, m.
std::optional<Number> height(const BodyDescription& body, const Motion& m, const PlaneDescription& plane) {
    const Vector normal = reference::vector_of(plane.normal);
    const Vector n = normal * (1 / norm(normal));
    if (body.shape.kind != ShapeKind::sphere && body.shape.kind != ShapeKind::box) return {};
    return dot(n, m.x) + plane.offset - half_extent(body, m.q.normalized(), n);
}

// The limit that is exceeded, or nothing. A range that is not held to its end, or for the hardest of impacts, may be
// enough for the motion, and is told where it is not; a coarse place for what touches little.
std::optional<Limit> exceeded_limit(const SceneDescription& scene, const std::string& integrator,
                                    const std::string& numbers, bool carry) {
    for (const Limit& limit : exceeded_limits(scene, integrator, numbers, carry))
        if (limit.what != "range" && limit.what != "impact" && limit.what != "place") return limit;
    return {};
}

// True if a limit is exceeded at twice the step. From there on what swings far and wide may gain energy by resonance
// with the step: two springs in a row, 0.68 of the limit, the 29-fold in 370 steps.
bool is_near_limit(SceneDescription scene, const std::string& integrator) {
    StepSize& step = scene.step;
    if (step.denominator != 0) step.numerator *= 2;
    else step.decimal *= 2;
    return exceeded_limit(scene, integrator, "f64", false).has_value();
}

// What drives the scene besides loads that have a potential.
bool is_driven(const SceneDescription& scene) {
    const bool turntable = std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const BodyDescription& body) {
        return body.fixed && body.angular_velocity != Triple{};
    });
    return turntable || !scene.impulses.empty() || !scene.forces.empty();
}

// Methods that keep the energy of what swings and turns within bounds, at steps up to half of what they stand.
bool keeps_energy(const std::string& integrator) {
    return find_integrator(integrator).free_order != 1 && integrator != "midpoint" && integrator != "heun" &&
           integrator != "rk4";
}

// The law that a run breaks without a status, or nothing.
std::string broken_law(const SceneDescription& scene, const Run& run, const Units& units, Number rounding_of_energy,
                       std::int64_t& step) {
    const ContactDescription& contact = scene.contact;
    const auto rough = [](const auto& side) { return side.friction.value_or(0.0) > 0; };
    const bool has_friction = contact.friction > 0 || std::any_of(scene.planes.begin(), scene.planes.end(), rough);
    double bounciest = contact.restitution;
    for (const PlaneDescription& plane : scene.planes) bounciest = std::max(bounciest, plane.restitution.value_or(0.0));
    // Newton's law of restitution with friction may gain energy (Kane's paradox); springs between boxes have no
    // potential here.
    const bool energy_is_bounded = !is_driven(scene) && keeps_energy(run.integrator) &&
                                   !(has_friction && bounciest > 0.7) && contact.response != ContactResponse::spring;
    const bool momentum_is_kept =
        !is_driven(scene) && scene.planes.empty() && scene.gravity == Triple{} && scene.linear_drag == 0 &&
        !contact.sleep &&
        std::none_of(scene.bodies.begin(), scene.bodies.end(), [](const auto& b) { return b.fixed; }) &&
        std::all_of(scene.springs.begin(), scene.springs.end(), [](const auto& s) { return s.to_body >= 0; });

    const Energy& start = run.samples.front().energy;
    Number freed = 0, fastest = 0, spin = 0, mass = 0;
    Vector momentum_at_start;
    const Number h = scene.step.seconds(), fall = norm(reference::vector_of(scene.gravity)), hop = fall * h * h / 4;
    for (const BodyDescription& body : scene.bodies) mass += *body.mass;
    // What rests may be lifted within the contact band.
    const Number lift = contact.response == ContactResponse::impulse ? mass * fall * found * contact.tolerance : 0;
    for (const Sample& sample : run.samples) {
        step = sample.step;
        Vector momentum;
        for (std::size_t b = 0; b < sample.bodies.size(); ++b) {
            const BodyDescription& body = scene.bodies[b];
            const Motion& m = sample.bodies[b];
            const std::string who = "\"" + body.name + "\" ";
            if (!is_finite(m)) return who + "is not finite";
            if (!(std::abs(m.q.norm2() - 1) <= unit_length))
                return who + "has an orientation of length " + few_digits(std::sqrt(m.q.norm2()));
            momentum = momentum + *body.mass * m.v;
            fastest = std::max(fastest, norm(m.v));
            spin = std::max(spin, norm(m.w));
            if (contact.response != ContactResponse::impulse || body.fixed) continue;
            for (const PlaneDescription& plane : scene.planes) {
                const auto gap = height(body, m, plane);
                const auto first = height(body, run.samples.front().bodies[b], plane);
                // What gravity and the spin move in a step, which is taken as straight, is not seen.
                const Number unseen = hop + reach(body) * spin * h;
                if (gap && *first >= -contact.tolerance &&
                    *gap < -depth * contact.tolerance - unseen - units.of.position)
                    return who + "is " + few_digits(-*gap) + " m deep in \"" + plane.name + "\"";
            }
        }
        freed = std::max(freed, start.potential - sample.energy.potential);
        const Number gain = sample.energy.total() - start.total(),
                     most = start.kinetic + std::max(freed, start.potential);
        if (energy_is_bounded && gain > most_gain * std::abs(most) + lift + rounding_of_energy &&
            !is_near_limit(scene, run.integrator))
            return "energy rises from " + few_digits(start.total()) + " J to " + few_digits(sample.energy.total()) +
                   " J";
        if (sample.step == 0) momentum_at_start = momentum;
        const Number drift = norm(momentum - momentum_at_start);
        if (momentum_is_kept &&
            drift > mass * (units.of.velocity * static_cast<Number>(16 + sample.step) + 1e-5L * fastest))
            return "momentum drifts by " + few_digits(drift) + " N s";
    }
    return {};
}

// --- the comparison --------------------------------------------------------------------------------------------------

// The largest of a body's motion, what a difference is a part of.
Differences reached(const Run& run, const SceneDescription& scene, std::size_t body) {
    const Number size = reach(scene.bodies[body]);
    const Motion& start = run.samples.front().bodies[body];
    Differences largest;
    for (const Sample& sample : run.samples) {
        const Motion& now = sample.bodies[body];
        largest.see(
            {norm(now.x - start.x) + size, norm(now.v) + norm(now.w) * size, 1, norm(now.w) + norm(now.v) / size});
    }
    return largest;
}

class Comparison {
public:
    // `fork`: velocities that differ by as much as they may move what has them apart from the start on, up to a tenth
    // of what the motion reaches.
    Comparison(const SceneDescription& scene, const Units& units, const Run& base, const std::vector<Run>& jolted,
               bool fork)
        : scene_(scene), units_(units), base_(base), jolted_(jolted), fork_(fork), magnified_(scene.bodies.size()) {
        for (std::size_t b = 0; b < scene.bodies.size(); ++b) reached_.push_back(reached(base, scene, b));
    }

    void hold(const Run& run, Verdict& verdict) {
        std::size_t count = std::min(base_.samples.size(), run.samples.size());
        for (const Run& other : jolted_) count = std::min(count, other.samples.size());
        for (std::size_t i = 0; i < count; ++i) {
            const Sample &sample = base_.samples[i], &held = run.samples[i];
            if (!is_useful(i)) break;
            verdict.compared = static_cast<double>(i + 1) / static_cast<double>(sample_steps(scene_.steps()).size());
            for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
                if (has_impacts_ && !has_neighbours(i)) continue;
                const Differences difference = nearest(i, b, held.bodies[b]), bound = bound_of(b, sample.step);
                const Number share = difference.over(bound);
                verdict.share = std::max(verdict.share, static_cast<double>(share));
                if (!(share > 1) || verdict.kind == Verdict::Kind::wrong) continue;
                verdict.kind = Verdict::Kind::wrong;
                verdict.step = sample.step;
                verdict.what =
                    "\"" + scene_.bodies[b].name + "\" differs by " + text(difference) + "; bounds: " + text(bound);
            }
        }
    }

private:
    static std::string text(const Differences& d) {
        return few_digits(d.position) + " m, " + few_digits(d.velocity) + " m/s, " + few_digits(d.angle) + " rad, " +
               few_digits(d.spin) + " rad/s";
    }

    [[nodiscard]] bool has_neighbours(std::size_t i) const {
        const std::vector<Sample>& samples = base_.samples;
        return i > 0 && i + 1 < samples.size() && samples[i + 1].step - samples[i - 1].step == 2;
    }

    // Of a state and the base's; where there are impacts, of its velocities and those of the steps beside.
    [[nodiscard]] Differences nearest(std::size_t i, std::size_t b, const Motion& held) const {
        Differences difference = between(base_.samples[i].bodies[b], held);
        for (const std::size_t j : {i - 1, i + 1}) {
            if (!has_impacts_) continue;
            const Differences beside = between(base_.samples[j].bodies[b], held);
            difference.velocity = std::min(difference.velocity, beside.velocity);
            difference.spin = std::min(difference.spin, beside.spin);
        }
        return difference;
    }

    // What bounces less than the contact band, or for less than a step, may do so in another step, or not at all.
    [[nodiscard]] Differences band_of(std::size_t b) const {
        if (!has_impacts_) return {};
        const Number band = found * scene_.contact.tolerance, size = reach(scene_.bodies[b]), h = scene_.step.seconds(),
                     fall = norm(reference::vector_of(scene_.gravity)) * h / 2;
        return {band + fall * h, fall, (band + fall * h) / size, fall / size};
    }
    [[nodiscard]] Differences bound_of(std::size_t b, std::int64_t step) const {
        const Differences &m = magnified_[b], &u = units_.of;
        Differences band = band_of(b);
        if (fork_) {
            const Number time = scene_.step.seconds() * static_cast<Number>(step);
            band.position += std::min(band.velocity * time, useful * reached_[b].position);
            band.angle += std::min(band.spin * time, useful * reached_[b].angle);
        }
        return {safety * (m.position + u.position) + band.position, safety * (m.velocity + u.velocity) + band.velocity,
                safety * (m.angle + u.angle) + band.angle, safety * (m.spin + u.spin) + band.spin};
    }

    // The magnified rounding of all bodies up to a sample; false where it is no longer small.
    [[nodiscard]] bool is_useful(std::size_t i) {
        for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
            for (const Run& other : jolted_)
                magnified_[b].see(between(base_.samples[i].bodies[b], other.samples[i].bodies[b]));
            if (i == 0) at_start_.push_back(magnified_[b]);
            const Differences &m = magnified_[b], &start = at_start_[b], band = band_of(b), &most = reached_[b];
            const auto small = [](Number now, Number first, Number floor, Number largest) {
                return safety * now <= std::max(useful * largest, 2 * safety * first + floor);
            };
            if (!small(m.position, start.position, band.position, most.position) ||
                !small(m.velocity, start.velocity, band.velocity, most.velocity) ||
                !small(m.angle, start.angle, band.angle, most.angle) ||
                !small(m.spin, start.spin, band.spin, most.spin))
                return false;
        }
        return true;
    }

    const SceneDescription& scene_;
    const bool has_impacts_ = scene_.contact.response == ContactResponse::impulse;
    const Units& units_;
    const Run& base_;
    const std::vector<Run>& jolted_;
    const bool fork_;
    std::vector<Differences> magnified_, at_start_, reached_;
};

Verdict judge_scene(const Trial& trial, const SceneDescription& scene) {
    Verdict verdict;
    const auto told = [&](const Run& run, const char* whose) {
        if (run.told.empty() || verdict.kind == Verdict::Kind::wrong) return;
        verdict.kind = Verdict::Kind::told;
        verdict.what = whose + run.told;
    };
    for (const std::string& numbers : {trial.numbers, std::string("f64")}) {
        const auto limit = exceeded_limit(scene, trial.integrator, numbers, numbers != "f64" && trial.carry);
        if (!limit) continue;
        verdict.kind = Verdict::Kind::named;
        verdict.what = limit->what;
        return verdict;
    }
    // What begins in a plane or in another body.
    if (const auto unlike = limitations(scene); scene.contact.response != ContactResponse::none && !unlike.empty()) {
        verdict.kind = Verdict::Kind::named;
        verdict.what = unlike.front();
        return verdict;
    }
    const std::vector<std::int64_t> at = sample_steps(scene.steps());
    Run base = run(scene, trial.integrator, "f64", false, at),
        other = run(scene, trial.integrator, trial.numbers, trial.carry, at);
    if (base.samples.empty() || other.samples.empty()) {
        told(base, "f64: ");
        told(other, "");
        return verdict;
    }
    const Units units = units_of(trial, base, other), fine{};
    std::vector<Run> jolts;
    Random random(1);
    // Of the two runs in double precision the one with residuals is the better one.
    const bool carried = trial.carry && trial.numbers != "f64";
    const double units_carried = carried_units + (carried ? 0 : 0.5 * static_cast<double>(scene.steps()));
    const auto jolt = [&](std::initializer_list<double> factors) {
        for (const double factor : factors) {
            jolts.push_back(
                run(jolted(scene, units, factor * units_carried, random), trial.integrator, "f64", false, at));
        }
    };
    jolt({1, 1, 8});
    Number rounding_of_energy = 0;
    for (const Run& jolt : jolts) {
        if (jolt.samples.empty()) continue;
        const Number change = jolt.samples.front().energy.total() - base.samples.front().energy.total();
        rounding_of_energy = std::max(rounding_of_energy, safety * std::abs(change));
    }

    const auto law = [&](Run& of, const Units& in) {
        if (verdict.kind == Verdict::Kind::wrong) return;
        std::int64_t step = 0;
        const std::string law = broken_law(scene, of, in, rounding_of_energy, step);
        if (law.empty() || end_where_command_tells(of, scene, step, true)) return;
        verdict.kind = Verdict::Kind::wrong;
        verdict.what = of.numbers + ": " + law;
        verdict.step = step;
    };
    law(base, fine);
    Units all = units;  // of a run
    all.of.position *= units_carried;
    law(other, all);
    if (verdict.kind == Verdict::Kind::wrong) return verdict;

    // Bodies that rounding moves by their size may meet others than they would.
    const bool touches =
        scene.contact.response != ContactResponse::none && (!scene.planes.empty() || scene.bodies.size() > 1);
    if (touches && !(units.of.position * units_carried < smallest_reach(scene))) {
        verdict.kind = Verdict::Kind::named;
        verdict.what = "rounding moves a body by its size";
        return verdict;
    }
    Units of_a_step = units;
    of_a_step.of.velocity += rounding_by_springs(scene, units);
    const auto compare = [&](bool fork) {
        verdict = {};
        Comparison(scene, of_a_step, base, jolts, fork).hold(other, verdict);
        return verdict.kind == Verdict::Kind::wrong;
    };
    if (compare(false)) {
        // A motion that comes to a fork, as where a box lands on an edge, or what is pushed away loses touch a step
        // later, is known by more runs.
        jolt({1, 1, 1, 1, 1, 8, 8, 8, 64});
        if (compare(true) && (end_where_command_tells(other, scene, verdict.step, true) ||
                              end_where_command_tells(base, scene, verdict.step, false)))
            compare(true);
    }
    told(base, "f64: ");
    told(other, "");
    return verdict;
}

}  // namespace

Verdict judge(const Trial& trial) {
    Verdict verdict;
    try {
        return judge_scene(trial, read_scene_text(scene_text(trial.scene), trial.scene.name));
    } catch (const SceneError& error) {
        verdict.kind = Verdict::Kind::refused;
        verdict.what = error.what();
    } catch (const UnsupportedScene& error) {
        verdict.kind = Verdict::Kind::refused;
        verdict.what = error.what();
    } catch (const std::invalid_argument& error) {
        verdict.kind = Verdict::Kind::refused;
        verdict.what = error.what();
    } catch (const std::exception& error) {
        verdict.kind = Verdict::Kind::wrong;
        verdict.what = error.what();
    }
    return verdict;
}

void load_worlds(const std::string& numbers) {
    SceneDescription scene = draw_trial(1, 0).scene;
    for (BodyDescription& body : scene.bodies) body.position = body.velocity = body.angular_velocity = {};
    for (const NumberSystemInfo& system : number_systems()) {
        const std::string name = numbers_text(system.name, system.carry);
        if (!numbers.empty() && name != numbers && name != "f64") continue;
        Ranges::for_each([&]<class Named>() {
            scene.range = {Named::Range::position, Named::Range::velocity, Named::Range::spin};
            (void)make_simulation(scene, "verlet", system.name, system.carry);
        });
    }
}

}  // namespace tumble::test

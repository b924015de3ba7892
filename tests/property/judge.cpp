#include "judge.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "../kernel/random.hpp"
#include "scene/data.hpp"
#include "scene/error.hpp"
#include "scene/reader.hpp"
#include "simulation/simulation.hpp"
#include "tools/text.hpp"
#include "truth/smooth_motion.hpp"
#include "verdict/record.hpp"
#include "verdict/verdict.hpp"

namespace tumble::test {
namespace {

using namespace host;
using host::Method;
using Kind = Judgement::Kind;
using reference::Motion, reference::vector_of;

// Bound of the distance from f64, in distances that rounding of the start makes, or in resolutions of the numbers.
constexpr double rounding_factor = 32;
// Rounding of a start, in units of the number system; without residuals each step adds up to half a unit.
constexpr double units_of_start = 4, units_of_step = 0.5;
// Part of the motion beyond which a bound says nothing.
constexpr double useful = 0.1;
// Part of the contact band to which an impact finds its time; and the largest penetration, in contact bands.
constexpr double found = 0x1p-4, depth = 5;
// Growth of energy in parts of the largest kinetic energy.
constexpr double most_gain = 1;
// Error of a run in f64, rad or in parts of the way, that a finer step must make smaller by this factor.
constexpr double tolerance = 0.01, shrinks = 0.5;

// The rounding of each measure, SI units; of a factor, relative.
using Units = std::array<double, 5>;
double unit(const Units& units, Measure measure) { return units[static_cast<std::size_t>(measure)]; }
double length(const reference::Vector& v) { return static_cast<double>(norm(v)); }

Units units_of(const SceneDescription& scene, const Method& method, const Record& twin) {
    double x = 0, v = 0, q = 0, w = 0, factor = 0, smallest = std::numeric_limits<double>::infinity();
    for (const BodyDescription& body : scene.bodies) smallest = std::min(smallest, reach(body));
    if (method.numbers == "q32") {
        const RangeDescription range = held_by(find_number_system(scene, method.numbers, method.carry).range);
        x = range.position * 0x1p-30;
        v = range.velocity * 0x1p-29;
        w = std::min(range.angular_velocity, 0.5 / scene.step.seconds()) * 0x1p-29;
        // Arms of contact points have 24 bits.
        q = factor = scene.contact.response == ContactResponse::none ? 0x1p-29 : 0x1p-24;
    } else {
        q = factor = method.numbers == "f64" ? 0x1p-52 : 0x1p-23;
        for (const Moment& moment : twin.moments) {
            for (const Motion& m : moment.bodies) {
                x = std::max(x, factor * length(m.x));
                v = std::max(v, factor * length(m.v));
                w = std::max(w, factor * length(m.w));
            }
        }
    }
    return {x, v, q, w + v / smallest, factor};  // a load at a point turns the rounding of velocities into spin
}

// The unit of velocities in the rows of contacts in fixed point, m/s, of the lightest body of the scene. An island has
// one scale (SpeedScale::of in q32_contact.hpp) for velocities times the root of the mass: 29 bits for less than four
// times the largest component, times the power of two above their norm, times the root of the mass ratio, up to twice,
// and two bits more for several bodies.
double unit_of_rows(const SceneDescription& scene, const Record& twin) {
    const double kick = length(vector_of(scene.gravity)) * scene.step.seconds();
    double heaviest = 0, lightest = std::numeric_limits<double>::infinity(), fastest = 0;  // of the roots of masses
    unsigned count = 0;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        const BodyDescription& body = scene.bodies[b];
        if (body.fixed) continue;
        const double root = std::sqrt(*body.mass);
        heaviest = std::max(heaviest, root);
        lightest = std::min(lightest, root);
        ++count;
        for (const Moment& moment : twin.moments) {
            const Motion& m = moment.bodies[b];
            fastest = std::max(fastest, root * std::max(length(m.v) + kick, reach(body) * length(m.w)));
        }
    }
    if (count == 0) return 0;
    const double norm = std::exp2((std::bit_width(6 * count - 1) + 1) / 2),
                 spread = count > 1 ? 8 * heaviest / lightest : 1;
    return 4 * fastest * norm * spread * 0x1p-29 / lightest;
}

// The scene with all its numbers off by up to `count` units.
SceneDescription jolted(SceneDescription scene, const Units& units, double count, Random& random) {
    for_each_number(scene, [&](double& x, Measure measure) {
        const double off = count * random.uniform(-1, 1) * unit(units, measure);
        x += measure == Measure::factor ? off * x : off;
    });
    scene.contact.restitution = std::min(scene.contact.restitution, 1.0);
    for (BodyDescription& body : scene.bodies) {
        if (body.fixed) body.velocity = {};
        if (body.is_point_mass()) body.orientation = {1, 0, 0, 0}, body.angular_velocity = {};
    }
    return scene;
}

bool is_isolated(const SceneDescription& scene) {
    return scene.impulses.empty() && scene.forces.empty() && scene.planes.empty() && scene.gravity == Triple{} &&
           scene.linear_drag == 0 && !scene.contact.sleep &&
           std::none_of(scene.bodies.begin(), scene.bodies.end(), [](const auto& b) { return b.fixed; }) &&
           std::all_of(scene.springs.begin(), scene.springs.end(), [](const auto& s) { return s.to_body >= 0; }) &&
           std::all_of(scene.joints.begin(), scene.joints.end(), [](const auto& j) { return j.to_body >= 0; });
}

// How deep the lowest point of a sphere or a box is in a plane, m.
double depth_of(const BodyDescription& body, const Motion& m, const PlaneDescription& plane) {
    const reference::Vector normal = vector_of(plane.normal), n = normal * (1 / norm(normal));
    return static_cast<double>(half_extent(body, m.q.normalized(), n) - dot(n, m.x) - plane.offset);
}

// The law that a run breaks before it has a status, or nothing. What a step moves beside the straight line is not seen
// within it. What other bodies, springs or forces press into planes may sink in, in f64 as well: a pile that is heavier
// at the top needs more sweeps than their bound. Each step leaves the same part of the load, so that it sinks at a
// constant speed. In which plane a wedged body sinks, and when it slips out, rounding decides.
std::string broken_law(const SceneDescription& scene, const Record& run, const Record& twin, const Units& units,
                       double count) {
    const double h = scene.step.seconds(), fall = length(vector_of(scene.gravity)) * h * h / 4;
    const bool is_alone = is_isolated(scene);
    const bool is_pressed = scene.bodies.size() > 1 || !scene.springs.empty() || !scene.forces.empty();
    // The twin's largest depth in any plane so far, m, and the largest speed of sinking beyond the band, m a step.
    std::vector<double> sunk(scene.bodies.size()), sinks(scene.bodies.size());
    double spin = 0;
    for (std::size_t i = 0; i < run.moments.size(); ++i) {
        const auto now = moments_of(scene)[i];
        if (!run.troubles.empty() && run.troubles.front().step < now) return {};
        const double steps = static_cast<double>(now), band = depth * run.contact_tolerance;
        reference::Vector drift;
        double momentum = 0, mass = 0;
        for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
            const BodyDescription& body = scene.bodies[b];
            const Motion& m = run.moments[i].bodies[b];
            if (!(std::abs(m.q.norm2() - 1) <= 0x1p-5L)) return "\"" + body.name + "\" has no unit quaternion";
            drift = drift + *body.mass * (m.v - vector_of(body.velocity));
            momentum += *body.mass * length(m.v);
            mass += *body.mass;
            spin = std::max(spin, length(m.w));
            const bool is_known = body.shape.kind == ShapeKind::sphere || body.shape.kind == ShapeKind::box;
            if (scene.contact.response != ContactResponse::impulse || body.fixed || !is_known) continue;
            const Motion start{vector_of(body.position), {}, reference::rotation_of(body.orientation).normalized(), {}};
            if (is_pressed && i < twin.moments.size())
                for (const PlaneDescription& plane : scene.planes)
                    sunk[b] = std::max(sunk[b], depth_of(body, twin.moments[i].bodies[b], plane));
            sinks[b] = std::max(sinks[b], (sunk[b] - band) / steps);
            const double most =
                band + fall + reach(body) * spin * h + count * units[0] + 2 * std::max(sunk[b], sinks[b] * steps);
            for (const PlaneDescription& plane : scene.planes)
                if (const double deep = depth_of(body, m, plane);
                    deep > most && depth_of(body, start, plane) <= run.contact_tolerance)
                    return "\"" + body.name + "\" is " + few_digits(deep) + " m deep in \"" + plane.name + "\"";
        }
        if (is_alone && length(drift) > mass * unit(units, Measure::velocity) * (16 + steps) + 1e-5 * momentum)
            return "momentum drifts by " + few_digits(length(drift)) + " N s";
    }
    return {};
}

// The parts of a step in which fixed point rotates the fastest body, as Q32::Scale::of counts them for a momentum.
double most_parts(const Simulation& simulation) {
    const std::string_view range = simulation.range();
    const double spin = range == "near" ? NearRange::spin : range == "room" ? RoomRange::spin : FieldRange::spin;
    const double turn = std::ceil(std::log2(spin * static_cast<double>(simulation.step_length())));
    return std::exp2(std::clamp(3 + turn, 0.0, 6.0));
}

// Spins, rad/s, from which fixed point rotates each body in parts of a step, whose error is not that of f64.
std::vector<double> whole_step_spins(const SceneDescription& scene, const Method& method) {
    std::vector<double> spins(scene.bodies.size(), std::numeric_limits<double>::infinity());
    if (method.numbers != "q32") return spins;
    const auto simulation = make_simulation(scene, method.integrator, method.numbers, method.carry);
    const double parts = most_parts(*simulation);
    for (std::size_t b = 0; b < spins.size(); ++b) spins[b] = simulation->held_spin(static_cast<int>(b)) / parts;
    return spins;
}

// A run held against its twin in f64 and against jolted runs of that. `own`: jolted runs in its own numbers, whose
// distance from it is rounding, too; with them, what the contact band lets velocities differ by may move bodies apart
// from the start on. It ends where a body spins faster than `spins`.
Judgement hold(const Record& run, const Record& twin, const std::vector<Record>& jolts, const std::vector<Record>& own,
               const SceneDescription& scene, const Units& units, const std::vector<double>& spins) {
    const double h = scene.step.seconds(), speed = length(vector_of(scene.gravity)) * h;
    const bool bounces = scene.contact.response == ContactResponse::impulse;
    const std::vector<std::int64_t> moments = moments_of(scene);
    std::size_t count = std::min(twin.moments.size(), run.moments.size());
    for (const auto* records : {&jolts, &own})
        for (const Record& record : *records) count = std::min(count, record.moments.size());
    std::vector<Errors> magnified(scene.bodies.size(), {unit(units, Measure::position), unit(units, Measure::angle)});
    Judgement judgement;
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t b = 0; b < magnified.size(); ++b) {
            const double size = reach(scene.bodies[b]), way = twin.moments.back().way_m[b] + size;
            // A bounce within the contact band, or shorter than a step, may happen in another step or not at all.
            double band = bounces ? found * twin.contact_tolerance + speed * h : 0, angle = band / size;
            if (bounces && !own.empty()) {
                const double time = h * static_cast<double>(moments[i]);
                band += std::min(speed * time, useful * way);
                angle += std::min(speed / size * time, useful);
            }
            const Motion& motion = twin.moments[i].bodies[b];
            if (std::max(length(motion.w), length(run.moments[i].bodies[b].w)) > spins[b]) return judgement;
            for (const Record& jolt : jolts) magnified[b].see(motion, jolt.moments[i].bodies[b]);
            for (const Record& jolt : own) magnified[b].see(run.moments[i].bodies[b], jolt.moments[i].bodies[b]);
            const Errors bound{rounding_factor * magnified[b].position_m + band,
                               rounding_factor * magnified[b].orientation_rad + angle};
            if (bound.position_m > std::max(useful * way, 2 * band) ||
                bound.orientation_rad > std::max(useful, 2 * angle))
                return judgement;
            Errors off;
            off.see(motion, run.moments[i].bodies[b]);
            judgement.share = std::max({judgement.share, off.position_m / std::max(bound.position_m, 1e-300),
                                        off.orientation_rad / std::max(bound.orientation_rad, 1e-300)});
            if (judgement.share <= 1) continue;
            judgement.kind = Kind::wrong;
            judgement.what = "\"" + scene.bodies[b].name + "\" differs from f64 by " + few_digits(off.position_m) +
                             " m and " + few_digits(off.orientation_rad) + " rad after " + std::to_string(moments[i]) +
                             " steps; bounds: " + few_digits(bound.position_m) + " m, " +
                             few_digits(bound.orientation_rad) + " rad";
            return judgement;
        }
        judgement.compared = static_cast<double>(i + 1) / static_cast<double>(moments.size());
    }
    return judgement;
}

// A run against the verdict's references: in f64, and on joints, which are flown in as many parts of a step as they ask
// for. At a limit of that rounding decides.
Judgement hold_by_verdict(const SceneDescription& scene, const Method& method) {
    VerdictOptions options;
    options.tolerance = tolerance;
    options.most_references = 1;
    options.explains = false;
    const Verdict verdict = verdict_of(scene, method, options);
    Judgement judgement;
    judgement.compared = verdict.kind == Verdict::Kind::right ? 1 : verdict.time_s / scene.duration;
    if (verdict.kind != Verdict::Kind::wrong) return judgement;
    const auto size_of = [&](const Verdict& of) {
        return std::max(of.error.position_m / reach(scene.body(of.body)), of.error.orientation_rad);
    };
    judgement.what = method.numbers + ": " + sentence_of(verdict, scene, method);
    for (const int halvings : {2, 4, 6}) {
        SceneDescription finer = scene;
        finer.step = scaled(scene.step, -halvings);
        const Verdict of_finer = verdict_of(finer, method, options);
        if (of_finer.kind != Verdict::Kind::wrong || of_finer.time_s > verdict.time_s ||
            size_of(of_finer) <= shrinks * size_of(verdict))
            return judgement;
        judgement.what +=
            "; with the step halved " + std::to_string(halvings) + " times " + sentence_of(of_finer, finer, method);
    }
    judgement.kind = Kind::wrong;
    return judgement;
}

Judgement judge_scene(const Trial& trial) {
    const SceneDescription scene = read_scene_text(scene_text(trial.scene), trial.scene.name);
    const Method& method = trial.method;
    const auto run_of = [moments = moments_of(scene)](const SceneDescription& of, const Method& with) {
        return record_of(of, with, 0, moments, most_gain);
    };
    const Record run = run_of(scene, method);
    SceneDescription alike = scene;  // fixed point may widen the contact band
    alike.contact.tolerance = std::max(alike.contact.tolerance, run.contact_tolerance);
    const Method in_f64{method.integrator, "f64", false};
    const Record twin = run_of(alike, in_f64);
    const Units units = units_of(scene, method, twin);
    const double count = units_of_start + (method.carry ? 0 : units_of_step * static_cast<double>(scene.steps()));
    const std::string status = !run.troubles.empty()    ? run.troubles.front().issue
                               : !twin.troubles.empty() ? twin.troubles.front().issue
                                                        : std::string();

    if (const std::string law = broken_law(scene, run, twin, units, count); !law.empty()) return {Kind::wrong, law};
    if (method.carry && find_integrator(method.integrator).order > 1 && run.gained && !twin.gained && status.empty())
        return {Kind::wrong, "energy grows, in f64 it does not"};
    Judgement judgement;
    if ((method.numbers == "f64" && !method.carry) || !scene.joints.empty()) {
        judgement = status.empty() ? hold_by_verdict(scene, method) : Judgement{};
    } else {
        Random random(1);
        Units jolt = units;
        const auto jolts = [&](const std::vector<double>& factors, const Method& with) {
            std::vector<Record> records;
            for (const double factor : factors)
                records.push_back(run_of(jolted(alike, jolt, factor * count, random), with));
            return records;
        };
        const std::vector<double> spins = whole_step_spins(alike, method);
        judgement = hold(run, twin, jolts({1, 8}, in_f64), {}, alike, units, spins);
        if (judgement.kind == Kind::wrong) {
            if (method.numbers == "q32" && scene.contact.response == ContactResponse::impulse)
                jolt[static_cast<std::size_t>(Measure::velocity)] += unit_of_rows(alike, twin);
            const std::vector<Record> own = jolts({1, 8}, method);
            judgement = hold(run, twin, jolts({1, 1, 1, 1, 8, 8, 8, 64}, in_f64), own, alike, units, spins);
        }
    }
    if (judgement.kind == Kind::wrong) return judgement;
    judgement.kind = !status.empty() ? Kind::told : judgement.compared < 0.5 ? Kind::undecided : Kind::agrees;
    if (!status.empty()) judgement.what = status;
    return judgement;
}

}  // namespace

Judgement judge(const Trial& trial) {
    try {
        return judge_scene(trial);
    } catch (const SceneError& error) { return {Kind::refused, error.what()}; } catch (const UnsupportedScene& error) {
        return {Kind::refused, error.what()};
    } catch (const std::invalid_argument& error) {
        return {Kind::refused, error.what()};
    } catch (const std::exception& error) { return {Kind::wrong, error.what()}; }
}

}  // namespace tumble::test

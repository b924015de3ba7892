#include "judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <vector>

#include "../kernel/random.hpp"
#include "scene/data.hpp"
#include "scene/error.hpp"
#include "scene/reader.hpp"
#include "scene_text.hpp"
#include "simulation/simulation.hpp"
#include "tools/text.hpp"
#include "verdict/record.hpp"
#include "verdict/verdict.hpp"

namespace tumble::test {
namespace {

using namespace host;
using Kind = Judgement::Kind;
using reference::Motion, reference::Vector;

constexpr double rounding_factor = 32;
// Rounding of a start in units of the number system: of the start, of constants and of what a step makes of them.
constexpr double units_of_start = 4;
// Without residuals every step rounds by up to half a unit, and all may lean one way.
constexpr double units_of_step = 0.5;
// Parts of the motion beyond which a bound says nothing.
constexpr double useful = 0.1;
// Parts of the contact band to which an impact finds its time.
constexpr double found = 0x1p-4;
// Contact bands: how deep what touches may be.
constexpr double depth = 5;
// Growth of energy in parts of the largest kinetic energy that no load explains.
constexpr double most_gain = 1;
// Error of a run in f64, rad or in parts of the way, from which on it is to shrink with the step.
constexpr double tolerance = 0.01;
constexpr int halvings = 2;
constexpr double shrinks = 0.5;

// The rounding of each quantity, SI units; of a factor, relative.
struct Units {
    double position, velocity, spin, angle, factor;
};
Units units_of(const SceneDescription& scene, const Trial& trial, const Record& twin) {
    const Method& method = trial.method;
    double smallest = std::numeric_limits<double>::infinity();
    for (const BodyDescription& body : scene.bodies) smallest = std::min(smallest, reach(body));
    Units units{};
    if (method.numbers == "q32") {
        const RangeDescription range = held_by(find_number_system(scene, method.numbers, method.carry).range);
        const bool has_contacts = scene.contact.response != ContactResponse::none;
        units = {range.position * 0x1p-30, range.velocity * 0x1p-29,
                 std::min(range.angular_velocity, 0.5 / scene.step.seconds()) * 0x1p-29, 0x1p-30,
                 has_contacts ? 0x1p-24 : 0x1p-29};  // arms of contact points have 24 bits
        if (has_contacts) units.angle = units.factor;
    } else {
        const double last_place = method.numbers == "f64" ? 0x1p-52 : 0x1p-23;
        Vector most;
        for (const Moment& moment : twin.moments) {
            for (const Motion& m : moment.bodies) {
                most.x = std::max(most.x, norm(m.x));
                most.y = std::max(most.y, norm(m.v));
                most.z = std::max(most.z, norm(m.w));
            }
        }
        most = most * static_cast<reference::Number>(last_place);
        units = {static_cast<double>(most.x), static_cast<double>(most.y), static_cast<double>(most.z), last_place,
                 last_place};
    }
    // A load at a point or a contact turns the rounding of velocities into spin.
    units.spin += units.velocity / smallest;
    return units;
}

// The scene with all its numbers off by up to `count` units.
SceneDescription jolted(SceneDescription scene, const Units& units, double count, Random& random) {
    for_each_number(scene, [&](double& x, Quantity quantity) {
        const double off = count * random.uniform(-1, 1);
        switch (quantity) {
        case Quantity::position: x += off * units.position; break;
        case Quantity::velocity: x += off * units.velocity; break;
        case Quantity::angle: x += off * units.angle; break;
        case Quantity::spin: x += off * units.spin; break;
        case Quantity::factor: x *= 1 + off * units.factor; break;
        }
    });
    scene.contact.restitution = std::min(scene.contact.restitution, 1.0);
    for (BodyDescription& body : scene.bodies) {
        if (body.fixed) body.velocity = {};
        if (body.is_point_mass()) body.orientation = {1, 0, 0, 0}, body.angular_velocity = {};
    }
    return scene;
}

// --- laws ------------------------------------------------------------------------------------------------------------

bool is_isolated(const SceneDescription& scene) {
    return scene.impulses.empty() && scene.forces.empty() && scene.planes.empty() && scene.gravity == Triple{} &&
           scene.linear_drag == 0 && !scene.contact.sleep &&
           std::none_of(scene.bodies.begin(), scene.bodies.end(), [](const auto& b) { return b.fixed; }) &&
           std::all_of(scene.springs.begin(), scene.springs.end(), [](const auto& s) { return s.to_body >= 0; });
}

// Above a plane, m, the lowest point of a sphere or a box.
double height(const BodyDescription& body, const Motion& m, const PlaneDescription& plane) {
    const Vector normal = reference::vector_of(plane.normal), n = normal * (1 / norm(normal));
    return static_cast<double>(dot(n, m.x) + plane.offset - half_extent(body, m.q.normalized(), n));
}

// The law that a run breaks before it has a status, or nothing.
std::string broken_law(const SceneDescription& scene, const Record& run, const Units& units) {
    const double h = scene.step.seconds(), fall = static_cast<double>(norm(reference::vector_of(scene.gravity)));
    std::vector<Motion> start;
    for (const BodyDescription& b : scene.bodies)
        start.push_back({reference::vector_of(b.position), reference::vector_of(b.velocity),
                         reference::rotation_of(b.orientation).normalized(), reference::vector_of(b.angular_velocity)});
    double steps = 0, spin = 0;
    for (const Moment& moment : run.moments) {
        steps += static_cast<double>(scene.steps()) / sample_count;
        Vector drift;
        double momentum = 0, mass = 0;
        for (std::size_t b = 0; b < moment.bodies.size(); ++b) {
            const BodyDescription& body = scene.bodies[b];
            const Motion& m = moment.bodies[b];
            if (!(std::abs(m.q.norm2() - 1) <= 0x1p-5L))
                return "\"" + body.name + "\" has a quaternion of length " + few_digits(std::sqrt(m.q.norm2()));
            drift = drift + *body.mass * (m.v - start[b].v);
            momentum += *body.mass * static_cast<double>(norm(m.v));
            mass += *body.mass;
            spin = std::max(spin, static_cast<double>(norm(m.w)));
            const bool is_held = body.shape.kind == ShapeKind::sphere || body.shape.kind == ShapeKind::box;
            if (scene.contact.response != ContactResponse::impulse || body.fixed || !is_held) continue;
            for (const PlaneDescription& plane : scene.planes) {
                // What a step moves beside the straight line is not seen within it.
                const double unseen = fall * h * h / 4 + reach(body) * spin * h + units.position;
                const double deepest = depth * run.contact_tolerance + unseen;
                if (height(body, start[b], plane) >= -run.contact_tolerance && height(body, m, plane) < -deepest)
                    return "\"" + body.name + "\" is " + few_digits(-height(body, m, plane)) + " m deep in \"" +
                           plane.name + "\"";
            }
        }
        if (is_isolated(scene) &&
            static_cast<double>(norm(drift)) > mass * units.velocity * (16 + steps) + 1e-5 * momentum)
            return "momentum drifts by " + few_digits(norm(drift)) + " N s";
    }
    return {};
}

// --- the comparison with double precision ----------------------------------------------------------------------------

struct Bound {
    double position = 0, angle = 0;

    void see(const Motion& one, const Motion& other) {
        position = std::max(position, static_cast<double>(norm(one.x - other.x)));
        angle = std::max(angle, static_cast<double>(angle_between(one.q, other.q)));
    }
};

class Comparison {
public:
    Comparison(const SceneDescription& scene, const Units& units, const Record& twin)
        : scene_(scene), units_(units), twin_(twin) {}

    // `forks`: what the contact band lets velocities differ by may move bodies apart from the start on.
    [[nodiscard]] Judgement hold(const Record& run, const std::vector<Record>& jolts, bool forks) const {
        std::size_t count = std::min(twin_.moments.size(), run.moments.size());
        for (const Record& jolt : jolts) count = std::min(count, jolt.moments.size());
        Judgement judgement;
        std::vector<Bound> magnified(scene_.bodies.size());
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t b = 0; b < magnified.size(); ++b) {
                for (const Record& jolt : jolts)
                    magnified[b].see(twin_.moments[i].bodies[b], jolt.moments[i].bodies[b]);
                const Bound bound = bound_of(magnified[b], b, i, forks);
                if (bound.position > std::max(useful * way(b), 2 * bound_of({}, b, i, false).position) ||
                    bound.angle > std::max(useful, 2 * bound_of({}, b, i, false).angle))
                    return judgement;
                Bound off;
                off.see(twin_.moments[i].bodies[b], run.moments[i].bodies[b]);
                const double share = std::max(off.position / bound.position, off.angle / bound.angle);
                judgement.share = std::max(judgement.share, share);
                if (share <= 1) continue;
                judgement.kind = Kind::wrong;
                judgement.what = "\"" + scene_.bodies[b].name + "\" differs from f64 by " + few_digits(off.position) +
                                 " m and " + few_digits(off.angle) + " rad at sample " + std::to_string(i + 1) +
                                 "; bounds: " + few_digits(bound.position) + " m, " + few_digits(bound.angle) + " rad";
                return judgement;
            }
            judgement.compared = static_cast<double>(i + 1) / static_cast<double>(moments_of(scene_).size());
        }
        return judgement;
    }

private:
    // m: how far the body moves in the run, and its size.
    [[nodiscard]] double way(std::size_t b) const { return twin_.moments.back().way_m[b] + reach(scene_.bodies[b]); }

    // A bounce within the contact band, or shorter than a step, may happen in another step or not at all.
    [[nodiscard]] Bound bound_of(const Bound& magnified, std::size_t b, std::size_t i, bool forks) const {
        const double size = reach(scene_.bodies[b]), h = scene_.step.seconds();
        Bound band;
        if (scene_.contact.response == ContactResponse::impulse) {
            const double speed = static_cast<double>(norm(reference::vector_of(scene_.gravity))) * h / 2;
            band.position = found * twin_.contact_tolerance + 2 * speed * h;
            band.angle = band.position / size;
            if (forks) {
                const double time = h * static_cast<double>(moments_of(scene_)[i]);
                band.position += std::min(speed * time, useful / 2 * way(b));
                band.angle += std::min(speed / size * time, useful / 2);
            }
        }
        return {rounding_factor * std::max(magnified.position, units_.position) + band.position,
                rounding_factor * std::max(magnified.angle, units_.angle) + band.angle};
    }

    const SceneDescription& scene_;
    const Units& units_;
    const Record& twin_;
};

// --- the judgement ---------------------------------------------------------------------------------------------------

std::string status_of(const Record& run) { return run.troubles.empty() ? "" : run.troubles.front().issue; }

// A run in f64 against the verdict's references.
Judgement against_references(const SceneDescription& scene, const Method& method) {
    VerdictOptions options;
    options.tolerance = tolerance;
    options.explains = false;
    options.most_references = 1;
    const Verdict verdict = verdict_of(scene, method, options);
    Judgement judgement;
    judgement.compared = verdict.kind == Verdict::Kind::right ? 1 : verdict.time_s / scene.duration;
    if (verdict.kind == Verdict::Kind::no_reference && judgement.compared < 0.5) judgement.kind = Kind::undecided;
    if (verdict.kind != Verdict::Kind::wrong) return judgement;
    SceneDescription finer = scene;
    finer.step = scaled(scene.step, -halvings);
    const Verdict of_finer = verdict_of(finer, method, options);
    const auto size_of = [&](const Verdict& of) {
        return std::max(of.error.position_m / reach(scene.body(of.body)), of.error.orientation_rad);
    };
    const bool is_wrong = of_finer.kind == Verdict::Kind::wrong && of_finer.time_s <= verdict.time_s &&
                          size_of(of_finer) > shrinks * size_of(verdict);
    if (!is_wrong) { if(getenv("ALL")) judgement.what = "truncation"; return judgement; }
    judgement.kind = Kind::wrong;
    judgement.what = "f64: " + sentence_of(verdict, scene, method) + "; at an eighth of the step " +
                     sentence_of(of_finer, finer, method);
    return judgement;
}

Judgement judge_scene(const Trial& trial) {
    const SceneDescription scene = read_scene_text(scene_text(trial.scene), trial.scene.name);
    const std::vector<std::int64_t> moments = moments_of(scene);
    const Method twin_method{trial.method.integrator, "f64", false};
    const auto run_of = [&](const SceneDescription& of, const Method& method) {
        return record_of(of, method, 0, moments, ProcessorTime{}, most_gain);
    };
    const Record run = run_of(scene, trial.method);
    // Fixed point may widen the contact band.
    SceneDescription alike = scene;
    alike.contact.tolerance = std::max(alike.contact.tolerance, run.contact_tolerance);
    const Record twin = run_of(alike, twin_method);
    const Units units = units_of(scene, trial, twin);

    Judgement judgement;
    const bool is_base = trial.method.numbers == "f64" && !trial.method.carry;
    const std::string law = broken_law(scene, run, units);
    if (!law.empty() || (run.gained && !twin.gained && twin.troubles.empty() && run.troubles.empty())) {
        judgement.kind = Kind::wrong;
        judgement.what = law.empty() ? "energy grows, in f64 it does not" : law;
        return judgement;
    }
    if (is_base) {
        judgement = against_references(scene, trial.method);
    } else {
        Random random(1);
        std::vector<Record> jolts;
        const double count =
            units_of_start + (trial.method.carry ? 0 : units_of_step * static_cast<double>(scene.steps()));
        const auto jolt = [&](std::initializer_list<double> factors) {
            for (const double factor : factors)
                jolts.push_back(run_of(jolted(alike, units, factor * count, random), twin_method));
        };
        const Comparison comparison(alike, units, twin);
        jolt({1, 1, 8});
        judgement = comparison.hold(run, jolts, false);
        if (judgement.kind == Kind::wrong) {
            jolt({1, 1, 1, 1, 1, 8, 8, 8, 64});
            judgement = comparison.hold(run, jolts, true);
        }
    }
    if (judgement.kind == Kind::wrong) return judgement;
    const std::string status = status_of(run).empty() ? status_of(twin) : status_of(run);
    if (!status.empty()) judgement.kind = Kind::told, judgement.what = status;
    else if (judgement.compared < 0.5) judgement.kind = Kind::undecided;
    return judgement;
}

}  // namespace

Judgement judge(const Trial& trial) {
    Judgement judgement;
    try {
        return judge_scene(trial);
    } catch (const SceneError& error) {
        judgement = {Kind::refused, error.what()};
    } catch (const UnsupportedScene& error) {
        judgement = {Kind::refused, error.what()};
    } catch (const std::invalid_argument& error) {
        judgement = {Kind::refused, error.what()};
    } catch (const std::exception& error) { judgement = {Kind::wrong, error.what()}; }
    return judgement;
}

}  // namespace tumble::test

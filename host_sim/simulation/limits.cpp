#include "simulation/limits.hpp"

#include <tumble/body/mass.hpp>
#include <tumble/shapes/shape.hpp>
#include <tumble/status.hpp>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "scene/data.hpp"
#include "scene/reader.hpp"
#include "simulation/motion_of.hpp"
#include "simulation/number_systems.hpp"
#include "simulation/simulation.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

using reference::Number;
using reference::Rotation;
using reference::Vector;

// Of the energy that a method adds to an oscillation in the whole run; less is not told.
constexpr double most_growth = 1.1;
// A safe step is this share of the longest stable one, where an oscillation may swing to a multiple of its size.
constexpr double safe_share = 0.9;
// Of what floats hold of a place, how deep contact springs are to be pressed.
constexpr double least_depth = 16;

// Mass properties and pose at the start, in principal axes.
struct Body {
    Number mass;
    PrincipalAxes axes;
    Rotation pose;  // principal axes to the world
    bool rotates;

    explicit Body(const BodySpec& spec)
        : mass{number(spec.mass)}, axes{principal_inertia(spec.inertia)},
          pose{rotation(spec.orientation).normalized() * axes.to_user}, rotates{!is_point_mass(spec)} {}
    // m, principal axes, of a point in the user's.
    [[nodiscard]] Vector arm(const RealVec3& point) const { return axes.to_user.rotate_back(vector(point)); }
};

// x'' = -stiffness x - damping x'.
struct Mode {
    double stiffness = 0;  // 1/s^2
    double damping = 0;    // 1/s
    std::string where, what;
    bool is_known_to_kernel = true;  // which tells of steps beyond the bounds of its method

    [[nodiscard]] OscillatorStep step_of(const IntegratorInfo& method, double h) const {
        return method.oscillator_step(h * h * stiffness, h * damping);
    }
};

// ln of what a step multiplies the amplitude with at most.
double log_radius(const OscillatorStep& step) {
    // (trace / 2)^2 - determinant, without cancellation
    const double half = (step.xx - step.vv) / 2, square = half * half + step.xv * step.vx;
    if (square < 0) return std::log(step.determinant()) / 2;
    return std::log(std::abs(step.trace()) / 2 + std::sqrt(square));
}
// True of what the kernel tells of as step_too_long.
bool is_told(const StepBounds& bounds, double k, double c) {
    for (int i = 0; i < StepBounds::sums; ++i)
        if (bounds.of_spring[i] * k + bounds.of_damper[i] * c > 1) return true;
    return false;
}
// True if the mode's energy does not grow by more than most_growth in the time, s, and nothing is told of it.
bool holds(const IntegratorInfo& method, const Mode& mode, double h, double time) {
    if (mode.is_known_to_kernel && is_told(method.step_bounds, h * h * mode.stiffness, h * mode.damping)) return false;
    // Some methods are stable again in a window beyond the limit, which no motion that is not linear stays in.
    if (mode.damping == 0 && method.oscillation_limit > 0 && h * std::sqrt(mode.stiffness) > method.oscillation_limit)
        return false;
    const double growth = 2 * std::max(1.0, time / h) * log_radius(mode.step_of(method, h));
    return growth <= std::log(most_growth);
}
// The longest step, s, with which the mode holds, from one with which it does not.
double longest_step(const IntegratorInfo& method, const Mode& mode, double too_long, double time) {
    double good = too_long / 2, bad = too_long;
    while (good > 0 && !holds(method, mode, good, time)) bad = std::exchange(good, good / 2);
    for (int halving = 0; halving < 50; ++halving) {
        const double middle = (good + bad) / 2;
        (holds(method, mode, middle, time) ? good : bad) = middle;
    }
    // What grows at every step does so more slowly the shorter it is; elsewhere growth begins all at once.
    return method.oscillation_limit > 0 ? safe_share * good : good;
}

// The linear oscillations about the start of all bodies that springs hold, with drag: the eigenvectors of stiffness, of
// damping, both per mass, and of the sums of both that the kernel looks at.
class SpringModes {
public:
    SpringModes(const SceneData& scene, const std::vector<Body>& bodies) : scene_{scene}, bodies_{bodies} {
        for (const SpringSpec& spring : scene.springs) {
            give_room(spring.body);
            give_room(spring.to_body);
        }
        const Eigen::Index n = size_;
        stiffness_ = damping_ = drag_ = Eigen::MatrixXd::Zero(n, n);
        for (const SpringSpec& spring : scene.springs) add(spring);
        for (const auto& [b, first] : first_) {
            const Body& body = bodies_[static_cast<std::size_t>(b)];
            for (int i = 0; i < 3; ++i) {
                drag_(first + i, first + i) = static_cast<double>(number(scene.world.linear_drag) / body.mass);
                if (body.rotates)
                    drag_(first + 3 + i, first + 3 + i) =
                        static_cast<double>(number(scene.world.angular_drag) / body.axes.moments[i]);
            }
        }
    }

    [[nodiscard]] bool holds(int body) const { return first_.count(body) > 0; }
    [[nodiscard]] std::vector<Mode> modes(const SceneDescription& names, const StepBounds& bounds, double step) const {
        std::vector<Mode> modes;
        if (size_ == 0) return modes;
        const Eigen::MatrixXd all_damping = damping_ + drag_;
        const auto axes_of = [](const Eigen::MatrixXd& matrix) -> Eigen::MatrixXd {
            return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvectors();
        };
        for (const Eigen::MatrixXd* matrix : {&stiffness_, &all_damping}) {
            if (matrix->isZero(0)) continue;
            const Eigen::MatrixXd axes = axes_of(*matrix);
            for (Eigen::Index k = 0; k < size_; ++k) modes.push_back(mode_along(axes.col(k), all_damping, names));
        }
        if (damping_.isZero(0) && drag_.isZero(0)) return modes;
        for (int i = 0; i < StepBounds::sums; ++i) {
            const Eigen::MatrixXd axes =
                axes_of(bounds.of_spring[i] * step * step * stiffness_ + bounds.of_damper[i] * step * all_damping);
            modes.push_back(mode_along(axes.col(size_ - 1), all_damping, names));
        }
        return modes;
    }

private:
    void give_room(int b) {
        if (b < 0 || scene_.bodies[static_cast<std::size_t>(b)].fixed || !first_.emplace(b, size_).second) return;
        size_ += bodies_[static_cast<std::size_t>(b)].rotates ? 6 : 3;
    }

    // One end of a spring: how it moves with the coordinates of its body, each divided by the root of its mass.
    struct End {
        Vector place{};
        Eigen::Matrix<double, 3, Eigen::Dynamic> moves;
        Vector arm{};  // principal axes
        const Body* body = nullptr;
        Eigen::Index first = -1;
    };
    [[nodiscard]] End end_of(int b, const RealVec3& point, double sign) const {
        End end;
        end.moves.setZero(3, size_);
        if (b < 0) {
            end.place = vector(point);
            return end;
        }
        const auto index = static_cast<std::size_t>(b);
        const Body& body = bodies_[index];
        if (body.rotates) end.arm = body.arm(point);
        end.place = vector(scene_.bodies[index].position) + body.pose.rotate(end.arm);
        if (!holds(b)) return end;
        end.body = &body;
        end.first = first_.at(b);
        for (int i = 0; i < 3; ++i) {
            end.moves(i, end.first + i) = sign / std::sqrt(static_cast<double>(body.mass));
            if (!body.rotates) continue;
            Vector axis;
            axis[i] = 1;
            const Vector moved = body.pose.rotate(cross(axis, end.arm)) * (sign / std::sqrt(body.axes.moments[i]));
            for (int k = 0; k < 3; ++k) end.moves(k, end.first + 3 + i) = static_cast<double>(moved[k]);
        }
        return end;
    }
    void add(const SpringSpec& spring) {
        const End from = end_of(spring.body, spring.point, -1), to = end_of(spring.to_body, spring.to, 1);
        const Vector reach = to.place - from.place;
        const Number length = norm(reach), k = number(spring.stiffness), rest = number(spring.rest_length);
        // Without a length every direction may become the spring's.
        const Vector along = length > 0 ? reach * (1 / length) : Vector{};
        const Number across = length > 0 ? k * (1 - rest / length) : k, force = k * (length - rest);
        const Eigen::Vector3d n(static_cast<double>(along.x), static_cast<double>(along.y),
                                static_cast<double>(along.z));
        const Eigen::MatrixXd moves = from.moves + to.moves;
        const Eigen::RowVectorXd stretch = n.transpose() * moves;
        Eigen::MatrixXd own = static_cast<double>(across) * moves.transpose() * moves +
                              static_cast<double>(k - across) * stretch.transpose() * stretch;
        // A pull on an arm turns the body back as it does a pendulum.
        for (const End* end : {&from, &to}) {
            if (end->body == nullptr || !end->body->rotates) continue;
            const Number pull = end == &from ? -force : force;
            const Vector n_b = end->body->pose.rotate_back(along), &p = end->arm;
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j) {
                    const Number turn = (p[i] * n_b[j] + p[j] * n_b[i]) / 2 - (i == j ? dot(p, n_b) : 0);
                    own(end->first + 3 + i, end->first + 3 + j) += static_cast<double>(
                        pull * turn / std::sqrt(end->body->axes.moments[i] * end->body->axes.moments[j]));
                }
            }
        }
        stiffness_ += own;
        of_spring_.push_back(std::move(own));
        of_damper_.push_back(static_cast<double>(number(spring.damping)) * stretch.transpose() * stretch);
        damping_ += of_damper_.back();
    }

    [[nodiscard]] Mode mode_along(const Eigen::VectorXd& axis, const Eigen::MatrixXd& all_damping,
                                  const SceneDescription& names) const {
        const auto share = [&](const Eigen::MatrixXd& matrix) { return axis.dot(matrix * axis); };
        Mode mode{std::max(0.0, share(stiffness_)), std::max(0.0, share(all_damping)), "", ""};
        double most = 0;
        const auto claim = [&](double part, const std::string& where, const char* what) {
            if (part > most) {
                most = part;
                mode.where = where;
                mode.what = what;
            }
        };
        for (std::size_t s = 0; s < of_spring_.size(); ++s) {
            const std::string where = "spring[" + std::to_string(s) + "]";
            claim(std::sqrt(std::max(0.0, share(of_spring_[s]))), where, "spring");
            claim(share(of_damper_[s]), where, "damper");
        }
        for (const auto& [b, first] : first_) {
            const Eigen::Index room = bodies_[static_cast<std::size_t>(b)].rotates ? 6 : 3;
            const auto part = axis.segment(first, room);
            claim(part.dot(drag_.block(first, first, room, room) * part), "body \"" + names.body(b).name + "\"",
                  "drag");
        }
        return mode;
    }

    const SceneData& scene_;
    const std::vector<Body>& bodies_;
    std::map<int, Eigen::Index> first_;  // of a body's coordinates: three of translation, three of rotation
    Eigen::Index size_ = 0;
    Eigen::MatrixXd stiffness_, damping_, drag_;
    std::vector<Eigen::MatrixXd> of_spring_, of_damper_;
};

// What an index of the list of number systems holds of a velocity, m/s, and of a half turn, rad a step, at a step of
// `step` s; infinite in floating point.
struct Held {
    double velocity = std::numeric_limits<double>::infinity(), half_turn = velocity;
};
Held held_by(std::size_t system, Real step, Spin spin) {
    Held held;
    std::size_t index = 0;
    const auto look = [&]<class N>(const System<N>&) {
        if (index++ != system) return;
        if constexpr (N::fixed_point) {
            const auto scale = N::Scale::of(step, turn_per_spin(spin, step));
            held = {static_cast<double>(number(scale.metres(N::largest_drift) / step)),
                    static_cast<double>(number(scale.angle(N::largest_turn)))};
        }
    };
    std::apply([&](const auto&... systems) { (look(systems), ...); }, number_system_list);
    return held;
}

// Two bodies that nothing but each other's gravitation moves, as they begin.
struct Pair {
    double strength;          // G (m1 + m2), of what moves; m^3/s^2
    double distance;          // m, at the start
    double least_distance;    // m, in the whole run
    double motion = 0;        // 1/s: mean motion of an ellipse
    double eccentricity = 0;  // of an ellipse
    double kinetic = 0;       // energy there, of an ellipse, in parts of what binds them
};

// Kepler's motion from the relative place and velocity: how close they come within the time.
Pair two_bodies(double strength, const Vector& reach, const Vector& velocity, double time) {
    const auto distance = static_cast<double>(norm(reach));
    Pair pair{strength, distance, distance};
    if (!(distance > 0)) return pair;
    const auto speed2 = static_cast<double>(dot(velocity, velocity)),
               inwards = -static_cast<double>(dot(reach, velocity));
    const Vector turning = cross(reach, velocity);
    const double energy = speed2 / 2 - strength / distance, area2 = static_cast<double>(dot(turning, turning)),
                 axis = -strength / (2 * energy), e = std::sqrt(std::max(0.0, 1 - area2 / (strength * axis)));
    if (!std::isfinite(axis) || (energy >= 0 && e - 1 < 1e-12)) return pair;
    const double n = std::sqrt(strength / std::abs(axis * axis * axis)), closest = area2 / (strength * (1 + e));
    // Mean anomaly before the closest point; an ellipse comes round again.
    double before = 0;
    // The distance at the end, where the mean anomaly of size `left` is anomaly - e sin(anomaly), or that of a
    // hyperbola.
    const auto distance_at = [&](double left) {
        const auto mean = [&](double anomaly) {
            return energy < 0 ? anomaly - e * std::sin(anomaly) : e * std::sinh(anomaly) - anomaly;
        };
        double less = 0, more = std::numbers::pi;
        while (mean(more) < left) more *= 2;
        for (int halving = 0; halving < 60; ++halving) {
            const double middle = (less + more) / 2;
            (mean(middle) < left ? less : more) = middle;
        }
        return axis * (1 - e * (energy < 0 ? std::cos(less) : std::cosh(less)));
    };
    if (energy < 0) {
        pair.motion = n;
        pair.eccentricity = e;
        const double anomaly = std::acos(std::clamp((1 - distance / axis) / (e > 0 ? e : 1), -1.0, 1.0)),
                     mean = anomaly - e * std::sin(anomaly);
        before = inwards > 0 ? mean : 2 * std::numbers::pi - mean;
    } else {
        if (inwards <= 0) return pair;
        const double anomaly = std::acosh(std::max(1.0, (1 - distance / axis) / e));
        before = e * std::sinh(anomaly) - anomaly;
    }
    pair.least_distance = before <= n * time ? closest : std::min(distance, distance_at(before - n * time));
    if (energy < 0) pair.kinetic = std::max(0.0, 2 * axis / pair.least_distance - 1);
    return pair;
}

// m: of a shape no point is farther from its centre than `most`, and all that are nearer than `least` are of it.
struct Reach {
    Number least = 0, most = 0;

    explicit Reach(const Shape& shape) {
        const Vector size = vector(shape.size);
        switch (shape.kind) {
        case ShapeKind::box:
            least = std::min({size.x, size.y, size.z}) / 2;
            most = norm(size) / 2;
            break;
        case ShapeKind::cylinder:
            least = std::min(size.x, size.y / 2);
            most = std::hypot(size.x, size.y / 2);
            break;
        case ShapeKind::capsule:
            least = size.x;
            most = size.x + size.y / 2;
            break;
        case ShapeKind::sphere: least = most = size.x; break;
        case ShapeKind::hoop: most = size.x; break;
        case ShapeKind::points:
        case ShapeKind::none: break;
        }
    }
};

// m: of the box around it.
Vector half_extents(const Shape& shape) {
    const Vector size = vector(shape.size);
    switch (shape.kind) {
    case ShapeKind::box: return size * Number(0.5);
    case ShapeKind::cylinder: return {size.x, size.x, size.y / 2};
    case ShapeKind::capsule: return {size.x, size.x, size.y / 2 + size.x};
    case ShapeKind::sphere: return {size.x, size.x, size.x};
    case ShapeKind::hoop: return {size.x, size.x, 0};
    case ShapeKind::points:
    case ShapeKind::none: break;
    }
    return {};
}

class Search {
public:
    Search(const SceneDescription& scene, std::string_view integrator, std::string_view numbers,
           std::optional<bool> carry)
        : scene_{scene}, data_{build_scene(scene)}, method_{find_integrator(integrator)}, system_{find_number_system(
                                                                                              scene, numbers, carry)},
          step_{static_cast<double>(number(data_.step.value))}, duration_{scene.duration} {
        for (const BodySpec& spec : data_.bodies) bodies_.emplace_back(spec);
    }

    [[nodiscard]] std::vector<Limit> run() {
        const SpringModes springs(data_, bodies_);
        for (const Mode& mode : springs.modes(scene_, method_.step_bounds, step_)) look_at(mode);
        look_at_reports_of_springs();
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            if (data_.bodies[b].fixed || springs.holds(static_cast<int>(b))) continue;
            const std::string where = body(b);
            const auto per = [](Real drag, Number inertia) { return static_cast<double>(number(drag) / inertia); };
            look_at({0, per(data_.world.linear_drag, bodies_[b].mass), where, "drag"});
            if (bodies_[b].rotates)
                look_at({0, per(data_.world.angular_drag, bodies_[b].axes.moments.z), where, "drag"});
        }
        for (std::size_t b = 0; b < bodies_.size(); ++b) look_at_contact_springs(b);
        look_at_gravitation();
        for (std::size_t b = 0; b < bodies_.size(); ++b) look_at_swings(b);
        for (std::size_t b = 0; b < bodies_.size(); ++b) look_at_spin(b);
        for (std::size_t b = 0; b < bodies_.size(); ++b) look_at_impacts(b);
        look_at_range();
        look_at_gravity();
        for (std::size_t b = 0; b < bodies_.size(); ++b) look_at_forces(b);
        look_at_masses();
        for (std::size_t b = 0; b < bodies_.size(); ++b) look_at_place(b);
        for (std::size_t b = 0; b < bodies_.size(); ++b) look_at_place_on_contact_springs(b);
        return std::move(found_);
    }

private:
    // The worst of each place and kind is kept.
    void tell(Limit limit) {
        const auto known = std::find_if(found_.begin(), found_.end(), [&](const Limit& other) {
            return other.where == limit.where && other.what == limit.what;
        });
        if (known == found_.end()) found_.push_back(std::move(limit));
        else if (limit.largest_step < known->largest_step) *known = std::move(limit);
    }

    void look_at(const Mode& mode) {
        if (holds(method_, mode, step_ / safe_share, duration_)) return;
        const double most = longest_step(method_, mode, step_ / safe_share, duration_);
        if (!(most < step_ * (1 - 1e-9))) return;  // but for the rounding of the search
        const bool is_spring = mode.what != "damper" && mode.what != "drag";
        const double per_step = is_spring ? std::sqrt(mode.stiffness) : mode.damping;
        const double known = is_spring ? method_.oscillation_limit : method_.drag_limit;
        const bool damped = is_spring ? mode.damping > 0 : mode.stiffness > 0;
        const double longest = method_.oscillation_limit > 0 ? most / safe_share : most;
        Limit limit{mode.where, mode.what, per_step * step_, damped || known == 0 ? per_step * longest : known,
                    most,       ""};
        const std::string ratio = is_spring ? "h w" : mode.what == "drag" ? "h c/m" : "h c/m of the damper";
        limit.sentence = limit.where + ": " + step_and(ratio + " " + few_digits(limit.value)) + ", and " + method_.name;
        if (known == 0 && is_spring)
            limit.sentence += " adds to an oscillation at every step, here more than " +
                              few_digits(100 * (most_growth - 1)) + " % in " + few_digits(duration_) + " s" +
                              (mode.what == "contact spring" ? " of contact" : "");
        else
            limit.sentence += " is stable up to " + four_digits_down(limit.limit) +
                              (limit.value < limit.limit ? ", of which nine tenths are safe" : "");
        tell(std::move(limit));
    }

    // The kernel looks at springs one after another, in the order of the file, and takes them to be stretched: what it
    // reports when they are added, where nothing else is told of them.
    void look_at_reports_of_springs() {
        if (!found_.empty() || data_.springs.empty()) return;
        const auto report_at = [&](double step) -> std::optional<Trouble> {
            SceneDescription scene = scene_;
            scene.step = {1, 0, step};
            scene.duration = 0;
            const auto simulation = make_simulation(scene, method_.name, system_.name, system_.carry);
            for (const Trouble& trouble : simulation->troubles())
                if (trouble.issue == name_of(Issue::step_too_long)) return trouble;
            return {};
        };
        const auto report = report_at(step_);
        if (!report) return;
        double good = step_ / 2, bad = step_;
        while (good > 0 && report_at(good)) bad = std::exchange(good, good / 2);
        for (int halving = 0; halving < 8; ++halving) {
            const double middle = (good + bad) / 2;
            (report_at(middle) ? bad : good) = middle;
        }
        Limit limit{body(static_cast<std::size_t>(report->body)), "spring", step_, good, safe_share * good, ""};
        limit.sentence = limit.where + ": " + step_and("its springs too stiff, each with those before it");
        tell(std::move(limit));
    }

    // rad in a step: beyond it the energy or the quaternion's length is wrong by the maps of stability.
    [[nodiscard]] double most_turn() const {
        return method_.spin == Spin::angular_momentum ? 1.5 : method_.order > 1 ? 0.45 : 0.2;
    }
    [[nodiscard]] std::string body(std::size_t b) const { return "body \"" + scene_.bodies[b].name + "\""; }
    // "verlet in q32 near"
    [[nodiscard]] std::string way() const {
        return method_.name + " in " + system_.name + (system_.range.empty() ? "" : " ") + system_.range;
    }
    [[nodiscard]] std::string step_and(const std::string& makes) const {
        return "a step of " + few_digits(step_) + " s makes " + makes;
    }

    // Bodies that fall around each other: h w with w^2 = G (m1 + m2) / r^3. Past 1 no method follows the closest
    // approach. On an ellipse what goes wrong there counts against what binds them, of which the kinetic energy at the
    // closest point is (1 + e) / (1 - e): the maps of stability show orbits changed by as much as their energy from
    // (h w)^2 times that ratio of 1.6 on, with the methods of order 1, and up to 20 with suzuki4. Half of the limit
    // keeps the energy.
    void look_at_gravitation() {
        constexpr double closest = 1, most_of_binding = 1.5;
        if (!(data_.world.gravitation > Real{})) return;
        for (std::size_t b = 1; b < bodies_.size(); ++b) {
            for (std::size_t a = 0; a < b; ++a) {
                if (data_.bodies[a].fixed && data_.bodies[b].fixed) continue;
                const Pair pair = pair_of(a, b);
                if (!(pair.distance > 0)) continue;
                const std::string where = body(a) + " and " + body(b);
                const double w = std::sqrt(pair.strength / std::pow(pair.least_distance, 3)), e = pair.eccentricity;
                // w^2 in the mean over a turn, which is no more than it is where they are closest.
                const double mean = std::min(w * w, pair.motion * pair.motion * std::pow(1 - e * e, -1.5));
                if (mean > 0 && std::isfinite(mean) && method_.oscillation_limit == 0)
                    look_at({mean, 0, where, "gravitation"});
                const double most = std::min(closest, std::sqrt(most_of_binding / pair.kinetic));
                if (!(w * step_ > most)) continue;
                Limit limit{where, "gravitation", w * step_, most, most / 2 / w, ""};
                const bool later = pair.least_distance < pair.distance;
                const std::string when =
                    later ? "where they come to r = " + few_digits(pair.least_distance) + " m" : "at the start";
                limit.sentence = where + ": " +
                                 (limit.largest_step > 0
                                      ? step_and("h w " + few_digits(limit.value)) + ", w^2 = G (m1 + m2) / r^3, " +
                                            when + ", and no method follows more than " + few_digits(most)
                                      : "they fall into each other, for which no step is short enough");
                tell(std::move(limit));
            }
        }
    }
    [[nodiscard]] Pair pair_of(std::size_t a, std::size_t b) const {
        const BodySpec &one = data_.bodies[a], &other = data_.bodies[b];
        const Vector reach = vector(other.position) - vector(one.position);
        const auto moving_mass =
            (other.fixed ? Number(0) : bodies_[a].mass) + (one.fixed ? Number(0) : bodies_[b].mass);
        const auto strength = static_cast<double>(number(data_.world.gravitation) * moving_mass);
        const auto distance = static_cast<double>(norm(reach));
        const bool falls = (one.fixed || other.fixed) && !data_.world.gravity.is_zero();
        const bool alone = bodies_.size() == 2 && data_.springs.empty() && data_.forces.empty() &&
                           data_.impulses.empty() && data_.world.linear_drag.is_zero() && !falls;
        const bool touch = data_.world.contact.response != ContactResponse::none &&
                           (!data_.planes.empty() || shapes_meet(one.shape.kind, other.shape.kind));
        if (!alone || touch) return {strength, distance, distance};
        const auto velocity = [](const BodySpec& spec) { return spec.fixed ? Vector{} : vector(spec.velocity); };
        return two_bodies(strength, reach, velocity(other) - velocity(one), duration_);
    }

    // Forces that keep their direction in the world swing a body as a pendulum, with w^2 = sum |F||p| / I at most; and
    // they may spin it up to what the energy of its start is enough for. How far a body may turn in a step before the
    // energy or the quaternion's length is wrong by the maps of stability.
    void look_at_swings(std::size_t b) {
        const Body& body_b = bodies_[b];
        if (data_.bodies[b].fixed || !body_b.rotates) return;
        Vector stiffness;  // about each axis, 1/s^2
        Number work = 0;   // J, that the forces can do
        Number twist = 0;  // N m s, their angular impulse at most
        const Number least = std::min({body_b.axes.moments.x, body_b.axes.moments.y, body_b.axes.moments.z});
        for (const ForceSpec& force : data_.forces) {
            if (static_cast<std::size_t>(force.body) != b || force.frame != Frame::world ||
                force.from.to_double() >= duration_)
                continue;
            const Vector f = vector(force.force), p = body_b.arm(force.point);
            const Number strength = norm(f), arm = norm(p);
            if (!(arm > 0)) continue;
            work += strength * arm - dot(f, body_b.pose.rotate(p));
            const Number lasts = std::min(Number(force.until.to_double()), Number(duration_)) - force.from.to_double();
            twist += strength * arm * lasts;
            // What ends before a radian of a swing is a push.
            if (lasts * lasts * strength * arm < least) continue;
            for (int i = 0; i < 3; ++i)
                stiffness[i] += strength / arm * (arm * arm - p[i] * p[i]) / body_b.axes.moments[i];
        }
        if (!(twist > 0)) return;
        for (int i = 0; i < 3; ++i) look_at({static_cast<double>(stiffness[i]), 0, body(b), "force"});

        const Vector &moments = body_b.axes.moments,
                     w = body_b.axes.to_user.rotate_back(vector(data_.bodies[b].angular_velocity));
        // What pulls outward along its arm does no work, but for its rounding.
        const Number energy = std::max(Number(0), work) + dot(w, times(moments, w)) / 2;
        const auto spin =
            static_cast<double>(std::min(std::sqrt(2 * energy / least), (norm(times(moments, w)) + twist) / least));
        const double turn = most_turn();
        if (!(spin * step_ > turn)) return;
        Limit limit{body(b), "spin", spin, turn / step_, turn / spin, ""};
        limit.sentence = limit.where + ": the energy of its start is enough for " + few_digits(spin) + " rad/s, and " +
                         step_and(few_digits(spin * step_) + " rad of it") + ", where " + method_.name + " follows " +
                         few_digits(turn) + " rad";
        tell(std::move(limit));
    }

    // A body alone with its spin, times `share`, for as long as nothing else acts on it: the status that ends that, or
    // "energy" where that of its tumbling doubles, or nothing.
    [[nodiscard]] std::string ended_by(std::size_t b, double share, double step) const {
        SceneDescription alone = scene_;
        BodyDescription body = scene_.bodies[b];
        body.position = body.velocity = {};
        for (double& w : body.angular_velocity) w *= share;
        alone.bodies = {body};
        alone.gravity = {};
        alone.gravitation = alone.linear_drag = alone.angular_drag = 0;
        alone.planes.clear();
        alone.springs.clear();
        alone.impulses.clear();
        alone.forces.clear();
        alone.contact = {};
        alone.step = {1, 0, step};
        const double most_steps = adds_to_tumbling() ? 131072 : 16384,
                     steps = turns_freely(b) ? std::min(most_steps, std::ceil(duration_ / step)) : 1;
        alone.duration = std::max(1.0, steps) * step;
        const auto simulation = make_simulation(alone, method_.name, system_.name, system_.carry);
        const auto most = 2 * simulation->energy().kinetic;
        constexpr std::int64_t between_looks = 16;
        for (std::int64_t n = 1; n <= simulation->steps(); ++n) {
            simulation->step();
            if (!simulation->troubles().empty()) return simulation->troubles().front().issue;
            if ((n % between_looks == 0 || n == simulation->steps()) && simulation->energy().kinetic > most)
                return "energy";
        }
        return "";
    }
    // True of a method that may add energy to a body that tumbles at every step, if slowly; semi-implicit Euler's
    // rotation is explicit.
    [[nodiscard]] bool adds_to_tumbling() const {
        return method_.spin == Spin::angular_velocity && (method_.order == 1 || !(method_.oscillation_limit > 0));
    }
    // True if nothing but its own motion will change the body's spin.
    [[nodiscard]] bool turns_freely(std::size_t b) const {
        const auto acts_on_it = [&](const auto& event) { return static_cast<std::size_t>(event.body) == b; };
        const auto any = [&](const auto& list) { return std::any_of(list.begin(), list.end(), acts_on_it); };
        const bool holds = std::any_of(scene_.springs.begin(), scene_.springs.end(), [&](const auto& spring) {
            return static_cast<std::size_t>(spring.body) == b || static_cast<std::size_t>(spring.to_body) == b;
        });
        const auto meets = [&](const BodyDescription& other) {
            return &other != &scene_.bodies[b] && shapes_meet(other.shape.kind, scene_.bodies[b].shape.kind);
        };
        const bool touches = scene_.contact.response != ContactResponse::none &&
                             (!scene_.planes.empty() || std::any_of(scene_.bodies.begin(), scene_.bodies.end(), meets));
        return !holds && !touches && !any(scene_.forces) && !any(scene_.impulses) && scene_.angular_drag == 0;
    }

    // The free flight of a body is tried by itself: its spin about each axis grows and shrinks as the body tumbles, and
    // what a method keeps of it depends on the moments.
    void look_at_spin(std::size_t b) {
        const Body& body_b = bodies_[b];
        if (!body_b.rotates || data_.bodies[b].angular_velocity.is_zero()) return;
        const Vector w = body_b.axes.to_user.rotate_back(vector(data_.bodies[b].angular_velocity));
        const auto spin = static_cast<double>(norm(w));
        // No spin that its momentum allows comes near any limit, but for methods that add to it at every step.
        const double most = static_cast<double>(norm(times(body_b.axes.moments, w)) / body_b.axes.moments.z);
        if (most * step_ < 1.0 / 16 && most < 16 && !adds_to_tumbling()) return;
        const std::string issue = ended_by(b, 1, step_);
        if (issue.empty()) return;
        double held = 0, beyond = 1;
        for (int halving = 0; halving < 12; ++halving) {
            const double middle = (held + beyond) / 2;
            (ended_by(b, middle, step_).empty() ? held : beyond) = middle;
        }
        double step = step_ * held;
        for (int halving = 0; step > 0 && halving < 6 && !ended_by(b, 1, step).empty(); ++halving) step /= 2;
        if (!(step > 0) || !ended_by(b, 1, step).empty()) step = 0;
        Limit limit{body(b), "spin", spin, spin * held, step, ""};
        limit.sentence = limit.where + ": it spins at " + few_digits(spin) + " rad/s, and " + way() +
                         (issue == "range_left" ? " holds " : " follows ") + four_digits_down(limit.limit) +
                         " rad/s of this motion at a step of " + few_digits(step_) + " s" +
                         (step > 0 ? "" : ": no step holds it, which a larger [range] angular_velocity may");
        tell(std::move(limit));
    }

    // rad/s about a principal axis of the body, in an index of the list of number systems.
    [[nodiscard]] double held_spin(std::size_t b, int axis, double step, std::size_t system) const {
        const Vector& moments = bodies_[b].axes.moments;
        const double per_spin =
            step / 2 * (method_.spin == Spin::angular_momentum ? static_cast<double>(moments[axis] / moments.y) : 1);
        return held_by(system, Real{step}, method_.spin).half_turn / per_spin;
    }
    // That a method which keeps the momentum follows too: about a small moment its state holds more than it turns by.
    [[nodiscard]] double followed_spin(std::size_t b, int axis, double step, std::size_t system) const {
        const double held = held_spin(b, axis, step, system);
        return method_.spin == Spin::angular_momentum ? std::min(held, most_turn() / step) : held;
    }
    // About any axis: about the smallest moment a spin is never the first to leave.
    [[nodiscard]] double least_held_spin(std::size_t b, double step, std::size_t system) const {
        return std::min(held_spin(b, 0, step, system), held_spin(b, 1, step, system));
    }

    // m/s: how fast a body may meet what is `gap(place)` m away from its centre of mass, which moves from x with v
    // under g; 0 where it does not within the run. How it is turned then is not known: between its least and most
    // reach.
    template <class Gap>
    [[nodiscard]] Number meeting_speed(std::size_t b, const Vector& x, const Vector& v, const Vector& g,
                                       Gap&& gap) const {
        const Reach reach(data_.bodies[b].shape);
        const Number time = duration_, fastest = norm(v) + norm(g) * time;
        if (!(fastest > 0)) return 0;
        const bool is_rough = scene_.bodies[b].friction.value_or(scene_.contact.friction) > 0;
        constexpr int most_looks = 16384;
        Number speed = 0;
        for (Number t = 0; t <= time;) {
            const Vector place = x + v * t + g * (t * t / 2), velocity = v + g * t;
            const Number away = gap(place), moment = reach.most / fastest / 1024,
                         approach = (away - gap(place + velocity * moment)) / moment;
            if (away <= reach.most && approach > 0) speed = std::max(speed, is_rough ? norm(velocity) : approach);
            if (speed > 0 && (away <= reach.least || away > reach.most)) break;
            t += std::max(time / most_looks, std::max(away - reach.most, reach.most / 8) / fastest);
        }
        return speed;
    }
    [[nodiscard]] Number speed_to(const PlaneSpec& plane, std::size_t b) const {
        const Vector n = vector(normalized(plane.normal));
        const Number offset = number(plane.offset);
        return meeting_speed(b, vector(data_.bodies[b].position), vector(data_.bodies[b].velocity),
                             vector(data_.world.gravity), [&](const Vector& x) { return dot(n, x) + offset; });
    }
    // Where both move, gravity moves neither against the other. What spins is taken to fill the ball of its reach.
    [[nodiscard]] Number speed_to(const BodySpec& other, std::size_t b) const {
        const BodySpec& own = data_.bodies[b];
        const bool is_box = other.shape.kind == ShapeKind::box && other.angular_velocity.is_zero();
        const Rotation pose = rotation(other.orientation).normalized();
        const Vector half = vector(other.shape.size) * Number(0.5);
        const Number ball = Reach(other.shape).most;
        const auto gap = [&](const Vector& x) {
            if (!is_box) return norm(x) - ball;
            Vector outside = pose.rotate_back(x);
            for (int i = 0; i < 3; ++i) outside[i] = std::max(Number(0), std::abs(outside[i]) - half[i]);
            return norm(outside);
        };
        return meeting_speed(b, vector(own.position) - vector(other.position),
                             other.fixed ? vector(own.velocity) : vector(own.velocity) - vector(other.velocity),
                             other.fixed ? vector(data_.world.gravity) : Vector{}, gap);
    }
    // What a body may touch: a plane, or another body.
    struct Meeting {
        Number speed;                      // m/s, at which they meet within the run, or 0
        bool is_within_reach;              // where they begin, if one of them turns
        Vector normal;                     // the plane's, or from the other to the body where they begin
        std::optional<std::size_t> other;  // body
    };
    template <class Meet>
    void for_each_meeting(std::size_t b, Meet&& meet) const {
        const ShapeKind shape = data_.bodies[b].shape.kind;
        if (shape == ShapeKind::none) return;
        const Vector x = vector(data_.bodies[b].position);
        const Number most = Reach(data_.bodies[b].shape).most;
        for (const PlaneSpec& plane : data_.planes) {
            const Vector n = vector(normalized(plane.normal));
            meet(Meeting{speed_to(plane, b), dot(n, x) + number(plane.offset) <= most, n, {}});
        }
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            const BodySpec& other = data_.bodies[i];
            if (i == b || !shapes_meet(shape, other.shape.kind)) continue;
            const Vector reach = x - vector(other.position);
            const Number distance = norm(reach);
            meet(Meeting{speed_to(other, b), distance <= most + Reach(other.shape).most,
                         distance > 0 ? reach * (1 / distance) : Vector{}, i});
        }
    }
    // What own(body) is of both, if they are free to move.
    template <class Own>
    [[nodiscard]] Number sum_of(std::size_t b, std::optional<std::size_t> other, Own&& own) const {
        return own(b) + (other && !data_.bodies[*other].fixed ? own(*other) : 0);
    }
    // 1/kg: of contact springs the stiffness of the fastest motion, per stiffness and mass, as in ContactSprings: a
    // sphere has one, which pushes at its centre, and others four that lift or tilt them, or one that does both where
    // they meet a sphere.
    [[nodiscard]] Number compliance(std::size_t b, bool meets_sphere) const {
        const Shape& shape = data_.bodies[b].shape;
        const Number lift = 1 / bodies_[b].mass;
        if (shape.kind == ShapeKind::sphere) return lift;
        const InertiaTensor& t = data_.bodies[b].inertia;
        const Vector half = half_extents(shape), moments(number(t.xx), number(t.yy), number(t.zz));
        Number tilt = 0;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                if (i != j) tilt = std::max(tilt, half[j] * half[j] / moments[i]);
        return meets_sphere ? lift + tilt : 4 * std::max(lift, tilt);
    }
    // Of both.
    [[nodiscard]] Number compliance(std::size_t b, const Meeting& met) const {
        const auto is_sphere = [&](std::size_t i) { return data_.bodies[i].shape.kind == ShapeKind::sphere; };
        const bool meets_sphere = met.other && (is_sphere(b) || is_sphere(*met.other));
        return sum_of(b, met.other, [&](std::size_t i) { return compliance(i, meets_sphere); });
    }
    [[nodiscard]] bool turns(std::size_t b) const {
        return data_.bodies[b].shape.kind != ShapeKind::sphere && !data_.bodies[b].angular_velocity.is_zero();
    }
    // The kernel tells of steps that no explicit method stands, but not of a method that adds to every oscillation:
    // here as if the body stayed in contact with all that it meets in its flight or by its turning, or, where more than
    // uniform gravity moves it, may meet.
    void look_at_contact_springs(std::size_t b) {
        const ContactDescription& contact = scene_.contact;
        if (contact.response != ContactResponse::spring || !(contact.stiffness > 0) || data_.bodies[b].fixed ||
            method_.oscillation_limit > 0)
            return;
        const bool is_thrown =
            scene_.impulses.empty() && scene_.forces.empty() && scene_.springs.empty() && scene_.gravitation == 0;
        for_each_meeting(b, [&](const Meeting& met) {
            const bool meets_by_turning = met.is_within_reach && (turns(b) || (met.other && turns(*met.other)));
            if (is_thrown && !meets_by_turning && !(met.speed > 0)) return;
            const auto both = static_cast<double>(compliance(b, met));
            look_at({contact.stiffness * both, contact.damping * both, body(b), "contact spring", false});
        });
    }
    // What meets a body at a speed v, m/s, d m beside its centre of mass turns it at (1 + e) v d / (a I + d^2), with a
    // the sum of 1/m of both: fastest where d^2 = a I, if it reaches so far. Friction turns a sphere until it rolls, at
    // 5/7 of v / r.
    void look_at_impacts(std::size_t b) {
        const BodySpec& spec = data_.bodies[b];
        const BodyDescription& named = scene_.bodies[b];
        if (!system_.fixed_point || spec.fixed || spec.shape.kind == ShapeKind::none ||
            scene_.contact.response == ContactResponse::none || told_of(body(b), "spin"))
            return;
        Number speed = 0;
        Vector spin;  // rad/s, principal axes
        if (spec.shape.kind == ShapeKind::sphere) {
            const Number pull = norm(vector(data_.world.gravity));
            const bool meets = std::any_of(data_.planes.begin(), data_.planes.end(),
                                           [&](const PlaneSpec& plane) { return speed_to(plane, b) > 0; });
            if (!(named.friction.value_or(scene_.contact.friction) > 0) || !meets || !(pull > 0)) return;
            // About the axis across gravity and the way, in the body's axes, of which each is held by itself.
            const Vector across = cross(vector(data_.world.gravity) * (1 / pull), vector(spec.velocity)),
                         w = bodies_[b].pose.rotate_back(across);
            speed = norm(across);
            for (int i = 0; i < 3; ++i) spin[i] = std::abs(w[i]) * 5 / 7 / number(spec.shape.size.x);
        } else {
            const Number e = named.restitution.value_or(scene_.contact.restitution), most = Reach(spec.shape).most;
            for_each_meeting(b, [&](const Meeting& met) {
                const Number at = met.speed,
                             per_mass = sum_of(b, met.other, [&](std::size_t i) { return 1 / bodies_[i].mass; });
                for (int i = 0; i < 3 && at > 0; ++i) {
                    const Number beside = per_mass * bodies_[b].axes.moments[i], d = std::min(most, std::sqrt(beside)),
                                 turn = (1 + e) * at * d / (beside + d * d);
                    if (!(turn > spin[i])) continue;
                    spin[i] = turn;
                    speed = std::max(speed, at);
                }
            });
        }
        const auto spin_of = [&](int i) { return static_cast<double>(spin[i]); };
        const auto excess = [&](int i) { return spin_of(i) / followed_spin(b, i, step_, index()); };
        int worst = 0;
        for (const int i : {1, 2})
            if (excess(i) >= excess(worst)) worst = i;
        if (!(excess(worst) > 1)) return;
        const double held = followed_spin(b, worst, step_, index());
        Limit limit{body(b), "impact", spin_of(worst), held, 0, ""};
        limit.sentence = limit.where + ": what it meets at " + few_digits(speed) + " m/s may turn it at " +
                         few_digits(limit.value) + " rad/s, and " + way() + " holds " + four_digits_down(held) +
                         " rad/s of this body at a step of " + few_digits(step_) + " s: ";
        // Where the moments differ more, impacts in a row hand the spin of one axis to another, and no bound is known.
        constexpr Number most_alike = 2;
        const bool is_alike = bodies_[b].axes.moments.x <= most_alike * bodies_[b].axes.moments.z;
        // A [range] asks for no more than the reader takes, and its number system holds more at some steps.
        SceneDescription asking = scene_;
        double& declared = asking.range.angular_velocity;
        for (int i = 0; i < 3; ++i) {
            // As that of a sphere.
            const double alike = spin_of(i) * held_spin(b, 1, step_, index()) / held_spin(b, i, step_, index());
            declared = std::max(declared, std::min(alike, double{FieldRange::spin}));
        }
        const std::size_t system = index_of(find_number_system(asking, system_.name, system_.carry));
        const auto is_held = [&](double step) {
            for (int i = 0; i < 3; ++i)
                if (followed_spin(b, i, step, system) < spin_of(i)) return false;
            return declared <= RangeDescription{}.angular_velocity || least_held_spin(b, step, system) >= declared;
        };
        constexpr double shortest = 0x1p-14;
        double step = step_;
        while (step > shortest && !is_held(step)) step /= 2;
        if (is_alike && is_held(step)) {
            limit.largest_step = step;
            limit.sentence += "a [range] angular_velocity of " + few_digits(declared) + " and a step of " +
                              four_digits_down(step) + " s hold it";
        } else limit.sentence += "no [range] is sure to hold it, but floating point does";
        tell(std::move(limit));
    }

    // What [range] promises of spins, where the file asks for more than the default.
    void look_at_range() {
        if (!system_.fixed_point || scene_.range.angular_velocity <= RangeDescription{}.angular_velocity) return;
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            if (!bodies_[b].rotates) continue;
            const auto held = [&](double step) { return least_held_spin(b, step, index()); };
            const double declared = scene_.range.angular_velocity, limit_of_spin = held(step_);
            if (limit_of_spin >= declared || told_of(body(b), "spin")) continue;
            double step = step_ * limit_of_spin / declared;
            for (int halving = 0; halving < 6 && held(step) < declared; ++halving) step /= 2;
            Limit limit{body(b), "range", declared, limit_of_spin, step, ""};
            limit.sentence = limit.where + ": [range] asks for spins up to " + few_digits(declared) + " rad/s, and " +
                             way() + " holds " + four_digits_down(limit_of_spin) + " rad/s of this body at a step of " +
                             few_digits(step_) + " s";
            tell(std::move(limit));
        }
    }

    // m/s^2. Fixed point takes a share of what it holds of a velocity as the change of a step: a quarter of forces,
    // all of gravity, which it cuts beyond, or twice that where it adds it in halves.
    void look_at_load(const std::string& where, const std::string& changed, double acceleration, double share) {
        const auto most = [&](double step) { return held_by(index(), Real{step}, method_.spin).velocity * share; };
        if (acceleration * step_ <= most(step_)) return;
        double step = most(step_) / acceleration;
        for (int halving = 0; halving < 6 && acceleration * step > most(step); ++halving) step /= 2;
        Limit limit{where, "load", acceleration * step_, most(step_), step, ""};
        limit.sentence = limit.where + ": it changes " + changed + " by " + few_digits(limit.value) +
                         " m/s in a step of " + few_digits(step_) + " s, and " + way() + " takes " +
                         four_digits_down(limit.limit) + " m/s";
        tell(std::move(limit));
    }
    [[nodiscard]] static double largest_component(const Vector& v) {
        return static_cast<double>(std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}));
    }
    void look_at_gravity() {
        const bool is_felt =
            std::any_of(data_.bodies.begin(), data_.bodies.end(), [](const BodySpec& spec) { return !spec.fixed; });
        if (!system_.fixed_point || !is_felt) return;
        const bool is_halved = system_.carry && method_.coasts_with_mean;
        look_at_load("gravity", "velocities", largest_component(vector(data_.world.gravity)), is_halved ? 2 : 1);
    }
    void look_at_forces(std::size_t b) {
        if (!system_.fixed_point || method_.takes_any_load || data_.bodies[b].fixed) return;
        for (std::size_t f = 0; f < data_.forces.size(); ++f) {
            const ForceSpec& force = data_.forces[f];
            if (static_cast<std::size_t>(force.body) != b || force.from.to_double() >= duration_) continue;
            // In the body's axes the direction in the world is not known: its share along the best axis is.
            const Vector push = vector(force.force) * (1 / bodies_[b].mass), gravity = vector(data_.world.gravity);
            const double acceleration =
                force.frame == Frame::world
                    ? largest_component(push + gravity)
                    : static_cast<double>(norm(push) / std::sqrt(Number(3))) - static_cast<double>(norm(gravity));
            look_at_load("force[" + std::to_string(f) + "]", "the velocity of " + body(b), acceleration, 0.25);
        }
    }

    // Impacts in fixed point round what the heavier of two bodies takes: the lighter one's velocity is off by some 1e-4
    // at this ratio of masses, and its restitution is lost at some 3e5.
    void look_at_masses() {
        constexpr double most = 1e4;
        if (!system_.fixed_point || scene_.contact.response != ContactResponse::impulse) return;
        for (std::size_t b = 1; b < bodies_.size(); ++b) {
            for (std::size_t a = 0; a < b; ++a) {
                const BodySpec &one = data_.bodies[a], &other = data_.bodies[b];
                if (one.fixed || other.fixed || !shapes_meet(one.shape.kind, other.shape.kind)) continue;
                const auto [light, heavy] = std::minmax(bodies_[a].mass, bodies_[b].mass);
                const auto ratio = static_cast<double>(heavy / light);
                if (!(ratio > most)) continue;
                Limit limit{body(a) + " and " + body(b), "mass", ratio, most, 0, ""};
                limit.sentence = limit.where + ": one is " + few_digits(ratio) +
                                 " times as heavy as the other, and impacts between them in " + system_.name +
                                 " follow " + few_digits(most) + ": take floating point, or a fixed body";
                tell(std::move(limit));
            }
        }
    }

    // m: what a float holds of a place, x m from the origin.
    [[nodiscard]] double unit_at(double x) const {
        return x == 0 ? 0 : std::ldexp(system_.name == "f32" ? 0x1p-23 : 0x1p-52, std::ilogb(x));
    }
    void tell_place(std::size_t b, double away, double unit, double near, const std::string& what_it_meets) {
        Limit limit{body(b), "place", unit, near, 0, ""};
        limit.sentence = limit.where + ": " + system_.name + " holds its place, " + few_digits(away) +
                         " m from the origin, to " + few_digits(unit) + " m, and what it meets " + what_it_meets +
                         ", or take numbers that hold more digits";
        tell(std::move(limit));
    }
    // Floats hold a place to a part of its distance from the origin, and impacts happen within a quarter of the
    // contact tolerance, which the kernel raises where floats do not resolve it beside the largest body.
    void look_at_place(std::size_t b) {
        if (system_.fixed_point || data_.bodies[b].fixed || scene_.contact.response != ContactResponse::impulse) return;
        double away = 0;  // m
        for (const double x : scene_.bodies[b].position) away = std::max(away, std::abs(x));
        Real largest{};
        for (const BodySpec& spec : data_.bodies) largest = std::max(largest, reach_of(spec.shape));
        const Real least = system_.name == "f32" ? ContactNumbers<F32>::LengthScale::least_tolerance(largest)
                                                 : ContactNumbers<F64>::LengthScale::least_tolerance(largest);
        const double unit = unit_at(away), near = std::max(scene_.contact.tolerance, least.to_double()) / 4;
        if (!(unit > near)) return;
        bool meets = false;
        for_each_meeting(b, [&](const Meeting& met) { meets = meets || met.speed > 0; });
        if (meets)
            tell_place(b, away, unit, near,
                       "is found within " + few_digits(near) +
                           " m, a quarter of the contact tolerance: move the scene to the origin, declare a larger "
                           "tolerance");
    }
    // Contact springs of w^2 = k / m are pressed v / w deep along a normal.
    void look_at_place_on_contact_springs(std::size_t b) {
        const ContactDescription& contact = scene_.contact;
        if (system_.fixed_point || data_.bodies[b].fixed || contact.response != ContactResponse::spring ||
            !(contact.stiffness > 0))
            return;
        for_each_meeting(b, [&](const Meeting& met) {
            double away = 0;
            for (int i = 0; i < 3; ++i)
                away = std::max(away, std::abs(scene_.bodies[b].position[static_cast<std::size_t>(i)] *
                                               static_cast<double>(met.normal[i])));
            const auto depth = static_cast<double>(met.speed / std::sqrt(contact.stiffness * compliance(b, met)));
            if (depth > 0 && unit_at(away) * least_depth > depth)
                tell_place(b, away, unit_at(away), depth / least_depth,
                           "presses its contact springs " + few_digits(depth) +
                               " m: move the scene to the origin, declare softer springs");
        });
    }

    [[nodiscard]] static std::size_t index_of(const NumberSystemInfo& system) {
        return static_cast<std::size_t>(&system - number_systems().data());
    }
    [[nodiscard]] std::size_t index() const { return index_of(system_); }
    [[nodiscard]] bool told_of(const std::string& where, const std::string& what) const {
        return std::any_of(found_.begin(), found_.end(),
                           [&](const Limit& limit) { return limit.where == where && limit.what == what; });
    }

    const SceneDescription& scene_;
    SceneData data_;
    const IntegratorInfo& method_;
    const NumberSystemInfo& system_;
    double step_, duration_;  // s
    std::vector<Body> bodies_;
    std::vector<Limit> found_;
};

}  // namespace

std::vector<Limit> exceeded_limits(const SceneDescription& scene, std::string_view integrator, std::string_view numbers,
                                   std::optional<bool> carry) {
    const auto search = [&](const SceneDescription& at) { return Search(at, integrator, numbers, carry).run(); };
    const auto tells_step = [](const Limit& limit) { return limit.largest_step > 0 && limit.what != "impact"; };
    // Of those that tell a step the one of the shortest.
    const auto strictest = [&](std::vector<Limit>& limits) -> Limit* {
        Limit* least = nullptr;
        for (Limit& limit : limits)
            if (tells_step(limit) && (least == nullptr || limit.largest_step < least->largest_step)) least = &limit;
        return least;
    };
    std::vector<Limit> limits = search(scene);
    if (Limit* limit = strictest(limits)) {
        // Springs and dampers together move otherwise at another step: what is told there may be a shorter one.
        constexpr int most_rounds = 64;
        for (int round = 0; round < most_rounds; ++round) {
            SceneDescription shorter = scene;
            shorter.step = {1, 0, std::stod(four_digits_down(limit->largest_step))};
            if (!(scene.duration / shorter.step.seconds() < static_cast<double>(max_steps))) break;
            std::vector<Limit> still = search(shorter);
            const Limit* next = strictest(still);
            if (next == nullptr || !(next->largest_step < shorter.step.seconds())) break;
            limit->largest_step = next->largest_step;
        }
    }
    for (Limit& limit : limits)
        if (tells_step(limit))
            limit.sentence += ": the largest safe step is " + four_digits_down(limit.largest_step) + " s";
    return limits;
}

}  // namespace tumble::host

#include "simulation/limits.hpp"

#include <tumble/body/mass.hpp>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "scene/data.hpp"
#include "simulation/motion_of.hpp"
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
// True if the mode's energy does not grow by more than most_growth in the time, s.
bool holds(const IntegratorInfo& method, const Mode& mode, double h, double time) {
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

// The linear oscillations about the start of all bodies that springs hold, with drag: the eigenvectors of stiffness and
// of damping, both per mass.
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
    [[nodiscard]] std::vector<Mode> modes(const SceneDescription& names) const {
        std::vector<Mode> modes;
        if (size_ == 0) return modes;
        const Eigen::MatrixXd all_damping = damping_ + drag_;
        for (const Eigen::MatrixXd* matrix : {&stiffness_, &all_damping}) {
            if (matrix->isZero(0)) continue;
            const Eigen::MatrixXd axes = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(*matrix).eigenvectors();
            for (Eigen::Index k = 0; k < size_; ++k) modes.push_back(mode_along(axes.col(k), all_damping, names));
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

class Search {
public:
    Search(const SceneDescription& scene, std::string_view integrator)
        : scene_{scene}, data_{build_scene(scene)}, method_{find_integrator(integrator)},
          step_{static_cast<double>(number(data_.step.value))}, duration_{scene.duration} {
        for (const BodySpec& spec : data_.bodies) bodies_.emplace_back(spec);
    }

    [[nodiscard]] std::vector<Limit> run() {
        const SpringModes springs(data_, bodies_);
        for (const Mode& mode : springs.modes(scene_)) look_at(mode);
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            if (data_.bodies[b].fixed || springs.holds(static_cast<int>(b))) continue;
            const std::string where = "body \"" + scene_.bodies[b].name + "\"";
            const auto per = [](Real drag, Number inertia) { return static_cast<double>(number(drag) / inertia); };
            look_at({0, per(data_.world.linear_drag, bodies_[b].mass), where, "drag"});
            if (bodies_[b].rotates)
                look_at({0, per(data_.world.angular_drag, bodies_[b].axes.moments.z), where, "drag"});
        }
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
        const bool is_spring = mode.what == "spring";
        const double per_step = is_spring ? std::sqrt(mode.stiffness) : mode.damping;
        const double known = is_spring ? method_.oscillation_limit : method_.drag_limit;
        const bool damped = is_spring ? mode.damping > 0 : mode.stiffness > 0;
        Limit limit{mode.where, mode.what, per_step * step_, damped || known == 0 ? per_step * most : known, most, ""};
        const std::string ratio = is_spring ? "h w" : mode.what == "drag" ? "h c/m" : "h c/m of the damper";
        limit.sentence = limit.where + ": a step of " + few_digits(step_) + " s makes " + ratio + " " +
                         few_digits(limit.value) + ", and " + method_.name;
        if (known == 0 && is_spring)
            limit.sentence += " adds to an oscillation at every step, here more than " +
                              few_digits(100 * (most_growth - 1)) + " % in " + few_digits(duration_) + " s";
        else limit.sentence += " is stable up to " + few_digits(limit.limit);
        limit.sentence += ": the largest safe step is " + four_digits_down(most) + " s";
        tell(std::move(limit));
    }

    const SceneDescription& scene_;
    SceneData data_;
    const IntegratorInfo& method_;
    double step_, duration_;  // s
    std::vector<Body> bodies_;
    std::vector<Limit> found_;
};

}  // namespace

std::vector<Limit> exceeded_limits(const SceneDescription& scene, std::string_view integrator,
                                   [[maybe_unused]] std::string_view numbers,
                                   [[maybe_unused]] std::optional<bool> carry) {
    return Search(scene, integrator).run();
}

}  // namespace tumble::host

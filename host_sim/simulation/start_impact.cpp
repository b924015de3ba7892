#include "simulation/start_impact.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "scene/data.hpp"
#include "truth/smooth_motion.hpp"

namespace tumble::host {
namespace {

using namespace reference;

// What counts, of the speeds of both sides.
constexpr Number least_share = 1e-3L;

class Impact {
public:
    explicit Impact(const SceneDescription& scene) : scene_(scene) {
        const SmoothMotion motion(scene, shapes_meet);
        sides_ = motion.bodies();
        energy_ = motion.energy_across_joints();
    }

    [[nodiscard]] StartImpact result() const {
        StartImpact impact;
        impact.energy = energy_;
        Number worst = 0;
        for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
            const JointDescription& joint = scene_.joints[j];
            const Motion own = side(joint.body), other = side(joint.to_body);
            const auto counting = [&](bool turns) {
                const Number size = norm(held(joint, turns, difference(joint, turns, own, other))),
                             of_sides = speed_of(joint, joint.body, turns) + speed_of(joint, joint.to_body, turns);
                return size > least_share * of_sides ? size : 0;
            };
            const Number speed = counting(false), spin = counting(true);
            if (!(speed > 0) && !(spin > 0)) continue;
            if (impact.joint >= 0) ++impact.others;
            if (std::max(speed, spin) <= worst) continue;
            worst = std::max(speed, spin);
            impact.joint = static_cast<int>(j);
            impact.speed = speed;
            impact.spin = spin;
        }
        if (impact.joint >= 0) fit(impact);
        return impact;
    }

private:
    [[nodiscard]] Motion side(int b) const { return b < 0 ? Motion{} : sides_[static_cast<std::size_t>(b)]; }
    // In the world.
    [[nodiscard]] static Vector spin_of(const Motion& side) { return side.q.rotate(side.w); }
    [[nodiscard]] Vector arm(const JointDescription& joint, int b) const {
        return b < 0 ? Vector{} : vector_of(joint.anchor_on(b)) - side(b).x;
    }
    // Of a side: a bound on the speed of its anchor, or its spin. A difference is judged against this.
    [[nodiscard]] Number speed_of(const JointDescription& joint, int b, bool turns) const {
        const Motion of = side(b);
        return turns ? norm(of.w) : norm(of.v) + norm(of.w) * norm(arm(joint, b));
    }
    // The velocity of `body` against `to_body`, at the anchor or of the spin, world.
    [[nodiscard]] Vector difference(const JointDescription& joint, bool turns, const Motion& own,
                                    const Motion& other) const {
        const auto of_anchor = [&](const Motion& of, int b) { return of.v + cross(spin_of(of), arm(joint, b)); };
        return turns ? spin_of(own) - spin_of(other) : of_anchor(own, joint.body) - of_anchor(other, joint.to_body);
    }
    // The part of it that the joint does not allow.
    [[nodiscard]] static Vector held(const JointDescription& joint, bool turns, Vector of) {
        const FreeAxes free = free_axes(joint);
        for (const Vector& axis : turns ? free.turns : free.slides) of = of - axis * dot(axis, of);
        return of;
    }

    // Takes from one side what the joint does not allow, first of its spin.
    void fit(StartImpact& impact) const {
        const JointDescription& joint = scene_.joints[static_cast<std::size_t>(impact.joint)];
        const bool is_own = !scene_.body(joint.body).fixed;
        impact.body = is_own ? joint.body : joint.to_body;
        const int beside = is_own ? joint.to_body : joint.body;
        Motion fitting = side(impact.body);
        const Motion other = side(beside);
        const auto ended = [&](bool turns) {
            const Vector by =
                is_own ? difference(joint, turns, fitting, other) : -difference(joint, turns, other, fitting);
            return held(joint, turns, by);
        };
        fitting.w = fitting.w - fitting.q.rotate_back(ended(true));
        fitting.v = fitting.v - ended(false);
        const auto triple = [](const Vector& v, Number size) {
            const auto rounded = [&](Number x) { return std::abs(x) < 1e-9L * size ? 0.0 : static_cast<double>(x); };
            return Triple{rounded(v.x), rounded(v.y), rounded(v.z)};
        };
        impact.velocity = triple(fitting.v, speed_of(joint, impact.body, false) + speed_of(joint, beside, false));
        impact.angular_velocity = triple(fitting.w, norm(side(impact.body).w) + norm(other.w));
    }

    const SceneDescription& scene_;
    std::vector<Motion> sides_;
    Number energy_ = 0;
};

}  // namespace

StartImpact impact_at_start(const SceneDescription& scene) {
    if (scene.joints.empty()) return {};
    return Impact(scene).result();
}

}  // namespace tumble::host

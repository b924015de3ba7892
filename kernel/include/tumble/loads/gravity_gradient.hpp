// GravityGradient: the torque on a long body whose lower end is attracted more than its upper end: 3 w^2 r x J r, with
// r the unit vector to the attracting centre and w the angular velocity of a circular orbit at this height. For
// Features::gravity_gradient or the LoadList of a scene. P. C. Hughes, Spacecraft Attitude Dynamics, 1986, section 8.1.
#pragma once

#include <tumble/loads/loaded_group.hpp>

namespace tumble {

// The orbit in a scene's data; without a rate there is no torque.
struct OrbitSpec {
    Real rate = 0;         // angular velocity of the orbit, rad/s
    RealVec3 to_centre{};  // the direction to the centre, world, of any length but zero

    static constexpr void each(auto&& f, auto&... of) {  // see Field
        f(Field{"rate", "rad/s", Field::positive}, of.rate...);
        f(Field{"to_centre"}, of.to_centre...);
    }
};

// The torque on each body of a world with so many bodies. The same centre for all.
template <class N, int bodies>
class GravityGradient {
public:
    // Angular velocity of the orbit, rad/s, and the direction to the centre, world, of any length but zero.
    constexpr void set_orbit(Real rate, const RealVec3& to_centre) {
        const RealVec3 unit = normalized(to_centre);
        to_centre_ = Vector::of(unit.x, unit.y, unit.z);
        strength_ = N::template constant<Work>(rate * rate * Real{3});
    }

    // As each load has it: loads/load.hpp.
    constexpr void set_body(int b, const BodySpec& spec, const PrincipalInertia& inertia, const auto&) {
        for (int i = 0; i < 3; ++i)
            excess_[b][i] =
                spec.is_fixed()
                    ? Work{}
                    : N::template constant<Work>(inertia.moments[(i + 2) % 3] - inertia.moments[(i + 1) % 3]);
    }
    // Likewise.
    [[nodiscard]] bool acts_on(const auto& all, int b) const { return turns(all, b); }
    // Likewise.
    [[nodiscard]] bool turns(const auto& all, int b) const { return strength_ > Work(0) && all.rotates(b); }
    // Likewise.
    template <class Group>
    void apply_to(const Group& group) const {
        if constexpr (Group::rotation) {
            for (int k = 0; k < group.count; ++k) {
                if (!turns(group.bodies, group.id[k])) continue;
                const auto r = L::rotated_back(group.stage[k].q_wb, to_centre_).template as<Work>();
                const Work(&excess)[3] = excess_[group.id[k]];
                group.turn(k, Vector::of(excess[0] * r.y * r.z, excess[1] * r.z * r.x, excess[2] * r.x * r.y),
                           L::factor(strength_ * group.seconds));
            }
        }
    }

    // Likewise.
    static void each(auto& gradient, auto& archive) { archive(gradient.strength_, gradient.to_centre_); }

private:
    using Work = typename N::Work;
    using L = LoadNumbers<N>;
    using Vector = typename L::Vector;
    Vector to_centre_{};        // world, a unit vector
    Work strength_{};           // 3 w^2, 1/s^2
    Work excess_[bodies][3]{};  // I_k - I_j of axes (i, j, k), kg m^2
};

}  // namespace tumble

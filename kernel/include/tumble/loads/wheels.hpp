// Wheels: the angular momentum that wheels inside a body store (a gyrostat): the body feels the torque h x w, and so
// keeps its axis or precesses. For Features::wheels or the LoadList of a scene. A motor that turns a wheel changes h,
// and turns the body by the opposite torque: World::set_torque. P. C. Hughes, Spacecraft Attitude Dynamics, 1986,
// section 3.4.
#pragma once

#include <tumble/loads/loaded_group.hpp>

namespace tumble {

// The wheels of a body in a scene's data.
struct WheelsSpec {
    BodyIndex body = 0;   // its id, or its number in the order of add()
    RealVec3 momentum{};  // N m s, user's body axes, relative to the body

    static constexpr void each(auto&& f, auto&... of) {  // see Field
        f(Field{"body", "", Field::body}, of.body...);
        f(Field{"momentum", "N m s"}, of.momentum...);
    }
};

// The stored angular momentum of each body of a world with so many bodies.
template <class N, int bodies>
class Wheels {
public:
    // The sum over all wheels of a body, N m s, user's body axes, relative to the body.
    template <class T>
    constexpr void set_momentum(BodyIndex body, const Vector3<T>& momentum) {
        TUMBLE_ASSERT(body >= 0 && body < bodies);
        for (int i = 0; i < 3; ++i) momentum_[body][i] = static_cast<Work>(momentum[i]);
    }

    // As each load has it: loads/load.hpp. The next body at the place of a removed one has no wheels.
    constexpr void set_body(int b, const BodySpec& spec, const auto&, const auto&) {
        if (spec.is_fixed()) momentum_[b] = {};
    }
    // Likewise.
    [[nodiscard]] bool acts_on(const auto& all, int b) const { return turns(all, b); }
    // Likewise.
    [[nodiscard]] bool turns(const auto& all, int b) const { return all.rotates(b) && !momentum_[b].is_zero(); }
    // Likewise.
    [[nodiscard]] bool depends_on_velocity() const {
        for (const Vector3<Work>& momentum : momentum_)
            if (!momentum.is_zero()) return true;
        return false;
    }
    // Likewise.
    template <class Group>
    void apply_to(const Group& group) const {
        if constexpr (Group::rotation)
            for (int k = 0; k < group.count; ++k)
                if (turns(group.bodies, group.id[k]))
                    group.turn(k, cross(momentum_[group.id[k]], group.angular_velocity(k)));
    }

    // Likewise.
    static void each(auto& wheels, auto& archive) { archive(wheels.momentum_); }

private:
    using Work = typename N::Work;
    Vector3<Work> momentum_[bodies]{};
};

}  // namespace tumble

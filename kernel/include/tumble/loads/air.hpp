// Air: drag in air that moves, with coefficients of each body: F = -(a + b |u|) u, where u is the velocity through the
// air. For Features::air or the LoadList of a scene. One square root a body and evaluation where b is not zero.
#pragma once

#include <tumble/loads/loaded_group.hpp>
#include <tumble/numbers/functions.hpp>

namespace tumble {

// Drag of a body in a scene's data: linear, kg/s, and quadratic, kg/m.
struct DragSpec {
    BodyIndex body = 0;  // its id, or its number in the order of add()
    Real linear = 0;     // kg/s
    Real quadratic = 0;  // kg/m

    static constexpr void each(auto&& f, auto&... of) {  // see Field
        f(Field{"body", "", Field::body}, of.body...);
        f(Field{"linear", "kg/s", Field::not_negative}, of.linear...);
        f(Field{"quadratic", "kg/m", Field::not_negative}, of.quadratic...);
    }
};

// Drag of each body of a world with so many bodies, at the centre of mass.
template <class N, int bodies>
class Air {
public:
    // Velocity of the air, m/s, world.
    constexpr void set_wind(const RealVec3& wind) {
        for (int i = 0; i < 3; ++i) wind_[i] = N::template constant<Work>(wind[i]);
    }
    // Drag of a body: linear, kg/s, and quadratic, kg/m. Not negative. Zero until it is set.
    constexpr void set_drag(BodyIndex body, Real linear, Real quadratic) {
        TUMBLE_ASSERT(body >= 0 && body < bodies && !linear.is_negative() && !quadratic.is_negative());
        linear_[body] = N::template constant<Work>(linear);
        quadratic_[body] = N::template constant<Work>(quadratic);
    }

    // As each load has it: loads/load.hpp. The next body at the place of a removed one has no drag.
    constexpr void set_body(int b, const BodySpec& spec, const auto&, const auto&) {
        if (spec.is_fixed()) linear_[b] = quadratic_[b] = Work(0);
    }
    // Likewise.
    [[nodiscard]] bool acts_on(const auto&, int b) const { return linear_[b] > Work(0) || quadratic_[b] > Work(0); }
    // Likewise.
    [[nodiscard]] bool depends_on_velocity() const {
        for (int b = 0; b < bodies; ++b)
            if (acts_on(b, b)) return true;
        return false;
    }
    // Likewise.
    template <class Group>
    void apply_to(const Group& group) const {
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            if (!acts_on(group.bodies, b)) continue;
            const Vector3<Work> through = group.velocity(k) - wind_;
            Work drag = linear_[b];
            if (quadratic_[b] > Work(0)) drag = drag + quadratic_[b] * sqrt(dot(through, through));
            group.push(k, through * -drag);
        }
    }

    // Likewise.
    static void each(auto& air, auto& archive) { archive(air.wind_, air.linear_, air.quadratic_); }

private:
    using Work = typename N::Work;
    Vector3<Work> wind_{};                         // m/s
    Work linear_[bodies]{}, quadratic_[bodies]{};  // kg/s, kg/m
};

}  // namespace tumble

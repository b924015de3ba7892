// A row of the constraint matrix: a direction in the velocities of one body or two. It knows neither contact nor joint.
//
// Velocities are weighted by the roots of mass and moments of inertia (principal axes): u = (sqrt(m) v, sqrt(I_i) w_i).
// A constraint J M^-1/2 u has the inverse effective mass |J M^-1/2|^2. Rows are divided by its root, so that they are
// of unit length: then an impulse p adds p to the velocity along its own row, every effective mass is 1, and every
// number of a row lies in [-1, 1] whatever the masses are. An impulse gives the row its target velocity w:
//   p += w - row . u        (Catto 2005, sequential impulses)
// At a single row without bounds this is the textbook impulse, exact after one visit.
#pragma once

#include <tumble/scene.hpp>

namespace tumble {

template <class N>
struct WeightedVelocity {
    using Speed = typename ContactNumbers<N>::Speed;
    Vec3<Speed> linear, angular;  // sqrt(m) v h, world; sqrt(I_i) w_i h, principal axes

    // The size of the largest component.
    [[nodiscard]] Speed largest() const {
        Speed most{};
        for (int i = 0; i < 3; ++i)
            for (const Speed size : {magnitude_of(linear[i]), magnitude_of(angular[i])})
                if (size > most) most = size;
        return most;
    }
};

template <class N, bool pairs>
struct Row {
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;
    using Lever = typename C::Lever;
    using Speed = typename C::Speed;
    using Velocity = WeightedVelocity<N>;

    Vec3<Unit> linear, angular;  // of body a
    [[no_unique_address]] If<pairs, Vec3<Unit>, 0> linear_b, angular_b;
    Unit inverse;     // 1 / |J M^-1/2| times the root of the reduced mass, at most 1; 1: through both centres of mass
    Speed target{};   // the velocity along the row that the impulse makes
    Speed impulse{};  // the sum of the step
    Speed before, conjugate;  // the impulse before this sweep; the conjugate direction

    // Sets the row of one body, or of two. A direction is the world's, times the body's share of the motion; a lever is
    // arm x direction over the radii of gyration, in principal axes.
    void set(const Vec3<Unit>& direction, const Vec3<Lever>& lever) {
        set_scaled(direction, lever, C::inverse_root_of_one_and(dot(lever, lever)));
    }
    void set(const Vec3<Unit>& direction, const Vec3<Lever>& lever, const Vec3<Unit>& direction_b,
             const Vec3<Lever>& lever_b) requires pairs {
        set_scaled(direction, lever, C::inverse_root_of_one_and(dot(lever, lever) + dot(lever_b, lever_b)));
        linear_b = -times(direction_b, inverse);
        angular_b = -times_lever(lever_b);
    }

    // Sets the row of a spin, or of the difference of two. A lever is an axis times a length that is not below any
    // radius of gyration, over these, in principal axes.
    void set_spin(const Vec3<Lever>& lever) {
        inverse = C::inverse_root_of(dot(lever, lever));
        linear = Vec3<Unit>::Constant(Unit{});
        angular = times_lever(lever);
    }
    void set_spin(const Vec3<Lever>& lever, const Vec3<Lever>& lever_b) requires pairs {
        inverse = C::inverse_root_of(dot(lever, lever) + dot(lever_b, lever_b));
        linear = linear_b = Vec3<Unit>::Constant(Unit{});
        angular = times_lever(lever);
        angular_b = -times_lever(lever_b);
    }

    // The velocity along the row; b is null where only a moves.
    [[nodiscard]] TUMBLE_INLINE Speed velocity(const Velocity& a, [[maybe_unused]] const Velocity* b) const {
        auto sum = add_dot(dot(linear, a.linear), angular, a.angular);
        if constexpr (pairs)
            if (b != nullptr) sum = add_dot(add_dot(sum, linear_b, b->linear), angular_b, b->angular);
        return C::speed(sum);
    }
    TUMBLE_INLINE void push(Speed by, Velocity& a, [[maybe_unused]] Velocity* b) const {
        add(a.linear, linear, by);
        add(a.angular, angular, by);
        if constexpr (pairs) {
            if (b != nullptr) {
                add(b->linear, linear_b, by);
                add(b->angular, angular_b, by);
            }
        }
    }
    // Changes the impulse to this value.
    TUMBLE_INLINE void change_to(Speed wanted, Velocity& a, Velocity* b) {
        const Speed change = wanted - impulse;
        if (change == Speed{}) return;
        impulse = wanted;
        push(change, a, b);
    }
    // Velocity along the row above its target.
    [[nodiscard]] TUMBLE_INLINE Speed excess(const Velocity& a, const Velocity* b) const {
        return velocity(a, b) - target;
    }
    // One visit: the impulse that makes the target velocity, at least `lower`. Raises `most` to the size of its change.
    TUMBLE_INLINE void visit(Speed lower, Velocity& a, Velocity* b, Speed& most) {
        Speed wanted = impulse + (target - velocity(a, b));
        if (wanted < lower) wanted = lower;
        note(wanted - impulse, most);
        change_to(wanted, a, b);
    }

    // Raises `most` to the size of a change.
    TUMBLE_INLINE static void note(Speed change, Speed& most) {
        const Speed size = magnitude_of(change);
        if (size > most) most = size;
    }
    [[nodiscard]] static Vec3<Unit> times(const Vec3<Unit>& v, Unit s) {
        return {C::product(v.x(), s), C::product(v.y(), s), C::product(v.z(), s)};
    }
    [[nodiscard]] TUMBLE_INLINE static Speed product(Speed s, Unit u) { return narrow<Speed>(mul(s, u)); }

private:
    void set_scaled(const Vec3<Unit>& direction, const Vec3<Lever>& lever, Unit scale) {
        inverse = scale;
        linear = times(direction, inverse);
        angular = times_lever(lever);
    }
    [[nodiscard]] Vec3<Unit> times_lever(const Vec3<Lever>& lever) const {
        return {C::unit(lever.x(), inverse), C::unit(lever.y(), inverse), C::unit(lever.z(), inverse)};
    }
    [[nodiscard]] TUMBLE_INLINE static auto add_dot(auto sum, const Vec3<Unit>& row, const Vec3<Speed>& v) {
        return mul_add(mul_add(mul_add(sum, row.x(), v.x()), row.y(), v.y()), row.z(), v.z());
    }
    TUMBLE_INLINE static void add(Vec3<Speed>& v, const Vec3<Unit>& row, Speed impulse) {
        v.x() += narrow<Speed>(mul(row.x(), impulse));
        v.y() += narrow<Speed>(mul(row.y(), impulse));
        v.z() += narrow<Speed>(mul(row.z(), impulse));
    }
};

}  // namespace tumble

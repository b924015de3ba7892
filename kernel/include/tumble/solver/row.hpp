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
    static constexpr Vec3<Speed> WeightedVelocity::*parts[] = {&WeightedVelocity::linear, &WeightedVelocity::angular};

    // The size of the largest component.
    [[nodiscard]] Speed largest() const {
        Speed most{};
        for (int i = 0; i < 3; ++i)
            for (const Speed size : {magnitude_of(linear[i]), magnitude_of(angular[i])})
                if (size > most) most = size;
        return most;
    }
};

// What sweeps keep of a body between two of them.
template <class N>
struct SweepMotion {
    WeightedVelocity<N> before;   // the velocity before the present sweep
    WeightedVelocity<N> swept;    // what the last sweep has changed
    WeightedVelocity<N> further;  // with what the present sweep began beyond that
};

// Of the rows of one block.
template <class N>
struct Couplings {
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;
    Unit normal[2], tangents;  // what an impulse of 1 along one row adds along another: normal, tangent; both tangents
    Unit slip;                 // the square of the smaller `inverse` of the tangents over the larger

    // Of a normal and two tangents.
    template <class Row>
    void set(const Row* row, bool moves_b) {
        for (int k = 0; k < 2; ++k) normal[k] = row[0].coupling(row[k + 1], moves_b);
        set_tangents(row + 1, moves_b);
    }
    template <class Row>
    void set_tangents(const Row* row, bool moves_b) {
        tangents = row[0].coupling(row[1], moves_b);
        const bool rises = row[0].inverse < row[1].inverse;
        const Unit least = row[rises ? 0 : 1].inverse, most = row[rises ? 1 : 0].inverse;
        slip = least == most ? C::one() : C::over_square(C::product(least, least), most);
    }
};

template <class N, bool two_bodies>
struct Row {
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;
    using Lever = typename C::Lever;
    using Speed = typename C::Speed;
    using Velocity = WeightedVelocity<N>;

    Vec3<Unit> linear, angular;  // of body a
    [[no_unique_address]] If<two_bodies, Vec3<Unit>, 0> linear_b, angular_b;
    Unit inverse;     // 1 / |J M^-1/2| times the root of the reduced mass, at most 1; 1: through both centres of mass
    Speed target{};   // the velocity along the row that the impulse makes
    Speed impulse{};  // the sum of the step
    // Each solution has its own use for this room. Sweeps keep the impulse before the present sweep. A solution without
    // sweeps keeps the impulse that it proposes before it is divided by `inverse`. The search for a motion keeps the
    // velocity that is missing along the row.
    union {
        Speed before, unscaled, missing;
    };
    Speed proposed;  // by a solution without sweeps

    // Sets the row of one body, or of two. A direction is the world's, times the body's share of the motion; a lever is
    // arm x direction over the radii of gyration, in principal axes.
    void set(const Vec3<Unit>& direction, const Vec3<Lever>& lever) {
        set_scaled(direction, lever, C::inverse_root_of_one_and(dot(lever, lever)));
    }
    void set(const Vec3<Unit>& direction, const Vec3<Lever>& lever, const Vec3<Unit>& direction_b,
             const Vec3<Lever>& lever_b) requires two_bodies {
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
    void set_spin(const Vec3<Lever>& lever, const Vec3<Lever>& lever_b) requires two_bodies {
        inverse = C::inverse_root_of(dot(lever, lever) + dot(lever_b, lever_b));
        linear = linear_b = Vec3<Unit>::Constant(Unit{});
        angular = times_lever(lever);
        angular_b = -times_lever(lever_b);
    }

    // The velocity along the row; b is null where only a moves.
    [[nodiscard]] TUMBLE_INLINE Speed velocity(const Velocity& a, [[maybe_unused]] const Velocity* b) const {
        auto sum = add_dot(dot(linear, a.linear), angular, a.angular);
        if constexpr (two_bodies)
            if (b != nullptr) sum = add_dot(add_dot(sum, linear_b, b->linear), angular_b, b->angular);
        return C::speed(sum);
    }
    // Applies impulses of `count` rows. Each velocity is rounded once.
    template <int count>
    TUMBLE_INLINE static void push(const Row* row, const Speed (&by)[count], Velocity& a,
                                   [[maybe_unused]] Velocity* b) {
        const auto add = [&](Vec3<Speed> & v, Vec3<Unit> Row::*part) __attribute__((always_inline)) {
            for (int i = 0; i < 3; ++i) {
                auto sum = mul((row[0].*part)[i], by[0]);
                for (int k = 1; k < count; ++k) sum = mul_add(sum, (row[k].*part)[i], by[k]);
                v[i] += narrow<Speed>(sum);
            }
        };
        add(a.linear, &Row::linear);
        add(a.angular, &Row::angular);
        if constexpr (two_bodies) {
            if (b != nullptr) {
                add(b->linear, &Row::linear_b);
                add(b->angular, &Row::angular_b);
            }
        }
    }
    void push(Speed by, Velocity& a, Velocity* b) const {
        const Speed impulses[1] = {by};
        push(this, impulses, a, b);
    }
    // The same of one body of the two, a or b.
    void push_one(Speed by, bool is_a, Velocity& v) const requires two_bodies {
        const Vec3<Unit>&along = is_a ? linear : linear_b, &about = is_a ? angular : angular_b;
        for (int i = 0; i < 3; ++i) {
            v.linear[i] += narrow<Speed>(mul(along[i], by));
            v.angular[i] += narrow<Speed>(mul(about[i], by));
        }
    }
    // Changes the impulses of `count` rows.
    template <int count>
    TUMBLE_INLINE static void change(Row* row, const Speed (&by)[count], Velocity& a, Velocity* b) {
        bool any = false;
        for (int k = 0; k < count; ++k) {
            any = any || !(by[k] == Speed{});
            row[k].impulse += by[k];
        }
        if (any) push(row, by, a, b);
    }
    // Velocity along the row above its target.
    [[nodiscard]] TUMBLE_INLINE Speed excess(const Velocity& a, const Velocity* b) const {
        return velocity(a, b) - target;
    }
    // What an impulse of 1 along another row of the same bodies adds to the velocity along this one.
    [[nodiscard]] Unit coupling(const Row& other, [[maybe_unused]] bool moves_b) const {
        auto sum = add_dot(dot(linear, other.linear), angular, other.angular);
        if constexpr (two_bodies)
            if (moves_b) sum = add_dot(add_dot(sum, linear_b, other.linear_b), angular_b, other.angular_b);
        return narrow<Unit>(sum);
    }

    [[nodiscard]] static Vec3<Unit> times(const Vec3<Unit>& v, Unit s) {
        return {C::product(v.x(), s), C::product(v.y(), s), C::product(v.z(), s)};
    }
    [[nodiscard]] TUMBLE_INLINE static Speed product(Speed s, Unit u) { return narrow<Speed>(mul(s, u)); }
    [[nodiscard]] static Vec3<Speed> products(const Vec3<Speed>& v, Unit u) {
        return {product(v.x(), u), product(v.y(), u), product(v.z(), u)};
    }

private:
    void set_scaled(const Vec3<Unit>& direction, const Vec3<Lever>& lever, Unit scale) {
        inverse = scale;
        linear = times(direction, inverse);
        angular = times_lever(lever);
    }
    [[nodiscard]] Vec3<Unit> times_lever(const Vec3<Lever>& lever) const {
        return {C::unit(lever.x(), inverse), C::unit(lever.y(), inverse), C::unit(lever.z(), inverse)};
    }
    template <class Value>
    [[nodiscard]] TUMBLE_INLINE static auto add_dot(auto sum, const Vec3<Unit>& row, const Vec3<Value>& v) {
        return mul_add(mul_add(mul_add(sum, row.x(), v.x()), row.y(), v.y()), row.z(), v.z());
    }
};

}  // namespace tumble

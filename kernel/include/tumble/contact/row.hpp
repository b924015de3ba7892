// Sequential impulses (Catto 2005): sweeps over the points of an island. A visit gives a point its target velocity by
// an impulse. At a single point this is the textbook impulse J = -(1 + e) v_n / (1/m_a + 1/m_b + (r x n) . I^-1 (r x n)
// of both), exact after one visit.
//
// Velocities are weighted by the roots of mass and moments (principal axes), so that every effective mass is 1 and rows
// are of unit length. Then every number of a row lies in [-1, 1] whatever the masses are.
#pragma once

#include <tumble/contact/pair.hpp>

namespace tumble {

template <class N>
struct WeightedMotion {
    using Speed = typename ContactNumbers<N>::Speed;
    Vec3<Speed> linear, angular;  // sqrt(m) v h, world; sqrt(I_i) w_i h, principal axes
};

template <class N, Features features>
class Solver {
public:
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;
    using Length = typename C::Length;
    using Speed = typename C::Speed;
    using Pair = NearPair<N, features>;
    using Point = ContactPoint<N, features>;
    using Row = ContactRow<N, features.pairs>;
    using Motion = WeightedMotion<N>;

    // The directions of a pair's rows, in the principal axes of its bodies, times the bodies' shares of the motion.
    struct Directions {
        Vec3<Unit> linear[Point::directions], angular[Point::directions];
        [[no_unique_address]] If<features.pairs, Vec3<Unit>[Point::directions], 0> linear_b;
        [[no_unique_address]] If<features.pairs, Vec3<Unit>[Point::directions], 1> angular_b;
        bool moves_b = false;

        Directions(const Pair& pair, const Axes<N>& axes, [[maybe_unused]] const Axes<N>* axes_b) {
            for (int k = 0; k < rows(pair); ++k) {
                const Vec3<Unit>& direction = k == 0 ? pair.normal : pair.tangent[k - 1];
                if constexpr (features.pairs) {
                    if (axes_b != nullptr) {
                        moves_b = true;
                        linear[k] = times(direction, pair.share_a);
                        linear_b[k] = times(direction, pair.share_b);
                        angular[k] = axes.to_body(linear[k]);
                        angular_b[k] = axes_b->to_body(linear_b[k]);
                        continue;
                    }
                }
                linear[k] = direction;
                angular[k] = axes.to_body(direction);
            }
        }
    };
    [[nodiscard]] static int rows([[maybe_unused]] const Pair& pair) {
        if constexpr (features.friction) return pair.rubs ? 3 : 1;
        else return 1;
    }

    static void make_row(Row& row, const Point& point, const Directions& directions, int k, const CollisionShape<N>& a,
                         [[maybe_unused]] const CollisionShape<N>* b) {
        const Vec3<typename C::Lever> lever = levers(a, point.arm, directions.angular[k]);
        Vec3<typename C::Lever> lever_b = Vec3<typename C::Lever>::Constant({});
        auto squares = dot(lever, lever);
        if constexpr (features.pairs) {
            if (directions.moves_b) {
                lever_b = levers(*b, point.arm_b, directions.angular_b[k]);
                squares = squares + dot(lever_b, lever_b);
            }
        }
        row.inverse = C::inverse_root_of_one_and(squares);
        row.linear = times(directions.linear[k], row.inverse);
        row.angular = {C::unit(lever.x(), row.inverse), C::unit(lever.y(), row.inverse),
                       C::unit(lever.z(), row.inverse)};
        if constexpr (features.pairs) {
            if (directions.moves_b) {
                row.linear_b = -times(directions.linear_b[k], row.inverse);
                row.angular_b = {-C::unit(lever_b.x(), row.inverse), -C::unit(lever_b.y(), row.inverse),
                                 -C::unit(lever_b.z(), row.inverse)};
            }
        }
    }

    // The velocity along a row; b is null where only a moves.
    [[nodiscard]] TUMBLE_INLINE static Speed velocity(const Row& row, const Motion& a,
                                                      [[maybe_unused]] const Motion* b) {
        auto sum = add_dot(dot(row.linear, a.linear), row.angular, a.angular);
        if constexpr (features.pairs)
            if (b != nullptr) sum = add_dot(add_dot(sum, row.linear_b, b->linear), row.angular_b, b->angular);
        return C::speed(sum);
    }
    TUMBLE_INLINE static void push(const Row& row, Speed impulse, Motion& a, [[maybe_unused]] Motion* b) {
        add(a.linear, row.linear, impulse);
        add(a.angular, row.angular, impulse);
        if constexpr (features.pairs) {
            if (b != nullptr) {
                add(b->linear, row.linear_b, impulse);
                add(b->angular, row.angular_b, impulse);
            }
        }
    }

    // One visit of a point. Raises `most` to the largest change of an impulse.
    static void visit(const Pair& pair, Point& point, Motion& a, Motion* b, Speed& most) {
        Speed pushed = point.pushed[0] + (point.target - velocity(point.row[0], a, b));
        if (pushed < Speed{}) pushed = Speed{};
        note(pushed - point.pushed[0], most);
        give(point, 0, pushed, a, b);
        if constexpr (features.friction) {
            if (pair.rubs) rub(pair, point, a, b, most);
        }
    }

private:
    // Coulomb's cone. The impulse stops the point along both tangents. Where that takes more than friction times the
    // normal impulse, the point slips: both tangents take steps in proportion to their velocities, and the sum is
    // scaled back to the cone. Once this changes nothing any more, friction is opposite to the slip.
    static void rub(const Pair& pair, Point& point, Motion& a, Motion* b, Speed& most) {
        const Speed limit = C::times_friction(pair.friction, product(point.pushed[0], point.row[0].inverse));
        const Speed before[2] = {point.pushed[1], point.pushed[2]};
        Speed wanted[2];
        for (int k = 0; k < 2; ++k) give(point, 1 + k, before[k] - slip(point, k, a, b), a, b);
        if (square(point, point.pushed[1], point.pushed[2]) > mul(limit, limit)) {
            for (int k = 0; k < 2; ++k) give(point, 1 + k, before[k], a, b);
            const Unit least =
                point.row[1].inverse < point.row[2].inverse ? point.row[1].inverse : point.row[2].inverse;
            for (int k = 0; k < 2; ++k) {
                const Unit inverse = point.row[1 + k].inverse;
                Speed step = slip(point, k, a, b);
                if (inverse > least) step = C::over_square(product(product(step, least), least), inverse);
                wanted[k] = before[k] - step;
            }
            const auto squares = square(point, wanted[0], wanted[1]);
            if (squares > mul(limit, limit)) {
                const Unit share = C::share(limit, squares);
                for (Speed& w : wanted) w = product(w, share);
            }
            for (int k = 0; k < 2; ++k) give(point, 1 + k, wanted[k], a, b);
        }
        for (int k = 0; k < 2; ++k) note(point.pushed[1 + k] - before[k], most);
    }
    [[nodiscard]] static Speed slip(const Point& point, int k, const Motion& a, const Motion* b) {
        return velocity(point.row[1 + k], a, b) - surface(point, 1 + k);
    }
    // Of the tangential impulse.
    [[nodiscard]] static auto square(const Point& point, Speed first, Speed second) {
        const Speed x = product(first, point.row[1].inverse), y = product(second, point.row[2].inverse);
        return mul_add(mul(x, x), y, y);
    }

    [[nodiscard]] static Speed surface([[maybe_unused]] const Point& point, [[maybe_unused]] int k) {
        if constexpr (features.turntables) return point.carried[k];
        else return Speed{};
    }
    TUMBLE_INLINE static void give(Point& point, int k, Speed pushed, Motion& a, Motion* b) {
        const Speed change = pushed - point.pushed[k];
        if (change == Speed{}) return;
        point.pushed[k] = pushed;
        push(point.row[k], change, a, b);
    }
    TUMBLE_INLINE static void note(Speed change, Speed& most) {
        const Speed size = magnitude_of(change);
        if (size > most) most = size;
    }
    [[nodiscard]] static Vec3<Unit> times(const Vec3<Unit>& v, Unit s) {
        return {C::product(v.x(), s), C::product(v.y(), s), C::product(v.z(), s)};
    }
    [[nodiscard]] TUMBLE_INLINE static Speed product(Speed s, Unit u) { return narrow<Speed>(mul(s, u)); }
    [[nodiscard]] static Vec3<typename C::Lever> levers(const CollisionShape<N>& shape, const Vec3<Length>& arm,
                                                        const Vec3<Unit>& direction) {
        const Vec3<Length> c = cross<Length>(arm, direction);
        return {shape.per_gyration[0](c.x()), shape.per_gyration[1](c.y()), shape.per_gyration[2](c.z())};
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

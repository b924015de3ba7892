// Coulomb's law of friction: the impulses of rows at right angles to a normal, or about it, are at most a coefficient
// times that of the normal.
#pragma once

#include <tumble/contact/row.hpp>

namespace tumble {

template <class N, bool pairs>
struct Friction {
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;
    using Speed = typename C::Speed;
    using Row = tumble::Row<N, pairs>;
    using Velocity = WeightedVelocity<N>;

    // One visit of two tangents. Their impulse stops the point. Where that takes more than friction times the normal
    // impulse, the point slips: both tangents take steps in proportion to their velocities, and the sum is scaled back
    // to the cone. Once this changes nothing any more, friction is opposite to the slip. Raises `most` to the largest
    // change of an impulse.
    static void visit(const Row& normal, Row* tangent, typename C::Friction coefficient, Velocity& a, Velocity* b,
                      Speed& most) {
        const Speed limit = limit_of(normal, coefficient);
        const Row &first = tangent[0], &second = tangent[1];
        const Speed before[2] = {first.impulse, second.impulse};
        Speed wanted[2];
        for (int k = 0; k < 2; ++k) tangent[k].change_to(before[k] - tangent[k].excess(a, b), a, b);
        if (square(tangent, first.impulse, second.impulse) > mul(limit, limit)) {
            for (int k = 0; k < 2; ++k) tangent[k].change_to(before[k], a, b);
            const Unit least = first.inverse < second.inverse ? first.inverse : second.inverse;
            for (int k = 0; k < 2; ++k) {
                const Unit inverse = tangent[k].inverse;
                Speed step = tangent[k].excess(a, b);
                if (inverse > least) step = C::over_square(Row::product(Row::product(step, least), least), inverse);
                wanted[k] = before[k] - step;
            }
            const auto squares = square(tangent, wanted[0], wanted[1]);
            if (squares > mul(limit, limit)) {
                const Unit share = C::share(limit, squares);
                for (Speed& w : wanted) w = Row::product(w, share);
            }
            for (int k = 0; k < 2; ++k) tangent[k].change_to(wanted[k], a, b);
        }
        for (int k = 0; k < 2; ++k) Row::note(tangent[k].impulse - before[k], most);
    }
    // One visit of a row by itself.
    static void visit_one(const Row& normal, Row& row, typename C::Friction coefficient, Velocity& a, Velocity* b,
                          Speed& most) {
        const Speed limit = limit_of(normal, coefficient), before = row.impulse;
        Speed wanted = before - row.excess(a, b);
        const Speed size = Row::product(wanted, row.inverse);
        if (magnitude_of(size) > limit) wanted = Row::product(wanted, C::share(limit, mul(size, size)));
        row.change_to(wanted, a, b);
        Row::note(row.impulse - before, most);
    }

private:
    [[nodiscard]] static Speed limit_of(const Row& normal, typename C::Friction coefficient) {
        return C::times_friction(coefficient, Row::product(normal.impulse, normal.inverse));
    }
    // Of the tangential impulse.
    [[nodiscard]] static auto square(const Row* tangent, Speed first, Speed second) {
        const Speed x = Row::product(first, tangent[0].inverse), y = Row::product(second, tangent[1].inverse);
        return mul_add(mul(x, x), y, y);
    }
};

}  // namespace tumble

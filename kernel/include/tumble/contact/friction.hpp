// Coulomb's law of friction over three rows: a normal and two tangents at right angles to it.
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

    // One visit of the tangents. Their impulse stops the point. Where that takes more than friction times the normal
    // impulse, the point slips: both tangents take steps in proportion to their velocities, and the sum is scaled back
    // to the cone. Once this changes nothing any more, friction is opposite to the slip. Raises `most` to the largest
    // change of an impulse.
    static void visit(Row (&row)[3], typename C::Friction coefficient, Velocity& a, Velocity* b, Speed& most) {
        const Speed limit = C::times_friction(coefficient, Row::product(row[0].impulse, row[0].inverse));
        Row& first = row[1];
        Row& second = row[2];
        const Speed before[2] = {first.impulse, second.impulse};
        Speed wanted[2];
        for (int k = 0; k < 2; ++k) row[1 + k].change_to(before[k] - row[1 + k].excess(a, b), a, b);
        if (square(row, first.impulse, second.impulse) > mul(limit, limit)) {
            for (int k = 0; k < 2; ++k) row[1 + k].change_to(before[k], a, b);
            const Unit least = first.inverse < second.inverse ? first.inverse : second.inverse;
            for (int k = 0; k < 2; ++k) {
                const Unit inverse = row[1 + k].inverse;
                Speed step = row[1 + k].excess(a, b);
                if (inverse > least) step = C::over_square(Row::product(Row::product(step, least), least), inverse);
                wanted[k] = before[k] - step;
            }
            const auto squares = square(row, wanted[0], wanted[1]);
            if (squares > mul(limit, limit)) {
                const Unit share = C::share(limit, squares);
                for (Speed& w : wanted) w = Row::product(w, share);
            }
            for (int k = 0; k < 2; ++k) row[1 + k].change_to(wanted[k], a, b);
        }
        for (int k = 0; k < 2; ++k) Row::note(row[1 + k].impulse - before[k], most);
    }

private:
    // Of the tangential impulse.
    [[nodiscard]] static auto square(const Row (&row)[3], Speed first, Speed second) {
        const Speed x = Row::product(first, row[1].inverse), y = Row::product(second, row[2].inverse);
        return mul_add(mul(x, x), y, y);
    }
};

}  // namespace tumble

// Coulomb's law of friction: the impulses of rows at right angles to a normal, or about it, are at most a coefficient
// times that of the normal.
#pragma once

#include <tumble/solver/row.hpp>

namespace tumble {

template <class N, bool two_bodies>
struct FrictionCone {
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;
    using Speed = typename C::Speed;
    using Row = tumble::Row<N, two_bodies>;

    // The changes of two tangents' impulses in one visit. `excess`: their velocities above their targets. The impulses
    // stop the point. Where that takes more than `limit`, friction times the normal impulse, the point slips: both
    // tangents take steps in proportion to their velocities, and the sum is scaled back to the cone. Once this changes
    // nothing any more, friction is opposite to the slip.
    TUMBLE_INLINE static void solve(const Row* tangent, const Speed (&excess)[2], const Couplings<N>& couplings,
                                    Speed limit, Speed* change) {
        const Row &first = tangent[0], &second = tangent[1];
        change[0] = -excess[0];
        change[1] = -(excess[1] + Row::product(change[0], couplings.tangents));
        if (!(square(tangent, first.impulse + change[0], second.impulse + change[1]) > mul(limit, limit))) return;
        Speed step[2] = {excess[0], excess[1]};
        Speed& of_larger = step[first.inverse < second.inverse ? 1 : 0];
        of_larger = Row::product(of_larger, couplings.slip);
        Speed wanted[2] = {first.impulse - step[0], second.impulse - step[1]};
        const auto squares = square(tangent, wanted[0], wanted[1]);
        if (squares > mul(limit, limit)) {
            const Unit share = C::share(limit, squares);
            for (Speed& w : wanted) w = Row::product(w, share);
        }
        for (int k = 0; k < 2; ++k) change[k] = wanted[k] - tangent[k].impulse;
    }
    // The same of one row by itself.
    [[nodiscard]] static Speed solve_one(const Row& row, Speed excess, Speed limit) {
        Speed wanted = row.impulse - excess;
        const Speed size = Row::product(wanted, row.inverse);
        // The squares are compared, because the share divides by the root of one: it may underflow to zero.
        const auto squares = mul(size, size);
        if (squares > mul(limit, limit)) wanted = Row::product(wanted, C::share(limit, squares));
        return wanted - row.impulse;
    }
    // Whether impulses of two tangents are in the cone.
    [[nodiscard]] static bool contains(const Row* tangent, const Speed (&impulse)[2], Speed limit) {
        return !(square(tangent, impulse[0], impulse[1]) > mul(limit, limit));
    }
    // The most that the impulses may be, for the impulse of a normal.
    [[nodiscard]] static Speed limit_of(const Row& normal, Speed impulse, typename C::Friction coefficient) {
        return C::times_friction(coefficient, Row::product(impulse, normal.inverse));
    }

private:
    // Of the tangential impulse.
    [[nodiscard]] static auto square(const Row* tangent, Speed first, Speed second) {
        const Speed x = Row::product(first, tangent[0].inverse), y = Row::product(second, tangent[1].inverse);
        return mul_add(mul(x, x), y, y);
    }
};

}  // namespace tumble

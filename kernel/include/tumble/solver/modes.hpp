// Modes: rows of one pair that have a place together, solved at once.
#pragma once

#include <tumble/solver/row.hpp>

namespace tumble {

// The rows of points in a plane, along one direction each, span no more than three directions of the velocities of
// their bodies. An orthonormal basis of these are the modes. A visit of all modes is exact for all rows, and what is
// symmetric stays so, where visits of one row after the other depend on their order. Impulses are those of the rows: a
// change along a mode is shared among them as their places say.
template <class N, bool two_bodies, int most_rows>
struct Modes {
    using C = ContactNumbers<N>;
    using Lever = typename C::Lever;
    using Unit = typename C::Unit;
    using Speed = typename C::Speed;
    using Row = tumble::Row<N, two_bodies>;
    static constexpr int count = 3;
    // For each row what a mode takes of it. All that one mode takes is at most 1.
    using Places = Unit[most_rows][count];

    Row mode[count];
    Lever share[most_rows][count];  // of an impulse along a mode, for each row

    // Makes the modes of row_of(0) to row_of(rows - 1): the sums of the rows times their places, made orthonormal one
    // after the other (Gram and Schmidt). False where they hardly differ: modes lose six bits at most, and shares stay
    // below 64.
    template <class RowOf>
    [[nodiscard]] bool make(RowOf&& row_of, const Places& places, int rows, bool moves_b) {
        for (int k = 0; k < count; ++k) {
            for_each_part(moves_b, [&](Vec3<Unit> Row::*part) {
                decltype(mul(Unit{}, Unit{})) sum[3]{};
                for (int i = 0; i < rows; ++i) {
                    if (places[i][k] == Unit{}) continue;
                    for (int c = 0; c < 3; ++c) sum[c] = mul_add(sum[c], (row_of(i).*part)[c], places[i][k]);
                }
                for (int c = 0; c < 3; ++c) (mode[k].*part)[c] = narrow<Unit>(sum[c]);
            });
            for (int i = 0; i < rows; ++i) share[i][k] = C::lever(places[i][k]);
            for (int l = 0; l < k; ++l) {
                const Unit along = mode[k].coupling(mode[l], moves_b);
                for_each_part(moves_b,
                              [&](Vec3<Unit> Row::*part) { mode[k].*part -= Row::times(mode[l].*part, along); });
                for (int i = 0; i < rows; ++i) share[i][k] -= narrow<Lever>(mul(along, share[i][l]));
            }
            const Unit square = mode[k].coupling(mode[k], moves_b);
            bool regular = square > least_square();
            for (int i = 0; i < rows; ++i) regular = regular && !(magnitude_of(share[i][k]) > C::lever(C::one()));
            if (!regular) return false;
            const Lever inverse = C::inverse_root(square);
            for_each_part(moves_b, [&](Vec3<Unit> Row::*part) {
                for (Unit& component : mode[k].*part) component = C::unit(inverse, component);
            });
            for (int i = 0; i < rows; ++i) share[i][k] = narrow<Lever>(mul(share[i][k], inverse));
        }
        return true;
    }
    // Sets the targets from those of the rows.
    template <class RowOf>
    void set_targets(RowOf&& row_of, int rows) {
        for (int k = 0; k < count; ++k) {
            auto sum = mul(share[0][k], row_of(0).target);
            for (int i = 1; i < rows; ++i) sum = mul_add(sum, share[i][k], row_of(i).target);
            mode[k].target = C::speed(sum);
        }
    }
    // By how much a velocity that meets the targets of the modes misses that of a row.
    [[nodiscard]] Speed missed(const Row& row, bool moves_b) const {
        Speed sum = -row.target;
        for (int k = 0; k < count; ++k) sum += Row::product(mode[k].target, mode[k].coupling(row, moves_b));
        return magnitude_of(sum);
    }
    // What impulses along the modes change of that of row i.
    [[nodiscard]] TUMBLE_INLINE Speed change(int i, const Speed (&by)[count]) const {
        const Lever(&of)[count] = share[i];
        return C::speed(mul_add(mul_add(mul(of[0], by[0]), of[1], by[1]), of[2], by[2]));
    }

private:
    // 2^-12
    [[nodiscard]] static Unit least_square() { return C::eighth(C::eighth(C::eighth(C::eighth(C::one())))); }
    template <class F>
    static void for_each_part(bool moves_b, F&& f) {
        f(&Row::linear);
        f(&Row::angular);
        if constexpr (two_bodies)
            if (moves_b) {
                f(&Row::linear_b);
                f(&Row::angular_b);
            }
    }
};

}  // namespace tumble

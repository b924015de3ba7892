// Sweeps over rows until no impulse changes any more (sequential impulses, Catto 2005, with momentum).
#pragma once

#include <tumble/contact/bounds.hpp>
#include <tumble/contact/friction.hpp>

namespace tumble {

template <class N, bool pairs, bool friction>
struct Solver {
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;
    using Speed = typename C::Speed;
    using Bounds = ContactBounds<N>;
    using Row = tumble::Row<N, pairs>;
    using Velocity = WeightedVelocity<N>;
    static constexpr int most_rows = friction ? 3 : 1;

    // Rows that are solved at one visit: a normal, which only pushes, and two tangents where there is friction.
    struct Block {
        Row (&row)[most_rows];
        int rows;
        typename C::Friction coefficient;
        Velocity& a;
        Velocity* b;  // null where only a moves
    };
    // Raises `most` to the largest change of an impulse.
    static void visit(const Block& block, Speed& most) {
        block.row[0].visit(Speed{}, block.a, block.b, most);
        if constexpr (friction)
            if (block.rows > 1) Friction<N, pairs>::visit(block.row, block.coefficient, block.a, block.b, most);
    }
    // Applies the impulses of a block to velocities that do not hold them yet.
    static void push(const Block& block) {
        for (int k = 0; k < block.rows; ++k)
            if (!(block.row[k].impulse == Speed{})) block.row[k].push(block.row[k].impulse, block.a, block.b);
    }

    // At most `bound` sweeps, until no impulse changes by more than `enough`. The change of a sweep counts as the
    // gradient of a function that is least at the solution. The next sweep starts with a step along it, as conjugate
    // gradients do (Silcowitz, Niebe and Erleben 2010). Plain sweeps carry a load through a stack by one box per sweep.
    // The momentum is the ratio of the squares of the largest changes, at most 1. It restarts from 0 where these grow.
    // Returns the largest change of the last sweep.
    template <class ForEachBlock>
    static Speed sweep(ForEachBlock&& for_each_block, Speed enough, int bound, bool with_momentum = true) {
        Speed last{};
        Unit momentum{};
        for (int sweep = 0; sweep < bound; ++sweep) {
            if (sweep > 0 && with_momentum) for_each_block([&](const Block& block) { go_on(block, momentum); });
            Speed most{};
            for_each_block([&](const Block& block) {
                for (int k = 0; k < block.rows; ++k) block.row[k].before = block.row[k].impulse;
                visit(block, most);
            });
            if (!(most > enough)) return most;
            if (sweep == 0 || Bounds::diverges(most, last)) {
                momentum = {};
            } else {
                const Unit ratio = most < last ? C::ratio(most, last) : C::one();
                momentum = C::product(ratio, ratio);
            }
            last = most;
        }
        return last;
    }

private:
    static void go_on(const Block& block, Unit momentum) {
        for (int k = 0; k < block.rows; ++k) {
            Row& row = block.row[k];
            const Speed changed = row.impulse - row.before;
            const Speed further = momentum == Unit{} ? Speed{} : narrow<Speed>(mul(row.conjugate, momentum));
            row.conjugate = changed + further;
            if (further == Speed{}) continue;
            row.impulse += further;
            row.push(further, block.a, block.b);
        }
    }
};

}  // namespace tumble

// Sweeps over rows until no impulse changes any more (sequential impulses, Catto 2005, with momentum).
#pragma once

#include <tumble/contact/bounds.hpp>
#include <tumble/contact/friction.hpp>

namespace tumble {

template <class N, bool pairs, bool friction, bool resists_spin = false>
struct Solver {
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;
    using Speed = typename C::Speed;
    using Bounds = ContactBounds<N>;
    using Row = tumble::Row<N, pairs>;
    using Velocity = WeightedVelocity<N>;
    using Friction = tumble::Friction<N, pairs>;
    static constexpr int most_rows = friction ? 3 : 1;

    // Rows of the relative spin, about two tangents and about the normal, with the resistance to it.
    struct Resistance {
        Row* row = nullptr;
        typename C::Friction rolling{}, spinning{};
    };
    // Rows that are solved at one visit: a normal, which only pushes, and two tangents where there is friction.
    struct Block {
        Row (&row)[most_rows];
        int rows;
        typename C::Friction coefficient;
        Velocity& a;
        Velocity* b;  // null where only a moves
        [[no_unique_address]] If<resists_spin, Resistance, 0> resistance{};

        template <class F>
        void for_each_row(F&& f) const {
            for (int k = 0; k < rows; ++k) f(row[k]);
            if constexpr (resists_spin)
                for (int k = 0; resistance.row != nullptr && k < 3; ++k) f(resistance.row[k]);
        }
    };
    // Raises `most` to the largest change of an impulse.
    static void visit(const Block& block, Speed& most) {
        block.row[0].visit(Speed{}, block.a, block.b, most);
        if constexpr (friction)
            if (block.rows > 1) Friction::visit(block.row[0], block.row + 1, block.coefficient, block.a, block.b, most);
        if constexpr (resists_spin) {
            const Resistance& resists = block.resistance;
            if (resists.row == nullptr) return;
            Friction::visit(block.row[0], resists.row, resists.rolling, block.a, block.b, most);
            Friction::visit_one(block.row[0], resists.row[2], resists.spinning, block.a, block.b, most);
        }
    }
    // Applies the impulses of a block to velocities that do not hold them yet.
    static void push(const Block& block) {
        block.for_each_row([&](const Row& row) {
            if (!(row.impulse == Speed{})) row.push(row.impulse, block.a, block.b);
        });
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
                block.for_each_row([](Row& row) { row.before = row.impulse; });
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
        block.for_each_row([&](Row& row) {
            const Speed changed = row.impulse - row.before;
            const Speed further = momentum == Unit{} ? Speed{} : narrow<Speed>(mul(row.conjugate, momentum));
            row.conjugate = changed + further;
            if (further == Speed{}) return;
            row.impulse += further;
            row.push(further, block.a, block.b);
        });
    }
};

}  // namespace tumble

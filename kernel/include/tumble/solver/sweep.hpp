// Sweeps over rows until no impulse changes any more (sequential impulses, Catto 2005, with momentum).
#pragma once

#include <tumble/solver/cone.hpp>

namespace tumble {

// What has rows: it calls f(block) for each of its blocks of rows, always in the same order.
template <class Source, class Block>
concept RowSource = requires(Source& for_each_block, void (&f)(const Block&)) {
    for_each_block(f);
};

template <class N, bool two_bodies, bool friction, bool resists_spin = false>
struct Sweep {
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;
    using Speed = typename C::Speed;
    using Row = tumble::Row<N, two_bodies>;
    using Velocity = WeightedVelocity<N>;
    using Cone = FrictionCone<N, two_bodies>;
    using Couplings = tumble::Couplings<N>;
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
        const Couplings* couplings = nullptr;  // of three rows
        typename C::Friction coefficient{};
        Velocity& a;
        Velocity* b = nullptr;  // null where only a moves
        [[no_unique_address]] If<resists_spin, Resistance, 0> resistance{};

        // Calls f(first row, its number of rows as a constant) for the rows that have a place together.
        template <class F>
        void for_each_group(F&& f) const {
            if constexpr (friction) {
                if (rows > 1) f(row, std::integral_constant<int, most_rows>{});
                else f(row, std::integral_constant<int, 1>{});
            } else {
                f(row, std::integral_constant<int, 1>{});
            }
            if constexpr (resists_spin)
                if (resistance.row != nullptr) f(resistance.row, std::integral_constant<int, 3>{});
        }
    };
    // Raises `most` to the largest change of an impulse.
    static void visit(const Block& block, Speed& most) {
        Row* const row = block.row;
        const Speed push = push_of(row[0], block, most), wanted = row[0].impulse + push;
        [[maybe_unused]] const auto limit = [&](typename C::Friction coefficient) {
            return Cone::limit_of(row[0], wanted, coefficient);
        };
        if constexpr (friction) {
            if (block.rows > 1) {
                const Couplings& couplings = *block.couplings;
                Speed excess[2], by[3] = {push, {}, {}};
                for (int k = 0; k < 2; ++k)
                    excess[k] = row[k + 1].excess(block.a, block.b) + Row::product(push, couplings.normal[k]);
                Cone::solve(row + 1, excess, couplings, limit(block.coefficient), by + 1);
                for (int k = 1; k < 3; ++k)
                    if (!C::fits(row[k].impulse + by[k])) [[unlikely]]
                        by[k] = Speed{};
                change(block, row, by, most);
            } else {
                change(block, row, {push}, most);
            }
        } else {
            change(block, row, {push}, most);
        }
        if constexpr (resists_spin) {
            const Resistance& resists = block.resistance;
            if (resists.row == nullptr) return;
            Row* const spin = resists.row;
            const Speed excess[2] = {spin[0].excess(block.a, block.b), spin[1].excess(block.a, block.b)};
            Couplings couplings;
            couplings.set_tangents(spin, block.b != nullptr);
            Speed by[2];
            Cone::solve(spin, excess, couplings, limit(resists.rolling), by);
            change(block, spin, by, most);
            const Speed about = spin[2].excess(block.a, block.b);
            change(block, spin + 2, {Cone::solve_one(spin[2], about, limit(resists.spinning))}, most);
        }
    }
    // Applies the impulses of a block to velocities that do not hold them yet.
    static void push(const Block& block) {
        block.for_each_group([&](const Row* row, auto count) {
            Speed by[count];
            for (int k = 0; k < count; ++k) by[k] = row[k].impulse;
            Row::push(row, by, block.a, block.b);
        });
    }

    // At most `bound` sweeps, until no impulse changes by more than `enough`. The change of a sweep counts as the
    // gradient of a function that is least at the solution. The next sweep starts with a step along it, as conjugate
    // gradients do (Silcowitz, Niebe and Erleben 2010). Plain sweeps carry a load through a stack by one box per sweep.
    // The momentum is the ratio of the squares of the largest changes, at most 1. It restarts from 0 where these grow.
    // Returns the largest change of the last sweep.
    template <RowSource<Block> Source>
    static Speed run(Source&& for_each_block, Speed enough, int bound, bool with_momentum = true) {
        Speed last{};
        Unit momentum{};
        for (int sweep = 0; sweep < bound; ++sweep) {
            if (sweep > 0 && with_momentum) for_each_block([&](const Block& block) { go_on(block, momentum); });
            Speed most{};
            for_each_block([&](const Block& block) {
                block.for_each_group([](Row* row, auto count) {
                    for (int k = 0; k < count; ++k) row[k].before = row[k].impulse;
                });
                visit(block, most);
            });
            if (!(most > enough)) return most;
            if (sweep == 0 || diverges(most, last)) {
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
    // The momentum of the sweeps restarts where the changes of impulses grow by more than an eighth.
    [[nodiscard]] static bool diverges(Speed change, Speed last) { return change > last + C::eighth(last); }
    // The change of a normal's impulse in one visit. An impulse that does not fit belongs to no solution, as of a body
    // that is squeezed between two that come on: it stays as it is.
    TUMBLE_INLINE static Speed push_of(const Row& row, const Block& block, Speed& most) {
        const Speed excess = row.excess(block.a, block.b);
        const Speed wanted = row.impulse - excess;
        if (wanted < Speed{}) return -row.impulse;
        // An impact turns a speed round, which takes twice its impulse.
        if (C::fits(C::half(wanted))) [[likely]]
            return -excess;
        note(excess, most);
        return Speed{};
    }
    static void go_on(const Block& block, Unit momentum) {
        block.for_each_group([&](Row* row, auto count) {
            Speed further[count];
            for (int k = 0; k < count; ++k) {
                const Speed changed = row[k].impulse - row[k].before;
                further[k] = momentum == Unit{} ? Speed{} : narrow<Speed>(mul(row[k].conjugate, momentum));
                if (!C::fits(row[k].impulse + further[k])) further[k] = Speed{};
                row[k].conjugate = changed + further[k];
            }
            if (!(momentum == Unit{})) Row::change(row, further, block.a, block.b);
        });
    }
    template <int count>
    TUMBLE_INLINE static void change(const Block& block, Row* row, const Speed (&by)[count], Speed& most) {
        for (int k = 0; k < count; ++k) note(by[k], most);
        Row::change(row, by, block.a, block.b);
    }
    TUMBLE_INLINE static void note(Speed change, Speed& most) {
        const Speed size = magnitude_of(change);
        if (size > most) most = size;
    }
};

}  // namespace tumble

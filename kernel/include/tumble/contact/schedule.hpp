// Who steps together, and whom a step wakes at its end: bodies that touch each other or that loads couple, or each body
// by itself.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/contact/islands.hpp>

namespace tumble {

template <int bodies>
struct Schedule {
    Islands<bodies> islands;
    BodyGroup<bodies> wakes;
    bool joins[bodies]{};             // not of bodies that have flown freely
    std::int16_t next[bodies];        // the next body of its island; -1: it is the last
    std::int16_t first_pair[bodies];  // of an island, by its first body: PairList::link()

    // Chains the bodies of each island, in their order. Call when all are connected.
    void chain(int count) {
        islands.finish(count);
        for (int b = 0; b < count; ++b) next[b] = -1;
        for (int b = count - 1; b >= 0; --b) {
            const int root = joins[b] ? islands.root(b) : b;
            if (root == b) continue;
            next[b] = next[root];
            next[root] = static_cast<std::int16_t>(b);
        }
    }
    // True of the first body of an island.
    [[nodiscard]] bool leads(int b) const { return joins[b] && islands.root(b) == b; }
    // Calls step(first body, bodies) for each island.
    template <class F>
    void for_each_island(int count, F&& step) const {
        BodyGroup<bodies> group;
        for (int root = 0; root < count; ++root) {
            if (!leads(root)) continue;
            group.count = 0;
            for (int b = root; b >= 0; b = next[b]) group.add(b);
            step(root, group);
        }
    }
};

// Of bodies that touch only planes, and that no load couples.
template <int bodies>
struct LoneBodies {
    // The same of the bodies for which joins(b). The one body of a world joins where any does.
    template <class Joins, class F>
    static void for_each_island(int count, Joins&& joins, F&& step) {
        if constexpr (bodies == 1) {
            step(0, OnlyBody{});
        } else {
            for (int b = 0; b < count; ++b)
                if (joins(b)) step(b, BodyGroup<bodies>{b});
        }
    }
};

}  // namespace tumble

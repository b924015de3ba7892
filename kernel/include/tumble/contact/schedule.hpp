// Who steps together, and whom a step wakes at its end.
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
    // Sets `group` to its bodies.
    void take(int root, BodyGroup<bodies>& group) const {
        group.count = 0;
        for (int b = root; b >= 0; b = next[b]) group.add(b);
    }
};

}  // namespace tumble

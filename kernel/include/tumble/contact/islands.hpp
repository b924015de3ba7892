// Islands: the bodies that a step must advance together, because near pairs or loads connect them.
#pragma once

#include <tumble/config.hpp>

namespace tumble {

template <int capacity>
class Islands {
public:
    void clear(int bodies) {
        for (int b = 0; b < bodies; ++b) parent_[b] = static_cast<std::int16_t>(b);
    }
    // Call when all are connected, before root().
    void finish(int bodies) {
        // A parent comes before its children.
        for (int b = 0; b < bodies; ++b) parent_[b] = parent_[parent_[b]];
    }
    // The first of the bodies of b's island.
    [[nodiscard]] int root(int b) const { return parent_[b]; }

    void connect(int a, int b) {
        a = find(a);
        b = find(b);
        if (a == b) return;
        if (a < b) parent_[b] = static_cast<std::int16_t>(a);
        else parent_[a] = static_cast<std::int16_t>(b);
    }

private:
    [[nodiscard]] int find(int b) {
        while (parent_[b] != b) b = parent_[b] = parent_[parent_[b]];
        return b;
    }

    std::int16_t parent_[capacity];
};

}  // namespace tumble

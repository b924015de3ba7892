// Changes of motion of bodies over a step or a part of it. A spin's part has the scale of the body's spin.
#pragma once

#include <tumble/body/stage.hpp>

namespace tumble {

template <class N, int bodies>
class Kicks {
public:
    [[nodiscard]] constexpr Kick<N>& operator[](int b) { return kick_[bodies == 1 ? 0 : b]; }
    [[nodiscard]] const Kick<N>& operator[](int b) const { return kick_[bodies == 1 ? 0 : b]; }
    // Converts a kick to a scale with more halvings, or fewer.
    TUMBLE_INLINE void rescale(int b, int halvings) {
        if (halvings != 0) [[unlikely]]
            halve(b, halvings);
    }

private:
    [[gnu::noinline, gnu::cold]] void halve(int b, int halvings) {
        for (auto& change : kick_[b].angular) change = N::halved(change, halvings);
    }

    Kick<N> kick_[bodies]{};
};

}  // namespace tumble

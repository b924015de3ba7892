// The layers of the bodies: which of them touch each other.
#pragma once

#include <tumble/body/setup.hpp>
#include <tumble/scene.hpp>

namespace tumble {

// Without Features::layers it takes no room, and all bodies touch each other.
template <Features features>
class Layers {
public:
    constexpr void set([[maybe_unused]] int b, [[maybe_unused]] const BodySpec& spec) {
        if constexpr (features.layers) of_body_[b] = spec.layers;
    }
    // Whether two bodies have a layer in common.
    [[nodiscard]] TUMBLE_INLINE constexpr bool meet([[maybe_unused]] int a, [[maybe_unused]] int b) const {
        if constexpr (features.layers) return (of_body_[a] & of_body_[b]) != 0;
        else return true;
    }

private:
    [[no_unique_address]] If<features.layers, std::uint16_t[(features.bodies > 0 ? features.bodies : 1)], 21>
        of_body_{};
};

}  // namespace tumble

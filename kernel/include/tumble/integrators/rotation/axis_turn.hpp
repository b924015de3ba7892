// A turn about one body axis, the element of every splitting of the free rotation.
#pragma once

#include <tumble/body/orientation.hpp>
#include <tumble/body/stage.hpp>

namespace tumble {

namespace detail {

// A turn about a body axis. The half angle is that of its quaternion; the turn is twice the half angle.
template <class N>
struct AxisTurn {
    using Turn = typename N::Turn;
    using Angle = typename N::Angle;

    Turn sine;              // of the whole angle; block turns
    Turn versine;           // 1 - cosine of the whole angle, which is 2 s^2 with the half angle's sine s
    Angle half_sine;        // of the half angle
    Angle cosine_less_one;  // of the half angle

    [[nodiscard]] TUMBLE_INLINE static AxisTurn of(Turn angle, const SinCosSeries<Angle>& series,
                                                   typename N::Block block, Dither d) {
        const Turn twice_sine = N::Block::stretched(angle, series.sinc_less_one, d.angle);
        return {N::Block::stretched(twice_sine, series.cos_less_one, d.delta), block.half_square(twice_sine, d),
                block.half_angle(twice_sine, d), series.cos_less_one};
    }
};

}  // namespace detail

}  // namespace tumble

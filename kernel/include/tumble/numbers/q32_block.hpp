// Q32::Block: the turns of one step of a free rotation, in block floating point.
//
// Why. The state keeps a spin as t, the half turn in a step in rad times 2^turn_shift, in a 64-bit sum (TurnSum).
// Products use 32 bits of it. turn_shift follows from the declared range, so products of a spin of a hundredth of the
// range would have seven bits fewer than those of a spin at the end of the range. The rounding error of the spin is
// lost for good and shows as an error of orientation that grows with time. A step therefore first counts the leading
// bits that the largest of the three components leaves unused, up, and reads all three from their sums times 2^up.
//
// What. A block turn is a half turn in rad times 2^shift, shift = turn_shift + up, held as a Fixed<32>: |t| < 1/4,
// which is below 2^30 units. All block turns of a step share the shift, so they can be added directly. A product of
// two is scaled by 2^(2 shift); it is shifted down by shift for a block turn and by 2 shift for an angle in rad. The
// constants of a body (ratios of its moments) have no share in it. One component may need more room than the others: a
// thin rod turns fast about z, its axis of the smallest moment, with little momentum. The constant of that axis is kept
// divided by 2^z_up, the turn that it is multiplied by is read times 2^z_up, and of() leaves room for it.
//   of              chooses up from the sums, at most most_up(), which keeps shift <= Scale::most_turn_shift
//   turn, turn_up   a sum of the state, or a product of two block turns, as a block turn; turn_up: times 2^up
//   lower           subtracts a product of two block turns from the state, to the last bit of the sum. Changes of the
//                   spin are not rounded to 32 bits, because white noise in the spin grows as time^1.5 in the
//                   orientation
//   half_square     half the square of a block turn, as a block turn: a versine from a sine
//   half_angle, whole_angle, square                       block turns and their products as angles in rad
//   angle_per_turn, times_cosine, angle, add_angle, widen  the sphere's turn: a factor in rad per block turn, and sums
//   share, twice_share, once, twice, times, stretched, rest  constants of the body or the step times a block turn
//   holds_twice     whether a turn leaves room for twice_share, if a method may have moved momentum to the axis
//
// Dither. A constant spin has the same numbers in every step, so its rounding error repeats: half a unit of its angle
// adds up to N/2 units in N steps. A function with a Dither, or with `dither`, a fraction of a unit in 2^-32, adds this
// fraction in place of 1/2 and rounds down. The fraction differs from step to step (dither.hpp), so the mean of the
// results is exact. Sums of the state and products with constants use Dither::turn, angles use Dither::angle, squares
// and series use Dither::delta, so that different roundings do not correlate. The callers of widen and stretched choose
// one. The fraction is shifted to the digits that are dropped.
// Not dithered: products as turns, which are corrections and differ from step to step (rounded to nearest); times, in
// an implicit equation whose next sweep corrects it (to nearest); down, square, angle and rest, where the dropped
// digits are far below the kept ones (rounded down).
#pragma once

#include <tumble/numbers/q32.hpp>

namespace tumble {

template <class R, bool with_carry>
class Q32<R, with_carry>::Block {
public:
    // `most_up` bounds the digits gained; z is to stay in range times 2^(z_up + 1).
    [[nodiscard]] TUMBLE_INLINE static constexpr Block of(TurnSum x, TurnSum y, TurnSum z, int z_up, int most_up,
                                                          Scale s) {
        const auto magnitude = [](TurnSum t) {
            const auto high = static_cast<std::int32_t>(t.raw >> 32);
            return static_cast<std::uint32_t>(high ^ (high >> 31));
        };
        const int room_xy = std::countl_zero(magnitude(x) | magnitude(y) | 1u) - 2;
        const int room_z = std::countl_zero(magnitude(z) | 1u) - 3 - z_up;
        Block b;
        const int room = room_xy < room_z ? room_xy : room_z;
        b.beyond_ = room < -1;
        b.up_ = room < 0 ? 0 : room > most_up ? most_up : room;
        b.shift_ = s.turn_shift + b.up_;
        return b;
    }
    // The spin about z is too fast for its turn's format, though its momentum is in range.
    [[nodiscard]] TUMBLE_INLINE constexpr bool is_out_of_range() const { return beyond_; }
    [[nodiscard]] static constexpr int most_up(Scale s, int z_up) {
        return detail::clamp(28 - z_up, 0, Scale::most_turn_shift - s.turn_shift);
    }

    // A sum of the state as a block turn, times 2^more, dithered: its mean over many steps keeps all digits.
    [[nodiscard]] TUMBLE_INLINE constexpr Turn turn(TurnSum t, Dither d, int more = 0) const {
        return {detail::upper_shifted_left(t.raw, up_ + more, d.turn)};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr Turn down(Turn t, int n) { return {t.raw >> n}; }
    // A product of two block turns as the nearest block turn. Below: half a square, dithered.
    [[nodiscard]] TUMBLE_INLINE constexpr Turn turn(TurnProduct p) const {
        return {(upper_word(p).raw + half()) >> shift_};
    }
    [[nodiscard]] TUMBLE_INLINE constexpr Turn turn_up(TurnProduct p, int up) const {
        return {(detail::upper_shifted_left(p.raw, up) + half()) >> shift_};
    }
    [[nodiscard]] TUMBLE_INLINE constexpr Turn half_square(Turn t, Dither d) const {
        return half_angle(Turn{detail::multiply_add_upper(0, d.delta, t.raw, t.raw)}, d);
    }
    // state -= p: a product puts the upper word in its place.
    TUMBLE_INLINE constexpr void lower(auto& state, TurnProduct p) const {
        const int down = shift_ + up_;
        if constexpr (detail::long_products_are_fast) {
            const auto low = static_cast<std::int64_t>(static_cast<std::uint32_t>(p.raw) >> down);
            state.accumulate(upper_word(p), Fixed<32>{static_cast<std::int32_t>(0u - (0x80000000u >> (down - 1)))},
                             [&](TurnSum sum) { return sum - TurnSum{low}; });
        } else {
            state.add(-TurnSum{detail::shift_right(p.raw, down)});
        }
    }
    // As angles: a product of two turns, and half a turn.
    [[nodiscard]] TUMBLE_INLINE constexpr Angle square(TurnProduct p) const {
        return {upper_word(p).raw >> (2 * shift_)};
    }
    [[nodiscard]] TUMBLE_INLINE constexpr Angle half_angle(Turn t) const { return {t.raw >> (shift_ + 1)}; }
    [[nodiscard]] TUMBLE_INLINE constexpr Angle half_angle(Turn t, Dither d) const {
        return {(t.raw + static_cast<std::int32_t>(d.angle >> (31 - shift_))) >> (shift_ + 1)};
    }
    [[nodiscard]] TUMBLE_INLINE constexpr Angle whole_angle(Turn t, Dither d) const {
        return {(t.raw + static_cast<std::int32_t>((d.angle >> 1) >> (31 - shift_))) >> shift_};
    }
    // 1 + c, c <= 0, as the factor from a turn to an angle, dithered. For 1/2, the end of its format, it is just below.
    [[nodiscard]] TUMBLE_INLINE constexpr Fixed<32> angle_per_turn(Angle c, Dither d) const {
        const auto less =
            static_cast<std::uint32_t>((c.raw + static_cast<std::int32_t>(d.delta >> (32 - shift_))) >> shift_);
        const std::uint32_t factor = less + (0x80000000u >> (shift_ - 1));
        return {static_cast<std::int32_t>(factor - (factor >> 31))};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr Fixed<32> times_cosine(Fixed<32> factor, Angle c,
                                                                        std::uint32_t dither) {
        return stretched(factor, c, dither);
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr Angle angle(Turn t, Fixed<32> factor) { return mul_upper(t, factor); }
    [[nodiscard]] TUMBLE_INLINE static constexpr Angle angle(Angle a, Angle b, std::uint32_t dither) {
        return {detail::multiply_add_upper(0, dither, a.raw, b.raw)};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr AngleSum add_angle(AngleSum sum, Turn t, Fixed<32> factor) {
        return mul_add(sum, t, factor);
    }
    // The start value a of a sum of products whose upper word will be a dithered angle.
    [[nodiscard]] TUMBLE_INLINE static constexpr AngleSum widen(Angle a, std::uint32_t dither) {
        return {
            static_cast<std::int64_t>((static_cast<std::uint64_t>(static_cast<std::uint32_t>(a.raw)) << 32) | dither)};
    }
    // t (1 + c), c * t (share, once) and 2 c * t, dithered.
    [[nodiscard]] TUMBLE_INLINE static constexpr Turn stretched(Turn t, Angle c, std::uint32_t dither) {
        return {detail::multiply_add_upper(t.raw, dither, t.raw, c.raw)};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr Turn share(Fixed<32> c, Turn t, Dither d) {
        return {detail::multiply_add_upper(0, d.turn, c.raw, t.raw)};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr Turn once(Fixed<30> c, Turn t, Dither d) {
        return {static_cast<std::int32_t>(mul_add(Wide<62>{static_cast<std::int64_t>(d.turn >> 2)}, c, t).raw >> 30)};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr Turn twice(Fixed<30> c, Turn t, Dither d) {
        return {static_cast<std::int32_t>(mul_add(Wide<62>{static_cast<std::int64_t>(d.turn >> 3)}, c, t).raw >> 29)};
    }
    // True if a change of c that is this change times |c| would round to zero: |c| < 2^-(1 + shift) in each component.
    [[nodiscard]] TUMBLE_INLINE constexpr bool vanishes_times_itself(const auto& change, const auto&) const {
        const auto size = [](Turn c) { return static_cast<std::uint32_t>(c.raw ^ (c.raw >> 31)); };
        return ((size(change.x()) | size(change.y()) | size(change.z())) >> shift_) == 0;
    }
    // c * t, rounded to nearest. Below: (a + d p - j c) 2^up, rounded down.
    [[nodiscard]] TUMBLE_INLINE static constexpr Turn times(Fixed<30> c, Turn t) {
        return {static_cast<std::int32_t>(mul_add(Wide<62>{std::int64_t{1} << 29}, c, t).raw >> 30)};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr Turn rest(Turn a, Fixed<30> d, Turn p, Fixed<30> j, Turn c, int up) {
        const Wide<62> start{static_cast<std::int64_t>(a.raw) * (std::int64_t{1} << 30)};
        return {static_cast<std::int32_t>(mul_sub(mul_add(start, d, p), j, c).raw >> (30 - up))};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr Turn twice_share(Fixed<31> c, Turn t, Dither d) {
        return {static_cast<std::int32_t>(mul_add(Wide<63>{static_cast<std::int64_t>(d.turn >> 2)}, c, t).raw >> 30)};
    }
    // True if the format of turns has room for twice the turn times 2^up.
    [[nodiscard]] TUMBLE_INLINE static constexpr bool holds_twice(Turn t, int up) {
        return ((t.raw ^ (t.raw >> 31)) >> (30 - up)) == 0;
    }

private:
    [[nodiscard]] TUMBLE_INLINE constexpr std::int32_t half() const { return 1 << (shift_ - 1); }
    int up_ = 0, shift_ = 1;
    bool beyond_ = false;
};

}  // namespace tumble

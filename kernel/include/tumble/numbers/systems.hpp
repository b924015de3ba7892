// Number systems: Q32<Range> (integers only), F32 and F64. Each names the type of every physical quantity and the few
// operations that differ between fixed and floating point, so that loads, integrators and contacts are written once.
//
// Inside a world time is counted in steps, not seconds. Velocity is kept as `Drift`, the displacement per step, and
// spin as `Turn`, half the angle turned per step: position += drift, and a half turn is what a quaternion needs. The
// step size then enters only when constants are made, so a step such as 0.005 s costs no accuracy and no cycles.
#pragma once

#include <tumble/numbers/carried.hpp>
#include <tumble/numbers/dither.hpp>
#include <tumble/numbers/functions.hpp>

namespace tumble {

// What fixed point must be able to hold: metres from the origin, m/s, rad/s. Formats round each up to a power of two.
template <int position_m = 1024, int velocity_m_s = 128, int spin_rad_s = 64>
struct Range {
    static constexpr int position = position_m;
    static constexpr int velocity = velocity_m_s;
    static constexpr int spin = spin_rad_s;
};
using NearRange = Range<64, 32, 32>;
using RoomRange = Range<>;
using FieldRange = Range<32768, 2048, 256>;

// A fraction known at compile time, such as an entry of a Butcher table.
struct Rational {
    int numerator = 0;
    int denominator = 1;
    [[nodiscard]] constexpr bool is_zero() const { return numerator == 0; }
    [[nodiscard]] constexpr bool is_dyadic() const { return (denominator & (denominator - 1)) == 0; }
    friend constexpr bool operator==(Rational, Rational) = default;
};

namespace detail {

// a >> shift for 1 <= shift <= 31, rounding down: four instructions on a 32-bit core.
[[nodiscard]] TUMBLE_INLINE constexpr std::int64_t shift_right(std::int64_t a, int shift) {
    const auto high = static_cast<std::int32_t>(a >> 32);
    const auto low = static_cast<std::uint32_t>(a);
    const std::uint32_t lower = (low >> shift) | (static_cast<std::uint32_t>(high) << (32 - shift));
    return static_cast<std::int64_t>((static_cast<std::uint64_t>(static_cast<std::uint32_t>(high >> shift)) << 32) |
                                     lower);
}

// The upper word of (a << shift) + rest, for 0 <= shift <= 31. A product moves the lower word up in one instruction.
[[nodiscard]] TUMBLE_INLINE constexpr std::int32_t upper_shifted_left(std::int64_t a, int shift,
                                                                      std::uint32_t rest = 0) {
    const std::uint32_t power = std::uint32_t{1} << shift;
    const auto high = static_cast<std::uint32_t>(static_cast<std::uint64_t>(a) >> 32),
               low = static_cast<std::uint32_t>(a);
    return static_cast<std::int32_t>(high * power +
                                     static_cast<std::uint32_t>((std::uint64_t{low} * power + rest) >> 32));
}

[[nodiscard]] constexpr int log2_of(int power_of_two) {
    int log2 = 0;
    while ((1 << log2) < power_of_two) ++log2;
    return log2;
}

[[nodiscard]] constexpr int clamp(int value, int low, int high) {
    return value < low ? low : value > high ? high : value;
}

}  // namespace detail

// 32-bit integers with 64-bit accumulation. Ranges decide the formats; see Scale for what the step decides.
template <class R = RoomRange, bool with_carry = true>
struct Q32 {
    using Range = R;
    static constexpr const char* name = "q32";
    static constexpr bool carry = with_carry;
    static constexpr bool fixed_point = true;

    using Position = Fixed<30 - detail::log2_of(R::position)>;  // m; one bit above the range
    using Drift = Fixed<30>;        // displacement per step / Scale's unit; +-1 is the range
    using Turn = Fixed<32>;         // half turn per step, rad, times 2^turn_shift; +-1/4 is the range
    using Angle = Fixed<32>;        // rad, |angle| < 1/2: half turns and what is computed from them
    using Unit = Fixed<30>;         // components of unit quaternions and unit vectors
    using Coefficient = Fixed<31>;  // dimensionless constants in [-1, 1]
    template <int bits>
    using CoefficientOf = Fixed<bits>;  // dimensionless constants below 2^(31 - bits)
    using TurnProduct = Wide<64>;
    using AngleSum = Wide<64>;
    using PositionSum = Wide<Position::fraction_bits + 32>;
    using DriftSum = Wide<62>;
    using TurnSum = Wide<64>;
    using Work = Scaled;  // loads and contacts: any magnitude, 31 digits
    template <class T>
    using Integrated = Carried<T, carry>;
    using IntegratedUnit = Carried<Unit, carry, true>;

    // Where the binary points stand, from the ranges and the step size.
    struct Scale {
        // Drift has drift_shift more fraction bits (of a metre) than Position: a step moves by a quarter of the range
        // at most.
        std::int8_t drift_shift = 2;
        std::int8_t turn_shift = 1;                 // Turn is the half turn times 2^turn_shift
        static constexpr int most_turn_shift = 14;  // squares of angles are shifted by up to 2 (14 + 1) < 32

        // `turn_per_spin`: the largest half turn per step that a spin of 1 rad/s can mean (h/2, h for momentum).
        [[nodiscard]] static constexpr Scale of(Real step, Real turn_per_spin) {
            const int drift_bits = 30 - (Real{R::velocity} * step).ceil_log2_bound();
            const int turn_bits = -2 - (Real{R::spin} * turn_per_spin).ceil_log2_bound();
            return {static_cast<std::int8_t>(detail::clamp(drift_bits - Position::fraction_bits, 2, 30)),
                    static_cast<std::int8_t>(detail::clamp(turn_bits, 1, most_turn_shift))};
        }
        // Set-up: metres per step (or per step^2) and half turns per step, as the numbers that state holds.
        [[nodiscard]] constexpr Real drift_units(Real metres) const {
            return metres * Real::scaled(1, Position::fraction_bits + drift_shift - Drift::fraction_bits);
        }
        [[nodiscard]] constexpr Real turn_units(Real angle) const { return angle * Real::scaled(1, turn_shift); }
        [[nodiscard]] constexpr Real metres(Real drift) const {
            return drift * Real::scaled(1, Drift::fraction_bits - Position::fraction_bits - drift_shift);
        }
        [[nodiscard]] constexpr Real angle(Real turn) const { return turn * Real::scaled(1, -turn_shift); }
    };

    // Turns that share a power of two of their own during one step, so that a spin far below the declared range is
    // computed with as many digits as one at its end: a block turn is a half turn times 2^shift, below 2^30 units in
    // each component.
    class Block {
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
        // Products of two block turns as the nearest block turn; half a square, dithered.
        [[nodiscard]] TUMBLE_INLINE constexpr Turn turn(TurnProduct p) const {
            return {(upper_word(p).raw + half()) >> shift_};
        }
        [[nodiscard]] TUMBLE_INLINE constexpr Turn turn_up(TurnProduct p, int up) const {
            return {(detail::upper_shifted_left(p.raw, up) + half()) >> shift_};
        }
        [[nodiscard]] TUMBLE_INLINE constexpr Turn half_square(Turn t, Dither d) const {
            return half_angle(upper_word(mul_add(TurnProduct{static_cast<std::int64_t>(d.delta)}, t, t)), d);
        }
        // state -= p: a product puts the upper word in its place.
        TUMBLE_INLINE constexpr void lower(auto& state, TurnProduct p) const {
            const int down = shift_ + up_;
            const auto low = static_cast<std::int64_t>(static_cast<std::uint32_t>(p.raw) >> down);
            state.accumulate(upper_word(p), Fixed<32>{static_cast<std::int32_t>(0u - (0x80000000u >> (down - 1)))},
                             [&](TurnSum sum) { return sum - TurnSum{low}; });
        }
        // As angles: a product of two turns, half a turn.
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
        // 1 + c, c <= 0, as the factor that makes an angle of a turn; dithered. Just below 1/2, its format's end, for
        // 1/2.
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
        [[nodiscard]] TUMBLE_INLINE static constexpr Angle angle(Turn t, Fixed<32> factor) {
            return upper_word(mul(t, factor));
        }
        [[nodiscard]] TUMBLE_INLINE static constexpr AngleSum add_angle(AngleSum sum, Turn t, Fixed<32> factor) {
            return mul_add(sum, t, factor);
        }
        // a as the start of a sum of products whose upper word will be a dithered angle.
        [[nodiscard]] TUMBLE_INLINE static constexpr AngleSum widen(Angle a, std::uint32_t dither) {
            return {static_cast<std::int64_t>((static_cast<std::uint64_t>(static_cast<std::uint32_t>(a.raw)) << 32) |
                                              dither)};
        }
        // t (1 + c), c * t and 2 c * t, dithered.
        [[nodiscard]] TUMBLE_INLINE static constexpr Turn stretched(Turn t, Angle c, std::uint32_t dither) {
            return upper_word(mul_add(widen(t, dither), t, c));
        }
        [[nodiscard]] TUMBLE_INLINE static constexpr Turn share(Fixed<32> c, Turn t, Dither d) {
            return upper_word(mul_add(TurnProduct{static_cast<std::int64_t>(d.turn)}, c, t));
        }
        [[nodiscard]] TUMBLE_INLINE static constexpr Turn twice(Fixed<30> c, Turn t, Dither d) {
            return {
                static_cast<std::int32_t>(mul_add(Wide<62>{static_cast<std::int64_t>(d.turn >> 3)}, c, t).raw >> 29)};
        }
        // Would a change of c that is this change times |c| round to nothing? |c| < 2^-(1 + shift) in each component.
        [[nodiscard]] TUMBLE_INLINE constexpr bool vanishes_times_itself(const auto& change, const auto&) const {
            const auto size = [](Turn c) { return static_cast<std::uint32_t>(c.raw ^ (c.raw >> 31)); };
            return ((size(change.x()) | size(change.y()) | size(change.z())) >> shift_) == 0;
        }
        // c * t, to nearest; and (a + d p - j c) 2^up, rounded down.
        [[nodiscard]] TUMBLE_INLINE static constexpr Turn times(Fixed<30> c, Turn t) {
            return {static_cast<std::int32_t>(mul_add(Wide<62>{std::int64_t{1} << 29}, c, t).raw >> 30)};
        }
        [[nodiscard]] TUMBLE_INLINE static constexpr Turn rest(Turn a, Fixed<30> d, Turn p, Fixed<30> j, Turn c,
                                                               int up) {
            const Wide<62> start{static_cast<std::int64_t>(a.raw) * (std::int64_t{1} << 30)};
            return {static_cast<std::int32_t>(mul_sub(mul_add(start, d, p), j, c).raw >> (30 - up))};
        }
        [[nodiscard]] TUMBLE_INLINE static constexpr Turn twice_share(Fixed<31> c, Turn t, Dither d) {
            return {
                static_cast<std::int32_t>(mul_add(Wide<63>{static_cast<std::int64_t>(d.turn >> 2)}, c, t).raw >> 30)};
        }

    private:
        [[nodiscard]] TUMBLE_INLINE constexpr std::int32_t half() const { return 1 << (shift_ - 1); }
        int up_ = 0, shift_ = 1;
        bool beyond_ = false;
    };

    template <class T>
    [[nodiscard]] static constexpr T constant(Real value) {
        return T::from(value);
    }

    // Between state and working numbers: metres, metres per step, half turns per step.
    [[nodiscard]] static constexpr PositionSum sum(const Integrated<Position>& x) { return x.sum(); }
    [[nodiscard]] static constexpr Work metres(PositionSum x) { return Work::of(x); }
    [[nodiscard]] static constexpr Work metres(DriftSum d, Scale s) {
        return Work::of(d.raw, -(Position::fraction_bits + 32 + s.drift_shift));
    }
    [[nodiscard]] static constexpr Work half_turn(Turn t, Scale s) { return Work::of(t.raw, -(32 + s.turn_shift)); }
    [[nodiscard]] static constexpr Work half_turn(TurnSum t, Scale s) { return Work::of(t.raw, -(64 + s.turn_shift)); }
    [[nodiscard]] static constexpr Work turn_product(TurnProduct p, Scale s) {
        return Work::of(p.raw, -(64 + 2 * s.turn_shift));
    }
    [[nodiscard]] static constexpr Work work(Unit u) { return Work::of(u); }
    [[nodiscard]] static constexpr PositionSum position_sum(Work metres) {
        return metres.template to_wide<PositionSum::fraction_bits>();
    }
    [[nodiscard]] static constexpr DriftSum drift_sum(Work metres, Scale s) {
        return {metres.to_sum(Position::fraction_bits + 32 + s.drift_shift)};
    }
    [[nodiscard]] static constexpr TurnSum turn_sum(Work half_turn, Scale s) {
        return {half_turn.to_sum(64 + s.turn_shift)};
    }

    // A constant change of drift. What leaves the range in one step is held at its end: sums with it cannot wrap.
    [[nodiscard]] static constexpr DriftSum fall(Real units) {
        constexpr std::int64_t limit = (std::int64_t{1} << 62) + (std::int64_t{1} << 32);
        const std::int64_t raw = units.to_fixed(DriftSum::fraction_bits, 64);
        return {raw > limit ? limit : raw < -limit ? -limit : raw};
    }
    // state += change, for changes of any size: what would wrap stops beyond the range, where it is told.
    TUMBLE_INLINE static constexpr void add_any(Integrated<Drift>& d, Work metres, Scale s) {
        d.add({no_wrap(d.sum().raw, metres.to_sum(Position::fraction_bits + 32 + s.drift_shift, widest))});
    }
    TUMBLE_INLINE static constexpr void add_any(auto& turn, Work half_turn, Scale s) {
        turn.add({no_wrap(turn.sum().raw, half_turn.to_sum(64 + s.turn_shift, widest))});
    }
    // A load's change of a step, within a quarter of the range, which no stage of a method can make wrap; clears
    // `within` where it had to be cut.
    template <int F>
    [[nodiscard]] TUMBLE_INLINE static constexpr Wide<F> limited(Wide<F> kick, bool& within) {
        constexpr std::int64_t limit = std::int64_t{1} << 60;
        if (kick.raw <= limit && kick.raw >= -limit) [[likely]]
            return kick;
        within = false;
        return {kick.raw < 0 ? -limit : limit};
    }

    // Is a correction to `t` only rounding? And the relative rounding of working numbers, with a margin.
    [[nodiscard]] static constexpr bool is_rounding(const auto& correction, const auto&) {
        const auto small = [](Turn c) { return c.raw >= -3 && c.raw <= 3; };  // three roundings make the correction
        return small(correction[0]) && small(correction[1]) && small(correction[2]);
    }
    [[nodiscard]] static constexpr Work rounding_unit() { return Work::of(1, -28); }

    [[nodiscard]] static constexpr Work half_of(Work w) { return w.times_power_of_two(-1); }
    [[nodiscard]] static constexpr Work times_power_of_two(Work w, int n) { return w.times_power_of_two(n); }
    // A working number as a constant of a step, nearest.
    template <int bits>
    [[nodiscard]] static constexpr CoefficientOf<bits> factor(Work w) {
        return w.template to_fixed<CoefficientOf<bits>>();
    }

    // For part of a step: sums times a fraction in (0, 1).
    using Fraction = Fixed<31>;
    [[nodiscard]] static constexpr Fraction fraction(Work w) { return w.template to_fixed<Fraction>(); }
    [[nodiscard]] static constexpr Work work(Fraction f) { return Work::of(f); }
    template <int F>
    [[nodiscard]] static constexpr Wide<F> part(Wide<F> a, Fraction f) {
        return {static_cast<std::int64_t>(static_cast<std::uint64_t>(mul_sum({a.raw}, f).raw) << 1)};
    }

    // n . x in m, for unit n.
    using AlongSum = Wide<Position::fraction_bits + Unit::fraction_bits>;
    [[nodiscard]] static constexpr AlongSum along(const PositionSum (&x)[3], const auto& n) {
        const auto term = [&](int i) { return AlongSum{mul_sum({x[i].raw}, n[i]).raw}; };
        return term(0) + term(1) + term(2);
    }
    [[nodiscard]] static constexpr Work metres_along(AlongSum x) { return Work::of(x); }

    // Is the value outside the declared range? One bit of headroom tells before anything can wrap.
    [[nodiscard]] TUMBLE_INLINE static constexpr std::uint32_t range_bits(std::int32_t raw) {
        return static_cast<std::uint32_t>(raw) ^ (static_cast<std::uint32_t>(raw) << 1);
    }
    template <class Body>
    [[nodiscard]] TUMBLE_INLINE static constexpr bool out_of_range(const Body& b) {
        const auto three = [](const auto& v) {
            return range_bits(upper(v.x.sum().raw)) | range_bits(upper(v.y.sum().raw)) |
                   range_bits(upper(v.z.sum().raw));
        };
        const std::uint32_t bits = three(b.x_w) | three(b.d_w) | three(b.t_b);
        return (bits >> 31) != 0;
    }
    // Marks a number for out_of_range().
    static constexpr void leave_range(auto& number) {
        constexpr std::int64_t beyond = std::int64_t{3} << 61;
        number = std::remove_reference_t<decltype(number)>::from_sum(
            decltype(number.sum()){number.sum().raw < 0 ? -beyond : beyond});
    }
    template <class Body>
    static constexpr void saturate(Body& b) {
        const auto clamp = [](auto& c) {
            constexpr std::int64_t limit = (std::int64_t{1} << 62) - 1;
            const std::int64_t raw = c.sum().raw;
            if ((range_bits(upper(raw)) >> 31) != 0)
                c = std::remove_reference_t<decltype(c)>::from_sum(decltype(c.sum()){raw < 0 ? -limit : limit});
        };
        for (int i = 0; i < 3; ++i) {
            clamp(b.x_w[i]);
            clamp(b.d_w[i]);
            clamp(b.t_b[i]);
        }
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr std::int32_t upper(std::int64_t raw) {
        return static_cast<std::int32_t>(raw >> 32);
    }
    // `change`, cut so that sum + change stays within the widest sum.
    static constexpr std::int64_t widest = INT64_MAX - (std::int64_t{1} << 32);
    [[nodiscard]] static constexpr std::int64_t no_wrap(std::int64_t sum, std::int64_t change) {
        if (sum > 0 && change > widest - sum) return widest - sum;
        if (sum < 0 && change < -widest - sum) return -widest - sum;
        return change;
    }

    // position += drift: the carried sums differ only in where the binary point stands. A product with a power of two
    // shifts the upper word down, into the sum itself.
    TUMBLE_INLINE static constexpr void move(Integrated<Position>& x, DriftSum drift, Scale s) {
        const auto low = static_cast<std::int64_t>(static_cast<std::uint32_t>(drift.raw) >> s.drift_shift);
        if constexpr (carry)
            x.accumulate(Drift{upper(drift.raw)}, Fixed<Position::fraction_bits + 2>{1 << (32 - s.drift_shift)},
                         [&](PositionSum sum) { return sum + PositionSum{low}; });
        else x.add({detail::shift_right(drift.raw, s.drift_shift)});
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr DriftSum sum(const Integrated<Drift>& d) { return d.sum(); }
    template <int F>
    [[nodiscard]] TUMBLE_INLINE static constexpr Wide<F> half(Wide<F> sum) {
        return {sum.raw >> 1};
    }
    // position += drift + extra, with all that the drift carries.
    TUMBLE_INLINE static constexpr void coast(Integrated<Position>& x, const Integrated<Drift>& d, DriftSum extra,
                                              Scale s) {
        move(x, d.sum() + extra, s);
    }
    [[nodiscard]] static constexpr PositionSum displaced(PositionSum x, DriftSum d, Scale s) {
        return x + PositionSum{detail::shift_right(d.raw, s.drift_shift)};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr Angle half_angle(Angle a) { return {a.raw >> 1}; }
    // t * 2^shift, which the caller knows to fit.
    [[nodiscard]] TUMBLE_INLINE static constexpr TurnSum scaled_up(TurnSum t, int shift) {
        return {static_cast<std::int64_t>(static_cast<std::uint64_t>(t.raw) << shift)};
    }
    TUMBLE_INLINE static constexpr void add(Integrated<Drift>& d, Wide<62> increment) { d.add(increment); }

    // The angle of a turn, unscaled and dithered.
    [[nodiscard]] TUMBLE_INLINE static constexpr Angle angle(Turn t, Scale s, Dither d) {
        const auto fraction = static_cast<std::int32_t>((d.angle >> 1) >> (31 - s.turn_shift));
        return {(t.raw + fraction) >> s.turn_shift};
    }
    // The upper word of an exact sum of products, dithered.
    [[nodiscard]] TUMBLE_INLINE static constexpr Angle round_angle(AngleSum a, Dither d) {
        return {static_cast<std::int32_t>((a + AngleSum{static_cast<std::int64_t>(d.delta)}).raw >> 32)};
    }
    // A turn's sum times a 32-bit number, both words of it: what drives the spin is not rounded to 32 bits, because
    // white noise there grows as time^1.5 in the orientation.
    template <int F>
    [[nodiscard]] TUMBLE_INLINE static constexpr Wide<32 + F> mul_sum(TurnSum t, Fixed<F> c) {
        const auto upper = static_cast<std::int32_t>(t.raw >> 32);
        const auto lower = static_cast<std::int32_t>(static_cast<std::uint32_t>(t.raw) >> 1);
        return {detail::multiply_add(detail::multiply(lower, c.raw) >> 31, upper, c.raw)};
    }
    template <int F>
    [[nodiscard]] TUMBLE_INLINE static constexpr TurnSum share(Fixed<F> c, TurnSum t) {
        return {static_cast<std::int64_t>(static_cast<std::uint64_t>(mul_sum(t, c).raw) << (32 - F))};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr TurnSum sum(const Carried<Turn, carry>& t) { return t.sum(); }
    [[nodiscard]] TUMBLE_INLINE static constexpr TurnSum sum(const Shaped<Turn, carry>& t) { return t.sum(); }
    // Three ways to round a sum: as a turn, plainly or dithered (what a constant spin is made of must not be rounded
    // the same way at every step), or as an angle, dithered.
    [[nodiscard]] TUMBLE_INLINE static constexpr Turn narrow_turn(TurnSum t) { return narrow<Turn>(t); }
    [[nodiscard]] TUMBLE_INLINE static constexpr Turn round_turn(TurnSum t, Dither d) {
        return {static_cast<std::int32_t>((t + TurnSum{static_cast<std::int64_t>(d.turn)}).raw >> 32)};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr Angle angle(TurnSum t, Scale s, Dither d) {
        const auto fraction = static_cast<std::int64_t>(static_cast<std::uint64_t>(d.angle) << s.turn_shift);
        return {static_cast<std::int32_t>((t + TurnSum{fraction}).raw >> 32) >> s.turn_shift};
    }
    // A sum of products of turns as a turn; and as an increment of the state, to its last bit.
    [[nodiscard]] TUMBLE_INLINE static constexpr Turn turn(TurnProduct p, Scale s) {
        return {static_cast<std::int32_t>((p + TurnProduct{std::int64_t{1} << (31 + s.turn_shift)}).raw >> 32) >>
                s.turn_shift};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr TurnSum turn_increment(TurnProduct p, Scale s) {
        return {detail::shift_right(p.raw, s.turn_shift)};
    }
    // The square of a turn's angle (of the three turns' length), as an angle; and a square scaled like a turn.
    [[nodiscard]] TUMBLE_INLINE static constexpr Angle square(TurnProduct p, Scale s) {
        const int shift = s.turn_shift > 15 ? 31 : 2 * s.turn_shift;
        return {narrow<Angle>(p).raw >> shift};
    }
    // coefficient * p / 2^turn_shift as a turn: for stages, where the product's upper word is enough.
    [[nodiscard]] TUMBLE_INLINE static constexpr Turn stage_turn(Coefficient c, TurnProduct p, Scale s) {
        // The upper word is the product rounded down; c / 2 puts back the half unit that is missing on average: a bias
        // would drive the spin like a torque.
        const auto upper = static_cast<std::int32_t>(p.raw >> 32);
        const auto product = static_cast<std::int32_t>(detail::multiply(c.raw, 2 * upper + 1) >> 32);
        return {(product + (1 << s.turn_shift >> 1)) >> s.turn_shift};
    }
    // t += coefficient * p, to the last bit of the carried sum: 96 bits of product, of which 64 are kept.
    template <int F>
    TUMBLE_INLINE static constexpr void add_turn(Shaped<Turn, carry>& t, Fixed<F> c, TurnProduct p, Scale s) {
        t.add({detail::shift_right(static_cast<std::int64_t>(static_cast<std::uint64_t>(mul_sum(p, c).raw) << (32 - F)),
                                   s.turn_shift)});
    }
};

// IEEE 754 arithmetic without contraction. Units are plain: turns in rad, drift in metres, so Scale is empty.
template <class T, bool with_carry>
struct Float {
    static constexpr const char* name = sizeof(T) == 4 ? "f32" : "f64";
    static constexpr bool carry = with_carry;
    static constexpr bool fixed_point = false;

    using Position = T;
    using Drift = T;
    using Turn = T;
    using Angle = T;
    using Unit = T;
    using Coefficient = T;
    template <int>
    using CoefficientOf = T;
    using TurnProduct = T;
    using AngleSum = T;
    using PositionSum = T;
    using DriftSum = T;
    using TurnSum = T;
    using Work = T;
    template <class V>
    using Integrated = Carried<V, carry>;
    using IntegratedUnit = Carried<T, carry, true>;

    struct Scale {
        [[nodiscard]] static constexpr Scale of(Real, Real) { return {}; }
        [[nodiscard]] constexpr Real drift_units(Real metres) const { return metres; }
        [[nodiscard]] constexpr Real turn_units(Real angle) const { return angle; }
        [[nodiscard]] constexpr Real metres(Real drift) const { return drift; }
        [[nodiscard]] constexpr Real angle(Real turn) const { return turn; }
    };

    // Floating point carries a power of two with every number.
    struct Block {
        [[nodiscard]] TUMBLE_INLINE static constexpr Block of(T, T, T, int, int, Scale) { return {}; }
        [[nodiscard]] static constexpr int most_up(Scale, int) { return 0; }
        [[nodiscard]] static constexpr bool is_out_of_range() { return false; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T turn(T t, Dither, int = 0) { return t; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T down(T t, int) { return t; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T turn(T p) { return p; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T turn_up(T p, int) { return p; }
        TUMBLE_INLINE static constexpr void lower(auto& state, T p) { state.add(-p); }
        [[nodiscard]] TUMBLE_INLINE static constexpr T square(T p) { return p; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T half_angle(T t) { return t * T(0.5); }
        [[nodiscard]] TUMBLE_INLINE static constexpr T half_angle(T t, Dither) { return t * T(0.5); }
        [[nodiscard]] TUMBLE_INLINE static constexpr T half_square(T t, Dither) { return t * t * T(0.5); }
        // Kept less one: 1 + c would lose c's digits.
        [[nodiscard]] TUMBLE_INLINE static constexpr T angle_per_turn(T c, Dither) { return c; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T times_cosine(T factor, T c, std::uint32_t) {
            return factor + c + factor * c;
        }
        [[nodiscard]] TUMBLE_INLINE static constexpr T angle(T t, T factor) { return t + t * factor; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T add_angle(T sum, T t, T factor) {
            return sum + (t + t * factor);
        }
        [[nodiscard]] TUMBLE_INLINE static constexpr T widen(T a, std::uint32_t) { return a; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T stretched(T t, T c, std::uint32_t) { return t + t * c; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T share(T c, T t, Dither) { return c * t; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T twice_share(T c, T t, Dither) { return T(2) * c * t; }
        [[nodiscard]] TUMBLE_INLINE static constexpr bool vanishes_times_itself(const auto& change, const auto& c) {
            return is_rounding(change, c);
        }
        [[nodiscard]] TUMBLE_INLINE static constexpr T twice(T c, T t, Dither) { return T(2) * c * t; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T times(T c, T t) { return c * t; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T rest(T a, T d, T p, T j, T c, int) { return a - j * c + d * p; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T whole_angle(T t, Dither) { return t; }
    };

    template <class V>
    [[nodiscard]] static constexpr V constant(Real value) {
        return from_real<V>(value);
    }

    [[nodiscard]] static constexpr T sum(const Integrated<T>& x) { return x.value(); }
    [[nodiscard]] static constexpr T metres(T x) { return x; }
    [[nodiscard]] static constexpr T metres(T d, Scale) { return d; }
    [[nodiscard]] static constexpr T half_turn(T t, Scale) { return t; }
    [[nodiscard]] static constexpr T turn_product(T p, Scale) { return p; }
    [[nodiscard]] static constexpr T work(T u) { return u; }
    [[nodiscard]] static constexpr T position_sum(T metres) { return metres; }
    [[nodiscard]] static constexpr T drift_sum(T metres, Scale) { return metres; }
    [[nodiscard]] static constexpr T turn_sum(T half_turn, Scale) { return half_turn; }

    [[nodiscard]] static constexpr bool is_rounding(const auto& correction, const auto& t) {
        const T size = magnitude(t[0]) + magnitude(t[1]) + magnitude(t[2]);
        return magnitude(correction[0]) + magnitude(correction[1]) + magnitude(correction[2]) <= size * rounding_unit();
    }
    [[nodiscard]] static constexpr T rounding_unit() { return sizeof(T) == 4 ? T(0x1p-21) : T(0x1p-48); }
    [[nodiscard]] static constexpr T magnitude(T a) { return a < T(0) ? -a : a; }

    [[nodiscard]] static constexpr T half_of(T w) { return w * T(0.5); }
    [[nodiscard]] static constexpr T times_power_of_two(T w, int) {
        return w;
    }  // formats that shift are of fixed point
    template <int>
    [[nodiscard]] static constexpr T factor(T w) {
        return w;
    }

    using Fraction = T;
    [[nodiscard]] static constexpr T fraction(T w) { return w; }
    [[nodiscard]] static constexpr T part(T a, T f) { return a * f; }

    using AlongSum = T;
    [[nodiscard]] static constexpr T metres_along(T x) { return x; }
    [[nodiscard]] static constexpr T along(const T (&x)[3], const auto& n) {
        return x[0] * n[0] + x[1] * n[1] + x[2] * n[2];
    }

    // Not finite? Zero times a finite sum is zero; infinities and NaN give NaN. Drift and spin need not be looked at:
    // the position and every component of the orientation take them over within a step.
    template <class Body>
    [[nodiscard]] TUMBLE_INLINE static constexpr bool out_of_range(const Body& b) {
        const T sum = (b.x_w.x.value() + b.x_w.y.value() + b.x_w.z.value()) + b.q_wb.w.value();
        return !(sum * T(0) == T(0));
    }
    static constexpr void leave_range(auto&) {}
    template <class Body>
    static constexpr void saturate(Body&) {}

    [[nodiscard]] static constexpr T fall(Real metres) { return constant<T>(metres); }
    TUMBLE_INLINE static constexpr void add_any(auto& number, T change, Scale) { number.add(change); }
    [[nodiscard]] TUMBLE_INLINE static constexpr T limited(T kick, bool&) { return kick; }
    TUMBLE_INLINE static constexpr void move(Integrated<T>& x, T drift, Scale) { x.add(drift); }
    [[nodiscard]] TUMBLE_INLINE static constexpr T half(T sum) { return sum * T(0.5); }
    TUMBLE_INLINE static constexpr void coast(Integrated<T>& x, const Integrated<T>& d, T extra, Scale) {
        if constexpr (carry) x.add(d.residual());
        x.add(d.value() + extra);
    }
    [[nodiscard]] static constexpr T displaced(T x, T d, Scale) { return x + d; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T narrow_turn(T t) { return t; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T half_angle(T a) { return a * T(0.5); }
    [[nodiscard]] TUMBLE_INLINE static constexpr T scaled_up(T t, int) { return t; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T mul_sum(T t, T c) { return t * c; }
    TUMBLE_INLINE static constexpr void add(Integrated<T>& d, T increment) { d.add(increment); }

    [[nodiscard]] TUMBLE_INLINE static constexpr T angle(T t, Scale, Dither) { return t; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T round_angle(T a, Dither) { return a; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T share(T c, T t) { return c * t; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T widen(T t) { return t; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T round_turn(T t, Dither) { return t; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T turn(T p, Scale) { return p; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T turn_increment(T p, Scale) { return p; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T square(T p, Scale) { return p; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T stage_turn(T c, T p, Scale) { return c * p; }
    TUMBLE_INLINE static constexpr void add_turn(Integrated<T>& t, T c, T p, Scale) { t.add(c * p); }
};
using F32 = Float<float, true>;
using F32Plain = Float<float, false>;
using F64 = Float<double, false>;
using F64Carried = Float<double, true>;

}  // namespace tumble

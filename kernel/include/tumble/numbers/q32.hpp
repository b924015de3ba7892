// Q32<Range, carry>: a number system in integers. Every quantity is a 32-bit Fixed in a format that follows from the
// declared range. Sums and products have 64 bits and are rounded once. Block (q32_block.hpp) serves free rotation,
// ContactNumbers (q32_contact.hpp) contacts. Float in ieee.hpp has the same functions under the same names.
#pragma once

#include <tumble/numbers/carried.hpp>
#include <tumble/numbers/dither.hpp>
#include <tumble/numbers/scaled.hpp>

namespace tumble {

// The declared range: metres from the origin, m/s, rad/s. Formats round each up to a power of two.
template <int position_m = 1024, int velocity_m_s = 128, int spin_rad_s = 64>
struct Range {
    static constexpr int position = position_m;
    static constexpr int velocity = velocity_m_s;
    static constexpr int spin = spin_rad_s;
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

// The upper word of (a << shift) + rest, for 0 <= shift <= 31. Where a long product is one instruction, a
// multiplication by a power of two moves the lower word up.
[[nodiscard]] TUMBLE_INLINE constexpr std::int32_t upper_shifted_left(std::int64_t a, int shift,
                                                                      std::uint32_t rest = 0) {
    const auto high = static_cast<std::uint32_t>(static_cast<std::uint64_t>(a) >> 32),
               low = static_cast<std::uint32_t>(a);
    if constexpr (long_products_are_fast) {
        const std::uint32_t power = std::uint32_t{1} << shift;
        return static_cast<std::int32_t>(high * power +
                                         static_cast<std::uint32_t>((std::uint64_t{low} * power + rest) >> 32));
    } else {
        const std::uint64_t shifted =
            std::uint64_t{(high << shift) | (low >> 1 >> (31 - shift))} << 32 | (low << shift);
        return upper_of_sum(static_cast<std::int64_t>(shifted), 0, rest);
    }
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

// 32-bit integers with 64-bit accumulation. The range decides the formats, the step decides Scale.
template <class R = Range<>, bool with_carry = true>
struct Q32 {
    using Range = R;
    static constexpr const char* name = "q32";
    static constexpr const char* what = "32-bit integers only, formats from the range";
    static constexpr bool carry = with_carry;
    static constexpr bool fixed_point = true;

    using Position = Fixed<30 - detail::log2_of(R::position)>;  // m; one bit above the range
    using Drift = Fixed<30>;        // displacement in a step, in units of Scale; the range is +-1
    using Turn = Fixed<32>;         // half turn in a step, rad, times 2^turn_shift; the range is +-1/4
    using Angle = Fixed<32>;        // rad, |angle| < 1/2: half turns and angles computed from them
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
    // Whether 1 / a and 1 / sqrt(a) are numbers. Below: whether 1 / length^3 is one, from the square of the length.
    [[nodiscard]] TUMBLE_INLINE static constexpr bool is_divisor(Work a) { return a > Work{}; }
    [[nodiscard]] TUMBLE_INLINE static constexpr bool has_inverse_cube(Work square) { return square > Work{}; }
    // The ends of the ranges of drifts and turns, in the units of Scale.
    static constexpr Real largest_drift = 1, largest_turn = Real::scaled(1, -2);
    template <class T>
    using Integrated = Carried<T, carry>;
    using IntegratedUnit = Carried<Unit, carry, true>;

    // Places of the binary points, from the ranges and the step.
    struct Scale {
        // Fraction bits of Drift (in metres) beyond those of Position. At least 2: a step moves by at most a quarter of
        // the range.
        std::int8_t drift_shift = 2;
        std::int8_t turn_shift = 1;                 // Turn is the half turn times 2^turn_shift
        static constexpr int most_turn_shift = 14;  // squares of angles are shifted by up to 2 (14 + 1) < 32 bits
        // A faster spin is held in half turns of a half, a quarter, ... a 64th of the step: as many halvings as the
        // declared range needs. StepParts counts the parts in eight bits.
        std::int8_t most_halvings = 0;

        // `turn_per_spin`: the largest half turn in a step that a spin of 1 rad/s can be, s (h/2; h for momentum).
        [[nodiscard]] static constexpr Scale of(Real step, Real turn_per_spin) {
            const int drift_bits = 30 - (Real{R::velocity} * step).ceil_log2_bound();
            const int turn_bits = -2 - (Real{R::spin} * turn_per_spin).ceil_log2_bound();
            return {static_cast<std::int8_t>(detail::clamp(drift_bits - Position::fraction_bits, 2, 30)),
                    static_cast<std::int8_t>(detail::clamp(turn_bits, 1, most_turn_shift)),
                    static_cast<std::int8_t>(detail::clamp(1 - turn_bits, 0, 6))};
        }
        // The scale of turns that are half turns in 2^-halvings of the step.
        [[nodiscard]] TUMBLE_INLINE constexpr Scale halved(int halvings) const {
            return {drift_shift, static_cast<std::int8_t>(turn_shift - halvings), most_halvings};
        }
        // For set-up: metres in a step (or in a step^2), and half turns in a step, in the units of the state.
        [[nodiscard]] constexpr Real drift_units(Real metres) const {
            return metres * Real::scaled(1, Position::fraction_bits + drift_shift - Drift::fraction_bits);
        }
        [[nodiscard]] constexpr Real turn_units(Real angle) const { return angle * Real::scaled(1, turn_shift); }
        [[nodiscard]] constexpr Real metres(Real drift) const {
            return drift * Real::scaled(1, Drift::fraction_bits - Position::fraction_bits - drift_shift);
        }
        [[nodiscard]] constexpr Real angle(Real turn) const { return turn * Real::scaled(1, -turn_shift); }
    };

    // The turns of one step of a free rotation: q32_block.hpp.
    class Block;

    template <class T>
    [[nodiscard]] static constexpr T constant(Real value) {
        return T::from(value);
    }

    // Conversions between state and working numbers: metres, metres in a step, half turns in a step.
    [[nodiscard]] static constexpr PositionSum sum(const Integrated<Position>& x) { return x.sum(); }
    [[nodiscard]] static constexpr Work metres(PositionSum x) { return Work::of(x); }
    // to - from, m. It may be larger than a sum holds, for places at opposite ends of the range.
    [[nodiscard]] static constexpr Work apart(PositionSum to, PositionSum from) {
        std::int64_t difference = 0;
        if (!__builtin_sub_overflow(to.raw, from.raw, &difference)) [[likely]]
            return Work::of(difference, -PositionSum::fraction_bits);
        return Work::of((to.raw >> 1) - (from.raw >> 1), 1 - PositionSum::fraction_bits);
    }
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
    // A component of a unit quaternion.
    [[nodiscard]] static constexpr Wide<62> unit_sum(Work u) { return u.template to_wide<62>(); }
    [[nodiscard]] static constexpr DriftSum drift_sum(Work metres, Scale s) {
        return {metres.to_sum(Position::fraction_bits + 32 + s.drift_shift)};
    }
    [[nodiscard]] static constexpr TurnSum turn_sum(Work half_turn, Scale s) {
        return {half_turn.to_sum(64 + s.turn_shift)};
    }

    // A constant change of drift in a step. It is held at the end of the range, so that sums with it cannot wrap.
    [[nodiscard]] static constexpr DriftSum fall(Real units) {
        constexpr std::int64_t limit = (std::int64_t{1} << 62) + (std::int64_t{1} << 32);
        const std::int64_t raw = units.to_fixed(DriftSum::fraction_bits, 64);
        return {raw > limit ? limit : raw < -limit ? -limit : raw};
    }
    // state += change, for changes of any size. A sum that would wrap stops beyond the range, where the range check
    // finds it.
    TUMBLE_INLINE static constexpr void add_any(Integrated<Drift>& d, Work metres, Scale s) {
        d.add({no_wrap(d.sum().raw, metres.to_sum(Position::fraction_bits + 32 + s.drift_shift, widest))});
    }
    TUMBLE_INLINE static constexpr void add_any(auto& turn, Work half_turn, Scale s) {
        turn.add({no_wrap(turn.sum().raw, half_turn.to_sum(64 + s.turn_shift, widest))});
    }
    // The same for a change in the units of the state.
    TUMBLE_INLINE static constexpr void add_sum(auto& number, auto change) {
        const auto sum = number.sum();
        number.add(held_sum(sum, change) - sum);
    }
    // The sum of two changes, held at the widest sum.
    template <int F>
    [[nodiscard]] TUMBLE_INLINE static constexpr Wide<F> held_sum(Wide<F> a, Wide<F> b) {
        // A sum wraps if its sign differs from those of both numbers. Compilers make more of __builtin_add_overflow().
        const Wide<F> sum = a + b;
        if (((upper(sum.raw) ^ upper(a.raw)) & (upper(sum.raw) ^ upper(b.raw))) < 0) [[unlikely]]
            return {a.raw < 0 ? -widest : widest};
        return sum;
    }
    // A load's change in a step, held within a quarter of the range, so that no stage of a method can wrap. Clears
    // `within` if the change was held.
    template <int F>
    [[nodiscard]] TUMBLE_INLINE static constexpr Wide<F> limited(Wide<F> kick, bool& within) {
        constexpr std::int64_t limit = std::int64_t{1} << 60;
        if (kick.raw <= limit && kick.raw >= -limit) [[likely]]
            return kick;
        within = false;
        return {kick.raw < 0 ? -limit : limit};
    }

    // is_rounding(): true if a correction to `t` is only rounding. Below: the relative rounding error of working
    // numbers, with a margin.
    [[nodiscard]] static constexpr bool is_rounding(const auto& correction, const auto&) {
        const auto small = [](Turn c) { return c.raw >= -3 && c.raw <= 3; };  // a correction has three roundings
        return small(correction[0]) && small(correction[1]) && small(correction[2]);
    }
    [[nodiscard]] static constexpr Work rounding_unit() { return Work::of(1, -28); }

    [[nodiscard]] static constexpr Work half_of(Work w) { return w.times_power_of_two(-1); }
    [[nodiscard]] static constexpr Work times_power_of_two(Work w, int n) { return w.times_power_of_two(n); }
    // A working number as a constant of a step, rounded to nearest.
    template <int bits>
    [[nodiscard]] static constexpr CoefficientOf<bits> factor(Work w) {
        return w.template to_fixed<CoefficientOf<bits>>();
    }

    // For a part of a step: sums times a fraction in (0, 1).
    using Fraction = Fixed<31>;
    [[nodiscard]] static constexpr Fraction fraction(Work w) { return w.template to_fixed<Fraction>(); }
    [[nodiscard]] static constexpr Work work(Fraction f) { return Work::of(f); }
    template <int F>
    [[nodiscard]] static constexpr Wide<F> part(Wide<F> a, Fraction f) {
        return {static_cast<std::int64_t>(static_cast<std::uint64_t>(mul_sum({a.raw}, f).raw) << 1)};
    }

    // n . x in m, for a unit vector n.
    using AlongSum = Wide<Position::fraction_bits + Unit::fraction_bits>;
    [[nodiscard]] static constexpr AlongSum along(const PositionSum (&x)[3], const auto& n) {
        const auto term = [&](int i) { return AlongSum{mul_sum({x[i].raw}, n[i]).raw}; };
        return term(0) + term(1) + term(2);
    }
    [[nodiscard]] static constexpr Work metres_along(AlongSum x) { return Work::of(x); }

    // The top bit is set if the value is outside the declared range. Formats have one bit more than the range needs, so
    // the check comes before anything can wrap.
    [[nodiscard]] TUMBLE_INLINE static constexpr std::uint32_t range_bits(std::int32_t raw) {
        return static_cast<std::uint32_t>(raw) ^ (static_cast<std::uint32_t>(raw) << 1);
    }
    template <class Body>
    [[nodiscard]] TUMBLE_INLINE static constexpr bool out_of_range(const Body& b, double) {
        const auto three = [](const auto& v) {
            return range_bits(upper(v.x.sum().raw)) | range_bits(upper(v.y.sum().raw)) |
                   range_bits(upper(v.z.sum().raw));
        };
        std::uint32_t bits = three(b.x_w) | three(b.d_w);
        if constexpr (requires { b.t_b; }) bits |= three(b.t_b);
        return (bits >> 31) != 0;
    }
    // True of a quaternion of unit length, to 2^-8.
    [[nodiscard]] static constexpr bool is_unit(const auto& q) {
        std::int64_t squares = 0;
        for (const std::int32_t raw : {q.w.raw, q.v.x().raw, q.v.y().raw, q.v.z().raw}) {
            const std::int64_t upper = raw >> 15;  // 2^15 is one
            squares += upper * upper;
        }
        return (squares + (1 << 22)) >> 23 == std::int64_t{1} << 7;
    }
    // The same for the spin alone. Below: a spin in half or twice the unit of time.
    template <class Body>
    [[nodiscard]] TUMBLE_INLINE static constexpr bool spins_out_of_range(const Body& b) {
        return ((range_bits(upper(b.t_b.x.sum().raw)) | range_bits(upper(b.t_b.y.sum().raw)) |
                 range_bits(upper(b.t_b.z.sum().raw))) >>
                31) != 0;
    }
    // A change of the spin in a scale with more halvings, or fewer.
    [[nodiscard]] TUMBLE_INLINE static constexpr TurnSum halved(TurnSum change, int halvings) {
        return {halvings >= 0 ? change.raw >> halvings : change.raw * (std::int64_t{1} << -halvings)};
    }
    static constexpr void halve(auto& turns) {
        for (int i = 0; i < 3; ++i) turns[i].add(half(turns[i].sum()) - turns[i].sum());
    }
    static constexpr void twice(auto& turns) {
        for (int i = 0; i < 3; ++i) turns[i].add(turns[i].sum());
    }
    // The same, but beyond the range where twice the spin is.
    static constexpr void twice_or_beyond(auto& turns) {
        for (int i = 0; i < 3; ++i) {
            auto& turn = turns[i];
            if (const std::int64_t raw = turn.sum().raw; raw >= -(std::int64_t{1} << 61) && raw < std::int64_t{1} << 61)
                turn.add(turn.sum());
            else leave_range(turn);
        }
    }
    // True if twice the spin, and that about z times 2^z_up, is below half of the range.
    [[nodiscard]] static constexpr bool is_slow(const auto& turns, int z_up) {
        const auto size = [](const auto& t) {
            const std::int32_t high = upper(t.sum().raw);
            return static_cast<std::uint32_t>(high ^ (high >> 31));
        };
        return ((size(turns.x) | size(turns.y)) >> 28) == 0 && z_up <= 28 && (size(turns.z) >> (28 - z_up)) == 0;
    }
    // True if the turn times 2^up is in the range. Below: the end of that range, and a turn that is held there. More
    // than most_room would leave a turn less than two bits: it stays as it is.
    static constexpr int most_room = 28;
    [[nodiscard]] TUMBLE_INLINE static constexpr bool has_room(const auto& turn, int up) {
        const std::int32_t high = upper(turn.sum().raw);
        return up > most_room || ((high ^ (high >> 31)) >> (30 - up)) == 0;
    }
    [[nodiscard]] static constexpr TurnSum largest_turn_with_room(int up) {
        return {up > most_room ? 0 : ((1 << (30 - up)) - 1) * (std::int64_t{1} << 32)};
    }
    static constexpr void clamp(auto& turn, int up) {
        if (up > most_room) return;
        const TurnSum limit = largest_turn_with_room(up);
        turn = std::remove_reference_t<decltype(turn)>::from_sum(turn.sum().raw < 0 ? -limit : limit);
    }
    // Moves a number out of its range, so that out_of_range() reports it.
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
            if constexpr (requires { b.t_b; }) clamp(b.t_b[i]);
        }
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr std::int32_t upper(std::int64_t raw) {
        return static_cast<std::int32_t>(raw >> 32);
    }
    // `change`, held so that sum + change stays within the widest sum.
    static constexpr std::int64_t widest = INT64_MAX - (std::int64_t{1} << 32);
    [[nodiscard]] static constexpr std::int64_t no_wrap(std::int64_t sum, std::int64_t change) {
        if (sum > 0 && change > widest - sum) return widest - sum;
        if (sum < 0 && change < -widest - sum) return -widest - sum;
        return change;
    }
    // raw * 2^up, rounded to nearest, for |raw| < 2^62, held at the widest sum. A spin that leaves its range is up to
    // sqrt(3) times as large before its parts are halved.
    [[nodiscard, gnu::noinline]] static constexpr std::int64_t shifted(std::int64_t raw, int up) {
        if (up < 0) return up < -62 ? 0 : ((raw >> (-up - 1)) + 1) >> 1;
        const int room = std::countl_zero(static_cast<std::uint64_t>(raw ^ (raw >> 63))) - 1;
        if (up < room) return raw * (std::int64_t{1} << up);
        if (raw == 0) return 0;
        if (up == room && raw != -1) {
            const std::int64_t sum = raw * (std::int64_t{1} << up);
            if (sum >= -widest && sum <= widest) return sum;
        }
        return raw < 0 ? -widest : widest;
    }

    // position += drift. The two sums differ only in the place of the binary point. Multiplying by a power of two
    // shifts the upper word down, straight into the sum.
    TUMBLE_INLINE static constexpr void move(Integrated<Position>& x, DriftSum drift, Scale s) {
        if constexpr (carry && detail::long_products_are_fast) {
            const auto low = static_cast<std::int64_t>(static_cast<std::uint32_t>(drift.raw) >> s.drift_shift);
            x.accumulate(Drift{upper(drift.raw)}, Fixed<Position::fraction_bits + 2>{1 << (32 - s.drift_shift)},
                         [&](PositionSum sum) { return sum + PositionSum{low}; });
        } else x.add({detail::shift_right(drift.raw, s.drift_shift)});
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr DriftSum sum(const Integrated<Drift>& d) { return d.sum(); }
    template <int F>
    [[nodiscard]] TUMBLE_INLINE static constexpr Wide<F> half(Wide<F> sum) {
        return {sum.raw >> 1};
    }
    // position += drift + extra, with the drift's residual.
    TUMBLE_INLINE static constexpr void coast(Integrated<Position>& x, const Integrated<Drift>& d, DriftSum extra,
                                              Scale s) {
        move(x, d.sum() + extra, s);
    }
    [[nodiscard]] static constexpr PositionSum displaced(PositionSum x, DriftSum d, Scale s) {
        return x + PositionSum{detail::shift_right(d.raw, s.drift_shift)};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr Angle half_angle(Angle a) { return {a.raw >> 1}; }
    TUMBLE_INLINE static constexpr void add(Integrated<Drift>& d, Wide<62> increment) { d.add(increment); }

    // The angle of a turn, without its scale, dithered. A turn at the end of the format, which range_left reports, may
    // wrap.
    [[nodiscard]] TUMBLE_INLINE static constexpr Angle angle(Turn t, Scale s, Dither d) {
        const std::uint32_t fraction = (d.angle >> 1) >> (31 - s.turn_shift);
        return {static_cast<std::int32_t>(static_cast<std::uint32_t>(t.raw) + fraction) >> s.turn_shift};
    }
    // The upper word of an exact sum of products, dithered.
    [[nodiscard]] TUMBLE_INLINE static constexpr Angle round_angle(AngleSum a, Dither d) {
        return {detail::upper_of_sum(a.raw, 0, d.delta)};
    }
    // The sum of a turn times a 32-bit number, with both words of the sum. Changes of the spin are not rounded to 32
    // bits, because white noise in the spin grows as time^1.5 in the orientation.
    template <int F>
    [[nodiscard]] TUMBLE_INLINE static constexpr Wide<32 + F> mul_sum(TurnSum t, Fixed<F> c) {
        const auto upper = static_cast<std::int32_t>(t.raw >> 32);
        const auto lower = static_cast<std::int32_t>(static_cast<std::uint32_t>(t.raw) >> 1);
        return {detail::multiply_add(detail::multiply(lower, c.raw) >> 31, upper, c.raw)};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr TurnSum sum(const Carried<Turn, carry>& t) { return t.sum(); }
    [[nodiscard]] TUMBLE_INLINE static constexpr TurnSum sum(const Shaped<Turn, carry>& t) { return t.sum(); }
    // A sum as a turn, rounded to nearest.
    [[nodiscard]] TUMBLE_INLINE static constexpr Turn narrow_turn(TurnSum t) { return narrow<Turn>(t); }
    // coefficient * p / 2^turn_shift as a turn. For stages, where the upper word of the product is enough.
    [[nodiscard]] TUMBLE_INLINE static constexpr Turn stage_turn(Coefficient c, TurnProduct p, Scale s) {
        // The upper word is the product rounded down. c / 2 adds the half unit that is missing on average; without it,
        // the bias would act on the spin like a torque.
        const auto upper = static_cast<std::int32_t>(p.raw >> 32);
        const auto product = detail::multiply_upper(c.raw, 2 * upper + 1);
        return {(product + (1 << s.turn_shift >> 1)) >> s.turn_shift};
    }
    // t += coefficient * p, to the last bit of the carried sum: 64 bits of the 96-bit product are kept.
    template <int F>
    TUMBLE_INLINE static constexpr void add_turn(Shaped<Turn, carry>& t, Fixed<F> c, TurnProduct p, Scale s) {
        t.add({detail::shift_right(static_cast<std::int64_t>(static_cast<std::uint64_t>(mul_sum(p, c).raw) << (32 - F)),
                                   s.turn_shift)});
    }
};

}  // namespace tumble

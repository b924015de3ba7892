// The numbers of joints. A Unit is a component of an axis, of an arm over a power of two of its length, or of a matrix
// over powers of two of mass and length: at most 1. What a joint has open, a gap or a rate, is a Unit too, in 2^-bits
// m. In floating point all of them are plain numbers.
//
// Fixed point: gaps and rates are differences of 64-bit sums of the state, so they are exact but for the rounding of
// axes and arms, 2^-30 of the arm. The solution computes with at most 23 bits of them, and with fewer where a light
// link moves faster than what is open (JointForest::fit_lengths()). What it leaves is the gap of the next correction.
#pragma once

#include <tumble/body/state.hpp>
#include <tumble/joints/joint.hpp>

namespace tumble {

template <class N>
struct JointNumbers;

template <class N>
requires(N::fixed_point) struct JointNumbers<N> {
    using Unit = typename N::Unit;
    using Open = std::int64_t;  // before it is held in a Unit

    static constexpr int sum_bits = N::PositionSum::fraction_bits;
    // Bits of gaps, of rates (m in a step) and of spins (rad in a step), finest first. Larger ones take the others.
    static constexpr int gap_bits = sum_bits < 34 ? sum_bits : 34, coarse_gap_bits = gap_bits - 12, rate_bits = 36,
                         coarse_rate_bits = 22, spin_bits = 33, coarse_spin_bits = 27;
    // The least power of two of arms, m: a Unit of it is at least 2^-gap_bits m.
    static constexpr int least_log2 = -4, most_log2 = 26;
    // Bits of the largest gap or rate in a solution, at most and at least, and of what follows from it, at most.
    static constexpr int open_bits = 23, least_open_bits = 12, room_bits = 29;
    static constexpr int most_up = 14;  // a gap of one unit counts as that many bits

    // a 2^-bits, rounded, for bits up to 31, which are as good as any more.
    struct Down {
        std::int32_t half;
        int bits;
        [[nodiscard]] TUMBLE_INLINE explicit Down(int b) : half{static_cast<std::int32_t>(1u << b >> 1)}, bits{b} {}
        [[nodiscard]] TUMBLE_INLINE Unit operator()(Unit a) const { return {(a.raw + half) >> bits}; }
    };
    static constexpr int most_down = 31;
    [[nodiscard]] TUMBLE_INLINE static Unit down(Unit a, int bits) {
        return Down{bits < most_down ? bits : most_down}(a);
    }
    // a 2^bits for positive bits, held.
    [[nodiscard]] static Unit up(Unit a, int bits) {
        const std::int64_t up = static_cast<std::int64_t>(a.raw) * (std::int64_t{1} << (bits > 32 ? 32 : bits));
        return {static_cast<std::int32_t>(up > INT32_MAX ? INT32_MAX : up < -INT32_MAX ? -INT32_MAX : up)};
    }
    // The same with ties to even, by 1 bit or more: a bias of a quarter of a unit would push a free mechanism on and
    // on.
    [[nodiscard]] TUMBLE_INLINE static Unit down_even(Unit a, int bits) {
        if (bits > 30) return Unit{0};
        return Unit{(a.raw + ((1 << bits >> 1) - 1) + ((a.raw >> bits) & 1)) >> bits};
    }
    // a 2^up for up in 0 .. 31. Words by themselves, which cost less than a product.
    [[nodiscard]] TUMBLE_INLINE static std::int64_t shifted_up(std::int32_t a, int up) {
        const std::uint32_t low = static_cast<std::uint32_t>(a) << up;
        const std::int32_t upper = (a >> 1) >> (31 - up);
        return static_cast<std::int64_t>(static_cast<std::uint64_t>(upper) << 32 | low);
    }
    // a 2^up, as bits of a sum; below: rounded down where up is negative.
    [[nodiscard]] TUMBLE_INLINE static std::int64_t raised(std::int32_t a, int up) {
        if (up >= 0 && up <= 31) [[likely]]
            return shifted_up(a, up);
        return N::shifted(a, up);
    }
    [[nodiscard]] TUMBLE_INLINE static std::int64_t lowered(std::int64_t a, int down) {
        if constexpr (sizeof(std::size_t) < sizeof(a)) {
            // Words by themselves: compilers would choose between them for each shift.
            const auto upper = static_cast<std::int32_t>(a >> 32);
            if (down >= 0 && down < 32) [[likely]] {
                const std::uint32_t low = static_cast<std::uint32_t>(a) >> down | static_cast<std::uint32_t>(upper)
                                                                                      << 1 << (31 - down);
                return static_cast<std::int64_t>(static_cast<std::uint64_t>(upper >> down) << 32 | low);
            }
        } else if (down >= 0) [[likely]] {
            return a >> (down > 63 ? 63 : down);
        }
        return lowered_far(a, down);
    }
    [[nodiscard, gnu::noinline]] static std::int64_t lowered_far(std::int64_t a, int down) {
        if (down >= 0) return a >> (down > 63 ? 63 : down);
        return down < -63 ? 0 : static_cast<std::int64_t>(static_cast<std::uint64_t>(a) << -down);
    }
    // Of two places, own less other.
    template <int bits>
    [[nodiscard]] TUMBLE_INLINE static Open apart(const auto& own, const auto& other) {
        return lowered((own.sum() - other.sum()).raw, sum_bits - bits);
    }
    // Of two drifts, m in a step. Below: of one.
    [[nodiscard]] TUMBLE_INLINE static Open drift_apart(const auto& own, const auto& other, typename N::Scale scale,
                                                        int bits) {
        return lowered((own.sum() - other.sum()).raw, sum_bits + scale.drift_shift - bits);
    }
    [[nodiscard]] TUMBLE_INLINE static Open drift(const auto& own, typename N::Scale scale, int bits) {
        return lowered(own.sum().raw, sum_bits + scale.drift_shift - bits);
    }
    // With fewer bits.
    [[nodiscard]] TUMBLE_INLINE static Open coarser(Open a, int down) {
        if (down == 0) [[likely]]
            return a;
        return a >> down;
    }
    // A length of the set-up, in 2^-gap_bits m.
    [[nodiscard]] static constexpr Open length(Real metres) { return metres.to_fixed(gap_bits, 64); }
    static constexpr void add_to(auto& digest, Open length) {
        digest.add(static_cast<int>(static_cast<std::uint32_t>(length)));
        digest.add(static_cast<int>(static_cast<std::uint32_t>(length >> 32)));
    }
    // A length along an axis, without the lower bits: half a unit less on average.
    [[nodiscard]] static Open along(Open length, Unit axis) {
        const std::int64_t high = length >> 30, low = length & 0x3fffffff;
        return high * axis.raw + (low * axis.raw >> Unit::fraction_bits);
    }
    // The power of two, m, above the components of a gap in 2^-gap_bits m, without bounds.
    [[nodiscard]] static int log2_above(const Open (&gap)[3]) {
        std::uint64_t all = 0;
        for (const Open g : gap) all |= static_cast<std::uint64_t>(g < 0 ? -g : g);
        return static_cast<int>(std::bit_width(all)) - gap_bits;
    }
    // The drift of a change of motion, in 2^-bits m in a step.
    [[nodiscard]] static Open drift_of(typename N::DriftSum change, typename N::Scale scale, int bits) {
        return lowered(change.raw, sum_bits + scale.drift_shift - bits);
    }
    // An arm over 2^log2 m.
    template <int bits>
    [[nodiscard]] TUMBLE_INLINE static Open arm(Unit a, int log2) {
        const int up = bits - Unit::fraction_bits + log2;
        if constexpr (bits - Unit::fraction_bits + least_log2 >= 0 && bits - Unit::fraction_bits + most_log2 <= 31)
            return shifted_up(a.raw, up);
        else return up >= 0 ? raised(a.raw, up) : a.raw >> (up < -31 ? 31 : -up);
    }
    // A turn, rad, times 2^log2 m, in 2^-bits m. Clears `fits` where it is held.
    [[nodiscard]] TUMBLE_INLINE static Unit lean(Unit a, int log2, int bits, bool& fits) {
        const int up = bits - Unit::fraction_bits + log2;
        if (up < 0) return {a.raw >> (up < -31 ? 31 : -up)};
        const auto raised = static_cast<std::int32_t>(static_cast<std::uint32_t>(a.raw) << (up & 31));
        if (up < 31 && raised >> up == a.raw && within(raised, 30)) [[likely]]
            return {raised};
        fits = fits && a.raw == 0;
        return {a.raw < 0 ? -0x3fffffff : a.raw > 0 ? 0x3fffffff : 0};
    }
    // True of a number of so many bits and a sign.
    [[nodiscard]] TUMBLE_INLINE static bool within(std::int32_t a, int bits) {
        return static_cast<std::uint32_t>(a) + (1u << bits) < 2u << bits;
    }
    // A component of spin x arm. The spin is in 2^-of_spin rad.
    [[nodiscard]] TUMBLE_INLINE static Open swept(auto product, int log2, int of_spin, int bits) {
        return lowered(product.raw, of_spin + Unit::fraction_bits - log2 - bits);
    }
    // A spin in 2^-of_spin, times 2^log2 m.
    [[nodiscard]] TUMBLE_INLINE static Open turned(Unit spin, int log2, int of_spin, int bits) {
        const int up = bits + log2 - of_spin;
        return up >= 0 && up <= 31 ? shifted_up(spin.raw, up) : lowered_far(spin.raw, -up);
    }
    // What is open as a Unit. Clears `fits` where it is held.
    [[nodiscard]] TUMBLE_INLINE static Unit clamped(Open a, bool& fits) { return clamped_at<30>(a, fits); }
    // The same at half of it, so that a difference of two turned vectors holds.
    [[nodiscard]] TUMBLE_INLINE static Unit clamped_half(Open a, bool& fits) { return clamped_at<29>(a, fits); }
    template <int bits>
    [[nodiscard]] TUMBLE_INLINE static Unit clamped_at(Open a, bool& fits) {
        const auto low = static_cast<std::int32_t>(a);
        if (low == a && within(low, bits)) [[likely]]
            return {low};
        fits = false;
        constexpr std::int32_t most = (1 << bits) - 1;
        return {a < 0 ? -most : most};
    }
    // The shift that brings the largest to its bits.
    [[nodiscard]] static int up_for(Unit largest, int bits) {
        const int up = bits - static_cast<int>(std::bit_width(static_cast<std::uint32_t>(largest.raw)));
        return up > most_up ? most_up : up;
    }
    [[nodiscard]] TUMBLE_INLINE static Unit shifted(Unit a, int up) {
        return up >= 0 ? Unit{static_cast<std::int32_t>(static_cast<std::uint32_t>(a.raw) << up)} : down(a, -up);
    }

    // a mantissa 2^(up - 32), rounded to nearest and held at +-(2^31 - 1). up is in 1 .. 30.
    [[nodiscard]] TUMBLE_INLINE static Unit raised_product(Unit a, std::int32_t mantissa, int up) {
        const std::int64_t product = detail::multiply(a.raw, mantissa) + (std::int64_t{0x80000000u} >> up);
        const auto upper = static_cast<std::int32_t>(product >> 32);
        const auto raised = static_cast<std::int32_t>(static_cast<std::uint32_t>(upper) << up);
        if (raised >> up != upper) [[unlikely]]
            return {upper < 0 ? -0x7fffffff : 0x7fffffff};
        return {raised | static_cast<std::int32_t>(static_cast<std::uint32_t>(product) >> (32 - up))};
    }
    // 1 / sqrt(d), as a factor.
    struct Root {
        std::int32_t mantissa;
        int up;
        [[nodiscard]] TUMBLE_INLINE Unit operator()(Unit a) const { return raised_product(a, mantissa, up); }
    };
    // d is rounded: a moment too small for the matrix counts as its unit.
    [[nodiscard]] static Root inverse_root(Unit d) {
        const auto root = detail::inverse_root(static_cast<std::uint64_t>(d.raw > 0 ? d.raw : 1));
        return {root.raw, 32 + root.exponent + Unit::fraction_bits / 2};
    }
    // A factor of any size.
    struct Factor {
        std::int32_t mantissa;
        std::int8_t log2;
        [[nodiscard]] static constexpr Factor of(Real value) {
            const int log2 = value.ceil_log2_bound();
            return {static_cast<std::int32_t>((value * Real::scaled(1, -log2)).to_fixed(Unit::fraction_bits)),
                    static_cast<std::int8_t>(log2)};
        }
        // Of a factor of at least 1/2.
        [[nodiscard]] TUMBLE_INLINE Unit operator()(Unit a) const {
            return raised_product(a, mantissa, log2 < 28 ? log2 + 2 : 30);
        }
    };
    // A change of motion, held within a quarter of the range, so that no sum of two wraps. Clears `within` where it is.
    template <int F>
    [[nodiscard]] TUMBLE_INLINE static Wide<F> clamped(Wide<F> change, bool& within) {
        const auto upper = static_cast<std::uint32_t>(static_cast<std::uint64_t>(change.raw) >> 32);
        if (upper + (1u << 28) < 1u << 29) [[likely]]
            return change;
        constexpr std::int64_t most = (std::int64_t{1} << 60) - 1;
        within = false;
        return {change.raw < 0 ? -most : most};
    }
    [[nodiscard]] TUMBLE_INLINE static Unit mean(Unit a, Unit b) { return {(a.raw >> 1) + (b.raw >> 1)}; }
    // The angle in a step of a turn, in 2^-of_spin rad.
    [[nodiscard]] TUMBLE_INLINE static Open angle(typename N::Turn t, Factor to_angle, typename N::Scale scale,
                                                  int of_spin) {
        const int down = 32 + scale.turn_shift + Unit::fraction_bits - to_angle.log2 - of_spin;
        return lowered(detail::multiply(t.raw, to_angle.mantissa), down);
    }
    // A quarter of that in a part of 2^-halvings of a step.
    [[nodiscard]] TUMBLE_INLINE static Unit quarter(typename N::Turn t, Factor to_angle, typename N::Scale scale,
                                                    int halvings) {
        const int down = 32 + scale.turn_shift + 2 - to_angle.log2 + halvings;
        const std::int64_t product = detail::multiply(t.raw, to_angle.mantissa);
        bool fits = true;
        if (down >= 32) [[likely]]
            return clamped(static_cast<std::int32_t>(product >> 32) >> (down > 63 ? 31 : down - 32), fits);
        return clamped(lowered(product, down), fits);
    }
    // True where a change of spin times 2^up, up to 6, is more than a quarter of the range.
    [[nodiscard]] TUMBLE_INLINE static bool is_wide(const typename N::TurnSum (&change)[3], int up) {
        std::int64_t bits = 0;
        for (const auto& sum : change) bits |= sum.raw ^ (sum.raw >> 63);
        return bits >> (60 - up) != 0;
    }
    // True of a quarter of a turn, of which the square counts: more than 1/16 rad in the turn.
    [[nodiscard]] TUMBLE_INLINE static bool is_far(Unit quarter) {
        return magnitude_of(quarter) > Unit{1 << (Unit::fraction_bits - 6)};
    }
    // A sum times 2^-down.
    template <class Sum>
    [[nodiscard]] TUMBLE_INLINE static constexpr Sum halved(Sum sum, int down) {
        return down == 0 ? sum : Sum{sum.raw >> down};
    }
    // h^2 f r / I in 2^-16, from the sum of the components of 2^log2 h^2 f, kg m.
    using Load = std::int64_t;
    [[nodiscard, gnu::noinline]] static Load load(const auto& force, const Factor& swing, int log2) {
        const std::int64_t sum =
            std::int64_t{magnitude_of(force[0]).raw} + magnitude_of(force[1]).raw + magnitude_of(force[2]).raw;
        const std::int32_t size = static_cast<std::int32_t>(sum < INT32_MAX ? sum : INT32_MAX);
        const int down = Unit::fraction_bits - swing.log2 - log2 - 16;
        return down >= 0 ? lowered(detail::multiply(size, swing.mantissa), down) : std::int64_t{size != 0} << 40;
    }
    [[nodiscard]] TUMBLE_INLINE static bool is_too_strong(Load load, int halvings) {
        return load > std::int64_t{1} << (16 + detail::joint_load_log2 + 2 * halvings);
    }
    [[nodiscard]] TUMBLE_INLINE static bool turns_too_far(const auto& spin, int of_spin, int halvings) {
        return dot(spin, spin).raw > std::int64_t{1}
                                         << (2 * (of_spin - 2 + halvings) < 62 ? 2 * (of_spin - 2 + halvings) : 62);
    }
    // Sums of the state by a change in 2^-bits m, and by a change of the angle in 2^-bits rad over 2^log2.
    [[nodiscard]] TUMBLE_INLINE static typename N::DriftSum drift_sum(Unit a, typename N::Scale scale, int bits) {
        return {raised(a.raw, sum_bits + scale.drift_shift - bits)};
    }
    [[nodiscard]] TUMBLE_INLINE static typename N::PositionSum position_sum(Unit a, int bits) {
        return {raised(a.raw, sum_bits - bits)};
    }
    [[nodiscard]] TUMBLE_INLINE static typename N::TurnSum turn_sum(Unit angle, Unit to_turn, typename N::Scale scale,
                                                                    int log2, int bits) {
        const std::int64_t product = detail::multiply(angle.raw, to_turn.raw);
        const int down = bits + log2 + Unit::fraction_bits - 64 - scale.turn_shift;
        return {down > 0 ? lowered(product, down) : N::shifted(product, -down)};
    }
    // Half of an angle in 2^-bits over 2^log2, held below half a radian.
    [[nodiscard]] static typename N::Angle half_angle(Unit angle, int log2, int bits) {
        constexpr std::int64_t most = std::int64_t{1} << 30;
        const std::int64_t half = raised(angle.raw, 31 - bits - log2);
        return {static_cast<std::int32_t>(half > most ? most : half < -most ? -most : half)};
    }
    // An arm of the set-up, over 2^log2.
    [[nodiscard]] static constexpr Unit unit(Real a, int log2) {
        return N::template constant<Unit>(a * Real::scaled(1, -log2));
    }
    [[nodiscard]] static constexpr int log2_of(Real length) {
        return detail::clamp(length.ceil_log2_bound(), least_log2, most_log2);
    }
    // The power of two, m, above a gap in 2^-bits m.
    [[nodiscard]] static int log2_of(Open gap, int bits) {
        const int log2 = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(gap < 0 ? -gap : gap))) - bits;
        return detail::clamp(log2, least_log2, most_log2 - 2);
    }
    // A gap in 2^-bits m as an arm over 2^log2 m.
    [[nodiscard]] static Unit unit_of(Open gap, int log2, int bits) {
        return {static_cast<std::int32_t>(lowered(gap, bits + log2 - Unit::fraction_bits))};
    }
    // A joint is closed where no component of its gap is larger: three units of the largest arm, which is what the
    // rounding of axes and of arms leaves of a gap, times 2^roundings. Arms of less than 1 m count as 1 m. Without
    // carry it is the rounding of two places.
    [[nodiscard]] TUMBLE_INLINE static Unit enough(bool, int log2, int roundings) {
        constexpr int of_arms = gap_bits - Unit::fraction_bits, of_places = gap_bits - N::Position::fraction_bits;
        int up = (log2 > 0 ? log2 : 0) + roundings + (of_arms > 0 ? of_arms : 0);
        if (!N::carry && of_places > up) up = of_places;
        return {std::int32_t{3} << (up > 28 ? 28 : up)};
    }
    // Where a body was: places in 2^-gap_bits m modulo 1/4 m or more, and quaternions in 2^-turn_bits, modulo 2.
    static constexpr int turn_bits = 31;
    struct Pose {
        std::int32_t at[7];
    };
    // Whether a step at this drift moves a body by less than 1/8 m, so that a Pose tells both places apart.
    [[nodiscard]] static bool is_told(const auto& drift_of_step, typename N::Scale scale) {
        for (int i = 0; i < 3; ++i)
            if (const Open eighths = drift(drift_of_step[i], scale, 3); eighths != 0 && eighths != -1) return false;
        return true;
    }
    static void take_pose(Pose& pose, const auto& state) {
        for (int i = 0; i < 3; ++i)
            pose.at[i] = static_cast<std::int32_t>(state.x_w[i].sum().raw >> (sum_bits - gap_bits));
        const auto& q = state.q_wb;
        const std::int64_t parts[] = {q.w.sum().raw, q.x.sum().raw, q.y.sum().raw, q.z.sum().raw};
        constexpr int down = decltype(q.w.sum())::fraction_bits - turn_bits;
        for (int i = 0; i < 4; ++i) pose.at[3 + i] = static_cast<std::int32_t>(parts[i] >> down);
    }
    // Whether it is there, but for so many gaps that count as closed. Its arms are over 2^log2 m.
    [[nodiscard]] static bool is_at(const Pose& pose, const auto& state, int gaps, int log2, const auto&, const auto&) {
        Pose now;
        take_pose(now, state);
        // The change of a unit quaternion is half of the turn.
        const std::int64_t most = std::int64_t{gaps} * enough(false, log2, 0).raw,
                           most_turn = lowered(most, log2 + 1 + gap_bits - turn_bits);
        bool same = true;
        for (int i = 0; i < 7; ++i) {
            const auto way = static_cast<std::int32_t>(static_cast<std::uint32_t>(now.at[i]) -
                                                       static_cast<std::uint32_t>(pose.at[i]));
            const std::int64_t limit = i < 3 ? most : most_turn;
            same = same && way <= limit && way >= -limit;
        }
        return same;
    }
};

template <class N>
requires(!N::fixed_point) struct JointNumbers<N> {
    using Unit = typename N::Unit;
    using Open = Unit;

    static constexpr int gap_bits = 0, coarse_gap_bits = 0, rate_bits = 0, coarse_rate_bits = 0, spin_bits = 0,
                         coarse_spin_bits = 0, least_log2 = 0;

    struct Down {
        [[nodiscard]] TUMBLE_INLINE explicit Down(int) {}
        [[nodiscard]] TUMBLE_INLINE Unit operator()(Unit a) const { return a; }
    };
    static constexpr int most_down = 0;
    [[nodiscard]] TUMBLE_INLINE static Unit down(Unit a, int) { return a; }
    [[nodiscard]] TUMBLE_INLINE static Unit up(Unit a, int) { return a; }
    [[nodiscard]] TUMBLE_INLINE static Unit down_even(Unit a, int) { return a; }
    // With what the sums have left over.
    template <int>
    [[nodiscard]] TUMBLE_INLINE static Open apart(const auto& own, const auto& other) {
        const Unit apart = own.value() - other.value();
        if constexpr (N::carry) return apart + (own.residual() - other.residual());
        else return apart;
    }
    [[nodiscard]] TUMBLE_INLINE static Open drift_apart(const auto& own, const auto& other, typename N::Scale, int) {
        return apart<0>(own, other);
    }
    [[nodiscard]] TUMBLE_INLINE static Open drift(const auto& own, typename N::Scale, int) { return own.value(); }
    [[nodiscard]] TUMBLE_INLINE static Open coarser(Open a, int) { return a; }
    [[nodiscard]] static constexpr Open length(Real metres) { return N::template constant<Unit>(metres); }
    static void add_to(auto& digest, Open length) { digest.add_number(length); }
    [[nodiscard]] static Open along(Open length, Unit axis) { return length * axis; }
    [[nodiscard]] static int log2_above(const Open (&)[3]) { return 0; }
    [[nodiscard]] static Open drift_of(Unit change, typename N::Scale, int) { return change; }
    template <int>
    [[nodiscard]] TUMBLE_INLINE static Open arm(Unit a, int) {
        return a;
    }
    [[nodiscard]] TUMBLE_INLINE static Unit lean(Unit a, int, int, bool&) { return a; }
    [[nodiscard]] TUMBLE_INLINE static Open swept(Unit product, int, int, int) { return product; }
    [[nodiscard]] TUMBLE_INLINE static Open turned(Unit spin, int, int, int) { return spin; }
    [[nodiscard]] TUMBLE_INLINE static Unit clamped(Open a, bool&) { return a; }
    [[nodiscard]] TUMBLE_INLINE static Unit clamped_half(Open a, bool&) { return a; }
    [[nodiscard]] TUMBLE_INLINE static Unit shifted(Unit a, int) { return a; }

    struct Root {
        Unit inverse;
        [[nodiscard]] TUMBLE_INLINE Unit operator()(Unit a) const { return a * inverse; }
    };
    [[nodiscard]] static Root inverse_root(Unit d) { return {Unit(1) / sqrt(d)}; }
    struct Factor {
        Unit value;
        [[nodiscard]] static constexpr Factor of(Real real) { return {N::template constant<Unit>(real)}; }
        [[nodiscard]] TUMBLE_INLINE Unit operator()(Unit a) const { return a * value; }
    };
    [[nodiscard]] TUMBLE_INLINE static Unit mean(Unit a, Unit b) { return (a + b) * Unit(0.5); }
    [[nodiscard]] TUMBLE_INLINE static Open angle(Unit t, Factor to_angle, typename N::Scale, int) {
        return t * to_angle.value;
    }
    [[nodiscard]] TUMBLE_INLINE static Unit quarter(Unit t, Factor to_angle, typename N::Scale, int halvings) {
        return halved(t * to_angle.value, halvings + 2);
    }
    [[nodiscard]] TUMBLE_INLINE static bool is_far(Unit quarter) { return magnitude_of(quarter) > Unit(0.015625); }
    // a 2^-down.
    [[nodiscard]] TUMBLE_INLINE static constexpr Unit halved(Unit a, int down) {
        for (; down > 0; --down) a *= Unit(0.5);
        for (; down < 0; ++down) a += a;
        return a;
    }
    using Load = Unit;
    [[nodiscard]] TUMBLE_INLINE static Load load(const auto& force, Factor swing, int log2) {
        return swing(halved(magnitude_of(force[0]) + magnitude_of(force[1]) + magnitude_of(force[2]), -log2));
    }
    [[nodiscard]] TUMBLE_INLINE static bool is_too_strong(Load load, int halvings) {
        return load * Unit(1 << -detail::joint_load_log2) > Unit(1 << 2 * halvings);
    }
    [[nodiscard]] TUMBLE_INLINE static bool turns_too_far(const auto& spin, int, int halvings) {
        return dot(spin, spin) > Unit(1 << 2 * halvings) * Unit(0.0625);
    }
    // Times 2^-bits: those of a change that is more than the solution's.
    [[nodiscard]] TUMBLE_INLINE static Unit drift_sum(Unit a, typename N::Scale, int bits) { return halved(a, bits); }
    [[nodiscard]] TUMBLE_INLINE static Unit position_sum(Unit a, int) { return a; }
    [[nodiscard]] TUMBLE_INLINE static Unit turn_sum(Unit angle, Unit to_turn, typename N::Scale, int, int bits) {
        return halved(angle * to_turn, bits);
    }
    [[nodiscard]] static Unit half_angle(Unit angle, int, int) {
        const Unit half = angle * Unit(0.5);
        return half > Unit(0.25) ? Unit(0.25) : half < Unit(-0.25) ? Unit(-0.25) : half;
    }
    [[nodiscard]] static constexpr Unit unit(Real a, int) { return N::template constant<Unit>(a); }
    [[nodiscard]] static constexpr int log2_of(Real) { return 0; }
    [[nodiscard]] static int log2_of(Open, int) { return 0; }
    [[nodiscard]] static Unit unit_of(Open gap, int, int) { return gap; }
    // Some roundings of the largest of the places and arms that a gap is the difference of, at least those of 1 m: in
    // double 2^-40, which costs no correction more than 2^-46 would save. With carry a sixteenth of that with the
    // guess: it lags behind the force f of the joint, and a gap c that opens under one force and closes under another
    // takes or gives the difference of f c. A pendulum in float gained 1.3e-4 m g l in 10^6 steps of 1/256 s where the
    // guess was kept up to 3e-7 m, and moves by 1e-6 at a sixteenth; at a fourth it gained 1.3e-4 in 10^6 steps of
    // 1/1024 s. Without carry rounding alone moves it by up to 1.6e-4, and more corrections would cost 15 % of a step.
    [[nodiscard]] TUMBLE_INLINE static Unit enough(bool is_guess, int, int) {
        constexpr Unit of_correction = sizeof(Unit) == 4 ? Unit(3e-7) : Unit(1e-12);
        return N::carry && is_guess ? of_correction * Unit(0.0625) : of_correction;
    }
    [[nodiscard, gnu::noinline]] static Unit enough_of(bool is_guess, const auto& place, const auto& own,
                                                       const auto& other) {
        Unit size(1);
        for (int i = 0; i < 3; ++i) {
            size = larger_of(size, magnitude_of(place[i].value()));
            size = larger_of(size, magnitude_of(own[i]));
            size = larger_of(size, magnitude_of(other[i]));
        }
        return size * enough(is_guess, 0, 0);
    }
    // Where a body was.
    struct Pose {
        Unit at[7];
    };
    [[nodiscard]] static bool is_told(const auto&, typename N::Scale) { return true; }
    static void take_pose(Pose& pose, const auto& state) {
        for (int i = 0; i < 3; ++i) pose.at[i] = state.x_w[i].value();
        const auto& q = state.q_wb;
        const Unit parts[] = {q.w.value(), q.x.value(), q.y.value(), q.z.value()};
        for (int i = 0; i < 4; ++i) pose.at[3 + i] = parts[i];
    }
    // Whether it is there, but for so many gaps that count as closed.
    [[nodiscard]] static bool is_at(const Pose& pose, const auto& state, int gaps, int, const auto& own,
                                    const auto& link) {
        Pose now;
        take_pose(now, state);
        const Unit most = Unit(gaps) * enough_of(false, state.x_w, own, link);
        bool same = true;
        // The change of a unit quaternion is half of the turn.
        for (int i = 0; i < 7; ++i)
            same = same && magnitude_of(Unit(now.at[i] - pose.at[i])) <= (i < 3 ? most : Unit(most * Unit(0.5)));
        return same;
    }
};

}  // namespace tumble

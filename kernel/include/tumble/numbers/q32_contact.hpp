// ContactNumbers of a fixed-point system. A Length is a 32-bit distance; the largest body decides its binary point. A
// Lever is an arm over a radius of gyration. A Unit is a component of a direction or of a row of unit length. A Speed
// is a velocity times the root of the mass; the fastest body of an island decides its binary point. A Friction is a
// coefficient of friction. Roots take Newton steps on 32-bit words, without division.
#pragma once

#include <tumble/numbers/functions.hpp>
#include <tumble/numbers/q32.hpp>
#include <tumble/numbers/vectors.hpp>

namespace tumble {

namespace detail {

// raw * 2^exponent, with raw in (2^29, 2^30].
struct ScaledRoot {
    std::int32_t raw;
    int exponent;
};

// 1 / sqrt(s) for s > 0, to 2^-29: the parabola that is off by at most 2.4 % as the first guess, and three Newton
// steps. No division.
[[nodiscard]] constexpr ScaledRoot inverse_root(std::uint64_t s) {
    const auto upper = [](std::uint32_t a, std::uint32_t b) {
        return static_cast<std::uint32_t>((static_cast<std::uint64_t>(a) * b) >> 32);
    };
    const int up = std::countl_zero(s | 1u) & ~1;
    const auto x = static_cast<std::uint32_t>((s << up) >> 32);  // [1/4, 1) with 32 bits
    // h = 1 / (2 sqrt(x)) with 31 bits: h <- h (3/2 - 2 x h^2)
    std::uint32_t h = 0xaaeef78eu - upper(x, 0xd2434869u - upper(x, 0x68de4bc3u));
    for (int i = 0; i < 3; ++i) {
        const std::uint32_t t = 0x60000000u - 2u * upper(x, upper(h, h));
        h = static_cast<std::uint32_t>((static_cast<std::uint64_t>(h) * t) >> 30);
    }
    return {static_cast<std::int32_t>((h + 1u) >> 1), (up >> 1) - 61};
}

// (a * b) >> shift, rounded to nearest and held at +-(2^31 - 1). shift is in 0 .. 62.
[[nodiscard]] TUMBLE_INLINE constexpr std::int32_t scaled_product(std::int32_t a, std::int32_t b, int shift) {
    const std::int64_t half = (std::int64_t{1} << shift) >> 1;
    const std::int64_t product = (multiply(a, b) + half) >> shift;
    const auto low = static_cast<std::int32_t>(product);
    if (low == product) [[likely]]
        return low;
    return product < 0 ? -0x7fffffff : 0x7fffffff;
}

}  // namespace detail

template <class N>
struct ContactNumbers;

template <class N>
requires(N::fixed_point) struct ContactNumbers<N> {
    using Work = typename N::Work;
    using Unit = Fixed<30>;
    using Length = Fixed<24>;  // Fixed for its operations only: LengthScale has the binary point
    using Lever = Fixed<24>;
    using Speed = Fixed<30>;  // Fixed for its operations only: SpeedScale has the binary point
    using Friction = Fixed<24>;

    // Converts metres to Lengths. The largest length stays below 2^27 units, so that sums of a few cannot wrap. Larger
    // distances are held at 2^30 units, larger displacements in a step at 2^28.
    class LengthScale {
    public:
        static constexpr int room = 27;
        [[nodiscard]] static constexpr LengthScale of(Real largest) {
            LengthScale s;
            const int bits = room - largest.ceil_log2_bound();
            s.bits_ = detail::clamp(bits, 0, N::PositionSum::fraction_bits - 4);
            return s;
        }
        // True if a shape may be that large.
        [[nodiscard]] static constexpr bool fits(Real metres) { return metres <= Real::scaled(1, room); }
        // m, of contacts. Gaps are whole units.
        [[nodiscard]] constexpr Real least_tolerance(Real) const { return Real::scaled(16, -bits_); }
        [[nodiscard]] constexpr int bits() const { return bits_; }
        [[nodiscard]] constexpr Length length(Real metres) const {
            return {static_cast<std::int32_t>(metres.to_fixed(bits_, 31))};
        }
        // Rounds to nearest, ties upwards.
        template <int F>
        [[nodiscard]] constexpr Length length(Wide<F> metres) const {
            return cut(((metres.raw >> (F - bits_ - 1)) + 1) >> 1);
        }
        // a - b, which may be larger than a sum holds.
        template <int F>
        [[nodiscard]] constexpr Length between(Wide<F> a, Wide<F> b) const {
            Wide<F> difference;
            if (__builtin_sub_overflow(a.raw, b.raw, &difference.raw))
                difference.raw =
                    a.raw < 0 ? std::numeric_limits<std::int64_t>::min() : std::numeric_limits<std::int64_t>::max();
            return length(difference);
        }
        [[nodiscard]] constexpr Length length(Work metres) const { return cut(metres.to_sum(bits_)); }
        [[nodiscard]] constexpr Work metres(Length l) const { return Work::of(l.raw, -bits_); }
        // The power of two, in m, above the largest component.
        [[nodiscard]] int log2(const Vec3<Length>& lengths) const {
            std::uint32_t any = 0;
            for (int i = 0; i < 3; ++i) any |= static_cast<std::uint32_t>(lengths[i].raw ^ (lengths[i].raw >> 31));
            return static_cast<int>(std::bit_width(any)) - bits_;
        }
        // True of a length that was held at the end of the format.
        [[nodiscard]] static constexpr bool is_cut(Length l) { return l.raw >= far || l.raw <= -far; }
        // The displacement of a drift in a step, rounded down.
        [[nodiscard]] Length drift(typename N::DriftSum d, typename N::Scale s) const {
            const int down = N::PositionSum::fraction_bits + s.drift_shift - bits_;
            return cut(d.raw >> (down > 63 ? 63 : down), fast);
        }
        // The same to nearest, ties away from zero.
        [[nodiscard]] constexpr Length fall(typename N::DriftSum d, typename N::Scale s) const {
            const int down = N::PositionSum::fraction_bits + s.drift_shift - bits_;
            const auto rounded = [&](std::int64_t raw) { return down > 62 ? 0 : ((raw >> (down - 1)) + 1) >> 1; };
            return cut(d.raw < 0 ? -rounded(-d.raw) : rounded(d.raw), fast);
        }
        // The same length in a coarser scale, which a larger body has set.
        [[nodiscard]] constexpr Length coarser(Length l, const LengthScale& finer) const {
            const int down = finer.bits_ - bits_;
            return {l.raw >> (down > 31 ? 31 : down)};
        }

    private:
        static constexpr std::int64_t far = std::int64_t{1} << 30, fast = std::int64_t{1} << 28;
        [[nodiscard]] static constexpr Length cut(std::int64_t raw, std::int64_t most = far) {
            return {static_cast<std::int32_t>(raw > most ? most : raw < -most ? -most : raw)};
        }
        int bits_ = 24;
    };

    // One over a length: a length times it is a lever.
    class PerLength {
    public:
        [[nodiscard]] static constexpr PerLength of(Real length, const LengthScale& scale) {
            const Real inverse = Real{1} / length;
            const int bits = 30 - inverse.ceil_log2();  // of the mantissa's fraction
            return {static_cast<std::int32_t>(inverse.to_fixed(bits, 31)),
                    static_cast<std::int8_t>(detail::clamp(bits + scale.bits() - Lever::fraction_bits, 1, 62))};
        }
        [[nodiscard]] TUMBLE_INLINE constexpr Lever operator()(Length l) const {
            return {detail::scaled_product(l.raw, mantissa_, shift_)};
        }
        constexpr void rescale(const LengthScale& from, const LengthScale& to) {
            shift_ = static_cast<std::int8_t>(detail::clamp(shift_ + to.bits() - from.bits(), 1, 62));
        }

        constexpr PerLength() = default;

    private:
        constexpr PerLength(std::int32_t mantissa, std::int8_t shift) : mantissa_{mantissa}, shift_{shift} {}
        std::int32_t mantissa_ = 0;
        std::int8_t shift_ = 1;
    };

    // The binary point of the weighted velocities of one island.
    class SpeedScale {
    public:
        // Calls visit with the members that a snapshot holds.
        template <class Self, class Visit>
        static void each(Self& self, Visit& visit) {
            visit.within(self.bits_, -0x10000, 0x10000);
        }
        // The scale for speeds whose largest component is below 2^log2, with this number of bodies and masses that
        // differ by a factor of up to 4^spread. The norm of the speeds, which no solution exceeds by much, and the
        // impulses then stay below 2^29 units.
        [[nodiscard]] static SpeedScale of(int log2, int bodies, int spread) {
            const int norm = (static_cast<int>(std::bit_width(static_cast<std::uint32_t>(6 * bodies - 1))) + 1) / 2;
            return SpeedScale{29 - log2 - norm - spread};
        }
        [[nodiscard]] Speed speed(Work w) const { return {static_cast<std::int32_t>(w.to_sum(bits_, 0x3fffffff))}; }
        // Whether impulses that turn a speed below 2^log2 round fit.
        [[nodiscard]] bool fits(int log2) const { return log2 + bits_ <= 27; }
        // Makes the scale coarser where they would not, for a speed of a surface.
        void make_room(Work w) {
            const int over = w.exponent() + bits_ + 4;
            if (w.mantissa() != 0 && over > 0) bits_ -= over;
        }
        // A sum of the state with `fraction_bits` fraction bits, times a weight.
        [[nodiscard]] Speed speed(std::int64_t sum, int fraction_bits, Work weight) const {
            if (sum == 0) return {0};
            const int room = std::countl_zero(static_cast<std::uint64_t>(sum < 0 ? -sum : sum)) - 1;
            const auto top = static_cast<std::int32_t>((sum << room) >> 32);
            return shifted(top, weight.mantissa(), fraction_bits + room - 32 - weight.exponent() - bits_);
        }
        // A length times a weight.
        [[nodiscard]] Speed speed(Length l, Work weight, const LengthScale& scale) const {
            return shifted(l.raw, weight.mantissa(), scale.bits() - weight.exponent() - bits_);
        }
        // A speed times a weight, as a sum of the state. Clears `within` if the sum was held.
        [[nodiscard]] std::int64_t sum(Speed s, int fraction_bits, Work weight, bool& within) const {
            const std::int64_t product = detail::multiply(s.raw, weight.mantissa());
            const int down = bits_ - weight.exponent() - fraction_bits;
            if (down > 0) return down > 62 ? 0 : (product + (std::int64_t{1} << (down - 1))) >> down;
            constexpr std::int64_t most = (std::int64_t{1} << 62) - 1;
            const int room = std::countl_zero(static_cast<std::uint64_t>(product < 0 ? -product : product)) - 2;
            if (product == 0) return 0;
            if (-down <= room) [[likely]]
                return product * (std::int64_t{1} << -down);
            within = false;
            return product < 0 ? -most : most;
        }
        [[nodiscard]] Work work(Speed s) const { return Work::of(s.raw, -bits_); }
        // A speed in another scale, converted to this one.
        [[nodiscard]] Speed from(Speed s, SpeedScale other) const {
            const int up = bits_ - other.bits_;
            if (up <= 0) return {up < -31 ? 0 : s.raw >> -up};
            // A guess from another step that is too large for this scale is dropped.
            if (up > 29 || ((s.raw ^ (s.raw >> 31)) >> (29 - up)) != 0) return {0};
            return {s.raw << up};
        }
        // Changes of speed below which sweeps stop. At rest it is 2^-21 of the norm (more if the norm leaves room for
        // unequal masses), because the sweeps of the next step continue from there. In an impact, which is solved once,
        // it is rounding: each of four points rounds six components by up to a half, of which a row of unit length sees
        // at most 1.3, and a half is that of its own velocity.
        [[nodiscard]] static constexpr Speed enough_at_rest() { return {256}; }
        [[nodiscard]] static constexpr Speed enough_in_impact() { return {6}; }
        [[nodiscard]] static constexpr Speed rounding() { return {2}; }
        // What a solution leaves at a point of an impact: for each of four points of a pair the change at which sweeps
        // stop, and six roundings.
        [[nodiscard]] static constexpr Speed noise() { return {48}; }

        constexpr SpeedScale() = default;
        friend constexpr bool operator==(SpeedScale, SpeedScale) = default;

    private:
        constexpr explicit SpeedScale(int bits) : bits_{bits > 120 ? 120 : bits} {}
        [[nodiscard]] static Speed shifted(std::int32_t a, std::int32_t b, int down) {
            if (down > 62) return {0};
            const std::int32_t product = detail::scaled_product(a, b, down < 1 ? 1 : down);
            constexpr std::int32_t most = 0x3fffffff;
            return {product > most ? most : product < -most ? -most : product};
        }
        int bits_ = 0;
    };
    // The size of a sum of the state times a weight, for SpeedScale::of: the power of two above it.
    [[nodiscard]] static int size(std::int64_t sum, int fraction_bits, Work weight) {
        if (sum == 0) return nothing();
        return 64 - std::countl_zero(static_cast<std::uint64_t>(sum < 0 ? -sum : sum)) - fraction_bits + 31 +
               weight.exponent();
    }
    // The same for a length times a weight.
    [[nodiscard]] static int size(Length l, const LengthScale& scale, Work weight) {
        return size(std::int64_t{l.raw}, scale.bits(), weight);
    }
    [[nodiscard]] static constexpr int nothing() { return -1000; }
    [[nodiscard]] static int log2(Work w) { return w.exponent(); }
    [[nodiscard]] static int drift_bits(typename N::Scale s) { return N::PositionSum::fraction_bits + s.drift_shift; }
    [[nodiscard]] static int turn_bits(typename N::Scale s) { return 64 + s.turn_shift; }
    template <int F>
    [[nodiscard]] static std::int64_t raw(Wide<F> sum) {
        return sum.raw;
    }
    template <class Sum>
    [[nodiscard]] static Sum as(std::int64_t raw) {
        return {raw};
    }

    // travel(): an upper bound of the displacement in k steps. Below: true if it exceeds a gap, or the rest of a
    // distance.
    [[nodiscard]] static std::int64_t travel(Length speed, Length fall, int k) {
        return (static_cast<std::int64_t>(speed.raw) + static_cast<std::int64_t>(fall.raw) * k) * k;
    }
    [[nodiscard]] static bool exceeds(std::int64_t travel, Length gap) { return travel >= gap.raw; }
    [[nodiscard]] static bool reaches(std::int64_t travel, Length touch, Wide<48> distance2) {
        const std::int64_t sum = travel + touch.raw;
        return sum >= std::int64_t{1} << 30 || sum * sum >= distance2.raw;
    }
    [[nodiscard]] static Length rounded_up(Length l) { return {l.raw + 4}; }
    // Of a grid: 2^log2 m, at most longest(); the cell of width 2^log2 m in which a coordinate lies; whether balls
    // meet.
    [[nodiscard]] static Length power_of_two(const LengthScale& scale, int log2) {
        const int bits = detail::clamp(log2 + scale.bits(), 0, 30);
        return {std::int32_t{1} << bits};
    }
    [[nodiscard]] static std::int32_t cell(typename N::PositionSum x, int log2) {
        constexpr std::int64_t most = std::int64_t{1} << 30;
        const std::int64_t cell = x.raw >> detail::clamp(N::PositionSum::fraction_bits + log2, 0, 63);
        return static_cast<std::int32_t>(cell > most ? most : cell < -most ? -most : cell);
    }
    [[nodiscard]] static bool meet(Length radius, Length other, Wide<48> distance2) {
        return reaches(radius.raw, other, distance2);
    }

    [[nodiscard]] static constexpr Unit one() { return {1 << 30}; }
    [[nodiscard]] static constexpr Length longest() { return {1 << 30}; }
    [[nodiscard]] TUMBLE_INLINE static bool has_direction(const Vec3<Length>& v) {
        const auto square = dot(v, v);
        return square > decltype(square){};
    }
    // v / |v|, and below |v|. v must not be zero.
    [[nodiscard]] static constexpr StoredVec3<Unit> direction(const StoredVec3<Length>& v) {
        const auto root = detail::inverse_root(static_cast<std::uint64_t>(dot(v, v).raw));
        const int shift = -(root.exponent + 30);
        return {Unit{detail::scaled_product(v.x().raw, root.raw, shift)},
                Unit{detail::scaled_product(v.y().raw, root.raw, shift)},
                Unit{detail::scaled_product(v.z().raw, root.raw, shift)}};
    }
    [[nodiscard]] static constexpr StoredVec3<Unit> direction(const StoredVec3<Unit>& v) {
        return direction(StoredVec3<Length>{Length{v.x().raw}, Length{v.y().raw}, Length{v.z().raw}});
    }
    // 1 / sqrt(1 + q . q) of levers, at most 1. Below: a lever times that.
    [[nodiscard]] TUMBLE_INLINE static Unit inverse_root_of_one_and(Wide<48> squares) {
        const auto root = detail::inverse_root(static_cast<std::uint64_t>(squares.raw) + (std::uint64_t{1} << 48));
        return {detail::scaled_product(root.raw, 1 << 30, -(root.exponent + 24))};
    }
    [[nodiscard]] static Unit inverse_root_of_one_and(Wide<60> square) {
        return inverse_root_of_one_and(Wide<48>{square.raw >> 12});
    }
    // 1 / sqrt(q . q) of levers that are at least 1 together.
    [[nodiscard]] static Unit inverse_root_of(Wide<48> squares) {
        const std::int64_t beyond = squares.raw - (std::int64_t{1} << 48);
        return inverse_root_of_one_and(Wide<48>{beyond > 0 ? beyond : 0});
    }
    [[nodiscard]] TUMBLE_INLINE static Unit unit(Lever q, Unit factor) {
        return narrow<Unit>(Wide<60>{detail::multiply(q.raw, factor.raw) * 64});
    }
    [[nodiscard]] TUMBLE_INLINE static Unit product(Unit a, Unit b) { return narrow<Unit>(mul(a, b)); }
    [[nodiscard]] TUMBLE_INLINE static Speed speed(Wide<60> sum) { return narrow<Speed>(sum); }
    // A sum of levers times speeds, held at the largest norm of a SpeedScale: levers of a body with its mass near its
    // axis are long.
    [[nodiscard]] static Speed speed(Wide<54> sum) {
        constexpr std::int64_t most = std::int64_t{1} << (29 + Lever::fraction_bits);
        return narrow<Speed>(Wide<54>{sum.raw > most ? most : sum.raw < -most ? -most : sum.raw});
    }
    template <class T>
    [[nodiscard]] TUMBLE_INLINE static T half(T a) {
        return {a.raw >> 1};
    }
    template <class T>
    [[nodiscard]] TUMBLE_INLINE static T eighth(T a) {
        return {a.raw >> 3};
    }
    // mu * s: the largest friction impulse for a normal impulse s.
    [[nodiscard]] static Speed times_friction(Friction mu, Speed s) {
        return {detail::scaled_product(mu.raw, s.raw, 24)};
    }
    [[nodiscard]] static Work work(Friction mu) { return Work::of(mu); }
    [[nodiscard]] static Friction friction(Work mu) { return mu.template to_fixed<Friction>(); }
    // Alike for both signs.
    [[nodiscard]] static Lever lever(Unit u) { return {u.raw / (1 << (Unit::fraction_bits - Lever::fraction_bits))}; }
    // 1 / sqrt(u), for u from 2^-13 on.
    [[nodiscard]] static Lever inverse_root(Unit u) {
        const auto root = detail::inverse_root(static_cast<std::uint64_t>(u.raw) << Unit::fraction_bits);
        return {detail::scaled_product(root.raw, 1 << 30, -(root.exponent + Lever::fraction_bits))};
    }
    // The power of two that makes a length above zero a number from 1/8 up to 1/4. Below: a length times such a power,
    // alike for both signs.
    [[nodiscard]] static int to_quarter(Length largest) {
        return std::countl_zero(static_cast<std::uint32_t>(largest.raw)) - 4;
    }
    [[nodiscard]] static Unit times_power(Length l, int log2) {
        return {log2 < 0 ? l.raw / (1 << -log2) : l.raw * (1 << log2)};
    }
    [[nodiscard]] static Unit unit(Work w) { return w.template to_fixed<Unit>(); }
    // limit / sqrt(squares), less than one.
    [[nodiscard]] static Unit share(Speed limit, Wide<60> squares) {
        const auto root = detail::inverse_root(static_cast<std::uint64_t>(squares.raw));
        return {detail::scaled_product(limit.raw, root.raw, -(root.exponent + 30))};
    }
    // Whether an impulse stays below what SpeedScale::of() leaves room for. A normal's may be twice as large in an
    // impact.
    [[nodiscard]] TUMBLE_INLINE static bool fits(Speed impulse) {
        return magnitude_of(impulse) < Speed{std::int32_t{1} << 29};
    }
    // s / u^2 for 0 < u <= 1. s is a product with a factor below u^2, so the result fits.
    template <class T>
    [[nodiscard]] static T over_square(T s, Unit u) {
        const auto root = detail::inverse_root(static_cast<std::uint64_t>(mul(u, u).raw));
        const int shift = -(root.exponent + 30);
        return {detail::scaled_product(detail::scaled_product(s.raw, root.raw, shift), root.raw, shift)};
    }
    // a / b in [0, 1] for 0 <= a <= b, b > 0.
    template <class T>
    [[nodiscard]] static Unit ratio(T a, T b) {
        return {static_cast<std::int32_t>((static_cast<std::int64_t>(a.raw) << 30) / b.raw)};
    }
    // The same of sums of squares, rounded down.
    [[nodiscard]] static Unit ratio_of_squares(Wide<60> a, Wide<60> b) {
        const int up = std::countl_zero(static_cast<std::uint64_t>(b.raw)) - 1, down = up < 30 ? 30 - up : 0;
        return {static_cast<std::int32_t>((a.raw << (30 - down)) / ((b.raw >> down) + 1))};
    }
    // rad: the square of a smaller turn is rounding beside a length, which has 27 bits.
    [[nodiscard]] static Work least_turn() {
        static constexpr Work turn = Work::of(1, -14);
        return turn;
    }
    // Axes with a larger cosine (an angle below 2^-10 rad) count as parallel.
    [[nodiscard]] static constexpr Unit nearly_parallel() { return {(1 << 30) - (1 << 9)}; }
    // l / sqrt(1 - c^2), for a c that is not nearly parallel.
    [[nodiscard]] static Length over_sine(Length l, Unit c) {
        const auto root = detail::inverse_root(static_cast<std::uint64_t>((std::int64_t{1} << 60) - mul(c, c).raw));
        return {detail::scaled_product(l.raw, root.raw, -(root.exponent + 30))};
    }
    // hair(): l / 2^16, which is only rounding beside l. Below: l / 16.
    [[nodiscard]] static Length hair(Length l) { return {(l.raw >> 16) + 1}; }
    [[nodiscard]] static Length sixteenth(Length l) { return {l.raw >> 4}; }
    // The norm of some components of a unit vector.
    [[nodiscard]] static Unit unit_norm(const Vec3<Unit>& v) {
        return {static_cast<std::int32_t>(integer_sqrt(static_cast<std::uint64_t>(dot(v, v).raw)))};
    }
    // A norm of such components that is only rounding, 2^-16.
    [[nodiscard]] static constexpr Unit flat() { return {1 << 14}; }
};

}  // namespace tumble

// Numbers of moments: of speeds times lengths, of levers as parts of a length, and of quotients of these. They are to
// ContactNumbers what a lever arm is to a force.
#pragma once

#include <tumble/numbers/systems.hpp>

namespace tumble {

// A Moment is a Speed times a Length. An Extent is a length that others are a part of.
template <class N>
struct MomentNumbers;

template <class N>
requires(N::fixed_point) struct MomentNumbers<N> {
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;
    using Length = typename C::Length;
    using Lever = typename C::Lever;
    using Speed = typename C::Speed;
    using Moment = Wide<Length::fraction_bits + Speed::fraction_bits>;
    using Square = Wide<2 * Unit::fraction_bits>;

    // The power of two above a length.
    class Extent {
    public:
        [[nodiscard]] static Extent above(Length l) {
            Extent e;
            e.bits_ = static_cast<int>(std::bit_width(static_cast<std::uint32_t>(l.raw)));
            if (e.bits_ > Unit::fraction_bits) e.bits_ = Unit::fraction_bits;
            return e;
        }
        // A length that is shorter.
        [[nodiscard]] Lever part(Length l) const {
            const int up = Lever::fraction_bits - bits_;
            return {up >= 0 ? l.raw << up : l.raw >> -up};
        }
        // A moment over the extent.
        [[nodiscard]] Speed speed(Moment m) const {
            return clamped((m.raw + ((std::int64_t{1} << bits_) >> 1)) >> bits_);
        }
        [[nodiscard]] Length length() const { return {std::int32_t{1} << bits_}; }

    private:
        int bits_ = 0;
    };
    // One over a number.
    class Inverse {
    public:
        // s > 0
        explicit Inverse(Square s) {
            const int up = std::countl_zero(static_cast<std::uint64_t>(s.raw)) - 1;
            const auto top = static_cast<std::uint32_t>((s.raw << up) >> 32);  // in [2^30, 2^31)
            mantissa_ = static_cast<std::int32_t>(((std::uint64_t{1} << 61) - 1) / top);
            up_ = up;
        }
        // A quarter of a over the number.
        [[nodiscard]] Lever quarter(Square a) const {
            if (a.raw == 0) return {0};
            const int up = std::countl_zero(static_cast<std::uint64_t>(a.raw < 0 ? -a.raw : a.raw)) - 1;
            const int down = 63 - Lever::fraction_bits + up - up_;  // 61 of the mantissa, 2 of a quarter
            if (down < 1) return {a.raw < 0 ? -0x7fffffff : 0x7fffffff};
            if (down > 62) return {0};
            return {detail::scaled_product(static_cast<std::int32_t>((a.raw << up) >> 32), mantissa_, down)};
        }

    private:
        std::int32_t mantissa_;  // 2^61 over the leading 31 bits
        int up_;                 // bits before them
    };
    [[nodiscard]] static bool fits(Lever l) { return magnitude_of(l) < Lever{std::int32_t{1} << 30}; }
    [[nodiscard]] static bool is_apart(Length distance, Length) { return distance > Length{}; }
    [[nodiscard]] static Square square(Lever a, Lever b) { return {detail::multiply(a.raw, b.raw) * (1 << 12)}; }
    // A quarter of a sum of squares.
    [[nodiscard]] static Unit quarter(Square s) { return {static_cast<std::int32_t>(s.raw >> 32)}; }
    // A part of a square that is only rounding.
    [[nodiscard]] static Square hair(Square s) { return {s.raw >> 14}; }
    // Of at most `most` numbers.
    template <int most, class T>
    [[nodiscard]] static T mean(T sum, int count) {
        return {share<most>(sum.raw, count)};
    }
    [[nodiscard]] static Speed speed(Moment m) {
        return clamped((m.raw + (1 << (Length::fraction_bits - 1))) >> Length::fraction_bits);
    }
    // a / b for b > 0.
    [[nodiscard]] static Lever ratio(Speed a, Speed b) {
        return Lever{clamped((static_cast<std::int64_t>(a.raw) * (1 << Lever::fraction_bits)) / b.raw).raw};
    }
    // s a / b
    [[nodiscard]] static Speed times_ratio(Speed s, Lever a, Lever b) {
        const std::int64_t quotient = detail::multiply(s.raw, a.raw) / b.raw;
        constexpr std::int64_t most = std::int64_t{1} << 29;
        return {static_cast<std::int32_t>(quotient > most ? most : quotient < -most ? -most : quotient)};
    }
    // Of a lever below 1.
    [[nodiscard]] static Unit unit(Lever l) { return {l.raw * (1 << (Unit::fraction_bits - Lever::fraction_bits))}; }
    // Divides speeds by u > 0.
    class Over {
    public:
        Over() = default;
        explicit Over(Unit u) : root_{detail::inverse_root(static_cast<std::uint64_t>(mul(u, u).raw))} {}
        [[nodiscard]] Speed operator()(Speed s) const {
            const int down = -(root_.exponent + Unit::fraction_bits);
            return {detail::scaled_product(s.raw, root_.raw, down < 0 ? 0 : down)};
        }

    private:
        detail::ScaledRoot root_{};
    };
    // s / u for u > 0.
    [[nodiscard]] static Speed over(Speed s, Unit u) { return Over{u}(s); }
    // The same, for a u that is often that of the call before.
    class OverRecent {
    public:
        [[nodiscard]] Speed operator()(Speed s, Unit u) {
            if (!(u == of_)) {
                of_ = u;
                over_ = Over{u};
            }
            return over_(s);
        }

    private:
        Unit of_{};
        Over over_{};
    };

private:
    // sum / count. Up to four need no division, which some cores do not have; 3 * 0x55555556 = 2^32 + 2.
    template <int most>
    [[nodiscard]] static std::int32_t share(std::int32_t sum, int count) {
        if constexpr (most > 4) {
            return sum / count;
        } else {
            const std::int32_t round = sum < 0 ? 1 : 0;
            if (count == 3) return static_cast<std::int32_t>(detail::multiply(sum, 0x55555556) >> 32) + round;
            return (sum + round * (count - 1)) >> (count >> 1);
        }
    }
    // Clamped at the largest Speed.
    [[nodiscard]] static Speed clamped(std::int64_t raw) {
        constexpr std::int64_t most = std::int64_t{1} << 30;
        return {static_cast<std::int32_t>(raw > most ? most : raw < -most ? -most : raw)};
    }
};

template <class N>
requires(!N::fixed_point) struct MomentNumbers<N> {
    using T = typename N::Work;
    using Moment = T;
    using Square = T;

    class Extent {
    public:
        [[nodiscard]] static Extent above(T l) { return Extent{l}; }
        [[nodiscard]] T part(T l) const { return l * inverse_; }
        [[nodiscard]] T speed(T m) const { return m * inverse_; }
        [[nodiscard]] T length() const { return length_; }
        Extent() = default;

    private:
        explicit Extent(T l) : length_{l}, inverse_{T(1) / l} {}
        T length_ = 1, inverse_ = 1;
    };
    class Inverse {
    public:
        explicit Inverse(T s) : inverse_{T(1) / s} {}
        [[nodiscard]] T quarter(T a) const { return a * inverse_ * T(0.25); }

    private:
        T inverse_;
    };
    // Of a share for a moment: a larger one comes of places that are only rounding. False of NaN.
    [[nodiscard]] static bool fits(T l) { return magnitude_of(l) < (sizeof(T) == 4 ? T(0x1p24) : T(0x1p53)); }
    // Whether a distance from the origin is more than rounding of the body's radius.
    [[nodiscard]] static bool is_apart(T distance, T radius) { return distance > radius * T(0x1p-60); }
    [[nodiscard]] static T square(T a, T b) { return a * b; }
    [[nodiscard]] static T quarter(T s) { return s * T(0.25); }
    [[nodiscard]] static T hair(T s) { return s * T(0x1p-14); }
    template <int most>
    [[nodiscard]] static T mean(T sum, int count) {
        return sum / T(count);
    }
    [[nodiscard]] static T speed(T m) { return m; }
    [[nodiscard]] static T ratio(T a, T b) { return a / b; }
    [[nodiscard]] static T times_ratio(T s, T a, T b) { return s * a / b; }
    [[nodiscard]] static T unit(T l) { return l; }
    class Over {
    public:
        explicit Over(T u) : divisor_{u} {}
        [[nodiscard]] T operator()(T s) const { return s / divisor_; }

    private:
        T divisor_;
    };
    [[nodiscard]] static T over(T s, T u) { return s / u; }
    class OverRecent {
    public:
        [[nodiscard]] T operator()(T s, T u) { return s / u; }
    };
};

}  // namespace tumble

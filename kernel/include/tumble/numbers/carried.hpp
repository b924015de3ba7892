// Carried: integrated state that keeps its rounding residual, so that rounding errors do not accumulate.
// In fixed point it is a 64-bit sum, whose upper word is the value. In floating point it is a compensated (Kahan) pair.
// Without carry it is the bare value, rounded at every addition.
#pragma once

#include <tumble/numbers/fixed.hpp>

namespace tumble {

template <class T, bool carry, bool biased = false>
class Carried;

// A biased number stores its sum plus half a unit. Its upper word is then the value rounded to nearest at no cost: for
// state that every step reads as a value. An unbiased number gives its sum at no cost.
template <int F, bool biased>
class Carried<Fixed<F>, true, biased> {
public:
    using Value = Fixed<F>;
    static constexpr int fraction_bits = F + 32;  // of the 64-bit sum

    constexpr Carried() = default;
    [[nodiscard]] static constexpr Carried from(Real value) { return from_sum({value.to_fixed(F + 32, 64)}); }
    [[nodiscard]] static constexpr Carried from_sum(Wide<F + 32> s) {
        Carried c;
        c.stored_ = (s + Wide<F + 32>{bias}).raw;
        return c;
    }

    [[nodiscard]] TUMBLE_INLINE constexpr Value value() const {
        return {static_cast<std::int32_t>((Wide<F + 32>{stored_} + Wide<F + 32>{half - bias}).raw >> 32)};
    }
    // Value and residual as one number with F + 32 fraction bits.
    [[nodiscard]] TUMBLE_INLINE constexpr Wide<F + 32> sum() const {
        return Wide<F + 32>{stored_} - Wide<F + 32>{bias};
    }
    TUMBLE_INLINE constexpr void add(Wide<F + 32> increment) { stored_ = (Wide<F + 32>{stored_} + increment).raw; }
    // Adds a * b, and then what `more` adds to the sum: products accumulate in the state itself.
    template <class A, class B, class More>
    TUMBLE_INLINE constexpr void accumulate(A a, B b, More&& more) {
        stored_ = more(mul_add(Wide<F + 32>{stored_}, a, b)).raw;
    }
    [[nodiscard]] constexpr Real to_real() const { return Real::scaled(sum().raw, -(F + 32)); }
    friend constexpr bool operator==(Carried, Carried) = default;

private:
    static constexpr std::int64_t half = std::int64_t{1} << 31;
    static constexpr std::int64_t bias = biased ? half : 0;
    std::int64_t stored_ = bias;
};

template <int F, bool biased>
class Carried<Fixed<F>, false, biased> {
public:
    using Value = Fixed<F>;
    static constexpr int fraction_bits = F;

    constexpr Carried() = default;
    [[nodiscard]] static constexpr Carried from(Real value) { return Carried{Value::from(value)}; }
    [[nodiscard]] TUMBLE_INLINE constexpr Value value() const { return value_; }
    [[nodiscard]] TUMBLE_INLINE constexpr Wide<F + 32> sum() const {
        return {static_cast<std::int64_t>(value_.raw) * (std::int64_t{1} << 32)};
    }
    [[nodiscard]] static constexpr Carried from_sum(Wide<F + 32> s) { return Carried{narrow<Value>(s)}; }
    TUMBLE_INLINE constexpr void add(Wide<F + 32> increment) { value_ += narrow<Value>(increment); }
    template <class A, class B, class More>
    TUMBLE_INLINE constexpr void accumulate(A a, B b, More&& more) {
        add(more(mul(a, b)));
    }
    [[nodiscard]] constexpr Real to_real() const { return Real::scaled(value_.raw, -F); }
    friend constexpr bool operator==(Carried, Carried) = default;

private:
    constexpr explicit Carried(Value v) : value_{v} {}
    Value value_{};
};

// Shared by the floating-point specialisations. T is float or double.
template <class T>
[[nodiscard]] constexpr T from_real(Real value);
template <>
[[nodiscard]] constexpr float from_real<float>(Real value) {
    return value.to_float();
}
template <>
[[nodiscard]] constexpr double from_real<double>(Real value) {
    return value.to_double();
}

// Exact for every finite value.
[[nodiscard]] constexpr Real to_real(double value) { return Real{value}; }
[[nodiscard]] constexpr Real to_real(float value) { return Real{value}; }

template <class T, bool biased>
class Carried<T, true, biased> {
public:
    using Value = T;

    constexpr Carried() = default;
    [[nodiscard]] static constexpr Carried from(Real value) {
        Carried c;
        c.value_ = from_real<T>(value);
        // A value beyond T's range is infinite and has no residual.
        if (c.value_ - c.value_ == T(0)) c.residual_ = from_real<T>(value - tumble::to_real(c.value_));
        return c;
    }
    [[nodiscard]] TUMBLE_INLINE constexpr T value() const { return value_; }
    [[nodiscard]] TUMBLE_INLINE constexpr T residual() const { return residual_; }
    // Kahan's sum: exact to about twice T's precision while increments are smaller than the value.
    TUMBLE_INLINE constexpr void add(T increment) {
        const T y = increment + residual_;
        const T t = value_ + y;
        residual_ = y - (t - value_);
        value_ = t;
    }
    template <class More>
    TUMBLE_INLINE constexpr void accumulate(T a, T b, More&& more) {
        add(more(a * b));
    }
    [[nodiscard]] constexpr Real to_real() const { return tumble::to_real(value_) + tumble::to_real(residual_); }
    friend constexpr bool operator==(Carried, Carried) = default;

private:
    T value_ = 0;
    T residual_ = 0;
};

template <class T, bool biased>
class Carried<T, false, biased> {
public:
    using Value = T;

    constexpr Carried() = default;
    [[nodiscard]] static constexpr Carried from(Real value) {
        Carried c;
        c.value_ = from_real<T>(value);
        return c;
    }
    [[nodiscard]] TUMBLE_INLINE constexpr T value() const { return value_; }
    [[nodiscard]] TUMBLE_INLINE constexpr T residual() const { return 0; }
    TUMBLE_INLINE constexpr void add(T increment) { value_ += increment; }
    template <class More>
    TUMBLE_INLINE constexpr void accumulate(T a, T b, More&& more) {
        add(more(a * b));
    }
    [[nodiscard]] constexpr Real to_real() const { return tumble::to_real(value_); }
    friend constexpr bool operator==(Carried, Carried) = default;

private:
    T value_ = 0;
};

// Carried, for a quantity whose rounded value drives its own rate of change. Each step adds the rounding error of the
// value that the step before it used (first-order noise shaping). The mean of the used values is then exact, and the
// rounding noise does not random-walk: 3 to 20 times less error on a top that tumbles near its unstable axis.
template <class T, bool carry>
class Shaped : public Carried<T, carry> {
public:
    using Base = Carried<T, carry>;
    constexpr Shaped() = default;
    [[nodiscard]] static constexpr Shaped from(Real value) { return Shaped{Base::from(value)}; }
    [[nodiscard]] static constexpr Shaped from_sum(auto sum) { return Shaped{Base::from_sum(sum)}; }
    // The value to use in this step. Its rounding error goes into the next step's value.
    [[nodiscard]] TUMBLE_INLINE constexpr T take() { return this->value(); }
    friend constexpr bool operator==(Shaped, Shaped) = default;

protected:
    constexpr explicit Shaped(Base base) : Base{base} {}
};

// Kept as 32-bit words: three of them make a spin of 36 bytes; a 64-bit member would make it 48.
template <int F>
class Shaped<Fixed<F>, true> {
public:
    using Value = Fixed<F>;
    static constexpr int fraction_bits = F + 32;

    constexpr Shaped() = default;
    [[nodiscard]] static constexpr Shaped from(Real value) { return from_sum({value.to_fixed(F + 32, 64)}); }
    [[nodiscard]] static constexpr Shaped from_sum(Wide<F + 32> sum) {
        Shaped s;
        s.set(sum);
        return s;
    }
    [[nodiscard]] TUMBLE_INLINE constexpr Wide<F + 32> sum() const {
        return {
            static_cast<std::int64_t>((static_cast<std::uint64_t>(static_cast<std::uint32_t>(upper_)) << 32) | lower_)};
    }
    [[nodiscard]] TUMBLE_INLINE constexpr Value value() const { return narrow<Value>(sum()); }
    TUMBLE_INLINE constexpr void add(Wide<F + 32> increment) { set(sum() + increment); }
    [[nodiscard]] TUMBLE_INLINE constexpr Value take() {
        const Wide<F + 32> wanted = sum() + Wide<F + 32>{static_cast<std::int64_t>(left_out_)};
        left_out_ = static_cast<std::uint32_t>(wanted.raw);
        return {static_cast<std::int32_t>(wanted.raw >> 32)};
    }
    [[nodiscard]] constexpr std::uint32_t left_out() const { return left_out_; }
    [[nodiscard]] constexpr Real to_real() const { return Real::scaled(sum().raw, -fraction_bits); }
    friend constexpr bool operator==(Shaped, Shaped) = default;

private:
    TUMBLE_INLINE constexpr void set(Wide<F + 32> sum) {
        lower_ = static_cast<std::uint32_t>(sum.raw);
        upper_ = static_cast<std::int32_t>(sum.raw >> 32);
    }
    std::uint32_t lower_ = 0;
    std::int32_t upper_ = 0;
    std::uint32_t left_out_ = std::uint32_t{1} << 31;  // in 2^-32 of a unit
};

}  // namespace tumble

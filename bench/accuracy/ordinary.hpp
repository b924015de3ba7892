// Any system of ordinary equations y' = f(y), stepped by the kernel's own Butcher tables in float, double or fixed
// point.
//
// The kernel's stepping function (integrators/runge_kutta.hpp) is for rigid bodies: its stages are delta quaternions
// and drifts, and its state is a BodyState. This one shares the tables, the sums weighted at compile time and the
// carried numbers; its loop over stages is its own, a dozen lines.
#pragma once

#include <tumble/integrators/butcher.hpp>
#include <tumble/numbers/carried.hpp>

#include <array>
#include <cmath>

namespace tumble::bench {

// The arithmetic of an equation: it reads Values and sums products in a Product; a step of 2^-n s adds an Increment to
// the state.
template <class T, bool with_carry>
struct FloatArithmetic {
    static constexpr const char* name = sizeof(T) == 4 ? "f32" : "f64";
    static constexpr bool carry = with_carry;
    using Value = T;
    using Product = T;
    using Increment = T;
    using State = Carried<T, carry>;

    [[nodiscard]] static Value value(double x) { return static_cast<T>(x); }
    [[nodiscard]] static Product mul(Value a, Value b) { return a * b; }
    [[nodiscard]] static Increment over_step(Product rate, int n) { return std::ldexp(rate, -n); }
    [[nodiscard]] static Value at(const State& y, Increment change) { return y.value() + change; }
    [[nodiscard]] static bool holds(Value a) { return std::isfinite(a); }
};
// Values with F fraction bits in 32. |value| < 2^(31 - F), and a step's increments times the denominator of the table
// have the same limit.
template <int F, bool with_carry>
struct FixedArithmetic {
    static constexpr const char* name = "q32";
    static constexpr bool carry = with_carry;
    using Value = Fixed<F>;
    using Product = Wide<2 * F>;
    using Increment = Wide<F + 32>;
    using State = Carried<Value, carry>;

    [[nodiscard]] static Value value(double x) { return Value::from(Real{x}); }
    [[nodiscard]] static Product mul(Value a, Value b) { return tumble::mul(a, b); }
    [[nodiscard]] static Increment over_step(Product rate, int n) {
        const int left = 32 - F - n;
        return {left >= 0 ? static_cast<std::int64_t>(static_cast<std::uint64_t>(rate.raw) << left)
                          : (rate.raw + (std::int64_t{1} << (-left - 1))) >> -left};
    }
    [[nodiscard]] static Value at(const State& y, Increment change) { return narrow<Value>(y.sum() + change); }
    // Half of the range is kept free for the increment of a stage.
    [[nodiscard]] static bool holds(Value a) {
        const std::int32_t raw = a.raw;
        return raw < (1 << 30) && raw > -(1 << 30);
    }
};

// One step of 2^-n s. `rates(values, products)` is f.
template <const auto& table, class A, std::size_t size, class F>
void ordinary_step(std::array<typename A::State, size>& y, const F& rates, int n) {
    using Increments = std::array<typename A::Increment, size>;
    std::array<Increments, table.stages> k;
    tumble::detail::unroll<table.stages>([&](auto stage) {
        constexpr int s = stage;
        Increments before{};
        tumble::detail::unroll<s>([&](auto earlier) {
            constexpr int j = earlier;
            constexpr Rational a = table.a[s][j];
            if constexpr (!a.is_zero())
                for (std::size_t i = 0; i < size; ++i)
                    before[i] += tumble::detail::times<a>(k[static_cast<std::size_t>(j)][i]);
        });
        std::array<typename A::Value, size> values;
        std::array<typename A::Product, size> products;
        for (std::size_t i = 0; i < size; ++i) values[i] = A::at(y[i], before[i]);
        rates(values, products);
        for (std::size_t i = 0; i < size; ++i) k[static_cast<std::size_t>(s)][i] = A::over_step(products[i], n);
    });
    for (std::size_t i = 0; i < size; ++i) {
        typename A::Increment sum{};
        tumble::detail::unroll<table.stages>([&](auto stage) {
            constexpr int s = stage;
            constexpr Rational weight{table.weight(s), 1};
            if constexpr (weight.numerator != 0)
                sum += tumble::detail::times<weight>(k[static_cast<std::size_t>(s)][i]);
        });
        constexpr Rational share{1, table.denominator()};
        y[i].add(tumble::detail::times<share>(sum));
    }
}

}  // namespace tumble::bench

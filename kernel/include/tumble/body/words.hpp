// The words of a state, in the order of records and of Hash.
#pragma once

#include <tumble/body/state.hpp>

namespace tumble {

// Calls f(name, number) for each carried number of a body's state, in the order of its words. A point mass has the
// first six numbers only, whether its world has rotation or not.
template <class N, Spin spin, class F>
constexpr void for_each_number(const BodyState<N, spin>& body, F&& f, [[maybe_unused]] bool rotates = true) {
    f("x_w.x", body.x_w.x);
    f("x_w.y", body.x_w.y);
    f("x_w.z", body.x_w.z);
    f("d_w.x", body.d_w.x);
    f("d_w.y", body.d_w.y);
    f("d_w.z", body.d_w.z);
    if constexpr (spin != Spin::none) {
        if (!rotates) return;
        f("q_wb.w", body.q_wb.w);
        f("q_wb.x", body.q_wb.x);
        f("q_wb.y", body.q_wb.y);
        f("q_wb.z", body.q_wb.z);
        f("t_b.x", body.t_b.x);
        f("t_b.y", body.t_b.y);
        f("t_b.z", body.t_b.z);
    }
}

namespace detail {

template <class F>
constexpr void for_each_word_of(float value, F&& f) {
    f(std::bit_cast<std::uint32_t>(value));
}
template <class F>
constexpr void for_each_word_of(std::uint64_t value, F&& f) {
    f(static_cast<std::uint32_t>(value));
    f(static_cast<std::uint32_t>(value >> 32));
}
template <class F>
constexpr void for_each_word_of(double value, F&& f) {
    for_each_word_of(std::bit_cast<std::uint64_t>(value), f);
}

}  // namespace detail

// Calls f(word) for the 32-bit words of a carried number. The lower half of a 64-bit number comes first.
template <class T, bool carry, bool biased, class F>
constexpr void for_each_word(const Carried<T, carry, biased>& number, F&& f) {
    if constexpr (std::floating_point<T>) {
        detail::for_each_word_of(number.value(), f);
        if constexpr (carry) detail::for_each_word_of(number.residual(), f);
    } else if constexpr (carry) {
        detail::for_each_word_of(static_cast<std::uint64_t>(number.sum().raw), f);
    } else {
        f(static_cast<std::uint32_t>(number.value().raw));
    }
}
template <class T, bool carry, class F>
constexpr void for_each_word(const Shaped<T, carry>& number, F&& f) {
    if constexpr (requires { number.left_out(); }) {
        detail::for_each_word_of(static_cast<std::uint64_t>(number.sum().raw), f);
        f(number.left_out());
    } else {
        for_each_word(static_cast<const Carried<T, carry>&>(number), f);
    }
}
template <class N, Spin spin, class F>
constexpr void for_each_word(const BodyState<N, spin>& body, F&& f, bool rotates = true) {
    for_each_number(
        body, [&](const char*, const auto& number) { for_each_word(number, f); }, rotates);
}

// A hash of words: FNV-1a over 32-bit words, widened to 64 bits. Two runs with equal hashes agree in every bit of every
// body, except with a chance of 2^-64. About 10 instructions for a word on a 32-bit core.
class Hash {
public:
    [[gnu::noinline]] constexpr void add(std::uint32_t word) {
        for (int i = 0; i < 2; ++i) {  // 16 bits at a time keep FNV's mixing and halve the number of multiplications
            value_ ^= word & 0xffffu;
            value_ *= 0x100000001b3u;
            word >>= 16;
        }
    }
    template <class N, Spin spin>
    constexpr void add(const BodyState<N, spin>& body, bool rotates = true) {
        for_each_word(
            body, [&](std::uint32_t word) { add(word); }, rotates);
    }

    [[nodiscard]] constexpr std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0xcbf29ce484222325u;
};

}  // namespace tumble

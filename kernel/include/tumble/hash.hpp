// A digest of the state: FNV-1a over its 32-bit words, widened to 64 bits. Two runs agree in every bit of every body
// exactly when their digests agree (but for a chance of 2^-64). About 10 instructions a word on a 32-bit core.
#pragma once

#include <tumble/body/state.hpp>

namespace tumble {

class Hash {
public:
    constexpr void add(std::uint32_t word) {
        for (int i = 0; i < 2; ++i) {  // 16 bits at a time keeps FNV's mixing and halves its multiplications
            value_ ^= word & 0xffffu;
            value_ *= 0x100000001b3u;
            word >>= 16;
        }
    }
    constexpr void add(std::uint64_t word) {
        add(static_cast<std::uint32_t>(word));
        add(static_cast<std::uint32_t>(word >> 32));
    }
    constexpr void add(float value) { add(std::bit_cast<std::uint32_t>(value)); }
    constexpr void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
    template <int F>
    constexpr void add(Fixed<F> value) {
        add(static_cast<std::uint32_t>(value.raw));
    }
    template <class T, bool carry, bool biased>
    constexpr void add(const Carried<T, carry, biased>& number) {
        if constexpr (std::floating_point<T>) {
            add(number.value());
            if constexpr (carry) add(number.residual());
        } else if constexpr (carry) {
            add(static_cast<std::uint64_t>(number.sum().raw));
        } else {
            add(number.value());
        }
    }
    template <class T, bool carry>
    constexpr void add(const Shaped<T, carry>& number) {
        if constexpr (requires { number.left_out(); }) {
            add(static_cast<std::uint64_t>(number.sum().raw));
            add(number.left_out());
        } else {
            add(static_cast<const Carried<T, carry>&>(number));
        }
    }
    template <class N, Spin spin>
    constexpr void add(const BodyState<N, spin>& body) {
        for (int i = 0; i < 3; ++i) add(body.x_w[i]);
        for (int i = 0; i < 3; ++i) add(body.d_w[i]);
        add(body.q_wb.w);
        add(body.q_wb.x);
        add(body.q_wb.y);
        add(body.q_wb.z);
        for (int i = 0; i < 3; ++i) add(body.t_b[i]);
    }

    [[nodiscard]] constexpr std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0xcbf29ce484222325u;
};

}  // namespace tumble

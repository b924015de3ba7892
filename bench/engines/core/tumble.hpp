// This kernel, in the number system of TUMBLE_VARIANT. TUMBLE_COUNT, if it is 1000: however many bodies step exactly.
#pragma once

#include "scene.hpp"

namespace tumble::bench {

class Engine {
    struct Config : Recorded::Config {
        using Numbers = NumbersOf<TUMBLE_VARIANT, typename Recorded::Config::Numbers::Range>;
        using Integrator = integrators::Verlet;
        static constexpr Features features = [] {
            Features all = Recorded::Config::features;
            if (TUMBLE_COUNT == 1000) all.bounded_steps = false;
            return all;
        }();
    };

public:
    static constexpr const char *name = "tumble", *numbers = Config::Numbers::name;
    static constexpr bool carry = Config::Numbers::carry;

    void step() { (void)replay_.step(); }
    [[nodiscard]] std::uint32_t status_bits() const { return replay_.world().status().bits; }
    [[nodiscard]] Vec position(std::size_t i) const {
        const auto at = replay_.world().template pose<float>(BodyId{static_cast<int>(i)}).position;
        return {at[0], at[1], at[2]};
    }
    [[nodiscard]] Turn turn(std::size_t i) const {
        const auto q = replay_.world().template pose<float>(BodyId{static_cast<int>(i)}).orientation;
        return {q.w, q.v[0], q.v[1], q.v[2]};
    }

private:
    Replay<Config, Recorded> replay_;
};

}  // namespace tumble::bench

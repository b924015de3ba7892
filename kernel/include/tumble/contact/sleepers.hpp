// Awake bodies, and the rule of sleep. An island falls asleep as a whole where it rests on something fixed and has been
// slow for long enough. A step does not visit sleeping bodies; they keep their place.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/scene.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class Sleepers {
public:
    using Work = typename N::Work;
    using Bodies = tumble::Bodies<N, spin, features.bodies, features.mixed()>;
    using BodyGroup = tumble::BodyGroup<features.bodies>;

    constexpr Sleepers(Real step, const SleepSpec& spec) {
        if constexpr (features.sleep) {
            rules_.on = spec.on;
            const Real speed = spec.speed * step, spin_speed = spec.angular_speed * step, steps = spec.time / step;
            rules_.speed2 = N::template constant<Work>(speed * speed);
            rules_.spin2 = N::template constant<Work>(spin_speed * spin_speed);
            std::int64_t count = steps.to_fixed(0, 64);
            if (count < 1) count = 1;
            // Long times are counted in units of a power of two steps, rounded up.
            while (count > 0xfffe && rules_.unit < 31) {
                ++rules_.unit;
                count = steps.to_fixed(-rules_.unit, 64) + 2;
            }
            rules_.steps = static_cast<std::uint16_t>(count > 0xfffe ? 0xfffe : count);
        }
    }

    // Adds an awake body.
    constexpr void add(int b) { awake_[awake_count_++] = static_cast<std::int16_t>(b); }
    // Writes or reads what a snapshot holds. Of the bodies that may move those sleep that are not in the list.
    template <class Self, class Archive>
    static void archive(Self& self, const Bodies& bodies, Archive& to) {
        bool asleep[features.bodies]{};
        int moving = 0;
        for (int b = 0; b < bodies.count; ++b) {
            asleep[b] = !bodies.constants[b].fixed();
            moving += asleep[b];
        }
        const int count = to.within(self.awake_count_, features.sleep ? 0 : moving, moving);
        for (int k = 0; k < count; ++k) {
            const int b = to.within(self.awake_[k], 0, features.bodies - 1);
            to.require(asleep[b]);
            asleep[b] = false;
        }
        if constexpr (features.sleep) {
            to(self.quiet_);
            if constexpr (Archive::reads)
                for (int b = 0; b < features.bodies; ++b) self.asleep_[b] = asleep[b];
        }
    }
    // Call when a body that is awake is removed.
    void remove(int b) {
        keep([&](int other) { return other != b; });
        if constexpr (features.sleep) quiet_[b] = 0;
    }
    // Awake bodies, in the order in which they were added or woke.
    [[nodiscard]] TUMBLE_INLINE int awake_count() const { return awake_count_; }
    [[nodiscard]] TUMBLE_INLINE int awake(int k) const {
        if constexpr (features.bodies == 1) return 0;
        else return awake_[k];
    }
    // Resting bodies fall asleep.
    [[nodiscard]] bool is_on() const {
        if constexpr (features.sleep) return rules_.on;
        else return false;
    }
    [[nodiscard]] constexpr bool is_asleep([[maybe_unused]] int b) const {
        if constexpr (features.sleep) return asleep_[b];
        else return false;
    }

    void wake(int b) requires(features.sleep) {
        asleep_[b] = false;
        quiet_[b] = 0;
        add(b);
    }
    // Counts the step of an island that presses on something. True when all its bodies have been slow for long enough.
    [[nodiscard]] bool have_been_slow(const Bodies& bodies, const SomeBodies<features.bodies>& group,
                                      bool presses) requires(features.sleep) {
        if (!rules_.on) return false;
        bool all = presses;
        const bool counts = (bodies.steps_taken & ((std::uint32_t{1} << rules_.unit) - 1)) == 0;
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            if (!presses || !is_slow(bodies, b)) quiet_[b] = 0;
            else if (counts && quiet_[b] < rules_.steps) ++quiet_[b];
            all = all && quiet_[b] >= rules_.steps;
        }
        return all;
    }
    // Stops the bodies.
    void put_to_sleep(Bodies& bodies, const BodyGroup& group) requires(features.sleep) {
        if (group.count == 0) return;
        for (int k = 0; k < group.count; ++k) {
            asleep_[group.id[k]] = true;
            bodies.stop(group.id[k]);
        }
        keep([&](int b) { return !asleep_[b]; });
    }

private:
    // Keeps the awake bodies for which is_kept(b).
    template <class F>
    void keep(F&& is_kept) {
        int kept = 0;
        for (int k = 0; k < awake_count_; ++k)
            if (is_kept(awake_[k])) awake_[kept++] = awake_[k];
        awake_count_ = kept;
    }
    [[nodiscard]] bool is_slow(const Bodies& bodies, int b) const requires(features.sleep) {
        Work speed2(0), spin2(0);
        for (int i = 0; i < 3; ++i) {
            const Work v = bodies.drift(b, i);
            speed2 = mul_add(speed2, v, v);
        }
        if (speed2 > rules_.speed2) return false;
        for (int i = 0; i < 3; ++i) {
            const Work w = bodies.turn(b, i);
            spin2 = mul_add(spin2, w, w);
        }
        return !(spin2 > rules_.spin2);
    }

    struct Rules {
        bool on = false;
        Work speed2{}, spin2{};   // (m a step)^2, (rad a step)^2
        std::uint16_t steps = 0;  // in units of 2^unit
        std::uint8_t unit = 0;
    };
    int awake_count_ = 0;
    std::int16_t awake_[features.bodies]{};
    [[no_unique_address]] If<features.sleep, Rules, 0> rules_{};
    [[no_unique_address]] If<features.sleep, bool[features.bodies], 1> asleep_{};
    [[no_unique_address]] If<features.sleep, std::uint16_t[features.bodies], 2> quiet_{};
};

}  // namespace tumble

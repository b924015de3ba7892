// Until when bodies and pairs surely touch nothing.
#pragma once

#include <tumble/contact/grid.hpp>

namespace tumble {

// Steps are counted modulo 2^32. With a grid, pairs of bodies have no times of their own, unless they are near.
template <class N, Features features>
class ClearTimes {
public:
    // Body b can touch nothing before step `now`.
    [[nodiscard]] TUMBLE_INLINE bool is_clear(int b, std::uint32_t now) const {
        return static_cast<std::int32_t>(clear_until_[b] - now) > 0;
    }
    void set(int b, std::uint32_t until) { clear_until_[b] = until; }
    // Steps from now until a pair is examined again; at most 0 where it is due.
    [[nodiscard]] int steps_left(int slot, std::uint32_t now) const { return steps_left(due_[slot], now); }
    // The same, from the lower 15 bits of the step.
    [[nodiscard]] static int steps_left(std::uint16_t due, std::uint32_t now) {
        return static_cast<std::int16_t>(static_cast<std::uint16_t>((due - now) << 1)) >> 1;
    }
    constexpr void set_due(int slot, std::uint32_t step) {
        due_[slot] = static_cast<std::uint16_t>((due_[slot] & listed) | (step & (listed - 1u)));
    }
    // Whether the pair of a slot is in the list of near pairs.
    [[nodiscard]] bool is_listed(int slot) const { return (due_[slot] & listed) != 0; }
    // Call where a pair comes into the list, and where it goes.
    void list(int a, int b) {
        if (const int slot = slot_of(a, b); slot >= 0) due_[slot] |= listed;
    }
    void unlist(int a, int b) {
        if (const int slot = slot_of(a, b); slot >= 0) due_[slot] &= listed - 1u;
    }
    constexpr void unlist_all() {
        for (auto& due : due_) due &= listed - 1u;
    }
    void unlist_pairs_of(int b) {
        for (int p = 0; p < features.planes; ++p) unlist(b, -1 - p);
        for (int other = 0; features.pairs && other < features.bodies; ++other)
            if (other != b) unlist(b, other);
    }
    // Call where the body's motion changes other than by its flight: ends the bounds of the body and of its pairs.
    constexpr void end(int b, int planes, std::uint32_t now) {
        clear_until_[b] = now;
        for (int p = 0; p < features.planes && p < planes; ++p) set_due(plane_slot(b, p), now);
        if constexpr (features.grid()) {
            ++many.ends[b];
        } else if constexpr (features.pairs) {
            for (int other = 0; other < features.bodies; ++other) {
                if (other == b) continue;
                set_due(body_slot(b, other), now);
                clear_until_[other] = now;
            }
        }
    }
    // The same of all bodies.
    void end_all(std::uint32_t now) {
        for (auto& until : clear_until_) until = now;
        for (auto& due : due_) due = static_cast<std::uint16_t>((due & listed) | (now & (listed - 1u)));
        if constexpr (features.grid()) {
            for (auto& ends : many.ends) ++ends;
            many.near = true;
        }
    }
    [[nodiscard]] static constexpr int plane_slot(int b, int p) { return b * features.planes + p; }
    [[nodiscard]] static constexpr int body_slot(int a, int b) {
        const int high = a < b ? b : a, low = a < b ? a : b;
        return features.bodies * features.planes + high * (high - 1) / 2 + low;
    }
    // Of a body and a plane, -1 - b, or another body; -1 where the pair has none.
    [[nodiscard]] static constexpr int slot_of(int a, int b) {
        if (b < 0) return plane_slot(a, -1 - b);
        return features.grid() ? -1 : body_slot(a, b);
    }

    // Writes or reads what a snapshot holds.
    template <class Self, class Archive>
    static void archive(Self& self, Archive& to) {
        to(self.clear_until_, self.due_);
        if constexpr (features.grid()) {
            to(self.many.ends, self.many.come, self.many.near);
            Grid<N, features.bodies>::archive(self.many.grid, to);
        }
    }

    // With a grid.
    struct Many {
        Grid<N, features.bodies> grid{};
        std::uint16_t ends[features.bodies]{};  // how often the bounds of the body have been ended, modulo 2^16
        bool come = true;   // bodies that are not in the grid: those around them are examined in the next step
        bool near = false;  // all bodies that are near something are examined in the next step
    };
    [[no_unique_address]] If<features.grid(), Many, 0> many{};
    // Whether a load acts in this step on a body that is or was near something. Asked when it is needed.
    class Push {
    public:
        void ask() { answer_ = not_asked; }
        void begin() { answer_ = true; }
        template <class Look>
        [[nodiscard]] bool answer(Look&& look) {
            if (answer_ == not_asked) answer_ = look();
            return answer_ != 0;
        }

    private:
        static constexpr std::int8_t not_asked = -1;
        std::int8_t answer_ = not_asked;
    };

private:
    static constexpr int slots = features.grid() ? features.bodies * features.planes : features.all_pairs();

    static constexpr std::uint16_t listed = 0x8000;

    std::uint32_t clear_until_[features.bodies]{};  // its pairs are examined again in this step
    // Of each pair the lower 15 bits of the step in which it is examined again, and `listed`.
    std::uint16_t due_[slots > 0 ? slots : 1]{};

public:
    [[no_unique_address]] If<features.pairs, Push, 1> push{};  // last, where it takes least room
};

}  // namespace tumble

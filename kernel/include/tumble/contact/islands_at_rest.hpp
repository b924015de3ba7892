// Which islands are at rest under gravity alone. While one is unchanged and its bodies are balanced
// (PairList::are_balanced), it is at rest in the next step too: neither its loads nor its forces are computed, and its
// bodies look for no others.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/scene.hpp>

namespace tumble {

template <Features features>
class IslandsAtRest {
public:
    using BodyGroup = SomeBodies<features.bodies>;

    // Call where something happens that is not the work of a step.
    constexpr void end() {
        all_ = is_known_ = false;
        if constexpr (features.control) gravity_.were_at_rest = false;
    }
    // Call where gravity changes: what was at rest may be held by other forces.
    void gravity_changed() requires(features.control) {
        gravity_.is_other = true;
        gravity_.were_at_rest = gravity_.were_at_rest || all_;
        all_ = false;
    }
    // True from new gravity to the end of the next step of islands.
    [[nodiscard]] TUMBLE_INLINE bool has_other_gravity() const {
        if constexpr (features.control) return gravity_.is_other;
        else return false;
    }
    // True where all islands are at rest and unchanged. With sleep never: their bodies fall asleep.
    [[nodiscard]] bool all() const { return all_; }
    // True where the body was at rest when it last had a pair. Ask whether it has one now.
    [[nodiscard]] TUMBLE_INLINE bool was_at_rest([[maybe_unused]] int b) const {
        if constexpr (each) return all_ || (is_known_ && of_[b]);
        else if constexpr (features.control) return all_ || gravity_.were_at_rest;
        else return all_;
    }
    // True where an island is unchanged since it was at rest. Ask whether it is balanced.
    [[nodiscard]] bool is_unchanged(const BodyGroup& group) const { return !has_other_gravity() && was_at_rest(group); }
    // True where all bodies of an island were at rest. The island of a single body is all there is.
    [[nodiscard]] bool was_at_rest(const BodyGroup& group) const {
        bool all = true;
        for (int k = 0; k < group.count; ++k) all = all && was_at_rest(group.id[k]);
        return all;
    }
    // Call where the body looks for others, in worlds with a grid.
    void look(int b) requires(features.grid()) { of_[b] = false; }
    // True where it has looked since it was at rest, or was not.
    [[nodiscard]] bool has_looked(int b) const requires(features.grid()) { return !of_[b]; }

    // Call for each island that has stepped.
    void set([[maybe_unused]] const BodyGroup& group, [[maybe_unused]] bool at_rest) {
        if constexpr (each)
            for (int k = 0; k < group.count; ++k) of_[group.id[k]] = at_rest;
    }
    // Call when all islands have stepped. `is_known`: every pair of bodies that are near is in an island.
    void end_step(bool all, bool is_known) {
        all_ = all && is_known;
        is_known_ = is_known;
        if constexpr (features.control) gravity_ = {};
    }

    // Writes or reads what a snapshot holds.
    template <class Self, class Archive>
    static void archive(Self& self, Archive& to) {
        to(self.all_, self.is_known_);
        if constexpr (features.control) to(self.gravity_.is_other, self.gravity_.were_at_rest);
        if constexpr (each) to(self.of_);
    }

private:
    static constexpr bool each = features.bodies > 1;
    struct Gravity {
        bool is_other = false;      // than in the last step
        bool were_at_rest = false;  // all islands, under the one before
    };

    bool all_ = false;
    bool is_known_ = false;  // of_ is what it says
    [[no_unique_address]] If<features.control, Gravity, 1> gravity_{};
    [[no_unique_address]] If<each, bool[features.bodies], 0> of_{};
};

}  // namespace tumble

// Which islands stand: in the last step one stood as in the step before, under gravity alone. While nothing happens to
// a world, and its bodies are balanced (PairList::are_balanced), it stands in the next step too: neither loads nor
// forces of it are computed, and its bodies look for nothing.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/scene.hpp>

namespace tumble {

template <Features features>
class Standing {
public:
    using BodyGroup = SomeBodies<features.bodies>;

    // Call where something happens that is not the work of a step.
    constexpr void end() {
        all_ = is_known_ = false;
        if constexpr (features.control) gravity_.stood = false;
    }
    // Call where gravity changes: what stood may stand under other forces.
    void gravity_changed() requires(features.control) {
        gravity_.is_other = true;
        gravity_.stood = gravity_.stood || all_;
        all_ = false;
    }
    // True from new gravity to the end of the next step of islands.
    [[nodiscard]] TUMBLE_INLINE bool has_other_gravity() const {
        if constexpr (features.control) return gravity_.is_other;
        else return false;
    }
    // True where all islands stood, under the same gravity. With sleep never: their bodies fall asleep.
    [[nodiscard]] bool all() const { return all_; }
    // True where the body stood when it was last near something. Ask whether it is near something now.
    [[nodiscard]] TUMBLE_INLINE bool stood([[maybe_unused]] int b) const {
        if constexpr (each) return all_ || (is_known_ && of_[b]);
        else if constexpr (features.control) return all_ || gravity_.stood;
        else return all_;
    }
    // True where an island stands as it did. Ask whether it is balanced.
    [[nodiscard]] bool stands(const BodyGroup& group) const { return !has_other_gravity() && stood(group); }
    // True where all bodies of an island stood. The island of a single body is all there is.
    [[nodiscard]] bool stood(const BodyGroup& group) const {
        bool all = true;
        for (int k = 0; k < group.count; ++k) all = all && stood(group.id[k]);
        return all;
    }
    // Call where the body looks for others, in worlds with a grid.
    void look(int b) requires(features.grid()) { of_[b] = false; }
    // True where it has looked since it stood, or has not stood.
    [[nodiscard]] bool has_looked(int b) const requires(features.grid()) { return !of_[b]; }

    // Call for each island that has stepped.
    void set([[maybe_unused]] const BodyGroup& group, [[maybe_unused]] bool stands) {
        if constexpr (each)
            for (int k = 0; k < group.count; ++k) of_[group.id[k]] = stands;
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
        if constexpr (features.control) to(self.gravity_.is_other, self.gravity_.stood);
        if constexpr (each) to(self.of_);
    }

private:
    static constexpr bool each = features.bodies > 1;
    struct Gravity {
        bool is_other = false;  // than in the last step
        bool stood = false;     // then all islands stood under the one before
    };

    bool all_ = false;
    bool is_known_ = false;  // of_ is what it says
    [[no_unique_address]] If<features.control, Gravity, 1> gravity_{};
    [[no_unique_address]] If<each, bool[features.bodies], 0> of_{};
};

}  // namespace tumble

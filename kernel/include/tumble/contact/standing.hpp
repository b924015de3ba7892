// Which islands stand: in the last step one stood as in the step before, under gravity alone. While nothing happens to
// a world, and the pairs of the island hold it (PairList::hold_all), it stands in the next step too: neither loads nor
// forces of it are computed, and its bodies look for nothing.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/scene.hpp>

namespace tumble {

template <Features features>
class Standing {
public:
    using BodyGroup = tumble::BodyGroup<features.bodies>;

    // Call where something happens that is not the work of a step.
    void end() { all_ = is_known_ = false; }
    // True where all islands stood. With sleep never: their bodies fall asleep.
    [[nodiscard]] bool all() const { return all_; }
    // True where the body stood when it was last near something. Ask whether it is near something now.
    [[nodiscard]] bool stood([[maybe_unused]] int b) const {
        if constexpr (each) return all_ || (is_known_ && of_[b]);
        else return all_;
    }
    // The same of all bodies of an island. Ask whether its pairs hold it. The island of a single body is all there is.
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
    }

    // Writes or reads what a snapshot holds.
    template <class Self, class Archive>
    static void archive(Self& self, Archive& to) {
        to(self.all_, self.is_known_);
        if constexpr (each) to(self.of_);
    }

private:
    static constexpr bool each = features.bodies > 1;

    bool all_ = false;
    bool is_known_ = false;  // of_ is what it says
    [[no_unique_address]] If<each, bool[features.bodies], 0> of_{};
};

}  // namespace tumble

// Which islands are known to stand: in the last step one stood as in the step before, under gravity alone, and nothing
// has happened since. It stands in the next step too, and nothing of it is computed.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/scene.hpp>

namespace tumble {

template <Features features>
class Standing {
public:
    using BodyGroup = tumble::BodyGroup<features.bodies>;

    // Call where something changes other than by a step.
    void end() { all_ = is_known_ = false; }
    // True where all islands stand, and none of their bodies is to fall asleep.
    [[nodiscard]] bool all() const { return all_; }
    // True where the body stood in its island of the last step.
    [[nodiscard]] bool stood([[maybe_unused]] int b) const {
        if constexpr (each) return all_ || (is_known_ && of_[b]);
        else return all_;
    }
    // True where the bodies stood, each in its island of the last step. What has come near them since is not asked.
    [[nodiscard]] bool stood([[maybe_unused]] const BodyGroup& group) const {
        if constexpr (each) {
            bool all = is_known_;
            for (int k = 0; k < group.count; ++k) all = all && of_[group.id[k]];
            return all;
        } else {
            return false;
        }
    }

    // Call for each island that has stepped.
    void set([[maybe_unused]] const BodyGroup& group, [[maybe_unused]] bool stands) {
        if constexpr (each)
            for (int k = 0; k < group.count; ++k) of_[group.id[k]] = stands;
    }
    // Call when all islands have stepped. `apart`: no pair has come near that connects two of them.
    void end_step(bool all, bool apart) {
        all_ = all;
        is_known_ = apart;
    }

private:
    // Of a single body `all_` says it.
    static constexpr bool each = features.bodies > 1;

    bool all_ = false;
    bool is_known_ = false;  // of_
    [[no_unique_address]] If<each, bool[features.bodies], 0> of_{};
};

}  // namespace tumble

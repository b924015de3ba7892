// How wrong a method is on a scene, at steps that are powers of two times the scene's.
//
// The error of a run is the largest over 20 sample times, equally spaced over the scene up to a rounding to whole
// steps, and over all bodies, of the distance between the body's place and its true place (m) and of the angle between
// its orientation and its true orientation (rad). Every step that is compared ends at every sample time and at every
// time at which an event of the scene acts, so that all runs replay the same events and are read at the same moments.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "scene/description.hpp"
#include "simulation/simulation.hpp"
#include "truth/motion.hpp"

namespace tumble::host {

inline constexpr int sample_count = 20;

// An integrator in a number system.
struct Method {
    std::string integrator, numbers;
    bool carry = false;
};

// Throws std::invalid_argument where the scene has events of control. A force for one step has no meaning at another
// step, so no other run is a reference for them.
void require_no_events(const SceneDescription& scene);
[[nodiscard]] Method method_of(const Simulation& simulation);

[[nodiscard]] reference::Motion motion_of(const BodySnapshot& body);
[[nodiscard]] bool is_finite(const reference::Motion& motion);

// The scene with its events at the starts of whole steps, so that a finer run replays them at the same times.
[[nodiscard]] SceneDescription with_events_at_steps(SceneDescription scene);

// The largest seen.
struct Errors {
    double position_m = 0, orientation_rad = 0;
    void see(const reference::Motion& one, const reference::Motion& other);
    [[nodiscard]] double largest() const { return position_m > orientation_rad ? position_m : orientation_rad; }
};

// The states of all bodies at each sample time.
using Samples = std::array<std::vector<reference::Motion>, sample_count>;
[[nodiscard]] Errors largest_errors(const Samples& a, const Samples& b);

// A scene whose events are at whole steps, at each of its steps. A step has a number: its length is the scene's own
// times 2^number.
class SampledScene {
public:
    // Throws std::invalid_argument for a scene that does not last.
    explicit SampledScene(SceneDescription scene);

    // The longest step: 20 of it fit into the scene, and every event is at a multiple of it. The shortest: no longer
    // than 1/4096 s, a quarter of the scene's own and 1/4096 of the duration; but a run has at most 2^20 steps.
    [[nodiscard]] int longest() const { return longest_; }
    [[nodiscard]] int shortest() const { return shortest_; }

    [[nodiscard]] bool has_joints() const { return !scene_.joints.empty(); }
    // The scene with this step, up to the last sample time.
    [[nodiscard]] SceneDescription with_step(int number) const;
    // Of the longest step, from the start to a sample time.
    [[nodiscard]] const std::array<std::int64_t, sample_count>& sample_steps() const { return sample_steps_; }

private:
    SceneDescription scene_;
    int longest_ = 0, shortest_ = 0;
    std::array<std::int64_t, sample_count> sample_steps_{};
};

// A run that was read at the sample times, or what ended it.
struct SampledRun {
    Samples samples;
    std::string failure;  // the name of a status, or "not finite"; empty: it came to its end
};
// Empty for an integrator that does not run in this number system.
[[nodiscard]] std::optional<SampledRun> run_sampled(const SampledScene& scene, const Method& method, int step);

// What a scene really does, at the sample times.
struct Truth {
    Samples samples;
    // With contacts there is no smooth motion to integrate: the samples are those of rk4 in double precision at a
    // quarter of the shortest step, and the doubt is how far suzuki4, at twice that step, is from them. Without, the
    // samples are those of SmoothMotion, and there is no doubt: 0. Joints make motions chaotic: then the doubt is what
    // a coarser integration differs by.
    bool has_contacts = false;
    Errors doubt;
};
// Throws std::runtime_error when there is no truth to be had: the motion is singular, or the fine runs fail.
[[nodiscard]] Truth truth_of(const SampledScene& scene);

// What a method reaches at one step.
struct Attempt {
    Method method;
    int step = 0;  // its number
    StepSize length;
    Errors errors;
    std::string failure;  // of the run; then the errors are infinite
    [[nodiscard]] double error() const {
        return failure.empty() ? errors.largest() : std::numeric_limits<double>::infinity();
    }
};

// The longest step at which the method's error is at most `tolerance`, or the most accurate attempt where there is
// none: halving does not always help, since fixed point has a floor of rounding. Empty for an integrator that does not
// run in this number system.
[[nodiscard]] std::optional<Attempt> longest_step_within(double tolerance, const SampledScene& scene,
                                                         const Truth& truth, const Method& method);

}  // namespace tumble::host

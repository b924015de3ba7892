// What can go wrong while a world runs. Bits are sticky: once set they stay until clear_status(), with the first body
// and step that set one, and a count of all occurrences.
#pragma once

#include <tumble/config.hpp>

namespace tumble {

// A bit of Status.
enum class Issue : std::uint8_t {
    // A position, velocity or spin left the range of the number system. Fixed point: the value is held at the limit and
    // the trajectory is wrong from here on; declare a larger Range or take a smaller step. Floating point: a value is
    // not finite, or the body turned so far in a step that its orientation is wrong or lost its unit length; take a
    // smaller step.
    range_left = 1,
    // An iteration met its bound. Either an implicit method did not converge: take a smaller step. Or a step had more
    // impacts than it resolves, and left out a bounce faster than loads change a speed in a step: set
    // restitution_threshold. Or the forces between touching bodies were not found, so that one sinks into another, as
    // below a body that is 1000 times as heavy: make the masses more equal. Or these forces leave a face turning, so
    // that a tall stack leans and walks off sideways: take a smaller step. Or joints did not close in a 32nd of a
    // step, which was projected and lost energy: take a smaller step. The state is usable but less accurate.
    step_bound_hit = 2,
    // More pairs near each other than the scene has room for; some bodies pass through others. Raise near_pairs.
    contacts_full = 4,
    // add() was called on a full world, or with a joint that closes a loop; nothing was added. Raise the capacity in
    // the scene, or ask World::fault_of().
    world_full = 8,
    // The step is too long and adds energy: for a spring, a damper or drag when it was added, for a spring of a joint
    // in the next step, for contacts by springs, or for two bodies that attract each other. Or a link swings under the
    // force of its joint faster than a 32nd of the step follows. Take a smaller step; for contacts by springs at most
    // World::largest_safe_step().
    step_too_long = 16,
    // A step had more impacts or searches than ContactSpec allows, or sweeps without an end: allow more. What was left
    // over is resolved at the start of the next step; bodies overlap until then. Or a bounded step of many bodies ended
    // with an overlap that one step does not correct: take a smaller step.
    left_over = 32,
    // A joint stayed open: poses were set that do not fit it, or a step was too long by far. Set the poses of all
    // bodies of a mechanism before the next step, or take a smaller step.
    joint_open = 64,
};
// All issues, in the order of their bits.
inline constexpr Issue all_issues[] = {Issue::range_left, Issue::step_bound_hit, Issue::contacts_full,
                                       Issue::world_full, Issue::step_too_long,  Issue::left_over,
                                       Issue::joint_open};

// The name as the command and its rows print it: range_left.
[[nodiscard]] constexpr const char* name_of(Issue issue) {
    switch (issue) {
    case Issue::range_left: return "range_left";
    case Issue::step_bound_hit: return "step_bound_hit";
    case Issue::contacts_full: return "contacts_full";
    case Issue::step_too_long: return "step_too_long";
    case Issue::left_over: return "left_over";
    case Issue::joint_open: return "joint_open";
    default: return "world_full";
    }
}

// What has gone wrong since the start, or since clear_status().
struct Status {
    std::uint32_t first_step = 0;  // number of the step that set the first bit, from 0, modulo 2^32; where !ok()
    std::uint16_t count = 0;       // occurrences, held at 65535
    // Meaningful when !ok(). The number of bodies then: none of them, as of gravity. 255: that one or a later one.
    std::uint8_t first_body = 0;
    std::uint8_t bits = 0;  // of the issues that occurred; 0: none

    // True while nothing has gone wrong.
    [[nodiscard]] constexpr bool ok() const { return bits == 0; }
    // True once this issue has occurred.
    [[nodiscard]] constexpr bool has(Issue issue) const { return (bits & static_cast<std::uint8_t>(issue)) != 0; }
    // Counts an issue, of a body in a step.
    constexpr void set(Issue issue, int body, std::uint32_t step) {
        if (bits == 0) {
            first_body = static_cast<std::uint8_t>(body < 0xff ? body : 0xff);
            first_step = step;
        }
        bits = static_cast<std::uint8_t>(bits | static_cast<std::uint8_t>(issue));
        if (count != 0xffffu) ++count;
    }
};

}  // namespace tumble

// The features of the host's worlds.
#pragma once

#include "scene/data.hpp"

namespace tumble::host {

// Every feature that a scene file or a live run can ask for, with the host's room. The command itself keeps the events
// of a live run, and a scene keeps its bodies. Features of joints cost nothing without room for joints.
inline constexpr Features host_features = [] {
    Features f =
        Features{.bodies = max_bodies, .planes = max_planes, .springs = max_springs, .near_pairs = max_near_pairs}
            .with_everything();
    f.recording = f.removal = false;
    return f;
}();

// Those of scenes with joints. Most of them have no contacts, and their worlds compile in half the time without.
inline constexpr Features joint_features = [] {
    Features f = host_features;
    f.joints = max_joints;
    f.removal = true;  // of joints
    return f;
}();
inline constexpr Features joint_features_without_contacts = [] {
    Features f = joint_features;
    f.planes = 0;
    f.pairs = false;
    return f;
}();

}  // namespace tumble::host

// The words of scene files for what has a fixed set of choices.
#pragma once

#include <tumble/events/event.hpp>

#include <string>
#include <utility>
#include <vector>

namespace tumble::host {

enum class JointKind { hinge, ball, fixed, slider, universal, distance };

// One choice of a fixed set of words.
template <class T>
using Words = std::vector<std::pair<std::string, T>>;

// The events that a scene has, or those that it has tables of forces for: `timed`. It keeps its bodies.
[[nodiscard]] inline Words<EventKind> words_of_events(bool timed) {
    Words<EventKind> all;
    for (int i = 0; i <= static_cast<int>(EventKind::remove_joint); ++i) {
        const auto kind = static_cast<EventKind>(i);
        if (kind != EventKind::remove && is_timed(kind) == timed) all.emplace_back(name_of(kind), kind);
    }
    return all;
}

// The words for the values of a type. With underscores, they are the kernel's names.
template <class T>
inline const Words<T> words{};
template <>
inline const Words<ContactResponse> words<ContactResponse>{
    {"impulse", ContactResponse::impulse}, {"spring", ContactResponse::spring}, {"none", ContactResponse::none}};
template <>
inline const Words<Frame> words<Frame>{{"world", Frame::world}, {"body", Frame::body}};
template <>
inline const Words<EventKind> words<EventKind> = words_of_events(false);
template <>
inline const Words<Mixing> words<Mixing>{{"larger", Mixing::larger},
                                         {"smaller", Mixing::smaller},
                                         {"mean", Mixing::mean},
                                         {"geometric mean", Mixing::geometric_mean},
                                         {"product", Mixing::product}};
template <>
inline const Words<JointKind> words<JointKind>{{"ball", JointKind::ball},           {"hinge", JointKind::hinge},
                                               {"slider", JointKind::slider},       {"fixed", JointKind::fixed},
                                               {"universal", JointKind::universal}, {"distance", JointKind::distance}};
template <>
inline const Words<ShapeKind> words<ShapeKind>{{"box", ShapeKind::box},           {"sphere", ShapeKind::sphere},
                                               {"cylinder", ShapeKind::cylinder}, {"hoop", ShapeKind::hoop},
                                               {"capsule", ShapeKind::capsule},   {"points", ShapeKind::points},
                                               {"none", ShapeKind::none}};

// The word for a value that has one.
template <class T>
[[nodiscard]] const std::string& word_of(const T& value) {
    std::size_t i = 0;
    while (words<T>[i].second != value) ++i;
    return words<T>[i].first;
}

// The key of where the spring of a joint rests; empty where that is the start.
[[nodiscard]] inline const char* rest_key(JointKind kind) {
    switch (kind) {
    case JointKind::hinge:
    case JointKind::universal: return "angle";
    case JointKind::slider: return "travel";
    case JointKind::distance: return "rest_length";
    default: return "";
    }
}

}  // namespace tumble::host

// The words of scene files for what has a fixed set of choices.
#pragma once

#include <tumble/body/setup.hpp>

#include <string>
#include <utility>
#include <vector>

namespace tumble::host {

enum class JointKind { hinge, ball, fixed, slider, universal, distance };

// One choice of a fixed set of words.
template <class T>
using Words = std::vector<std::pair<std::string, T>>;

// The word for a value that has one.
template <class T>
[[nodiscard]] const std::string& word_of(const Words<T>& words, const T& value) {
    std::size_t i = 0;
    while (words[i].second != value) ++i;
    return words[i].first;
}

// With underscores, the words are the names of the kernel.
inline const Words<ContactResponse> responses{
    {"impulse", ContactResponse::impulse}, {"spring", ContactResponse::spring}, {"none", ContactResponse::none}};
inline const Words<Mixing> mixings{{"larger", Mixing::larger},
                                   {"smaller", Mixing::smaller},
                                   {"mean", Mixing::mean},
                                   {"geometric mean", Mixing::geometric_mean},
                                   {"product", Mixing::product}};
inline const Words<JointKind> joint_kinds{{"ball", JointKind::ball},           {"hinge", JointKind::hinge},
                                          {"slider", JointKind::slider},       {"fixed", JointKind::fixed},
                                          {"universal", JointKind::universal}, {"distance", JointKind::distance}};

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

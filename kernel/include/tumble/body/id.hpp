// The ids that add() of a world returns.
#pragma once

#include <tumble/config.hpp>

namespace tumble {

// What a world keeps in the order of add().
enum class Thing : std::uint8_t { body, plane, spring, joint };

// The number of a body, plane, spring or joint in its world. False if add() found no room. The id of a body or a joint
// also holds how often that of its place had been removed when it was added, so that the id of a removed one names no
// other.
template <Thing thing>
class Id {
public:
    constexpr Id() = default;  // the id of nothing
    // From the place in the order of add(), from 0.
    constexpr explicit Id(int index)
        : index_{index < 0 || index > most ? std::int16_t{-1} : static_cast<std::int16_t>(index)} {}
    // The same after so many removals of this place, modulo 2^16.
    constexpr Id(int index, std::uint16_t generation) : Id{index} { generation_ = generation; }
    // True of an id of something. False of the result of add() without room.
    [[nodiscard]] constexpr explicit operator bool() const { return index_ >= 0; }
    [[nodiscard]] constexpr Id operator*() const { return *this; }
    // The place in the order of add(), from 0. -1: the id of nothing.
    [[nodiscard]] constexpr int index() const { return index_; }
    // How often a body or a joint of this place had been removed before, modulo 2^16.
    [[nodiscard]] constexpr std::uint16_t generation() const { return generation_; }
    friend constexpr bool operator==(Id, Id) = default;
    // The largest index that an id can hold.
    static constexpr int most = 0x7fff;

private:
    std::int16_t index_ = -1;
    std::uint16_t generation_ = 0;
};
// Of a body.
using BodyId = Id<Thing::body>;
// Of a plane.
using PlaneId = Id<Thing::plane>;
// Of a spring.
using SpringId = Id<Thing::spring>;
// Of a joint.
using JointId = Id<Thing::joint>;

// The place of a body in the order of add(), as springs and timed events name it: an id, or a number from 0. -1: no
// body.
class BodyIndex {
public:
    // A number; not checked until it is used.
    constexpr BodyIndex(int index) : index_{index} {}  // NOLINT(google-explicit-constructor): generated scenes
    // The body's number.
    constexpr BodyIndex(BodyId id) : index_{id.index()} {}  // NOLINT(google-explicit-constructor)
    // The number.
    constexpr operator int() const { return index_; }  // NOLINT(google-explicit-constructor)

private:
    int index_;
};

}  // namespace tumble

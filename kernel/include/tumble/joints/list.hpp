// The kinds of joints. A new kind is one header and one entry.
//
// A kind is a struct with:
//   Spec                       as a program adds it, with `body`, `to_body` and `anchor`
//   name                       for messages
//   turns, slides              the number of free rotations and of free translations
//   axes                       the number of axes of each body that its gap and its free directions need: 0 to 2
//   axes_of(spec)              the axes in the world when it is added
//   fault_of(spec)             what is wrong with the spec in itself
//   turn(view, i)              the axis of free rotation i, of unit length and perpendicular to the others; not of
//                              three, which are those about the axes of the world
//   slide(view, i)             the direction of free translation i
//   lean(view)                 the turn, rad, that closes the gap between the orientations to first order; not of three
//                              free rotations
// The view has the axes of the body, own(i), and of the other, other(i), and products of them. The gap between the
// anchors is the same for all kinds: their distance, less what is along free translations.
#pragma once

#include <tumble/joints/ball.hpp>
#include <tumble/joints/fixed.hpp>
#include <tumble/joints/hinge.hpp>
#include <tumble/joints/slider.hpp>
#include <tumble/joints/universal.hpp>
#include <tumble/scene.hpp>

namespace tumble {

namespace detail {

// The kind that a program adds by this spec.
template <class Spec, class Kind, class... More>
struct KindOfSpec : KindOfSpec<Spec, More...> {};
template <class Spec, class Kind, class... More>
requires(std::is_same_v<Spec, typename Kind::Spec>) struct KindOfSpec<Spec, Kind, More...> {
    using type = Kind;
};

}  // namespace detail

template <class... Kinds>
struct JointKindList {
    static constexpr int count = sizeof...(Kinds);
    static constexpr int most_directions = [] {
        int most = 0;
        for (const int directions : {Kinds::turns + Kinds::slides...})
            if (directions > most) most = directions;
        return most;
    }();
    template <class Spec>
    static constexpr bool has = (std::is_same_v<typename Kinds::Spec, Spec> || ...);
    // The kind of a spec, as a number.
    template <class Spec>
    static constexpr std::uint8_t number_of = [] {
        std::uint8_t number = 0, found = 0;
        ((found = std::is_same_v<typename Kinds::Spec, Spec> ? number : found, ++number), ...);
        return found;
    }();
    template <class Spec>
    using Of = typename detail::KindOfSpec<Spec, Kinds...>::type;
    // Calls f<Kind>() of the kind with this number.
    template <class F>
    TUMBLE_INLINE static constexpr void with(int number, F&& f) {
        int n = 0;
        (void)((n++ == number ? (f.template operator()<Kinds>(), true) : false) || ...);
    }
};

using JointKinds = JointKindList<joints::Hinge, joints::Ball, joints::Fixed, joints::Slider, joints::Universal>;

// True of what add() takes as a joint.
template <class Spec>
concept JointSpec = JointKinds::has<Spec>;

}  // namespace tumble

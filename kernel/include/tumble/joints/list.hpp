// The kinds of joints. A new kind is one header and one entry.
//
// A kind is a struct with:
//   Spec                       as a program adds it, with `body`, `to_body` and `anchor`
//   name                       for messages
//   feature                    of Features: a world without it has no such joint
//   turns, slides              the number of free rotations and of free translations
//   axes                       the number of axes of each body that its gap and its free directions need: 0 to 2
//   axes_of(spec)              the axes in the world when it is added
//   fault_of(spec)             what is wrong with the spec in itself
// A step knows the counts alone, so that all kinds share its code. With own the axes of the body and other those of the
// other side:
//   turns      free rotations                 what closes the gap between the orientations to first order
//   3          about the axes of the world    there is none
//   2          about own 0 and other 0        own 0 and other 0 stay perpendicular: -(own 0 . other 0) own 0 x other 0
//   1          about own 0                    own 0 and other 0 stay parallel: own 0 x other 0
//   0          none                           this, and the part of own 1 x other 1 along own 0
//   slides     free translations
//   1          along other 0
//   2          across the line between the anchors, which keeps its length; a slack rope leaves this free too
// The gap between the anchors is their distance, less what is along free translations.
#pragma once

#include <tumble/joints/ball.hpp>
#include <tumble/joints/distance.hpp>
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
    // Of the kinds of a scene. A distance may have all six.
    [[nodiscard]] static constexpr int most_directions(const Features& features) {
        int most = 0;
        for (const int directions : {(!(features.*Kinds::feature) ? 0
                                      : Kinds::slides < 2         ? Kinds::turns + Kinds::slides
                                                                  : 6)...})
            if (directions > most) most = directions;
        return most;
    }
    // True where a kind of the scene has so many free rotations, and so many free translations.
    [[nodiscard]] static constexpr bool any_turns(const Features& features, int so_many) {
        return ((features.*Kinds::feature && Kinds::turns == so_many) || ...);
    }
    [[nodiscard]] static constexpr bool any_slides(const Features& features, int so_many) {
        return ((features.*Kinds::feature && Kinds::slides == so_many) || ...);
    }
    template <class Spec>
    static constexpr bool has = (std::is_same_v<typename Kinds::Spec, Spec> || ...);
    // The kind of a spec, as a number.
    template <class Spec>
    static constexpr std::uint8_t number_of = [] {
        std::uint8_t number = 0, found = 0;
        ((found = std::is_same_v<typename Kinds::Spec, Spec> ? number : found, ++number), ...);
        return found;
    }();
    // Free rotations along which a spring of the joint acts; none of a distance.
    template <class Spec>
    static constexpr int turns_of_springs =
        ((std::is_same_v<typename Kinds::Spec, Spec> && Kinds::slides == 0 ? int{Kinds::turns} : 0) + ...);
    template <class Spec>
    using Of = typename detail::KindOfSpec<Spec, Kinds...>::type;
    // Of the kind with a number.
    static constexpr std::int8_t turns[count] = {Kinds::turns...}, slides[count] = {Kinds::slides...},
                                 axes[count] = {Kinds::axes...};
};

using JointKinds =
    JointKindList<joints::Hinge, joints::Ball, joints::Fixed, joints::Slider, joints::Universal, joints::Distance>;

// True of what add() takes as a joint.
template <class Spec>
concept JointSpec = JointKinds::has<Spec>;

}  // namespace tumble

// What an integration method provides, and the small types that methods share.
//
// A method is a struct with:
//   name, order                     for the command line and for tests
//   spin                            the kind of the state's spin: see Spin in body/state.hpp
//   coasting                        the advance of a position under constant acceleration
//   Inertia<N>::of(moments, step, scale)   the constants of a body that its rotation needs
//   rotate<N>(body, inertia, step)         one step of torque-free rotation. Returns nothing, whether it converged, or
//                                          Turned
//   oscillator_step, oscillation_limit, drag_limit, step_bounds   limits of the step: a method has them from its base
//                                   Stability in stability.hpp
//   advance<N, capacity>(group, evaluate, step)   one step of bodies whose loads depend on their state. A method whose
//                                   advance() takes any Group can step bodies that do not rotate
// Optional members:
//   inertia.prepare(body, scale)    if the constants of a body depend on its spin; called after each change of the spin
//   free_order                      if torque-free rotation has another order than the rest
//   needs                           if a step needs sqrt, division or trigonometry: the text for the user
//   follows_any_turn                if a step may turn a body by any angle. Without it, floating point sets range_left
//                                   for more than 1 rad, or for more than 3 rad if the spin is the angular momentum
//   keeps_kick                      if a step of a body alone starts with the kick that the last step ended with:
//                                   evaluate.kept_kick()
//   rotate_called<N>                rotate() out of line, if advance() turns bodies by the same code: worlds with loads
//                                   then have it once
//   PartAlone                       the method of a part of a composition, if joints may fly it by itself
//   not_in_fixed_point              if the method is for floating point only: the reason for the user; see runs_in
// A new method is one such header and one line in integrators/list.hpp. World checks the required members by the
// concept Method below.
#pragma once

#include <tumble/body/orientation.hpp>
#include <tumble/body/stage.hpp>

namespace tumble {

// The free_order of a rotation without truncation error.
inline constexpr int no_truncation = 0x7fffffff;

// True if the method runs in the number system. All loops over methods and number systems use this. Builds read the
// same member from the headers (lists.cmake).
template <class Method, class N>
inline constexpr bool runs_in = !(N::fixed_point && requires { Method::not_in_fixed_point; });

// The number of bodies of a group; of a body alone, a constant.
template <int capacity>
struct GroupCount {
    int count = 0;
    void set_count(int bodies) {
        count = bodies;
        has_bodies();
    }
    // Tells compilers that there is a first stage.
    TUMBLE_INLINE void has_bodies() const {
        if (count < 1) __builtin_unreachable();
    }
};
template <>
struct GroupCount<1> {
    static constexpr int count = 1;
    static void set_count(int) {}
    static void has_bodies() {}
};

// Bodies that have their stages together, because loads couple them, or one body alone. With `points` some of them may
// move as point masses do, whose orientation and spin the method leaves alone: point masses, and bodies whose rotation
// the loads neither change nor ask for.
template <class N, Spin spin, class Inertia, int capacity, bool points = false>
struct Group : GroupCount<capacity> {
    static constexpr bool rotation = true, has_points = points;
    using Stage = StageState<N>;
    using Kick = tumble::Kick<N>;

    BodyState<N, spin>* body[capacity]{};
    Inertia* inertia[capacity]{};  // null for a body that moves as a point mass
    mutable int too_fast = -1;     // a body that the method could not turn, because it turns too far in the step

    [[nodiscard]] TUMBLE_INLINE bool rotates([[maybe_unused]] int b) const {
        if constexpr (points) return inertia[b] != nullptr;
        else return true;
    }
    // Writes body b as it stands.
    TUMBLE_INLINE void take(int b, Stage& stage) const { take_stage(stage, *body[b]); }
};
// The same in a world that has only point masses.
template <class N, Spin spin, int capacity>
struct Translations : GroupCount<capacity> {
    static constexpr bool rotation = false, has_points = false;
    using Stage = StageState<N, false>;
    using Kick = tumble::Kick<N, false>;

    BodyState<N, spin>* body[capacity]{};

    [[nodiscard]] static constexpr bool rotates(int) { return false; }
    TUMBLE_INLINE void take(int b, Stage& stage) const { take_stage(stage, *body[b]); }
};

namespace detail {

// Loads that act on no body: tests by them whether a method can be called with loads.
template <class N>
struct NoLoads {
    static constexpr bool may_depend_on_velocity = true;
    void operator()(const StageState<N>*, Kick<N>*) const {}
    void operator()(const StageState<N>*, WorkKick<N>*) const {}
    [[nodiscard]] bool depends_on_velocity() const { return false; }
};

template <class M, class N>
concept DescribesItself = requires {
    { M::name } -> std::convertible_to<const char*>;
    { M::order } -> std::convertible_to<int>;
    { M::spin } -> std::convertible_to<Spin>;
    { M::coasting } -> std::convertible_to<Coasting>;
    typename M::template Inertia<N>;
};

}  // namespace detail

// M can step the bodies of a world in the number system N. advance() returns whether it converged.
template <class M, class N>
concept Method = detail::DescribesItself<M, N> &&
    requires(BodyState<N, M::spin>& body, const typename M::template Inertia<N>& inertia, const StepInfo<N>& step,
             const Group<N, M::spin, typename M::template Inertia<N>, 1>& group, const detail::NoLoads<N>& loads) {
    { M::template Inertia<N>::of(RealVec3{}, step.scale) } -> std::convertible_to<typename M::template Inertia<N>>;
    M::template rotate<N>(body, inertia, step);
    { M::template advance<N, 1>(group, loads, step) } -> std::same_as<bool>;
};

}  // namespace tumble

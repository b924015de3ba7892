// What every integration method provides, and the small types they share.
//
// A method is a struct with:
//   name, order                     for the command line and for tests
//   spin                            what the state's spin is: see Spin in body/state.hpp
//   coasting                        how position advances under constant acceleration
//   Inertia<N>::of(moments, step, scale)   the constants of a body that its rotation needs
//   rotate<N>(body, inertia, step)         one step of torque-free rotation
//   inertia.prepare(body, scale)           only where those constants depend on the spin: called whenever it is changed
//   free_order                      only where torque-free rotation has another order than the rest
//   needs                           only where a step needs sqrt, division or trigonometry: says so to the user
//   oscillator_step, oscillation_limit, drag_limit, step_bounds   how long a step may be: Stability of stability.hpp,
//                                   which a method has as a base
//   follows_any_turn                only where a step may turn a body by any angle: else more than 1 rad (with angular
//                                   momentum as the spin, 3 rad of it) is told as range_left in floating point
//   takes_any_load                  only where fixed point does not limit what loads change in a step
//   not_in_fixed_point              only where it is for floating point alone: says why to the user; see runs_in
//   advance<N, capacity>(group, evaluate, step)   one step of bodies whose loads depend on their state; of a group in
//                                   which a body does not rotate, if it takes any Group
// A new method is one such header and one line in integrators/list.hpp. World asks for what every method must have by
// the concept Method below.
#pragma once

#include <tumble/body/orientation.hpp>
#include <tumble/body/stage.hpp>

namespace tumble {

// The free_order of a rotation without truncation error.
inline constexpr int no_truncation = 0x7fffffff;

// True of a method that runs in a number system. All loops over methods and number systems ask this, and builds ask
// the same member of the headers (lists.cmake).
template <class Method, class N>
inline constexpr bool runs_in = !(N::fixed_point && requires { Method::not_in_fixed_point; });

// Bodies that must be staged together, because loads couple them; or one body alone. With `points` some of them may be
// point masses, without a spin all of them are: their orientation and spin are not touched, and need not be there.
template <class N, Spin spin, class Inertia, int capacity, bool points = false>
struct Group {
    static constexpr bool rotation = true, has_points = points;
    using Stage = StageState<N>;
    using Kick = tumble::Kick<N>;

    int count = 0;
    BodyState<N, spin>* body[capacity]{};
    Inertia* inertia[capacity]{};  // none of a point mass

    [[nodiscard]] TUMBLE_INLINE bool rotates([[maybe_unused]] int b) const {
        if constexpr (points) return inertia[b] != nullptr;
        else return true;
    }
};
template <class N, class Inertia, int capacity>
struct Group<N, Spin::none, Inertia, capacity, false> {
    static constexpr bool rotation = false, has_points = false;
    using Stage = StageState<N, false>;
    using Kick = tumble::Kick<N, false>;

    int count = 0;
    BodyState<N, Spin::none>* body[capacity]{};

    [[nodiscard]] static constexpr bool rotates(int) { return false; }
};

namespace detail {

// Loads of no body, for asking whether a method can be called with loads.
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

// M can step the bodies of a world in the number system N. rotate() returns nothing or whether it converged, advance()
// whether it did.
template <class M, class N>
concept Method = detail::DescribesItself<M, N> &&
    requires(BodyState<N, M::spin>& body, const typename M::template Inertia<N>& inertia, const StepInfo<N>& step,
             const Group<N, M::spin, typename M::template Inertia<N>, 1>& group, const detail::NoLoads<N>& loads) {
    { M::template Inertia<N>::of(RealVec3{}, step.scale) } -> std::convertible_to<typename M::template Inertia<N>>;
    M::template rotate<N>(body, inertia, step);
    { M::template advance<N, 1>(group, loads, step) } -> std::same_as<bool>;
};

}  // namespace tumble

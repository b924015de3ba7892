// MovingBodies<Scene>: the bodies of a world with their inertia, what acts on them, and the constants by which the
// scene's method moves them. The first layer of Advance. A layer is a class that derives from the one before it and
// names what it takes from there; none knows the ones behind it.
#pragma once

#include <tumble/events/wrench.hpp>
#include <tumble/integrators/verlet.hpp>
#include <tumble/joints/forest.hpp>
#include <tumble/loads/load_set.hpp>

namespace tumble {

template <class S>
class MovingBodies {
public:
    using N = typename S::Numbers;
    using Integrator = typename S::Integrator;
    using Work = typename N::Work;
    using DriftSum = typename N::DriftSum;
    using TurnSum = typename N::TurnSum;
    static constexpr Features features = S::features;
    static constexpr bool has_loads = detail::has_loads<S>, rotation = features.rotation,
                          has_own_loads = detail::OwnLoads<S>::List::count > 0,
                          has_wrenches = features.control && features.bodies > 0, has_joints = features.has_joints();
    static constexpr bool keeps_kicks = has_loads && requires { Integrator::keeps_kick; };
    static constexpr Spin spin = rotation ? Integrator::spin : Spin::none;
    using State = BodyState<N, spin>;
    // The step is a constant of the program where the scene names it and bodies fly freely.
    static constexpr bool is_step_constant = requires { S::step; }
    &&!has_loads && !features.contacts();
    using Bodies =
        tumble::Bodies<N, spin, features.bodies, features.mixed(), std::conditional_t<is_step_constant, S, void>>;
    using BodyGroup = tumble::BodyGroup<features.bodies>;
    using Loads = LoadSet<N, spin, features, typename detail::OwnLoads<S>::List>;
    using Portion = tumble::Portion<Work>;
    using Joints = JointForest<N, features>;
    static constexpr bool may_couple = [] {
        if constexpr (has_loads) return Loads::may_couple;
        else return false;
    }();

    constexpr MovingBodies(Seconds step, const WorldSpec& spec)
        : bodies{step}, loads{step.value, spec}, wrenches{step.value} {}
    // m/s^2, world frame.
    constexpr void set_gravity(RealVec3 gravity) {
        const Real h2 = bodies.step_length * bodies.step_length;
        disturb();
        for (int i = 0; i < 3; ++i) {
            const Real fall = bodies.scale.drift_units(gravity[i] * h2);
            gravity_[i] = N::fall(fall_in_halves ? fall * Real::scaled(1, -1) : fall);
        }
    }
    // The same of a program's numbers. False where it is what it was.
    bool set_gravity(const VectorBlock<N>& gravity) requires(has_wrenches) {
        const Work seconds = wrenches.seconds;
        bool within = true, same = true;
        gravity.times(seconds).each_drift(fall_in_halves ? N::half_of(seconds) : seconds, bodies.scale, false,
                                          [&](int i, DriftSum fall, auto) {
                                              fall = N::limited(fall, within);
                                              same = same && fall == gravity_[i];
                                              gravity_[i] = fall;
                                          });
        if (!within) bodies.report(Issue::range_left, bodies.count);
        if (!same) disturb();
        return !same;
    }

    // Call after every change of what loads depend on, unless a step made it. It voids the kicks that were kept, and
    // trees of joints are no longer at rest.
    TUMBLE_INLINE constexpr void disturb() {
        if constexpr (has_joints) joints.wake();
        if constexpr (keeps_kicks)
            if (++kept_.disturbances == 0) ++kept_.disturbances;
    }
    // Call after every change of the spin other than by free rotation.
    TUMBLE_INLINE constexpr void spin_changed([[maybe_unused]] int b) {
        if constexpr (prepares_spin())
            if (bodies.rotates(b)) inertia_[b].prepare(bodies.state[b], bodies.scale);
    }
    constexpr void spins_changed(const BodyGroup& group) {
        for (int k = 0; k < group.count; ++k) spin_changed(group.id[k]);
    }
    TUMBLE_INLINE constexpr void check_range(int b) {
        if (bodies.check_range(b, most_turn)) [[unlikely]]
            spin_changed(b);
    }
    // Change of drift by gravity in a step.
    [[nodiscard]] constexpr DriftSum whole_fall(int i) const { return whole(gravity_[i]); }

    using Inertia = typename Integrator::template Inertia<N>;
    // Trees of joints fly each part of a composition by itself.
    static constexpr bool flies_parts_alone = has_joints && requires { typename Integrator::PartAlone; };
    using PartAlone = decltype([] {
        if constexpr (flies_parts_alone) return typename Integrator::PartAlone{};
        else return Integrator{};
    }());
    using PartInertia = typename PartAlone::template Inertia<N>;
    struct PartsAlone {
        typename detail::RoomFor<PartInertia, features.bodies>::Array inertia{};
        bool is_flown = false;
    };
    void forget_kicks([[maybe_unused]] const BodyGroup& group) {
        if constexpr (keeps_kicks)
            for (int k = 0; k < group.count; ++k) kept_.of_body[group.id[k]].age = 0;
    }
    // Call for a body that no load pushes alone in this step. A load of the program may push it again in any later
    // step, and the kick that was kept is not that of its place then.
    TUMBLE_INLINE void lose_kick([[maybe_unused]] int b) {
        if constexpr (keeps_kicks && has_own_loads) kept_.of_body[b].age = 0;
    }
    // There may be bodies that turn by themselves, and tumble in free rotation.
    static constexpr bool may_tumble = rotation && features.moving_surfaces() && features.bodies > 0;
    constexpr void set_inertia(int b, const RealVec3& moments) requires rotation {
        inertia_[b] = Inertia::of(moments, bodies.scale);
        if constexpr (flies_parts_alone) alone_.inertia[b] = PartInertia::of(moments, bodies.scale);
        if constexpr (may_tumble)
            if (bodies.constants[b].fixed()) sphere_ = Inertia::of({1, 1, 1}, bodies.scale);
    }
    // True if the constants of a body's rotation depend on its spin.
    static constexpr bool prepares_spin() {
        return rotation && requires(Inertia & inertia, const Bodies& all) { inertia.prepare(all.state[0], all.scale); };
    }
    // No bounds for a method that does not name its own.
    static constexpr StepBounds step_bounds = [] {
        if constexpr (requires { Integrator::step_bounds; }) return Integrator::step_bounds;
        else return StepBounds{};
    }();
    static constexpr SpringBounds<N> spring_bounds{step_bounds};
    // rad; see Bodies::check_range. The spin of a momentum is at most twice the half turn.
    static constexpr double most_turn = requires { Integrator::follows_any_turn; }
    ? 0 : spin == Spin::angular_momentum ? 1.5 : 0.5;
    // Where sums are exact, gravity is kept and added in halves. Between the two the drift is the step's mean.
    static constexpr bool fall_in_halves = Integrator::coasting == Coasting::mean && N::fixed_point && N::carry;
    [[nodiscard]] static constexpr DriftSum whole(DriftSum f) { return fall_in_halves ? f + f : f; }

    struct KeptKicks {
        typename detail::RoomFor<KeptKick<N, rotation>, features.bodies>::Array of_body{};
        std::uint32_t disturbances = 1;  // counted; 0 is skipped
    };
    [[no_unique_address]] If<keeps_kicks, KeptKicks, 11> kept_{};
    [[no_unique_address]] If<has_loads, BodyPlaces<features.bodies>, 12> places_{};
    [[no_unique_address]] If<has_joints && may_couple, bool[(features.bodies > 0 ? features.bodies : 1)], 15>
        with_trees_{};
    DriftSum gravity_[3]{};  // change of drift a step, or half of it: see fall_in_halves

    [[no_unique_address]] Bodies bodies;
    // Behind the bodies, where it may fill the end of their last word.
    [[no_unique_address]] If<rotation, typename detail::RoomFor<Inertia, features.bodies>::Array, 1> inertia_{};
    [[no_unique_address]] If<flies_parts_alone, PartsAlone, 16> alone_{};
    [[no_unique_address]] If<may_tumble, Inertia, 13> sphere_{};  // of a fixed body that would tumble
    [[no_unique_address]] If<has_loads, Loads, 0> loads;
    [[no_unique_address]] If<has_wrenches, Wrenches<N, rotation, features.bodies>, 6> wrenches;
    [[no_unique_address]] If<has_joints, Joints, 14> joints;
};

}  // namespace tumble

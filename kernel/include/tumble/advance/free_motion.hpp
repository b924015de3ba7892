// FreeMotion<Scene>: a body that nothing touches and no load pushes. It falls by a constant acceleration and rotates
// freely, in as many parts of a step as its spin needs, between half turns by the wrenches of a program.
#pragma once

#include <tumble/advance/moving_bodies.hpp>

namespace tumble {

template <class S>
class FreeMotion : public MovingBodies<S> {
    using Base = MovingBodies<S>;

public:
    constexpr FreeMotion(Seconds step, const WorldSpec& spec) : Base{step, spec} {}
    using Base::check_range, Base::spin_changed, Base::whole;
    using Base::has_loads, Base::rotation, Base::has_wrenches, Base::fall_in_halves, Base::bodies, Base::loads,
        Base::wrenches, Base::inertia_, Base::alone_, Base::flies_parts_alone;
    using typename Base::N, typename Base::Integrator, typename Base::DriftSum, typename Base::TurnSum,
        typename Base::State, typename Base::Bodies, typename Base::BodyGroup, typename Base::Inertia,
        typename Base::PartAlone;

    void check_range(const BodyGroup& group) {
        for (int k = 0; k < group.count; ++k) {
            check_range(group.id[k]);
            check_spin_about_z(group.id[k]);
            settle(group.id[k]);
        }
    }

    // `dragged`: by linear drag, the only load.
    template <bool ends_step = false, bool dragged = false, class... Part>
    TUMBLE_INLINE void unloaded(int b, const StepInfo<N>& info, const DriftSum (&fall)[3], const Part&... part) {
        if constexpr (has_wrenches) {
            if (wrenches.act_on(b)) {
                driven<dragged>(b, info, fall, part...);
                if constexpr (ends_step) {
                    check_spin_about_z(b);
                    settle(b);
                }
                return;
            }
        }
        // The centre of mass comes last, so that the check has its numbers in registers.
        if constexpr (ends_step) rotate<true>(b, info);
        else rotate_flight(b, info);
        coast<dragged>(b, fall);
    }
    // Half of a wrench's change of the spin, a free rotation, and the other half: order 2. Its change of the drift is
    // one with gravity's.
    template <bool dragged = false, class... Part>
    void driven(int b, const StepInfo<N>& info, const DriftSum (&fall)[3], const Part&... part) requires(has_wrenches) {
        DriftSum all[3];
        for (int i = 0; i < 3; ++i) {
            const DriftSum change = over_part(wrenches.kick(b).linear[i], part...);
            all[i] = fall[i] + (fall_in_halves ? N::half(change) : change);
        }
        coast<dragged>(b, all);
        if constexpr (rotation) {
            if (!bodies.rotates(b)) return;
            half_turn_by_wrenches(b, part...);
            rotate(b, info);
            half_turn_by_wrenches(b, part...);
        }
    }
    // The change in a part of a step, with the part as the unit of time.
    template <class Sum, class... Part>
    [[nodiscard]] TUMBLE_INLINE static Sum over_part(Sum change, const Part&... part) {
        if constexpr (sizeof...(part) == 0) return change;
        else return N::part(N::part(change, part...), part...);
    }
    template <class... Part>
    void half_turn_by_wrenches(int b, const Part&... part) requires(has_wrenches&& rotation) {
        const TurnSum(&change)[3] = wrenches.kick(b).angular;
        if (change[0] == TurnSum{} && change[1] == TurnSum{} && change[2] == TurnSum{}) return;
        const int halvings = bodies.halvings_of(b);
        for (int i = 0; i < 3; ++i)
            bodies.state[b].t_b[i].add(N::halved(N::half(over_part(change[i], part...)), halvings));
        bodies.fit_parts(b);
        spin_changed(b);
    }
    // Motion under a constant acceleration, exact for methods of order two and more, and under linear drag beside it.
    template <bool dragged = false>
    TUMBLE_INLINE void coast(int b, const DriftSum (&fall)[3]) {
        State& s = bodies.state[b];
        if constexpr (dragged) {
            const auto& form = loads.drag().closed_form(b);
            for (int i = 0; i < 3; ++i) {
                const DriftSum kick = whole(fall[i]) - LoadNumbers<N>::share(N::sum(s.d_w[i]), form.share);
                N::coast(s.x_w[i], s.d_w[i], N::part(kick, form.of_way), bodies.scale);
                N::add(s.d_w[i], N::part(kick, form.of_drift));
            }
            return;
        }
        const auto axis = [&](auto& x, auto& d, DriftSum f) {
            if constexpr (Integrator::coasting == Coasting::mean && !fall_in_halves)
                N::coast(x, d, N::half(f), bodies.scale);
            if constexpr (Integrator::coasting == Coasting::start) N::coast(x, d, {}, bodies.scale);
            N::add(d, f);
            if constexpr (fall_in_halves) {
                N::coast(x, d, {}, bodies.scale);
                N::add(d, f);
            }
            if constexpr (Integrator::coasting == Coasting::end) N::coast(x, d, {}, bodies.scale);
        };
        axis(s.x_w.x, s.d_w.x, fall[0]);
        axis(s.x_w.y, s.d_w.y, fall[1]);
        axis(s.x_w.z, s.d_w.z, fall[2]);
    }
    // Free rotation, in as many parts as the spin has halvings.
    template <bool ends_step = false>
    TUMBLE_INLINE void rotate([[maybe_unused]] int b, [[maybe_unused]] const StepInfo<N>& info) {
        if constexpr (rotation) {
            if (!bodies.rotates(b)) return;
            if constexpr (Bodies::has_parts) {
                for (;;) {
                    rotate_once(b, info);
                    if (bodies.parts.halvings[b] == 0) [[likely]]
                        return;
                    if (!has_part_left(b, ends_step)) return;
                }
            } else {
                rotate_once(b, info);
            }
        }
    }
    // Of flights, which share the code.
    [[gnu::noinline]] void rotate_flight(int b, const StepInfo<N>& info) { rotate(b, info); }
    TUMBLE_INLINE void rotate_once(int b, const StepInfo<N>& info) requires(rotation) {
        const auto run = [&] {
            if constexpr (flies_parts_alone)
                if (alone_.is_flown) return PartAlone::template rotate<N>(bodies.state[b], alone_.inertia[b], info);
            if constexpr (has_loads && requires { Integrator::template rotate_called<N>; })
                return Integrator::template rotate_called<N>(bodies.state[b], inertia_[b], info);
            else return Integrator::template rotate<N>(bodies.state[b], inertia_[b], info);
        };
        if constexpr (std::is_void_v<decltype(run())>) {
            run();
        } else if constexpr (std::is_same_v<decltype(run()), Turned>) {
            const Turned turned = run();
            if (turned == Turned::not_converged) bodies.report(Issue::step_bound_hit, b);
            if (turned == Turned::too_far) [[unlikely]]
                turn_less(b);
        } else {
            if (!run()) bodies.report(Issue::step_bound_hit, b);
        }
    }
    // The part that a method could not follow is done again in two, if there may be more parts. Else the spin about z
    // is out of its range.
    [[gnu::noinline, gnu::cold]] void turn_less(int b) {
        if constexpr (Bodies::has_parts)
            if (bodies.repeat_part(b)) return spin_changed(b);
        if constexpr (has_z_room) hold_spin_about_z(b);
    }
    // About z, its axis of the smallest moment, a slender body turns many times as fast as about y with the same
    // momentum. A spin about z that the rotation does not follow gets shorter parts, here or in the rotation. Where
    // there are none, it is held and reported.
    static constexpr bool has_z_room = rotation && N::fixed_point && requires(const Inertia& inertia) {
        inertia.z_room();
    };
    TUMBLE_INLINE void shorten_parts_about_z([[maybe_unused]] int b) {
        if constexpr (has_z_room && Bodies::has_parts)
            while (!has_room_about_z(b) && bodies.halve_parts(b)) [[unlikely]] spin_changed(b);
    }
    TUMBLE_INLINE void check_spin_about_z([[maybe_unused]] int b) {
        if constexpr (has_z_room)
            if (!has_room_about_z(b)) [[unlikely]]
                hold_spin_about_z(b);
    }
    [[nodiscard]] TUMBLE_INLINE bool has_room_about_z([[maybe_unused]] int b) const {
        if constexpr (has_z_room) return N::has_room(bodies.state[b].t_b.z, inertia_[b].z_room());
        else return true;
    }
    [[gnu::noinline, gnu::cold]] void hold_spin_about_z(int b) requires has_z_room {
        if constexpr (Bodies::has_parts)
            if (bodies.parts.halvings[b] < bodies.scale.most_halvings) return;
        N::clamp(bodies.state[b].t_b.z, inertia_[b].z_room());
        bodies.report(Issue::range_left, b);
        spin_changed(b);
    }
    // Counts a part. The spin may have left its range in it.
    [[gnu::noinline]] bool has_part_left(int b, bool ends_step) requires(Bodies::has_parts) {
        const int before = bodies.halvings_of(b);
        const bool left = bodies.end_part(b);
        if (bodies.halvings_of(b) != before) spin_changed(b);
        if (!left && ends_step) settle(b);
        return left;
    }
    // Gives a spin that has become slow longer parts again. At the end of a step.
    TUMBLE_INLINE void settle([[maybe_unused]] int b) {
        if constexpr (Bodies::has_parts)
            if (bodies.parts.halvings[b] != 0) [[unlikely]]
                settle_parts(b);
    }
    [[gnu::noinline, gnu::cold]] void settle_parts(int b) requires(Bodies::has_parts) {
        int z_room = 0;
        if constexpr (requires { inertia_[b].z_room(); }) z_room = inertia_[b].z_room();
        if (bodies.settle_parts(b, z_room)) spin_changed(b);
    }
};

}  // namespace tumble

// LoadedMotion<Scene>: bodies that loads push, alone or coupled, by the stages of the method. A body that linear drag
// alone slows down moves by its closed form.
#pragma once

#include <tumble/advance/kinematic_motion.hpp>

namespace tumble {

template <class S>
class LoadedMotion : public KinematicMotion<S> {
    using Base = KinematicMotion<S>;

public:
    constexpr LoadedMotion(Seconds step, const WorldSpec& spec) : Base{step, spec} {}
    using Base::features, Base::has_loads, Base::rotation, Base::has_wrenches, Base::keeps_kicks, Base::spin,
        Base::bodies, Base::loads, Base::wrenches, Base::inertia_, Base::alone_, Base::flies_parts_alone, Base::kept_,
        Base::places_;
    using Base::half_turn_by_wrenches, Base::lose_kick, Base::over_part, Base::rotate, Base::spins_changed,
        Base::unloaded, Base::whole;
    using typename Base::N, typename Base::Integrator, typename Base::Work, typename Base::DriftSum,
        typename Base::Bodies, typename Base::BodyGroup, typename Base::Inertia, typename Base::PartAlone,
        typename Base::PartInertia;

    // True of a body that feels anything but gravity in this step, at stages or as a constant change.
    [[nodiscard]] bool is_driven(int b) const {
        if constexpr (has_wrenches)
            if (wrenches.act_on(b)) return true;
        return is_loaded(b);
    }
    // Adds the change of motion by wrenches in a step.
    void add_wrenches(int b, Kick<N>& kick) const requires(has_wrenches) {
        if (!wrenches.act_on(b)) return;
        for (int i = 0; i < 3; ++i) {
            kick.linear[i] += wrenches.kick(b).linear[i];
            if constexpr (rotation) kick.angular[i] += wrenches.kick(b).angular[i];
        }
    }
    // True of a body that feels a load, which is evaluated at stages.
    [[nodiscard]] bool is_loaded([[maybe_unused]] int b) const {
        if constexpr (has_loads) return loads.is_loaded(bodies, b);
        else return false;
    }
    // True of a body that feels another moving body.
    [[nodiscard]] bool is_coupled([[maybe_unused]] int b) const {
        if constexpr (has_loads) return loads.is_coupled(bodies, b);
        else return false;
    }
    // True of a group in which a load connects a body to a fixed or kinematic one that moves by itself: the load
    // changes though nothing happens to the group.
    [[nodiscard]] bool has_moving_end([[maybe_unused]] const BodyGroup& group) const {
        bool any = false;
        if constexpr (has_loads && features.moving_surfaces())
            for (int k = 0; k < group.count; ++k)
                loads.for_each_coupled(bodies, group.id[k], [&](int end) { any = any || changes_loads(end); });
        return any;
    }

    // Moves the bodies over a part of a step of this length, in steps. State and `fall` have it as the unit of time.
    // `keeps`: nothing changes the motion of the bodies until their next step. `part` is the length again, of a part
    // that is not the whole step.
    template <class... Part>
    [[gnu::noinline]] void over(const BodyGroup& group, const StepInfo<N>& info, const DriftSum (&fall)[3], Work length,
                                [[maybe_unused]] bool keeps, const Part&... part) {
        if constexpr (has_loads) {
            BodyGroup coupled;
            for (int k = 0; k < group.count; ++k) {
                const int b = group.id[k];
                if (!is_coupled(b)) {
                    one(b, info, fall, length, keeps, part...);
                    continue;
                }
                lose_kick(b);
                coupled.add(b);
            }
            if (coupled.count > 0) loaded(coupled, info, fall, length, true, false, part...);
        } else {
            for (int k = 0; k < group.count; ++k) unloaded(group.id[k], info, fall, part...);
        }
    }
    template <class... Part>
    void one(int b, const StepInfo<N>& info, const DriftSum (&fall)[3], Work length, bool keeps,
             const Part&... part) requires has_loads {
        if (is_loaded(b)) {
            if constexpr (drags_in_closed_form && sizeof...(part) == 0)
                if (length == Work(1) && is_dragged_alone(b)) {
                    lose_kick(b);
                    return this->template unloaded<false, true>(b, info, fall);
                }
            return loaded(BodyGroup{b}, info, fall, length, false, keeps, part...);
        }
        lose_kick(b);
        unloaded(b, info, fall, part...);
    }
    static constexpr bool drags_in_closed_form = features.drag && Integrator::order >= 2;
    // True of a body of which linear drag is the only load, and which moves by its closed form.
    [[nodiscard]] TUMBLE_INLINE bool is_dragged_alone([[maybe_unused]] int b) const {
        if constexpr (drags_in_closed_form)
            return loads.drag().closed_form(b).exists && loads.is_only_dragged(bodies, b);
        else return false;
    }

private:
    // True of a fixed or kinematic body that moves by itself a point at which a load acts.
    [[nodiscard]] bool changes_loads(int b) const requires(has_loads) {
        const bool is_kinematic = bodies.constants[b].kinematic();
        if (is_kinematic && bodies.is_drifting(b)) return true;
        if constexpr (rotation)
            return bodies.constants[b].fixed() && (is_kinematic || features.turntables) && bodies.is_turning(b) &&
                   loads.is_turned(bodies, b);
        return false;
    }
    // True of a body whose velocity a wrench changes between the kick that ends a step and the next one, if that
    // matters.
    [[nodiscard]] bool is_pushed_between_kicks([[maybe_unused]] int b, [[maybe_unused]] const auto& evaluate) const {
        if constexpr (has_wrenches) return wrenches.act_on(b) && evaluate.depends_on_velocity();
        else return false;
    }
    // Of bodies that loads act on too.
    template <class... Part>
    void half_kick_by_wrenches(const BodyGroup& group, const Part&... part) requires(has_wrenches) {
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            if (!wrenches.act_on(b)) continue;
            for (int i = 0; i < 3; ++i)
                N::add(bodies.state[b].d_w[i], N::half(over_part(wrenches.kick(b).linear[i], part...)));
            if constexpr (rotation)
                if (bodies.rotates(b)) half_turn_by_wrenches(b, part...);
        }
    }
    // Bodies that loads act on: one body, or bodies that they couple.
    template <class... Part>
    void loaded(const BodyGroup& group, const StepInfo<N>& info, const DriftSum (&fall)[3], Work length, bool coupled,
                [[maybe_unused]] bool keeps, const Part&... part) requires has_loads {
        if constexpr (has_wrenches) half_kick_by_wrenches(group, part...);
        const DriftSum falls[3]{whole(fall[0]), whole(fall[1]), whole(fall[2])};
        const bool turned = is_turned(group);
        if (features.bodies == 1 || !coupled) {
            auto evaluate =
                with_joints(loads.template evaluation<true>(bodies, group, length, falls, turned), group, length);
            if constexpr (keeps_kicks) {
                if (keeps && !is_pushed_between_kicks(group.id[0], evaluate))
                    evaluate.kept = &kept_.of_body[group.id[0]];
                else kept_.of_body[group.id[0]].age = 0;
                evaluate.age = kept_.disturbances;
            }
            staged<1>(group, evaluate, info);
        } else if constexpr (features.bodies > 1) {
            staged<features.bodies>(
                group,
                with_joints(loads.template evaluation<false>(bodies, group, length, falls, turned, places_.of(group)),
                            group, length),
                info);
        }
        if constexpr (has_wrenches) half_kick_by_wrenches(group, part...);
    }
    // The loads of jointed bodies. A flight begins and ends with half a kick by the joints, which the bodies have at
    // once and which is not their velocity: loads see that of before the first and, as far as it is known, that of
    // after the second. Else a damper would push against what the joint does, and the joint against that. The second is
    // a guess, so such a flight is not symmetric: compositions of order four need those that see the half kicks.
    template <class Evaluate>
    struct AcrossJoints : Evaluate {
        const typename Base::Joints& joints;
        const BodyGroup& group;
        Work length;  // of the flight, in steps

        template <class Stage>
        void correct_velocities(Stage* state, bool ends) const {
            if (!this->depends_on_velocity()) return;
            for (int k = 0; k < group.count; ++k) {
                const Kick<N>* const kick = joints.kick_of(group.id[k]);
                if (kick == nullptr) continue;
                const Work part = ends ? length : -length;
                for (int i = 0; i < 3; ++i) {
                    state[k].d_w[i] +=
                        N::drift_sum(N::metres(kick->linear[i], this->bodies.scale) * part, this->bodies.scale);
                    state[k].t_b[i] += N::narrow_turn(N::turn_sum(
                        N::half_turn(kick->angular[i], this->bodies.finest_scale()) * part, this->bodies.scale));
                }
            }
        }
    };
    template <class Evaluate>
    [[nodiscard]] TUMBLE_INLINE auto with_joints(const Evaluate& evaluate, [[maybe_unused]] const BodyGroup& group,
                                                 [[maybe_unused]] Work length) const {
        if constexpr (Base::has_joints && Integrator::order <= 2)
            return AcrossJoints<Evaluate>{evaluate, this->joints, group, length};
        else return evaluate;
    }
    // Whether the method steps bodies whose rotation the loads neither change nor ask for as it steps point masses.
    static constexpr bool translates =
        requires(const Translations<N, spin, 1>& group, const detail::NoLoads<N>& loads, const StepInfo<N>& info) {
        Integrator::template advance<N, 1>(group, loads, info);
    };
    template <int capacity, class Constants>
    using Staged = std::conditional_t<rotation, Group<N, spin, Constants, capacity, features.mixed() || translates>,
                                      Translations<N, spin, capacity>>;
    template <int capacity, class Evaluate>
    void staged(const BodyGroup& ids, const Evaluate& evaluate, const StepInfo<N>& info) {
        if constexpr (flies_parts_alone)
            if (alone_.is_flown) return staged<PartAlone, PartInertia, capacity>(ids, evaluate, info, alone_.inertia);
        staged<Integrator, Inertia, capacity>(ids, evaluate, info, inertia_);
    }
    // Bodies that the loads do not turn rotate freely, and the loads move their centres of mass.
    template <class Method, class Constants, int capacity, class Evaluate>
    void staged(const BodyGroup& ids, const Evaluate& evaluate, const StepInfo<N>& info, auto& inertia) {
        Staged<capacity, Constants> group;
        group.set_count(ids.count);
        for (int k = 0; k < ids.count; ++k) {
            const int b = ids.id[k];
            group.body[k] = &bodies.state[b];
            if constexpr (rotation) {
                if (!evaluate.turned) rotate(b, info);
                else if (bodies.rotates(b)) group.inertia[k] = &inertia[b];
            }
        }
        if (!Method::template advance<N, capacity>(group, evaluate, info))
            bodies.report(Issue::step_bound_hit, ids.id[0]);
        if constexpr (rotation) {
            if constexpr (Bodies::has_parts)
                if (group.too_fast >= 0) [[unlikely]]
                    bodies.report(Issue::range_left, ids.id[group.too_fast]);
            if (evaluate.turned) spins_changed(ids);
        }
    }
    // True of a group that the method turns stage by stage.
    [[nodiscard]] bool is_turned([[maybe_unused]] const BodyGroup& ids) const {
        if constexpr (!rotation) return false;
        if constexpr (!translates) return true;
        for (int k = 0; k < ids.count; ++k)
            if (loads.is_turned(bodies, ids.id[k])) return true;
        return false;
    }
};

}  // namespace tumble

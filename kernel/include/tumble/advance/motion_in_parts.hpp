// MotionInParts<Scene>: parts of a step. Contacts and joints ask for a portion of it, and spins too fast for their
// format for 2^n parts of a portion. A part is a step of its own with a shorter unit of time.
#pragma once

#include <tumble/advance/loaded_motion.hpp>
#include <tumble/body/state_in_unit.hpp>

namespace tumble {

template <class S>
class MotionInParts : public LoadedMotion<S> {
    using Base = LoadedMotion<S>;

public:
    using Base::add_wrenches, Base::check_range, Base::check_spin_about_z, Base::forget_kicks, Base::has_room_about_z,
        Base::is_coupled, Base::is_dragged_alone, Base::is_driven, Base::is_loaded, Base::one, Base::over,
        Base::rotate_flight, Base::settle, Base::shorten_parts_about_z, Base::spin_changed, Base::spins_changed,
        Base::whole_fall;
    constexpr MotionInParts(Seconds step, const WorldSpec& spec) : Base{step, spec} {}
    using Base::features, Base::has_loads, Base::rotation, Base::has_wrenches, Base::spin, Base::bodies, Base::loads,
        Base::places_, Base::gravity_;
    using typename Base::N, typename Base::Integrator, typename Base::Work, typename Base::DriftSum,
        typename Base::State, typename Base::Bodies, typename Base::BodyGroup, typename Base::Portion;

    // A step of a body that loads do not couple to another.
    void alone(int b, const StepInfo<N>& info) requires has_loads {
        const BodyGroup group{b};
        if (moved_in_parts(group, info, Work(1))) forget_kicks(group);
        else one(b, info, gravity_, Work(1), true);
        check_range(b);
        check_spin_about_z(b);
        settle(b);
    }
    // A step of one body, or of bodies that loads couple.
    void group(const BodyGroup& group, const StepInfo<N>& info) {
        if (moved_in_parts(group, info, Work(1))) forget_kicks(group);
        else over(group, info, gravity_, Work(1), true);
        check_range(group);
    }
    // A portion of a step, of bodies that are not fixed. It does not check their range. Contacts may change the motion
    // after it.
    void portion(const BodyGroup& group, const StepInfo<N>& info, const Portion& portion) {
        forget_kicks(group);
        if (moved_in_parts(group, info, portion.length)) return;
        if (portion.whole) {
            over(group, info, gravity_, Work(1), false);
            return;
        }
        BodyGroup driven;
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            if (is_driven(b) || is_coupled(b)) driven.add(b);
            else free_part(b, info, portion.length);
        }
        if constexpr (has_loads || has_wrenches)
            if (driven.count > 0) part_of_step(driven, info, portion.length);
    }
    // Writes the change of motion by gravity and by the loads, at their present strength, over the whole step.
    template <class Marks, class Kicks>
    void foresee(const BodyGroup& group, const Marks& marks, Kicks& kick_of) {
        forget_kicks(group);
        const DriftSum fall[3]{whole_fall(0), whole_fall(1), whole_fall(2)};
        BodyGroup loaded;
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            Kick<N>& kick = kick_of[b];
            kick = {};
            for (int i = 0; i < 3; ++i) kick.linear[i] = fall[i];
            if (marks[b].loaded) {
                loaded.add(b);
            } else if constexpr (has_wrenches) {
                add_wrenches(b, kick);
                kick_of.rescale(b, bodies.halvings_of(b));
            }
        }
        if constexpr (has_loads) {
            if (loaded.count == 0) return;
            StageState<N> stages[features.bodies];
            Kick<N> kicks[features.bodies];
            for (int k = 0; k < loaded.count; ++k) stages[k] = stage_of(bodies.state[loaded.id[k]]);
            const std::int16_t* const places = places_.of(loaded);
            if (!foresee_in_parts(loaded, places, stages, kicks))
                loads.template evaluation<false>(bodies, loaded, Work(1), fall, true, places)(stages, kicks);
            for (int k = 0; k < loaded.count; ++k) {
                kick_of[loaded.id[k]] = kicks[k];
                if constexpr (has_wrenches) add_wrenches(loaded.id[k], kick_of[loaded.id[k]]);
                kick_of.rescale(loaded.id[k], bodies.halvings_of(loaded.id[k]));
            }
        }
    }

private:
    // The most halvings of a spin in a group in which loads act at stages on a body with such a spin, else 0. `whole`:
    // over a whole step.
    [[nodiscard]] int halvings_under_loads(const BodyGroup& group, bool whole) const
        requires(has_loads&& Bodies::has_parts) {
        int most = 0;
        bool loaded = false;
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            if (bodies.parts.halvings[b] == 0) continue;
            loaded = loaded || (is_loaded(b) && !(whole && is_dragged_alone(b)));
            if (bodies.parts.halvings[b] > most) most = bodies.parts.halvings[b];
        }
        return loaded ? most : 0;
    }
    // Moves bodies whose spins have halvings under loads; false of others.
    TUMBLE_INLINE bool moved_in_parts([[maybe_unused]] const BodyGroup& group, [[maybe_unused]] const StepInfo<N>& info,
                                      [[maybe_unused]] Work length) {
        if constexpr (has_loads && Bodies::has_parts) {
            // A spin that no load changes gets its parts where it turns, as in a world without loads.
            for (int k = 0; k < group.count; ++k)
                if (const int b = group.id[k]; !has_room_about_z(b) && is_loaded(b)) [[unlikely]]
                    shorten_parts_about_z(b);
            if (const int halvings = halvings_under_loads(group, length == Work(1)); halvings > 0) [[unlikely]] {
                portion_in_parts(group, info, length, halvings);
                return true;
            }
        }
        return false;
    }
    // A portion of a step of bodies under loads, in 2^halvings parts: in each of them the spins have their usual scale.
    [[gnu::noinline]] void portion_in_parts(const BodyGroup& group, const StepInfo<N>& info, Work length,
                                            int halvings) requires(has_loads&& Bodies::has_parts) {
        for (int part = 0; part < 1 << halvings; ++part) {
            for (int k = 0; k < group.count; ++k) {
                const int b = group.id[k];
                for (; bodies.parts.halvings[b] < halvings; ++bodies.parts.halvings[b]) N::halve(bodies.state[b].t_b);
                bodies.parts.halvings[b] = 0;
            }
            part_of_step(group, info, N::times_power_of_two(length, -halvings), halvings);
            int most = halvings;
            for (int k = 0; k < group.count; ++k) {
                const int b = group.id[k];
                bodies.set_halvings(b, bodies.parts.halvings[b] + halvings);
                (void)bodies.check_range(b);
                if (bodies.parts.halvings[b] > most) most = bodies.parts.halvings[b];
            }
            for (; halvings < most; ++halvings) part = 2 * part + 1;
        }
    }
    // Where a spin has halvings, the loads act over the shortest part. The kicks are then those over the whole step
    // again. False where none has.
    template <class Stage, class Kick>
    bool foresee_in_parts([[maybe_unused]] const BodyGroup& loaded, [[maybe_unused]] const std::int16_t* places,
                          [[maybe_unused]] Stage* stages, [[maybe_unused]] Kick* kicks) requires has_loads {
        if constexpr (Bodies::has_parts) {
            const int most = halvings_under_loads(loaded, false);
            if (most == 0) [[likely]]
                return false;
            DriftSum part_of_fall[3];
            for (int i = 0; i < 3; ++i) {
                part_of_fall[i] = {whole_fall(i).raw >> 2 * most};
                for (int k = 0; k < loaded.count; ++k) {
                    stages[k].d_w[i].raw >>= most;
                    stages[k].t_b[i].raw >>= most - bodies.parts.halvings[loaded.id[k]];
                }
            }
            loads.template evaluation<false>(bodies, loaded, N::times_power_of_two(Work(1), -most), part_of_fall, true,
                                             places)(stages, kicks);
            const auto of_step = [&](Work change) { return N::times_power_of_two(change, 2 * most); };
            for (int k = 0; k < loaded.count; ++k) {
                for (int i = 0; i < 3; ++i) {
                    auto& [linear, angular] = kicks[k];
                    linear[i] = N::drift_sum(of_step(N::metres(linear[i], bodies.scale)), bodies.scale);
                    angular[i] = N::turn_sum(of_step(N::half_turn(angular[i], bodies.scale)), bodies.scale);
                }
            }
            return true;
        }
        return false;
    }

    // A part of a step of a body that gravity alone moves. Its drift, and a spin that is the angular momentum, follow
    // without a division by the part.
    [[gnu::noinline, gnu::cold]] void free_part(int b, [[maybe_unused]] const StepInfo<N>& info, Work length) {
        State& s = bodies.state[b];
        const auto part = N::fraction(length);
        const auto move = [&](auto& x, auto& d, DriftSum whole) __attribute__((noinline)) {
            const DriftSum fall = N::part(whole, part);
            DriftSum mean = N::sum(d);
            if constexpr (Integrator::coasting == Coasting::mean) mean += N::half(fall);
            if constexpr (Integrator::coasting == Coasting::end) mean += fall;
            N::move(x, N::part(mean, part), bodies.scale);
            N::add(d, fall);
        };
        move(s.x_w.x, s.d_w.x, whole_fall(0));
        move(s.x_w.y, s.d_w.y, whole_fall(1));
        move(s.x_w.z, s.d_w.z, whole_fall(2));
        if constexpr (rotation)
            if (bodies.rotates(b)) rotate_in_part(b, info, length);
    }
    // The spin shrinks to the part, so that the method's code for a step turns the body.
    void rotate_in_part(int b, const StepInfo<N>& info, Work length) requires(rotation) {
        StateInUnit<Bodies> unit;
        const auto from = bodies.state[b].q_wb.value();
        unit.shrink_spin(bodies, b, N::fraction(length));
        spin_changed(b);
        rotate_flight(b, info);
        if constexpr (spin == Spin::angular_momentum) unit.restore_momentum(bodies, b, from);
        else unit.restore_spin(bodies, b, [&](Work change) { return change / length; });
        spin_changed(b);
    }
    // A part of a step of bodies under loads, with the part as the unit of time: accelerations shrink with its square.
    // The spin is already in half turns of 2^-halvings of the step.
    void part_of_step(const BodyGroup& group, const StepInfo<N>& info, Work length, int halvings = 0) {
        const auto part = N::fraction(length);
        const Work inverse = Work(1) / length;
        [[maybe_unused]] const Work spin_length = N::times_power_of_two(length, halvings),
                                    spin_inverse = N::times_power_of_two(inverse, -halvings);
        StateInUnit<Bodies> unit[features.bodies];
        for (int k = 0; k < group.count; ++k) {
            unit[k].shrink_drift(bodies, group.id[k], part);
            if constexpr (rotation)
                unit[k].shrink_spin(bodies, group.id[k], N::fraction(spin_length),
                                    halvings == 0 || spin_length < Work(1));
        }
        spins_changed(group);

        DriftSum fall[3];
        for (int i = 0; i < 3; ++i) fall[i] = N::part(N::part(gravity_[i], part), part);
        if constexpr (has_wrenches) over(group, info, fall, length, false, part);
        else over(group, info, fall, length, false);

        for (int k = 0; k < group.count; ++k) {
            unit[k].restore_drift(bodies, group.id[k], inverse);
            if constexpr (rotation)
                unit[k].restore_spin(bodies, group.id[k], [&](Work change) { return change * spin_inverse; });
        }
        spins_changed(group);
    }
};

}  // namespace tumble

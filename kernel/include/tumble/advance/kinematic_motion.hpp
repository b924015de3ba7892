// KinematicMotion<Scene>: fixed bodies that turn, and kinematic bodies, which move as their velocity says.
#pragma once

#include <tumble/advance/free_motion.hpp>
#include <tumble/body/state_in_unit.hpp>

namespace tumble {

template <class S>
class KinematicMotion : public FreeMotion<S> {
    using Base = FreeMotion<S>;

public:
    constexpr KinematicMotion(Seconds step, const WorldSpec& spec) : Base{step, spec} {}
    using Base::check_range, Base::check_spin_about_z, Base::disturb, Base::lose_kick, Base::rotate, Base::settle,
        Base::shorten_parts_about_z, Base::spin_changed, Base::unloaded;
    using Base::features, Base::rotation, Base::spin, Base::may_tumble, Base::bodies, Base::inertia_, Base::sphere_,
        Base::gravity_;
    using typename Base::N, typename Base::Work, typename Base::DriftSum, typename Base::TurnSum, typename Base::State,
        typename Base::Bodies, typename Base::BodyGroup, typename Base::Inertia;

    // A step of a body that feels gravity alone.
    TUMBLE_INLINE void free_body(int b, const StepInfo<N>& info) {
        if (bodies.constants[b].fixed()) return step_fixed(b, info);
        lose_kick(b);
        this->template unloaded<true>(b, info, gravity_);
        check_range(b);
    }
    // A step of a fixed body that nothing feels.
    TUMBLE_INLINE void step_fixed(int b, const StepInfo<N>& info) {
        step_turntable(b, info);
        if constexpr (features.kinematic)
            if (bodies.constants[b].kinematic()) step_kinematic(b, info);
    }
    // A step of a fixed body, which may turn where there are turntables. Kinematic bodies stay.
    TUMBLE_INLINE void step_turntable([[maybe_unused]] int b, [[maybe_unused]] const StepInfo<N>& info) {
        if constexpr (features.turntables && rotation)
            if (bodies.is_turning(b) && !bodies.constants[b].kinematic()) {
                turn_steadily<true>(b, info);
                check_range(b);
                disturb();
            }
    }

    // The kinematic bodies that move in a step, and how they move at its start.
    struct MovingKinematics {
        BodyGroup group;
        SavedMotions<Bodies> start;
    };
    using Kinematics = If<features.kinematic, MovingKinematics, 0>;
    // Begins a step: notes the kinematic bodies that move. Loads feel them where they are halfway.
    void begin([[maybe_unused]] Kinematics& kinematic, [[maybe_unused]] const StepInfo<N>& info) {
        if constexpr (features.kinematic) {
            note_moving(kinematic);
            place(kinematic, info, N::half_of(Work(1)));
        }
    }
    void note_moving(Kinematics& kinematic) const requires(features.kinematic) {
        for (int b = 0; b < bodies.count; ++b) {
            if (!bodies.moves_by_itself(b)) continue;
            kinematic.start.save(kinematic.group.count, bodies, b);
            kinematic.group.add(b);
        }
    }
    // Places them where they are at this part of the step. Their velocities are those in a part of length `unit`.
    void place(const Kinematics& kinematic, const StepInfo<N>& info, Work time,
               Work unit = Work(1)) requires(features.kinematic) {
        for (int k = 0; k < kinematic.group.count; ++k) {
            const int b = kinematic.group.id[k];
            kinematic.start.restore(k, bodies, b);
            if (time > Work(0)) {
                shorten(b, time);
                coast_by_itself(b, info);
                const State there = bodies.state[b];
                kinematic.start.restore(k, bodies, b);
                bodies.state[b].x_w = there.x_w;
                if constexpr (rotation) bodies.state[b].q_wb = there.q_wb;
            }
            shorten(b, unit);
        }
    }
    // Ends the step.
    void end([[maybe_unused]] const Kinematics& kinematic, [[maybe_unused]] const StepInfo<N>& info) {
        if constexpr (features.kinematic) {
            place(kinematic, info, Work(0));
            for (int k = 0; k < kinematic.group.count; ++k) step_kinematic(kinematic.group.id[k], info);
        }
    }

private:
    // The motion of a body in a part of the step as that in a whole one.
    void shorten(int b, Work length) requires(features.kinematic) {
        if (length == Work(1)) return;
        const auto part = N::fraction(length);
        for (int i = 0; i < 3; ++i) {
            StateInUnit<Bodies>::shrink(bodies.state[b].d_w[i], part);
            if constexpr (rotation)
                if (bodies.rotates(b)) StateInUnit<Bodies>::shrink(bodies.state[b].t_b[i], part);
        }
        spin_changed(b);
    }
    // A step of a kinematic body.
    [[gnu::noinline]] void step_kinematic(int b, const StepInfo<N>& info) requires(features.kinematic) {
        spin_changed(b);  // in a world where it was placed within the step, and so in all others
        coast_by_itself<true>(b, info);
        check_range(b);
        disturb();
    }
    template <bool ends_step = false>
    void coast_by_itself(int b, const StepInfo<N>& info) requires(features.kinematic) {
        turn_steadily<ends_step>(b, info);
        State& s = bodies.state[b];
        for (int i = 0; i < 3; ++i) N::coast(s.x_w[i], s.d_w[i], DriftSum{}, bodies.scale);
    }
    // Rotation of a fixed or kinematic body: steadily about the axis of its spin, whatever its moments.
    template <bool ends_step = false>
    void turn_steadily(int b, const StepInfo<N>& info) {
        if constexpr (may_tumble)
            if (tumbles(b)) return turn_as_a_sphere<ends_step>(b, info);
        this->template rotate<ends_step>(b, info);
    }
    // True of a spin that changes in free rotation: it has components of different moments. Those that rounding leaves
    // beside a principal axis do not count.
    [[nodiscard]] bool tumbles(int b) const requires may_tumble {
        if (!bodies.rotates(b)) return false;
        int components = 0;
        for (int i = 0; i < 3; ++i) components += N::sum(bodies.state[b].t_b[i]) == TurnSum{} ? 0 : 1;
        return components > 1 && has_different_moments(b);
    }
    [[nodiscard, gnu::noinline]] bool has_different_moments(int b) const requires may_tumble {
        const auto& units = bodies.constants[b].units;
        Work turn[3], most(0), first(0);
        for (int i = 0; i < 3; ++i) {
            turn[i] = magnitude_of(bodies.turn(b, i));
            if (turn[i] > most) most = turn[i];
        }
        for (int i = 0; i < 3; ++i) {
            if (!(turn[i] > most * N::rounding_unit())) continue;
            const Work rate = units.per_half_turn(i);
            // The units of an angular velocity do not depend on the moments. A body of equal moments turns as a sphere.
            if (first > Work(0) && (units.has_one_rate || !(rate == first))) return true;
            first = rate;
        }
        return false;
    }
    // A sphere turns steadily. Its spin is its angular velocity. The body has its own spin again afterwards.
    template <bool ends_step>
    [[gnu::noinline]] void turn_as_a_sphere(int b, const StepInfo<N>& info) requires may_tumble {
        State& s = bodies.state[b];
        shorten_parts_about_z(b);
        check_spin_about_z(b);
        [[maybe_unused]] const auto spin_before = s.t_b;
        [[maybe_unused]] const int halvings = bodies.halvings_of(b);
        const Inertia own = inertia_[b];
        inertia_[b] = sphere_;
        if constexpr (spin == Spin::angular_momentum) {
            for (int i = 0; i < 3; ++i) {
                const Work half_turn = N::half_of(bodies.turn(b, i));
                s.t_b[i] = {};
                N::add_any(s.t_b[i], half_turn, bodies.spin_scale(b));
            }
            (void)bodies.check_range(b);
            spin_changed(b);
        }
        rotate(b, info);
        inertia_[b] = own;
        if constexpr (spin == Spin::angular_momentum) {
            s.t_b = spin_before;
            bodies.to_scale_of(b, s.t_b, halvings);
            spin_changed(b);
        }
        if constexpr (ends_step) settle(b);
    }
};

}  // namespace tumble

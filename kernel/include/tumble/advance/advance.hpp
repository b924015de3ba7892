// Advance<Scene> moves bodies over a step or a part of it with the scene's method: freely, under loads, in trees of
// joints, or fixed in their place. It owns the bodies, their inertia, the loads and gravity. It knows no contact.
#pragma once

#include <tumble/advance/tree_motion.hpp>
#include <tumble/events/snapshot.hpp>
#include <tumble/solver/marks.hpp>

namespace tumble {

template <class S>
class Advance : TreeMotion<S> {
    using Base = TreeMotion<S>;
    using Base::features, Base::rotation, Base::keeps_kicks, Base::step_bounds, Base::spring_bounds, Base::gravity_;
    using Base::foresee, Base::is_driven, Base::is_loaded, Base::keep_joint_springs, Base::prepares_spin,
        Base::set_inertia;
    using typename Base::N, typename Base::Work, typename Base::DriftSum, typename Base::Loads, typename Base::Joints;

public:
    // What contacts and World ask for.
    using Base::add, Base::break_joint, Base::remove_joint, Base::set_gravity, Base::whole_fall;
    constexpr Advance(Seconds step, const WorldSpec& spec) : Base{step, spec} {}
    using Base::begin, Base::end, Base::note_moving, Base::place, Base::step_turntable, Base::free_body, Base::alone,
        Base::group, Base::portion, Base::step_trees;
    using Base::bodies, Base::loads, Base::wrenches, Base::joints, Base::spin, Base::has_loads, Base::has_own_loads,
        Base::has_wrenches, Base::has_joints, Base::may_couple;
    using Base::check_range, Base::disturb, Base::spin_changed, Base::spins_changed;
    using Base::find_bodies_of_trees, Base::has_moving_end, Base::is_coupled, Base::steps_with_trees,
        Base::touches_with_coupled;
    using typename Base::Integrator, typename Base::State, typename Base::Bodies, typename Base::BodyGroup,
        typename Base::Kinematics, typename Base::Pieces;

    // Adds a body at a place, which is free: the end or one that a body has left.
    constexpr void add(const BodySpec& spec, const PrincipalInertia& inertia, int b) {
        bodies.add(spec, inertia, b);
        if constexpr (rotation)
            if (bodies.rotates(b)) set_inertia(b, inertia.moments);
        spin_changed(b);
        disturb();
        if constexpr (has_loads) loads.set_body(b, spec, inertia, bodies);
        if constexpr (features.drag)
            if (!spec.is_fixed() &&
                loads.drag().is_too_strong(spec, inertia, bodies.rotates(b), step_bounds.of_damper[1]))
                bodies.report(Issue::step_too_long, b);
    }
    // Leaves a place without a body, and removes its springs.
    void remove(int b) {
        disturb();
        bodies.remove(b);
        if constexpr (has_loads) loads.remove(b, bodies);
        if constexpr (has_wrenches) wrenches.forget(b);
        if constexpr (has_joints) joints.remove_from(b, bodies);
        keep_joint_springs();
    }
    // Adds a spring; false when there is no room.
    constexpr bool add(const SpringSpec& spec) requires(features.springs > 0) {
        disturb();
        return loads.add(spec, bodies, spring_bounds);
    }
    // Writes or reads what a snapshot of a whole world holds.
    template <class Self, class Archive>
    static void archive(Self& self, Archive& to) {
        if constexpr (Archive::reads) self.disturb();
        if constexpr (prepares_spin())
            for (int b = 0; b < self.bodies.count; ++b) to(self.inertia_[b]);
        if constexpr (has_wrenches) to(self.wrenches, self.gravity_);
        if constexpr (has_loads) Loads::archive(self.loads, to);
        if constexpr (has_joints) {
            Joints::archive(self.joints, self.bodies, to);
            if constexpr (Archive::reads) self.keep_joint_springs();
        }
        if constexpr (keeps_kicks && Loads::may_depend_on_velocity)
            for (int b = 0; b < self.bodies.count; ++b)
                KeptKick<N, rotation>::archive(self.kept_.of_body[b], to, self.kept_.disturbances);
    }
    // Adds gravity to the digest of a scene, where no event changes it, and the joints.
    void add_to([[maybe_unused]] detail::Digest& digest) const {
        if constexpr (!has_wrenches)
            for (const DriftSum& fall : gravity_) digest.add_number(fall);
        if constexpr (has_joints) joints.add_to(digest);
        if constexpr (features.has_joint_springs()) loads.joint_springs().add_to(digest);
    }

    // A step of a world with loads or joints, and without contacts by impulses. Bodies that loads couple advance
    // together, those of a tree too, the others one by one. `touches(b)`: as of find_bodies_of_trees().
    template <class Touches>
    void step_all(const StepInfo<N>& info, Touches&& touches) {
        BodyGroup coupled;
        Kinematics kinematic;
        begin(kinematic, info);
        if constexpr (has_joints) find_bodies_of_trees(touches);
        for (int b = 0; b < bodies.count; ++b) {
            if (bodies.constants[b].fixed()) step_turntable(b, info);
            else if (steps_with_trees(b)) continue;
            else if (is_coupled(b)) coupled.add(b);
            else if constexpr (has_loads) alone(b, info);
            else free_body(b, info);
        }
        if constexpr (has_joints) step_trees(info);
        if constexpr (has_loads)
            if (coupled.count > 0) group(coupled, info);
        end(kinematic, info);
    }
    // What an island's step asks for (contact/island_step.hpp).
    template <class Flight, class Marks>
    void move(const Flight& flight, const StepInfo<N>& info, const Marks& marks) {
        if (flight.new_spins) spins_changed(flight.group);
        if (flight.loads != nullptr) foresee(flight.group, marks, *flight.loads);
        if (flight.portion.length > Work(0)) portion(flight.group, info, flight.portion);
    }
    // The same where kinematic bodies move along. Loads feel them where they are in the middle of the flight.
    template <class Flight, class Marks>
    void move(const Flight& flight, const StepInfo<N>& info, const Marks& marks,
              const Kinematics& kinematic) requires(features.kinematic) {
        const Work length = flight.portion.length;
        const bool along = length > Work(0);
        if (has_loads && along) place(kinematic, info, flight.from + N::half_of(length), length);
        move(flight, info, marks);
        if (along || flight.places) place(kinematic, info, flight.from + length);
    }
    // What acts on a body in this step besides gravity.
    [[nodiscard]] TUMBLE_INLINE Mark mark(int b) const { return {is_coupled(b), is_loaded(b), is_driven(b)}; }
};

}  // namespace tumble

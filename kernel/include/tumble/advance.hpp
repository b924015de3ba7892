// Advance<Scene> moves bodies over a step or a part of it with the scene's method: freely, under loads, or fixed in
// their place. It owns the bodies, their inertia, the loads and gravity. It knows no contact.
#pragma once

#include <tumble/body/momentum.hpp>
#include <tumble/events/snapshot.hpp>
#include <tumble/events/wrench.hpp>
#include <tumble/integrators/verlet.hpp>
#include <tumble/joints/hold.hpp>
#include <tumble/loads/load_set.hpp>
#include <tumble/solver/marks.hpp>

namespace tumble {

template <class S>
class Advance {
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

    constexpr Advance(Seconds step, const WorldSpec& spec)
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
    // Adds a body at a place, which is free: the end or one that a body has left.
    constexpr void add(const BodySpec& spec, const PrincipalInertia& inertia, int b) {
        bodies.add(spec, inertia, b);
        if constexpr (rotation)
            if (bodies.rotates(b)) set_inertia(b, inertia.moments);
        spin_changed(b);
        disturb();
        if constexpr (has_loads) loads.set_body(b, spec, inertia, bodies);
        if constexpr (features.drag) loads.check_drag(b, spec, inertia, bodies, step_bounds);
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
    // Adds a joint that has no fault; returns its place.
    template <class Spec>
    int add(const Spec& spec) requires(has_joints&& JointSpec<Spec>) {
        const int place = joints.add(spec, bodies);
        if constexpr (features.has_joint_springs()) {
            using Springs = typename Loads::JointSpringsOfWorld;
            using Kind = JointKinds::Of<Spec>;
            constexpr auto along = Kind::slides == 1   ? Springs::Along::slide
                                   : Kind::slides == 2 ? Springs::Along::line
                                   : Kind::turns == 3  ? Springs::Along::whole_turn
                                   : Kind::turns == 2  ? Springs::Along::turns
                                                       : Springs::Along::turn;
            typename Springs::Side side[2];
            typename N::PositionSum anchor[3];
            const auto& record = joints.record(place);
            for (int i = 0; i < 2; ++i) {
                const auto& from = record.side[i];
                side[i].body = from.body;
                for (int k = 0; k < 3; ++k)
                    side[i].arm[k] = N::times_power_of_two(N::work(from.arm[k]), N::fixed_point ? from.arm_log2 : 0);
                for (int k = 0; k < 2; ++k) side[i].axis[k] = from.axis[k];
            }
            for (int i = 0; i < 3; ++i) anchor[i] = N::sum(record.anchor[i]);
            loads.joint_springs().set(place, along, side, anchor,
                                      {detail::spring_of(spec, 0), detail::spring_of(spec, 1)}, bodies);
            disturb();
        }
        return place;
    }
    void break_joint(int place) requires(features.joint_breaks) {
        joints.break_apart(place, bodies);
        keep_joint_springs();
        disturb();
    }
    void remove_joint(int place) requires has_joints {
        joints.remove(place, bodies);
        keep_joint_springs();
        disturb();
    }
    // Adds a spring; false when there is no room.
    constexpr bool add(const SpringSpec& spec) requires(features.springs > 0) {
        disturb();
        return loads.add(spec, bodies, spring_bounds);
    }
    // Writes or reads what a snapshot of a whole world holds.
    template <class Self, class Archive>
    static void archive(Self& self, Archive& to) {
        if constexpr (prepares_spin())
            for (int b = 0; b < self.bodies.count; ++b) to(self.inertia_[b]);
        if constexpr (has_wrenches) to(self.wrenches, self.gravity_);
        if constexpr (has_loads) Loads::archive(self.loads, to);
        if constexpr (has_joints) {
            Joints::archive(self.joints, self.bodies, to);
            if constexpr (Archive::reads) self.keep_joint_springs();
        }
        if constexpr (Archive::reads) self.disturb();
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
    // Call after every change of what loads depend on, unless a step made it. It voids the kicks that were kept.
    TUMBLE_INLINE constexpr void disturb() {
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
    void check_range(const BodyGroup& group) {
        for (int k = 0; k < group.count; ++k) {
            check_range(group.id[k]);
            check_spin_about_z(group.id[k]);
            settle(group.id[k]);
        }
    }

    // Change of drift by gravity in a step.
    [[nodiscard]] constexpr DriftSum whole_fall(int i) const { return whole(gravity_[i]); }

    // A step of a body that feels gravity alone.
    TUMBLE_INLINE void free_body(int b, const StepInfo<N>& info) {
        if (bodies.constants[b].fixed()) return step_fixed(b, info);
        lose_kick(b);
        unloaded<true>(b, info, gravity_);
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
    // True of a body in a tree of joints.
    [[nodiscard]] TUMBLE_INLINE bool is_jointed([[maybe_unused]] int b) const {
        if constexpr (has_joints) return joints.is_jointed(b);
        else return false;
    }
    // True of a body in a tree, and of one that loads couple to a tree, directly or through others. Ask
    // find_bodies_of_trees() first.
    [[nodiscard]] TUMBLE_INLINE bool steps_with_trees([[maybe_unused]] int b) const {
        if constexpr (has_joints && may_couple) return with_trees_[b];
        else return is_jointed(b);
    }
    // Call before a step. Misuse: one of these bodies touches something. `touches(b)`: planes and bodies do not pass
    // through body b.
    template <class Touches>
    void find_bodies_of_trees([[maybe_unused]] Touches&& touches) requires has_joints {
        if constexpr (may_couple) {
            for (auto& is_with : with_trees_) is_with = false;
            for (int b = 0; b < bodies.count; ++b)
                if (is_jointed(b)) add_coupled(with_trees_, b);
            for (int b = 0; features.touches() && b < bodies.count; ++b) TUMBLE_ASSERT(!with_trees_[b] || !touches(b));
        }
    }
    // Whether a body, or one that loads couple to it, touches something. Never of a fixed body.
    template <class Touches>
    [[nodiscard]] bool touches_with_coupled(int b, Touches&& touches) const requires has_joints {
        if (b < 0 || bodies.constants[b].fixed()) return false;
        if constexpr (may_couple) {
            bool with[features.bodies]{};
            add_coupled(with, b);
            bool any = false;
            for (int other = 0; other < bodies.count; ++other) any = any || (with[other] && touches(other));
            return any;
        } else {
            return touches(b);
        }
    }
    // A step of the trees of joints, and of the bodies that loads couple to them. These trees step together.
    void step_trees(const StepInfo<N>& info) requires has_joints {
        BodyGroup coupled;
        for (int b = 0; may_couple && b < bodies.count; ++b)
            if (steps_with_trees(b) && is_coupled(b)) coupled.add(b);
        typename Hold::Trees together;
        for (int t = 0; t < joints.tree_count(); ++t) {
            const JointTreeState& tree = joints.tree(t);
            BodyGroup group;
            bool is_apart = true;
            for (int i = tree.first; i < tree.last; ++i) {
                const int b = joints.nodes()[i].body;
                group.add(b);
                if constexpr (may_couple)
                    loads.for_each_coupled(bodies, b, [&](int other) {
                        is_apart = is_apart && (bodies.constants[other].fixed() || joints.is_in(tree, other));
                    });
            }
            if (is_apart) {
                hold(typename Hold::Trees{t}, group, info);
                continue;
            }
            together.add(t);
            for (int i = tree.first; i < tree.last; ++i) coupled.add_once(joints.nodes()[i].body);
        }
        if (together.count > 0) hold(together, coupled, info);
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

private:
    void keep_joint_springs() {
        if constexpr (features.has_joint_springs())
            loads.joint_springs().keep([&](int j) { return joints.record(j).is_there; },
                                       [&](int j) { return joints.holds(j); }, bodies);
    }
    // Reports a step that is surely too long for a spring of a joint: with the inertia of what hangs on it along its
    // free direction as if the other side stood still, which is more than the motion has. The factor must be that of
    // now.
    [[gnu::noinline, gnu::cold]] void check_springs(JointTreeState& tree) requires(features.has_joint_springs()) {
        tree.is_new = false;
        for (int i = tree.first; i < tree.last; ++i) {
            const auto& node = joints.nodes()[i];
            if (node.joint < 0) continue;
            for (int k = 0; k < 2; ++k) {
                const Work stiffness = loads.joint_springs().stiffness(node.joint, k) * seconds_of_step(),
                           damping = loads.joint_springs().damping(node.joint, k);
                if (!(stiffness > Work(0)) && !(damping > Work(0))) continue;
                const Work inertia = joints.inertia_along(node, k) / seconds_of_step();
                if (!(inertia > Work(0))) continue;
                for (int s = 0; s < StepBounds::sums; ++s)
                    if (inertia < spring_bounds.of_spring[s] * stiffness + spring_bounds.of_damper[s] * damping)
                        bodies.report(Issue::step_too_long, node.body);
            }
        }
    }
    [[nodiscard]] Work seconds_of_step() const { return N::template constant<Work>(bodies.step_length); }
    // Adds a body, and all moving bodies that loads couple to it, directly or through others.
    void add_coupled(bool (&to)[features.bodies], int b) const requires(has_joints&& may_couple) {
        if (to[b]) return;
        BodyGroup open{b};
        to[b] = true;
        while (open.count > 0)
            loads.for_each_coupled(bodies, open.id[--open.count], [&](int other) {
                if (to[other] || bodies.constants[other].fixed()) return;
                to[other] = true;
                open.add(other);
            });
    }
    // True of a fixed or kinematic body that moves by itself a point at which a load acts.
    [[nodiscard]] bool changes_loads(int b) const requires(has_loads) {
        const bool is_kinematic = bodies.constants[b].kinematic();
        if (is_kinematic && bodies.is_drifting(b)) return true;
        if constexpr (rotation)
            return bodies.constants[b].fixed() && (is_kinematic || features.turntables) && bodies.is_turning(b) &&
                   loads.is_turned(bodies, b);
        return false;
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
        State& s = bodies.state[b];
        const auto part = N::fraction(length);
        auto start = s.t_b;
        const auto from = s.q_wb.value();
        [[maybe_unused]] const int halvings = bodies.halvings_of(b);
        const auto shrink = [&](auto& t) __attribute__((noinline)) { t.add(N::part(N::sum(t), part) - N::sum(t)); };
        shrink(s.t_b.x);
        shrink(s.t_b.y);
        shrink(s.t_b.z);
        [[maybe_unused]] auto shrunk = s.t_b;
        spin_changed(b);
        rotate_flight(b, info);
        if constexpr (Bodies::has_parts) {
            for (int h = halvings; h < bodies.halvings_of(b); ++h) {
                N::halve(start);
                N::halve(shrunk);
            }
        }
        if constexpr (spin == Spin::angular_momentum) {
            TurnSum t[3]{N::sum(start.x), N::sum(start.y), N::sum(start.z)};
            turn_momentum<N>(t, bodies.spin_scale(b), from, s.q_wb.value());
            s.t_b = start;
            s.t_b.x.add(t[0] - N::sum(start.x));
            s.t_b.y.add(t[1] - N::sum(start.y));
            s.t_b.z.add(t[2] - N::sum(start.z));
        } else {
            // Only the change is scaled back, so that a spin that does not change stays exact.
            for (int i = 0; i < 3; ++i) {
                const Work change = N::half_turn(N::sum(s.t_b[i]) - N::sum(shrunk[i]), bodies.scale) / length;
                s.t_b[i] = start[i];
                s.t_b[i].add(N::turn_sum(change, bodies.scale));
            }
        }
        spin_changed(b);
    }
    // A part of a step of bodies under loads, with the part as the unit of time. Drift and spin shrink with it, and
    // accelerations with its square. Then the same code steps over the part. Only the changes are scaled back, so that
    // a drift that loads do not change stays exact. The spin is already in half turns of 2^-halvings of the step.
    void part_of_step(const BodyGroup& group, const StepInfo<N>& info, Work length, int halvings = 0) {
        const auto part = N::fraction(length);
        const Work inverse = Work(1) / length;
        const Work spin_length = N::times_power_of_two(length, halvings),
                   spin_inverse = N::times_power_of_two(inverse, -halvings);
        const bool spin_shrinks = halvings == 0 || spin_length < Work(1);
        StateCopies<State, features.bodies> whole, scaled;
        [[maybe_unused]] std::int8_t before[features.bodies]{};
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            State& s = bodies.state[b];
            whole.keep(k, s);
            before[k] = static_cast<std::int8_t>(bodies.halvings_of(b));
            for (int i = 0; i < 3; ++i) {
                N::add(s.d_w[i], N::part(N::sum(s.d_w[i]), part) - N::sum(s.d_w[i]));
                if constexpr (rotation)
                    if (spin_shrinks)
                        s.t_b[i].add(N::part(N::sum(s.t_b[i]), N::fraction(spin_length)) - N::sum(s.t_b[i]));
            }
            scaled.keep(k, s);
        }
        spins_changed(group);

        DriftSum fall[3];
        for (int i = 0; i < 3; ++i) fall[i] = N::part(N::part(gravity_[i], part), part);
        if constexpr (has_wrenches) over(group, info, fall, length, false, part);
        else over(group, info, fall, length, false);

        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            State& s = bodies.state[b];
            if constexpr (Bodies::has_parts) {
                for (int h = before[k]; h < bodies.halvings_of(b); ++h) {
                    N::halve(whole.first()[k].t_b);
                    N::halve(scaled.first()[k].t_b);
                }
            }
            for (int i = 0; i < 3; ++i) {
                const Work linear = N::metres(N::sum(s.d_w[i]) - N::sum(scaled[k].d_w[i]), bodies.scale) * inverse;
                s.d_w[i] = whole[k].d_w[i];
                N::add(s.d_w[i], N::drift_sum(linear, bodies.scale));
                if constexpr (rotation) {
                    const Work angular =
                        N::half_turn(N::sum(s.t_b[i]) - N::sum(scaled[k].t_b[i]), bodies.scale) * spin_inverse;
                    s.t_b[i] = whole[k].t_b[i];
                    s.t_b[i].add(N::turn_sum(angular, bodies.scale));
                }
            }
        }
        spins_changed(group);
    }
    void forget_kicks([[maybe_unused]] const BodyGroup& group) {
        if constexpr (keeps_kicks)
            for (int k = 0; k < group.count; ++k) kept_.of_body[group.id[k]].age = 0;
    }
    // Call for a body that no load pushes alone in this step. A load of the program may push it again in any later
    // step, and the kick that was kept is not that of its place then.
    TUMBLE_INLINE void lose_kick([[maybe_unused]] int b) {
        if constexpr (keeps_kicks && detail::OwnLoads<S>::List::count > 0) kept_.of_body[b].age = 0;
    }
    // True of a body whose velocity a wrench changes between the kick that ends a step and the next one, if that
    // matters.
    [[nodiscard]] bool is_pushed_between_kicks([[maybe_unused]] int b, [[maybe_unused]] const auto& evaluate) const {
        if constexpr (has_wrenches) return wrenches.act_on(b) && evaluate.depends_on_velocity();
        else return false;
    }
    // Moves bodies whose spins have halvings under loads; false of others.
    TUMBLE_INLINE bool moved_in_parts([[maybe_unused]] const BodyGroup& group, [[maybe_unused]] const StepInfo<N>& info,
                                      [[maybe_unused]] Work length) {
        if constexpr (has_loads && Bodies::has_parts) {
            for (int k = 0; k < group.count; ++k) shorten_parts_about_z(group.id[k]);
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

    using Hold = JointHold<Bodies, features>;
    // A step of trees, with all bodies that step together.
    [[gnu::noinline]] void hold(const typename Hold::Trees& trees, const BodyGroup& group,
                                const StepInfo<N>& info) requires has_joints {
        const auto fly = [&](int halvings) {
            portion(group, info, halvings == 0 ? Portion{} : Portion{false, Hold::length_of_part(halvings)});
        };
        Hold{joints, bodies, trees}.step(group, fly, [&](int b) { spin_changed(b); });
        if constexpr (features.has_joint_springs())
            for (int t = 0; t < trees.count; ++t)
                if (JointTreeState& tree = joints.tree(trees.tree[t]); tree.is_new) check_springs(tree);
        check_range(group);
    }

    using Inertia = typename Integrator::template Inertia<N>;
    // There may be bodies that turn by themselves, and tumble in free rotation.
    static constexpr bool may_tumble = rotation && features.moving_surfaces() && features.bodies > 0;
    constexpr void set_inertia(int b, const RealVec3& moments) requires rotation {
        inertia_[b] = Inertia::of(moments, bodies.scale);
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

    static constexpr bool drags_in_closed_form = features.drag && Integrator::order >= 2;
    // True of a body of which linear drag is the only load, and which moves by its closed form.
    [[nodiscard]] TUMBLE_INLINE bool is_dragged_alone([[maybe_unused]] int b) const {
        if constexpr (drags_in_closed_form) return loads.closed_form(b).exists && loads.is_only_dragged(bodies, b);
        else return false;
    }

    // Motion under a constant acceleration, exact for methods of order two and more, and under linear drag beside it.
    template <bool dragged = false>
    TUMBLE_INLINE void coast(int b, const DriftSum (&fall)[3]) {
        State& s = bodies.state[b];
        if constexpr (dragged) {
            const auto& form = loads.closed_form(b);
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
    // A step of a kinematic body.
    void step_kinematic(int b, const StepInfo<N>& info) requires(features.kinematic) {
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
        rotate<ends_step>(b, info);
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
        [[maybe_unused]] int halvings = bodies.halvings_of(b);
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
            if constexpr (Bodies::has_parts)
                for (; halvings < bodies.parts.halvings[b]; ++halvings) N::halve(s.t_b);
            spin_changed(b);
        }
        if constexpr (ends_step) settle(b);
    }
    // The motion of a body in a part of the step as that in a whole one.
    void shorten(int b, Work length) requires(features.kinematic) {
        if (length == Work(1)) return;
        State& s = bodies.state[b];
        const auto part = N::fraction(length);
        for (int i = 0; i < 3; ++i) {
            N::add(s.d_w[i], N::part(N::sum(s.d_w[i]), part) - N::sum(s.d_w[i]));
            if constexpr (rotation)
                if (bodies.rotates(b)) s.t_b[i].add(N::part(N::sum(s.t_b[i]), part) - N::sum(s.t_b[i]));
        }
        spin_changed(b);
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
            while (!N::has_room(bodies.state[b].t_b.z, inertia_[b].z_room()) && bodies.halve_parts(b))
                [[unlikely]] spin_changed(b);
    }
    TUMBLE_INLINE void check_spin_about_z([[maybe_unused]] int b) {
        if constexpr (has_z_room)
            if (!N::has_room(bodies.state[b].t_b.z, inertia_[b].z_room())) [[unlikely]]
                hold_spin_about_z(b);
    }
    [[gnu::noinline, gnu::cold]] void hold_spin_about_z(int b) requires has_z_room {
        if constexpr (Bodies::has_parts)
            if (bodies.parts.halvings[b] < bodies.scale.most_halvings) return;
        N::hold(bodies.state[b].t_b.z, inertia_[b].z_room());
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
                    return unloaded<false, true>(b, info, fall);
                }
            return loaded(BodyGroup{b}, info, fall, length, false, keeps, part...);
        }
        lose_kick(b);
        unloaded(b, info, fall, part...);
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
            auto evaluate = loads.template evaluation<true>(bodies, group, length, falls, turned);
            if constexpr (keeps_kicks) {
                if (keeps && !is_pushed_between_kicks(group.id[0], evaluate))
                    evaluate.kept = &kept_.of_body[group.id[0]];
                else kept_.of_body[group.id[0]].age = 0;
                evaluate.age = kept_.disturbances;
            }
            staged<1>(group, evaluate, info);
        } else if constexpr (features.bodies > 1) {
            staged<features.bodies>(
                group, loads.template evaluation<false>(bodies, group, length, falls, turned, places_.of(group)), info);
        }
        if constexpr (has_wrenches) half_kick_by_wrenches(group, part...);
    }
    // Whether the method steps bodies whose rotation the loads neither change nor ask for as it steps point masses.
    static constexpr bool translates =
        requires(const Translations<N, spin, 1>& group, const detail::NoLoads<N>& loads, const StepInfo<N>& info) {
        Integrator::template advance<N, 1>(group, loads, info);
    };
    template <int capacity>
    using Staged = std::conditional_t<rotation, Group<N, spin, Inertia, capacity, features.mixed() || translates>,
                                      Translations<N, spin, capacity>>;
    // Bodies that the loads do not turn rotate freely, and the loads move their centres of mass.
    template <int capacity, class Evaluate>
    void staged(const BodyGroup& ids, const Evaluate& evaluate, const StepInfo<N>& info) {
        Staged<capacity> group;
        group.set_count(ids.count);
        for (int k = 0; k < ids.count; ++k) {
            const int b = ids.id[k];
            group.body[k] = &bodies.state[b];
            if constexpr (rotation) {
                if (!evaluate.turned) rotate(b, info);
                else if (bodies.rotates(b)) group.inertia[k] = &inertia_[b];
            }
        }
        if (!Integrator::template advance<N, capacity>(group, evaluate, info))
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

    struct KeptKicks {
        typename detail::RoomFor<KeptKick<N, rotation>, features.bodies>::Array of_body{};
        std::uint32_t disturbances = 1;  // counted; 0 is skipped
    };
    [[no_unique_address]] If<keeps_kicks, KeptKicks, 11> kept_{};
    [[no_unique_address]] If<has_loads, BodyPlaces<features.bodies>, 12> places_{};
    [[no_unique_address]] If<has_joints && may_couple, bool[(features.bodies > 0 ? features.bodies : 1)], 15>
        with_trees_{};
    DriftSum gravity_[3]{};  // change of drift a step, or half of it: see fall_in_halves

public:
    [[no_unique_address]] Bodies bodies;

private:
    // Behind the bodies, where it may fill the end of their last word.
    [[no_unique_address]] If<rotation, typename detail::RoomFor<Inertia, features.bodies>::Array, 1> inertia_{};
    [[no_unique_address]] If<may_tumble, Inertia, 13> sphere_{};  // of a fixed body that would tumble

public:
    [[no_unique_address]] If<has_loads, Loads, 0> loads;
    [[no_unique_address]] If<has_wrenches, Wrenches<N, rotation, features.bodies>, 6> wrenches;
    [[no_unique_address]] If<has_joints, Joints, 14> joints;
};

}  // namespace tumble

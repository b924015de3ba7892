// TreeMotion<Scene>: the trees of joints, with the bodies that loads couple to them.
#pragma once

#include <tumble/advance/motion_in_parts.hpp>
#include <tumble/integrators/suzuki4.hpp>
#include <tumble/joints/hold.hpp>

namespace tumble {

template <class S>
class TreeMotion : public MotionInParts<S> {
    using Base = MotionInParts<S>;

public:
    constexpr TreeMotion(Seconds step, const WorldSpec& spec) : Base{step, spec} {}
    using Base::check_range, Base::disturb, Base::has_moving_end, Base::is_coupled, Base::portion, Base::spin_changed;
    using Base::features, Base::has_joints, Base::has_own_loads, Base::has_wrenches, Base::may_couple,
        Base::spring_bounds, Base::bodies, Base::loads, Base::wrenches, Base::joints, Base::with_trees_, Base::alone_,
        Base::flies_parts_alone;
    using typename Base::N, typename Base::Integrator, typename Base::Work, typename Base::Bodies,
        typename Base::BodyGroup, typename Base::Loads, typename Base::Portion;

    // Adds a joint that has no fault; returns its place.
    template <class Spec>
    constexpr int add(const Spec& spec) requires(has_joints&& JointSpec<Spec>) {
        const int place = joints.add(spec, bodies);
        if constexpr (features.has_joint_springs()) {
            using Springs = typename Loads::JointSprings;
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
            JointTreeState& tree = joints.tree(t);
            BodyGroup group;
            bool is_apart = true, may_rest = !has_own_loads;
            for (int i = tree.first; i < tree.last; ++i) {
                const int b = joints.nodes()[i].body;
                group.add(b);
                if constexpr (has_wrenches) may_rest = may_rest && !wrenches.act_on(b);
                if constexpr (may_couple)
                    loads.for_each_coupled(bodies, b, [&](int other) {
                        is_apart = is_apart && (bodies.constants[other].fixed() || joints.is_in(tree, other));
                    });
            }
            may_rest = may_rest && is_apart && !has_moving_end(group);
            if (may_rest && joints.is_at_rest(tree)) continue;
            if (is_apart) {
                hold(typename Hold::Trees{t}, group, info, may_rest);
                continue;
            }
            together.add(t);
            for (int i = tree.first; i < tree.last; ++i) coupled.add_once(joints.nodes()[i].body);
        }
        if (together.count > 0) hold(together, coupled, info, false);
    }

    void keep_joint_springs() {
        if constexpr (features.has_joint_springs())
            loads.joint_springs().keep([&](int j) { return joints.record(j).is_known(); },
                                       [&](int j) { return joints.acts(j); }, bodies);
    }

    // With joints a method of order four flies the five pieces of Suzuki's composition. Its own flights are symmetric
    // to this order.
    using Pieces = std::conditional_t<(Integrator::order > 2), detail::Suzuki4Parts, detail::OnePart>;

private:
    struct Lengths {
        consteval Lengths() {
            for (int i = 0; i < Pieces::count; ++i) of[i] = N::template constant<Work>(Pieces::of(i));
        }
        Work of[Pieces::count]{};
    };
    static constexpr Lengths lengths_of_pieces{};
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
    using Hold = JointHold<Bodies, features, may_couple, Pieces>;
    // A step of trees, with all bodies that step together.
    [[gnu::noinline]] void hold(const typename Hold::Trees& trees, const BodyGroup& group, const StepInfo<N>& info,
                                bool may_rest) requires has_joints {
        const auto fly = [&](int halvings, [[maybe_unused]] int piece) {
            if constexpr (Pieces::count == 1)
                portion(group, info, halvings == 0 ? Portion{} : Portion{false, Hold::length_of_part(halvings)});
            else portion(group, info, {false, Hold::length_of_part(halvings) * lengths_of_pieces.of[piece]});
        };
        if constexpr (flies_parts_alone) alone_.is_flown = true;
        Hold{joints, bodies, trees}.step(
            group, fly, [&](int b) { spin_changed(b); }, may_rest);
        if constexpr (flies_parts_alone) alone_.is_flown = false;
        if constexpr (features.has_joint_springs())
            for (int t = 0; t < trees.count; ++t)
                if (JointTreeState& tree = joints.tree(trees.tree[t]); tree.is_new) check_springs(tree);
        check_range(group);
    }
};

}  // namespace tumble

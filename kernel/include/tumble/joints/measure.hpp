// What joints have open, measured from the states of the bodies: gaps at the end of a flight, rates, and what a change
// of motion does to the gaps at the end.
//
// With own and other the two sides, x places, a and b the arms to the anchors and R rotations, the gap is
//   c = x_own + R a - x_other - R b,
// and the arm of the other side goes on along a free translation as far as the body has gone. The rate is the same of
// velocities. Targets are their opposites.
#pragma once

#include <tumble/joints/forest.hpp>

namespace tumble {

// Of the trees of a world, for one step. It lives on the stack.
template <class N, Features features>
class JointMeasures {
public:
    using J = JointNumbers<N>;
    using Unit = typename N::Unit;
    using Open = typename J::Open;
    using Vector = Vec3<Unit>;
    using Forest = JointForest<N, features>;
    using Node = JointNode<N>;
    using Place = JointPlace<N>;
    using Record = JointRecord<N>;
    using Tree = JointTree<N, features>;
    static constexpr int most_nodes = Forest::most_nodes;

    Place end[most_nodes];  // where the bodies are now; the nodes' own places are those of the factor
    JointSolution<N> solution[most_nodes];
    int bits = 0;  // of the targets, which are in 2^-bits m

    explicit JointMeasures(Forest& forest) : forest_{forest} {}

    // Sets `end` from the bodies.
    [[gnu::noinline]] void place(const JointTreeState& tree, const auto& bodies) {
        for (int i = tree.first; i < tree.last; ++i) {
            const Node& node = forest_.nodes()[i];
            Place& at = end[i];
            at.axes = Axes<N>::of(bodies.state[node.body].q_wb.value());
            if (node.joint == Node::no_joint) {
                set_free_root(at);
                continue;
            }
            const Record& joint = forest_.record(node.joint);
            set_side(at.axes, joint.side[node.side], node, at.own_arm, at.own_axis);
            at.own_log2 = joint.side[node.side].arm_log2;
            const auto& other = joint.side[1 - node.side];
            at.arm_log2 = other.arm_log2;
            if (node.parent >= 0) {
                set_side(end[node.parent].axes, other, node, at.arm, at.other_axis);
            } else if (node.base >= 0) {
                set_side(Axes<N>::of(bodies.state[node.base].q_wb.value()), other, node, at.arm, at.other_axis);
            } else {
                set_world(at, other);
            }
            if constexpr (features.has_joint_ranges()) {
                if (node.slides > 1) reach_over(node, i, bodies);
                else if (forest_.has_range(node)) hold_at_end(node, i, bodies);
            }
            if constexpr (JointKinds::any_slides(features, 1))
                if (node.slides == 1) follow(node, at, bodies);
        }
    }
    // Takes `end` over as the places of the factor, and factors.
    [[gnu::noinline]] void factor(JointTreeState& tree) {
        bool slides = false;
        for (int i = tree.first; i < tree.last; ++i) {
            Node& node = forest_.nodes()[i];
            // Held at a limit a slider has no slide, and is as long as before.
            if (node.parent >= 0 && forest_.may_slide(node)) {
                set_span(node, end[i], end[node.parent]);
                slides = true;
            }
        }
        if (slides) forest_.fit_lengths(tree);
        for (int i = tree.first; i < tree.last; ++i) {
            Node& node = forest_.nodes()[i];
            const Place& at = end[i];
            node.frame = at.axes;
            node.lever = lever(node, at);
            set_directions(node, at);
            if (node.parent < 0) continue;
            const Node& parent = forest_.nodes()[node.parent];
            node.link = Vector{over(at.arm, parent.length_log2 - at.arm_log2) - Vector{parent.lever}};
        }
        forest_.solver(tree).factor();
    }

    // Measures the gaps at `end` and sets the targets that close them. True where all are closed. `is_guess`: after the
    // flight with the guess, whose gaps are not rounding alone.
    [[gnu::noinline]] bool gaps(const JointTreeState& tree, const auto& bodies, bool is_guess = false) {
        bool fits = true;
        bool closed = measure_gaps(tree, bodies, is_guess, 0, fits);
        if (closed) return true;
        int of_gap = J::gap_bits;
        if (!fits) [[unlikely]] {
            of_gap = J::coarse_gap_bits;
            (void)measure_gaps(tree, bodies, is_guess, J::gap_bits - J::coarse_gap_bits, fits);
        }
        scale(tree, of_gap);
        return false;
    }
    // Measures the rates across the joints, at `end`, and sets the targets that end them.
    [[gnu::noinline]] void rates(const JointTreeState& tree, const auto& bodies) {
        of_spin_ = measure_spins(tree, bodies);
        int of_rate = J::rate_bits;
        while (!measure_rates(tree, bodies, of_rate) && of_rate > J::coarse_rate_bits)
            [[unlikely]] of_rate = J::coarse_rate_bits;
        scale(tree, of_rate);
    }
    // Takes from the targets what the solution does to the gaps at the end of a flight, by the tangent of a free
    // flight: the centre of mass moves by dv. With the change dL of the angular momentum, constant in the world, L
    // itself and the inertia I in the middle of the flight, the body turns by phi with phi' = I^-1 (dL + L x phi):
    //   phi = I^-1 (dL + (h / 2) L x I^-1 dL) h
    // over a step h to second order. `solution` is in the world's axes of the start, phi in those of the end.
    // of_flight(): a turn in a part of 2^-halvings of a step as that in the flight.
    [[gnu::noinline]] void take_off_effect(const JointTreeState& tree, const auto& bodies, int halvings,
                                           const auto& of_flight) {
        for (int i = tree.first; i < tree.last; ++i)
            turn_[i] = turn_by(forest_.nodes()[i], solution[i].dw, bodies, end[i], halvings, of_flight);
        for (int i = tree.first; i < tree.last; ++i) {
            const Node& node = forest_.nodes()[i];
            if (node.joint == Node::no_joint) continue;
            auto& s = solution[i];
            const Place& at = end[i];
            // Turns are times the length: arms are over it.
            Vector v = s.dv + Tree::across(turn_[i], lever(node, at)), w = turn_[i];
            if (node.parent >= 0) {
                const int parent_log2 = forest_.nodes()[node.parent].length_log2;
                v -= solution[node.parent].dv +
                     Tree::across(turn_[node.parent], over(at.arm, parent_log2 - at.arm_log2));
                w -= down(turn_[node.parent], node.length_down);
            }
            leave_free(node, at, v, w);
            set_three(s.target, three(s.target) - v);
            set_three(s.target + 3, three(s.target + 3) - w);
        }
    }
    // After rates() and their solution, which ends a part of 2^-halvings of a step: the halvings that keep the turn of
    // a part below 1/4 rad and h^2 f r / I, summed over the joints of a body with the forces f of this part, below 1/4.
    // A sixteenth of that of 4, at which the swing across an arm is unstable: errors of a part stay small.
    [[nodiscard, gnu::noinline]] int halvings_for(const JointTreeState& tree, int halvings) {
        typename J::Load load[most_nodes]{};
        int wanted = 0;
        for (int i = tree.first; i < tree.last; ++i) set_three(solution[i].impulse, Vector::Constant(Unit{}));
        for (int i = tree.last - 1; i >= tree.first; --i) {
            const Node& node = forest_.nodes()[i];
            const auto& s = solution[i];
            // h^2 f / 2 in whole steps, of the joint and what hangs on it.
            const Vector force =
                three(s.impulse) + along(s.dv, J::down(node.mass, node.mass_log2 - node.own_mass_log2));
            if (node.joint != Node::no_joint)
                load[i] += J::load(force, node.swing[0], node.mass_log2 - bits + halvings + 1);
            if (node.parent >= 0) {
                load[node.parent] += J::load(force, node.swing[1], node.mass_log2 - bits + halvings + 1);
                Unit* const p = solution[node.parent].impulse;
                set_three(p, three(p) + down(force, node.mass_down));
            }
            while (wanted <= most_halvings &&
                   (J::turns_too_far(spin_[i], of_spin_, wanted) || J::is_too_strong(load[i], wanted)))
                ++wanted;
        }
        return wanted;
    }
    // Sets the changes of motion of a solution to half kicks. The factor must be that of where they act.
    [[gnu::noinline]] void take(const JointTreeState& tree, const Kick<N>* kicks,
                                const auto& bodies) requires(features.has_joint_ranges()) {
        const auto fits = [&](int of_rate, int of_spin) {
            bool all = true;
            bits = of_rate;
            for (int i = tree.first; i < tree.last; ++i) {
                const Node& node = forest_.nodes()[i];
                Vector spin;
                for (int k = 0; k < 3; ++k) {
                    solution[i].dv[k] = J::clamped(J::drift_of(kicks[i].linear[k], bodies.scale, of_rate), all);
                    spin[k] = J::clamped_half(
                        J::angle(N::narrow_turn(kicks[i].angular[k]), node.to_angle[k], bodies.finest_scale(), of_spin),
                        all);
                }
                spin = node.frame.to_world(spin);
                for (int k = 0; k < 3; ++k)
                    solution[i].dw[k] = J::clamped(J::turned(spin[k], node.length_log2, of_spin, of_rate), all);
            }
            return all;
        };
        if (!fits(J::rate_bits, J::spin_bits)) (void)fits(J::coarse_rate_bits, J::coarse_spin_bits);
    }
    // Calls f(node, i) for each joint that these changes of motion push out of its range: a rope that pushes, and a
    // joint that an end of its range pulls. What a joint hands on is the balance of what hangs on it, about its anchor.
    template <class F>
    [[gnu::noinline]] void for_each_that_pushes(const JointTreeState& tree,
                                                F&& f) requires(features.has_joint_ranges()) {
        for (int i = tree.first; i < tree.last; ++i)
            for (Unit& impulse : solution[i].impulse) impulse = Unit{};
        for (int i = tree.last - 1; i >= tree.first; --i) {
            Node& node = forest_.nodes()[i];
            const auto& s = solution[i];
            Vector p = three(s.impulse), h = three(s.impulse + 3);
            add_change(node, s.dv, s.dw, p, h);
            if (node.holder >= 0) {
                Unit* const of_parent = solution[node.holder].impulse;
                const Vector down_p = down(p, node.mass_down), down_h = down(h, node.moment_down);
                set_three(of_parent, three(of_parent) + down_p);
                set_three(of_parent + 3, three(of_parent + 3) + down_h + cross<Unit>(Vector{node.link}, down_p));
            }
            if (!forest_.has_range(node)) continue;
            const auto& range = forest_.range(node);
            if (range.end == 0 || range.is_rod) continue;
            const auto& axis = forest_.directions()[node.direction + (node.keeps_distance() ? 5 : 0)].axis;
            const bool turns = JointKinds::turns[forest_.record(node.joint).kind] == 1;
            const Unit out = narrow<Unit>(dot(Vector{axis}, turns ? h : p));
            if (range.end * Forest::sign(node) > 0 ? out > Unit{} : out < Unit{}) f(node, i);
        }
    }
    // The end of its range beyond which a joint that is free of both is at `end`; 0 where it is within. A step turns it
    // by less than half a radian, `is_posed`: something else by any angle.
    [[nodiscard, gnu::noinline]] int end_beyond(const Node& node, int i, const auto& bodies,
                                                bool is_posed = false) const requires(features.has_joint_ranges()) {
        const auto& range = forest_.range(node);
        const Place& at = end[i];
        const bool turns = JointKinds::turns[forest_.record(node.joint).kind] == 1;
        const int log2 = log2_of_line(at);
        Unit enough = J::enough(false, turns && node.length_log2 > log2 ? int{node.length_log2} : log2, 0);
        if constexpr (!N::fixed_point) enough = J::enough_of(false, bodies.state[node.body].x_w, at.own_arm, at.arm);
        const int sign = Forest::sign(node);
        bool fits = true;
        for (const int e : {1, -1}) {
            Unit beyond{};  // in the direction of the joint
            if (turns) {
                // The sine of the angle from the end, which is small where its cosine is near 1.
                const Vector own{at.own_axis[1]}, from = at_end(range, e, node, at);
                if (narrow<Unit>(dot(from, own)) < N::template constant<Unit>(0.857)) {
                    if (is_posed && is_far_beyond(range, e, node, at)) return e;
                    continue;
                }
                beyond = J::lean(narrow<Unit>(dot(Vector{at.own_axis[0]}, cross<Unit>(from, own))), node.length_log2,
                                 J::gap_bits, fits);
            } else {
                const Vector axis{node.keeps_distance() ? at.own_axis[0] : at.other_axis[0]};
                const Open length = e > 0 ? range.most : range.least;
                beyond = longer_than(sign > 0 ? length : -length, axis, i, 0, fits);
            }
            if (e * sign > 0 ? beyond > enough : beyond < -enough) return e;
        }
        return 0;
    }
    // True of bodies at `end` of which one is turned by half a turn against the other: no gap shows that.
    [[nodiscard, gnu::noinline, gnu::cold]] bool is_turned_over(const JointTreeState& tree) const {
        for (int i = tree.first; i < tree.last; ++i) {
            const Node& node = forest_.nodes()[i];
            const Place& at = end[i];
            for (int k = 0; node.joint != Node::no_joint && k < 2 - node.turns; ++k)
                if (narrow<Unit>(dot(Vector{at.own_axis[k]}, Vector{at.other_axis[k]})) < Unit{}) return true;
        }
        return false;
    }
    // After a blow: at least `wanted`, and as many as the turns ask for that it leaves. The forces are those of before.
    [[nodiscard, gnu::noinline, gnu::cold]] int halvings_of_turns(const JointTreeState& tree, const auto& bodies,
                                                                  int wanted) {
        of_spin_ = measure_spins(tree, bodies);
        for (int i = tree.first; i < tree.last; ++i)
            while (wanted <= most_halvings && J::turns_too_far(spin_[i], of_spin_, wanted)) ++wanted;
        return wanted;
    }

private:
    static constexpr int most_halvings = JointForest<N, features>::most_halvings;
    // A joint of the scene may hold an orientation.
    static constexpr bool may_lean =
        JointKinds::any_turns(features, 0) || JointKinds::any_turns(features, 1) || JointKinds::any_turns(features, 2);

    Forest& forest_;
    int of_spin_ = 0;          // of spin_
    Vector spin_[most_nodes];  // of the bodies in the world's axes
    Vector turn_[most_nodes];
    [[no_unique_address]] If<features.has_joint_ranges(), Open[most_nodes][3], 23>
        line_;  // between the points, of a distance

    [[nodiscard]] TUMBLE_INLINE static Vector three(const Unit* x) { return Tree::three(x); }
    TUMBLE_INLINE static void set_three(Unit* x, const Vector& v) { Tree::set_three(x, v); }

    [[nodiscard]] TUMBLE_INLINE static Vector down(const Vector& v, int bits) { return Tree::down(v, bits); }
    [[nodiscard]] TUMBLE_INLINE static Vector over(const Vector& v, int bits) {
        if (!N::fixed_point || bits >= 0) [[likely]]
            return down(v, bits);
        return up(v, -bits);
    }
    [[nodiscard, gnu::noinline]] static Vector up(const Vector& v, int bits) {
        return {J::up(v[0], bits), J::up(v[1], bits), J::up(v[2], bits)};
    }

    static void set_side(const Axes<N>& axes, const typename Record::Side& side, const Node& node,
                         StoredVec3<Unit>& arm, StoredVec3<Unit> (&axis)[2]) {
        arm = axes.to_world(Vector{side.arm});
        for (int k = 0; k < node.axes; ++k) axis[k] = axes.to_world(Vector{side.axis[k]});
    }
    static void set_free_root(Place& at) {
        at.own_arm = at.arm = {Unit{}, Unit{}, Unit{}};
        at.own_log2 = at.arm_log2 = J::least_log2;
    }
    static void set_world(Place& at, const typename Record::Side& world) {
        at.arm = {Unit{}, Unit{}, Unit{}};
        at.arm_log2 = J::least_log2;
        for (int k = 0; k < 2; ++k) at.other_axis[k] = world.axis[k];
    }
    // The arm of the body, over the length of its node, which is the shorter one in small mechanisms.
    [[nodiscard]] TUMBLE_INLINE static Vector lever(const Node& node, const Place& at) {
        return over(at.own_arm, node.length_log2 - at.own_log2);
    }
    void set_directions(const Node& node, const Place& at) {
        FreeDirection<N>* const direction = forest_.directions() + node.direction;
        if constexpr (JointKinds::any_slides(features, 1))
            if (node.slides == 1) direction[0].axis = at.other_axis[0];
        if constexpr (features.has_joint_ranges()) {
            if (node.keeps_distance()) {
                direction[0].axis = at.other_axis[0];
                direction[1].axis = at.other_axis[1];
                direction[5].axis = at.own_axis[0];
            } else if (forest_.has_range(node)) {
                const bool turns = JointKinds::turns[forest_.record(node.joint).kind] == 1;
                direction[0].axis = turns ? at.own_axis[0] : at.other_axis[0];
            }
        }
        if (node.turns == 3) return;
        if (node.turns > 0) direction[node.slides].axis = at.own_axis[0];
        if constexpr (JointKinds::any_turns(features, 2))
            if (node.turns > 1) direction[node.slides + 1].axis = at.other_axis[0];
    }
    // In 2^-gap_bits m.
    [[gnu::noinline]] void set_gap(const Node& node, const Place& at, const auto& bodies, Open (&gap)[3]) const {
        const auto& own = bodies.state[node.body].x_w;
        const auto& other = node.parent >= 0 ? bodies.state[forest_.nodes()[node.parent].body].x_w
                            : node.base >= 0 ? bodies.state[node.base].x_w
                                             : forest_.record(node.joint).anchor;
        detail::for_axes<N>([&](int i) {
            gap[i] = J::template apart<J::gap_bits>(own[i], other[i]) +
                     J::template arm<J::gap_bits>(at.own_arm[i], at.own_log2) -
                     J::template arm<J::gap_bits>(at.arm[i], at.arm_log2);
        });
    }
    // Lets the arm of the other side go on along the free translation.
    [[gnu::noinline, gnu::cold]] void follow(const Node& node, Place& at, const auto& bodies) const {
        Open gap[3];
        set_gap(node, at, bodies, gap);
        int log2 = J::least_log2;
        for (const Open& g : gap)
            if (J::log2_of(g, J::gap_bits) > log2) log2 = J::log2_of(g, J::gap_bits);
        Vector way;
        for (int i = 0; i < 3; ++i) way[i] = J::unit_of(gap[i], log2, J::gap_bits);
        const Vector axis = at.other_axis[0];
        // Each component of the way is at most 1, and so is the arm: their sum is a Unit over four times the larger.
        const int both = (log2 > at.arm_log2 ? log2 : int{at.arm_log2}) + (N::fixed_point ? 2 : 0);
        const Vector along_axis = along(axis, narrow<Unit>(dot(down(axis, 1), way)));
        at.arm = Vector{down(at.arm, both - at.arm_log2) + down(along_axis, both - log2 - (N::fixed_point ? 1 : 0))};
        at.arm_log2 = static_cast<std::int8_t>(both);
    }
    // Of a distance: its line, two axes across it, and the arm of the other side, which goes on to the point of the
    // body.
    [[gnu::noinline]] void reach_over(const Node& node, int i,
                                      const auto& bodies) requires(features.has_joint_ranges()) {
        Place& at = end[i];
        Open(&apart)[3] = line_[i];
        set_gap(node, at, bodies, apart);
        const int above = J::log2_above(apart);
        const Unit one = N::template constant<Unit>(1);
        Vector half, along_line{Unit{}, one, Unit{}};
        for (int k = 0; k < 3; ++k) half[k] = J::down(J::unit_of(apart[k], above, J::gap_bits), 1);
        if (const Unit square = narrow<Unit>(dot(half, half)); square > Unit{}) {
            const auto root = J::inverse_root(square);
            for (int k = 0; k < 3; ++k) along_line[k] = root(half[k]);
            // The root is good to 2^-28, of which a long line would not close: one more step of Newton's.
            if constexpr (N::fixed_point)
                along_line -= along(along_line, J::down(narrow<Unit>(dot(along_line, along_line)) - one, 1));
        }
        int least = 0;
        for (int k = 1; k < 3; ++k)
            if (magnitude_of(along_line[k]) < magnitude_of(along_line[least])) least = k;
        Vector across = along(along_line, -along_line[least]);
        across[least] += one;
        const auto root = J::inverse_root(narrow<Unit>(dot(across, across)));
        for (int k = 0; k < 3; ++k) across[k] = root(across[k]);
        at.own_axis[0] = along_line;
        at.other_axis[0] = across;
        at.other_axis[1] = cross<Unit>(along_line, across);
        go_on(at, apart);
    }
    // By how much the line between the anchors is longer along an axis, in 2^(coarser - gap_bits) m.
    [[nodiscard]] Unit longer_than(Open length, const Vector& axis, int i, int coarser, bool& fits) const
        requires(features.has_joint_ranges()) {
        Vector rest;
        for (int k = 0; k < 3; ++k)
            rest[k] = J::clamped(J::coarser(line_[i][k] - J::along(length, axis[k]), coarser), fits);
        return narrow<Unit>(dot(axis, rest));
    }
    // Of the largest of the arms and the distance, whose arm has two bits to spare.
    [[nodiscard]] static int log2_of_line(const Place& at) {
        const int line = at.arm_log2 - (N::fixed_point ? 2 : 0);
        return at.own_log2 > line ? at.own_log2 : line;
    }
    // Notes the line between the anchors of a slider, and holds a hinge or a slider at an end of its range: there the
    // axes of the other side are turned, and its arm goes on, by what the end says.
    [[gnu::noinline]] void hold_at_end(const Node& node, int i,
                                       const auto& bodies) requires(features.has_joint_ranges()) {
        Place& at = end[i];
        const auto& range = forest_.range(node);
        if (JointKinds::turns[forest_.record(node.joint).kind] == 1) {
            if (range.end != 0) at.other_axis[1] = at_end(range, range.end, node, at);
            return;
        }
        set_gap(node, at, bodies, line_[i]);
        if (range.end == 0) return;
        Open way[3];
        const Open length = Forest::sign(node) > 0 ? range.length() : -range.length();
        for (int k = 0; k < 3; ++k) way[k] = J::along(length, at.other_axis[0][k]);
        go_on(at, way);
    }
    // The second axis of the other side, turned to an end of the range of a hinge.
    [[nodiscard]] static Vector at_end(const JointRange<N>& range, int e, const Node& node,
                                       const Place& at) requires(features.has_joint_ranges()) {
        const Vector axis{at.other_axis[0]}, from{at.other_axis[1]};
        const Unit sine = range.sine[e > 0 ? 1 : 0];
        return along(from, range.cosine[e > 0 ? 1 : 0]) +
               along(cross<Unit>(axis, from), Forest::sign(node) > 0 ? sine : Unit(-sine));
    }
    // Of a hinge more than half a radian from an end: its angle has the sign of the end, and a smaller cosine.
    [[nodiscard, gnu::noinline, gnu::cold]] static bool
    is_far_beyond(const JointRange<N>& range, int e, const Node& node,
                  const Place& at) requires(features.has_joint_ranges()) {
        const Vector own{at.own_axis[1]}, from{at.other_axis[1]};
        const Unit sine = narrow<Unit>(dot(Vector{at.own_axis[0]}, cross<Unit>(from, own)));
        if (e * Forest::sign(node) > 0 ? sine < Unit{} : sine > Unit{}) return false;
        return narrow<Unit>(dot(from, own)) < range.cosine[e > 0 ? 1 : 0];
    }
    // Lets the arm of the other side go on. Each component of both is at most 1: their sum is a Unit over four times
    // the larger.
    static void go_on(Place& at, const Open (&way)[3]) requires(features.has_joint_ranges()) {
        const int above = J::log2_above(way);
        const int both = (above > at.arm_log2 ? above : int{at.arm_log2}) + (N::fixed_point ? 2 : 0);
        Vector arm = down(at.arm, both - at.arm_log2);
        for (int k = 0; k < 3; ++k) arm[k] += J::unit_of(way[k], both, J::gap_bits);
        at.arm = arm;
        at.arm_log2 = static_cast<std::int8_t>(both);
    }
    // Adds the change of momentum of a body, and that of its angular momentum about the anchor, over its powers of two.
    static void add_change(const Node& node, const Vector& dv, const Vector& dw, Vector& p, Vector& h) {
        const int m = node.mass_log2 - node.own_mass_log2, l = node.length_log2 - node.own_length_log2;
        const Vector x = node.frame.axis(0), z = node.frame.axis(2);
        const Vector push = along(dv, J::down(node.mass, m));
        p += push;
        h += along(dw, J::down(node.moment_y, m + 2 * l)) +
             along(x, narrow<Unit>(mul(J::down(node.moment_x_less_y, m + 2 * l), narrow<Unit>(dot(x, dw))))) +
             along(z, narrow<Unit>(mul(J::down(node.moment_z_less_y, m + 2 * l), narrow<Unit>(dot(z, dw))))) -
             cross<Unit>(Vector{node.lever}, push);
    }
    // The length of the link of a slider, from above.
    [[gnu::noinline, gnu::cold]] static void set_span(Node& node, const Place& at, const Place& parent) {
        if constexpr (N::fixed_point) {
            std::int64_t sum = 2;
            for (int i = 0; i < 3; ++i) {
                const std::int64_t link = J::template arm<Forest::reach_bits>(at.arm[i], at.arm_log2) -
                                          J::template arm<Forest::reach_bits>(parent.own_arm[i], parent.own_log2);
                sum += link < 0 ? -link : link;
            }
            node.span = static_cast<std::int32_t>(sum < Forest::most_reach ? sum : Forest::most_reach);
        }
    }

    // The turn, rad, that closes the gap between the orientations to first order: joints/list.hpp.
    [[nodiscard]] static Vector lean(const Node& node, const Place& at) {
        const Vector own = at.own_axis[0], other = at.other_axis[0];
        Vector lean = Tree::across(own, other);
        if constexpr (JointKinds::any_turns(features, 2))
            if (node.turns == 2) lean = along(lean, -narrow<Unit>(dot(own, other)));
        if constexpr (JointKinds::any_turns(features, 0) || features.joint_limits)
            if (node.turns == 0)
                lean +=
                    along(own, narrow<Unit>(dot(own, Tree::across(Vector{at.own_axis[1]}, Vector{at.other_axis[1]}))));
        return lean;
    }
    // In 2^(coarser - gap_bits) m.
    [[nodiscard, gnu::noinline]] bool measure_gaps(const JointTreeState& tree, const auto& bodies, bool is_guess,
                                                   int coarser, bool& fits) {
        bool closed = true;
        fits = true;
        for (int i = tree.first; i < tree.last; ++i) {
            const Node& node = forest_.nodes()[i];
            Unit(&target)[6] = solution[i].target;
            set_three(target + 3, Vector::Constant(Unit{}));
            if (node.joint == Node::no_joint) {
                set_three(target, Vector::Constant(Unit{}));
                continue;
            }
            const Place& at = end[i];
            bool is_distance = false;
            if constexpr (features.has_joint_ranges())
                if (node.slides > 1) {
                    is_distance = true;
                    set_three(target, Vector::Constant(Unit{}));
                    if (node.slides > 2) continue;
                    const Unit longer =
                        longer_than(forest_.range(node).length(), Vector{at.own_axis[0]}, i, coarser, fits);
                    set_three(target, along(Vector{at.own_axis[0]}, -longer));
                }
            if (!is_distance) {
                Open gap[3];
                set_gap(node, at, bodies, gap);
                detail::for_axes<N>([&](int k) { target[k] = -J::clamped(J::coarser(gap[k], coarser), fits); });
            }
            int log2 = is_distance ? log2_of_line(at) : at.own_log2 > at.arm_log2 ? at.own_log2 : at.arm_log2;
            if (may_lean && node.turns < 3) {
                const Vector turn = lean(node, at);
                detail::for_axes<N>(
                    [&](int k) { target[3 + k] = J::lean(turn[k], node.length_log2, J::gap_bits - coarser, fits); });
                if (node.length_log2 > log2) log2 = node.length_log2;
            }
            // The axis of an end is rounded once more.
            if constexpr (features.has_joint_ranges())
                if (node.turns + node.slides == 0 && forest_.has_range(node)) log2 = (log2 > 1 ? log2 : 1) + 1;
            // A spin in 2^n parts rounds the orientation as often: a sum of 2^(n/2) roundings.
            int halvings = bodies.halvings_of(node.body);
            if (node.parent >= 0) halvings = larger_of(halvings, bodies.halvings_of(forest_.nodes()[node.parent].body));
            const int roundings = (halvings + 1) / 2;
            bool is_within = are_within(target, J::enough(is_guess, log2, roundings));
            if constexpr (!N::fixed_point)
                is_within = is_within ||
                            are_within(target, J::enough_of(is_guess, bodies.state[node.body].x_w, at.own_arm, at.arm));
            closed = closed && is_within;
        }
        return closed && fits;
    }
    // A change of motion less its parts along free directions, which are open to any.
    TUMBLE_INLINE static void leave_free(const Node& node, const Place& at, Vector& v, Vector& w) {
        if constexpr (JointKinds::any_slides(features, 1))
            if (node.slides == 1) leave(at.other_axis[0], v);
        if constexpr (features.has_joint_ranges()) {
            if (node.slides == 2) v = along(Vector{at.own_axis[0]}, narrow<Unit>(dot(Vector{at.own_axis[0]}, v)));
            if (node.slides == 3) v = Vector::Constant(Unit{});
        }
        if (node.turns == 3) {
            w = Vector::Constant(Unit{});
            return;
        }
        if (node.turns > 0) leave(at.own_axis[0], w);
        if constexpr (JointKinds::any_turns(features, 2))
            if (node.turns > 1) leave(at.other_axis[0], w);
    }
    [[gnu::noinline]] static void leave(const StoredVec3<Unit>& axis, Vector& change) {
        change -= along(axis, narrow<Unit>(dot(axis, change)));
    }
    // False of a number that is none.
    [[nodiscard]] TUMBLE_INLINE static bool are_within(const Unit (&target)[6], Unit limit) {
        for (const Unit a : target)
            if (!(magnitude_of(a) <= limit)) return false;
        return true;
    }

    // The spins of the bodies, in 2^-(what it returns): the finest that holds them.
    [[nodiscard, gnu::noinline]] int measure_spins(const JointTreeState& tree, const auto& bodies) {
        int of_spin = J::spin_bits;
        while (!measure_spins(tree, bodies, of_spin) && of_spin > J::coarse_spin_bits) of_spin -= 2;
        return of_spin;
    }
    [[nodiscard]] bool measure_spins(const JointTreeState& tree, const auto& bodies, int of_spin) {
        bool fits = true;
        for (int i = tree.first; i < tree.last; ++i) {
            const Node& node = forest_.nodes()[i];
            Vector own;
            const auto scale = bodies.spin_scale(node.body);
            detail::for_axes<N>([&](int k) {
                own[k] =
                    J::clamped_half(J::angle(turn_of(bodies, node.body, k), node.to_angle[k], scale, of_spin), fits);
            });
            spin_[i] = Tree::to_world(end[i].axes, own);
        }
        return fits;
    }
    [[nodiscard]] TUMBLE_INLINE static typename N::Turn turn_of(const auto& bodies, int b, int k) {
        return N::narrow_turn(N::sum(bodies.state[b].t_b[k]));
    }
    // Of a spin, at an arm.
    [[gnu::noinline]] void set_swept(const Vector& spin, const StoredVec3<Unit>& arm, int log2, int of_rate,
                                     Open (&rate)[3]) const {
        const decltype(cross_component<0>(spin, arm)) product[3]{
            cross_component<0>(spin, arm), cross_component<1>(spin, arm), cross_component<2>(spin, arm)};
        detail::for_axes<N>([&](int k) { rate[k] = J::swept(product[k], log2, of_spin_, of_rate); });
    }
    [[nodiscard, gnu::noinline]] bool measure_rates(const JointTreeState& tree, const auto& bodies, int of_rate) {
        bool fits = true;
        for (int i = tree.first; i < tree.last; ++i) {
            const Node& node = forest_.nodes()[i];
            auto& s = solution[i];
            Vector v = Vector::Constant(Unit{}), w = v;
            if (node.joint != Node::no_joint) {
                const Place& at = end[i];
                const auto& d = bodies.state[node.body].d_w;
                Open rate[3];
                set_swept(spin_[i], at.own_arm, at.own_log2, of_rate, rate);
                w = spin_[i];
                if (node.parent >= 0) {
                    const auto& other = bodies.state[forest_.nodes()[node.parent].body].d_w;
                    Open of_other[3];
                    set_swept(spin_[node.parent], at.arm, at.arm_log2, of_rate, of_other);
                    detail::for_axes<N>(
                        [&](int k) { rate[k] += J::drift_apart(d[k], other[k], bodies.scale, of_rate) - of_other[k]; });
                    w -= spin_[node.parent];
                } else {
                    detail::for_axes<N>([&](int k) { rate[k] += J::drift(d[k], bodies.scale, of_rate); });
                }
                detail::for_axes<N>([&](int k) { v[k] = -J::clamped(rate[k], fits); });
                leave_free(node, at, v, w);
                detail::for_axes<N>(
                    [&](int k) { w[k] = -J::clamped(J::turned(w[k], node.length_log2, of_spin_, of_rate), fits); });
            }
            set_three(s.target, v);
            set_three(s.target + 3, w);
        }
        return fits;
    }
    // Brings the targets to the bits of a solution.
    void scale(const JointTreeState& tree, int of_target) {
        bits = of_target;
        if constexpr (N::fixed_point) {
            Unit largest{};
            for (int i = tree.first; i < tree.last; ++i)
                for (const Unit a : solution[i].target) largest = larger_of(largest, magnitude_of(a));
            const int up = J::up_for(largest, tree.open_bits);
            bits += up;
            for (int i = tree.first; i < tree.last; ++i)
                for (Unit& a : solution[i].target) a = J::shifted(a, up);
        }
    }

    [[nodiscard, gnu::noinline, gnu::cold]] static Vector twice_across(const Vector& a, const Vector& b) {
        const Vector across = Tree::across(a, b);
        return across + across;
    }
    // The turn at the end by a change dw of the spin. Momenta are I_i / I_x times spins, over half a step where L is.
    // With q a quarter of the turn, the middle sees L, as the end has it, as L + 2 q x L to first order. The mean of
    // the axes at both ends stands for those in the middle: it shrinks what is across the turn by 1 - 2 |q|^2, twice.
    // Both count where the turn is more than 1/16 rad.
    [[nodiscard]] Vector turn_by(const Node& node, const Vector& dw, const auto& bodies, const Place& at, int halvings,
                                 const auto& of_flight) const {
        const auto scale = bodies.spin_scale(node.body);
        Axes<N> middle;
        for (int i = 0; i < 3; ++i)
            detail::for_axes<N>([&](int j) { middle.row[i][j] = J::mean(node.frame.row[i][j], at.axes.row[i][j]); });
        Vector turn = Tree::to_body(middle, dw), quarter, momentum;
        detail::for_axes<N>([&](int k) __attribute__((always_inline)) {
            turn[k] = node.per_share[k](narrow<Unit>(mul(turn[k], node.share[k])));
            quarter[k] = of_flight(J::quarter(turn_of(bodies, node.body, k), node.to_angle[k], scale, halvings));
            momentum[k] = narrow<Unit>(mul(quarter[k], node.share[k]));
            momentum[k] += momentum[k];
        });
        const bool is_far = J::is_far(quarter[0]) || J::is_far(quarter[1]) || J::is_far(quarter[2]);
        if (is_far) momentum += twice_across(quarter, momentum);
        const Vector more = Tree::across(momentum, turn);
        detail::for_axes<N>([&](int k) { turn[k] += node.per_share[k](more[k]); });
        if (is_far) turn -= twice_across(quarter, twice_across(quarter, turn));
        return Tree::to_world(middle, turn);
    }
};

}  // namespace tumble

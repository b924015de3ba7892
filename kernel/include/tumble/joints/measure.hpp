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
            if (node.slides > 0) follow(node, at, bodies);
        }
    }
    // Takes `end` over as the places of the factor, and factors.
    [[gnu::noinline]] void factor(JointTreeState& tree) {
        bool slides = false;
        for (int i = tree.first; i < tree.last; ++i) {
            Node& node = forest_.nodes()[i];
            node.place = end[i];
            if (node.parent >= 0 && node.slides > 0) {
                set_span(node);
                slides = true;
            }
        }
        if (slides) forest_.fit_lengths(tree);
        for (int i = tree.first; i < tree.last; ++i) {
            Node& node = forest_.nodes()[i];
            if (node.parent < 0) continue;
            const Node& parent = forest_.nodes()[node.parent];
            node.link = Vector{over(node.place.arm, parent.length_log2 - node.place.arm_log2) -
                               down(parent.place.own_arm, parent.length_log2 - parent.place.own_log2)};
        }
        forest_.solver(tree).factor();
    }

    // Measures the gaps at `end` and sets the targets that close them. True where all are closed.
    [[gnu::noinline]] bool gaps(const JointTreeState& tree, const auto& bodies) {
        bool fits = true;
        bool closed = measure_gaps<J::gap_bits>(tree, bodies, fits);
        if (!fits) [[unlikely]] {
            bool held = true;
            (void)measure_gaps<J::coarse_gap_bits>(tree, bodies, held);
            closed = false;
            scale(tree, J::coarse_gap_bits);
        } else if (!closed) {
            scale(tree, J::gap_bits);
        }
        return closed;
    }
    // Measures the rates across the joints, with the factor's places, and sets the targets that end them.
    [[gnu::noinline]] void rates(const JointTreeState& tree, const auto& bodies) {
        of_spin_ = measure_spins(tree, bodies);
        int of_rate = J::rate_bits;
        if (!measure_rates(tree, bodies, of_spin_, of_rate)) [[unlikely]] {
            of_rate = J::coarse_rate_bits;
            (void)measure_rates(tree, bodies, of_spin_, of_rate);
        }
        scale(tree, of_rate);
    }
    // Takes from the targets what the solution does to the gaps at the end of a flight, by the tangent of a free
    // flight: the centre of mass moves by dv. With the change dL of the angular momentum, constant in the world, L
    // itself and the inertia I in the middle of the flight, the body turns by phi with phi' = I^-1 (dL + L x phi):
    //   phi = I^-1 (dL + (h / 2) L x I^-1 dL) h
    // over a step h to second order. `solution` is in the world's axes of the start, phi in those of the end.
    [[gnu::noinline]] void take_off_effect(const JointTreeState& tree, const auto& bodies, int halvings) {
        for (int i = tree.first; i < tree.last; ++i)
            turn_[i] = turn_by(forest_.nodes()[i], solution[i].dw, bodies, end[i], halvings);
        for (int i = tree.first; i < tree.last; ++i) {
            const Node& node = forest_.nodes()[i];
            if (node.joint == Node::no_joint) continue;
            auto& s = solution[i];
            const Place& at = end[i];
            // Turns are times the length: arms are over it.
            Vector v = s.dv + cross<Unit>(turn_[i], down(at.own_arm, node.length_log2 - at.own_log2)), w = turn_[i];
            if (node.parent >= 0) {
                const int parent_log2 = forest_.nodes()[node.parent].length_log2;
                v -=
                    solution[node.parent].dv + cross<Unit>(turn_[node.parent], over(at.arm, parent_log2 - at.arm_log2));
                w -= down(turn_[node.parent], node.length_down);
            }
            leave_free(node, at, v, w);
            s.target_v -= v;
            s.target_w -= w;
        }
    }
    // After rates() and their solution, which ends a part of 2^-halvings of a step: the halvings that keep the turn of
    // a part below 1/4 rad and h^2 f r / I, summed over the joints of a body with the forces f of this part, below 1/4.
    // A sixteenth of that of 4, at which the swing across an arm is unstable: errors of a part stay small.
    [[nodiscard, gnu::noinline]] int halvings_for(const JointTreeState& tree, int halvings) {
        typename J::Load load[most_nodes]{};
        int wanted = 0;
        for (int i = tree.first; i < tree.last; ++i) solution[i].p = Vector::Constant(Unit{});
        for (int i = tree.last - 1; i >= tree.first; --i) {
            const Node& node = forest_.nodes()[i];
            auto& s = solution[i];
            // h^2 f / 2 in whole steps, of the joint and what hangs on it.
            const Vector force = s.p + along(s.dv, J::down(node.mass, node.mass_log2 - node.own_mass_log2));
            if (node.joint != Node::no_joint)
                load[i] += J::load(force, node.swing[0], node.mass_log2 - bits + halvings + 1);
            if (node.parent >= 0) {
                load[node.parent] += J::load(force, node.swing[1], node.mass_log2 - bits + halvings + 1);
                solution[node.parent].p += down(force, node.mass_down);
            }
            while (wanted <= most_halvings &&
                   (J::turns_too_far(spin_[i], of_spin_, wanted) || J::is_too_strong(load[i], wanted)))
                ++wanted;
        }
        return wanted;
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

    Forest& forest_;
    int of_spin_ = 0;          // of spin_
    Vector spin_[most_nodes];  // of the bodies in the world's axes
    Vector turn_[most_nodes];

    [[nodiscard]] TUMBLE_INLINE static Vector down(const Vector& v, int bits) { return JointTree<N>::down(v, bits); }
    [[nodiscard]] TUMBLE_INLINE static Vector over(const Vector& v, int bits) {
        return {J::over(v[0], bits), J::over(v[1], bits), J::over(v[2], bits)};
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
    // Places of both sides, without arms.
    template <class F>
    TUMBLE_INLINE void with_places(const Node& node, const auto& bodies, F&& f) const {
        const auto& own = bodies.state[node.body].x_w;
        if (node.parent >= 0) f(own, bodies.state[forest_.nodes()[node.parent].body].x_w);
        else if (node.base >= 0) f(own, bodies.state[node.base].x_w);
        else f(own, forest_.record(node.joint).anchor);
    }
    template <int of_gap>
    TUMBLE_INLINE void set_gap(const Node& node, const Place& at, const auto& bodies, Open (&gap)[3]) const {
        with_places(node, bodies, [&](const auto& own, const auto& other) {
            for (int i = 0; i < 3; ++i)
                gap[i] = J::template apart<of_gap>(own[i], other[i]) +
                         J::template arm<of_gap>(at.own_arm[i], at.own_log2) -
                         J::template arm<of_gap>(at.arm[i], at.arm_log2);
        });
    }
    // Lets the arm of the other side go on along the free translation.
    [[gnu::noinline]] void follow(const Node& node, Place& at, const auto& bodies) const {
        Open gap[3];
        set_gap<J::gap_bits>(node, at, bodies, gap);
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
    // The length of the link of a slider, from above.
    void set_span(Node& node) const {
        if constexpr (N::fixed_point) {
            const Place& parent = forest_.nodes()[node.parent].place;
            std::int64_t sum = 2;
            for (int i = 0; i < 3; ++i) {
                const std::int64_t link = J::template arm<Forest::reach_bits>(node.place.arm[i], node.place.arm_log2) -
                                          J::template arm<Forest::reach_bits>(parent.own_arm[i], parent.own_log2);
                sum += link < 0 ? -link : link;
            }
            node.span = static_cast<std::int32_t>(sum < Forest::most_reach ? sum : Forest::most_reach);
        }
    }

    template <int of_gap>
    [[nodiscard]] bool measure_gaps(const JointTreeState& tree, const auto& bodies, bool& fits) {
        bool closed = true;
        for (int i = tree.first; i < tree.last; ++i) {
            const Node& node = forest_.nodes()[i];
            auto& s = solution[i];
            s.target_v = s.target_w = Vector::Constant(Unit{});
            if (node.joint == Node::no_joint) continue;
            const Place& at = end[i];
            Open gap[3];
            set_gap<of_gap>(node, at, bodies, gap);
            for (int k = 0; k < 3; ++k) s.target_v[k] = -J::held(gap[k], fits);
            JointKinds::with(node.kind, [&]<class Kind>() {
                if constexpr (Kind::turns < 3) {
                    const Vector lean = Kind::lean(at);
                    for (int k = 0; k < 3; ++k)
                        s.target_w[k] = J::held(J::template lean<of_gap>(lean[k], node.length_log2), fits);
                }
            });
            int log2 = at.own_log2 > at.arm_log2 ? at.own_log2 : at.arm_log2;
            if (node.turns < 3 && node.length_log2 > log2) log2 = node.length_log2;
            // A spin in 2^n parts rounds the orientation as often: a sum of 2^(n/2) roundings.
            int halvings = bodies.halvings_of(node.body);
            if (node.parent >= 0) halvings = larger(halvings, bodies.halvings_of(forest_.nodes()[node.parent].body));
            const Unit enough =
                J::enough(log2, (halvings + 1) / 2, bodies.state[node.body].x_w.value(), at.own_arm, at.arm);
            for (int k = 0; k < 3; ++k)
                closed = closed && is_within(s.target_v[k], enough) && is_within(s.target_w[k], enough);
        }
        return closed;
    }
    // A change of motion less its parts along free directions, which are open to any.
    TUMBLE_INLINE static void leave_free(const Node& node, const Place& at, Vector& v, Vector& w) {
        const auto leave = [](const Vector& axis, Vector& change) {
            change -= along(axis, narrow<Unit>(dot(axis, change)));
        };
        JointKinds::with(node.kind, [&]<class Kind>() {
            if constexpr (Kind::slides > 0)
                for (int s = 0; s < Kind::slides; ++s) leave(Kind::slide(at, s), v);
            if constexpr (Kind::turns == 3) w = Vector::Constant(Unit{});
            else if constexpr (Kind::turns > 0)
                for (int r = 0; r < Kind::turns; ++r) leave(Kind::turn(at, r), w);
        });
    }
    [[nodiscard]] TUMBLE_INLINE static int larger(int a, int b) { return a > b ? a : b; }
    // False of a number that is none.
    [[nodiscard]] TUMBLE_INLINE static bool is_within(Unit a, Unit limit) { return a <= limit && a >= -limit; }

    // The spins of the bodies, in 2^-(what it returns): the finest that holds them.
    [[nodiscard]] int measure_spins(const JointTreeState& tree, const auto& bodies) {
        int of_spin = J::spin_bits;
        while (!measure_spins(tree, bodies, of_spin) && of_spin > J::coarse_spin_bits) of_spin -= 2;
        return of_spin;
    }
    [[nodiscard]] bool measure_spins(const JointTreeState& tree, const auto& bodies, int of_spin) {
        bool fits = true;
        for (int i = tree.first; i < tree.last; ++i) {
            const Node& node = forest_.nodes()[i];
            Vector own;
            for (int k = 0; k < 3; ++k) {
                const Open angle =
                    J::angle(turn_of(bodies, node.body, k), node.to_angle[k], bodies.spin_scale(node.body), of_spin);
                own[k] = J::held_half(angle, fits);
            }
            spin_[i] = end[i].axes.to_world(own);
        }
        return fits;
    }
    [[nodiscard]] TUMBLE_INLINE static typename N::Turn turn_of(const auto& bodies, int b, int k) {
        return N::narrow_turn(N::sum(bodies.state[b].t_b[k]));
    }
    [[nodiscard]] bool measure_rates(const JointTreeState& tree, const auto& bodies, int of_spin, int of_rate) {
        bool fits = true;
        for (int i = tree.first; i < tree.last; ++i) {
            const Node& node = forest_.nodes()[i];
            auto& s = solution[i];
            s.target_v = s.target_w = Vector::Constant(Unit{});
            if (node.joint == Node::no_joint) continue;
            Vector w = spin_[i], v;
            if (node.parent >= 0) w -= spin_[node.parent];
            const auto set_component = [&]<int k>() {
                const Place& at = node.place;
                const auto& d = bodies.state[node.body].d_w;
                Open rate = J::template swept<k>(spin_[i], at.own_arm, at.own_log2, of_spin, of_rate);
                if (node.parent >= 0)
                    rate += J::drift_apart(d[k], bodies.state[forest_.nodes()[node.parent].body].d_w[k], bodies.scale,
                                           of_rate) -
                            J::template swept<k>(spin_[node.parent], at.arm, at.arm_log2, of_spin, of_rate);
                else rate += J::drift(d[k], bodies.scale, of_rate);
                v[k] = -J::held(rate, fits);
            };
            set_component.template operator()<0>();
            set_component.template operator()<1>();
            set_component.template operator()<2>();
            leave_free(node, node.place, v, w);
            s.target_v = v;
            for (int k = 0; k < 3; ++k)
                s.target_w[k] = -J::held(J::turned(w[k], node.length_log2, of_spin, of_rate), fits);
        }
        return fits;
    }
    // Brings the targets to the bits of a solution.
    void scale(const JointTreeState& tree, int of_target) {
        bits = of_target;
        if constexpr (N::fixed_point) {
            Unit largest{};
            for (int i = tree.first; i < tree.last; ++i)
                for (int k = 0; k < 3; ++k) {
                    largest = larger_of(largest, magnitude_of(solution[i].target_v[k]));
                    largest = larger_of(largest, magnitude_of(solution[i].target_w[k]));
                }
            const int up = J::up_for(largest, tree.open_bits);
            bits += up;
            for (int i = tree.first; i < tree.last; ++i)
                for (int k = 0; k < 3; ++k) {
                    solution[i].target_v[k] = J::shifted(solution[i].target_v[k], up);
                    solution[i].target_w[k] = J::shifted(solution[i].target_w[k], up);
                }
        }
    }

    // A vector that is constant in the world, in the body's axes half a flight later. `quarter` is a quarter of the
    // turn: v - 2 (q x v) + 2 q x (q x v), to second order.
    [[nodiscard]] TUMBLE_INLINE static Vector half_a_flight_later(const Vector& quarter, const Vector& v) {
        const Vector across = cross<Unit>(quarter, v), change = cross<Unit>(quarter, across) - across;
        return v + change + change;
    }
    // The turn at the end by a change dw of the spin. Momenta are I_i / I_x times spins, over half a step where L is.
    [[nodiscard]] Vector turn_by(const Node& node, const Vector& dw, const auto& bodies, const Place& at,
                                 int halvings) const {
        const auto scale = bodies.spin_scale(node.body);
        Vector change = node.place.axes.to_body(dw), quarter, momentum;
        for (int k = 0; k < 3; ++k) {
            change[k] = narrow<Unit>(mul(change[k], node.share[k]));
            quarter[k] = J::quarter(turn_of(bodies, node.body, k), node.to_angle[k], scale, halvings);
            momentum[k] = narrow<Unit>(mul(quarter[k], node.share[k]));
            momentum[k] += momentum[k];
        }
        const auto over_inertia = [&](const Vector& v) {
            return Vector{node.per_share[0](v[0]), node.per_share[1](v[1]), node.per_share[2](v[2])};
        };
        Vector turn = over_inertia(half_a_flight_later(quarter, change));
        turn += over_inertia(cross<Unit>(half_a_flight_later(quarter, momentum), turn));
        return at.axes.to_world(half_a_flight_later(quarter, turn));
    }
};

}  // namespace tumble

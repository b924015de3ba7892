// The step of trees of joints: RATTLE (Andersen 1983, "RATTLE: a velocity version of the SHAKE algorithm"; for rigid
// bodies and any symmetric flight McLachlan, Modin, Verdier, Wilkins 2014, "Geometric generalisations of SHAKE and
// RATTLE"). With u the velocities, G the rows of the joints, M masses and moments:
//   P is the half kick that ended the last step. Repeat: u += P; fly; c = the gaps at the end; done where they are
//     closed; P += d, d = M^-1 G0^T l with G0 d h = -c along the rows of the start, refined once by the tangent T of
//     the flight: r = -c - G1 T d, d += M^-1 G0^T (G0 M^-1 G0^T)^-1 r / h.
//   At the end P = -M^-1 G1^T (G1 M^-1 G1^T)^-1 G1 u, u += P: the rates across the joints end.
// It is symplectic and of order two if the flight is, so the energy has no trend. The half kick that ends a step acts
// at the same place and along the same rows as the one that begins the next, and is its best guess: no other memory is
// needed, and a chain takes one correction a step.
//
// RATTLE is explicit in what the force f of a joint does to a link across its arm r, whose moment is I: h^2 f r / I
// must stay below 4, and Newton's iteration finds the next root only where a link turns by less than half a radian. So
// a step is flown in 2^n parts, as many as both bounds ask for at the beginning and at the end of each part
// (JointMeasures::halvings_for()): a part after which more are asked for is flown again. A choice by the beginning
// alone takes long parts into a jerk and short ones out of it, and each jerk takes energy. A part that does not close
// in most_corrections, or whose half kicks are beyond the range, is halved too. After most_halvings it is projected: it
// flies without its joints, places are moved until the gaps are closed, and the rates across the joints end, which can
// only lower the kinetic energy. It is reported. Half kicks are those of a part.
//
// This is of order two. A composition of such parts, some of negative length, has the order of the composition
// (Suzuki, see integrators/suzuki4.hpp): each of its pieces is a flight and a pair of half kicks of its own. The motion
// is reversible, so a half kick of a piece is that of the one before times the ratio of their lengths, and the guess of
// it. Ranges of joints end and slacken in pieces that go forward.
#pragma once

#include <tumble/body/orientation.hpp>
#include <tumble/joints/measure.hpp>

namespace tumble {

// Trees that a step flies together.
template <int capacity>
struct JointTrees {
    static constexpr int room = capacity;
    int count = 0;
    std::int16_t tree[capacity];

    JointTrees() = default;
    explicit JointTrees(int t) { add(t); }
    void add(int t) { tree[count++] = static_cast<std::int16_t>(t); }
};

// `couples`: trees step together where loads couple their bodies. Else each steps by itself. `Pieces` of a part: count,
// and of(i), their lengths in parts, of which the first and the last are the same.
template <class Bodies, Features features, bool couples, class Pieces>
class JointHold {
public:
    using N = typename Bodies::Numbers;
    using Forest = JointForest<N, features>;
    using Trees = JointTrees<couples ? Forest::most_trees : 1>;
    using Group = BodyGroup<features.bodies>;
    static constexpr int most_corrections = 10, most_projections = 8, most_halvings = Forest::most_halvings;

    // Of a part of 2^-halvings of a step, in steps.
    [[nodiscard]] static typename N::Work length_of_part(int halvings) {
        using Work = typename N::Work;
        if constexpr (N::fixed_point) return N::times_power_of_two(Work(1), -halvings);
        else return Work(1) / Work(1 << halvings);
    }

    JointHold(Forest& forest, Bodies& bodies, const Trees& trees)
        : forest_{forest}, bodies_{bodies}, trees_{trees}, measures_{forest} {}

    // One step of a group, which holds all bodies of the trees. fly(n, i): moves the group over piece i of a part of
    // 2^-n of the step. spin_changed(b): something other than a flight has changed the spin of b.
    // `may_rest`: nothing acts on the trees that changes by itself. They are at rest where no part of them has moved
    // for half a second by more than what counts as closed, as rounding does. Then their motion ends.
    template <class Fly, class SpinChanged>
    void step(const Group& group, Fly&& fly, SpinChanged&& spin_changed, bool may_rest) {
        halvings_ = 0;
        each([&](JointTreeState& tree) {
            if (tree.is_moved || tree.is_disturbed || !tree.is_factored) [[unlikely]]
                settle(tree, spin_changed);
            tree.corrections = 0;
            if (tree.halvings > halvings_) halvings_ = tree.halvings;
        });
        each([&](const JointTreeState& tree) { scale_kicks(tree, tree.halvings, halvings_); });
        for (int part = 0; part < 1 << halvings_;) {
            if (is_taken(group, fly, spin_changed)) [[likely]] {
                ++part;
            } else {
                halve();
                part *= 2;
            }
        }
        each([&](JointTreeState& tree) {
            scale_kicks(tree, halvings_, tree.halvings);
            if (forest_.comes_to_rest(tree, bodies_, may_rest)) [[unlikely]]
                end_motion(tree, spin_changed);
        });
    }

private:
    using Unit = typename N::Unit;
    using Vector = Vec3<Unit>;
    using J = JointNumbers<N>;
    using Node = JointNode<N>;

    Forest& forest_;
    Bodies& bodies_;
    const Trees& trees_;
    JointMeasures<N, features> measures_;
    Vector first_v_[Forest::most_nodes], first_w_[Forest::most_nodes];
    // Where a flight begins: motions, status, half kicks of the joints, and the ends at which those with a range are.
    struct Start {
        SavedMotions<Bodies> motions;
        Status status;
        Kick<N> guess[Forest::most_nodes];
        [[no_unique_address]] If<features.has_joint_ranges(), std::int8_t[Forest::most_nodes], 25> end;
    };
    static constexpr bool has_pieces = Pieces::count > 1;
    Start start_;
    int halvings_ = 0;  // of the step, in the present part
    // Of joints with a range: whether the end has changed in the part.
    [[no_unique_address]] If<features.has_joint_ranges(), bool[Forest::most_nodes], 24> is_changed_;
    [[no_unique_address]] If<has_pieces, Start, 26> part_;  // where the part begins
    [[no_unique_address]] If<has_pieces, int, 27> piece_{};

    [[nodiscard]] int piece() const {
        if constexpr (has_pieces) return piece_;
        else return 0;
    }
    // A number as a fraction times 2^doublings.
    struct Factor {
        typename N::Fraction fraction;
        int doublings;
        static consteval Factor of(Real a) {
            int doublings = 0;
            for (; abs(a) >= Real{1}; ++doublings) a = a * Real::scaled(1, -1);
            return {N::template constant<typename N::Fraction>(a), doublings};
        }
    };
    struct Factors {
        consteval Factors() {
            for (int i = 0; i < Pieces::count; ++i) {
                per_part[i] = Factor::of(Real{1} / Pieces::of(i));
                to_next[i] = Factor::of(Pieces::of((i + 1) % Pieces::count) / Pieces::of(i));
                length[i] = N::template constant<Unit>(Pieces::of(i));
                goes_back[i] = Pieces::of(i).is_negative();
            }
        }
        Factor per_part[Pieces::count]{};  // parts in a piece
        Factor to_next[Pieces::count]{};   // the next piece in this one
        Unit length[Pieces::count]{};      // in parts
        bool goes_back[Pieces::count]{};
    };
    static constexpr Factors factors{};
    [[nodiscard]] bool goes_back() const { return has_pieces && factors.goes_back[piece()]; }

    // Takes a part. Where it has to be shorter the group is where the part begins, and the result is false.
    template <class Fly, class SpinChanged>
    [[nodiscard]] bool is_taken(const Group& group, Fly& fly, SpinChanged& spin_changed) {
        if constexpr (has_pieces) {
            save(part_, group);
            for (piece_ = 0; piece_ < Pieces::count; ++piece_) {
                if (!is_flown(group, fly, spin_changed)) {
                    begin_part_anew(part_, group, spin_changed);
                    return false;
                }
                each([&](const JointTreeState& tree) { stretch_kicks(tree, factors.to_next[piece_]); });
            }
            return true;
        } else {
            return is_flown(group, fly, spin_changed);
        }
    }
    template <class Fly, class SpinChanged>
    [[nodiscard]] TUMBLE_INLINE bool is_flown(const Group& group, Fly& fly, SpinChanged& spin_changed) {
        const bool moved = is_moved(group, fly, spin_changed);
        if (!moved) [[unlikely]] {
            if (halvings_ < most_halvings) return false;
            project(fly);
        }
        int wanted = 0;
        each([&](JointTreeState& tree) {
            end(tree, spin_changed);
            if (!moved) [[unlikely]]
                scale_kicks(tree, 0, 1);  // it flew without joints, so the kick at its end is a whole one
            if (tree.halvings > wanted) wanted = tree.halvings;
        });
        if (wanted <= halvings_) [[likely]]
            return true;
        if constexpr (!has_pieces) begin_part_anew(start_, group, spin_changed);
        return false;
    }
    template <class SpinChanged>
    void begin_part_anew(const Start& from, const Group& group, SpinChanged& spin_changed) {
        go_back(from, group, spin_changed);
        each([&](JointTreeState& tree) {
            if constexpr (features.has_joint_ranges())
                for (int i = tree.first; i < tree.last; ++i)
                    if (Node& node = forest_.nodes()[i]; forest_.has_range(node)) forest_.set_end(node, from.end[i]);
            begin_anew(from, tree);
            tree.is_disturbed = false;
        });
    }
    // From the beginning of a part to half of it.
    [[gnu::noinline, gnu::cold]] void halve() {
        each([&](const JointTreeState& tree) { scale_kicks(tree, halvings_, halvings_ + 1); });
        ++halvings_;
    }
    // Moves the group over a part, closed at its end. Else it is where the part begins, and the result is false.
    template <class Fly, class SpinChanged>
    [[nodiscard]] bool is_moved(const Group& group, Fly& fly, SpinChanged& spin_changed) {
        save(start_, group);
        if constexpr (features.has_joint_ranges())
            each([&](const JointTreeState& tree) {
                each_node(tree, [&](const Node&, int i) { is_changed_[i] = false; });
            });
        for (int corrections = 0;; ++corrections) {
            each([&](const JointTreeState& tree) { kick(tree, spin_changed); });
            fly(halvings_, piece());
            bool closed = true, within = true;
            each([&](JointTreeState& tree) {
                if (!is_closed(tree, corrections == 0)) {
                    closed = false;
                    if (tree.corrections < INT8_MAX) ++tree.corrections;
                    correct(tree, within);
                }
            });
            if constexpr (features.has_joint_ranges()) {
                if (closed) {
                    bool is_other = false;
                    each([&](const JointTreeState& tree) { is_other = change_ends(tree) || is_other; });
                    if (!is_other) return true;
                    go_back(start_, group, spin_changed);
                    each([&](JointTreeState& tree) { begin_anew(start_, tree); });
                    corrections = -1;
                    continue;
                }
            }
            if (closed) return true;
            go_back(start_, group, spin_changed);
            if (corrections == most_corrections || (!within && halvings_ < most_halvings)) [[unlikely]]
                break;
        }
        each([&](const JointTreeState& tree) { take_guess(start_, tree); });
        return false;
    }
    TUMBLE_INLINE void save(Start& start, const Group& group) {
        for (int k = 0; k < group.count; ++k) start.motions.save(k, bodies_, group.id[k]);
        start.status = bodies_.status;
        each([&](const JointTreeState& tree) {
            each_node(tree, [&](const Node&, int i) { copy(start.guess[i], forest_.kicks()[i]); });
        });
        if constexpr (features.has_joint_ranges())
            each([&](const JointTreeState& tree) {
                each_node(tree, [&](const Node& node, int i) {
                    if (forest_.has_range(node)) start.end[i] = forest_.range(node).end;
                });
            });
    }

    // Without a call.
    static void copy(Kick<N>& to, const Kick<N>& from) {
        for (int k = 0; k < 3; ++k) {
            to.linear[k] = from.linear[k];
            to.angular[k] = from.angular[k];
            detail::keep_apart();
        }
    }
    template <class F>
    void each(F&& f) {
        if constexpr (Trees::room == 1) f(forest_.tree(trees_.tree[0]));
        else
            for (int t = 0; t < trees_.count; ++t) f(forest_.tree(trees_.tree[t]));
    }
    template <class F>
    void each_node(const JointTreeState& tree, F&& f) {
        for (int i = tree.first; i < tree.last; ++i) f(forest_.nodes()[i], i);
    }

    template <class SpinChanged>
    [[gnu::noinline, gnu::cold]] void end_motion(JointTreeState& tree, SpinChanged& spin_changed) {
        tree.corrections = 0;
        each_node(tree, [&](const Node& node, int) {
            auto& state = bodies_.state[node.body];
            for (int k = 0; k < 3; ++k) {
                state.d_w[k] = {};
                state.t_b[k] = {};
            }
            spin_changed(node.body);
        });
    }
    // Closes gaps and ends rates that something other than a step has left.
    template <class SpinChanged>
    [[gnu::noinline, gnu::cold]] void settle(JointTreeState& tree, SpinChanged& spin_changed) {
        if (tree.is_moved && !close(tree)) report(Issue::joint_open, tree);
        tree.is_moved = false;
        measures_.place(tree, bodies_);
        if (!tree.is_factored) measures_.factor(tree);
        tree.is_factored = true;
        if (!tree.is_disturbed) return;
        find_end(tree);
        each_node(tree, [&](const Node& node, int i) { push_far(node.body, change(node, i, 0), spin_changed); });
        const int before = tree.halvings;
        divide(tree, measures_.halvings_of_turns(tree, bodies_, before));
        scale_kicks(tree, before, tree.halvings);
        tree.is_disturbed = false;
    }
    template <class SpinChanged>
    void kick(const JointTreeState& tree, SpinChanged& spin_changed) {
        each_node(tree, [&](const Node& node, int i) { push(node.body, forest_.kicks()[i], spin_changed); });
    }
    [[nodiscard]] bool is_closed(const JointTreeState& tree, bool is_guess) {
        measures_.place(tree, bodies_);
        return measures_.gaps(tree, bodies_, is_guess);
    }
    // Clears `within` where a kick is held.
    void correct(const JointTreeState& tree, bool& within) {
        solve(tree);
        each_node(tree, [&](const Node&, int i) {
            first_v_[i] = measures_.solution[i].dv;
            first_w_[i] = measures_.solution[i].dw;
        });
        if constexpr (has_pieces)
            measures_.take_off_effect(tree, bodies_, halvings_,
                                      [&](Unit turn) { return narrow<Unit>(mul(turn, factors.length[piece_])); });
        else measures_.take_off_effect(tree, bodies_, halvings_, [](Unit turn) { return turn; });
        solve(tree);
        each_node(tree, [&](const Node& node, int i) {
            measures_.solution[i].dv += first_v_[i];
            measures_.solution[i].dw += first_w_[i];
            Kick<N> more = change(node, i, halvings_);
            if constexpr (has_pieces) more = times(more, factors.per_part[piece_], within);
            add(forest_.kicks()[i], more, within);
        });
    }
    // Adds to a half kick, held within a quarter of the range. Clears `within` where it is.
    [[gnu::noinline]] static void add(Kick<N>& to, const Kick<N>& change, bool& within) {
        detail::for_axes<N>([&](int k) {
            to.linear[k] = J::clamped(to.linear[k] + J::clamped(change.linear[k], within), within);
            to.angular[k] = J::clamped(to.angular[k] + J::clamped(change.angular[k], within), within);
        });
    }
    [[nodiscard]] static Kick<N> times(Kick<N> kick, const Factor& factor, bool& within) {
        for (int k = 0; k < 3; ++k) {
            kick.linear[k] = N::part(kick.linear[k], factor.fraction);
            kick.angular[k] = N::part(kick.angular[k], factor.fraction);
        }
        for (int n = 0; n < factor.doublings; ++n) add(kick, kick, within);
        return kick;
    }
    void stretch_kicks(const JointTreeState& tree, const Factor& factor) {
        bool within = true;
        each_node(tree, [&](const Node&, int i) { forest_.kicks()[i] = times(forest_.kicks()[i], factor, within); });
    }
    // Half kicks are of a part: those of 2^-from of a step become those of 2^-to with the same forces.
    void scale_kicks(const JointTreeState& tree, int from, int to) {
        if (from != to) [[unlikely]]
            scale_kicks_anew(tree, from, to);
    }
    [[gnu::noinline, gnu::cold]] void scale_kicks_anew(const JointTreeState& tree, int from, int to) {
        each_node(tree, [&](const Node&, int i) {
            Kick<N>& kick = forest_.kicks()[i];
            bool within = true;
            for (int n = from; n > to; --n) add(kick, Kick<N>{kick}, within);
            for (int k = 0; k < 3 && from < to; ++k) {
                kick.linear[k] = J::halved(kick.linear[k], to - from);
                kick.angular[k] = J::halved(kick.angular[k], to - from);
            }
        });
    }
    template <class SpinChanged>
    [[gnu::noinline]] void go_back(const Start& start, const Group& group, SpinChanged& spin_changed) {
        for (int k = 0; k < group.count; ++k) {
            start.motions.restore(k, bodies_, group.id[k]);
            spin_changed(group.id[k]);
        }
        bodies_.status = start.status;
    }
    template <class SpinChanged>
    void end(JointTreeState& tree, SpinChanged& spin_changed) {
        measures_.factor(tree);
        find_end(tree);
        each_node(tree, [&](const Node& node, int i) {
            Kick<N>& kick = forest_.kicks()[i];
            bool within = true;
            kick = {};
            add(kick, change(node, i, 0), within);
            push(node.body, kick, spin_changed);
            if (!within) [[unlikely]]
                tree.is_disturbed = true;
        });
        // A kick of a piece counts as that of the longest, but for the longest.
        if (!goes_back()) divide(tree, measures_.halvings_for(tree, halvings_));
    }
    // The changes of motion that end the rates across the joints. A rope that would push for it goes slack, and a joint
    // that its end would pull leaves it. The bodies must be placed, and the factor must be that of there.
    void find_end(JointTreeState& tree) {
        for (bool slackens = true; slackens;) {
            measures_.rates(tree, bodies_);
            solve(tree);
            slackens = false;
            if constexpr (features.has_joint_ranges()) {
                if (!tree.has_ranges || goes_back()) return;
                measures_.for_each_that_pushes(tree, [&](Node& node, int) {
                    forest_.set_end(node, 0);
                    slackens = true;
                });
                if (!slackens) return;
                each_node(tree, [&](const Node&, int i) { forest_.kicks()[i] = {}; });  // no guess without it
                measures_.factor(tree);
            }
        }
    }
    // After a part that closed: a distance that has left its range is held at its end from the start of the part on,
    // and one that its end pushed over the whole part goes slack. True where there is one. What has changed in a part
    // does not go slack any more.
    [[nodiscard, gnu::noinline]] bool change_ends(const JointTreeState& tree) requires(features.has_joint_ranges()) {
        bool any = false;
        if (!tree.has_ranges || goes_back()) return any;
        const auto change = [&](Node& node, int i, int end) {
            if (end == 0 && is_changed_[i]) return;
            is_changed_[i] = any = true;
            forest_.set_end(node, end);
            // The half kick that ended the last part held it: it is no guess any more.
            if (end == 0) each_node(tree, [&](const Node&, int k) { start_.guess[k] = {}; });
        };
        for (int i = tree.first; i < tree.last; ++i) {
            Node& node = forest_.nodes()[i];
            if (!forest_.has_range(node) || forest_.range(node).end != 0) continue;
            if (const int beyond = measures_.end_beyond(node, i, bodies_); beyond != 0) change(node, i, beyond);
        }
        measures_.take(tree, forest_.kicks(), bodies_);
        measures_.for_each_that_pushes(tree, [&](Node& node, int i) { change(node, i, 0); });
        return any;
    }
    // Where the bodies are back at the start of a part, and the factor is that of its end or of other ends of ranges.
    void begin_anew(const Start& start, JointTreeState& tree) {
        measures_.place(tree, bodies_);
        measures_.factor(tree);
        take_guess(start, tree);
    }
    void take_guess(const Start& start, const JointTreeState& tree) {
        each_node(tree, [&](const Node&, int i) { copy(forest_.kicks()[i], start.guess[i]); });
    }
    // The parts that the next step is to have.
    void divide(JointTreeState& tree, int halvings) {
        if (tree.least_halvings > halvings) halvings = tree.least_halvings;
        if (halvings > most_halvings) [[unlikely]]
            report(Issue::step_too_long, tree);
        tree.halvings = static_cast<std::int8_t>(halvings < most_halvings ? halvings : most_halvings);
    }
    template <class Fly>
    [[gnu::noinline, gnu::cold]] void project(Fly& fly) {
        each(
            [&](const JointTreeState& tree) { each_node(tree, [&](const Node&, int i) { forest_.kicks()[i] = {}; }); });
        fly(halvings_, piece());
        each([&](JointTreeState& tree) { report(close(tree) ? Issue::step_bound_hit : Issue::joint_open, tree); });
    }
    // Moves the bodies until the gaps are closed, without momentum. False where they are not in most_projections, or
    // where a side of a joint is turned over.
    [[gnu::noinline, gnu::cold]] bool close(JointTreeState& tree) {
        if constexpr (features.has_joint_ranges()) set_ends(tree, [](const Node&, int) { return 0; });
        for (int projections = 0;; ++projections) {
            measures_.place(tree, bodies_);
            if constexpr (features.has_joint_ranges()) {
                set_ends(tree, [&](const Node& node, int i) {
                    const int end = forest_.range(node).end;
                    return end != 0 ? end : measures_.end_beyond(node, i, bodies_, projections == 0);
                });
                measures_.place(tree, bodies_);
            }
            measures_.factor(tree);  // first: gaps are measured in its lengths
            if (measures_.gaps(tree, bodies_)) return !measures_.is_turned_over(tree);
            if (projections == most_projections) return false;
            solve(tree);
            each_node(tree, [&](const Node& node, int i) { move(node, i); });
        }
    }
    // Of joints with a range but for rods, as end(node, i) says.
    void set_ends(const JointTreeState& tree, auto&& end) requires(features.has_joint_ranges()) {
        each_node(tree, [&](Node& node, int i) {
            if (forest_.has_range(node) && !forest_.range(node).is_rod) forest_.set_end(node, end(node, i));
        });
    }
    // Moves a body by the solution in place of its velocity.
    [[gnu::noinline, gnu::cold]] void move(const Node& node, int i) {
        auto& state = bodies_.state[node.body];
        const auto& s = measures_.solution[i];
        const Vector own = JointTree<N, features>::to_body(node.frame, s.dw);
        Vec3<typename N::Angle> half;
        for (int k = 0; k < 3; ++k) {
            N::add_sum(state.x_w[k], J::position_sum(s.dv[k], measures_.bits));
            half[k] = J::half_angle(own[k], node.length_log2, measures_.bits);
        }
        turn<N>(state.q_wb, Delta<N>::of(half));
    }

    void solve(const JointTreeState& tree) { forest_.solver(tree).solve(measures_.solution); }
    // The change of motion of a solution, times 2^up. A spin's is in the finest scale, which holds the range of spins.
    [[nodiscard, gnu::noinline]] Kick<N> change(const Node& node, int i, int up) const {
        const auto& s = measures_.solution[i];
        const Vector own = JointTree<N, features>::to_body(node.frame, s.dw);
        Kick<N> kick;
        detail::for_axes<N>([&](int k) {
            kick.linear[k] = J::drift_sum(s.dv[k], bodies_.scale, measures_.bits - up);
            kick.angular[k] =
                J::turn_sum(own[k], node.to_turn[k], bodies_.finest_scale(), node.length_log2, measures_.bits - up);
        });
        return kick;
    }
    // A half kick, at most a quarter of the range: no sum can wrap. Below: of any change.
    template <class SpinChanged>
    [[gnu::noinline]] void push(int b, const Kick<N>& kick, SpinChanged& spin_changed) {
        if (const int halvings = refined(b, kick); halvings != 0) [[unlikely]] {
            Kick<N> part = kick;
            for (auto& angular : part.angular) angular = N::halved(angular, halvings);
            add(bodies_.state[b], part);
        } else {
            add(bodies_.state[b], kick);
        }
        (void)bodies_.fit_parts(b);
        spin_changed(b);
    }
    static void add(typename Bodies::State& state, const Kick<N>& kick) {
        N::add(state.d_w.x, kick.linear[0]);
        N::add(state.d_w.y, kick.linear[1]);
        N::add(state.d_w.z, kick.linear[2]);
        state.t_b.x.add(kick.angular[0]);
        state.t_b.y.add(kick.angular[1]);
        state.t_b.z.add(kick.angular[2]);
    }
    template <class SpinChanged>
    [[gnu::noinline, gnu::cold]] void push_far(int b, const Kick<N>& kick, SpinChanged& spin_changed) {
        auto& state = bodies_.state[b];
        const int halvings = refined(b, kick);
        for (int k = 0; k < 3; ++k) {
            N::add_sum(state.d_w[k], kick.linear[k]);
            N::add_sum(state.t_b[k], N::halved(kick.angular[k], halvings));
        }
        (void)bodies_.fit_parts(b);
        spin_changed(b);
    }
    // Takes the spin of b to a scale that holds the change too. Returns the halvings from the scale of kicks to it, 0
    // or less.
    [[nodiscard]] TUMBLE_INLINE int refined(int b, const Kick<N>& kick) {
        int halvings = bodies_.halvings_of(b) - bodies_.most_halvings();
        if constexpr (Bodies::has_parts)
            while (halvings < 0 && J::is_wide(kick.angular, -halvings) && bodies_.halve_parts(b)) ++halvings;
        return halvings;
    }
    void report(Issue issue, const JointTreeState& tree) { bodies_.report(issue, forest_.nodes()[tree.first].body); }
};

}  // namespace tumble

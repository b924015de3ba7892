// The joints of a world and the trees that they make of its bodies. The order of a tree follows from the places of its
// bodies alone: the order in which joints are added changes no bit.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/body/stage.hpp>
#include <tumble/joints/tree.hpp>

namespace tumble {

// A joint as a world keeps it.
template <class N>
struct JointRecord {
    struct Side {
        std::int16_t body = -1;                         // -1: the world
        std::int8_t arm_log2 = 0;                       // m
        StoredVec3<typename N::Unit> arm{}, axis[2]{};  // to the anchor, principal axes; axes of the kind
    };
    Side side[2];                                      // of `body` and of `to_body`
    IntegratedVec3<N, typename N::Position> anchor{};  // in the world, where it is the other side
    std::uint8_t kind = 0;
    std::int8_t halvings = 0;  // of a step, for its dampers
    bool is_there = false;
    std::uint16_t generation = 0;  // removals of a joint of this place, modulo 2^16

    // False of a place that has had no joint, or one of a body that has been removed. That of a joint that has been
    // removed is kept until the place is used again: a snapshot may bring it back.
    [[nodiscard]] bool is_known() const { return side[0].body >= 0; }
};

// The range of a joint, and the end of it at which it is held.
template <class N>
struct JointRange {
    using Length = typename JointNumbers<N>::Open;
    using Unit = typename N::Unit;

    Length least{}, most{};                   // of a distance or a slider, in 2^-gap_bits m
    Unit cosine[2]{{}, {}}, sine[2]{{}, {}};  // of a hinge, at least and at most
    bool is_there = false, is_rod = false;
    std::int8_t end = 0;  // 1: held at most, -1: at least, 0: neither

    [[nodiscard]] Length length() const { return end < 0 ? least : most; }
};

// What a joint bears, and whether it has broken.
template <class N>
struct JointStrength {
    using Work = typename N::Work;

    Work force{}, torque{};  // N, N m; 0: anything
    bool is_broken = false;

    [[nodiscard]] bool has_limits() const { return force > Work(0) || torque > Work(0); }
};

// The bodies of a tree, and what the next step has to do before it begins.
struct JointTreeState {
    std::int16_t first = 0, last = 0;  // nodes
    bool is_factored = false;          // the factor is that of the present poses
    bool is_disturbed = false;         // something other than a step has changed a velocity
    bool is_moved = false;             // something other than a step has changed a pose
    bool has_ranges = false;           // of a joint: JointRange
    bool is_new = true;                // no step has looked whether its springs are too stiff
    std::int8_t corrections = 0;       // of the last step
    std::int8_t open_bits = 0;         // of the targets of a solution, in fixed point
    std::int8_t halvings = 0;          // of the next step, which is flown in 2^halvings parts; kicks are of one
    std::int8_t least_halvings = 0;    // of every step, for dampers
    std::int16_t still_steps = 0;      // the last steps, up to those of a rest, in which nothing has moved
};

template <class N, Features features>
class JointForest {
public:
    using J = JointNumbers<N>;
    using Unit = typename N::Unit;
    using Record = JointRecord<N>;
    using Node = JointNode<N>;
    using Kicks = Kick<N>;
    static constexpr int room = features.has_joints() ? features.joints : 1;  // a world without joints has no forest
    static constexpr int most_halvings = detail::most_joint_halvings;         // of a step
    static constexpr int most_nodes = features.bodies > 0 && features.bodies < 2 * room ? features.bodies : 2 * room;
    static constexpr int most_trees = room < most_nodes ? room : most_nodes;
    // A free root has six directions; each of `used` joints leaves a tree less.
    static constexpr int most_directions = [] {
        int most = 0;
        for (int used = 0; used <= room; ++used) {
            const int roots = most_nodes - used < used ? (most_nodes > used ? most_nodes - used : 0) : used;
            const int directions = used * JointKinds::most_directions(features) + 6 * roots;
            if (directions > most) most = directions;
        }
        return most;
    }();

    // Of a spec that JointKinds has. `is_body`: of a place in the world.
    template <class Spec>
    [[nodiscard]] constexpr JointFault fault_of(const Spec& spec, const auto& bodies, const auto& is_body) const {
        const int a = spec.body, b = spec.to_body;
        if (!is_body(a) || b < -1 || (b >= 0 && !is_body(b))) return JointFault::no_such_body;
        if (const JointFault fault = fault_of_sides(bodies, a, b); fault != JointFault::none) return fault;
        if (const JointFault fault = JointKinds::Of<Spec>::fault_of(spec); fault != JointFault::none) return fault;
        // What a scene has no feature for is misuse.
        if constexpr (features.joint_limits) {
            if (const JointFault fault = detail::fault_of_limits(spec, JointKinds::turns_of_springs < Spec >> 0);
                fault != JointFault::none)
                return fault;
            if constexpr (N::fixed_point)
                if (detail::limits_of(spec).most > Real{most_arm} || -detail::limits_of(spec).least > Real{most_arm})
                    return JointFault::too_far;
        }
        if constexpr (features.joint_breaks)
            if (detail::break_force_of(spec).is_negative() || detail::break_torque_of(spec).is_negative())
                return JointFault::bad_strength;
        if constexpr (features.joint_springs)
            if (const JointFault fault = detail::fault_of_springs(spec, JointKinds::turns_of_springs<Spec>);
                fault != JointFault::none)
                return fault;
        if constexpr (N::fixed_point && requires { spec.most; })
            if (spec.most > Real{most_arm}) return JointFault::too_far;
        return fault_of_place(bodies, a, b, detail::anchor_of(spec, 0), detail::anchor_of(spec, 1));
    }
    // Adds a joint that has no fault; returns its place.
    template <class Spec>
    TUMBLE_COLD constexpr int add(const Spec& spec, const auto& bodies) {
        using Kind = typename JointKinds::Of<Spec>;
        const int place = first_vacant();
        Record& joint = record_[place];
        set_sides(joint, bodies, spec.body, spec.to_body, detail::anchor_of(spec, 0), detail::anchor_of(spec, 1),
                  Kind::axes_of(spec));
        joint.kind = JointKinds::number_of<Spec>;
        if constexpr (features.has_joint_springs()) joint.halvings = halvings_for_dampers(spec, joint, bodies);
        if constexpr (features.has_joint_ranges()) {
            range_[place] = JointRange<N>{};
            if constexpr (requires { spec.most; }) set_range(range_[place], spec);
            else set_range(range_[place], detail::limits_of(spec));
        }
        if constexpr (features.joint_breaks)
            strength_[place] = {N::template constant<typename N::Work>(detail::break_force_of(spec)),
                                N::template constant<typename N::Work>(detail::break_torque_of(spec)), false};
        JointTreeState& tree = tie(joint, bodies);
        // Half kicks are along rows that there still are, unless the bodies move: a distance has the spec's length.
        if constexpr (requires { spec.most; }) forget_pose(tree);
        return place;
    }
    [[nodiscard]] constexpr std::uint16_t generation(int place) const { return record_[place].generation; }
    [[nodiscard]] bool contains(JointId id) const {
        const int place = id.index();
        return place >= 0 && place < room && record_[place].is_there && record_[place].generation == id.generation();
    }
    TUMBLE_COLD void remove(int place, const auto& bodies) {
        Record& joint = record_[place];
        joint.is_there = false;
        ++joint.generation;
        for (const auto& side : joint.side) forget(side.body);
        order(bodies);
    }
    // It holds nothing any more, and keeps its place.
    TUMBLE_COLD void break_apart(int place, const auto& bodies) requires(features.joint_breaks) {
        strength_[place].is_broken = true;
        for (const auto& side : record_[place].side) forget(side.body);
        order(bodies);
    }
    // True of a joint that is there and has not broken.
    [[nodiscard]] constexpr bool acts(int place) const {
        if constexpr (features.joint_breaks)
            if (strength_[place].is_broken) return false;
        return record_[place].is_there;
    }
    [[nodiscard]] const JointStrength<N>& strength(int place) const requires(features.joint_breaks) {
        return strength_[place];
    }
    // Of a body that leaves the world: removes its joints, and forgets those that it had.
    void remove_from(int b, const auto& bodies) {
        for (int j = 0; j < room; ++j) {
            if (record_[j].side[0].body != b && record_[j].side[1].body != b) continue;
            if (record_[j].is_there) remove(j, bodies);
            const std::uint16_t generation = record_[j].generation;
            record_[j] = {};
            record_[j].generation = generation;
        }
    }
    // Call after a change of the velocity, or of the pose, of a body by something other than a step. A fixed body is a
    // base of trees.
    void velocity_changed(int b) {
        if (JointTreeState* const tree = tree_of(b)) tree->is_disturbed = true;
    }
    void pose_changed(int b) {
        for (int t = 0; t < tree_count_; ++t)
            if (is_in(tree_[t], b) || node_[tree_[t].first].base == b) forget_pose(tree_[t]);
    }
    // Call after a change of what loads depend on.
    constexpr void wake() {
        for (JointTreeState& tree : tree_) tree.still_steps = 0;
    }
    // True of a tree that stays where it is until something changes.
    [[nodiscard]] bool is_at_rest(const JointTreeState& tree) const {
        return tree.still_steps == steps_to_rest_ && !tree.is_disturbed && !tree.is_moved;
    }
    // True where the tree has come to rest with this step: steps_to_rest_ of them have left it where it was. A look at
    // velocities would not do, since dampers leave some where nothing moves. A count begins in every eighth step alone,
    // which costs less where something moves.
    [[nodiscard]] TUMBLE_INLINE bool comes_to_rest(JointTreeState& tree, const auto& bodies, bool may_rest) {
        if (!may_rest) tree.still_steps = 0;
        else if (tree.still_steps > 0 || bodies.steps_taken % 8 == 0) count_still_steps(tree, bodies);
        return tree.still_steps == steps_to_rest_;
    }
    [[nodiscard]] TUMBLE_INLINE bool is_jointed(int b) const { return is_jointed_[b]; }
    // True of a fixed body to which a tree ties.
    [[nodiscard]] bool has_base(int b) const {
        bool any = false;
        for (int t = 0; t < tree_count_; ++t) any = any || node_[tree_[t].first].base == b;
        return any;
    }
    [[nodiscard]] constexpr bool is_in(const JointTreeState& tree, int b) const {
        for (int i = tree.first; i < tree.last; ++i)
            if (node_[i].body == b) return true;
        return false;
    }
    // kg m^2 or kg: the inertia of what hangs on a node along the free direction of its spring k, with the other side
    // at rest, as the factor has it. Of a ball the least of those of its three directions. Of a distance that is held,
    // none is free: a spring moves nothing. 0 where it is held.
    [[nodiscard]] typename N::Work inertia_along(const Node& node, int k) const {
        using Work = typename N::Work;
        const bool of_line = node.keeps_distance();
        if (node.slides + node.turns == 0 || (of_line && node.slides == 2)) return Work(0);
        const int count = of_line           ? 1
                          : node.turns == 3 ? 3
                                            : 1,
                  first = of_line           ? 5
                          : node.turns == 3 ? node.slides
                                            : k;
        Work least(0);
        for (int f = first; f < first + count; ++f) {
            const FreeDirection<N>& direction = direction_[node.direction + f];
            const auto& along = direction.turns ? direction.t : direction.u;
            Work root(0);  // D over its root
            for (int i = 0; i < 3; ++i) {
                if (direction.only >= 0 && direction.only != i) continue;
                root += direction.only >= 0 ? N::work(along[i]) : N::work(along[i]) * N::work(direction.axis[i]);
            }
            const int log2 = node.mass_log2 + (direction.turns ? 2 * node.length_log2 : 0);
            const Work inertia = N::times_power_of_two(Work(root * root), N::fixed_point ? log2 : 0);
            if (f == first || inertia < least) least = inertia;
        }
        return least;
    }
    [[nodiscard]] int tree_count() const { return tree_count_; }
    [[nodiscard]] JointTreeState& tree(int t) { return tree_[t]; }
    [[nodiscard]] const JointTreeState& tree(int t) const { return tree_[t]; }
    [[nodiscard]] int count() const {
        int count = 0;
        for (const Record& joint : record_) count += joint.is_there ? 1 : 0;
        return count;
    }
    [[nodiscard]] Node* nodes() { return node_; }
    [[nodiscard]] const Node* nodes() const { return node_; }
    // The half kick of a body's joints; null where it has none.
    [[nodiscard]] const Kicks* kick_of(int b) const {
        const int i = is_jointed_[b] ? node_of_body(b) : -1;
        return i < 0 ? nullptr : &kick_[i];
    }
    [[nodiscard]] Kicks* kicks() { return kick_; }
    [[nodiscard]] const Kicks* kicks() const { return kick_; }
    [[nodiscard]] FreeDirection<N>* directions() { return direction_; }
    [[nodiscard]] constexpr const Record& record(int j) const { return record_[j]; }
    // Of a node that keeps a distance.
    [[nodiscard]] const JointRange<N>& range(const Node& node) const requires(features.has_joint_ranges()) {
        return range_[node.joint];
    }
    [[nodiscard]] const JointRange<N>& range_of(int joint) const requires(features.has_joint_ranges()) {
        return range_[joint];
    }
    [[nodiscard]] constexpr bool has_range(const Node& node) const requires(features.has_joint_ranges()) {
        return node.joint != Node::no_joint && range_[node.joint].is_there;
    }
    // Of a node as a body on its parent: the other way round where the joint is.
    [[nodiscard]] static int sign(const Node& node) { return node.side == 0 || node.keeps_distance() ? 1 : -1; }
    // Where neither end is held, nothing is handed on along a distance. A hinge or a slider has no free direction at an
    // end.
    constexpr void set_end(Node& node, int end) requires(features.has_joint_ranges()) {
        range_[node.joint].end = static_cast<std::int8_t>(end);
        if (node.keeps_distance()) {
            node.slides = end == 0 ? 3 : 2;
            node.holder = end == 0 ? std::int16_t{-1} : node.parent;
        } else {
            const std::uint8_t kind = record_[node.joint].kind;
            node.axes = 2;
            node.turns = end == 0 ? JointKinds::turns[kind] : std::int8_t{0};
            node.slides = end == 0 ? JointKinds::slides[kind] : std::int8_t{0};
        }
    }
    // False of a node whose anchors stay at one point.
    [[nodiscard]] bool may_slide(const Node& node) const {
        return JointTree<N, features>::may_slide && node.joint != Node::no_joint &&
               JointKinds::slides[record_[node.joint].kind] > 0;
    }
    // The node that hangs on its parent by this joint.
    [[nodiscard]] int node_of(int joint) const {
        int i = 0;
        while (node_[i].joint != joint) ++i;
        return i;
    }
    [[nodiscard]] const JointTreeState& tree_at(int node) const {
        int t = 0;
        while (tree_[t].last <= node) ++t;
        return tree_[t];
    }
    [[nodiscard]] JointTree<N, features> solver(const JointTreeState& tree) {
        return {node_, direction_, tree.first, tree.last};
    }

    // Sets the powers of two of lengths from the root's on. They hold the distance of every part of the subtree from
    // the anchor: own_reach, the arm and the radius of gyration, and span, the link to a child, and its reach. In units
    // of 2^-16 m.
    //
    // What is open at the speed v costs no more energy than the whole tree at v, with the mass M. So a part of the mass
    // m and the radius of gyration k moves by at most v sqrt(M / m), and spins with at most v sqrt(M / m) / k. Spins
    // count times the length l: a solution keeps bits of the targets for the largest sqrt(M / m) l / k.
    [[gnu::noinline, gnu::cold]] constexpr void fit_lengths(JointTreeState& tree) {
        if constexpr (N::fixed_point) {
            for (int i = tree.first; i < tree.last; ++i) node_[i].reach = node_[i].own_reach;
            for (int i = tree.last - 1; i >= tree.first; --i) {
                Node& node = node_[i];
                node.length_log2 = static_cast<std::int8_t>(
                    static_cast<int>(std::bit_width(static_cast<std::uint32_t>(node.reach) - 1u)) - reach_bits);
                if (node.parent < 0) continue;
                const std::int32_t sum = node.span + node.reach;
                if (sum > node_[node.parent].reach) node_[node.parent].reach = sum < most_reach ? sum : most_reach;
            }
            for (int i = tree.first; i < tree.last; ++i) {
                Node& node = node_[i];
                if (node.parent < 0) continue;
                const int down = node_[node.parent].length_log2 - node.length_log2;
                node.length_down = static_cast<std::int8_t>(JointTree<N, features>::clamped(down));
                node.moment_down = static_cast<std::int8_t>(JointTree<N, features>::clamped(node.mass_down + down));
            }
            int bits = J::open_bits;
            for (int i = tree.first; i < tree.last; ++i) {
                const Node& node = node_[i];
                const int up = (node_[tree.first].mass_log2 - node.own_mass_log2 + 1) / 2 + node.length_log2 -
                               node.own_length_log2;
                if (J::room_bits - up < bits) bits = J::room_bits - up;
            }
            tree.open_bits = static_cast<std::int8_t>(bits < J::least_open_bits ? J::least_open_bits : bits);
        }
    }
    static constexpr int reach_bits = 16;
    static constexpr std::int32_t most_reach = 1 << 29;
    static constexpr int most_arm = most_reach >> (reach_bits + 1);  // m: two of them, a link, are within that

    // Writes or reads what the next step depends on beside the poses.
    template <class Self, class Archive>
    static void archive(Self& self, [[maybe_unused]] const auto& bodies, Archive& to) {
        if constexpr (features.joint_breaks || features.removal) return archive_with_trees(self, bodies, to);
        for (int t = 0; t < self.tree_count_; ++t) {
            auto& tree = self.tree_[t];
            to(tree.is_disturbed, tree.is_moved);
            (void)to.within(tree.still_steps, 0, self.steps_to_rest_);
            if constexpr (features.joint_springs) to(tree.is_new);
            (void)to.within(tree.halvings, 0, most_halvings);
            if constexpr (Archive::reads) tree.is_factored = false;
            for (int i = tree.first; i < tree.last; ++i) to(self.kick_[i], self.pose_[i].at);
            if constexpr (features.has_joint_ranges())
                for (int i = tree.first; i < tree.last; ++i) {
                    auto& node = self.node_[i];
                    if (!self.has_range(node)) continue;
                    int end = self.range_[node.joint].end;
                    end = to.within(end, self.range_[node.joint].is_rod ? 1 : -1, 1);
                    if constexpr (Archive::reads) self.set_end(node, end);
                }
        }
    }
    // What was added. Which of it is there, or has broken, is state.
    void add_to(auto& digest) const {
        for (int j = 0; j < room; ++j) {
            const Record& joint = record_[j];
            digest.add(static_cast<int>(joint.is_known()));
            if (!joint.is_known()) continue;
            digest.add(static_cast<int>(joint.kind));
            for (const auto& side : joint.side) {
                digest.add(static_cast<int>(side.body));
                for (const auto& vector : {side.arm, side.axis[0], side.axis[1]})
                    for (int i = 0; i < 3; ++i) digest.add_number(vector[i]);
            }
            digest.add_number(joint.anchor);
            if constexpr (features.joint_breaks) {
                digest.add_number(strength_[j].force);
                digest.add_number(strength_[j].torque);
            }
            if constexpr (features.has_joint_ranges()) {
                J::add_to(digest, range_[j].least);
                J::add_to(digest, range_[j].most);
                for (int i = 0; i < 2; ++i) {
                    digest.add_number(range_[j].cosine[i]);
                    digest.add_number(range_[j].sine[i]);
                }
            }
        }
    }

private:
    // The trees follow from the joints that act: by bodies and joints, of which there are as many in every state.
    template <class Self, class Archive>
    static void archive_with_trees(Self& self, const auto& bodies, Archive& to) {
        constexpr int there = 1, broken = 2,
                      in_state = (features.removal ? ~broken : 0) | (features.joint_breaks ? broken : 0);
        bool is_other = false, acts[room]{};
        for (int j = 0; j < room; ++j) {
            auto& joint = self.record_[j];
            const int own = self.state_of(j);
            int state = own;
            state = to.within(state, 0, 0x3ffff);
            to.require((state & there) == 0 || joint.is_known());
            to.require(((state ^ own) & ~in_state) == 0);
            acts[j] = (state & (there | broken)) == there && joint.is_known();
            is_other = is_other || acts[j] != self.acts(j);
            if constexpr (Archive::reads) {
                joint.is_there = (state & there) != 0;
                joint.generation = static_cast<std::uint16_t>(state >> 2);
                if constexpr (features.joint_breaks) self.strength_[j].is_broken = (state & broken) != 0;
            }
        }
        if constexpr (Archive::reads) {
            if (is_other) self.order(bodies);
        } else if (to.compares()) {
            to.require(self.ties_trees(bodies, acts));
        }
        for (int b = 0; b < bodies.count; ++b) {
            const int i = self.node_of_body(b);
            JointTreeState tree = i < 0 ? JointTreeState{} : self.tree_at(i);
            Kicks kick{};
            typename J::Pose pose{};
            if (i >= 0) {
                kick = self.kick_[i];
                pose = self.pose_[i];
            }
            to(kick, pose.at, tree.is_disturbed, tree.is_moved, tree.is_new);
            (void)to.within(tree.halvings, 0, most_halvings);
            (void)to.within(tree.still_steps, 0, self.steps_to_rest_);
            if constexpr (Archive::reads)
                if (i >= 0) {
                    JointTreeState& own = *self.tree_of(b);
                    self.kick_[i] = kick;
                    self.pose_[i] = pose;
                    own.is_disturbed = tree.is_disturbed;
                    own.is_moved = tree.is_moved;
                    own.is_new = tree.is_new;
                    own.halvings = tree.halvings;
                    own.still_steps = tree.still_steps;
                    own.is_factored = false;
                }
        }
        if constexpr (features.has_joint_ranges())
            for (int j = 0; j < room; ++j) {
                int end = self.range_[j].end;
                end = to.within(end, -1, 1);
                if constexpr (Archive::reads) self.range_[j].end = static_cast<std::int8_t>(end);
            }
        if constexpr (Archive::reads && features.has_joint_ranges())
            for (int i = 0; i < self.node_count_; ++i)
                if (self.has_range(self.node_[i])) self.set_end(self.node_[i], self.range(self.node_[i]).end);
    }
    // Counts a step, if no part of the tree is farther from where it was when the count began than joints that count as
    // closed let it be.
    [[gnu::noinline]] void count_still_steps(JointTreeState& tree, const auto& bodies) {
        const bool begins = tree.still_steps == 0;
        bool still = true;
        for (int i = tree.first; i < tree.last && still; ++i) {
            const Node& node = node_[i];
            const auto& state = bodies.state[node.body];
            // Its gap and those from there to the root may have opened and closed.
            const int gaps = 2 * (i + 1 - tree.first);
            if (begins) J::take_pose(pose_[i], state);
            else
                still = J::is_told(state.d_w, bodies.scale) &&
                        J::is_at(pose_[i], state, gaps, node.length_log2, node.lever, node.link);
        }
        tree.still_steps = static_cast<std::int16_t>(still ? tree.still_steps + 1 : 0);
    }
    // Whether a joint is there, whether it has broken, and its generation.
    [[nodiscard]] int state_of(int j) const {
        int state = (record_[j].is_there ? 1 : 0) | record_[j].generation << 2;
        if constexpr (features.joint_breaks) state |= strength_[j].is_broken ? 2 : 0;
        return state;
    }
    // False where the joints that act would close a loop. It takes time as joints times bodies.
    TUMBLE_COLD [[nodiscard]] bool ties_trees(const auto& bodies, const bool (&acts)[room]) const {
        int tree[features.bodies]{};  // 0: the world and the fixed bodies
        for (int b = 0; b < bodies.count; ++b) tree[b] = is_base(bodies, b) ? 0 : b + 1;
        for (int j = 0; j < room; ++j) {
            if (!acts[j]) continue;
            const int to_body = record_[j].side[1].body;
            const int one = tree[record_[j].side[0].body], other = to_body < 0 ? 0 : tree[to_body];
            if (one == other) return false;
            for (int& t : tree)
                if (t == other) t = one;
        }
        return true;
    }
    // -1 of a body without a joint that holds.
    [[nodiscard]] int node_of_body(int b) const {
        for (int i = 0; i < node_count_; ++i)
            if (node_[i].body == b) return i;
        return -1;
    }
    TUMBLE_COLD [[nodiscard]] static constexpr bool is_far(const auto& bodies, int b, const RealVec3& anchor) {
        if (!N::fixed_point || b < 0) return false;
        const RealVec3 arm = from_centre(bodies, b, anchor);
        return dot(arm, arm) > Real::scaled(1, 2 * (std::bit_width(static_cast<unsigned>(most_arm)) - 1));
    }
    // A point, from the centre of mass of a body, in the world's axes.
    TUMBLE_COLD [[nodiscard]] static constexpr RealVec3 from_centre(const auto& bodies, int b, const RealVec3& point) {
        const auto& x = bodies.state[b].x_w;
        return point - RealVec3{x.x.to_real(), x.y.to_real(), x.z.to_real()};
    }
    [[nodiscard]] static constexpr bool is_base(const auto& bodies, int b) {
        return b < 0 || bodies.constants[b].fixed();
    }
    [[nodiscard]] static constexpr bool moves_by_itself(const auto& bodies, int b) {
        if (!features.moving_surfaces() || b < 0 || !bodies.constants[b].fixed()) return false;
        return bodies.constants[b].kinematic() || bodies.is_turning(b);
    }
    [[nodiscard]] constexpr int first_vacant() const {
        int place = 0;
        while (place < room && record_[place].is_there) ++place;
        return place;
    }
    [[nodiscard]] constexpr const JointTreeState* tree_of(int b) const {
        for (int t = 0; t < tree_count_; ++t)
            if (is_in(tree_[t], b)) return &tree_[t];
        return nullptr;
    }
    [[nodiscard]] constexpr JointTreeState* tree_of(int b) {
        return const_cast<JointTreeState*>(std::as_const(*this).tree_of(b));
    }
    // True where joints tie the two sides already. All fixed bodies are one with the world.
    [[nodiscard]] constexpr bool is_tied(const auto& bodies, int a, int b) const {
        const JointTreeState *of_a = is_base(bodies, a) ? nullptr : tree_of(a),
                             *of_b = is_base(bodies, b) ? nullptr : tree_of(b);
        if (of_a != nullptr && of_a == of_b) return true;
        return is_grounded(bodies, a, of_a) && is_grounded(bodies, b, of_b);
    }
    [[nodiscard]] constexpr bool is_grounded(const auto& bodies, int b, const JointTreeState* tree) const {
        return is_base(bodies, b) || (tree != nullptr && node_[tree->first].joint != Node::no_joint);
    }
    // Of a joint that goes: a half kick is along the rows that there were.
    TUMBLE_COLD void forget(int b) {
        if (b < 0) return;
        if (JointTreeState* const tree = tree_of(b)) {
            forget_kicks(*tree);
            note_change(*tree);
        }
    }
    static constexpr void note_change(JointTreeState& tree) {
        tree.is_disturbed = tree.is_new = true;
        tree.is_factored = false;
    }
    constexpr void forget_kicks(const JointTreeState& tree) {
        for (int i = tree.first; i < tree.last; ++i) kick_[i] = {};
    }
    constexpr void forget_pose(JointTreeState& tree) {
        forget_kicks(tree);
        tree.is_factored = false;
        tree.is_disturbed = tree.is_moved = true;
    }

    // What is wrong with the bodies of a joint, and with its place in the world.
    TUMBLE_COLD [[nodiscard]] static constexpr JointFault fault_of_sides(const auto& bodies, int a, int b) {
        if (a == b) return JointFault::same_body;
        if (is_base(bodies, a) && is_base(bodies, b)) return JointFault::no_moving_body;
        return bodies.rotates(a) && (b < 0 || bodies.rotates(b)) ? JointFault::none : JointFault::point_mass;
    }
    TUMBLE_COLD [[nodiscard]] constexpr JointFault
    fault_of_place(const auto& bodies, int a, int b, const RealVec3& anchor, const RealVec3& to_anchor) const {
        if (is_far(bodies, a, anchor) || is_far(bodies, b, to_anchor)) return JointFault::too_far;
        if (moves_by_itself(bodies, a) || moves_by_itself(bodies, b)) return JointFault::moving_base;
        if (is_tied(bodies, a, b)) return JointFault::closes_loop;
        return first_vacant() < room ? JointFault::none : JointFault::no_room;
    }
    // A joint of this place, new between two bodies.
    TUMBLE_COLD constexpr void set_sides(Record& joint, const auto& bodies, int a, int b, const RealVec3& anchor,
                                         const RealVec3& to_anchor, const detail::JointAxes& axes) {
        const std::uint16_t generation = joint.generation;
        joint = {};
        joint.generation = generation;
        joint.is_there = true;
        set_side(joint.side[0], bodies, a, anchor, axes.of_body);
        set_side(joint.side[1], bodies, b, to_anchor, axes.of_other);
        for (int i = 0; i < 3; ++i) joint.anchor[i] = N::template Integrated<typename N::Position>::from(to_anchor[i]);
    }
    // Brings a new joint into its tree, which it returns.
    TUMBLE_COLD constexpr JointTreeState& tie(const Record& joint, const auto& bodies) {
        order(bodies);
        const int moving = is_base(bodies, joint.side[0].body) ? joint.side[1].body : joint.side[0].body;
        JointTreeState& tree = *tree_of(moving);
        note_change(tree);
        return tree;
    }
    // The anchor and the axes as the body sees them now.
    TUMBLE_COLD constexpr void set_side(typename Record::Side& side, const auto& bodies, int b, const RealVec3& anchor,
                                        const RealVec3 (&axis)[2]) {
        side.body = static_cast<std::int16_t>(b);
        RealVec3 arm{};
        RealQuat q{};
        if (b >= 0) {
            const auto& s = bodies.state[b];
            q = normalized(RealQuat{s.q_wb.w.to_real(), {s.q_wb.x.to_real(), s.q_wb.y.to_real(), s.q_wb.z.to_real()}});
            arm = detail::rotated_back(q, from_centre(bodies, b, anchor));
        }
        const int log2 = J::log2_of(length_of(arm));
        side.arm_log2 = static_cast<std::int8_t>(log2);
        for (int i = 0; i < 3; ++i) side.arm[i] = J::unit(arm[i], log2);
        for (int k = 0; k < 2; ++k) {
            const RealVec3 own = detail::rotated_back(q, axis[k]);
            for (int i = 0; i < 3; ++i) side.axis[k][i] = J::unit(own[i], 0);
        }
    }
    TUMBLE_COLD [[nodiscard]] static constexpr Real length_of(const RealVec3& v) { return sqrt(dot(v, v)); }

    // A distance that is at an end of its range is held there.
    TUMBLE_COLD static constexpr void set_range(JointRange<N>& range,
                                                const DistanceSpec& spec) requires(features.has_joint_ranges()) {
        const RealVec3 apart = spec.point - spec.to_point;
        const Real length = length_of(apart), near = Real::scaled(1, -20);
        range.is_there = true;
        range.is_rod = spec.least == spec.most;
        range.least = J::length(spec.least);
        range.most = J::length(spec.most);
        if (range.is_rod || length >= spec.most * (Real{1} - near)) range.end = 1;
        else if (length <= spec.least * (Real{1} + near) && spec.least > Real{}) range.end = -1;
    }

    // Both of a hinge and of a slider, which use what they need.
    TUMBLE_COLD static constexpr void set_range(JointRange<N>& range,
                                                const JointLimits& limits) requires(features.has_joint_ranges()) {
        if (!limits.acts()) return;
        range.is_there = true;
        range.least = J::length(limits.least);
        range.most = J::length(limits.most);
        for (int i = 0; i < 2; ++i) {
            const RealQuat q = rotation_about({0, 0, 1}, i == 0 ? limits.least : limits.most);
            range.cosine[i] = J::unit(q.w * q.w - q.v.z * q.v.z, 0);
            range.sine[i] = J::unit(q.w * q.v.z * Real{2}, 0);
        }
    }

    // Builds the trees anew. The root is the body that hangs on the world or on a fixed body. A tree that flies freely
    // has its heaviest body as root, of equal ones that of the lowest place: beside a light root the solution keeps
    // fewer bits of it. Then come its children in the order of their places, and theirs. It takes time as the number
    // of bodies times that of joints, anew for each tree that flies freely.
    TUMBLE_COLD constexpr void order(const auto& bodies) {
        Kicks kept_kick[most_nodes]{};
        std::int16_t kept_body[most_nodes]{};
        JointTreeState kept_tree[most_trees]{};
        const int kept_count = node_count_, kept_trees = tree_count_;
        for (int i = 0; i < kept_count; ++i) {
            kept_kick[i] = kick_[i];
            kept_body[i] = node_[i].body;
        }
        for (int t = 0; t < kept_trees; ++t) kept_tree[t] = tree_[t];
        node_count_ = tree_count_ = direction_count_ = 0;
        const std::uint64_t steps = detail::nearest_step(Real::scaled(1, -1), bodies.step_length);
        steps_to_rest_ = static_cast<std::int16_t>(steps < 4 ? 4 : steps < INT16_MAX ? steps : INT16_MAX);
        for (int b = 0; b < features.bodies; ++b) is_jointed_[b] = false;
        for (int b = 0; b < bodies.count; ++b)
            if (const int j = is_base(bodies, b) ? none : base_joint(bodies, b); j != none) grow(bodies, b, j);
        for (int b; (b = heaviest_loose(bodies)) != none;) grow(bodies, b, Node::no_joint);
        for (int t = 0; t < tree_count_; ++t) {
            JointTreeState& tree = tree_[t];
            set_constants(bodies, tree);
            tree.is_new = false;
            const auto each_kept = [&](auto&& f) {
                for (int k = 0; k < kept_trees; ++k)
                    for (int i = kept_tree[k].first; i < kept_tree[k].last; ++i)
                        for (int at = tree.first; at < tree.last; ++at)
                            if (node_[at].body == kept_body[i]) f(kept_tree[k], kept_kick[i], at);
            };
            for (int i = tree.first; i < tree.last; ++i) {
                kick_[i] = {};
                if (const int j = node_[i].joint; j != Node::no_joint && record_[j].halvings > tree.least_halvings)
                    tree.least_halvings = record_[j].halvings;
            }
            tree.halvings = tree.least_halvings < most_halvings ? tree.least_halvings : std::int8_t{most_halvings};
            each_kept([&](const JointTreeState& kept, const Kicks&, int) {
                tree.is_disturbed = tree.is_disturbed || kept.is_disturbed;
                tree.is_moved = tree.is_moved || kept.is_moved;
                tree.is_new = tree.is_new || kept.is_new;
                if (kept.corrections > tree.corrections) tree.corrections = kept.corrections;
                if (kept.halvings > tree.halvings) tree.halvings = kept.halvings;
            });
            // Of shorter parts.
            each_kept([&](const JointTreeState& kept, const Kicks& kick, int at) {
                for (int k = 0; k < 3; ++k) {
                    kick_[at].linear[k] = J::halved(kick.linear[k], tree.halvings - kept.halvings);
                    kick_[at].angular[k] = J::halved(kick.angular[k], tree.halvings - kept.halvings);
                }
            });
        }
    }
    static constexpr int none = -2;
    // The half kick that ends a part is found by iterations, of which each leaves h c / 2 I of the one before, with the
    // damping c in a part h of a step, and the inertia I of each side by itself: a quarter at most.
    TUMBLE_COLD [[nodiscard]] static constexpr std::int8_t halvings_for_dampers(const auto& spec, const Record& joint,
                                                                                const auto& bodies) {
        using Kind = typename JointKinds::Of<std::remove_cvref_t<decltype(spec)>>;
        Real most{};
        for (int k = 0; k < 2; ++k) {
            Real response{};
            for (const auto& side : joint.side)
                if (!is_base(bodies, side.body)) response += response_of<Kind>(side, side.axis[0], bodies);
            response = response * detail::spring_of(spec, k).damping * Real::scaled(1, -1);
            if (response > most) most = response;
        }
        std::int8_t halvings = 0;
        for (; most > Real::scaled(1, -2) && halvings <= most_halvings; ++halvings) most = most * Real::scaled(1, -1);
        return halvings;
    }
    // The rate that an impulse along a free direction gives to a side, in a step: an axis of the side, or the most of
    // all directions, of a ball and of a distance.
    template <class Kind>
    TUMBLE_COLD [[nodiscard]] static constexpr Real response_of(const typename Record::Side& side, const auto& axis,
                                                                const auto& bodies) {
        const auto real = [](const auto& v) {
            return RealVec3{static_cast<Real>(N::work(v[0])), static_cast<Real>(N::work(v[1])),
                            static_cast<Real>(N::work(v[2]))};
        };
        RealVec3 per_moment;
        Real largest{};
        for (int i = 0; i < 3; ++i) {
            per_moment[i] = static_cast<Real>(bodies.step_per_moment(side.body, i));
            if (per_moment[i] > largest) largest = per_moment[i];
        }
        const auto about = [&](const RealVec3& v) {
            return v.x * v.x * per_moment.x + v.y * v.y * per_moment.y + v.z * v.z * per_moment.z;
        };
        if constexpr (Kind::slides == 0) return Kind::turns == 3 ? largest : about(real(axis));
        const RealVec3 arm = arm_of(side);
        return static_cast<Real>(bodies.step_per_mass(side.body)) +
               (Kind::slides == 1 ? about(cross(arm, real(axis))) : dot(arm, arm) * largest);
    }
    // The joint of a body with a base, or `none`.
    TUMBLE_COLD [[nodiscard]] constexpr int base_joint(const auto& bodies, int b) const {
        for (int j = 0; j < room; ++j)
            if (const int other = other_of(j, b); other != none && is_base(bodies, other)) return j;
        return none;
    }
    // Of the bodies that have a joint and are in no tree yet, the heaviest one, at the lowest place; or `none`.
    TUMBLE_COLD [[nodiscard]] constexpr int heaviest_loose(const auto& bodies) const {
        int heaviest = none;
        for (int b = 0; b < bodies.count; ++b) {
            bool is_loose = false;
            for (int j = 0; j < room; ++j) is_loose = is_loose || other_of(j, b) != none;
            if (!is_loose || is_jointed_[b] || is_base(bodies, b)) continue;
            if (heaviest == none || bodies.step_per_mass(b) < bodies.step_per_mass(heaviest)) heaviest = b;
        }
        return heaviest;
    }
    // The body at the other side of joint j, if b is at one; else `none`.
    [[nodiscard]] constexpr int other_of(int j, int b) const {
        const Record& joint = record_[j];
        if (!acts(j)) return none;
        for (int side = 0; side < 2; ++side)
            if (joint.side[side].body == b) return joint.side[1 - side].body;
        return none;
    }
    TUMBLE_COLD constexpr void grow(const auto& bodies, int root, int joint) {
        JointTreeState& tree = tree_[tree_count_++];
        tree = {};
        tree.first = static_cast<std::int16_t>(node_count_);
        put(node_count_++, root, -1, joint);
        for (int i = tree.first; i < node_count_; ++i) {
            const int first_child = node_count_;
            for (int j = 0; j < room; ++j) {
                const int b = other_of(j, node_[i].body);
                if (b < 0 || is_base(bodies, b) || is_jointed_[b]) continue;
                int at = node_count_++;
                for (; at > first_child && node_[at - 1].body > b; --at) node_[at] = node_[at - 1];
                put(at, b, i, j);
                node_[i].carries = true;
            }
        }
        tree.last = static_cast<std::int16_t>(node_count_);
        for (int i = tree.first; i < tree.last; ++i) {
            Node& node = node_[i];
            node.direction = direction_count_;
            for (int s = 0; s < node.slides; ++s) add_direction(false, node.slides == 3 ? s : -1);
            for (int r = 0; r < node.turns; ++r) add_direction(true, node.turns == 3 ? r : -1);
            if constexpr (features.has_joint_ranges())
                if (has_range(node)) {
                    tree.has_ranges = true;
                    if (node.keeps_distance()) add_direction(false, -1);  // along the line, where it is slack
                    set_end(node, range_[node.joint].end);
                }
        }
    }
    constexpr void add_direction(bool turns, int only) {
        FreeDirection<N>& direction = direction_[direction_count_++];
        direction.turns = turns;
        direction.only = static_cast<std::int8_t>(only);
    }
    TUMBLE_COLD constexpr void put(int at, int b, int parent, int joint) {
        Node& node = node_[at];
        node = {};
        is_jointed_[b] = true;
        node.body = static_cast<std::int16_t>(b);
        node.parent = node.holder = static_cast<std::int16_t>(parent);
        node.joint = static_cast<std::int16_t>(joint);
        if (joint == Node::no_joint) return;
        const Record& record = record_[joint];
        node.side = record.side[0].body == b ? 0 : 1;
        if (parent < 0) node.base = record.side[1 - node.side].body;
        node.turns = JointKinds::turns[record.kind];
        node.slides = JointKinds::slides[record.kind];
        node.axes = JointKinds::axes[record.kind];
    }

    // Masses and moments, and the powers of two that hold subtrees.
    TUMBLE_COLD constexpr void set_constants(const auto& bodies, JointTreeState& tree) {
        Real mass[most_nodes];
        for (int i = tree.first; i < tree.last; ++i) mass[i] = set_body(bodies, node_[i]);
        for (int i = tree.last - 1; i >= tree.first; --i)
            if (node_[i].parent >= 0) mass[node_[i].parent] += mass[i];
        if constexpr (N::fixed_point) {
            for (int i = tree.first; i < tree.last; ++i) {
                Node& node = node_[i];
                node.mass_log2 = static_cast<std::int8_t>(mass[i].ceil_log2_bound());
                if (node.parent < 0) continue;
                node.mass_down = static_cast<std::int8_t>(
                    JointTree<N, features>::clamped(node_[node.parent].mass_log2 - node.mass_log2));
                node.span = reach_of(length_of(own_arm(node_[node.parent]) - parent_arm(node)));
            }
        }
        fit_lengths(tree);
    }
    TUMBLE_COLD [[nodiscard]] static constexpr std::int32_t reach_of(const Real& length) {
        const std::int64_t reach = length.to_fixed(reach_bits, 64) + 1;
        return static_cast<std::int32_t>(reach < most_reach ? reach : most_reach);
    }
    TUMBLE_COLD [[nodiscard]] static constexpr RealVec3 arm_of(const typename Record::Side& side) {
        RealVec3 arm;
        for (int i = 0; i < 3; ++i) arm[i] = static_cast<Real>(N::work(side.arm[i])) * Real::scaled(1, side.arm_log2);
        return arm;
    }
    TUMBLE_COLD [[nodiscard]] constexpr RealVec3 own_arm(const Node& node) const {
        return node.joint == Node::no_joint ? RealVec3{} : arm_of(record_[node.joint].side[node.side]);
    }
    [[nodiscard]] constexpr RealVec3 parent_arm(const Node& node) const {
        return arm_of(record_[node.joint].side[1 - node.side]);
    }
    // What a force at an arm does to the swing of the body across the arm: the largest |e_i x r| / I_i, at least 2^-30.
    TUMBLE_COLD [[nodiscard]] static constexpr Real swing(const auto& bodies, const RealVec3& arm, int b) {
        Real largest = Real::scaled(1, -30);
        for (int i = 0; i < 3; ++i) {
            const Real y = arm[(i + 1) % 3], z = arm[(i + 2) % 3];
            const Real of_axis =
                sqrt(y * y + z * z) * static_cast<Real>(bodies.step_per_moment(b, i)) / bodies.step_length;
            if (of_axis > largest) largest = of_axis;
        }
        return largest;
    }
    // Returns the mass.
    TUMBLE_COLD [[nodiscard]] constexpr Real set_body(const auto& bodies, Node& node) {
        const int b = node.body;
        const Real step = bodies.step_length, mass = step / static_cast<Real>(bodies.step_per_mass(b));
        RealVec3 moment;
        for (int i = 0; i < 3; ++i) moment[i] = step / static_cast<Real>(bodies.step_per_moment(b, i));
        const Real gyration = sqrt(moment.x / mass);
        const int m = N::fixed_point ? mass.ceil_log2_bound() : 0, l = N::fixed_point ? gyration.ceil_log2_bound() : 0;
        node.own_mass_log2 = static_cast<std::int8_t>(m);
        node.own_length_log2 = static_cast<std::int8_t>(l);
        node.mass = J::unit(mass, N::fixed_point ? m : 0);
        node.moment_y = J::unit(moment.y, m + 2 * l);
        node.moment_x_less_y = J::unit(moment.x - moment.y, m + 2 * l);
        node.moment_z_less_y = J::unit(moment.z - moment.y, m + 2 * l);
        constexpr bool is_momentum = std::remove_cvref_t<decltype(bodies)>::Units::has_one_factor;
        for (int i = 0; i < 3; ++i) {
            const Real turn = is_momentum ? moment[i] / (moment.y * Real{2}) : Real::scaled(1, -1);
            node.to_turn[i] = J::unit(turn, 0);
            node.to_angle[i] = J::Factor::of(Real{1} / turn);
            node.share[i] = J::unit(moment[i] / moment.x, 0);
            node.per_share[i] = J::Factor::of(moment.x / moment[i]);
        }
        if constexpr (N::fixed_point) node.own_reach = reach_of(length_of(own_arm(node)) + gyration);
        if (node.joint != Node::no_joint) node.swing[0] = J::Factor::of(swing(bodies, own_arm(node), b));
        if (node.parent >= 0) node.swing[1] = J::Factor::of(swing(bodies, parent_arm(node), node_[node.parent].body));
        return mass;
    }

    Record record_[room]{};
    [[no_unique_address]] If<features.joint_breaks, JointStrength<N>[room], 25> strength_ {};
    [[no_unique_address]] If<features.has_joint_ranges(), JointRange<N>[room], 22> range_ {};
    Node node_[most_nodes]{};
    Kicks kick_[most_nodes]{};
    typename J::Pose pose_[most_nodes]{};  // where a body was when the count of still steps began
    FreeDirection<N> direction_[most_directions]{};
    JointTreeState tree_[most_trees]{};
    bool is_jointed_[features.bodies > 0 ? features.bodies : 1]{};
    std::int16_t node_count_ = 0, tree_count_ = 0, direction_count_ = 0;
    // Half a second, and four at least: a thrown body is in a place at the ends of two steps, but not of three.
    std::int16_t steps_to_rest_ = 4;
};

}  // namespace tumble

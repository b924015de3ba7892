// The direct solution of a tree of joints, in one pass to the root and one back. A joint is its free directions. Each
// is eliminated from the articulated inertia by one inverse root and a change of rank one (Featherstone 1983, "The
// calculation of robot dynamics using articulated-body inertias", in maximal coordinates and impulses). Across the
// other directions a joint shall change the velocity by a given target.
//
// In the world's axes, about each body's anchor, with the velocity v of the anchor and the spin w, the impulse P and
// the angular impulse H that a subtree takes from its parent are
//   P = A v + B w + p,   H = B^T v + C w + h.
// One body has, with the arm r from its centre of mass to its anchor and [r] x = r x x,
//   A = m 1,   B = m [r],   C = I + m (r.r 1 - r r^T).
// A free direction d, a rotation, takes no impulse: d . H = 0. With u = B d, t = C d, D = d . t, both over sqrt(D):
//   A -= u u^T,  B -= u t^T,  C -= t t^T,  k = d . h / sqrt(D),  p -= u k,  h -= t k,
//   q = -(u . v + t . w + k) / sqrt(D),
// with the rate q about d. Of a translation u = A d, t = B^T d, D = d . u, k = d . p / sqrt(D). The parent has them
// about its own anchor, the arm l from it to this anchor:
//   A' = A,   B' = B - A [l],   C' = C - B^T [l] + [l] B'.
//
// Fixed point: matrices are Units over powers of two of mass and length that hold the body's whole subtree. They do not
// decrease towards the root, and no element exceeds 1. A target is a velocity, or a displacement in a step; spins are
// times the length.
#pragma once

#include <tumble/joints/joint_numbers.hpp>
#include <tumble/joints/list.hpp>
#include <tumble/shapes/axes.hpp>

namespace tumble {

// Where a body and the two sides of its joint are, in the world's axes.
template <class N>
struct JointPlace {
    using Unit = typename N::Unit;

    Axes<N> axes;                            // of the body
    StoredVec3<Unit> own_arm;                // from the body's centre of mass to its anchor
    StoredVec3<Unit> arm;                    // from the parent's to that point, or from the world's anchor
    StoredVec3<Unit> own_axis[2];            // of the kind, on the body's side
    StoredVec3<Unit> other_axis[2];          // and on the parent's
    std::int8_t own_log2 = 0, arm_log2 = 0;  // of the arms
};

// A matrix by rows.
template <class U>
struct JointMatrix {
    U element[9];

    [[nodiscard]] TUMBLE_INLINE U* operator[](int row) { return element + 3 * row; }
    [[nodiscard]] TUMBLE_INLINE const U* operator[](int row) const { return element + 3 * row; }
};

// A free direction of a joint.
template <class N>
struct FreeDirection {
    StoredVec3<typename N::Unit> axis;  // d; not of all directions, which are the axes of the world
    bool turns = false;                 // a rotation, else a translation
    std::int8_t only = -1;              // the axis of the world that it is; -1: it has an axis of its own
    StoredVec3<typename N::Unit> u, t;  // over sqrt(D)
    typename JointNumbers<N>::Root root;
    typename N::Unit k;  // of the solution
};

// A body in a tree, with the joint by which it hangs on its parent.
template <class N>
struct JointNode {
    using J = JointNumbers<N>;
    using Unit = typename N::Unit;
    static constexpr int no_joint = -1, world = -1;

    std::int16_t body = 0, parent = -1;          // the parent as a node; -1: the world or a fixed body
    std::int16_t holder = -1;                    // the parent, but of a slack rope, which hands nothing on
    std::int16_t base = world;                   // that fixed body
    std::int16_t joint = no_joint;               // no_joint: a root that is free, with all directions
    std::uint8_t side = 0;                       // of the joint, on which the body is
    std::int8_t turns = 3, slides = 3;           // free rotations and translations
    bool carries = false;                        // it is the parent of a node
    std::int8_t axes = 0;                        // of each side that the kind uses
    std::int16_t direction = 0;                  // the first of them
    std::int8_t mass_log2 = 0, length_log2 = 0;  // of the subtree, kg and m
    // From these to the parent's: of masses, of lengths, and of masses times lengths.
    std::int8_t mass_down = 0, length_down = 0, moment_down = 0;
    typename J::Factor swing[2]{};                    // of the body and of the parent: see JointForest::swing()
    std::int32_t own_reach = 0, span = 0, reach = 0;  // see JointForest::fit_lengths()
    // Of the body: mass, and the middle moment and what the others are more, over powers of two.
    std::int8_t own_mass_log2 = 0, own_length_log2 = 0;
    Unit mass{}, moment_y{}, moment_x_less_y{}, moment_z_less_y{};
    typename J::Factor to_angle[3]{};   // the angle in a step over the state's half turn
    StoredVec3<Unit> to_turn{};         // the inverse
    StoredVec3<Unit> share{};           // I_i / I_x
    typename J::Factor per_share[3]{};  // the inverse
    StoredVec3<Unit> link{};            // from the parent's anchor to this one, over the parent's length
    StoredVec3<Unit> lever{};           // from the centre of mass to the anchor, over the length
    Axes<N> frame;                      // the axes of the body where the factor is of
    JointMatrix<Unit> a, b, c;

    // It hangs by a distance.
    [[nodiscard]] constexpr bool keeps_distance() const { return joint != no_joint && slides > 1; }
};

// What a solution of one body is: the targets, and the change of its motion.
template <class N>
struct JointSolution {
    using Unit = typename N::Unit;
    using Vector = Vec3<Unit>;

    Unit target[6];   // of the anchor's velocity and of the spin, against the parent
    Unit impulse[6];  // P and H
    Vector dv, dw;    // of the centre of mass and of the spin
    Vector anchor_v;  // of the anchor
};

// The nodes first .. last - 1, parents before children.
template <class N, Features features>
class JointTree {
public:
    // A joint of the scene may slide along an axis, and may turn about all of them.
    static constexpr bool may_slide = JointKinds::any_slides(features, 1) || JointKinds::any_slides(features, 2),
                          may_turn_freely = JointKinds::any_turns(features, 3);
    using J = JointNumbers<N>;
    using Unit = typename N::Unit;
    using Vector = Vec3<Unit>;
    using Node = JointNode<N>;
    using Direction = FreeDirection<N>;
    using Solution = JointSolution<N>;

    JointTree(Node* nodes, Direction* directions, int first, int last)
        : node_{nodes}, direction_{directions}, first_{first}, last_{last} {}

    // The factor where the bodies are: the nodes' axes, levers and links and the axes of the directions must be set.
    [[gnu::noinline]] void factor() {
        for (int i = first_; i < last_; ++i) set_own_inertia(node_[i]);
        for (int i = last_ - 1; i >= first_; --i) {
            Node& node = node_[i];
            Direction* const direction = direction_ + node.direction;
            for (int f = 0; f < node.slides + node.turns; ++f) {
                eliminate(node, direction[f]);
                if (is_read(node, f)) take_off(node, direction[f], f + 1 == node.slides + 3);
            }
            if (node.holder >= 0) hand_on(node, node_[node.holder]);
        }
    }
    // Finds the changes of motion that bring about the targets.
    [[gnu::noinline]] void solve(Solution* solution) {
        for (int i = first_; i < last_; ++i)
            for (Unit& impulse : solution[i].impulse) impulse = Unit{};
        for (int i = last_ - 1; i >= first_; --i) {
            const Node& node = node_[i];
            Solution& s = solution[i];
            release(node, s.impulse);
            if (node.holder >= 0) hand_on(node, s, solution[node.holder].impulse);
        }
        for (int i = first_; i < last_; ++i) {
            const Node& node = node_[i];
            set_motion(node, solution[i], node.holder >= 0 ? &solution[node.holder] : nullptr);
        }
    }
    // Out of line in fixed point, where each takes 110 bytes or more.
    [[nodiscard]] TUMBLE_INLINE static Vector across(const Vector& a, const Vector& b) {
        if constexpr (N::fixed_point) return called_across(a, b);
        else return cross<Unit>(a, b);
    }
    [[nodiscard]] TUMBLE_INLINE static Vector to_body(const Axes<N>& axes, const Vector& v) {
        if constexpr (N::fixed_point) return called_to_body(axes, v);
        else return axes.to_body(v);
    }
    [[nodiscard]] TUMBLE_INLINE static Vector to_world(const Axes<N>& axes, const Vector& v) {
        if constexpr (N::fixed_point) return called_to_world(axes, v);
        else return axes.to_world(v);
    }
    [[nodiscard]] TUMBLE_INLINE static Vector down(const Vector& v, int bits) {
        if (!N::fixed_point || bits == 0) return v;
        const typename J::Down by{clamped(bits)};
        return {by(v[0]), by(v[1]), by(v[2])};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr int clamped(int bits) {
        return bits < J::most_down ? bits : J::most_down;
    }
    // With ties to even.
    TUMBLE_INLINE static void lower(Vector& v, int bits) {
        if (N::fixed_point && bits != 0) lower_even(v, bits);
    }
    [[gnu::noinline]] static void lower_even(Vector& v, int bits) {
        v = {J::down_even(v[0], bits), J::down_even(v[1], bits), J::down_even(v[2], bits)};
    }
    // The vector of three of six components.
    [[nodiscard]] TUMBLE_INLINE static Vector three(const Unit* x) { return {x[0], x[1], x[2]}; }
    TUMBLE_INLINE static void set_three(Unit* x, const Vector& v) {
        x[0] = v[0];
        x[1] = v[1];
        x[2] = v[2];
    }

private:
    using Matrix = JointMatrix<Unit>;

    [[nodiscard, gnu::noinline]] static Vector called_across(const Vector& a, const Vector& b) {
        return cross<Unit>(a, b);
    }
    [[nodiscard, gnu::noinline]] static Vector called_to_body(const Axes<N>& axes, const Vector& v) {
        return axes.to_body(v);
    }
    [[nodiscard, gnu::noinline]] static Vector called_to_world(const Axes<N>& axes, const Vector& v) {
        return axes.to_world(v);
    }

    Node* node_;
    Direction* direction_;
    int first_, last_;

    template <class Sum>
    [[nodiscard]] TUMBLE_INLINE static Unit nar(Sum sum) {
        return narrow<Unit>(sum);
    }
    [[nodiscard]] TUMBLE_INLINE static auto add_dot(auto sum, const auto& a, const auto& b) {
        return mul_add(mul_add(mul_add(sum, a[0], b[0]), a[1], b[1]), a[2], b[2]);
    }
    [[nodiscard]] TUMBLE_INLINE static auto dot3(const auto& a, const auto& b) {
        return mul_add(mul_add(mul(a[0], b[0]), a[1], b[1]), a[2], b[2]);
    }
    // Column i of B, by the rows of the matrix.
    struct Column {
        const Matrix& b;
        int i;
        [[nodiscard]] TUMBLE_INLINE Unit operator[](int row) const { return b[row][i]; }
    };

    static void set_own_inertia(Node& node) {
        const int l = node.length_log2 - node.own_length_log2;
        const typename J::Down by_mass{clamped(node.mass_log2 - node.own_mass_log2)},
            by_moment{clamped(node.mass_log2 - node.own_mass_log2 + 2 * l)};
        const Vector r = node.lever, x = node.frame.axis(0), z = node.frame.axis(2);
        const Unit mass = by_mass(node.mass), zero{};
        const Vector mr = along(r, mass);
        // I = I_y 1 + (I_x - I_y) x x^T + (I_z - I_y) z z^T
        const Vector ix = along(x, by_moment(node.moment_x_less_y)), iz = along(z, by_moment(node.moment_z_less_y));
        const Unit trace = by_moment(node.moment_y) + nar(dot(mr, r));
        auto &a = node.a, &b = node.b, &c = node.c;
        a[0][0] = a[1][1] = a[2][2] = mass;
        a[0][1] = a[0][2] = a[1][2] = a[1][0] = a[2][0] = a[2][1] = b[0][0] = b[1][1] = b[2][2] = zero;
        b[0][1] = -mr[2];
        b[0][2] = mr[1];
        b[1][0] = mr[2];
        b[1][2] = -mr[0];
        b[2][0] = -mr[1];
        b[2][1] = mr[0];
        const auto element = [&](int i, int j) {
            return nar(mul_sub(mul_add(mul(ix[i], x[j]), iz[i], z[j]), mr[i], r[j]));
        };
        for (int i = 0; i < 3; ++i) c[i][i] = trace + element(i, i);
        c[0][1] = c[1][0] = element(0, 1);
        c[0][2] = c[2][0] = element(0, 2);
        c[1][2] = c[2][1] = element(1, 2);
    }
    // Finds the part of a direction.
    static void eliminate(const Node& node, Direction& direction) {
        Vector u, t;
        Unit d;
        if (direction.only >= 0) {
            const int i = direction.only;
            for (int r = 0; r < 3; ++r) {
                u[r] = direction.turns ? node.b[r][i] : node.a[r][i];
                t[r] = direction.turns ? node.c[r][i] : node.b[i][r];
            }
            d = direction.turns ? t[i] : u[i];
        } else if (!may_slide || direction.turns) {
            const Vector axis = direction.axis;
            detail::for_axes<N>([&](int r) {
                u[r] = nar(dot3(node.b[r], axis));
                t[r] = nar(dot3(node.c[r], axis));
            });
            d = nar(dot(axis, t));
        } else if constexpr (may_slide) {
            set_slide(node, direction.axis, u, t);
            d = nar(dot(Vector{direction.axis}, u));
        }
        direction.root = J::inverse_root(d);
        detail::for_axes<N>([&](int r) {
            direction.u[r] = direction.root(u[r]);
            direction.t[r] = direction.root(t[r]);
        });
    }
    // False after the last direction of a root, which hands nothing on.
    [[nodiscard]] TUMBLE_INLINE static bool is_read(const Node& node, int direction) {
        return node.parent >= 0 || direction + 1 < node.slides + node.turns;
    }
    // Takes the part of a direction off. Nothing but A remains after the last of three turns.
    static void take_off(Node& node, const Direction& direction, bool is_third_turn) {
        const Vector u = direction.u, t = direction.t;
        for (int r = 0; r < 3; ++r) {
            const Unit ur = direction.u[r], tr = direction.t[r];
            take_off(node.a[r], ur, u);
            if (may_turn_freely && is_third_turn) {
                set_three(node.b[r], Vector::Constant(Unit{}));
                set_three(node.c[r], Vector::Constant(Unit{}));
            } else {
                take_off(node.b[r], ur, t);
                take_off(node.c[r], tr, t);
            }
        }
    }
    [[gnu::noinline, gnu::cold]] static void set_slide(const Node& node, const Vector& axis, Vector& u, Vector& t) {
        for (int r = 0; r < 3; ++r) {
            u[r] = nar(dot3(node.a[r], axis));
            t[r] = nar(dot3(Column{node.b, r}, axis));
        }
    }
    TUMBLE_INLINE static void take_off(Unit* row, Unit a, const Vector& b) {
        row[0] -= nar(mul(a, b[0]));
        row[1] -= nar(mul(a, b[1]));
        row[2] -= nar(mul(a, b[2]));
    }
    // Adds the inertia, about the parent's anchor, to the parent's.
    static void hand_on(const Node& node, Node& parent) {
        const typename J::Down by_mass{node.mass_down}, by_moment{node.moment_down},
            by_square{clamped(node.moment_down + node.length_down)};
        const Vector link = node.link;
        Matrix b, moved;
        for (int i = 0; i < 3; ++i) {
            const Unit x = by_mass(node.a[i][0]), y = by_mass(node.a[i][1]), z = by_mass(node.a[i][2]);
            parent.a[i][0] += x;
            parent.a[i][1] += y;
            parent.a[i][2] += z;
            for (int j = 0; j < 3; ++j) b[i][j] = by_moment(node.b[i][j]);
            // A [l] by rows: a x l
            parent.b[i][0] += moved[i][0] = b[i][0] - nar(mul_sub(mul(y, link[2]), z, link[1]));
            parent.b[i][1] += moved[i][1] = b[i][1] - nar(mul_sub(mul(z, link[0]), x, link[2]));
            parent.b[i][2] += moved[i][2] = b[i][2] - nar(mul_sub(mul(x, link[1]), y, link[0]));
        }
        // C - B^T [l] + [l] B'
        const auto element = [&](int i, int j) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            const auto turned = mul_sub(mul(link[i1], moved[i2][j]), link[i2], moved[i1][j]);
            return by_square(node.c[i][j]) + nar(mul_sub(mul_add(turned, b[j2][i], link[j1]), b[j1][i], link[j2]));
        };
        auto& c = parent.c;
        c[0][0] += element(0, 0);
        c[1][1] += element(1, 1);
        c[2][2] += element(2, 2);
        c[1][0] = c[0][1] += element(0, 1);
        c[2][0] = c[0][2] += element(0, 2);
        c[2][1] = c[1][2] += element(1, 2);
    }

    [[nodiscard]] TUMBLE_INLINE static Vector unit_vector(int i, Unit length) {
        const Unit zero{};
        return {i == 0 ? length : zero, i == 1 ? length : zero, i == 2 ? length : zero};
    }
    // The impulses that free directions do not take. None are on a body that carries no other one.
    TUMBLE_INLINE void release(const Node& node, Unit (&impulse)[6]) {
        Direction* const directions = direction_ + node.direction;
        for (int f = 0; f < node.slides + node.turns; ++f) {
            Direction& direction = directions[f];
            if (!node.carries) {
                direction.k = Unit{};
                continue;
            }
            const Unit* const of = impulse + (direction.turns ? 3 : 0);
            const Unit along = direction.only >= 0 ? of[direction.only] : nar(dot3(direction.axis, of));
            const Unit k = direction.k = direction.root(along);
            if (!is_read(node, f)) break;
            detail::for_axes<N>([&](int r) {
                impulse[r] -= nar(mul(direction.u[r], k));
                impulse[3 + r] -= nar(mul(direction.t[r], k));
            });
        }
    }
    TUMBLE_INLINE static void hand_on(const Node& node, const Solution& s, Unit (&parent)[6]) {
        const Vector v = three(s.target), w = three(s.target + 3);
        Unit impulse[6];
        const bool is_whole = !may_turn_freely || node.turns < 3;  // else B and C are zero
        for (int r = 0; r < 3; ++r) {
            auto sum = dot3(node.a[r], v);
            if (is_whole) sum = add_dot(sum, node.b[r], w);
            impulse[r] = s.impulse[r] + nar(sum);
            impulse[3 + r] = s.impulse[3 + r];
            if (is_whole) impulse[3 + r] += nar(add_dot(dot3(Column{node.b, r}, v), node.c[r], w));
        }
        Vector p = three(impulse), h = three(impulse + 3);
        lower(p, node.mass_down);
        lower(h, node.moment_down);
        set_three(parent, three(parent) + p);
        set_three(parent + 3, three(parent + 3) + h + cross<Unit>(node.link, p));
    }
    TUMBLE_INLINE void set_motion(const Node& node, Solution& s, const Solution* parent) {
        Vector v = three(s.target), w = three(s.target + 3);
        if (parent != nullptr) {
            v += parent->anchor_v + cross<Unit>(parent->dw, node.link);
            Vector of_parent = parent->dw;
            lower(of_parent, node.length_down);
            w += of_parent;
        }
        const Direction* direction = direction_ + node.direction + node.slides + node.turns;
        for (int f = node.slides + node.turns; f > 0; --f) {
            --direction;
            const Unit q = -direction->root(nar(add_dot(dot3(direction->u, v), direction->t, w)) + direction->k);
            const Vector change =
                direction->only >= 0 ? unit_vector(direction->only, q) : along(Vector{direction->axis}, q);
            if (direction->turns) w += change;
            else v += change;
        }
        s.anchor_v = v;
        s.dw = w;
        s.dv = v - cross<Unit>(w, node.lever);
    }
};

}  // namespace tumble

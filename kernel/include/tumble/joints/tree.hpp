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

// Where the two sides of a joint are, in the world's axes: the view of its kind.
template <class N>
struct JointPlace {
    using Unit = typename N::Unit;
    using Vector = Vec3<Unit>;

    Axes<N> axes;                            // of the body
    StoredVec3<Unit> own_arm;                // from the body's centre of mass to its anchor
    StoredVec3<Unit> arm;                    // from the parent's to that point, or from the world's anchor
    StoredVec3<Unit> own_axis[2];            // of the kind, on the body's side
    StoredVec3<Unit> other_axis[2];          // and on the parent's
    std::int8_t own_log2 = 0, arm_log2 = 0;  // of the arms

    [[nodiscard]] TUMBLE_INLINE Vector own(int i) const { return own_axis[i]; }
    [[nodiscard]] TUMBLE_INLINE Vector other(int i) const { return other_axis[i]; }
    // a x b, a + b, the part of b along a unit vector a, and -(a . b) c.
    [[nodiscard]] TUMBLE_INLINE static Vector across(const Vector& a, const Vector& b) { return cross<Unit>(a, b); }
    [[nodiscard]] TUMBLE_INLINE static Vector sum(const Vector& a, const Vector& b) { return a + b; }
    [[nodiscard]] TUMBLE_INLINE static Vector along(const Vector& a, const Vector& b) {
        return tumble::along(a, narrow<Unit>(dot(a, b)));
    }
    [[nodiscard]] TUMBLE_INLINE static Vector less_cosine_times(const Vector& a, const Vector& b, const Vector& c) {
        return tumble::along(c, -narrow<Unit>(dot(a, b)));
    }
};

template <class U>
struct SymmetricMatrix {
    U xx, xy, xz, yy, yz, zz;
};

// A free direction of a joint.
template <class N>
struct FreeDirection {
    StoredVec3<typename N::Unit> axis;  // d; not of all directions, which are the axes of the world
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
    std::int16_t base = world;                   // that fixed body
    std::int16_t joint = no_joint;               // no_joint: a root that is free, with all directions
    std::uint8_t kind = JointKinds::count;       // a free root has none
    std::uint8_t side = 0;                       // of the joint, on which the body is
    std::int8_t turns = 3, slides = 3;           // free rotations and translations
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
    JointPlace<N> place;                // where the factor is of
    SymmetricMatrix<Unit> a, c;
    Unit b[3][3];
};

// What a solution of one body is: the targets, and the change of its motion.
template <class N>
struct JointSolution {
    using Vector = Vec3<typename N::Unit>;

    Vector target_v, target_w;  // of the anchor's velocity and of the spin, against the parent
    Vector dv, dw;              // of the centre of mass and of the spin
    Vector anchor_v;            // of the anchor
    Vector p, h;
};

// The nodes first .. last - 1, parents before children.
template <class N>
class JointTree {
public:
    using J = JointNumbers<N>;
    using Unit = typename N::Unit;
    using Vector = Vec3<Unit>;
    using Node = JointNode<N>;
    using Direction = FreeDirection<N>;
    using Solution = JointSolution<N>;

    JointTree(Node* nodes, Direction* directions, int first, int last)
        : node_{nodes}, direction_{directions}, first_{first}, last_{last} {}

    // The factor where the bodies are: the nodes' places and links must be set.
    [[gnu::noinline]] void factor() {
        for (int i = first_; i < last_; ++i) set_own_inertia(node_[i]);
        for (int i = last_ - 1; i >= first_; --i) {
            Node& node = node_[i];
            set_axes(node);
            Direction* direction = direction_ + node.direction;
            if (node.slides == 3)
                for (int s = 0; s < 3; ++s) eliminate_slide(node, direction[s], unit_vector(s));
            else
                for (int s = 0; s < node.slides; ++s) eliminate_slide(node, direction[s], direction[s].axis);
            direction += node.slides;
            if (node.turns == 3) eliminate_all_turns(node, direction);
            else
                for (int r = 0; r < node.turns; ++r) eliminate_turn(node, direction[r]);
            if (node.parent >= 0) hand_on(node, node_[node.parent]);
        }
    }
    // Finds the changes of motion that bring about the targets.
    [[gnu::noinline]] void solve(Solution* solution) {
        for (int i = first_; i < last_; ++i) solution[i].p = solution[i].h = Vector::Constant(Unit{});
        for (int i = last_ - 1; i >= first_; --i) {
            const Node& node = node_[i];
            Solution& s = solution[i];
            release(node, s);
            if (node.parent >= 0) hand_on(node, s, solution[node.parent]);
        }
        for (int i = first_; i < last_; ++i) {
            const Node& node = node_[i];
            set_motion(node, solution[i], node.parent >= 0 ? &solution[node.parent] : nullptr);
        }
    }
    [[nodiscard]] TUMBLE_INLINE static Vector unit_vector(int i) {
        Vector v = Vector::Constant(Unit{});
        v[i] = N::template constant<Unit>(1);
        return v;
    }
    [[nodiscard]] TUMBLE_INLINE static Vector down(const Vector& v, int bits) {
        return {J::down(v[0], bits), J::down(v[1], bits), J::down(v[2], bits)};
    }
    [[nodiscard]] TUMBLE_INLINE static Vector down_even(const Vector& v, int bits) {
        return {J::down_even(v[0], bits), J::down_even(v[1], bits), J::down_even(v[2], bits)};
    }

private:
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
    [[nodiscard]] TUMBLE_INLINE static Vector times(const SymmetricMatrix<Unit>& m, const Vector& v) {
        return {nar(mul_add(mul_add(mul(m.xx, v[0]), m.xy, v[1]), m.xz, v[2])),
                nar(mul_add(mul_add(mul(m.xy, v[0]), m.yy, v[1]), m.yz, v[2])),
                nar(mul_add(mul_add(mul(m.xz, v[0]), m.yz, v[1]), m.zz, v[2]))};
    }
    // B v, and B^T v.
    [[nodiscard]] TUMBLE_INLINE static Vector times(const Unit (&b)[3][3], const Vector& v) {
        const auto row = [&](int i) { return nar(mul_add(mul_add(mul(b[i][0], v[0]), b[i][1], v[1]), b[i][2], v[2])); };
        return {row(0), row(1), row(2)};
    }
    [[nodiscard]] TUMBLE_INLINE static Vector transposed_times(const Unit (&b)[3][3], const Vector& v) {
        const auto row = [&](int i) { return nar(mul_add(mul_add(mul(b[0][i], v[0]), b[1][i], v[1]), b[2][i], v[2])); };
        return {row(0), row(1), row(2)};
    }

    void set_own_inertia(Node& node) {
        const int m = node.mass_log2 - node.own_mass_log2, l = node.length_log2 - node.own_length_log2;
        const Vector r = down(node.place.own_arm, node.length_log2 - node.place.own_log2);
        const Vector x = node.place.axes.axis(0), z = node.place.axes.axis(2);
        const Unit mass = J::down(node.mass, m), zero{};
        node.a = {mass, zero, zero, mass, zero, mass};
        const Vector mr = along(r, mass);
        auto& b = node.b;
        b[0][0] = b[1][1] = b[2][2] = zero;
        b[0][1] = -mr[2];
        b[0][2] = mr[1];
        b[1][0] = mr[2];
        b[1][2] = -mr[0];
        b[2][0] = -mr[1];
        b[2][1] = mr[0];
        // I = I_y 1 + (I_x - I_y) x x^T + (I_z - I_y) z z^T
        const Vector ix = along(x, J::down(node.moment_x_less_y, m + 2 * l)),
                     iz = along(z, J::down(node.moment_z_less_y, m + 2 * l));
        const auto element = [&](int i, int j) {
            return nar(mul_sub(mul_add(mul(ix[i], x[j]), iz[i], z[j]), mr[i], r[j]));
        };
        const Unit trace = J::down(node.moment_y, m + 2 * l) + nar(dot(mr, r));
        node.c = {trace + element(0, 0), element(0, 1), element(0, 2),
                  trace + element(1, 1), element(1, 2), trace + element(2, 2)};
    }
    // The axes of the free directions, where they are not all.
    void set_axes(const Node& node) {
        JointKinds::with(node.kind, [&]<class Kind>() {
            Direction* direction = direction_ + node.direction;
            if constexpr (Kind::slides > 0)
                for (int s = 0; s < Kind::slides; ++s) direction[s].axis = Kind::slide(node.place, s);
            if constexpr (Kind::turns > 0 && Kind::turns < 3)
                for (int r = 0; r < Kind::turns; ++r) direction[Kind::slides + r].axis = Kind::turn(node.place, r);
        });
    }
    void eliminate_slide(Node& node, Direction& direction, const Vector& axis) {
        direction.axis = axis;
        const Vector u = times(node.a, axis), t = transposed_times(node.b, axis);
        take_off(node, direction, u, t, nar(dot(axis, u)));
    }
    void eliminate_turn(Node& node, Direction& direction) {
        const Vector axis = direction.axis, u = times(node.b, axis), t = times(node.c, axis);
        take_off(node, direction, u, t, nar(dot(axis, t)));
    }
    TUMBLE_INLINE static void set_root(Direction& direction, const Vector& u, const Vector& t, Unit d) {
        direction.root = J::inverse_root(d);
        for (int i = 0; i < 3; ++i) {
            direction.u[i] = direction.root(u[i]);
            direction.t[i] = direction.root(t[i]);
        }
    }
    TUMBLE_INLINE static void take_off_a(SymmetricMatrix<Unit>& a, const StoredVec3<Unit>& u) {
        a.xx -= nar(mul(u[0], u[0]));
        a.xy -= nar(mul(u[0], u[1]));
        a.xz -= nar(mul(u[0], u[2]));
        a.yy -= nar(mul(u[1], u[1]));
        a.yz -= nar(mul(u[1], u[2]));
        a.zz -= nar(mul(u[2], u[2]));
    }
    static void take_off(Node& node, Direction& direction, const Vector& u, const Vector& t, Unit d) {
        set_root(direction, u, t, d);
        take_off_a(node.a, direction.u);
        take_off_a(node.c, direction.t);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) node.b[i][j] -= nar(mul(direction.u[i], direction.t[j]));
    }
    // B and C end as zero: what is eliminated is not computed.
    static void eliminate_all_turns(Node& node, Direction* direction) {
        auto& b = node.b;
        auto& c = node.c;
        const Unit zero{};
        for (int r = 0; r < 3; ++r) {
            const Vector u{b[0][r], b[1][r], b[2][r]};
            const Vector t = r == 0   ? Vector{c.xx, c.xy, c.xz}
                             : r == 1 ? Vector{zero, c.yy, c.yz}
                                      : Vector{zero, zero, c.zz};
            set_root(direction[r], u, t, t[r]);
            const StoredVec3<Unit>&s = direction[r].u, &w = direction[r].t;
            take_off_a(node.a, s);
            for (int j = r + 1; j < 3; ++j)
                for (int i = 0; i < 3; ++i) b[i][j] -= nar(mul(s[i], w[j]));
            if (r == 2) break;
            c.zz -= nar(mul(w[2], w[2]));
            if (r == 1) continue;
            c.yy -= nar(mul(w[1], w[1]));
            c.yz -= nar(mul(w[1], w[2]));
        }
    }
    // Adds the inertia, about the parent's anchor, to the parent's.
    void hand_on(const Node& node, Node& parent) {
        const int m = node.mass_down, l = node.moment_down, ll = l + node.length_down;
        const bool is_whole = node.turns != 3;  // else B and C are zero
        const SymmetricMatrix<Unit> own{J::down(node.a.xx, m), J::down(node.a.xy, m), J::down(node.a.xz, m),
                                        J::down(node.a.yy, m), J::down(node.a.yz, m), J::down(node.a.zz, m)};
        add(parent.a, own);
        const Unit a[3][3] = {{own.xx, own.xy, own.xz}, {own.xy, own.yy, own.yz}, {own.xz, own.yz, own.zz}};
        const Vector r = node.link;
        Unit b[3][3], moved[3][3];
        for (int i = 0; i < 3; ++i) {
            // A [l] by rows: a x l
            const Unit across[3] = {nar(mul_sub(mul(a[i][1], r[2]), a[i][2], r[1])),
                                    nar(mul_sub(mul(a[i][2], r[0]), a[i][0], r[2])),
                                    nar(mul_sub(mul(a[i][0], r[1]), a[i][1], r[0]))};
            for (int j = 0; j < 3; ++j) {
                b[i][j] = is_whole ? J::down(node.b[i][j], l) : Unit{};
                moved[i][j] = b[i][j] - across[j];
                parent.b[i][j] += moved[i][j];
            }
        }
        // -B^T [l] + [l] B'
        const auto element = [&](int i, int j) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            const auto turned = mul_sub(mul(r[i1], moved[i2][j]), r[i2], moved[i1][j]);
            return nar(is_whole ? mul_sub(mul_add(turned, b[j2][i], r[j1]), b[j1][i], r[j2]) : turned);
        };
        SymmetricMatrix<Unit> c{element(0, 0), element(0, 1), element(0, 2),
                                element(1, 1), element(1, 2), element(2, 2)};
        if (is_whole)
            add(c, {J::down(node.c.xx, ll), J::down(node.c.xy, ll), J::down(node.c.xz, ll), J::down(node.c.yy, ll),
                    J::down(node.c.yz, ll), J::down(node.c.zz, ll)});
        add(parent.c, c);
    }
    TUMBLE_INLINE static void add(SymmetricMatrix<Unit>& to, const SymmetricMatrix<Unit>& m) {
        to.xx += m.xx;
        to.xy += m.xy;
        to.xz += m.xz;
        to.yy += m.yy;
        to.yz += m.yz;
        to.zz += m.zz;
    }

    // The impulses that free directions do not take.
    TUMBLE_INLINE void release(const Node& node, Solution& s) {
        Direction* direction = direction_ + node.direction;
        for (int f = 0; f < node.slides + node.turns; ++f, ++direction) {
            const int turn = f - node.slides;
            if (turn < 0) direction->k = direction->root(nar(dot(direction->axis, s.p)));
            else if (node.turns == 3) direction->k = direction->root(s.h[turn]);
            else direction->k = direction->root(nar(dot(direction->axis, s.h)));
            for (int i = 0; i < 3; ++i) {
                s.p[i] -= nar(mul(direction->u[i], direction->k));
                s.h[i] -= nar(mul(direction->t[i], direction->k));
            }
        }
    }
    TUMBLE_INLINE static void hand_on(const Node& node, const Solution& s, Solution& parent) {
        const Vector &v = s.target_v, &w = s.target_w;
        Vector p, h;
        if (node.turns == 3) {
            p = s.p + times(node.a, v);
            h = s.h;
        } else {
            const auto &a = node.a, &c = node.c;
            const auto& b = node.b;
            p = {s.p[0] + nar(add_dot(add_dot_first(a.xx, a.xy, a.xz, v), b[0], w)),
                 s.p[1] + nar(add_dot(add_dot_first(a.xy, a.yy, a.yz, v), b[1], w)),
                 s.p[2] + nar(add_dot(add_dot_first(a.xz, a.yz, a.zz, v), b[2], w))};
            const auto column = [&](int i, auto sum) {
                return nar(mul_add(mul_add(mul_add(sum, b[0][i], v[0]), b[1][i], v[1]), b[2][i], v[2]));
            };
            h = {s.h[0] + column(0, add_dot_first(c.xx, c.xy, c.xz, w)),
                 s.h[1] + column(1, add_dot_first(c.xy, c.yy, c.yz, w)),
                 s.h[2] + column(2, add_dot_first(c.xz, c.yz, c.zz, w))};
        }
        const int m = node.mass_down, l = node.moment_down;
        p = down_even(p, m);
        h = down_even(h, l);
        parent.p += p;
        parent.h += h + cross<Unit>(node.link, p);
    }
    [[nodiscard]] TUMBLE_INLINE static auto add_dot_first(Unit x, Unit y, Unit z, const Vector& v) {
        return mul_add(mul_add(mul(x, v[0]), y, v[1]), z, v[2]);
    }
    TUMBLE_INLINE void set_motion(const Node& node, Solution& s, const Solution* parent) {
        Vector v = s.target_v, w = s.target_w;
        if (parent != nullptr) {
            v += parent->anchor_v + cross<Unit>(parent->dw, node.link);
            w += down_even(parent->dw, node.length_down);
        }
        const Direction* direction = direction_ + node.direction + node.slides + node.turns;
        for (int f = node.slides + node.turns - 1; f >= 0; --f) {
            --direction;
            const Unit q = -direction->root(nar(add_dot(dot(direction->u, v), direction->t, w)) + direction->k);
            const int turn = f - node.slides;
            if (turn < 0) v += along(Vector{direction->axis}, q);
            else if (node.turns == 3) w[turn] += q;
            else w += along(Vector{direction->axis}, q);
        }
        s.anchor_v = v;
        s.dw = w;
        s.dv = v - cross<Unit>(w, down(node.place.own_arm, node.length_log2 - node.place.own_log2));
    }
};

}  // namespace tumble

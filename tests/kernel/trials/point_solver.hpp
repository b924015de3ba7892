// The impulses of one body's contact points on surfaces that do not answer a push: which points push, which grip,
// which slip, and by how much. Newton's method on these states. Each step solves six equations, however many points
// there are.
//
// Velocities are weighted: u = (sqrt(m) v, sqrt(I_i) w_i), world and principal axes, so that the mass matrix is the
// identity. A direction of a point has the row J = (direction, lever); the lever is arm x direction over the radii of
// gyration. Impulses f are those of the world over sqrt(m): u = start + sum J^T f, and Coulomb's cone is |t| <= mu n.
//
// y: a point's velocities above its targets. Its law is one projection (Alart, Curnier 1991), with one r for the body:
//   d = f - r y;  n = max(d_n, 0);  t = d_t, or mu n s where |d_t| > mu n, with s = d_t / |d_t|
// So d decides the state of a point. A small slip has no direction, but d has one. Newton's step for each state is
//   open   f = 0
//   grips  y = 0
//   slips  y_n = 0, t = mu n s - b p (p . y), with p across s and b = r mu n / (|d_t| - mu n)
// y = 0 is softened to f = f before - g y; and b is at most g. Then f depends on u alone, and the velocity's change has
// six equations, whose matrix B is diagonal but for the mu n s of a slip:
//   (1 + sum J^T B J) du = sum J^T c
// What softness leaves, further steps remove. Softness decides two more things. A face has more impulses than
// equations: those of the first step, and with them all, are as even as they can be. And steps between wrong states are
// large where g is large, so g is small until two steps have the same states.
//
// Where the steps do not end, sweeps over the points give another start, and they are the last resort. There is always
// a solution if no target is above zero and no surface moves along itself: standing still is possible then. A bounce
// between several planes may have none.
//
// Cost in products: a system 112, and 21, 63 or 122 for each point that is smooth, grips or slips; a step 36, and 36 a
// plane, 36 to 80 a point; a sweep 54 to 75 a point. PointBounds bounds it.
//
// A trial, which the kernel does not use: with it in place of sweeps, for one body on planes, the worst step of a box
// that tips over on a Cortex-M3 takes half of the cycles, but its mean step takes half as many again, and the firmware
// 15 KB more.
#pragma once

#include "point_numbers.hpp"

namespace tumble {

// Bounds of a solution. Of random problems 97 % take at most the first 10 systems.
struct PointBounds {
    int systems = 10;        // from zero impulses
    int sweeps = 24;         // over the points, from zero impulses, where those have not ended
    int systems_again = 20;  // from there
    int late_sweeps = 32;    // over the points, from zero impulses, where those have not ended either
};

// N: FixedPointNumbers, FloatNumbers<T>.
template <class N, int most_planes, int most_points>
class PointSolver {
public:
    using Unit = typename N::Unit;
    using Speed = typename N::Speed;

    struct Plane {
        Unit direction[3][3];  // the normal, away from the surface, and two tangents; world
        typename N::Friction friction;
    };
    struct Point {
        int plane;                      // the points of a plane follow each other
        typename N::Lever lever[3][3];  // of the directions of the plane, principal axes
        Speed target;                   // least velocity along the normal
        Speed drift[2];                 // of the surface along the tangents
        Speed impulse[3];               // the result
    };
    Plane plane[most_planes];
    Point point[most_points];
    int points = 0;
    // Of the body, linear and angular: without the impulses before solve(), with them after it. In fixed point its norm
    // times the longest row is below 2^30 units.
    Speed velocity[6];

    // A solution is right to `fine`, as a velocity; or to `coarse` where only another system would help. False without
    // a solution: then the impulses push, lie in their cones and add no more energy than the targets ask for, but
    // points may approach.
    [[nodiscard]] bool solve(Speed fine, Speed coarse, const PointBounds& bounds = {}) {
        for (int j = 0; j < 6; ++j) start_[j] = velocity[j];
        set_scales();
        clear_impulses();
        if (take_steps(fine, coarse, bounds.systems)) return true;
        clear_impulses();
        sweep(bounds.sweeps);
        if (take_steps(fine, coarse, bounds.systems_again)) return true;
        clear_impulses();
        sweep(bounds.late_sweeps);
        if (!(find_states() > coarse)) return true;
        shorten();
        return false;
    }

private:
    using Sum = typename N::Sum;
    using Entry = typename N::Entry;
    enum class Kind : std::uint8_t { open, smooth, slips, grips };
    struct State {
        Speed y[3];
        Speed miss[3];    // what the impulses lack of those of their state
        Speed change[3];  // of the impulses over g
        Unit along[2];    // s of a slip
        Speed limit;      // mu n of a slip
        Speed beyond;     // |d_t| - mu n of a slip
        Unit yields;      // b / g of a slip
        Kind kind;

        [[nodiscard]] bool stops(int k) const { return kind == Kind::grips || (k == 0 && kind != Kind::open); }
        [[nodiscard]] Speed across() const { return N::sum(N::product(along[0], y[2]), -N::product(along[1], y[1])); }
    };
    // Powers of two of g, for rows of length 1. It is divided by the root of 1 / r: between the shortest rows and the
    // longest. For a box, a step with a stiff system leaves 2^-8 of what was left, and 22 of the 30 bits of the matrix
    // remain for it. Of stiff 2^8 to 2^13 and of soft 2^3 to 2^7 these leave the fewest random manifolds unsolved at
    // the least cost.
    static constexpr int soft = 5, stiff = 9;

    // r, with r |J|^2 in [1, 2) for the longest row: sweeps over one row then converge. half_: each column of J is
    // divided by 2^half_, so that the diagonal of the matrix is at most 1. A point adds at most 1 + mu times |D|^2 = 1,
    // or 2 l^2 with its largest lever l; all are rounded up to powers of two.
    void set_scales() {
        int row = 0, common = 0, lever[3]{};
        while ((1 << common) < points) ++common;
        int friction = 0;
        for (int i = 0; i < points; ++i) {
            if (const int log2 = N::log2_above(plane[point[i].plane].friction); log2 > friction) friction = log2;
            for (const auto& l : point[i].lever) {
                if (const int log2 = N::log2(N::one_and_square(l)); log2 > row) row = log2;
                for (int j = 0; j < 3; ++j)
                    if (const int log2 = N::log2_above_lever(l[j]); log2 > lever[j]) lever[j] = log2;
            }
        }
        common += friction + 1;
        log2_r_ = -row;
        for (int j = 0; j < 3; ++j) {
            half_[j] = common / 2;
            half_[j + 3] = lever[j] + (common + 1) / 2;
        }
    }
    void clear_impulses() {
        for (int i = 0; i < points; ++i)
            for (Speed& f : point[i].impulse) f = Speed{};
        add_up();
    }
    // Newton's steps with at most `bound` systems. True of a solution.
    bool take_steps(Speed fine, Speed coarse, int bound) {
        for (int i = 0; i < points; ++i) state_[i].kind = Kind::open;
        // Of one plane the first states are right often enough.
        const bool soft_first = points > 0 && point[0].plane != point[points - 1].plane;
        Speed before{};
        for (int systems = 0;;) {
            changed_ = slips_ = false;
            const Speed left = find_states();
            if (!(left > fine)) return true;
            // A system without directions of slip serves again while a step leaves less than an eighth: that ends.
            const bool serves = systems > 0 && log2_g_ == stiff + log2_r_ / 2 && !changed_ && !slips_ &&
                                !(left > N::shifted(before, -3));
            if (!serves) {
                if (systems == bound || (systems > 0 && !changed_)) {
                    if (!(left > coarse)) return true;
                    if (systems == bound) return false;
                }
                log2_g_ = (changed_ && (soft_first || systems > 0) ? soft : stiff) + log2_r_ / 2;
                ++systems;
                assemble();
                eliminate();
            }
            before = left;
            take_step();
        }
    }
    // Sets the states at the present velocity. Returns the largest difference from the law, as a velocity.
    Speed find_states() {
        Speed most = fits_ ? Speed{} : N::largest();
        for (int i = 0; i < points; ++i) {
            State& s = state_[i];
            const Kind before = s.kind;
            Speed wanted[3];
            find_wanted(i, wanted);
            for (int k = 0; k < 3; ++k) {
                const Speed off = N::size(s.stops(k) ? s.y[k] : N::shifted(wanted[k] - point[i].impulse[k], -log2_r_));
                if (off > most) most = off;
            }
            changed_ = changed_ || s.kind != before;
            slips_ = slips_ || s.kind == Kind::slips;
        }
        return most;
    }
    // The law of a point at the present velocity: its state, and the impulses that it wants.
    void find_wanted(int i, Speed (&wanted)[3]) {
        State& s = state_[i];
        const Point& p = point[i];
        for (int k = 0; k < 3; ++k) {
            s.y[k] = N::sum(along_row(i, k, velocity), -(k == 0 ? p.target : p.drift[k - 1]));
            wanted[k] = N::sum(p.impulse[k], -N::shifted(s.y[k], log2_r_));
        }
        const auto mu = plane[p.plane].friction;
        if (!(wanted[0] > Speed{})) {
            s.kind = Kind::open;
            wanted[0] = wanted[1] = wanted[2] = Speed{};
        } else if (!(mu > typename N::Friction{})) {
            s.kind = Kind::smooth;
            wanted[1] = wanted[2] = Speed{};
        } else {
            s.limit = N::product(mu, wanted[0]);
            s.beyond = N::sum(N::direction(wanted[1], wanted[2], s.along), -s.limit);
            s.kind = s.beyond > Speed{} ? Kind::slips : Kind::grips;
            for (int k = 0; k < 2 && s.kind == Kind::slips; ++k) wanted[k + 1] = N::product(s.along[k], s.limit);
        }
    }
    // J u of a row. The points of a plane share the part of the linear velocity: call for each point in order.
    [[nodiscard]] Speed along_row(int i, int k, const Speed (&u)[6]) {
        const Point& p = point[i];
        if (i == 0 || p.plane != point[i - 1].plane) linear_[k] = N::dot(plane[p.plane].direction[k], u);
        return N::sum(linear_[k], N::dot(p.lever[k], u + 3));
    }
    // Adds J^T times the impulses of the points from i to end, or times their changes, to u. False where the impulse of
    // a plane does not fit.
    bool push(int i, int end, bool changes, Sum (&u)[6]) const {
        Sum linear[3]{};
        bool fits = true;
        for (; i < end; ++i) {
            const Point& p = point[i];
            const auto& f = changes ? state_[i].change : p.impulse;
            for (int k = 0; k < 3; ++k) linear[k] += N::wide(f[k]);
            N::add_transposed(u + 3, p.lever, f);
            if (i + 1 < end && point[i + 1].plane == p.plane) continue;
            Speed of_plane[3];
            for (int k = 0; k < 3; ++k) {
                fits = fits && N::fits(linear[k]);
                of_plane[k] = N::shifted(linear[k], 0);
                linear[k] = Sum{};
            }
            N::add_transposed(u, plane[p.plane].direction, of_plane);
        }
        return fits;
    }
    // The velocity with the impulses.
    void add_up() {
        Sum u[6];
        for (int j = 0; j < 6; ++j) u[j] = N::wide(start_[j]);
        fits_ = push(0, points, false, u);
        for (int j = 0; j < 6; ++j) {
            fits_ = fits_ && N::fits(u[j]);
            velocity[j] = N::shifted(u[j], 0);
        }
    }

    // The matrix over g, from rows R = J / 2^half_: 1 / (g 4^half_) + sum R^T (B / g) R. What is symmetric first, as a
    // lower triangle; then the mu n s of slips, as a column times the normal's row.
    void assemble() {
        for (int a = 0; a < 6; ++a)
            for (int b = 0; b < 6; ++b) matrix_[a][b] = a == b ? least_pivot(a) : Entry{};
        Entry row[3][6];
        for (int i = 0; i < points; ++i) {
            State& s = state_[i];
            if (s.kind == Kind::open) continue;
            set_rows(i, row);
            add_square(row[0], row[0]);
            if (s.kind == Kind::grips)
                for (int k = 1; k < 3; ++k) add_square(row[k], row[k]);
            if (s.kind != Kind::slips) continue;
            s.yields = N::ratio(s.limit, s.beyond, log2_r_ - log2_g_);
            for (int j = 0; j < 6; ++j) {
                row[0][j] = N::product(s.along[0], row[2][j]) - N::product(s.along[1], row[1][j]);
                row[1][j] = N::product(s.yields, row[0][j]);
            }
            add_square(row[1], row[0]);
        }
        for (int a = 0; a < 6; ++a)
            for (int b = 0; b < a; ++b) matrix_[b][a] = matrix_[a][b];
        for (int i = 0; i < points; ++i) {
            const State& s = state_[i];
            if (s.kind != Kind::slips) continue;
            set_rows(i, row);
            for (int a = 0; a < 6; ++a) {
                const Entry along = N::product(s.along[0], row[1][a]) + N::product(s.along[1], row[2][a]),
                            drag = N::product(plane[point[i].plane].friction, along);
                for (int b = 0; b < 6; ++b) matrix_[a][b] = matrix_[a][b] + N::product(drag, row[0][b]);
            }
        }
    }
    void set_rows(int i, Entry (&row)[3][6]) const {
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < 3; ++j) {
                row[k][j] = N::entry(plane[point[i].plane].direction[k][j], half_[j]);
                row[k][j + 3] = N::entry(point[i].lever[k][j], half_[j + 3]);
            }
    }
    void add_square(const Entry (&a)[6], const Entry (&b)[6]) {
        for (int i = 0; i < 6; ++i)
            for (int j = 0; j <= i; ++j) matrix_[i][j] = matrix_[i][j] + N::product(a[i], b[j]);
    }
    // Of a direction in which no point pushes.
    [[nodiscard]] Entry least_pivot(int a) const { return N::power(-log2_g_ - 2 * half_[a]); }
    // Factors into triangles. The largest entry of a column is its pivot, so factors are at most 1.
    void eliminate() {
        for (int k = 0; k < 6; ++k) {
            int best = k;
            for (int i = k + 1; i < 6; ++i)
                if (N::size(matrix_[i][k]) > N::size(matrix_[best][k])) best = i;
            pivot_[k] = static_cast<std::int8_t>(best);
            for (int j = 0; j < 6 && best != k; ++j) std::swap(matrix_[k][j], matrix_[best][j]);
            if (matrix_[k][k] == Entry{}) matrix_[k][k] = least_pivot(k);
            inverse_[k] = typename N::Inverse{matrix_[k][k]};
            for (int i = k + 1; i < 6; ++i) {
                Entry* const row = matrix_[i];
                row[k] = inverse_[k].times(row[k]);
                for (int j = k + 1; j < 6; ++j) row[j] = row[j] - N::product(row[k], matrix_[k][j]);
            }
        }
    }
    void substitute(Speed (&x)[6]) const {
        for (int k = 0; k < 6; ++k) std::swap(x[k], x[pivot_[k]]);
        for (int i = 1; i < 6; ++i)
            for (int k = 0; k < i; ++k) x[i] = N::sum(x[i], -N::product(matrix_[i][k], x[k]));
        for (int i = 5; i >= 0; --i) {
            for (int j = i + 1; j < 6; ++j) x[i] = N::sum(x[i], -N::product(matrix_[i][j], x[j]));
            x[i] = inverse_[i].times(x[i]);
        }
    }
    // Changes the impulses with the states and the system as they are. What is left is scaled up to 22 bits. A solution
    // may be longer than the right side by 2 / sqrt(least pivot), which is 2^8 for a box: it stays below 2^30.
    void take_step() {
        Speed most{};
        for (int i = 0; i < points; ++i) {
            find_miss(i);
            for (int k = 0; k < 3; ++k)
                for (const Speed s : {state_[i].y[k], N::shifted(state_[i].miss[k], -log2_g_)})
                    if (N::size(s) > most) most = N::size(s);
        }
        const int up = N::room(most, 22);
        Sum sum[6]{};
        for (int i = 0; i < points; ++i) {
            State& s = state_[i];
            for (Speed& y : s.y) y = N::shifted(y, up);
            find_change(i);
            for (int k = 0; k < 3; ++k) s.change[k] = N::sum(s.change[k], N::shifted(s.miss[k], up - log2_g_));
        }
        (void)push(0, points, true, sum);
        Speed du[6];
        for (int j = 0; j < 6; ++j) du[j] = N::shifted(sum[j], -half_[j]);
        substitute(du);
        for (int j = 0; j < 6; ++j) du[j] = N::shifted(du[j], -half_[j]);
        for (int i = 0; i < points; ++i) {
            State& s = state_[i];
            for (int k = 0; k < 3; ++k) s.y[k] = N::sum(s.y[k], along_row(i, k, du));
            find_change(i);
            for (int k = 0; k < 3; ++k) {
                Speed& f = point[i].impulse[k];
                f = N::sum(f, N::sum(s.miss[k], N::shifted(s.change[k], log2_g_ - up)));
            }
        }
        add_up();
    }
    // What the impulses lack where the state decides them. Takes away the velocities that change no impulse.
    void find_miss(int i) {
        State& s = state_[i];
        const auto& f = point[i].impulse;
        for (int k = 0; k < 3; ++k) s.miss[k] = s.stops(k) ? Speed{} : -f[k];
        if (s.kind == Kind::slips) {
            const Speed limit = N::product(plane[point[i].plane].friction, f[0]), across = s.across();
            for (int k = 0; k < 2; ++k) s.miss[k + 1] = N::sum(s.miss[k + 1], N::product(s.along[k], limit));
            s.y[1] = -N::product(s.along[1], across);
            s.y[2] = N::product(s.along[0], across);
        } else {
            for (int k = 0; k < 3; ++k)
                if (!s.stops(k)) s.y[k] = Speed{};
        }
    }
    // -B y / g.
    void find_change(int i) {
        State& s = state_[i];
        for (int k = 0; k < 3; ++k) s.change[k] = s.stops(k) ? -s.y[k] : Speed{};
        if (s.kind != Kind::slips) return;
        const Speed limit = N::product(plane[point[i].plane].friction, s.change[0]),
                    back = N::product(s.yields, s.across());
        s.change[1] = N::sum(N::product(s.along[0], limit), N::product(s.along[1], back));
        s.change[2] = N::sum(N::product(s.along[1], limit), -N::product(s.along[0], back));
    }

    // Each point in turn takes the impulses that it wants (Gauss-Seidel).
    void sweep(int count) {
        for (int n = 0; n < count; ++n)
            for (int i = 0; i < points; ++i) {
                for (int k = 0; k < 3; ++k) linear_[k] = N::dot(plane[point[i].plane].direction[k], velocity);
                Speed wanted[3];
                find_wanted(i, wanted);
                for (int k = 0; k < 3; ++k) {
                    state_[i].change[k] = N::sum(wanted[k], -point[i].impulse[k]);
                    point[i].impulse[k] = wanted[k];
                }
                Sum u[6];
                for (int j = 0; j < 6; ++j) u[j] = N::wide(velocity[j]);
                (void)push(i, i + 1, true, u);
                for (int j = 0; j < 6; ++j) velocity[j] = N::shifted(u[j], 0);
            }
        add_up();
    }
    // Shortens all impulses where they add more energy, |u|^2 / 2, than the targets ask for. With u = start + p:
    //   start . p + p^2 / 2 <= sum n max(target, 0) + t drift
    void shorten() {
        if (!fits_) clear_impulses();
        typename N::Square room{}, square{};
        for (int j = 0; j < 6; ++j) {
            const Speed p = velocity[j] - start_[j];
            N::add_energy(room, start_[j], -p);
            N::add_energy(square, p, p);
        }
        for (int i = 0; i < points; ++i) {
            const Point& p = point[i];
            if (p.target > Speed{}) N::add_energy(room, p.impulse[0], p.target);
            for (int k = 0; k < 2; ++k) N::add_energy(room, p.impulse[k + 1], p.drift[k]);
        }
        const Unit share = N::ratio_of_energies(room + room, square);
        for (int i = 0; i < points; ++i)
            for (Speed& f : point[i].impulse) f = N::product(share, f);
        add_up();
    }

    State state_[most_points];
    Speed start_[6];
    Speed linear_[3];  // a linear velocity along the directions of a plane
    Entry matrix_[6][6];
    typename N::Inverse inverse_[6];
    std::int8_t pivot_[6];
    int half_[6];
    int log2_r_ = 0, log2_g_ = soft;
    bool changed_ = false;  // some state, by find_states()
    bool slips_ = false;    // some point
    bool fits_ = true;      // the velocity
};

}  // namespace tumble

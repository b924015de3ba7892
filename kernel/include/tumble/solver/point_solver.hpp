// The impulses of a body's contact points on surfaces that do not answer a push: which points press, which grip and which
// slip, and with what impulses. Newton's method on these states; each iteration solves six equations, however many points
// there are.
//
// Velocities are weighted: u = (sqrt(m) v, sqrt(I_i) w_i), world and principal axes, so that the mass matrix is the
// identity. A direction of a point has the row J = (direction, lever), with the lever (arm x direction) over the radii of
// gyration. So impulses f are physical ones over sqrt(m), u = start + sum J^T f, and Coulomb's cone is |t| <= mu n as it
// stands. With y, a point's velocities above their targets, the law of a point is that of the nearest cone
// (Alart, Curnier 1991), here with one r for the body:
//   d = f - r y;  n = max(d_n, 0);  t = d_t, where longer than mu n: mu n s with s = d_t / |d_t|
// d tells the state of the point: open (n = 0), slips (against s), grips. Newton's step of that law is
//   open:  f = 0
//   grips: y = 0
//   slips: y_n = 0, t = mu n s - b p (p . y), p across s, b = r mu n / (|d_t| - mu n)
// Zero velocities are softened to y = -(f - f before) / g, which leaves f = f before - g y. Then f depends on u alone, and
// (1 + sum J^T B J) du = sum J^T c has six unknowns; B is diagonal but for a slip, whose t depends on n. Steps from the
// new impulses remove what the softness leaves. It decides two more things: of the impulses of a face, which four equations
// do not determine, those of the first step are as even as they can be; and a large g makes steps between wrong states
// large, so that g is small until the states of two steps are the same.
//
// Where the steps do not end, sweeps over the points give another start; sweeps are the last resort too. The bounds count
// products: a system about 25 + 90 for each slipping point + 70, a step 36 + 75 a point, a sweep 50 a point.
#pragma once

#include <tumble/solver/point_numbers.hpp>

namespace tumble {

// Bounds of a solution. In 1e5 random problems 97 % need no more than 10 systems.
struct PointBounds {
    int systems = 12;          // from rest
    int sweeps = 16;           // over the points, where these have not ended
    int systems_again = 16;    // from there
    int late_sweeps = 32;      // where these have not ended either
};

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
        int plane;
        typename N::Lever lever[3][3];  // of the directions of the plane
        Speed target;                   // least velocity along the normal
        Speed drift[2];                 // velocities of the surface along the tangents
        Speed impulse[3];               // result
    };
    Plane plane[most_planes];
    Point point[most_points];
    int planes = 0, points = 0;
    Speed velocity[6];  // of the body: linear, angular. Before, and after solve() with the impulses

    // Solves for the impulses and adds them to `velocity`. A solution is right to `fine`, or to `coarse` where a bound
    // was met. False without a solution: the impulses then push, lie in their cones and add no energy beyond what the
    // targets ask for, but points may approach.
    bool solve(Speed fine, Speed coarse, const PointBounds& bounds = {}) {
        for (int j = 0; j < 6; ++j) start_[j] = velocity[j];
        set_scale();
        clear();
        if (iterate(fine, coarse, bounds.systems)) return true;
        clear();
        sweep(bounds.sweeps);
        if (iterate(fine, coarse, bounds.systems_again)) return true;
        clear();
        sweep(bounds.late_sweeps);
        if (!(find_states() > coarse)) return true;
        shorten();
        return false;
    }
    int systems = 0, steps = 0, sweeps = 0;

private:
    using Sum = typename N::Sum;
    using Entry = typename N::Entry;
    enum class Kind : std::uint8_t { open, smooth, slips, grips };
    struct State {
        Speed y[3];       // velocities above the targets
        Speed miss[3];    // what the impulses lack
        Speed change[3];  // of the impulses over g, by a step
        Unit along[2];    // s of a slip
        Speed limit;      // mu n of a slip
        Speed beyond;     // |d_t| less that
        Unit yields;      // b / g of a slip, at most 1
        Kind kind;
    };
    // g, as powers of two.
    static constexpr int soft = 4, stiff = 10;

    // r and the unit of the matrix. With r |J|^2 in [1, 2) the iteration of find_states() alone converges, for one
    // point; the trace of the matrix is below 1.
    void set_scale() {
        int log2 = 0, friction = 0;
        for (int i = 0; i < points; ++i) {
            for (const auto& l : point[i].lever)
                if (const int k = N::log2(N::square(l)); k > log2) log2 = k;
            if (const int k = N::log2_above(plane[point[i].plane].friction); k > friction) friction = k;
        }
        log2_r_ = -log2;
        int count = 0;
        while ((1 << count) < points) ++count;
        half_ = (log2 + 1 + count + friction + 1) / 2;
    }
    void clear() {
        for (int i = 0; i < points; ++i)
            for (Speed& f : point[i].impulse) f = Speed{};
        add_up();
    }
    // Newton's steps, with at most this many systems.
    bool iterate(Speed fine, Speed coarse, int bound) {
        for (int i = 0; i < points; ++i) state_[i].kind = Kind::open;
        Speed before{};
        for (int n = 0;;) {
            changed_ = slips_ = false;
            const Speed left = find_states();
            if (!(left > fine)) return true;
            // The same system serves again as long as it helps. That of slips depends on their directions.
            const bool serves = n > 0 && log2_g_ == stiff && !changed_ && !slips_ && !(left > N::shifted(before, -3));
            if (!serves) {
                if (n == bound) return !(left > coarse);
                log2_g_ = n == 0 || changed_ ? soft : stiff;
                ++n;
                assemble();
                eliminate();
            }
            before = left;
            step();
        }
    }
    // Sets the states of the points at the present velocity. Returns how much the impulses differ from their law, and
    // the velocities.
    Speed find_states() {
        Speed most = fits_ ? Speed{} : N::largest();
        for (int i = 0; i < points; ++i) {
            State& s = state_[i];
            const Kind before = s.kind;
            look(i, velocity, true);
            Speed wanted[3];
            project(i, wanted);
            for (int k = 0; k < 3; ++k) {
                const bool stops = s.kind == Kind::grips || (k == 0 && s.kind != Kind::open);
                const Speed off =
                    N::size(stops ? s.y[k] : N::shifted(wanted[k] - point[i].impulse[k], -log2_r_));
                if (off > most) most = off;
            }
            changed_ = changed_ || s.kind != before;
            slips_ = slips_ || s.kind == Kind::slips;
        }
        return most;
    }
    // The law: sets the state of a point and the impulses that it wants.
    void project(int i, Speed (&wanted)[3]) {
        State& s = state_[i];
        const Point& p = point[i];
        for (int k = 0; k < 3; ++k) wanted[k] = N::sum(p.impulse[k], -N::shifted(s.y[k], log2_r_));
        const typename N::Friction mu = plane[p.plane].friction;
        if (!(wanted[0] > Speed{})) {
            s.kind = Kind::open;
            wanted[0] = wanted[1] = wanted[2] = Speed{};
        } else if (!(mu > typename N::Friction{})) {
            s.kind = Kind::smooth;
            wanted[1] = wanted[2] = Speed{};
        } else {
            const Speed limit = N::product(mu, wanted[0]), length = N::direction(wanted[1], wanted[2], s.along);
            s.kind = length > limit ? Kind::slips : Kind::grips;
            if (s.kind == Kind::grips) return;
            s.limit = limit;
            s.beyond = N::sum(length, -limit);
            for (int k = 0; k < 2; ++k) wanted[k + 1] = N::product(s.along[k], limit);
        }
    }
    // y of a point: J u less the targets; or adds J du to it. The points of a plane follow each other: they share the part
    // of the linear velocity.
    void look(int i, const Speed (&u)[6], bool fresh) {
        const Point& p = point[i];
        for (int k = 0; k < 3; ++k) {
            if (i == 0 || p.plane != point[i - 1].plane) along_[k] = N::dot(plane[p.plane].direction[k], u);
            const Speed before = !fresh ? state_[i].y[k] : -(k == 0 ? p.target : p.drift[k - 1]);
            state_[i].y[k] = N::sum(before, N::sum(along_[k], N::dot(p.lever[k], u + 3)));
        }
    }
    // Adds J^T f of the points from one on to u. False where an impulse of a plane does not fit.
    bool push(int i, int end, bool changes, Sum (&u)[6]) const {
        Sum along[3]{};
        bool fits = true;
        for (; i < end; ++i) {
            const Point& p = point[i];
            const auto& f = changes ? state_[i].change : p.impulse;
            for (int k = 0; k < 3; ++k) along[k] += N::wide(f[k]);
            N::add_transposed(u + 3, p.lever, f);
            if (i + 1 < end && point[i + 1].plane == p.plane) continue;
            Speed of_plane[3];
            for (int k = 0; k < 3; ++k) {
                fits = fits && N::fits(along[k]);
                of_plane[k] = N::shifted(along[k], 0);
                along[k] = Sum{};
            }
            N::add_transposed(u, plane[p.plane].direction, of_plane);
        }
        return fits;
    }
    void add_up() {
        Sum u[6];
        for (int j = 0; j < 6; ++j) u[j] = N::wide(start_[j]);
        fits_ = push(0, points, false, u);
        for (int j = 0; j < 6; ++j) {
            fits_ = fits_ && N::fits(u[j]);
            velocity[j] = N::shifted(u[j], 0);
        }
    }

    // The matrix over g 4^half_: 2^-(log2_g_ + 2 half_) + sum R^T (B / g) R with R = J / 2^half_.
    void assemble() {
        ++systems;
        for (int a = 0; a < 6; ++a)
            for (int b = 0; b < 6; ++b) matrix_[a][b] = Entry{};
        for (int a = 0; a < 6; ++a) matrix_[a][a] = N::power(-log2_g_ - 2 * half_);
        Entry row[3][6], across[6];
        for (int i = 0; i < points; ++i) {
            State& s = state_[i];
            if (s.kind == Kind::open) continue;
            set_rows(i, row);
            add_square(row[0], row[0]);
            if (s.kind == Kind::grips)
                for (int k = 1; k < 3; ++k) add_square(row[k], row[k]);
            if (s.kind != Kind::slips) continue;
            for (int j = 0; j < 6; ++j)
                across[j] = N::product(s.along[0], row[2][j]) - N::product(s.along[1], row[1][j]);
            s.yields = N::ratio(s.limit, s.beyond, log2_r_ - log2_g_);
            Entry yields[6];
            for (int j = 0; j < 6; ++j) yields[j] = N::product(s.yields, across[j]);
            add_square(yields, across);
        }
        for (int a = 0; a < 6; ++a)
            for (int b = 0; b < a; ++b) matrix_[b][a] = matrix_[a][b];
        for (int i = 0; i < points; ++i) {
            const State& s = state_[i];
            if (s.kind != Kind::slips) continue;
            set_rows(i, row);
            const auto mu = plane[point[i].plane].friction;
            for (int a = 0; a < 6; ++a) {
                const Entry rub = N::product(mu, N::product(s.along[0], row[1][a]) + N::product(s.along[1], row[2][a]));
                for (int b = 0; b < 6; ++b) matrix_[a][b] = matrix_[a][b] + N::product(rub, row[0][b]);
            }
        }
    }
    void set_rows(int i, Entry (&row)[3][6]) const {
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < 3; ++j) {
                row[k][j] = N::entry(plane[point[i].plane].direction[k][j], half_);
                row[k][j + 3] = N::entry(point[i].lever[k][j], half_);
            }
    }
    // The lower half of a^T b, which is symmetric.
    void add_square(const Entry (&a)[6], const Entry (&b)[6]) {
        for (int i = 0; i < 6; ++i)
            for (int j = 0; j <= i; ++j) matrix_[i][j] = matrix_[i][j] + N::product(a[i], b[j]);
    }
    // Factors into triangles. The largest entry of a column is the pivot: a factor is at most 1.
    void eliminate() {
        for (int k = 0; k < 6; ++k) {
            int best = k;
            for (int i = k + 1; i < 6; ++i)
                if (N::size(matrix_[i][k]) > N::size(matrix_[best][k])) best = i;
            pivot_[k] = static_cast<std::int8_t>(best);
            for (int j = 0; j < 6 && best != k; ++j) std::swap(matrix_[k][j], matrix_[best][j]);
            if (matrix_[k][k] == Entry{}) matrix_[k][k] = N::power(-log2_g_ - 2 * half_);
            inverse_[k] = typename N::Inverse{matrix_[k][k]};
            for (int i = k + 1; i < 6; ++i) {
                Entry* const row = matrix_[i];
                row[k] = inverse_[k].factor(row[k]);
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
            x[i] = inverse_[i](x[i]);
        }
    }
    // One step with the states and the system as they are. Small residuals are scaled up, to use all bits.
    void step() {
        ++steps;
        Speed most{};
        for (int i = 0; i < points; ++i) {
            find_miss(i);
            for (int k = 0; k < 3; ++k)
                for (const Speed s : {state_[i].y[k], N::shifted(state_[i].miss[k], -log2_g_)})
                    if (N::size(s) > most) most = N::size(s);
        }
        const int up = N::room(most, 26 - half_);
        Sum sum[6]{};
        for (int i = 0; i < points; ++i) {
            State& s = state_[i];
            for (Speed& y : s.y) y = N::shifted(y, up);
            respond(i);
            for (int k = 0; k < 3; ++k) s.change[k] = N::sum(s.change[k], N::shifted(s.miss[k], up - log2_g_));
        }
        (void)push(0, points, true, sum);
        Speed du[6];
        for (int j = 0; j < 6; ++j) du[j] = N::shifted(sum[j], -half_);
        substitute(du);
        for (Speed& x : du) x = N::shifted(x, -half_);
        for (int i = 0; i < points; ++i) {
            const State& s = state_[i];
            look(i, du, false);
            respond(i);
            for (int k = 0; k < 3; ++k) {
                Speed& f = point[i].impulse[k];
                f = N::sum(f, N::sum(s.miss[k], N::shifted(s.change[k], log2_g_ - up)));
            }
        }
        add_up();
    }
    // What the impulses lack of the law at the present velocities where these only decide the state. Clears velocities
    // that decide no more.
    void find_miss(int i) {
        State& s = state_[i];
        const auto& f = point[i].impulse;
        for (int k = 0; k < 3; ++k) {
            const bool stops = s.kind == Kind::grips || (k == 0 && s.kind != Kind::open);
            s.miss[k] = stops ? Speed{} : -f[k];
        }
        if (s.kind == Kind::slips) {
            const Speed limit = N::product(plane[point[i].plane].friction, f[0]), across = across_of(s);
            for (int k = 0; k < 2; ++k) s.miss[k + 1] = N::sum(s.miss[k + 1], N::product(s.along[k], limit));
            s.y[1] = -N::product(s.along[1], across);
            s.y[2] = N::product(s.along[0], across);
        } else if (s.kind != Kind::grips) {
            s.y[1] = s.y[2] = Speed{};
        }
        if (s.kind == Kind::open) s.y[0] = Speed{};
    }
    [[nodiscard]] static Speed across_of(const State& s) {
        return N::sum(N::product(s.along[0], s.y[2]), -N::product(s.along[1], s.y[1]));
    }
    // The changes of a point's impulses over g by its velocities: -B y / g.
    void respond(int i) {
        State& s = state_[i];
        for (int k = 0; k < 3; ++k) s.change[k] = s.kind == Kind::grips ? -s.y[k] : Speed{};
        if (s.kind != Kind::open) s.change[0] = -s.y[0];
        if (s.kind != Kind::slips) return;
        const Speed limit = N::product(plane[point[i].plane].friction, s.change[0]),
                    back = N::product(s.yields, across_of(s));
        s.change[1] = N::sum(N::product(s.along[0], limit), N::product(s.along[1], back));
        s.change[2] = N::sum(N::product(s.along[1], limit), -N::product(s.along[0], back));
    }

    // Sweeps over the points: each takes the impulses that it wants (Gauss-Seidel).
    void sweep(int count) {
        for (int n = 0; n < count; ++n)
            for (int i = 0; i < points; ++i) {
                ++sweeps;
                Speed wanted[3];
                look(i, velocity, true);
                project(i, wanted);
                for (int k = 0; k < 3; ++k) {
                    state_[i].change[k] = wanted[k] - point[i].impulse[k];
                    point[i].impulse[k] = wanted[k];
                }
                Sum u[6];
                for (int j = 0; j < 6; ++j) u[j] = N::wide(velocity[j]);
                (void)push(i, i + 1, true, u);
                for (int j = 0; j < 6; ++j) velocity[j] = N::shifted(u[j], 0);
            }
        add_up();
    }
    // Shortens all impulses where they add energy, |u|^2 / 2, beyond what the targets ask for: u = start + p with
    // start . p + p^2 / 2 <= sum n target + t drift.
    void shorten() {
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
    Speed start_[6], along_[3];
    Entry matrix_[6][6];
    std::int8_t pivot_[6];
    typename N::Inverse inverse_[6];
    int log2_r_ = 0, half_ = 0, log2_g_ = soft;
    bool changed_ = false, slips_ = false, fits_ = true;
};

}  // namespace tumble

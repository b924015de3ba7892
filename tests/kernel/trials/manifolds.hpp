// Random contact manifolds of a box on one to three planes, and a judge of what a solver makes of them. Both are in
// double and know nothing of the kernel. Every number comes from sums, products and roots, so it is the same on every
// machine.
#pragma once

#include "random.hpp"

#include <algorithm>
#include <cmath>

namespace tumble::test {

// Rows are those of weighted velocities: the mass matrix is the identity.
struct Manifold {
    struct Point {
        int plane;
        double row[3][6];  // normal, two tangents; linear, angular
        double target[3];  // along them
    };
    int planes = 0, points = 0;
    double direction[3][3][3], friction[3];
    Point point[12];
    double start[6];
    bool may_jam = false;  // it bounces between several planes, which may have no solution

    [[nodiscard]] double speed() const { return norm(start); }
    [[nodiscard]] static double norm(const double (&u)[6]) {
        double square = 0;
        for (const double x : u) square += x * x;
        return std::sqrt(square);
    }
    [[nodiscard]] double longest_row() const {
        double longest = 1;
        for (int i = 0; i < points; ++i)
            for (const auto& row : point[i].row) longest = std::max(longest, norm(row));
        return longest;
    }
    [[nodiscard]] double velocity(int i, int k, const double (&u)[6]) const {
        double v = 0;
        for (int j = 0; j < 6; ++j) v += point[i].row[k][j] * u[j];
        return v;
    }
};

struct Impulses {
    bool solved = false;
    double velocity[6], impulse[12][3];
};

inline void set_cross(const double* a, const double* b, double* c) {
    for (int i = 0; i < 3; ++i) c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}
inline double dot_of(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline void set_length_to_one(double* v) {
    const double length = std::sqrt(dot_of(v, v));
    for (int i = 0; i < 3; ++i) v[i] /= length;
}

// A box with half edges `half`, principal axes along the world's. `slender`: its radius of gyration about y is that of
// a box times this.
class ManifoldMaker {
public:
    explicit ManifoldMaker(const double (&half)[3], double slender = 1) {
        for (int i = 0; i < 3; ++i) {
            half_[i] = half[i];
            const double a = half[(i + 1) % 3], b = half[(i + 2) % 3];
            gyration_[i] = std::sqrt((a * a + b * b) / 3) * (i == 1 ? slender : 1);
        }
    }
    // Adds a plane with this normal and tangent, and the box's lowest vertices above it, but for `left_out`.
    void add(const double* normal, const double* tangent, double friction, int left_out = -1) {
        const int plane = made.planes++;
        auto& direction = made.direction[plane];
        made.friction[plane] = friction;
        for (int i = 0; i < 3; ++i) {
            direction[0][i] = normal[i];
            direction[1][i] = tangent[i];
        }
        set_cross(direction[0], direction[1], direction[2]);
        int found = 0;
        for (int vertex = 0; vertex < 8; ++vertex) {
            double arm[3];
            bool lowest = true;
            for (int i = 0; i < 3; ++i) {
                arm[i] = (vertex >> i & 1) != 0 ? half_[i] : -half_[i];
                lowest = lowest && !(normal[i] * arm[i] > 0);
            }
            if (!lowest || found++ == left_out) continue;
            auto& point = made.point[made.points++];
            point = {.plane = plane, .row = {}, .target = {}};
            for (int k = 0; k < 3; ++k) {
                double lever[3];
                set_cross(arm, direction[k], lever);
                for (int i = 0; i < 3; ++i) {
                    point.row[k][i] = direction[k][i];
                    point.row[k][i + 3] = lever[i] / gyration_[i];
                }
            }
        }
    }

    Manifold made;

private:
    double half_[3], gyration_[3];
};

// Manifold n of its kind. A vertex, an edge, a face, or three points of a face above each plane; friction 0 to 1.5 and
// none in one of seven; slow and fast; standing still, bouncing, or with gaps. Two of ten have two planes, one has
// three.
inline Manifold random_manifold(int n, double slender = 1) {
    Random random{static_cast<std::uint64_t>(n)};
    double half[3], normal[3][3];
    for (double& h : half) h = random.uniform(0.05, 0.5);
    ManifoldMaker maker{half, slender};
    Manifold& m = maker.made;
    const int of_ten = n / 4 % 10, planes = of_ten < 7 ? 1 : of_ten < 9 ? 2 : 3;
    while (m.planes < planes) {
        const int any_kind = random.between(0, 3), kind = m.planes == 0 ? n % 4 : any_kind, axis = random.between(0, 2);
        double* const v = normal[m.planes];
        for (int i = 0; i < 3; ++i) v[i] = kind == 0 ? random.uniform(-1, 1) : 0;
        if (kind == 1) v[(axis + 1) % 3] = random.uniform(-2, 2);
        if (kind > 0) v[axis] = random.between(0, 1) * 2 - 1;
        set_length_to_one(v);
        bool meets = false;  // nearly the same plane, or a wedge below 60 degrees
        for (int other = 0; other < m.planes; ++other)
            meets = meets || dot_of(normal[other], v) > 0.9 || dot_of(normal[other], v) < -0.5;
        if (meets) continue;
        double any[3], tangent[3];
        do {
            for (double& a : any) a = random.uniform(-1, 1);
            set_cross(v, any, tangent);
        } while (dot_of(tangent, tangent) < 0.01);
        set_length_to_one(tangent);
        const double friction = random.uniform(0, 1.5);
        const bool smooth = random.between(0, 6) == 0;
        const int left_out = random.between(0, 3);
        maker.add(v, tangent, smooth ? 0 : friction, kind == 3 ? left_out : -1);
    }
    const double speed = n % 3 == 0 ? 0.05 : 1, spread = speed * (n % 5 == 0 ? 0.1 : 1);
    for (double& u : m.start) u = random.uniform(-spread, spread);
    for (int p = 0; p < planes; ++p) {
        const double approach = random.uniform(0.05, 1) * speed / std::sqrt(planes);
        for (int i = 0; i < 3; ++i) m.start[i] -= normal[p][i] * approach;
    }
    const int targets = random.between(0, 2);
    const double restitution = random.uniform(0, 1);
    m.may_jam = targets == 1 && planes > 1;
    for (int i = 0; i < m.points; ++i) {
        double& target = m.point[i].target[0];
        if (targets == 1) target = std::max(-restitution * m.velocity(i, 0, m.start), 0.0);
        if (targets == 2) target = -random.uniform(0, 0.3) * speed;
    }
    return m;
}

// How much impulses differ from the laws of contact: as a part of the speed at the start, or of the largest impulse if
// that is more.
struct Verdict {
    double law = 0;       // no approach, no pull, no push at a distance; friction in its cone, and against the slip
    double cone = 0;      // pull, and friction beyond the cone, alone
    double momentum = 0;  // the velocity is not that of the impulses
    double energy = 0;    // gained beyond what the targets ask for
};
inline Verdict judge(const Manifold& m, const Impulses& found) {
    Verdict verdict;
    double scale = m.speed(), sum[6], gained = 0;
    for (int j = 0; j < 6; ++j) {
        sum[j] = m.start[j];
        gained += (found.velocity[j] * found.velocity[j] - m.start[j] * m.start[j]) / 2;
    }
    for (int i = 0; i < m.points; ++i) {
        double y[3];
        const double* const f = found.impulse[i];
        for (int k = 0; k < 3; ++k) {
            y[k] = m.velocity(i, k, found.velocity) - m.point[i].target[k];
            gained -= f[k] * (k == 0 ? std::max(m.point[i].target[0], 0.0) : m.point[i].target[k]);
            for (int j = 0; j < 6; ++j) sum[j] += m.point[i].row[k][j] * f[k];
            scale = std::max(scale, std::abs(f[k]));
        }
        const double limit = m.friction[m.point[i].plane] * f[0], slip = std::hypot(y[1], y[2]);
        verdict.cone = std::max({verdict.cone, -f[0], std::hypot(f[1], f[2]) - limit});
        verdict.law = std::max({verdict.law, verdict.cone, -y[0], std::min(f[0], y[0])});
        if (slip > 1e-5 * scale)
            verdict.law = std::max(verdict.law,
                                   std::min(slip, std::hypot(f[1] + limit * y[1] / slip, f[2] + limit * y[2] / slip)));
    }
    for (int j = 0; j < 6; ++j) verdict.momentum = std::max(verdict.momentum, std::abs(sum[j] - found.velocity[j]));
    for (double* const v : {&verdict.law, &verdict.cone, &verdict.momentum}) *v /= scale;
    verdict.energy = gained / (scale * scale);
    return verdict;
}

// The reference: sweeps over the points (Gauss-Seidel) from the impulses that are given. Each point gets the normal
// impulse that stops it, then the friction that stops it or that its cone allows.
inline void sweep(const Manifold& m, Impulses& found, int sweeps) {
    for (int n = 0; n < sweeps; ++n)
        for (int i = 0; i < m.points; ++i) {
            const auto& point = m.point[i];
            const auto change = [&](int k, double by) {
                found.impulse[i][k] += by;
                for (int j = 0; j < 6; ++j) found.velocity[j] += point.row[k][j] * by;
            };
            double square[3], y[3];
            for (int k = 0; k < 3; ++k) {
                square[k] = 0;
                for (const double x : point.row[k]) square[k] += x * x;
            }
            double(&f)[3] = found.impulse[i];
            y[0] = m.velocity(i, 0, found.velocity) - point.target[0];
            change(0, std::max(-y[0] / square[0], -f[0]));
            double wanted[3];
            for (int k = 1; k < 3; ++k) {
                y[k] = m.velocity(i, k, found.velocity) - point.target[k];
                wanted[k] = f[k] - y[k] / std::max(square[1], square[2]);
            }
            const double limit = m.friction[point.plane] * f[0], size = std::hypot(wanted[1], wanted[2]);
            for (int k = 1; k < 3; ++k) change(k, (size > limit ? wanted[k] * limit / size : wanted[k]) - f[k]);
        }
}

}  // namespace tumble::test

// PointSolver: the laws of contact, mirror images, closed forms and bounds, in every number system.
#include "manifolds.hpp"
#include "point_solver.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

namespace tumble::test {
namespace {

constexpr int manifolds = 100000;

template <class N>
class PointSolvers : public testing::Test {
public:
    static constexpr bool fixed_point = std::is_same_v<N, FixedPointNumbers>;
    // Of the speed along the longest row: what steps of this precision reach; what is accepted where they do not.
    static constexpr double fine = std::is_same_v<N, FloatNumbers<float>> ? 5e-7 : 5e-8, coarse = 5e-7;
    using Solver = PointSolver<N, 3, 12>;

    template <class T>
    [[nodiscard]] static T number(double x) {
        if constexpr (fixed_point) return T{static_cast<std::int32_t>(std::lround(std::ldexp(x, T::fraction_bits)))};
        else return static_cast<T>(x);
    }
    template <class T>
    [[nodiscard]] static double value(T x) {
        return static_cast<double>(x);
    }
    // What speeds are multiplied by: in fixed point their norm, times the longest row, gets 30 bits.
    [[nodiscard]] static double unit(const Manifold& m) {
        return fixed_point ? std::ldexp(1.0, -1 - std::ilogb(m.speed() * m.longest_row())) : 1;
    }
    [[nodiscard]] static Solver solver(const Manifold& m) {
        Solver s{};
        s.points = m.points;
        for (int p = 0; p < m.planes; ++p) {
            s.plane[p].friction = number<typename N::Friction>(m.friction[p]);
            for (int k = 0; k < 3; ++k)
                for (int j = 0; j < 3; ++j) s.plane[p].direction[k][j] = number<typename N::Unit>(m.direction[p][k][j]);
        }
        for (int i = 0; i < m.points; ++i) {
            auto& point = s.point[i];
            point.plane = m.point[i].plane;
            for (int k = 0; k < 3; ++k) {
                const auto target = number<typename N::Speed>(m.point[i].target[k] * unit(m));
                (k == 0 ? point.target : point.drift[k - 1]) = target;
                for (int j = 0; j < 3; ++j) point.lever[k][j] = number<typename N::Lever>(m.point[i].row[k][j + 3]);
            }
        }
        for (int j = 0; j < 6; ++j) s.velocity[j] = number<typename N::Speed>(m.start[j] * unit(m));
        return s;
    }
    [[nodiscard]] static bool solve(Solver& s, const Manifold& m, const PointBounds& bounds = {}) {
        const double speed = m.speed() * m.longest_row() * unit(m);
        return s.solve(number<typename N::Speed>(fine * speed), number<typename N::Speed>(coarse * speed), bounds);
    }
    [[nodiscard]] static Impulses impulses(const Manifold& m, const PointBounds& bounds = {}) {
        Solver s = solver(m);
        Impulses found;
        found.solved = solve(s, m, bounds);
        for (int j = 0; j < 6; ++j) found.velocity[j] = value(s.velocity[j]) / unit(m);
        for (int i = 0; i < m.points; ++i)
            for (int k = 0; k < 3; ++k) found.impulse[i][k] = value(s.point[i].impulse[k]) / unit(m);
        return found;
    }
    // The worst of the random manifolds, found once.
    struct Tally {
        int sure = 0, unsolved = 0, may_jam = 0, jammed = 0;
        Verdict worst, worst_unsolved;
    };
    static void raise(Verdict& worst, const Verdict& v) {
        worst = {std::max(worst.law, v.law), std::max(worst.cone, v.cone), std::max(worst.momentum, v.momentum),
                 std::max(worst.energy, v.energy)};
    }
    static const Tally& tally() {
        static const Tally once = [] {
            Tally t;
            for (int n = 0; n < manifolds; ++n) {
                const Manifold m = random_manifold(n);
                const Impulses found = impulses(m);
                ++(m.may_jam ? t.may_jam : t.sure);
                if (!found.solved) ++(m.may_jam ? t.jammed : t.unsolved);
                raise(found.solved ? t.worst : t.worst_unsolved, judge(m, found));
            }
            return t;
        }();
        return once;
    }
    // A box of 1 m x 0.8 m x 0.6 m flat on the plane z = 0.
    [[nodiscard]] static Manifold flat_box(double friction, const double (&start)[6]) {
        const double half[3] = {0.5, 0.4, 0.3}, up[3] = {0, 0, 1}, along[3] = {1, 0, 0};
        ManifoldMaker maker{half};
        maker.add(up, along, friction);
        std::copy(start, start + 6, maker.made.start);
        return maker.made;
    }
};
using PointNumbers = testing::Types<FixedPointNumbers, FloatNumbers<float>, FloatNumbers<double>>;
TYPED_TEST_SUITE(PointSolvers, PointNumbers);

TYPED_TEST(PointSolvers, leave_at_most_one_of_200_random_manifolds_unsolved) {
    const auto& tally = this->tally();
    EXPECT_LE(tally.unsolved * 200, tally.sure);
    // 7 of 100 such manifolds have no solution that 4000 sweeps and 400 systems in double find.
    EXPECT_LE(tally.jammed * 4, tally.may_jam);
    this->RecordProperty("unsolved", std::to_string(tally.unsolved) + " of " + std::to_string(tally.sure) + ", " +
                                         std::to_string(tally.jammed) + " of " + std::to_string(tally.may_jam));
}
TYPED_TEST(PointSolvers, solve_each_manifold_right_to_a_thousandth_of_the_speed_or_say_that_they_do_not) {
    EXPECT_LT(this->tally().worst.law, 1e-3);
    EXPECT_LT(this->tally().worst.cone, 3e-5);
    this->RecordProperty("law", std::to_string(this->tally().worst.law));
}
TYPED_TEST(PointSolvers, keep_momentum_whether_they_solve_or_not) {
    EXPECT_LT(this->tally().worst.momentum, 1e-6);
    EXPECT_LT(this->tally().worst_unsolved.momentum, 1e-6);
}
TYPED_TEST(PointSolvers, add_no_energy_and_never_pull_whether_they_solve_or_not) {
    EXPECT_LT(this->tally().worst.energy, 1e-6);
    EXPECT_LT(this->tally().worst_unsolved.energy, 1e-6);
    EXPECT_LT(this->tally().worst_unsolved.cone, 3e-5);
}
TYPED_TEST(PointSolvers, leave_at_most_one_of_50_unsolved_where_levers_about_one_axis_are_seven_radii_of_gyration) {
    int unsolved = 0;
    for (int n = 0; n < 2000; ++n) {
        const Manifold m = random_manifold(n, 0.25);
        const Impulses found = this->impulses(m);
        const Verdict v = judge(m, found);
        if (!found.solved && !m.may_jam) ++unsolved;
        ASSERT_LT(v.momentum, 3e-6) << n;
        ASSERT_LT(v.energy, 3e-6) << n;
        ASSERT_LT(found.solved ? v.law : v.cone, 1e-3) << n;
    }
    EXPECT_LE(unsolved * 50, 2000);
    this->RecordProperty("unsolved_long", unsolved);
}
TYPED_TEST(PointSolvers, solve_bounces_in_wedges_of_strong_friction_right_or_say_that_they_do_not) {
    // Strong friction jams wedges: impulses of many times the speed.
    for (int n = 0; n < 20000; ++n) {
        Manifold m = random_manifold(n);
        if (!m.may_jam) continue;
        for (double& mu : m.friction) mu *= 1.5;
        const Impulses found = this->impulses(m);
        const Verdict v = judge(m, found);
        ASSERT_LT(v.momentum, 1e-5) << n;
        ASSERT_LT(v.energy, 1e-5) << n;
        ASSERT_LT(found.solved ? v.law : v.cone, 1e-3) << n;
    }
}
TYPED_TEST(PointSolvers, agree_with_sweeps_in_double_on_smooth_manifolds_whose_velocity_is_unique) {
    int compared = 0;
    for (int n = 0; n < 1000; ++n) {
        Manifold m = random_manifold(n);
        if (m.may_jam) continue;
        for (double& mu : m.friction) mu = 0;
        const Impulses found = this->impulses(m);
        Impulses reference{};
        std::copy(m.start, m.start + 6, reference.velocity);
        sweep(m, reference, 2000);
        if (judge(m, reference).law > 1e-6) continue;
        ++compared;
        ASSERT_TRUE(found.solved) << n;
        for (int j = 0; j < 6; ++j) ASSERT_NEAR(found.velocity[j], reference.velocity[j], 2e-5 * m.speed()) << n;
    }
    EXPECT_GT(compared, 800);
}
TYPED_TEST(PointSolvers, find_what_sweeps_in_double_leave_alone) {
    double worst = 0;
    for (int n = 0; n < 2000; ++n) {
        const Manifold m = random_manifold(n);
        const Impulses found = this->impulses(m);
        if (!found.solved || m.may_jam) continue;
        Impulses swept = found;
        sweep(m, swept, 20);
        for (int j = 0; j < 6; ++j)
            worst = std::max(worst, std::abs(swept.velocity[j] - found.velocity[j]) / m.speed());
    }
    EXPECT_LT(worst, 1e-3);
}

// The image in the plane x = 0. Levers and spins are axial vectors.
template <class Solver>
Solver mirrored(const Solver& of) {
    Solver image = of;
    for (auto& plane : image.plane)
        for (auto& direction : plane.direction) direction[0] = -direction[0];
    for (int i = 0; i < of.points; ++i)
        for (auto& lever : image.point[i].lever)
            for (int j = 1; j < 3; ++j) lever[j] = -lever[j];
    for (const int j : {0, 4, 5}) image.velocity[j] = -of.velocity[j];
    return image;
}
TYPED_TEST(PointSolvers, solve_a_mirror_image_with_the_mirrored_bits) {
    for (int n = 0; n < manifolds; ++n) {
        const Manifold m = random_manifold(n);
        auto one = this->solver(m), image = mirrored(one);
        ASSERT_EQ(this->solve(one, m), this->solve(image, m));
        image = mirrored(image);
        for (int j = 0; j < 6; ++j) ASSERT_EQ(one.velocity[j], image.velocity[j]) << n;
        for (int i = 0; i < m.points; ++i)
            for (int k = 0; k < 3; ++k) ASSERT_EQ(one.point[i].impulse[k], image.point[i].impulse[k]) << n;
    }
}
TYPED_TEST(PointSolvers, keep_a_box_that_lands_symmetrically_symmetric) {
    Random random{7};
    int exact = 0;
    for (int n = 0; n < 1000; ++n) {
        // It moves and turns in the plane y = 0. The points are (-, -), (+, -), (-, +), (+, +).
        const double friction = random.uniform(0, 1.5), along = random.uniform(-1, 1), fall = random.uniform(-1, -0.01),
                     pitch = random.uniform(-1, 1);
        const Manifold m = this->flat_box(friction, {along, 0, fall, 0, pitch, 0});
        auto s = this->solver(m);
        ASSERT_TRUE(this->solve(s, m)) << n;
        double turn = 0, share = 0;
        for (const int j : {1, 3, 5}) turn = std::max(turn, std::abs(this->value(s.velocity[j])));
        for (int i = 0; i < 2; ++i)
            for (int k = 0; k < 3; ++k)
                share = std::max(share, std::abs(this->value(s.point[i].impulse[k]) -
                                                 (k == 2 ? -1 : 1) * this->value(s.point[i + 2].impulse[k])));
        exact += turn == 0 && share == 0 ? 1 : 0;
        ASSERT_LT(turn, 2e-6) << n;
        ASSERT_LT(share, 2e-4) << n;
    }
    // Floats add the points one by one, and softness leaves 2^8 roundings of a share. Sweeps take the points in turn.
    if (this->fixed_point) { EXPECT_GE(exact, 990); }
}
TYPED_TEST(PointSolvers, give_the_same_bits_in_fixed_point_whatever_the_order_of_a_faces_points) {
    if constexpr (std::is_same_v<TypeParam, FixedPointNumbers>) {
        int same = 0, faces = 0;
        for (int n = 2; n < 4 * 1000; n += 4) {
            const Manifold m = random_manifold(n);
            if (m.planes > 1) continue;
            auto one = this->solver(m), other = one;
            std::reverse(other.point, other.point + other.points);
            ++faces;
            if (this->solve(one, m) == this->solve(other, m) &&
                std::memcmp(one.velocity, other.velocity, sizeof one.velocity) == 0)
                ++same;
        }
        // Sweeps depend on it, which 3 of 100 faces need.
        EXPECT_GE(same * 100, faces * 95) << same << " of " << faces;
    }
}

TYPED_TEST(PointSolvers, share_the_load_of_a_face_as_evenly_as_its_moments_allow) {
    const Impulses even = this->impulses(this->flat_box(0.5, {0, 0, -1, 0, 0, 0}));
    ASSERT_TRUE(even.solved);
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(even.impulse[i][0], 0.25, 1e-6);
    // The least sum of squares has no part along (1, -1, -1, 1), which changes no moment.
    const Impulses uneven = this->impulses(this->flat_box(0.3, {0.1, 0.05, -1, 0.1, 0.2, 0}));
    ASSERT_TRUE(uneven.solved);
    EXPECT_GT(uneven.impulse[3][0], uneven.impulse[0][0]);
    EXPECT_NEAR(uneven.impulse[0][0] + uneven.impulse[3][0], uneven.impulse[1][0] + uneven.impulse[2][0], 1e-3);
}
TYPED_TEST(PointSolvers, stop_a_rolling_point_or_let_it_slip_by_the_closed_form_of_a_ball) {
    Random random{11};
    for (int n = 0; n < 1000; ++n) {
        // A ball whose radius is `arm` radii of gyration. A tangential impulse of 1 changes its slip by 1 + arm^2.
        const double arm = random.uniform(0, 3), mu = random.uniform(0, 1), e = random.uniform(0, 1),
                     fall = random.uniform(0.1, 1), x = random.uniform(-2, 2), y = random.uniform(-2, 2),
                     spin[2] = {random.uniform(-1, 1), random.uniform(-1, 1)};
        Manifold m;
        m.planes = m.points = 1;
        m.friction[0] = mu;
        const double directions[3][3] = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
        const double levers[3][3] = {{0, 0, 0}, {0, -arm, 0}, {arm, 0, 0}};
        std::memcpy(m.direction[0], directions, sizeof directions);
        m.point[0] = {.plane = 0, .row = {}, .target = {e * fall, 0, 0}};
        for (int k = 0; k < 3; ++k) {
            std::copy(directions[k], directions[k] + 3, m.point[0].row[k]);
            std::copy(levers[k], levers[k] + 3, m.point[0].row[k] + 3);
        }
        const double start[6] = {x, y, -fall, spin[0], spin[1], 0};
        std::copy(start, start + 6, m.start);
        const Impulses found = this->impulses(m);
        ASSERT_TRUE(found.solved);
        const double normal = (1 + e) * fall, slip[2] = {x - arm * spin[1], y + arm * spin[0]},
                     size = std::hypot(slip[0], slip[1]), friction = std::min(mu * normal, size / (1 + arm * arm));
        EXPECT_NEAR(found.impulse[0][0], normal, 1e-5);
        for (int k = 0; k < 2; ++k) EXPECT_NEAR(found.impulse[0][k + 1], -friction * slip[k] / size, 2e-5) << n;
    }
}
TYPED_TEST(PointSolvers, take_a_box_along_with_a_surface_that_moves) {
    Manifold m = this->flat_box(0.5, {0, 0, -1, 0, 0, 0});
    for (int i = 0; i < 4; ++i) {
        m.point[i].target[0] = 0.125;  // it rises
        m.point[i].target[1] = 0.25;
    }
    Impulses found = this->impulses(m);
    ASSERT_TRUE(found.solved);
    EXPECT_NEAR(found.velocity[0], 0.25, 1e-6);
    EXPECT_NEAR(found.velocity[2], 0.125, 1e-6);
    // Faster than friction allows.
    for (int i = 0; i < 4; ++i) m.point[i].target[1] = 4;
    m.friction[0] = 0.1;
    found = this->impulses(m);
    ASSERT_TRUE(found.solved);
    EXPECT_NEAR(found.velocity[0], 0.1 * 1.125, 1e-6);
}
TYPED_TEST(PointSolvers, leave_a_body_alone_that_moves_away) {
    auto m = this->flat_box(0.5, {0.5, 0.25, 0.125, 0, 0, 0.5});
    auto s = this->solver(m);
    const auto before = s;
    EXPECT_TRUE(this->solve(s, m));
    for (int j = 0; j < 6; ++j) EXPECT_EQ(s.velocity[j], before.velocity[j]);
    s.points = 0;
    EXPECT_TRUE(this->solve(s, m));
}
TYPED_TEST(PointSolvers, do_not_solve_in_floats_what_is_no_number) {
    if constexpr (!TestFixture::fixed_point) {
        using Speed = typename TypeParam::Speed;
        for (const Speed wrong : {std::numeric_limits<Speed>::infinity(), std::numeric_limits<Speed>::quiet_NaN()}) {
            const Manifold m = this->flat_box(0.5, {0.5, 0.25, -1, 0, 0, 0});
            auto s = this->solver(m);
            s.velocity[2] = wrong;
            EXPECT_FALSE(this->solve(s, m));
        }
    }
}
TYPED_TEST(PointSolvers, end_in_sweeps_that_push_and_add_no_energy_where_bounds_are_tight) {
    int unsolved = 0;
    for (int n = 0; n < 2000; ++n) {
        const Manifold m = random_manifold(n);
        const Impulses found = this->impulses(m, {.systems = 0, .sweeps = 0, .systems_again = 0, .late_sweeps = n % 4});
        const Verdict v = judge(m, found);
        ASSERT_LT(v.momentum, 1e-6) << n;
        ASSERT_LT(v.energy, 1e-6) << n;
        ASSERT_LT(v.cone, 1e-6) << n;
        if (found.solved) ASSERT_LT(v.law, 1e-3) << n;
        else ++unsolved;
    }
    EXPECT_GT(unsolved, 1000);
}

// Counts systems: each inverts six pivots.
struct CountedNumbers : FloatNumbers<double> {
    static inline int inverses = 0;
    struct Inverse : FloatNumbers<double>::Inverse {
        Inverse() = default;
        explicit Inverse(double x) : FloatNumbers<double>::Inverse{x} { ++inverses; }
    };
};
TEST(PointBound, holds_for_the_systems_of_every_manifold) {
    using Counted = PointSolvers<CountedNumbers>;
    std::vector<int> systems;
    for (int n = 0; n < 2000; ++n) {
        const Manifold m = random_manifold(n);
        CountedNumbers::inverses = 0;
        (void)Counted::impulses(m, {.systems = 5, .sweeps = 4, .systems_again = 3});
        systems.push_back(CountedNumbers::inverses / 6);
    }
    std::sort(systems.begin(), systems.end());
    EXPECT_EQ(systems.back(), 5 + 3);
    EXPECT_LE(systems[systems.size() / 2], 4);
}

// FNV-1a of all results: the same on every machine, with every compiler.
TYPED_TEST(PointSolvers, give_the_same_bits_everywhere) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    const auto add = [&](const auto& x) {
        unsigned char bytes[sizeof x];
        std::memcpy(bytes, &x, sizeof x);
        for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001b3u;
    };
    for (int n = 0; n < 2000; ++n) {
        const Manifold m = random_manifold(n);
        auto s = this->solver(m);
        add(this->solve(s, m));
        for (const auto& v : s.velocity) add(v);
        for (int i = 0; i < m.points; ++i)
            for (const auto& f : s.point[i].impulse) add(f);
    }
    const std::uint64_t expected = this->fixed_point                        ? 17210955248045127320u
                                   : sizeof(typename TypeParam::Speed) == 4 ? 12354928686093508113u
                                                                            : 4451340026702485650u;
    EXPECT_EQ(hash, expected);
}

}  // namespace
}  // namespace tumble::test

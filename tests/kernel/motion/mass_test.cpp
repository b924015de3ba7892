// Mass properties against integrals over the shapes and against the definition of principal axes.
#include "random.hpp"
#include "tolerances.hpp"
#include "worlds.hpp"

#include <algorithm>
#include <cmath>

namespace tumble::test {
namespace {

struct Matrix {
    Number e[3][3]{};
};
Matrix matrix(const InertiaTensor& i) {
    return {{{number(i.xx), number(i.xy), number(i.xz)},
             {number(i.xy), number(i.yy), number(i.yz)},
             {number(i.xz), number(i.yz), number(i.zz)}}};
}
Number largest(const Matrix& m) {
    Number l = 0;
    for (const auto& row : m.e)
        for (const Number x : row) l = std::max(l, std::abs(x));
    return l;
}
Number difference(const Matrix& a, const Matrix& b) {
    Number l = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) l = std::max(l, std::abs(a.e[i][j] - b.e[i][j]));
    return l;
}
// R diag(d) R^T
Matrix in_turned_axes(Rotation q, Vector d) {
    const Vector columns[3] = {q.rotate({1, 0, 0}), q.rotate({0, 1, 0}), q.rotate({0, 0, 1})};
    Matrix m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k) m.e[i][j] += columns[k][i] * d[k] * columns[k][j];
    return m;
}

// A homogeneous body of revolution about z, of mass 1: volume and moments by slices.
struct Revolution {
    Number volume, axial, transverse;
};
template <class Radius>
Revolution slices(Number half_length, Radius&& radius) {
    const int n = 1 << 14;
    Number volume = 0, axial = 0, transverse = 0;
    for (int i = 0; i <= n; ++i) {
        const Number weight = (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2) / Number(3) * (2 * half_length / n);
        const Number z = half_length * (2 * static_cast<Number>(i) / n - 1), r = radius(z), area = pi * r * r;
        volume += weight * area;
        axial += weight * area * r * r / 2;
        transverse += weight * area * (r * r / 4 + z * z);
    }
    return {volume, axial / volume, transverse / volume};
}
void expect_revolution(const Shape& shape, const Revolution& expected) {
    const Number mass = 2.5L;
    const InertiaTensor i = inertia_of(shape, Real{2.5});
    EXPECT_LE(std::abs(number(i.xx) / (mass * expected.transverse) - 1), tolerance::quadrature);
    EXPECT_EQ(i.xx, i.yy);
    EXPECT_LE(std::abs(number(i.zz) / (mass * expected.axial) - 1), tolerance::quadrature);
    EXPECT_TRUE(i.xy.is_zero() && i.xz.is_zero() && i.yz.is_zero());
    EXPECT_LE(std::abs(number(volume_of(shape)) / expected.volume - 1), tolerance::quadrature);
}

TEST(mass, sphere_has_the_moments_and_volume_of_its_slices) {
    expect_revolution({ShapeKind::sphere, {0.3, 0, 0}}, slices(0.3L, [](Number z) {
                          return std::sqrt(std::max(Number(0), Number(0.3) * Number(0.3) - z * z));
                      }));
}
TEST(mass, cylinder_has_the_moments_and_volume_of_its_slices) {
    expect_revolution({ShapeKind::cylinder, {0.2, 0.7, 0}}, slices(0.35L, [](Number) { return Number(0.2); }));
}
TEST(mass, capsule_has_the_moments_and_volume_of_its_slices) {
    for (const double length : {0.7, 0.01, 30.0}) {
        const Number half = static_cast<Number>(length) / 2;
        expect_revolution({ShapeKind::capsule, {0.2, length, 0}}, slices(half + 0.2L, [&](Number z) {
                              const Number beyond = std::max(Number(0), std::abs(z) - half);
                              return std::sqrt(std::max(Number(0), 0.04L - beyond * beyond));
                          }));
    }
}

TEST(mass, box_has_a_twelfth_of_the_squares_of_its_edges) {
    const InertiaTensor i = inertia_of({ShapeKind::box, {1, 2, 3}}, Real{12});
    EXPECT_LE(std::abs(number(i.xx) - 13), 13 * tolerance::closed_form);
    EXPECT_LE(std::abs(number(i.yy) - 10), 10 * tolerance::closed_form);
    EXPECT_LE(std::abs(number(i.zz) - 5), 5 * tolerance::closed_form);
    EXPECT_EQ(volume_of({ShapeKind::box, {1, 2, 3}}), Real{6});
}

// Strict warnings are errors here: members that an initialiser leaves out must have a default.
TEST(mass, elements_of_a_tensor_that_are_left_out_are_zero) {
    constexpr InertiaTensor diagonal{.xx = 1, .yy = 2, .zz = 3}, with_one{.xx = 1, .yy = 2, .zz = 3, .xy = 4};
    EXPECT_TRUE(diagonal.xy.is_zero() && diagonal.xz.is_zero() && diagonal.yz.is_zero());
    EXPECT_TRUE(with_one.xy == Real{4} && with_one.xz.is_zero() && with_one.yz.is_zero());
}

TEST(mass, hoop_has_the_moments_of_its_points) {
    const int n = 360;
    std::vector<PointMass> points;
    for (int i = 0; i < n; ++i) {
        const Number a = 2 * pi * static_cast<Number>(i) / n;
        points.push_back({{real(0.4L * std::cos(a)), real(0.4L * std::sin(a)), 0}, Real{3} / Real{n}});
    }
    const PointCloud cloud = point_cloud(points.data(), n);
    const Matrix expected = matrix(cloud.inertia), got = matrix(inertia_of({ShapeKind::hoop, {0.4, 0, 0}}, Real{3}));
    EXPECT_LE(difference(got, expected), tolerance::pi_as_double);
    EXPECT_TRUE(volume_of({ShapeKind::hoop, {0.4, 0, 0}}).is_zero());
}

TEST(mass, moments_of_shapes_are_proportional_to_mass) {
    for (const Shape& shape : {Shape{ShapeKind::box, {1, 2, 3}}, Shape{ShapeKind::sphere, {2, 0, 0}},
                               Shape{ShapeKind::capsule, {1, 1, 0}}}) {
        const Matrix one = matrix(inertia_of(shape, Real{1})), heavy = matrix(inertia_of(shape, Real{1e6})),
                     light = matrix(inertia_of(shape, Real{1e-6}));
        for (int k = 0; k < 3; ++k) {
            EXPECT_LE(std::abs(heavy.e[k][k] / one.e[k][k] / 1e6L - 1), tolerance::closed_form);
            EXPECT_LE(std::abs(light.e[k][k] / one.e[k][k] / static_cast<Number>(1e-6) - 1), tolerance::closed_form);
        }
    }
}

TEST(mass, a_cloud_of_points_filling_a_box_tends_to_the_box) {
    // n^3 cells. The own moment of each cell is missing, a relative error of 1 / n^2.
    const int n = 8;
    const Number edges[3] = {1, 2, 3};
    std::vector<PointMass> points;
    const auto at = [&](int i, int axis) {
        return real(10 + edges[axis] * ((static_cast<Number>(i) + 0.5L) / n - 0.5L));
    };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < n; ++k) points.push_back({{at(i, 0), at(j, 1), at(k, 2)}, Real{6} / Real{n * n * n}});
    const PointCloud cloud = point_cloud(points.data(), n * n * n);
    EXPECT_LE(std::abs(number(cloud.mass) - 6), tolerance::closed_form);
    for (int i = 0; i < 3; ++i) EXPECT_LE(std::abs(number(cloud.centre[i]) - 10), tolerance::closed_form);
    const Matrix got = matrix(cloud.inertia), box_tensor = matrix(inertia_of({ShapeKind::box, {1, 2, 3}}, Real{6}));
    for (int i = 0; i < 3; ++i)
        EXPECT_LE(std::abs(got.e[i][i] / box_tensor.e[i][i] / (1 - 1 / Number(n * n)) - 1), tolerance::closed_form);
    EXPECT_LE(std::abs(got.e[0][1]) + std::abs(got.e[0][2]) + std::abs(got.e[1][2]), tolerance::closed_form);
}

TEST(mass, the_tensor_of_points_does_not_depend_on_where_the_cloud_is) {
    const PointMass here[] = {{{1, 0, 0}, 1}, {{0, 2, 0}, 2}, {{0, 0, -1}, 3}, {{1, 1, 1}, 4}};
    PointMass there[4];
    for (int i = 0; i < 4; ++i) there[i] = {here[i].position + RealVec3{64, -32, 16}, here[i].mass};
    EXPECT_LE(difference(matrix(point_cloud(here, 4).inertia), matrix(point_cloud(there, 4).inertia)),
              tolerance::closed_form);
}

void expect_principal(const InertiaTensor& tensor) {
    const PrincipalInertia p = principal_inertia(tensor);
    const Matrix m = matrix(tensor);
    const Rotation q = rotation(p.principal);
    EXPECT_LE(difference(in_turned_axes(q, vector(p.moments)), m),
              largest(m) * tolerance::jacobi);  // a rotation: right-handed by construction
    EXPECT_LE(std::abs(q.norm2() - 1), tolerance::jacobi);
    EXPECT_TRUE(p.moments.x >= p.moments.y && p.moments.y >= p.moments.z);
}

TEST(mass, principal_axes_give_back_random_tensors) {
    Random random{1};
    for (int i = 0; i < 2000; ++i) {
        const auto component = [&] { return static_cast<Number>(random.uniform(-1, 1)); };
        const Rotation q = Rotation{component(), {component(), component(), component()}}.normalized();
        Vector d{static_cast<Number>(random.uniform(0.1, 1)), static_cast<Number>(random.uniform(0.1, 1)),
                 static_cast<Number>(random.uniform(0.1, 1))};
        const int kind = random.between(0, 6);
        if (kind == 1) d.y = d.x;  // symmetric tops, of both kinds
        if (kind == 2) d.z = d.y;
        if (kind == 3) d.y = d.z = d.x;                                                                // sphere
        if (kind == 4) d.x = d.y * 1e-5L;                                                              // rod
        if (kind == 5) d.x = d.y + d.z;                                                                // plate
        if (kind == 6) d.y = d.x * (1 + static_cast<Number>(std::ldexp(1, -random.between(10, 60))));  // nearly equal
        const Matrix m = in_turned_axes(q, d);
        const Real scale = Real::scaled(1, random.between(-60, 60));
        expect_principal({real(m.e[0][0]) * scale, real(m.e[1][1]) * scale, real(m.e[2][2]) * scale,
                          real(m.e[0][1]) * scale, real(m.e[0][2]) * scale, real(m.e[1][2]) * scale});
    }
}

TEST(mass, principal_axes_of_every_diagonal_order_are_a_permutation) {
    int order[3] = {1, 2, 3};
    do {
        const InertiaTensor tensor{order[0], order[1], order[2], 0, 0, 0};
        const PrincipalInertia p = principal_inertia(tensor);
        EXPECT_EQ(p.moments.x, Real{3});
        EXPECT_EQ(p.moments.y, Real{2});
        EXPECT_EQ(p.moments.z, Real{1});
        expect_principal(tensor);
    } while (std::next_permutation(order, order + 3));
    const PrincipalInertia sorted = principal_inertia({3, 2, 1, 0, 0, 0}),
                           equal = principal_inertia({2, 2, 2, 0, 0, 0});
    EXPECT_LE(std::abs(number(sorted.principal.w) - 1), tolerance::jacobi);  // the user's own axes
    EXPECT_LE(std::abs(number(equal.principal.w) - 1), tolerance::jacobi);
}

TEST(mass, tensor_diagonalisation_is_a_constant_expression) {
    constexpr PrincipalInertia p = principal_inertia({2, 2, 3, 1, 0, 0});
    static_assert(abs(p.moments.x - Real{3}) < Real::scaled(1, -55));
    EXPECT_LE(std::abs(number(p.moments.z) - 1), 4 * tolerance::jacobi);
}

TEST(mass, body_helpers_fill_in_shape_mass_and_tensor) {
    const BodySpec b = box(Real{2}, {1, 2, 3});
    EXPECT_EQ(b.mass, Real{2});
    EXPECT_EQ(b.shape.kind, ShapeKind::box);
    EXPECT_LE(difference(matrix(b.inertia), matrix(inertia_of({ShapeKind::box, {1, 2, 3}}, Real{2}))), 0);
    EXPECT_EQ(sphere(Real{1}, Real{2}).shape.size.x, Real{2});
    EXPECT_EQ(cylinder(Real{1}, Real{2}, Real{3}).shape.size.y, Real{3});
    EXPECT_EQ(capsule(Real{1}, Real{2}, Real{3}).shape.kind, ShapeKind::capsule);
    EXPECT_EQ(hoop(Real{1}, Real{2}).shape.kind, ShapeKind::hoop);
    EXPECT_EQ((1.5_kg).to_double(), 1.5);
    EXPECT_EQ((2_m).to_double(), 2);
}

}  // namespace
}  // namespace tumble::test

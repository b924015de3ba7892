// The arithmetic of loads against long double, the kicks that a world keeps, and the closed form of the half kick that
// ends a step. A bound is the rounding of a format: half a unit of 30 bits is 2^-31 of a number that fills them.
#include <tumble/tumble.hpp>

#include "random.hpp"
#include "tolerances.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace tumble::test::load_arithmetic {
namespace {

using N = Q32<RoomRange>;
using L = LoadNumbers<N>;
using Number = long double;

Number value(L::Factor f) { return std::ldexp(Number(f.mantissa), f.exponent); }
Number value(const L::Vector& v, int i) { return std::ldexp(Number(v.mantissa[i]), v.exponent); }
Number length(const L::Vector& v) {
    Number squares = 0;
    for (int i = 0; i < 3; ++i) squares += value(v, i) * value(v, i);
    return std::sqrt(squares);
}

// Three sums of any size below 2^60 units, and their place in metres.
struct Sums {
    std::int64_t raw[3];
    explicit Sums(Random& random) {
        const int bits = random.between(4, 60);
        for (std::int64_t& r : raw) r = static_cast<std::int64_t>(random.bits()) >> (63 - bits);
        raw[random.between(0, 2)] |= 1;  // not zero
    }
    [[nodiscard]] L::Vector vector() const {
        const auto place = [&](int i) { return L::place(N::PositionSum{raw[i]}); };
        return L::between({place(0), place(1), place(2)});
    }
    [[nodiscard]] Number metres(int i) const { return std::ldexp(Number(raw[i]), -N::PositionSum::fraction_bits); }
};

L::Factor any_factor(Random& random) {
    const auto mantissa = static_cast<std::int32_t>(0x40000000u | (random.bits() & 0x3fffffffu));
    return {random.between(0, 1) != 0 ? mantissa : -mantissa, random.between(-80, 20)};
}

TEST(load_numbers, a_vector_has_30_bits_of_its_largest_component) {
    Random random{1};
    for (int n = 0; n < tests::many; ++n) {
        const Sums sums{random};
        const L::Vector v = sums.vector();
        Number most = 0;
        for (int i = 0; i < 3; ++i) most = std::max(most, std::abs(sums.metres(i)));
        for (int i = 0; i < 3; ++i) ASSERT_LE(std::abs(value(v, i) - sums.metres(i)), most * 0x1p-30L) << n;
    }
}

TEST(load_numbers, a_vector_across_the_whole_range_has_its_bits_too) {
    Random random{5};
    for (int n = 0; n < tests::many; ++n) {
        std::int64_t to[3], from[3];
        Number most = 0, metres[3];
        for (int i = 0; i < 3; ++i) {
            to[i] = random.int64();
            from[i] = random.int64();
            metres[i] = std::ldexp(Number(to[i]) - Number(from[i]), -N::PositionSum::fraction_bits);
            most = std::max(most, std::abs(metres[i]));
        }
        const auto sum = [&](int i) { return L::place(N::PositionSum{to[i]}) - L::place(N::PositionSum{from[i]}); };
        const L::Vector v = L::between({sum(0), sum(1), sum(2)});
        for (int i = 0; i < 3; ++i) ASSERT_LE(std::abs(value(v, i) - metres[i]), most * 0x1p-30L) << n;
    }
}

TEST(load_numbers, the_inverse_length_is_rounded_to_30_bits) {
    Random random{2};
    for (int n = 0; n < tests::many; ++n) {
        const L::Vector v = Sums{random}.vector();
        ASSERT_LE(std::abs(value(L::inverse_length(v)) * length(v) - 1), 0x1.001p-31L) << n;
    }
    // The ends of the two ranges that the square is scaled to.
    for (const std::int32_t m : {1 << 29, (1 << 29) + 1, (1 << 30) - 1, 1 << 30})
        for (const std::int32_t other : {0, m}) {
            const L::Vector v{{m, other, -other}, -30};
            EXPECT_LE(std::abs(value(L::inverse_length(v)) * length(v) - 1), 0x1.001p-31L) << m << " " << other;
        }
}

TEST(load_numbers, products_and_sums_of_factors_are_rounded_once) {
    Random random{3};
    for (int n = 0; n < tests::many; ++n) {
        const L::Factor a = any_factor(random), b = any_factor(random);
        const Number product = value(a) * value(b), sum = value(a) + value(b);
        ASSERT_LE(std::abs(value(L::product(a, b)) - product), std::abs(product) * 0x1.001p-31L) << n;
        // Half a unit of the result, or what an alignment to the larger drops.
        const Number larger = std::max(std::abs(value(a)), std::abs(value(b)));
        ASSERT_LE(std::abs(value(L::sum(a, b)) - sum), std::abs(sum) * 0x1p-31L + larger * 0x1p-60L) << n;
        ASSERT_EQ(L::exceeds_power_of_two<-20>(a), value(a) > 0x1p-20L) << n;
    }
}

TEST(load_numbers, a_rotation_turns_as_the_formula_says_at_any_length_of_the_quaternion) {
    Random random{4};
    for (int n = 0; n < tests::many; ++n) {
        const L::Vector v = Sums{random}.vector();
        Number q[4], norm = 0;
        for (Number& c : q) {
            c = Number(random.between(-1000000, 1000000)) + 0.5L;
            norm += c * c;
        }
        // Methods leave |q| off 1 by up to a thousandth.
        const Number scale = (1 + Number(random.between(-1000, 1000)) * 1e-6L) / std::sqrt(norm);
        Quat<N::Unit> unit;
        std::int32_t raw[4];
        for (int i = 0; i < 4; ++i) {
            raw[i] = static_cast<std::int32_t>(std::lround(std::ldexp(q[i] * scale, 30)));
            q[i] = std::ldexp(Number(raw[i]), -30);
        }
        unit.w = {raw[0]};
        unit.v = {N::Unit{raw[1]}, N::Unit{raw[2]}, N::Unit{raw[3]}};
        const Number dot = q[1] * value(v, 0) + q[2] * value(v, 1) + q[3] * value(v, 2);
        const Number along = q[0] * q[0] - q[1] * q[1] - q[2] * q[2] - q[3] * q[3];
        const L::Vector to_world = L::rotated(unit, v), back = L::rotated_back(unit, v);
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            const Number cross = q[1 + j] * value(v, k) - q[1 + k] * value(v, j),
                         common = along * value(v, i) + 2 * dot * q[1 + i];
            // Roundings to 30 bits: of the cosine, of u . v and u x v, which count twice, and of the sum.
            const Number bound = length(v) * 6 * 0x1p-30L;
            ASSERT_LE(std::abs(value(to_world, i) - (common + 2 * q[0] * cross)), bound) << n;
            ASSERT_LE(std::abs(value(back, i) - (common - 2 * q[0] * cross)), bound) << n;
        }
    }
}

TEST(load_numbers, strong_loads_cancel_and_a_load_out_of_range_is_held_and_told) {
    const N::Scale scale = N::Scale::of(Real{1} / Real{256}, Real{1} / Real{256});
    const Number unit = std::ldexp(Number(1), -(N::Position::fraction_bits + 32 + scale.drift_shift));  // m
    const L::Vector v{{1 << 30, 3 << 28, -(1 << 29)}, -30};
    // 100 m in a step, beyond the range of 1/2 m: as many as the headroom holds.
    const L::Factor strong = L::factor(Scaled(100)), weak = L::factor(Scaled(Real{1} / Real{1024}));
    N::DriftSum sum[3]{};
    L::add(sum, v, strong, scale);
    L::add(sum, v, weak, scale);
    L::add(sum, v, L::negative(strong), scale);
    const N::DriftSum fall{std::int64_t{12345} << 20};
    bool within = true;
    for (int i = 0; i < 3; ++i) {
        const Number expected = value(v, i) / 1024 + Number(fall.raw) * unit;
        // A unit of the sum is 2^8 of the kick's, and each of three loads is rounded.
        EXPECT_LE(std::abs(Number(L::clamped(sum[i], fall, within).raw) * unit - expected), 3 * 0x1p8L * unit) << i;
    }
    EXPECT_TRUE(within);
    L::add(sum, v, strong, scale);
    EXPECT_EQ(L::clamped(sum[0], fall, within).raw, std::int64_t{1} << 60);
    EXPECT_FALSE(within);
    // However many there are, the sum does not wrap.
    for (int n = 0; n < 100; ++n) L::add(sum, v, L::factor(Scaled(1 << 20)), scale);
    within = true;
    EXPECT_EQ(L::clamped(sum[0], fall, within).raw, std::int64_t{1} << 60);
    EXPECT_FALSE(within);
}

template <class Numbers, class Method>
using LoadedWorld =
    World<SceneOf<Numbers, Method, Features{.bodies = 2, .springs = 2, .point_masses = true, .drag = true}>>;

// A world with a body that a spring turns, and one that feels no torque.
template <class W>
void add_bodies(W& world, Real damping = 0) {
    BodySpec spec = box(1, {1, 2, 3});
    spec.position = {5, 0, 0};
    spec.velocity = {1, 0, 0.5};
    spec.angular_velocity = {1, 2, 0.5};
    (void)world.add(spec);
    spec.position = {-3, 1, 0};
    (void)world.add(spec);
    (void)world.add(SpringSpec{.body = 0,
                               .point = {0.25, 0.5, 0.125},
                               .to = {0, 0.5, 0},
                               .stiffness = 20,
                               .damping = damping,
                               .rest_length = 1});
    (void)world.add(SpringSpec{.body = 1, .to = {0, 0.5, 0}, .stiffness = 20, .damping = damping, .rest_length = 1});
}

template <class Numbers, class Method>
void expect_that_kept_kicks_change_no_bit() {
    const RealVec3 gravity{0, -9.8125, 0};
    LoadedWorld<Numbers, Method> kept{Seconds{1, 256}, {.gravity = gravity}}, anew{Seconds{1, 256}};
    add_bodies(kept);
    add_bodies(anew);
    for (int step = 0; step < 256; ++step) {
        anew.set_gravity(gravity);  // drops what is kept
        kept.step();
        anew.step();
        if (step == 100) {
            kept.apply_impulse(BodyId{0}, {1, 2, 3}, {0, 0.5, 0});
            anew.apply_impulse(BodyId{0}, {1, 2, 3}, {0, 0.5, 0});
        }
        if (step == 150) {
            kept.set_pose(BodyId{1}, {2.0, 2.0, 1.0}, Quaternion<Real>{});
            anew.set_pose(BodyId{1}, {2.0, 2.0, 1.0}, Quaternion<Real>{});
        }
        ASSERT_EQ(kept.hash(), anew.hash()) << step;
    }
    EXPECT_TRUE(kept.status().ok());
}

TEST(kept_kicks, change_no_bit) {
    expect_that_kept_kicks_change_no_bit<N, integrators::Verlet>();
    expect_that_kept_kicks_change_no_bit<N, integrators::Suzuki4>();
    expect_that_kept_kicks_change_no_bit<F32, integrators::Verlet>();
    expect_that_kept_kicks_change_no_bit<F64, integrators::Pdmv6>();
}

// Of damped springs the kick is solved at the end of a step: but for rounding it is that of the next step's start, also
// where the program pushes the body.
template <class Numbers, class Method>
void expect_the_motion_of_kicks_made_anew(double tolerance) {
    static constexpr Features controlled{
        .bodies = 2, .springs = 2, .point_masses = true, .drag = true, .control = true};
    const RealVec3 gravity{0, -9.8125, 0};
    World<SceneOf<Numbers, Method, controlled>> kept{Seconds{1, 256}, {.gravity = gravity}}, anew{Seconds{1, 256}};
    for (auto* world : {&kept, &anew}) {
        add_bodies(*world, 3);
        world->set_force(BodyId{1}, {0.0F, 0.0F, 2.0F}, Frame::world);
    }
    for (int step = 0; step < 256; ++step) {
        for (const RealVec3& change : {RealVec3{}, gravity}) anew.set_gravity(change);  // drops what is kept
        for (auto* world : {&kept, &anew}) {
            if (step == 60) world->set_force(BodyId{1}, {}, Frame::world);
            if (step == 100) world->apply_impulse(BodyId{1}, {2.0F, 1.0F, 3.0F});
            if (step % 50 == 0) world->apply_force(BodyId{1}, {200.0F, 0.0F, 100.0F}, Frame::world);
            world->step();
        }
        for (int b = 0; b < 2; ++b)
            for (int i = 0; i < 3; ++i)
                ASSERT_NEAR(static_cast<double>(kept.position(BodyId{b})[i]),
                            static_cast<double>(anew.position(BodyId{b})[i]), tolerance)
                    << step;
    }
    EXPECT_TRUE(kept.status().ok());
}
TEST(kept_kicks, of_dampers_are_those_of_the_next_step) {
    expect_the_motion_of_kicks_made_anew<N, integrators::Verlet>(1e-7);
    expect_the_motion_of_kicks_made_anew<N, integrators::Suzuki4>(1e-7);
    expect_the_motion_of_kicks_made_anew<F32, integrators::Verlet>(2e-5);
    expect_the_motion_of_kicks_made_anew<F64, integrators::Verlet>(1e-12);
}

// v1 = v0 + (kick(x0, v0) + kick(x1, v1)) / 2, of a point mass in one step.
TEST(end_kick, of_drag_depends_on_the_velocity_at_the_end) {
    LoadedWorld<F64, integrators::Verlet> world{Seconds{1, 16}, {.linear_drag = 8}};
    BodySpec spec = point_mass(2);
    spec.velocity = {3, -1, 2};
    (void)world.add(spec);
    world.step();
    const double half = 8.0 / 2 / 16 / 2;  // h c / 2m
    const auto v = world.velocity(BodyId{0});
    const double factor = (1 - half) / (1 + half), v0[3] = {3, -1, 2}, v1[3] = {v.x, v.y, v.z};
    for (int i = 0; i < 3; ++i) EXPECT_LE(std::abs(v1[i] - v0[i] * factor), 0x1p-50) << i;
}

TEST(end_kick, of_a_damper_depends_on_the_velocity_at_the_end) {
    const double h = 1.0 / 16, k = 8, c = 4, rest = 0.5, m = 2, gravity = -9.5;
    LoadedWorld<F64, integrators::Verlet> world{Seconds{1, 16}, {.gravity = {0, -9.5, 0}}};
    BodySpec spec = point_mass(2);
    spec.position = {2, 1, 0};
    spec.velocity = {3, -1, 2};
    (void)world.add(spec);
    (void)world.add(SpringSpec{.body = 0, .to = {0, 0, 0}, .stiffness = 8, .damping = 4, .rest_length = 0.5});
    (void)world.add(SpringSpec{.body = 0, .to = {0, 5, 0}, .stiffness = 4});
    struct Plain {
        double c[3];
    };
    const auto acceleration = [&](const Plain& x, const Plain& v) {
        double square = 0, rate = 0;
        for (int i = 0; i < 3; ++i) {
            square += x.c[i] * x.c[i];
            rate += x.c[i] * v.c[i];
        }
        const double r = std::sqrt(square);
        Plain a;
        for (int i = 0; i < 3; ++i)
            a.c[i] = (-k * (r - rest) - c * rate / r) * x.c[i] / r / m + 4 * ((i == 1 ? 5 : 0) - x.c[i]) / m;
        a.c[1] += gravity;
        return a;
    };
    const Plain x0{{2, 1, 0}}, v0{{3, -1, 2}};
    world.step();
    const auto x = world.position(BodyId{0}), v = world.velocity(BodyId{0});
    const Plain x1{{x.x, x.y, x.z}}, v1{{v.x, v.y, v.z}}, a0 = acceleration(x0, v0), a1 = acceleration(x1, v1);
    // Numbers up to 10 are rounded a few times each.
    for (int i = 0; i < 3; ++i)
        EXPECT_LE(std::abs(v1.c[i] - (v0.c[i] + h * (a0.c[i] + a1.c[i]) / 2)), 10 * 16 * 0x1p-53) << i;
}

}  // namespace
}  // namespace tumble::test::load_arithmetic

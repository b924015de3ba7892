// Trees of joints: closed in every step, of order two or four, and without a trend of the energy. The oracles are
// closed forms, reduced coordinates, conserved quantities and the same mechanism built otherwise.
#include <tumble/tumble.hpp>

#include "joint_cases.hpp"
#include "snapshots.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace tumble::test::joint_trees {
namespace {

using JointKindsTested =
    Tested<testing::Types<Kind<Q32<>, integrators::Verlet>, Kind<F64, integrators::Verlet>>,
           testing::Types<Kind<Q32<FieldRange>, integrators::Verlet>, Kind<F32, integrators::Verlet>,
                          Kind<F32Plain, integrators::Verlet>, Kind<Q32<>, integrators::Strang>,
                          Kind<Q32<>, integrators::Pdmv6>, Kind<F64, integrators::Exact>>>;
// In ranges that hold the spins of links of 0.1 m that whip.
using JointKindsThatJerk =
    Tested<testing::Types<Kind<Q32<Range<1024, 128, 1024>>, integrators::Verlet>, Kind<F64, integrators::Verlet>>,
           testing::Types<Kind<Q32<Range<1024, 512, 4096>>, integrators::Verlet>, Kind<F32, integrators::Verlet>>>;

inline constexpr Features jointed{
    .bodies = 12, .springs = 2, .joints = 12, .impulses = true, .control = true, .removal = true, .snapshots = true};
#ifdef TUMBLE_EVERY_KIND
inline constexpr int long_run = 1'000'000;
#else
inline constexpr int long_run = 30'000;
#endif

using Vector = Vector3<double>;
using Rotation = Quaternion<double>;
using joint_cases::length;

[[nodiscard]] Vector plain(const RealVec3& v) { return v.as<double>(); }
[[nodiscard]] BodySpec placed(BodySpec body, const RealVec3& position, const RealQuat& orientation = {}) {
    body.position = position;
    body.orientation = orientation;
    return body;
}
// A world with joints, and what the test knows of them in double.
template <class W>
class Mechanism {
public:
    using N = typename W::Numbers;
    using World = tumble::World<SceneOf<N, typename W::Integrator, jointed>>;
    struct Tie {
        int body, other;
        Vector arm, other_arm;
        JointId id;
    };

    explicit Mechanism(Seconds step = {1, 256}, RealVec3 gravity = {0, -9.81, 0}) : world{step, {.gravity = gravity}} {}
    int add(const BodySpec& body) {
        bodies.push_back(world.add(body));
        return static_cast<int>(bodies.size()) - 1;
    }
    template <class Spec>
    JointId join(const Spec& spec) {
        const JointId id = world.add(spec);
        const auto arm = [&](int b) {
            if (b < 0) return plain(spec.anchor);
            return rotate_back(orientation(b), plain(spec.anchor) - position(b));
        };
        if (!std::is_same_v<Spec, SliderSpec>)
            ties.push_back({spec.body, spec.to_body, arm(spec.body), arm(spec.to_body), id});
        joints.push_back(id);
        return id;
    }
    void run(int steps) {
        for (int i = 0; i < steps; ++i) (void)world.step();
    }
    [[nodiscard]] Vector position(int b) const {
        return joint_cases::place(world, bodies[static_cast<std::size_t>(b)]);
    }
    // Principal axes to world.
    [[nodiscard]] Rotation orientation(int b) const {
        const auto& q = world.state(bodies[static_cast<std::size_t>(b)]).q_wb;
        return {q.w.to_real().to_double(),
                {q.x.to_real().to_double(), q.y.to_real().to_double(), q.z.to_real().to_double()}};
    }
    [[nodiscard]] Vector velocity(int b) const {
        return joint_cases::velocity(world, bodies[static_cast<std::size_t>(b)]);
    }
    // The largest distance of the two anchors of a joint.
    [[nodiscard]] double gap() const {
        double largest = 0;
        for (const Tie& tie : ties) {
            const Vector own = position(tie.body) + rotate(orientation(tie.body), tie.arm);
            const Vector other =
                tie.other < 0 ? tie.other_arm : position(tie.other) + rotate(orientation(tie.other), tie.other_arm);
            largest = std::max(largest, length(own - other));
        }
        return largest;
    }
    [[nodiscard]] double energy() const { return joint_cases::energy(world); }
    [[nodiscard]] JointReadout<double> joint(int j) const {
        return world.template joint<double>(joints[static_cast<std::size_t>(j)]);
    }

    World world;
    std::vector<BodyId> bodies;
    std::vector<Tie> ties;
    std::vector<JointId> joints;
};

template <class W>
class Joints : public testing::Test {
protected:
    using N = typename W::Numbers;
    using Mechanism = joint_trees::Mechanism<W>;
    static constexpr bool in_fixed_point = N::fixed_point;
    static constexpr bool is_single = !N::fixed_point && sizeof(typename N::Unit) == 4,
                          carries_single = is_single && N::carry;
    // Of anchors of arms of 1 m, between components.
    static constexpr double closed = N::fixed_point ? 5e-9 : is_single ? 6e-7 : 2e-12;
    static constexpr double rod = 1.01 / 12 + 0.25;  // kg m^2, of a rod of 1 kg and 1 m about its end

    // From the point below which it hangs, at an angle from hanging.
    [[nodiscard]] static BodySpec hanging(const Vector& from, double angle) {
        return placed(box(1, {0.1, 1, 0.1}), {from.x + std::sin(angle) / 2, from.y - std::cos(angle) / 2, from.z},
                      rotation_about({0, 0, 1}, angle));
    }
    [[nodiscard]] static Mechanism pendulum(double angle, Seconds step = {1, 256}) {
        Mechanism m{step};
        (void)m.add(hanging({}, angle));
        (void)m.join(HingeSpec{.body = 0});
        return m;
    }
    [[nodiscard]] static Mechanism double_pendulum(double first, double second, Seconds step = {1, 256}) {
        Mechanism m{step};
        const Vector knee{std::sin(first), -std::cos(first), 0};
        (void)m.add(hanging({}, first));
        (void)m.add(hanging(knee, second));
        (void)m.join(HingeSpec{.body = 0});
        (void)m.join(HingeSpec{.body = 1, .to_body = 0, .anchor = {knee.x, knee.y, 0}});
        return m;
    }
    // Six links and their hinges, from the base on; in other places of the world where `place` says so.
    struct Link {
        BodySpec body;
        RealVec3 anchor, axis;
    };
    [[nodiscard]] static std::vector<Link> links_of_arm() {
        const double lengths[] = {0.2, 0.4, 0.35, 0.12, 0.1, 0.08}, masses[] = {4, 3.5, 2.5, 1.2, 0.8, 0.4};
        const RealVec3 axes[] = {{0, 1, 0}, {0, 0, 1}, {0, 0, 1}, {1, 0, 0}, {0, 0, 1}, {1, 0, 0}};
        std::vector<Link> links;
        RealVec3 at{};
        for (int i = 0; i < 6; ++i) {
            const RealVec3 along = i == 0 ? RealVec3{0, 1, 0} : RealVec3{1, 0, 0};
            const RealVec3 edges = i == 0 ? RealVec3{0.08, lengths[i], 0.08} : RealVec3{lengths[i], 0.06, 0.07};
            links.push_back({placed(box(masses[i], edges), at + along * Real{lengths[i] / 2}), at, axes[i]});
            at = at + along * Real{lengths[i]};
        }
        return links;
    }
    [[nodiscard]] static Mechanism arm(Seconds step = {1, 256}) {
        Mechanism m{step};
        const auto links = links_of_arm();
        for (int i = 0; i < 6; ++i) {
            const Link& link = links[static_cast<std::size_t>(i)];
            (void)m.add(link.body);
            (void)m.join(HingeSpec{.body = i, .to_body = i - 1, .anchor = link.anchor, .axis = link.axis});
        }
        return m;
    }
    [[nodiscard]] static Mechanism chain_of_ten() {
        Mechanism m;
        const RealQuat lean = rotation_about({0, 0, 1}, 0.5);
        const RealVec3 along{std::sin(0.5), -std::cos(0.5), 0};
        for (int i = 0; i < 10; ++i) {
            const RealVec3 at = along * Real{0.1 * i};
            (void)m.add(placed(box(0.1, {0.02, 0.1, 0.03}), at + along * Real{0.05}, lean));
            (void)m.join(BallSpec{.body = i, .to_body = i - 1, .anchor = at});
        }
        return m;
    }
    // A rotor in two rings, of which a weight makes the inner one precess.
    [[nodiscard]] static Mechanism gyroscope(Seconds step) {
        Mechanism m{step};
        const auto ring = [](double mass, double x, double y, double z) {
            BodySpec body;
            body.mass = mass;
            body.inertia = {x, y, z, 0, 0, 0};
            return body;
        };
        (void)m.add(ring(0.2, 0.002, 0.001, 0.002));
        (void)m.add(placed(ring(0.15, 0.0007, 0.0007, 0.0013), {0, 0, 0.02}));
        BodySpec rotor = placed(ring(0.5, 0.0003, 0.0003, 0.0005), {0, 0, 0.02});
        rotor.angular_velocity = {0, 0, 60};
        (void)m.add(rotor);
        (void)m.join(HingeSpec{.body = 0, .axis = {0, 1, 0}});
        (void)m.join(HingeSpec{.body = 1, .to_body = 0, .axis = {1, 0, 0}});
        (void)m.join(HingeSpec{.body = 2, .to_body = 1, .anchor = {0, 0, 0.02}});
        return m;
    }
    // The time from the first to the third passage of body 0 below the origin, on cubics through the steps.
    [[nodiscard]] static double measured_period(Mechanism& m, double step) {
        std::vector<double> passages;
        double x = m.position(0).x, v = 0;
        for (int i = 0; passages.size() < 3 && i < 8 / step; ++i) {
            m.run(1);
            const double next_x = m.position(0).x, next_v = m.velocity(0).x;
            if (m.position(0).y < 0 && x * next_x <= 0 && next_x != 0) {
                const auto cubic = [&](double s) {
                    return x * (1 + 2 * s) * (1 - s) * (1 - s) + step * v * s * (1 - s) * (1 - s) +
                           next_x * s * s * (3 - 2 * s) - step * next_v * s * s * (1 - s);
                };
                double low = 0, high = 1;
                for (int k = 0; k < 50; ++k) {
                    const double middle = (low + high) / 2;
                    (cubic(middle) * cubic(low) > 0 ? low : high) = middle;
                }
                passages.push_back((i + low) * step);
            }
            x = next_x;
            v = next_v;
        }
        return passages.size() < 3 ? 0 : passages[2] - passages[0];
    }
    // Runs it and returns the largest gap.
    [[nodiscard]] static double largest_gap(Mechanism m, int steps) {
        double largest = 0;
        for (int i = 0; i < steps; ++i) {
            m.run(1);
            largest = std::max(largest, m.gap());
        }
        EXPECT_TRUE(m.world.status().ok());
        return largest;
    }
    [[nodiscard]] static double mean_corrections(Mechanism m, int steps) {
        double sum = 0;
        for (int i = 0; i < steps; ++i) {
            m.run(1);
            sum += m.joint(0).corrections;
        }
        return sum / steps;
    }
    // The mean energy over `window` steps at the end less that over as many at the beginning.
    [[nodiscard]] static double energy_moved(Mechanism m, int window, int steps) {
        m.run(1);
        const auto [first, last] = joint_cases::mean_energies(
            m.world, [&] { return m.energy(); }, window, steps - 2 * window);
        EXPECT_TRUE(m.world.status().ok());
        return last - first;
    }
    // The error at 1/256 s by Richardson's extrapolation, and how many times that at 1/512 s is smaller.
    template <class Make>
    static void expect_order(Make&& make, int steps, int body, double most_error) {
        constexpr double ratio = W::Integrator::order > 2 ? 16 : 4;
        std::vector<Vector> ends;
        for (int fine = 1; fine <= 4; fine *= 2) {
            auto m = make(Seconds{1, 256 * fine});
            m.run(steps * fine);
            ends.push_back(m.position(body));
        }
        const double coarse = length(ends[0] - ends[1]), fine = length(ends[1] - ends[2]);
        EXPECT_LT(coarse * ratio / (ratio - 1), most_error);
        constexpr bool is_default = std::is_same_v<typename W::Integrator, integrators::Verlet>;
        if (!is_single && (ratio < 5 || !in_fixed_point)) {
            EXPECT_NEAR(coarse / fine, ratio, ratio * (is_default ? 0.125 : ratio > 4 ? 0.05 : 0.375));
        }
    }
};
TYPED_TEST_SUITE(Joints, JointKindsTested);

TYPED_TEST(Joints, a_pendulum_has_the_period_of_the_arithmetic_geometric_mean) {
    const double period = joint_cases::pendulum_period(2.5, this->rod, 9.81 / 2);
    std::vector<double> errors;
    for (const int rate : {64, 256, 1024}) {
        auto m = this->pendulum(2.5, {1, rate});
        errors.push_back(std::abs(this->measured_period(m, 1.0 / rate) / period - 1));
    }
    EXPECT_LT(errors[0], 5e-4);
    EXPECT_LT(errors[1], this->is_single ? 1e-4 : 3.1e-5);
    if (this->is_single) return;
    EXPECT_LT(errors[2], 2e-6);
    EXPECT_NEAR(errors[0] / errors[1], 16, 1.6);
}

// In the angles a and b of the rods from hanging, d = a - b, with I about the ends and lengths 1 (Lagrange):
//   (I + 1) a'' + cos(d) b'' / 2 + sin(d) b'^2 / 2 + 3 g sin(a) / 2 = 0
//   I b'' + cos(d) a'' / 2 - sin(d) a'^2 / 2 + g sin(b) / 2 = 0
[[nodiscard]] Vector reference_tip(double a, double b, double inertia, double time) {
    struct State {
        double a, b, va, vb;
    } s{a, b, 0, 0};
    const auto rate = [&](const State& at) {
        const double c = std::cos(at.a - at.b) / 2, n = std::sin(at.a - at.b) / 2;
        const double first = -n * at.vb * at.vb - 1.5 * 9.81 * std::sin(at.a),
                     second = n * at.va * at.va - 9.81 / 2 * std::sin(at.b), det = (inertia + 1) * inertia - c * c;
        return State{at.va, at.vb, (first * inertia - second * c) / det, (second * (inertia + 1) - first * c) / det};
    };
    const auto moved = [](const State& at, const State& by, double h) {
        return State{at.a + h * by.a, at.b + h * by.b, at.va + h * by.va, at.vb + h * by.vb};
    };
    const int steps = 20'000;
    const double h = time / steps;
    for (int i = 0; i < steps; ++i) {
        const State k1 = rate(s), k2 = rate(moved(s, k1, h / 2)), k3 = rate(moved(s, k2, h / 2)),
                    k4 = rate(moved(s, k3, h));
        s = moved(moved(moved(moved(s, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
    }
    return {std::sin(s.a) + std::sin(s.b) / 2, -std::cos(s.a) - std::cos(s.b) / 2, 0};
}

TYPED_TEST(Joints, a_double_pendulum_moves_as_in_its_angles_with_order_two) {
    const Vector tip = reference_tip(2.0, 2.4, this->rod, 2);
    double errors[2];
    for (int i = 0; i < 2; ++i) {
        auto m = this->double_pendulum(2.0, 2.4, {1, 256 << i});
        m.run(512 << i);
        errors[i] = length(m.position(1) - tip);
    }
    EXPECT_LT(errors[0], 1.5e-3);
    EXPECT_NEAR(errors[0] / errors[1], 4, this->is_single ? 0.5 : 0.2);
}

TYPED_TEST(Joints, a_falling_arm_and_a_gyroscope_are_of_order_two) {
    this->expect_order([&](Seconds step) { return this->arm(step); }, 128, 5, 3.5e-4);
    this->expect_order([&](Seconds step) { return this->gyroscope(step); }, 512, 2, 4e-4);
}

// A method of order four flies the parts of Suzuki's composition as flights of their own.
template <class Kind>
class JointsOfOrderFour : public Joints<Kind> {};
using JointKindsOfOrderFour =
    Tested<testing::Types<Kind<Q32<>, integrators::Suzuki4>, Kind<F64, integrators::Suzuki4>>,
           testing::Types<Kind<F64Carried, integrators::Rk4>, Kind<F32, integrators::Suzuki4>>>;
TYPED_TEST_SUITE(JointsOfOrderFour, JointKindsOfOrderFour);

TYPED_TEST(JointsOfOrderFour, pendulums_move_as_in_their_angles) {
    const double floor = this->is_single ? 5e-5 : this->in_fixed_point ? 4e-5 : 0;
    const double period = joint_cases::pendulum_period(2.5, this->rod, 9.81 / 2);
    const Vector tip = reference_tip(2.0, 2.4, this->rod, 2);
    double of_period[2], of_tip[2];
    for (int i = 0; i < 2; ++i) {
        const int rate = 64 << i;
        auto one = this->pendulum(2.5, {1, rate});
        of_period[i] = std::abs(this->measured_period(one, 1.0 / rate) / period - 1);
        auto two = this->double_pendulum(2.0, 2.4, {1, rate});
        two.run(2 * rate);
        of_tip[i] = length(two.position(1) - tip);
        EXPECT_TRUE(two.world.status().ok());
    }
    EXPECT_LT(of_period[0], 1.5e-7 + floor);
    EXPECT_LT(of_tip[0], 5e-5 + floor);
    EXPECT_LT(of_tip[1], 3e-6 + floor);
    if (floor > 0) return;
    EXPECT_NEAR(of_period[0] / of_period[1], 16, 1);
    EXPECT_NEAR(of_tip[0] / of_tip[1], 16, 1);
}

TYPED_TEST(JointsOfOrderFour, a_falling_arm_and_a_gyroscope_converge) {
    const double floor = this->is_single ? 5e-5 : this->in_fixed_point ? 1e-6 : 0;
    this->expect_order([&](Seconds step) { return this->arm(step); }, 128, 5, 1e-7 + floor);
    this->expect_order([&](Seconds step) { return this->gyroscope(step); }, 512, 2, 2e-7 + floor);
}

TYPED_TEST(JointsOfOrderFour, steps_end_closed_and_show_what_joints_carry) {
    EXPECT_LT(this->largest_gap(this->double_pendulum(1, 1.5), 500), this->closed);
    EXPECT_LT(this->largest_gap(this->gyroscope({1, 256}), 256), this->closed);
    typename TestFixture::Mechanism m;
    (void)m.add(placed(box(2, {1, 0.1, 0.1}), {0.5, 0, 0}));
    (void)m.join(FixedSpec{.body = 0});
    m.run(100);
    const double bar = this->is_single ? 5e-2 : 1e-3;
    EXPECT_LT(length(m.joint(0).force - Vector{0, 2 * 9.81, 0}), bar);
    EXPECT_LT(length(m.joint(0).torque - Vector{0, 0, 9.81}), bar);
}

TYPED_TEST(JointsOfOrderFour, steps_that_are_divided_keep_the_energy) {
    auto m = this->double_pendulum(2.5, -2.5, {1, 32});
    const double energy = m.energy();
    for (int i = 0; i < 1000; ++i) {
        m.run(1);
        ASSERT_NEAR(m.energy(), energy, 5e-2) << i;
    }
    EXPECT_TRUE(m.world.status().ok());
}

TYPED_TEST(Joints, the_energy_of_a_pendulum_has_no_trend) {
    const double period = joint_cases::pendulum_period(2.5, this->rod, 9.81 / 2);
    const auto moved = [&](int rate) {
        const int window = static_cast<int>(8 * period * rate);
        return std::abs(this->energy_moved(this->pendulum(2.5, {1, rate}), window, long_run) / 9.81);
    };
    EXPECT_LT(moved(256), this->in_fixed_point || this->carries_single ? 1e-5 : this->is_single ? 3e-4 : 1e-6);
    // At 1/1024 s the guess alone is within the bound of a correction.
    if (this->carries_single) { EXPECT_LT(moved(1024), 3e-5); }
}

#ifdef TUMBLE_EVERY_KIND
// 11 hours of its motion.
TYPED_TEST(Joints, the_energy_of_a_pendulum_has_no_trend_in_1e7_steps_of_fixed_point) {
    if constexpr (std::is_same_v<TypeParam, Kind<Q32<>, integrators::Verlet>>) {
        const int window = static_cast<int>(8 * joint_cases::pendulum_period(2.5, this->rod, 9.81 / 2) * 256);
        EXPECT_LT(std::abs(this->energy_moved(this->pendulum(2.5), window, 10'000'000) / 9.81), 3e-5);
    }
}
#endif

TYPED_TEST(Joints, the_energy_of_a_spherical_pendulum_has_no_trend) {
    typename TestFixture::Mechanism m;
    BodySpec body =
        placed(box(1, {0.1, 1, 0.2}), {std::sin(1.0) / 2, -std::cos(1.0) / 2, 0}, rotation_about({0, 0, 1}, 1.0));
    // v = w x r with w along the rod's normal in its plane: in the body's axes about x.
    body.velocity = {0, 0, 1};
    body.angular_velocity = {-2, 0, 0};
    (void)m.add(body);
    (void)m.join(BallSpec{.body = 0});
    const double moved = this->energy_moved(m, 4000, long_run) / 9.81;
    // Float with carry gains 3e-4 in 10^6 steps where a guess counts as closed up to the bound of a correction.
    EXPECT_LT(std::abs(moved), this->carries_single   ? 4e-6
                               : this->is_single      ? 5e-4
                               : this->in_fixed_point ? 3e-6
                                                      : 1e-6);
}

TYPED_TEST(Joints, every_step_ends_closed) {
    EXPECT_LT(this->largest_gap(this->pendulum(2.5), 2000), this->closed);
    EXPECT_LT(this->largest_gap(this->double_pendulum(1, 1.5), 2000), this->closed);
    EXPECT_LT(this->largest_gap(this->chain_of_ten(), 1000), this->closed);
    EXPECT_LT(this->largest_gap(this->arm(), 256), this->closed);
    EXPECT_LT(this->largest_gap(this->gyroscope({1, 256}), 512), this->closed);
}

TYPED_TEST(Joints, a_step_takes_few_corrections) {
    const double few = this->in_fixed_point || this->is_single ? 1.1 : 2;
    EXPECT_LT(this->mean_corrections(this->pendulum(2.5), 1000), few);
    EXPECT_LT(this->mean_corrections(this->double_pendulum(1, 1.5), 1000), few);
    EXPECT_LT(this->mean_corrections(this->chain_of_ten(), 500), few);
    EXPECT_LT(this->mean_corrections(this->arm(), 256), this->in_fixed_point ? 2 : 3);
    EXPECT_LT(this->mean_corrections(this->gyroscope({1, 256}), 256), this->in_fixed_point ? 3.1 : 4.1);
}

// The arm with its bodies in this order, and the joints added the other way round, named from either side. In flight
// its links spin when it begins.
TYPED_TEST(Joints, the_order_of_the_bodies_of_an_arm_changes_no_bit) {
    using Mechanism = typename TestFixture::Mechanism;
    const auto links = this->links_of_arm();
    for (const bool flies : {false, true}) {
        const auto arm_of = [&](const std::vector<int>& order, bool swapped, std::vector<std::size_t>& place) {
            Mechanism m;
            place.resize(6);
            for (std::size_t k = 0; k < 6; ++k) {
                const auto link = static_cast<std::size_t>(order[k]);
                BodySpec body = links[link].body;
                if (flies) body.angular_velocity = {1.5, 0.5 * order[k], -1};
                (void)m.add(body);
                place[link] = k;
            }
            for (std::size_t i = 6; i-- > (flies ? 1 : 0);) {
                HingeSpec hinge{.body = static_cast<int>(place[i]), .anchor = links[i].anchor, .axis = links[i].axis};
                if (i > 0) hinge.to_body = static_cast<int>(place[i - 1]);
                if (i > 0 && swapped) hinge = {hinge.to_body, hinge.body, hinge.anchor, hinge.axis};
                EXPECT_TRUE(m.join(hinge));
            }
            m.run(64);
            return m;
        };
        std::vector<std::size_t> own, place;
        const auto straight = arm_of({0, 1, 2, 3, 4, 5}, false, own);
        for (const std::vector<int>& order : {std::vector{5, 4, 3, 2, 1, 0}, std::vector{2, 0, 5, 1, 4, 3}})
            for (const bool swapped : {false, true}) {
                const auto m = arm_of(order, swapped, place);
                for (std::size_t i = 0; i < 6; ++i)
                    EXPECT_TRUE(m.world.state(m.bodies[place[i]]) == straight.world.state(straight.bodies[i]))
                        << flies << ' ' << i;
            }
    }
}

TYPED_TEST(Joints, the_order_in_which_joints_are_added_changes_no_bit) {
    auto straight = this->arm();
    typename TestFixture::Mechanism m;
    const auto links = this->links_of_arm();
    for (const auto& link : links) (void)m.add(link.body);
    for (const int i : {3, 0, 5, 2, 4, 1}) {
        const auto& link = links[static_cast<std::size_t>(i)];
        (void)m.join(HingeSpec{.body = i, .to_body = i - 1, .anchor = link.anchor, .axis = link.axis});
    }
    for (int i = 0; i < 64; ++i) {
        straight.run(1);
        m.run(1);
        ASSERT_EQ(straight.world.hash(), m.world.hash()) << i;
    }
}

TYPED_TEST(Joints, trees_do_not_know_of_each_other) {
    auto alone = this->double_pendulum(1, 1.5), beside = this->double_pendulum(1, 1.5);
    (void)beside.add(this->hanging({5, 0, 0}, 0.7));
    (void)beside.add(placed(sphere(1, 0.1), {0, 9, 0}));
    alone.run(10);
    beside.run(10);
    (void)beside.join(HingeSpec{.body = 2, .anchor = {5, 0, 0}});
    for (int i = 0; i < 100; ++i) {
        alone.run(1);
        beside.run(1);
        for (int b = 0; b < 2; ++b)
            ASSERT_TRUE(alone.world.state(alone.bodies[static_cast<std::size_t>(b)]) ==
                        beside.world.state(beside.bodies[static_cast<std::size_t>(b)]));
    }
}

TYPED_TEST(Joints, a_scene_that_is_turned_in_space_moves_alike) {
    auto plain_arm = this->arm();
    plain_arm.run(64);
    // A third of a turn about the diagonal takes x to y, y to z and z to x.
    const RealQuat third = rotation_about({1, 1, 1}, 2 * std::numbers::pi / 3);
    const auto turned = [](const RealVec3& v) { return RealVec3{v.z, v.x, v.y}; };
    typename TestFixture::Mechanism m{{1, 256}, {0, 0, -9.81}};
    const auto links = this->links_of_arm();
    for (int i = 0; i < 6; ++i) {
        const auto& link = links[static_cast<std::size_t>(i)];
        (void)m.add(placed(link.body, turned(link.body.position), third));
        (void)m.join(HingeSpec{.body = i, .to_body = i - 1, .anchor = turned(link.anchor), .axis = turned(link.axis)});
    }
    m.run(64);
    for (int i = 0; i < 6; ++i) {
        const Vector x = plain_arm.position(i);
        EXPECT_LT(length(m.position(i) - Vector{x.z, x.x, x.y}), this->is_single        ? 2e-5
                                                                 : this->in_fixed_point ? 5e-8
                                                                                        : 1e-11);
    }
}

TYPED_TEST(Joints, two_free_bodies_on_a_hinge_keep_their_momenta_and_energy) {
    typename TestFixture::Mechanism m{{1, 256}, {}};
    BodySpec a = placed(box(1, {0.1, 1, 0.1}), {0, 0.5, 0}), b = placed(box(2, {0.2, 0.8, 0.1}), {0, -0.4, 0});
    a.angular_velocity = {0, 0, 3};
    a.velocity = {-1.5, 0.3, 0.1};
    b.angular_velocity = {0, 0, -2};
    b.velocity = {-0.8, 0.3, 0.1};
    (void)m.add(a);
    (void)m.add(b);
    (void)m.join(HingeSpec{.body = 1, .to_body = 0});
    m.run(1);
    const auto before = joint_cases::momenta(m.world);
    const double energy = m.energy();
    m.run(2000);
    const double bar = this->is_single ? 1e-4 : this->in_fixed_point ? 2e-6 : 1e-11;
    const auto after = joint_cases::momenta(m.world);
    EXPECT_LT(length(after[0] - before[0]), bar);
    EXPECT_LT(length(after[1] - before[1]), 20 * bar);  // about the origin, from which it flies away
    EXPECT_NEAR(m.energy() / energy, 1, 1e-4);
    EXPECT_TRUE(m.world.status().ok());
}

TYPED_TEST(Joints, a_cart_on_a_rail_and_its_pendulum_keep_momentum_along_the_rail) {
    typename TestFixture::Mechanism m;
    (void)m.add(box(1, {0.2, 0.2, 0.3}));
    (void)m.add(this->hanging({}, 1));
    (void)m.join(SliderSpec{.body = 0});
    (void)m.join(HingeSpec{.body = 1, .to_body = 0});
    const double energy = m.energy();
    m.run(1000);
    const double centre = (m.position(0).x + m.position(1).x) / 2;
    EXPECT_NEAR(centre, std::sin(1.0) / 4, this->is_single ? 1e-3 : 1e-6);
    EXPECT_NEAR(m.position(0).y, 0, 1e-6);
    EXPECT_NEAR(m.joint(0).travel, m.position(0).x, 1e-6);
    EXPECT_NEAR(m.joint(0).speed, m.velocity(0).x, 1e-5);
    EXPECT_NEAR(m.energy(), energy, 5e-3);
}

TYPED_TEST(Joints, bodies_on_a_fixed_joint_swing_as_one) {
    typename TestFixture::Mechanism m;
    const Vector half{std::sin(2.5) / 2, -std::cos(2.5) / 2, 0};
    for (const double at : {0.25, 0.75})
        (void)m.add(placed(box(0.5, {0.1, 0.5, 0.1}), {std::sin(2.5) * at, -std::cos(2.5) * at, 0},
                           rotation_about({0, 0, 1}, 2.5)));
    (void)m.join(HingeSpec{.body = 0});
    (void)m.join(FixedSpec{.body = 1, .to_body = 0, .anchor = {half.x, half.y, 0}});
    const double period = joint_cases::pendulum_period(2.5, this->rod, 9.81 / 2);
    EXPECT_NEAR(this->measured_period(m, 1.0 / 256) / period, 1, this->is_single ? 1e-4 : 4e-5);
}

TYPED_TEST(Joints, a_universal_joint_shows_both_angles_and_carries_the_rest) {
    typename TestFixture::Mechanism m;
    BodySpec body = placed(box(1, {0.3, 0.6, 0.1}), {0, -0.5, 0});
    body.angular_velocity = {1, 0, 0.8};
    body.velocity = {0.4, 0, -0.5};
    (void)m.add(body);
    (void)m.join(UniversalSpec{.body = 0, .axis = {0, 0, 1}, .to_axis = {1, 0, 0}});
    const double energy = m.energy();
    double angle = 0, to_angle = 0;
    for (int i = 0; i < 200; ++i) {
        m.run(1);
        const auto joint = m.joint(0);
        EXPECT_NEAR((joint.angle - angle) * 256, joint.speed, 0.1);
        EXPECT_NEAR((joint.to_angle - to_angle) * 256, joint.to_speed, 0.1);
        angle = joint.angle;
        to_angle = joint.to_angle;
        // The body's axis is perpendicular to the world's.
        const Rotation q = m.world.orientation(m.bodies[0]).template as<double>();
        EXPECT_NEAR(rotate(q, {0, 0, 1}).x, 0, this->is_single ? 1e-6 : 1e-8);
    }
    EXPECT_NEAR(m.energy(), energy, 2e-3);
    EXPECT_LT(m.gap(), this->closed);
}

TYPED_TEST(Joints, a_body_that_hangs_at_rest_is_carried_by_its_joint) {
    typename TestFixture::Mechanism m;
    (void)m.add(placed(box(2, {1, 0.1, 0.1}), {0.5, 0, 0}));
    (void)m.join(FixedSpec{.body = 0});
    m.run(100);
    const auto joint = m.joint(0);
    const double bar = this->is_single ? 2e-2 : 1e-4;
    EXPECT_LT(length(joint.force - Vector{0, 2 * 9.81, 0}), bar);
    EXPECT_LT(length(joint.torque - Vector{0, 0, 9.81}), bar);
    EXPECT_LT(length(m.position(0) - Vector{0.5, 0, 0}), 1e-6);
}

TYPED_TEST(Joints, a_spring_on_a_slider_is_an_oscillator_and_ties_two_trees) {
    typename TestFixture::Mechanism m{{1, 256}, {}};
    (void)m.add(placed(box(1, {0.2, 0.2, 0.3}), {-0.9, 0, 0}));
    (void)m.add(placed(box(1, {0.2, 0.3, 0.2}), {1.1, 0, 0}));
    (void)m.join(SliderSpec{.body = 0, .anchor = {-0.9, 0, 0}});
    (void)m.join(SliderSpec{.body = 1, .anchor = {1.1, 0, 0}});
    (void)m.world.add(SpringSpec{.body = 0, .to_body = 1, .stiffness = 50, .rest_length = 1.8});
    // x1 - x0 = 1.8 + 0.2 cos(10 t)
    m.run(200);
    EXPECT_NEAR(m.position(1).x - m.position(0).x, 1.8 + 0.2 * std::cos(10 * 200 / 256.0), 3e-4);
    EXPECT_NEAR(m.position(1).x + m.position(0).x, 0.2, 1e-5);
}

TYPED_TEST(Joints, a_blow_on_a_link_moves_the_whole_tree) {
    auto m = this->pendulum(0);
    m.world.apply_impulse(m.bodies[0], {1, 0, 0}, {0, -0.5, 0});
    const double energy = m.energy();
    m.run(1);
    // The angular impulse about the axis over the moment about it.
    EXPECT_NEAR(m.joint(0).speed, 1 / this->rod, 2e-3);
    EXPECT_LT(m.energy(), energy);
    EXPECT_LT(m.gap(), this->closed);

    auto pair = this->double_pendulum(0, 0);
    pair.world.apply_impulse(pair.bodies[1], {1, 0, 0}, {0, -0.5, 0});
    pair.run(1);
    // (I + 1) w1 + w2 / 2 = 1 and w1 / 2 + I w2 = 1
    const double rod = this->rod, det = (rod + 1) * rod - 0.25;
    EXPECT_NEAR(pair.joint(0).speed, (rod - 0.5) / det, 1e-2);
    EXPECT_NEAR(pair.joint(0).speed + pair.joint(1).speed, (rod + 0.5) / det, 1e-2);
}

TYPED_TEST(Joints, a_mechanism_whose_poses_are_set_goes_on_from_them) {
    auto set = this->double_pendulum(0.3, 0.2), made = this->double_pendulum(1, 1.5);
    set.run(20);
    for (int b = 0; b < 2; ++b) {
        const BodyId id = set.bodies[static_cast<std::size_t>(b)];
        const Vector x = made.position(b);
        set.world.set_pose(id, {Real{x.x}, Real{x.y}, Real{x.z}}, rotation_about({0, 0, 1}, b == 0 ? 1.0 : 1.5));
        set.world.set_velocity(id, {0, 0, 0});
        set.world.set_angular_velocity(id, {0, 0, 0});
    }
    set.run(100);
    made.run(100);
    EXPECT_LT(length(set.position(1) - made.position(1)), this->is_single ? 1e-4 : 1e-6);
    EXPECT_TRUE(set.world.status().ok());

    // A body that is set beside its anchor comes back to it, without a velocity.
    auto open = this->pendulum(0);
    open.world.set_pose(open.bodies[0], {0.2, -0.4, 0.1});
    open.run(1);
    EXPECT_LT(open.gap(), this->closed);
    EXPECT_LT(length(open.velocity(0)), 0.05);
    EXPECT_TRUE(open.world.status().ok());
}

TYPED_TEST(Joints, what_is_removed_holds_nothing) {
    auto m = this->double_pendulum(1, 1.5);
    m.run(50);
    const JointId knee = m.joints[1];
    m.world.remove(knee);
    EXPECT_FALSE(m.world.contains(knee));
    EXPECT_EQ(m.world.joint_count(), 1);
    const Vector x = m.position(1), v = m.velocity(1);
    m.run(64);
    EXPECT_LT(length(m.position(1) - (x + v * 0.25 - Vector{0, 9.81 / 32, 0})), this->is_single ? 1e-5 : 1e-6);

    const JointId again = m.world.add(BallSpec{.body = 1, .anchor = {0, 0, 0}});
    EXPECT_TRUE(again);
    EXPECT_EQ(again.index(), knee.index());
    EXPECT_FALSE(m.world.contains(knee));
    m.world.remove(m.bodies[0]);
    EXPECT_FALSE(m.world.contains(m.joints[0]));
    EXPECT_TRUE(m.world.contains(again));
    m.world.remove(m.bodies[1]);
    EXPECT_EQ(m.world.joint_count(), 0);
    (void)m.world.step();
    EXPECT_TRUE(m.world.status().ok());
}

TYPED_TEST(Joints, a_world_goes_on_from_its_snapshot_with_the_same_bits) {
    auto m = this->arm(), other = this->arm();
    m.run(40);
    m.world.apply_impulse(m.bodies[3], {0.1, 0.2, 0}, {});
    const auto bytes = save(m.world);
    ASSERT_EQ(restore(other.world, bytes), SnapshotFault::none);
    for (int i = 0; i < 40; ++i) {
        m.run(1);
        other.run(1);
        ASSERT_EQ(m.world.hash(), other.world.hash()) << i;
    }
    auto another = this->double_pendulum(1, 1.5);
    EXPECT_EQ(restore(another.world, bytes), SnapshotFault::other_scene);
}

// A slider that has gone far has other powers of two than when it was added. They follow from the poses.
TYPED_TEST(Joints, a_world_goes_back_to_an_older_moment_with_a_pose_that_was_set) {
    for (const double travel : {0.7, 3.0, 20.0, 100.0}) {
        const auto made = [] {
            typename TestFixture::Mechanism m{{1, 256}, {}};
            for (int i = 0; i < 3; ++i) (void)m.add(placed(box(1, {0.2, 0.2, 0.2}), {0.3 * i, 0, 0}));
            (void)m.join(SliderSpec{.body = 1, .to_body = 0, .anchor = {0.3, 0, 0}});
            (void)m.join(HingeSpec{.body = 2, .to_body = 1, .anchor = {0.45, 0, 0}});
            return m;
        };
        auto m = made(), other = made();
        m.run(3);
        m.world.set_pose(m.bodies[1], {Real{travel}, Real{0.02}, 0}, rotation_about({0, 0, 1}, 0.01));
        m.world.set_pose(m.bodies[2], {Real{travel + 0.3}, 0, 0});
        const auto bytes = save(m.world);
        m.run(31);
        ASSERT_EQ(restore(m.world, bytes), SnapshotFault::none);
        ASSERT_EQ(restore(other.world, bytes), SnapshotFault::none);
        m.run(31);
        other.run(31);
        EXPECT_EQ(m.world.hash(), other.world.hash()) << travel;
    }
}

TYPED_TEST(Joints, each_fault_of_a_joint_is_named) {
    auto m = this->double_pendulum(1, 1.5);
    const int still = m.add(fixed(placed(box(1, {1, 1, 1}), {3, 0, 0})));
    const int gone = m.add(sphere(1, 0.1));
    m.world.remove(m.bodies[static_cast<std::size_t>(gone)]);
    const auto& world = m.world;
    EXPECT_EQ(world.fault_of(BallSpec{.body = 7}), JointFault::no_such_body);
    EXPECT_EQ(world.fault_of(BallSpec{.body = gone}), JointFault::no_such_body);
    EXPECT_EQ(world.fault_of(BallSpec{.body = 0, .to_body = gone}), JointFault::no_such_body);
    EXPECT_EQ(world.fault_of(BallSpec{.body = 0, .to_body = -2}), JointFault::no_such_body);
    EXPECT_EQ(world.fault_of(BallSpec{.body = 1, .to_body = 1}), JointFault::same_body);
    EXPECT_EQ(world.fault_of(BallSpec{.body = still}), JointFault::no_moving_body);
    EXPECT_EQ(world.fault_of(HingeSpec{.body = 1, .to_body = 0, .axis = {}}), JointFault::zero_axis);
    EXPECT_EQ(world.fault_of(SliderSpec{.body = 1, .to_body = 0, .axis = {}}), JointFault::zero_axis);
    EXPECT_EQ(world.fault_of(UniversalSpec{.body = 1, .to_body = 0, .to_axis = {}}), JointFault::zero_axis);
    EXPECT_EQ(world.fault_of(UniversalSpec{.body = 1, .to_body = 0, .to_axis = {1, 1, 0}}),
              JointFault::axes_not_perpendicular);
    // The same two bodies again, and the last one to the world or to a fixed body.
    EXPECT_EQ(world.fault_of(BallSpec{.body = 0, .to_body = 1}), JointFault::closes_loop);
    EXPECT_EQ(world.fault_of(BallSpec{.body = 1}), JointFault::closes_loop);
    EXPECT_EQ(world.fault_of(BallSpec{.body = 1, .to_body = still}), JointFault::closes_loop);
    for (const JointFault fault : {JointFault::none, JointFault::no_such_body, JointFault::same_body,
                                   JointFault::no_moving_body, JointFault::point_mass, JointFault::zero_axis,
                                   JointFault::axes_not_perpendicular, JointFault::closes_loop, JointFault::no_room})
        EXPECT_NE(name_of(fault), nullptr);
    EXPECT_EQ(world.joint_count(), 2);
    EXPECT_TRUE(world.status().ok());
    EXPECT_FALSE(m.world.add(BallSpec{.body = 1}));
    EXPECT_TRUE(world.status().has(Issue::world_full));
#ifndef __SANITIZE_ADDRESS__
    EXPECT_DEATH((void)m.world.add(BallSpec{.body = 1, .to_body = 1}), "");
    EXPECT_DEATH((void)m.world.add(HingeSpec{.body = 0, .anchor = {std::nan(""), 0, 0}}), "");
    EXPECT_DEATH((void)m.world.template joint<double>(JointId{5}), "");
#endif
}

// The arm with its bodies and joints where they are in m: a world that is set up anew. `joined`: has the joint to link
// i.
template <class Mechanism>
[[nodiscard]] Mechanism set_up_anew(const Mechanism& m, Seconds step, const auto& links, const auto& joined) {
    Mechanism anew{step};
    for (int i = 0; i < 6; ++i) {
        const BodyId id = m.bodies[static_cast<std::size_t>(i)];
        const auto vector = [](const Vector& v) { return RealVec3{v.x, v.y, v.z}; };
        const auto turned = m.world.orientation(id).template as<double>();
        BodySpec body = links[static_cast<std::size_t>(i)].body;
        body.position = vector(m.position(i));
        body.orientation = RealQuat{turned.w, vector(turned.v)};
        body.velocity = vector(m.velocity(i));
        body.angular_velocity = vector(m.world.angular_velocity(id).template as<double>());
        (void)anew.add(body);
    }
    for (int i = 0; i < 6; ++i) {
        if (!joined(i)) continue;
        const auto& link = links[static_cast<std::size_t>(i)];
        const Rotation q = m.world.orientation(m.bodies[static_cast<std::size_t>(i)]).template as<double>();
        const Vector at = m.position(i) + rotate(q, plain(link.anchor) - plain(link.body.position)),
                     axis = rotate(q, plain(link.axis));
        (void)anew.join(
            HingeSpec{.body = i, .to_body = i - 1, .anchor = {at.x, at.y, at.z}, .axis = {axis.x, axis.y, axis.z}});
    }
    return anew;
}

// After add(), remove() and set_pose() in the midst of a motion. A joint that is added leaves the loads of the others.
TYPED_TEST(Joints, a_changed_mechanism_moves_as_one_that_is_set_up_anew) {
    const auto links = this->links_of_arm();
    const double bar = this->is_single ? 2e-3 : this->in_fixed_point ? 2e-5 : 1e-10;
    for (const int rate : {100, 256})
        for (const int other : {2, 4, 5})
            for (const auto& [removes, adds, poses] :
                 {std::array{true, false, false}, std::array{true, true, false}, std::array{false, false, true}}) {
                auto m = this->arm({1, rate});
                m.run(rate / 5);
                bool is_there = true;
                if (removes) m.world.remove(m.joints[static_cast<std::size_t>(other)]);
                is_there = !removes;
                if (adds) {
                    // It has opened in a step without it, and the new one holds both where they are.
                    m.run(1);
                    const Vector before = m.joint(0).force;
                    const Vector at = m.position(other);
                    (void)m.world.add(BallSpec{.body = m.bodies[static_cast<std::size_t>(other)],
                                               .to_body = m.bodies[static_cast<std::size_t>(other - 1)],
                                               .anchor = {at.x, at.y, at.z}});
                    EXPECT_LT(length(m.joint(0).force - before), 1e-5 * length(before));
                    EXPECT_GT(length(before), 1);
                }
                if (poses)
                    for (const auto& link : links)
                        m.world.set_pose(m.bodies[static_cast<std::size_t>(&link - links.data())], link.body.position,
                                         link.body.orientation);
                auto anew = set_up_anew(m, {1, rate}, links, [&](int i) { return is_there || i != other; });
                if (adds) {
                    const Vector at = m.position(other);
                    (void)anew.world.add(BallSpec{.body = other, .to_body = other - 1, .anchor = {at.x, at.y, at.z}});
                }
                m.run(rate / 4);
                anew.run(rate / 4);
                EXPECT_TRUE(m.world.status().ok());
                EXPECT_LT(anew.gap(), 2 * this->closed);
                for (int i = 0; i < 6; ++i)
                    EXPECT_LT(length(m.position(i) - anew.position(i)), bar) << rate << " " << other << " " << adds;
            }
}

// A mechanism 4^k times as small moves 2^k times as fast. Its hinges are at the ends of the links and near their
// middles.
TYPED_TEST(Joints, small_mechanisms_move_as_large_ones) {
    using Mechanism = typename TestFixture::Mechanism;
    const double bar = this->is_single ? 3e-4 : this->in_fixed_point ? 2e-6 : 1e-10;
    for (const double arm : {0.5, 0.02, 0.0}) {
        const auto moved = [&](int k) {
            const double size = std::ldexp(1.0, -2 * k);
            Mechanism m{{1, 256 << k}};
            for (int i = 0; i < 3; ++i) {
                (void)m.add(placed(box(0.1, {size, size / 4, size / 5}), {size * (arm + i), 0, 0}));
                const RealVec3 anchor{size * i, 0, 0};
                if (i == 1) (void)m.join(BallSpec{.body = i, .to_body = i - 1, .anchor = anchor});
                else (void)m.join(HingeSpec{.body = i, .to_body = i - 1, .anchor = anchor});
            }
            EXPECT_LT(TestFixture::largest_gap(m, 100), 2 * this->closed) << k;
            m.run(100);
            return std::array{m.position(0) * (1 / size), m.position(1) * (1 / size), m.position(2) * (1 / size)};
        };
        const auto large = moved(0);
        for (const int k : {1, 2, 3, 4}) {
            const auto small = moved(k);
            for (const std::size_t i : {0u, 1u, 2u})
                EXPECT_LT(length(small[i] - large[i]), bar) << arm << " " << k << " " << i;
        }
    }
}

// Its gaps are those of a closed one.
TYPED_TEST(Joints, a_body_that_is_posed_turned_over_is_told) {
    const auto status_of = [](const auto& spec, const RealQuat& orientation) {
        typename TestFixture::Mechanism m{{1, 256}, {}};
        (void)m.add(box(1, {0.2, 1, 0.3}));
        (void)m.join(spec);
        m.run(1);
        m.world.set_pose(m.bodies[0], {}, orientation);
        m.run(2);
        return m.world.status();
    };
    for (const RealQuat& over : {RealQuat{0, {1, 0, 0}}, RealQuat{0, {0, 1, 0}}}) {
        EXPECT_TRUE(status_of(HingeSpec{}, over).has(Issue::joint_open));
        EXPECT_TRUE(status_of(SliderSpec{}, over).has(Issue::joint_open));
        EXPECT_TRUE(status_of(FixedSpec{}, over).has(Issue::joint_open));
        EXPECT_TRUE(status_of(BallSpec{}, over).ok());
    }
    EXPECT_TRUE(status_of(FixedSpec{}, {0, {0, 0, 1}}).has(Issue::joint_open));
    EXPECT_TRUE(status_of(HingeSpec{}, {0, {0, 0, 1}}).ok());
}

// Arms are within what fixed point holds of them.
TEST(JointArms, are_at_most_4096_m_in_fixed_point) {
    World<SceneOf<Q32<FieldRange>, integrators::Verlet, Features{.bodies = 2, .joints = 2}>> world{Seconds{1, 256}};
    (void)world.add(placed(box(1, {1, 1, 1}), {12000, 0, 0}));
    (void)world.add(placed(box(1, {1, 1, 1}), {12001, 0, 0}));
    EXPECT_EQ(world.fault_of(HingeSpec{.body = 0}), JointFault::too_far);
    EXPECT_EQ(world.fault_of(BallSpec{.body = 0, .to_body = 1, .anchor = {16097, 0, 0}}), JointFault::too_far);
    EXPECT_TRUE(world.add(HingeSpec{.body = 0, .anchor = {8000, 0, 0}}));
    EXPECT_TRUE(world.add(BallSpec{.body = 0, .to_body = 1, .anchor = {16000, 0, 0}}));
    for (int step = 0; step < 16; ++step) (void)world.step();
    EXPECT_TRUE(world.status().ok());
}

TYPED_TEST(Joints, a_joint_without_room_is_refused) {
    World<SceneOf<typename TestFixture::N, integrators::Verlet, Features{.bodies = 3, .joints = 1}>> world{
        Seconds{1, 256}};
    for (int b = 0; b < 3; ++b) (void)world.add(placed(sphere(1, 0.1), {Real{b}, 0, 0}));
    EXPECT_TRUE(world.add(BallSpec{.body = 0, .to_body = 1}));
    EXPECT_EQ(world.fault_of(BallSpec{.body = 2}), JointFault::no_room);
    EXPECT_FALSE(world.add(BallSpec{.body = 2}));
    EXPECT_TRUE(world.status().has(Issue::world_full));
}

// The world's side may be a fixed body, which the program sets elsewhere.
TYPED_TEST(Joints, a_fixed_body_carries_its_tree_along_when_it_is_set) {
    auto on_world = this->pendulum(1);
    typename TestFixture::Mechanism m;
    (void)m.add(this->hanging({}, 1));
    const int base = m.add(fixed(placed(box(1, {1, 1, 1}), {0, 0.5, 0}, rotation_about({0, 1, 0}, 0.3))));
    (void)m.join(HingeSpec{.body = 0, .to_body = base});
    on_world.run(100);
    m.run(100);
    EXPECT_LT(length(on_world.position(0) - m.position(0)), this->is_single ? 1e-5 : 1e-7);
    m.world.set_pose(m.bodies[static_cast<std::size_t>(base)], {0.125, 0.5, 0}, rotation_about({0, 1, 0}, 0.3));
    m.run(1);
    EXPECT_LT(m.gap(), 2 * this->closed);
    EXPECT_TRUE(m.world.status().ok());
}

// Ten links of 0.1 kg and a weight at the end, if any, let go from the horizontal.
template <class Mechanism>
[[nodiscard]] Mechanism weight_on_links(double weight, Seconds step) {
    Mechanism m{step};
    for (int i = 0; i < 10; ++i) {
        (void)m.add(placed(box(0.1, {0.1, 0.02, 0.02}), {0.1 * i + 0.05, 0, 0}));
        (void)m.join(BallSpec{.body = i, .to_body = i - 1, .anchor = {0.1 * i, 0, 0}});
    }
    if (weight == 0) return m;
    (void)m.add(placed(sphere(weight, 0.1), {1.1, 0, 0}));
    (void)m.join(BallSpec{.body = 10, .to_body = 9, .anchor = {1, 0, 0}});
    return m;
}

// A link under the force of 100 kg swings faster than 1/256 s follows: such steps are divided, and projected at last.
TYPED_TEST(Joints, a_step_that_is_too_long_gains_no_energy_and_is_reported) {
    for (const double weight : {10.0, 100.0}) {
        auto m = weight_on_links<typename TestFixture::Mechanism>(weight, {1, 256});
        const double energy = m.energy(), scale = weight * 9.81 * 1.1;
        double most = energy;
        for (int i = 0; i < 1000; ++i) {
            m.run(1);
            most = std::max(most, m.energy());
        }
        EXPECT_LT((most - energy) / scale, 0.01) << weight;
        if (weight > 50) { EXPECT_TRUE(m.world.status().has(Issue::step_too_long)); }
    }
}

template <class Kind>
class JointsThatJerk : public Joints<Kind> {};
TYPED_TEST_SUITE(JointsThatJerk, JointKindsThatJerk);

// Parts are asked for at both ends of a part, so that jerks take no energy: -0.50 in place of -0.01 for a weight of
// 10 kg where the beginning alone asks, and half kicks that are held in a whole step.
TYPED_TEST(JointsThatJerk, keep_their_energy_in_divided_steps) {
    const auto swings = [](auto m, double scale, int steps) {
        const double energy = m.energy();
        for (int i = 0; i < steps; ++i) {
            m.run(1);
            ASSERT_LT((m.energy() - energy) / scale, 0.01) << i;
            ASSERT_GT((m.energy() - energy) / scale, -0.05) << i;
        }
        EXPECT_LT(m.gap(), 8 * TestFixture::closed);  // of spins in 32 parts
        EXPECT_FALSE(m.world.status().has(Issue::step_bound_hit));
        EXPECT_FALSE(m.world.status().has(Issue::range_left));
    };
    using Mechanism = typename TestFixture::Mechanism;
    swings(weight_on_links<Mechanism>(10, {1, 256}), 10 * 9.81 * 1.1, 3000);
    swings(weight_on_links<Mechanism>(0, {1, 256}), 1 * 9.81 * 0.5, 3000);
    swings(this->arm(), 20, 5000);
}

// In fixed point axes and arms of any direction are rounded, which leaves nothing open.
TYPED_TEST(Joints, boxes_in_any_pose_hang_still_on_a_fixed_joint_and_slide_on_a_slider) {
    std::mt19937_64 random{11};
    const auto uniform = [&](double a, double b) {
        return a + (b - a) * static_cast<double>(random() >> 11) * 0x1p-53;
    };
    const auto vector = [&](double most) {
        const double x = uniform(-most, most), y = uniform(-most, most), z = uniform(-most, most);
        return RealVec3{x, y, z};
    };
    for (int i = 0; i < 32; ++i) {
        typename TestFixture::Mechanism m;
        const double mass = uniform(0.5, 2), width = uniform(0.2, 1), height = uniform(0.1, 0.5);
        const RealVec3 at = vector(0.8), turn = vector(1), anchor = vector(0.4), axis = vector(1);
        (void)m.add(placed(box(mass, {width, height, 0.3}), at, normalized(RealQuat{1, turn})));
        if (i % 2 == 0) (void)m.join(FixedSpec{.body = 0, .anchor = anchor});
        else (void)m.join(SliderSpec{.body = 0, .anchor = anchor, .axis = axis});
        for (int step = 0; step < 128; ++step) {
            m.run(1);
            const Vector force = m.joint(0).force;
            if (i % 2 == 0) {
                EXPECT_LT(joint_trees::length(force - Vector{0, 9.81 * mass, 0}), (this->is_single ? 0.1 : 0.01) * mass)
                    << i;
            }
        }
        if (!this->is_single) { EXPECT_TRUE(m.world.status().ok()) << i; }
    }
}

// A rod that spins about its end pulls with m w^2 l / 2, in a step of one part and in one of many.
TYPED_TEST(JointsThatJerk, forces_of_divided_steps_are_those_of_the_motion) {
    for (const double spin : {30.0, 50.0, 100.0, 200.0}) {
        for (const double side : {1.0, -1.0}) {
            typename TestFixture::Mechanism m;
            BodySpec rod = placed(box(1, {1, 0.125, 0.125}), {0.5 * side, 0, 0});
            rod.angular_velocity = {0, 0, spin};
            rod.velocity = {0, 0.5 * side * spin, 0};
            (void)m.add(rod);
            m.world.set_gravity({});
            (void)m.join(HingeSpec{.body = 0});
            for (int i = 0; i < 8; ++i) {
                m.run(5);
                const auto joint = m.joint(0);
                const Vector out = m.position(0) * 2;
                EXPECT_NEAR(dot(joint.force, out), -0.5 * spin * spin, 0.02 * spin * spin) << spin;
                EXPECT_NEAR(joint.speed, spin, 1e-4 * spin);
                EXPECT_NEAR(joint.torque.z, 0, 1e-3 * spin);
            }
            EXPECT_TRUE(m.world.status().ok()) << spin;
        }
    }
}

// A program that acts in every step does not undo how steps are divided.
TYPED_TEST(Joints, a_chain_that_is_touched_in_every_step_gains_no_energy) {
    typename TestFixture::Mechanism m;
    for (int i = 0; i < 5; ++i) {
        (void)m.add(placed(box(0.1, {0.1, 0.02, 0.03}), {0.1 * i + 0.05, 0, 0}));
        (void)m.join(BallSpec{.body = i, .to_body = i - 1, .anchor = {0.1 * i, 0, 0}});
    }
    const double energy = m.energy();
    double most = energy;
    for (int i = 0; i < 3000; ++i) {
        m.world.apply_impulse(m.bodies[0], {1e-7, 0, 0});
        m.run(1);
        most = std::max(most, m.energy());
    }
    EXPECT_LT((most - energy) / (0.5 * 9.81 * 0.5), 0.01);
}

// Sixteen steps of 1/4096 s for one of 1/256 s: nothing is divided.
TYPED_TEST(Joints, a_weight_on_light_links_swings_as_a_pendulum_in_short_steps) {
    auto m = weight_on_links<typename TestFixture::Mechanism>(10, {1, 4096});
    const double energy = m.energy();
    m.run(1200);
    EXPECT_TRUE(m.world.status().ok());
    EXPECT_NEAR((m.energy() - energy) / (10 * 9.81 * 1.1), 0, this->is_single ? 2e-3 : 1e-4);
}

// Every compiler, optimisation and core gives these bits.
TEST(JointBits, are_the_same_everywhere) {
    using Exact = Kind<Q32<>, integrators::Verlet>;
    Mechanism<Exact> m;
    (void)m.add(placed(box(1, {0.3, 0.5, 0.1}), {0.125, -0.25, 0}));
    (void)m.add(placed(box(0.5, {0.25, 0.125, 0.25}), {0.5, -0.5, 0.125}));
    (void)m.add(placed(box(0.25, {0.125, 0.125, 0.25}), {0.75, -0.5, 0.125}));
    (void)m.add(placed(box(0.25, {0.125, 0.25, 0.25}), {1, -0.5, 0.25}));
    (void)m.add(placed(sphere(1, 0.25), {3, 0, 0}));
    (void)m.add(placed(box(2, {0.5, 0.25, 0.25}), {3.5, 0, 0.125}));
    (void)m.join(UniversalSpec{.body = 0});
    (void)m.join(SliderSpec{.body = 1, .to_body = 0, .anchor = {0.25, -0.5, 0}, .axis = {1, 0, 0.5}});
    (void)m.join(FixedSpec{.body = 2, .to_body = 1, .anchor = {0.625, -0.5, 0.125}});
    (void)m.join(BallSpec{.body = 2, .to_body = 3, .anchor = {0.875, -0.5, 0.25}});
    (void)m.join(HingeSpec{.body = 4, .to_body = 5, .anchor = {3.25, 0, 0}, .axis = {1, 1, 0}});
    m.world.apply_impulse(m.bodies[5], {1, 2, 0.5}, {0.25, 0, 0});
    m.run(256);
    EXPECT_EQ(m.world.hash(), 5305966965119513128u);
}

}  // namespace
}  // namespace tumble::test::joint_trees

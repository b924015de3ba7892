// Forces, torques, impulses and motions that a program sets while a world runs, and what it reads, in every kind of
// number system and method. The expected motion is a closed form or an integration in long double.
#include <tumble/tumble.hpp>

#include "kinds.hpp"
#include "simulation/motion_of.hpp"

#include <cmath>
#include <limits>

namespace tumble::test::controls {
namespace {

// One method of each way to rotate and to coast, in each kind of numbers.
using Kinds = Tested<
    testing::Types<Kind<Q32<NearRange>, integrators::Verlet>>,
    testing::Types<Kind<F32, integrators::Rk4>, Kind<F64, integrators::Exact>,
                   Kind<Q32<NearRange, false>, integrators::Verlet>, Kind<Q32<NearRange>, integrators::Rk4>,
                   Kind<Q32<NearRange>, integrators::SemiImplicitEuler>, Kind<Q32<NearRange>, integrators::Pdmv6>,
                   Kind<F32, integrators::Verlet>, Kind<F64, integrators::Verlet>, Kind<F64, integrators::Rk4>,
                   Kind<F64, integrators::ImplicitMidpoint>, Kind<F64, integrators::Suzuki4>,
                   Kind<F64, integrators::ExplicitEuler>>>;

constexpr Features with_control{.control = true, .imu = true};
template <class K, Features features = with_control>
using Controlled = World<SceneOf<typename K::Numbers, typename K::Integrator, features>>;

constexpr RealVec3 g{0, -9.81, 0};
constexpr Number h = 1.0L / 256;

// A body with a full tensor, at a general place.
BodySpec skew_body() {
    BodySpec body;
    body.mass = 2.5;
    body.inertia = {2, 1.5, 1.75, 0.25, -0.125, 0.375};
    body.position = {1, -2, 3};
    body.velocity = {0.5, 0.25, -1};
    body.orientation = {0.5, {-0.5, 0.1, 0.3}};
    body.angular_velocity = {0.5, -1, 0.75};
    return body;
}

template <class K>
class Control : public testing::Test {
protected:
    using N = typename K::Numbers;
    // A rounding of values of the size of 1: a vector that a program gives keeps 29 bits in fixed point; a number of
    // this many bits, or without carry a step of them, elsewhere. Sixteen operations.
    static constexpr Number rounding = 16 * (N::fixed_point                  ? 0x1p-29L
                                             : sizeof(typename N::Work) == 4 ? 0x1p-24L
                                                                             : 0x1p-53L);
    // The same after this many steps, each of which rounds the state once where it is not carried.
    static Number rounding_in(int steps) {
        return N::carry ? rounding * 4 : rounding * (4 + static_cast<Number>(steps));
    }

    template <class World>
    [[nodiscard]] static Motion motion(const World& world, const BodySpec& body) {
        return host::motion_of(world.bodies(), host::PrincipalAxes{principal_inertia(body.inertia)}, 0);
    }
    template <class T>
    [[nodiscard]] static Vector plain(const Vector3<T>& v) {
        return {static_cast<Number>(static_cast<double>(v.x)), static_cast<Number>(static_cast<double>(v.y)),
                static_cast<Number>(static_cast<double>(v.z))};
    }
    [[nodiscard]] static Vector momentum(const BodySpec& body, Vector w) {
        const InertiaTensor& i = body.inertia;
        const Vector rows[3] = {{number(i.xx), number(i.xy), number(i.xz)},
                                {number(i.xy), number(i.yy), number(i.yz)},
                                {number(i.xz), number(i.yz), number(i.zz)}};
        return {dot(rows[0], w), dot(rows[1], w), dot(rows[2], w)};
    }
};
TYPED_TEST_SUITE(Control, Kinds);

TYPED_TEST(Control, a_held_force_moves_a_body_as_gravity_of_its_size_does) {
    const BodySpec body = skew_body();
    Controlled<TypeParam> falling{Seconds{1, 256}, {.gravity = {1, -9.81, 0.5}}}, pushed{Seconds{1, 256}};
    const BodyId id = falling.add(body);
    (void)pushed.add(body);
    pushed.set_force(id, RealVec3{1, -9.81, 0.5} * body.mass, Frame::world);
    for (int i = 0; i < 256; ++i) {
        falling.step();
        pushed.step();
    }
    const Motion a = this->motion(falling, body), b = this->motion(pushed, body);
    EXPECT_LE(norm(a.v - b.v), 10 * this->rounding_in(256));
    EXPECT_LE(norm(a.x - b.x), 10 * this->rounding_in(256));
    EXPECT_TRUE(a.w.x == b.w.x && a.q.w == b.q.w) << "it turned";
    EXPECT_TRUE(pushed.status().ok());
}

// Euler's equations of the body under a torque, constant in its axes or in the world's, by the classical Runge-Kutta
// method with steps of 2^-14 s.
struct Turning {
    Rotation q;
    Vector w;  // principal axes
};
Turning turned(const BodySpec& body, Vector torque, Frame frame, Number time) {
    const host::PrincipalAxes axes{principal_inertia(body.inertia)};
    const Vector& i = axes.moments;
    Turning s{rotation(normalized(body.orientation)) * axes.to_user,
              axes.to_user.conjugate().rotate(vector(body.angular_velocity))};
    struct Rate {
        Rotation q;
        Vector w;
    };
    const auto rate = [&](const Turning& at) {
        const Vector t =
            frame == Frame::world ? at.q.conjugate().rotate(torque) : axes.to_user.conjugate().rotate(torque);
        const Rotation q = at.q * Rotation{0, at.w * 0.5L};
        return Rate{q,
                    {(t.x + (i.y - i.z) * at.w.y * at.w.z) / i.x, (t.y + (i.z - i.x) * at.w.z * at.w.x) / i.y,
                     (t.z + (i.x - i.y) * at.w.x * at.w.y) / i.z}};
    };
    const auto plus = [](const Turning& a, const Rate& r, Number k) {
        return Turning{{a.q.w + r.q.w * k, a.q.v + r.q.v * k}, a.w + r.w * k};
    };
    const Number step = 0x1p-14L;
    for (int n = 0; n < static_cast<int>(std::lround(time / step)); ++n) {
        const Rate a = rate(s), b = rate(plus(s, a, step / 2)), c = rate(plus(s, b, step / 2)),
                   d = rate(plus(s, c, step));
        s = plus(plus(plus(plus(s, a, step / 6), b, step / 3), c, step / 3), d, step / 6);
    }
    return {s.q * axes.to_user.conjugate(), axes.to_user.rotate(s.w)};
}

TYPED_TEST(Control, a_torque_turns_a_body_with_order_2_in_its_own_frame_and_in_that_of_the_world) {
    const BodySpec body = skew_body();
    const Vector torque{0.5L, 2, -1};
    for (const Frame frame : {Frame::body, Frame::world}) {
        const Turning expected = turned(body, torque, frame, 1);
        const auto error = [&](int steps) {
            Controlled<TypeParam> world{Seconds{1, steps}};
            const BodyId id = world.add(body);
            world.set_torque(id, real(torque), frame);
            for (int i = 0; i < steps; ++i) EXPECT_TRUE(world.step().ok());
            return norm(this->motion(world, body).w - expected.w);
        };
        const Number coarse = error(64), fine = error(128);
        // Order p divides the error by 2^p; a tenth of it for the next order. Rounding is far below the errors here.
        const Number expected_ratio = TypeParam::Integrator::order == 1 ? 2 : 4;
        EXPECT_LE(fine * expected_ratio * 0.9L, coarse + this->rounding_in(128)) << static_cast<int>(frame);
        EXPECT_LE(coarse, TypeParam::Integrator::order == 1 ? 0.1L : 1e-3L);
    }
}

TYPED_TEST(Control, a_force_in_the_frame_of_the_body_turns_with_it_to_order_2) {
    // A sphere turning at pi rad/s about z: a force fixed in it brings it back to rest after 2 s, at 4 / pi from its
    // start.
    const Number pi = std::acos(Number(-1));
    BodySpec body = sphere(2, 0.5);
    body.angular_velocity = {0, 0, real(pi)};
    const auto error = [&](int steps, bool held) {
        Controlled<TypeParam> world{Seconds{1, steps}};
        const BodyId id = world.add(body);
        if (held) world.set_force(id, {4, 0, 0}, Frame::body);
        for (int i = 0; i < 2 * steps; ++i) {
            if (!held) world.apply_force(id, Vector3<double>{4, 0, 0}, Frame::body);
            EXPECT_TRUE(world.step().ok());
        }
        return norm(this->motion(world, body).x - Vector{0, 4 / pi, 0});
    };
    for (const bool held : {true, false}) {
        const Number coarse = error(64, held), fine = error(128, held);
        // A method of order 1 turns the body with its own error.
        const Number expected_ratio = TypeParam::Integrator::order == 1 ? 2 : 4;
        EXPECT_LE(fine * expected_ratio * 0.9L, coarse + 4 * this->rounding_in(256)) << held;
        EXPECT_LE(coarse, 0.1L);
    }
}

TYPED_TEST(Control, a_force_at_a_point_turns_the_body_by_its_lever) {
    // A sphere of moment 0.5 at rest: force 2 N at a lever of 0.25 m for 1 s.
    for (const Frame frame : {Frame::body, Frame::world}) {
        Controlled<TypeParam> world{Seconds{1, 256}};
        const BodySpec body = sphere(5, 0.5);
        const BodyId id = world.add(body);
        world.set_force(id, {0, 2, 0}, frame, {0.25, 0, 0});
        world.step();
        EXPECT_LE(norm(this->motion(world, body).w - Vector{0, 0, h}), this->rounding) << static_cast<int>(frame);
        EXPECT_LE(norm(this->motion(world, body).v - Vector{0, 0.4L * h, 0}), 2 * h * h + this->rounding);
    }
}

TYPED_TEST(Control, a_force_holds_until_it_is_set_again_and_a_force_of_a_step_ends_with_it) {
    const BodySpec body = sphere(2, 0.5);
    Controlled<TypeParam> world{Seconds{1, 256}};
    const BodyId id = world.add(body);
    const auto v = [&] { return this->motion(world, body).v; };
    world.set_force(id, {512, 0, 0}, Frame::world);  // 1 m/s a step
    for (int i = 0; i < 4; ++i) world.step();
    EXPECT_LE(norm(v() - Vector{4, 0, 0}), 4 * this->rounding);
    world.apply_force(id, {0, 256, 0}, Frame::world);
    world.apply_force(id, {0, 256, 0}, Frame::world);
    world.step();
    EXPECT_LE(norm(v() - Vector{5, 1, 0}), 5 * this->rounding);
    world.set_force(id, {0, 0, 0}, Frame::world);
    world.apply_torque(id, {0, 0, 51.2}, Frame::body);  // 1 rad/s in a step
    for (int i = 0; i < 4; ++i) world.step();
    EXPECT_LE(norm(v() - Vector{5, 1, 0}), 5 * this->rounding);
    EXPECT_LE(norm(this->motion(world, body).w - Vector{0, 0, 1}), 2 * this->rounding);
}

TYPED_TEST(Control, impulses_give_the_textbook_velocity_and_spin_in_both_frames) {
    const BodySpec body = skew_body();
    const Vector impulse{1, -2, 0.5L}, point{0.25L, 0.5L, -0.75L}, twist{0.5L, 0.25L, -1};
    for (const Frame frame : {Frame::body, Frame::world}) {
        Controlled<TypeParam> world{Seconds{1, 256}};
        const BodyId id = world.add(body);
        const Motion before = this->motion(world, body);
        const auto in_body = [&](Vector v) { return frame == Frame::body ? v : before.q.conjugate().rotate(v); };
        const auto in_world = [&](Vector v) { return frame == Frame::world ? v : before.q.rotate(v); };
        world.apply_impulse(id, real(impulse), real(point), frame);
        world.apply_angular_impulse(id, real(twist), frame);
        const Motion after = this->motion(world, body);
        EXPECT_LE(norm(after.v - before.v - in_world(impulse) * 0.4L), 4 * this->rounding);
        const Vector gain = this->momentum(body, after.w) - this->momentum(body, before.w);
        EXPECT_LE(norm(gain - cross(point, in_body(impulse)) - in_body(twist)), 8 * this->rounding);
        EXPECT_TRUE(after.x.x == before.x.x && after.q.w == before.q.w);
    }
}

TYPED_TEST(Control, motions_that_are_set_are_read_in_every_number) {
    const BodySpec body = skew_body();
    Controlled<TypeParam> world{Seconds{1, 256}};
    const BodyId id = world.add(body);
    const Vector x{-3, 0.5L, 2}, v{1, -2, 0.25L}, w{-0.5L, 2, 1};
    const Rotation q{0.8L, {0, 0.6L, 0}};
    world.set_pose(id, real(x), Quaternion<double>{1.6, {0, 1.2, 0}});  // twice as long
    world.set_velocity(id, real(v), Frame::body);
    world.set_angular_velocity(id, real(w), Frame::world);
    const Motion m = this->motion(world, body);
    EXPECT_LE(norm(m.x - x), 4 * this->rounding);
    EXPECT_LE(norm(m.v - q.rotate(v)), 4 * this->rounding);
    EXPECT_LE(norm(m.w - q.conjugate().rotate(w)), 4 * this->rounding);
    EXPECT_LE(std::abs(m.q.w - q.w) + norm(m.q.v - q.v), 4 * this->rounding);
    const auto agrees = [&]<class T>(Number digits) {
        const Pose<T> pose = world.template pose<T>(id);
        const Motion was = this->motion(world, body);
        const tumble::Motion<T> motion = world.template motion<T>(id);
        const Number margin = 4 * digits + 4 * this->rounding;
        EXPECT_LE(norm(this->plain(pose.position) - was.x), margin);
        EXPECT_LE(norm(this->plain(pose.orientation.v) - was.q.v), margin);
        EXPECT_LE(norm(this->plain(motion.velocity) - was.v), margin);
        EXPECT_LE(norm(this->plain(motion.angular_velocity) - was.w), margin);
    };
    agrees.template operator()<float>(0x1p-24L);
    agrees.template operator()<double>(0x1p-53L);
    EXPECT_EQ(static_cast<float>(world.position(id).x), world.template pose<float>(id).position.x);
    EXPECT_LE(
        norm(this->plain(rotate(world.orientation(id), rotate_back(world.orientation(id), world.velocity(id)))) - m.v),
        16 * this->rounding);
}

TYPED_TEST(Control, the_energy_is_that_of_mass_and_inertia) {
    const BodySpec body = skew_body();
    Controlled<TypeParam> world{Seconds{1, 256}, {.gravity = g}};
    const BodyId id = world.add(body);
    const Motion m = this->motion(world, body);
    const auto plain = [](auto value) { return static_cast<Number>(static_cast<double>(value)); };
    EXPECT_LE(std::abs(plain(world.mass(id)) - 2.5L), 4 * this->rounding);
    EXPECT_LE(
        std::abs(plain(world.kinetic_energy(id)) - (1.25L * dot(m.v, m.v) + dot(m.w, this->momentum(body, m.w)) / 2)),
        8 * this->rounding);
    EXPECT_LE(std::abs(plain(world.potential_energy(id)) - 2.5L * 9.81L * m.x.y), 64 * this->rounding);
    const InertiaTensor i = world.inertia(id);
    EXPECT_LE(std::abs(number(i.xx - body.inertia.xx)) + std::abs(number(i.yz - body.inertia.yz)), 8 * this->rounding);
    // The work of an impulse is the impulse times the mean of the velocities before and after it.
    const Number before = plain(world.kinetic_energy(id));
    world.apply_impulse(id, {1, 0, 0}, {}, Frame::world);
    const Motion after = this->motion(world, body);
    EXPECT_LE(std::abs(plain(world.kinetic_energy(id)) - before - (m.v.x + after.v.x) / 2), 8 * this->rounding);
}

TYPED_TEST(Control, the_inertial_sensor_feels_what_gravity_does_not_do) {
    // Differences of velocities over a step: their rounding grows by the rate of steps, and by its square in the spin.
    const Number noise = 4 * this->rounding * 256;
    BodySpec body = sphere(2, 0.5);
    body.orientation = {0.8, {0, 0, 0.6}};
    {
        BodySpec rest = body;
        rest.fixed = true;
        Controlled<TypeParam> world{Seconds{1, 256}, {.gravity = g}};
        const BodyId id = world.add(rest);
        world.step();
        const Rotation q = this->motion(world, rest).q;
        EXPECT_LE(norm(this->plain(world.template imu<float>(id).specific_force) - q.conjugate().rotate({0, 9.81L, 0})),
                  10 * noise + 1e-5L)
            << "a body at rest feels its weight";
    }
    Controlled<TypeParam> world{Seconds{1, 256}, {.gravity = g}};
    const BodyId id = world.add(body);
    for (int i = 0; i < 10; ++i) world.step();
    EXPECT_LE(norm(this->plain(world.template imu<double>(id).specific_force)), noise) << "free fall";
    world.set_force(id, {3, 4, 0}, Frame::body);
    world.step();
    EXPECT_LE(norm(this->plain(world.template imu<double>(id).specific_force) - Vector{1.5L, 2, 0}), 4 * noise);
    // A point that circles: towards the axis by the square of the spin, and along by the torque.
    world.set_force(id, {0, 0, 0}, Frame::body);
    world.set_angular_velocity(id, {0, 0, 2});
    world.step();
    EXPECT_LE(norm(this->plain(world.template imu<double>(id, {0.25, 0, 0}).specific_force) - Vector{-1, 0, 0}),
              8 * noise);
    EXPECT_LE(norm(this->plain(world.template imu<double>(id).angular_velocity) - Vector{0, 0, 2}), 4 * this->rounding);
    world.set_torque(id, {0, 0, 0.2}, Frame::body);  // 1 rad/s^2
    world.step();
    const Number middle = 2 + h / 2;
    EXPECT_LE(norm(this->plain(world.template imu<double>(id, {0.25, 0, 0}).specific_force) -
                   Vector{-middle * middle / 4, 0.25L, 0}),
              8 * noise);
}

TYPED_TEST(Control, every_number_system_moves_the_body_as_doubles_do) {
    Controlled<TypeParam> world{Seconds{1, 256}, {.gravity = g}};
    Controlled<Kind<F64, typename TypeParam::Integrator>> doubles{Seconds{1, 256}, {.gravity = g}};
    const BodySpec body = skew_body();
    const auto fly = [&](auto& any) {
        const BodyId id = any.add(body);
        any.set_force(id, {2, 20, -1}, Frame::body, {0.1, 0, 0.2});
        any.set_torque(id, {0.5, 1, 0.25}, Frame::world);
        for (int i = 0; i < 256; ++i) any.step();
        return this->motion(any, body);
    };
    const Motion a = fly(world), b = fly(doubles);
    // The errors of a second add up in velocity and again in position, of numbers of up to 20.
    EXPECT_LE(norm(a.x - b.x) + norm(a.v - b.v) + norm(a.w - b.w), 20 * this->rounding_in(256));
}

TYPED_TEST(Control, what_is_compiled_in_besides_changes_no_bit) {
    Controlled<TypeParam> minimal{Seconds{1, 256}, {.gravity = g}};
    Controlled<TypeParam, little_of_everything> full{Seconds{1, 256}, {.gravity = g}};
    Controlled<TypeParam, Features{}> plain{Seconds{1, 256}, {.gravity = g}};
    const BodySpec body = skew_body();
    const BodyId id = minimal.add(body);
    (void)full.add(body);
    (void)plain.add(body);
    for (int i = 0; i < 64; ++i) {
        minimal.step();
        full.step();
        plain.step();
    }
    EXPECT_EQ(minimal.hash(), plain.hash()) << "a feature that no body uses";
    const auto command = [&](auto& world, int i) {
        if (i == 0) world.set_force(id, Vector3<float>{1, 2, -3}, Frame::body, {0.1, 0, 0.2});
        if (i == 20) world.set_torque(id, {0.5F, 1.0F, 0.25F}, Frame::world);
        if (i == 40) world.apply_force(id, {0, 3, 0}, Frame::world, Vector3<float>{0, 0, 0.5F});
        if (i == 50) world.apply_impulse(id, {0.5, 0, 0.25}, {0, 0.5, 0}, Frame::body);
        world.step();
    };
    for (int i = 0; i < 64; ++i) {
        command(minimal, i);
        command(full, i);
        ASSERT_EQ(minimal.hash(), full.hash()) << i;
    }
    EXPECT_NE(minimal.hash(), plain.hash());
    EXPECT_TRUE(minimal.status().ok());
}

TYPED_TEST(Control, an_event_does_what_its_call_does_and_a_snapshot_keeps_what_holds) {
    Controlled<TypeParam> calls{Seconds{1, 256}}, events{Seconds{1, 256}};
    const BodyId id = calls.add(skew_body());
    (void)events.add(skew_body());
    using E = Event<typename TypeParam::Numbers>;
    calls.set_force(id, {1, 2, 3}, Frame::body, {0, 0.5, 0});
    events.apply(
        E{.kind = EventKind::force, .frame = Frame::body, .body = id, .value = {1, 2, 3}, .point = {0, 0.5, 0}});
    calls.apply_impulse(id, {1, 0, 0}, {0, 0, 1}, Frame::world);
    events.apply(E{.kind = EventKind::impulse, .body = id, .value = {1, 0, 0}, .point = {0, 0, 1}});
    const auto snapshot = calls;
    for (int i = 0; i < 32; ++i) {
        calls.step();
        events.step();
    }
    EXPECT_EQ(calls.hash(), events.hash());
    calls = snapshot;
    for (int i = 0; i < 32; ++i) calls.step();
    EXPECT_EQ(calls.hash(), events.hash());
}

TYPED_TEST(Control, a_force_too_large_for_the_step_is_reported) {
    if constexpr (TestFixture::N::fixed_point) {
        Controlled<TypeParam> world{Seconds{1, 256}};
        const BodyId id = world.add(sphere(1, 0.5));
        world.set_force(id, {1e30, 0, 0}, Frame::world);
        EXPECT_TRUE(world.step().has(Issue::range_left));
    } else {
        Controlled<TypeParam> world{Seconds{1, 256}};
        const BodyId id = world.add(sphere(1, 0.5));
        world.set_force(id, {std::numeric_limits<float>::infinity(), 0.0F, 0.0F}, Frame::world);
        EXPECT_TRUE(world.step().has(Issue::range_left));
    }
    Controlled<TypeParam> world{Seconds{1, 256}};
    const BodyId id = world.add(sphere(1, 0.5));
    world.set_velocity(id, {0, 1e30, 0});
    world.step();
    EXPECT_TRUE(world.status().has(Issue::range_left) || !TestFixture::N::fixed_point);
}

// --- beside contacts and loads ------------------------------------------------------------------------------------

constexpr Features on_the_ground{.bodies = 1,
                                 .planes = 1,
                                 .drag = true,
                                 .control = true,
                                 .imu = true,
                                 .boxes = true,
                                 .friction = true,
                                 .sleep = true};

TYPED_TEST(Control, friction_holds_a_box_until_the_force_exceeds_it) {
    Controlled<TypeParam, on_the_ground> world{
        Seconds{1, 256},
        {.gravity = {0, -8, 0}, .contact = {.restitution = 0, .friction = 0.5, .sleep = {.on = true}}}};
    BodySpec box = tumble::box(2, {1, 0.5, 1});
    box.position = {0, 0.25, 0};
    const BodyId id = world.add(box);
    (void)world.add(PlaneSpec{});
    const auto speed = [&] { return std::abs(this->motion(world, box).v.x); };
    for (int i = 0; i < 512; ++i) world.step();
    EXPECT_TRUE(world.asleep(id));
    EXPECT_LE(std::abs(static_cast<double>(world.template imu<float>(id).specific_force.y) - 8), 0.01);
    world.set_force(id, {4, 0, 0}, Frame::world);
    EXPECT_FALSE(world.asleep(id)) << "a force wakes a body";
    for (int i = 0; i < 64; ++i) world.step();
    EXPECT_LE(speed(), 1e-3L) << "friction holds up to 8 N";
    world.set_force(id, {12, 0, 0}, Frame::world);  // 2 m/s^2
    for (int i = 0; i < 128; ++i) world.step();
    // The contact's own tolerance: a hundredth of the speed.
    EXPECT_LE(std::abs(speed() - 1), 0.01L);
    EXPECT_TRUE(world.status().ok());
    world.set_force(id, {0, 20, 0}, Frame::world);  // lifts it
    for (int i = 0; i < 64; ++i) world.step();
    EXPECT_GT(this->motion(world, box).x.y, 0.27L);
}

TYPED_TEST(Control, drag_and_a_held_force_meet_at_the_terminal_speed) {
    Controlled<TypeParam, Features{.drag = true, .control = true}> world{Seconds{1, 256}, {.linear_drag = 2}};
    const BodySpec body = sphere(2, 0.5);
    const BodyId id = world.add(body);
    world.set_force(id, {4, 0, 0}, Frame::world);
    for (int i = 0; i < 256; ++i) world.step();
    // v = 2 (1 - exp(-t)); a step of h of a method of order 1 is off by h / 2 of the change.
    EXPECT_LE(std::abs(this->motion(world, body).v.x - 2 * (1 - std::exp(Number(-1)))), h);
    EXPECT_TRUE(world.status().ok());
}

TEST(Poses, are_interpolated_from_one_to_the_other_by_the_shorter_way) {
    const Pose<float> a{{0, 1, 2}, {}}, b{{4, 1, 0}, {-0.8F, {0, -0.6F, 0}}};  // b turns by 2 acos 0.8
    const Pose<float> start = interpolate(a, b, 0.0F), end = interpolate(a, b, 1.0F), middle = interpolate(a, b, 0.5F);
    EXPECT_EQ(start.position.x, 0);
    EXPECT_EQ(end.position.x, 4);
    EXPECT_EQ(middle.position, (Vector3<float>{2, 1, 1}));
    EXPECT_EQ(start.orientation.w, 1);
    EXPECT_NEAR(end.orientation.v.y, 0.6F, 1e-6F);
    // Half the angle: cos of acos(0.8) / 2.
    EXPECT_NEAR(middle.orientation.w, std::sqrt(0.9F), 1e-6F);
}

// Bodies on a fixed table whose pose or spin a program changes, asleep or awake.
template <class N>
class OnTable : public testing::Test {
protected:
    static constexpr Features features{.bodies = 2,
                                       .control = true,
                                       .imu = true,
                                       .pairs = true,
                                       .boxes = true,
                                       .friction = true,
                                       .sleep = true,
                                       .turntables = true};
    using Table = World<SceneOf<N, integrators::Verlet, features>>;

    explicit OnTable(double friction = 0.5)
        : world(Seconds{1, 256}, {.gravity = g, .contact = {.friction = friction, .sleep = {.on = true}}}) {
        BodySpec top = box(1, {8, 1, 8});
        top.position = {0, -0.5, 0};
        top.fixed = true;
        table = world.add(top);
    }
    BodyId add(BodySpec body, RealVec3 position) {
        body.position = position;
        return world.add(body);
    }
    void run(int steps) {
        for (int i = 0; i < steps; ++i) world.step();
    }

    Table world;
    BodyId table;
};
template <class N>
struct OnIce : OnTable<N> {
    OnIce() : OnTable<N>(0) {}
};
using TableNumbers = Tested<testing::Types<Q32<NearRange>>, testing::Types<F32, F64>>;
TYPED_TEST_SUITE(OnTable, TableNumbers);
TYPED_TEST_SUITE(OnIce, TableNumbers);

TYPED_TEST(OnTable, a_box_is_carried_by_a_table_that_is_set_spinning_under_it) {
    for (const int rest : {16, 512}) {  // awake, asleep
        typename TestFixture::Table world = this->world;
        const BodyId body = this->add(box(1, {0.4, 0.4, 0.4}), {1, 0.2, 0});
        this->run(rest);
        this->world.set_angular_velocity(this->table, {0, 1, 0});
        this->run(128);
        EXPECT_NEAR(static_cast<double>(this->world.angular_velocity(body).y), 1, 0.1) << rest;
        this->world.set_angular_velocity(this->table, {0, 0, 0});
        this->run(512);
        EXPECT_TRUE(this->world.asleep(body)) << rest;
        this->world = world;
    }
}

TYPED_TEST(OnTable, a_body_falls_when_its_table_is_taken_away) {
    for (const int rest : {16, 512}) {
        typename TestFixture::Table world = this->world;
        const BodyId body = this->add(box(1, {0.4, 0.4, 0.4}), {1, 0.2, 0});
        this->run(rest);
        EXPECT_EQ(this->world.asleep(body), rest == 512);
        this->world.set_pose(this->table, {0, -20, 0});
        this->run(128);
        EXPECT_NEAR(static_cast<double>(this->world.position(body).y), 0.2 - 9.81 / 8, 0.02) << rest;
        this->world = world;
    }
}

TYPED_TEST(OnIce, a_ball_slides_down_a_table_that_is_tilted_under_it) {
    const BodyId ball = this->add(sphere(1, 0.25), {0, 0.25, 0});
    this->run(16);
    // By 15 degrees, about the point under the ball.
    const Quaternion<Real> tilt{0.991444861373810, {0, 0, 0.130526192220052}};
    this->world.set_pose(this->table, {0.5 * 0.258819045102521, -0.5 * 0.965925826289068, 0}, tilt);
    this->run(64);
    EXPECT_NEAR(static_cast<double>(this->world.velocity(ball).x), -9.81 * 0.25 * 0.25, 0.05);
}

TYPED_TEST(OnTable, a_body_that_is_set_elsewhere_leaves_what_it_touched_alone) {
    typename TestFixture::Table world{Seconds{1, 256}};
    BodySpec ball = sphere(1, 0.5);
    const BodyId left = world.add(ball);
    ball.position = {1, 0, 0};
    const BodyId right = world.add(ball);
    world.step();
    world.set_pose(right, {-1.001, 5, 0});
    world.set_velocity(right, {-1, 0, 0});
    world.step();
    EXPECT_EQ(static_cast<double>(world.position(left).x), 0);
    EXPECT_NEAR(static_cast<double>(world.position(right).x), -1.001 - 1.0 / 256, 1e-6);
}

TYPED_TEST(OnTable, a_sensor_does_not_feel_an_impulse_between_steps) {
    const BodyId body = this->add(sphere(1, 0.25), {0, 10, 0});
    this->run(4);
    EXPECT_NEAR(static_cast<double>(this->world.template imu<float>(body).specific_force.y), 0, 1e-3);
    this->world.apply_impulse(body, {1, 0, 0});
    EXPECT_NEAR(static_cast<double>(this->world.template imu<float>(body).specific_force.x), 0, 1e-3);
    this->run(1);
    EXPECT_NEAR(static_cast<double>(this->world.template imu<float>(body).specific_force.y), 0, 1e-3);
    this->world.set_gravity({});
    EXPECT_NEAR(static_cast<double>(this->world.template imu<float>(body).specific_force.y), 0, 1e-3);
}

TYPED_TEST(Control, gravity_that_is_set_is_the_gravity_of_a_scene) {
    const RealVec3 gravity{1.5, -9.8125, 0.375};
    Controlled<TypeParam> scene{Seconds{1, 256}, {.gravity = gravity}}, set{Seconds{1, 256}}, again{scene};
    for (auto* world : {&scene, &set, &again}) (void)world->add(skew_body());
    set.set_gravity({1.5F, -9.8125F, 0.375F});
    for (int step = 0; step < 128; ++step) {
        again.set_gravity({1.5, -9.8125, 0.375});
        for (auto* world : {&scene, &set, &again}) world->step();
    }
    EXPECT_EQ(set.hash(), scene.hash());
    EXPECT_EQ(again.hash(), scene.hash()) << "gravity as it is changes nothing";
    set.set_gravity({0.0F, 2.0F, 0.0F});
    const auto before = this->plain(set.velocity(BodyId{0}));
    for (int step = 0; step < 128; ++step) set.step();
    const auto change = this->plain(set.velocity(BodyId{0})) - before;
    EXPECT_NEAR(static_cast<double>(change.x), 0, static_cast<double>(this->rounding_in(128)));
    EXPECT_NEAR(static_cast<double>(change.y), 1, static_cast<double>(this->rounding_in(128)));
}

TYPED_TEST(Control, gravity_beyond_its_range_is_told_of_no_body) {
    if (!TypeParam::Numbers::fixed_point) return;
    Controlled<TypeParam> world{Seconds{1, 256}};
    (void)world.add(skew_body());
    world.set_gravity(RealVec3{0, 1e9, 0});
    EXPECT_TRUE(world.status().has(Issue::range_left));
    EXPECT_EQ(world.status().first_body, 1) << "the number of bodies";
}

TYPED_TEST(OnTable, a_fixed_body_takes_a_spin_only_where_there_are_turntables) {
    World<SceneOf<TypeParam, integrators::Verlet, Features{.control = true}>> world{Seconds{1, 256}};
    BodySpec spec = box(1, {1, 1, 1});
    spec.fixed = true;
    const BodyId body = world.add(spec);
    world.set_angular_velocity(body, {0, 1, 0});
    EXPECT_EQ(static_cast<double>(world.angular_velocity(body).y), 0);
}

TEST(ControlDeathTest, misuse_ends_the_program) {
    using Q = Controlled<Kind<Q32<NearRange>, integrators::Verlet>, Features{.point_masses = true, .control = true}>;
    Q world{Seconds{1, 256}}, points{Seconds{1, 256}};
    const BodyId id = world.add(sphere(1, 0.5));
    (void)points.add(point_mass(1));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_DEATH(world.set_force(id, {nan, 0.0F, 0.0F}, Frame::world), "");
    EXPECT_DEATH(world.set_force(id, {std::numeric_limits<double>::infinity(), 0.0, 0.0}, Frame::world), "");
    EXPECT_DEATH(world.set_force(BodyId{1}, {1, 0, 0}, Frame::world), "");
    EXPECT_DEATH(world.set_pose(id, {0, 0, 0}, Quaternion<float>{0, {0, 0, 0}}), "");
    EXPECT_DEATH(points.set_torque(id, {1, 0, 0}, Frame::body), "");
    EXPECT_DEATH(points.set_force(id, {1, 0, 0}, Frame::body), "");
    EXPECT_DEATH(points.set_force(id, {1, 0, 0}, Frame::world, {0, 1, 0}), "");
    EXPECT_DEATH(points.set_angular_velocity(id, {1, 0, 0}), "");
    EXPECT_DEATH(points.apply_angular_impulse(id, {1, 0, 0}, Frame::world), "");
    points.set_force(id, {1, 0, 0}, Frame::world);
    points.step();
    EXPECT_GT(static_cast<float>(points.velocity(id).x), 0);
}

TEST(Conversions, of_floats_to_working_numbers_and_back_are_exact) {
    for (const float value : {0.0F, 1.0F, -1.5F, 0.1F, 3.4e38F, -1.2e-38F, 1e-45F, 16777217.0F})
        EXPECT_EQ(static_cast<float>(Scaled(value)), value) << value;
    for (const double value : {0.0, 1.0, -1.5, 0x1p-1000, -0x1.fffffffcp500})
        EXPECT_EQ(static_cast<double>(Scaled(value)), value) << value;
    EXPECT_EQ(Scaled(0.1), Scaled::from(Real{0.1}));
    // Halves round to even, and what is above a half rounds up.
    EXPECT_EQ(static_cast<float>(Scaled(16777217)), 16777216.0F);
    EXPECT_EQ(static_cast<float>(Scaled(16777219)), 16777220.0F);
    EXPECT_EQ(static_cast<float>(Scaled(33554435)), 33554436.0F);
    EXPECT_EQ(static_cast<float>(Real{0.1}), 0.1F);
    EXPECT_EQ(static_cast<double>(Real{0.1}), 0.1);
}

TEST(Ids, of_planes_and_springs_count_from_zero_and_are_false_without_room) {
    World<SceneOf<F64, integrators::Verlet, Features{.planes = 2, .springs = 1}>> world{Seconds{1, 256}};
    const BodyId body = world.add(sphere(1, 0.5));
    EXPECT_EQ(world.add(PlaneSpec{}).index(), 0);
    EXPECT_EQ(world.add(PlaneSpec{.offset = 5}).index(), 1);
    EXPECT_FALSE(world.add(PlaneSpec{}));
    SpringSpec spring;
    spring.body = body;
    spring.stiffness = 1;
    EXPECT_EQ(world.add(spring).index(), 0);
    EXPECT_FALSE(world.add(spring));
}

}  // namespace
}  // namespace tumble::test::controls

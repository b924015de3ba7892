// A drone with four rotors that holds a height and a heading. The controller computes in floats. It reads the pose, the
// motion and the inertial sensor after each step, shares the lift and the torque among the rotors, and sets the force
// and the torque that they make in the drone's own axes. The same code runs in a world of integers, of floats and of
// doubles, where the machine has them.
#include <tumble/tumble.hpp>

using namespace tumble::literals;

namespace {

using Vector = tumble::Vector3<float>;
using Quaternion = tumble::Quaternion<float>;

template <class N>
struct Drone : tumble::Scene {
    using Numbers = N;
    static constexpr tumble::Features features{.control = true, .imu = true};
};

constexpr float gravity = 9.81F;  // m/s^2
constexpr tumble::BodySpec body = tumble::box(0.25_kg, {0.2_m, 0.05_m, 0.2_m});
constexpr float mass = static_cast<float>(body.mass);  // kg
constexpr Vector inertia{static_cast<float>(body.inertia.xx), static_cast<float>(body.inertia.yy),
                         static_cast<float>(body.inertia.zz)};  // kg m^2

struct Command {
    float height;        // m
    Quaternion heading;  // level; a rotation about the vertical
};
constexpr Command commands[] = {
    {2, {}}, {2, {0.70710678F, {0, 0.70710678F, 0}}}, {0.5F, {}}};  // up; quarter turn; back down

float clamped(float value, float limit) { return value > limit ? limit : value < -limit ? -limit : value; }
bool is_near(float a, float b, float margin) { return a - b < margin && b - a < margin; }

// Four rotors at the corners push along the drone's y axis and turn in opposite pairs: each drags the drone about y.
constexpr float arm = 0.1F, drag = 0.02F, most_thrust = 2;  // m, along x and z; N m per N; N of a rotor
struct Rotors {
    float front_left, front_right, back_left, back_right;  // N; front: +x, right: +z; these two turn one way: fl, br
};
// The thrusts that make a force along y and a torque, within what the rotors give.
Rotors mix(float lift, const Vector& torque) {
    const auto thrust = [](float value) { return value < 0 ? 0 : value > most_thrust ? most_thrust : value; };
    const float each = lift * 0.25F, about_x = torque.x * (0.25F / arm),
                about_y = clamped(torque.y * (0.25F / drag), each * 0.5F), about_z = torque.z * (0.25F / arm);
    const float front = each + about_z, back = each - about_z, with = about_x + about_y, against = about_x - about_y;
    return {thrust(front + with), thrust(front - with), thrust(back + against), thrust(back - against)};
}

// Both controllers are critically damped: the height with 1/3 s, the attitude with 1/6 s.
template <class World>
void control(World& world, tumble::BodyId drone, const Command& to) {
    const auto [position, orientation] = world.template pose<float>(drone);
    const Vector velocity = world.template motion<float>(drone).velocity;
    const Vector rate = world.template imu<float>(drone).angular_velocity;  // the gyro
    // The rotation that is left, in the drone's axes: twice its vector part is the angle.
    const Quaternion left = orientation.conjugate() * to.heading;
    const Vector angle = left.v * (left.w < 0 ? -2.0F : 2.0F);
    const Vector gain = angle * 36 - rate * 12;  // rad/s^2
    // The rotors push along the drone's own y axis, which leans while it levels out.
    const Vector& v = orientation.v;
    const float upright = 1 - 2 * (v.x * v.x + v.z * v.z);  // the y component of the drone's y axis
    const float lift = gravity + clamped((to.height - position.y) * 9 - velocity.y * 6, gravity);  // m/s^2
    const Rotors r = mix(mass * lift / (upright > 0.5F ? upright : 0.5F),
                         {inertia.x * gain.x, inertia.y * gain.y, inertia.z * gain.z});
    const float front = r.front_left + r.front_right, back = r.back_left + r.back_right;
    world.set_force(drone, {0.0F, front + back, 0.0F}, tumble::Frame::body);
    world.set_torque(drone,
                     {arm * (r.front_left + r.back_left - r.front_right - r.back_right),
                      drag * (r.front_left + r.back_right - r.front_right - r.back_left), arm * (front - back)},
                     tumble::Frame::body);
}

// What a flight computer does 256 times a second. The tests measure it, so each number system has a function of its
// own.
template <class N>
bool hover(tumble::World<Drone<N>>& world, tumble::BodyId drone, const Command& to) {
    control(world, drone, to);
    return world.step().ok();
}
using Integers = tumble::Q32<tumble::NearRange>;
using Floats = tumble::F32Plain;
using Doubles = tumble::F64;
[[gnu::noinline]] bool hover_in_q32(tumble::World<Drone<Integers>>& world, tumble::BodyId drone, const Command& to) {
    return hover(world, drone, to);
}
[[maybe_unused, gnu::noinline]] bool hover_in_f32(tumble::World<Drone<Floats>>& world, tumble::BodyId drone,
                                                  const Command& to) {
    return hover(world, drone, to);
}

// 0 if the drone obeys all commands.
template <class N>
int fly(bool (*step)(tumble::World<Drone<N>>&, tumble::BodyId, const Command&) = hover<N>) {
    tumble::World<Drone<N>> world{tumble::Seconds{1, 256}, {.gravity = {0, -9.81, 0}}};
    const tumble::BodyId drone = world.add(body);
    if (!drone) return 1;
    for (const Command& command : commands) {
        // A gust from below at one rotor: N s in the drone's axes, at a point, m.
        world.apply_impulse(drone, Vector{0.02F, 0.05F, 0}, Vector{0.1F, 0, 0.05F}, tumble::Frame::body);
        for (int i = 0; i < 6 * 256; ++i) {
            if (!step(world, drone, command)) return 2;
        }
        const auto [position, orientation] = world.template pose<float>(drone);
        if (!is_near(position.y, command.height, 1e-3F)) return 3;
        const Quaternion left = orientation.conjugate() * command.heading;
        if (dot(left.v, left.v) > 1e-8F) return 4;
        // A drone that hovers feels its weight along its own y axis.
        const Vector felt = world.template imu<float>(drone).specific_force;
        if (!is_near(felt.x, 0, 0.02F) || !is_near(felt.y, gravity, 0.02F) || !is_near(felt.z, 0, 0.02F)) return 5;
    }
    return 0;
}

// Bits: 4, the machine has floats; 8, it has doubles.
#if defined(__ARM_FP)
constexpr int hardware = __ARM_FP;
#elif defined(__arm__)
constexpr int hardware = 0;
#else
constexpr int hardware = 4 | 8;
#endif

}  // namespace

int main() {
    if (const int status = fly<Integers>(hover_in_q32)) return status;
    if constexpr ((hardware & 4) != 0)
        if (const int status = fly<Floats>(hover_in_f32)) return 10 + status;
    if constexpr ((hardware & 8) != 0)
        if (const int status = fly<Doubles>()) return 20 + status;
    return 0;
}

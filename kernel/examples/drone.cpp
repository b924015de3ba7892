// A drone that holds a height and a heading. The controller computes in floats. It reads the pose, the motion and the
// inertial sensor after each step, and sets the thrust and the torque of the rotors in the drone's own axes. The same
// code runs in a world of integers, of floats and of doubles.
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
    world.set_torque(drone, {inertia.x * gain.x, inertia.y * gain.y, inertia.z * gain.z}, tumble::Frame::body);
    // The rotors push along the drone's own y axis, which leans while it levels out.
    const float upright = rotate(orientation, Vector{0, 1, 0}).y;
    const float lift = gravity + clamped((to.height - position.y) * 9 - velocity.y * 6, gravity);  // m/s^2
    world.set_force(drone, {0.0F, mass * lift / (upright > 0.5F ? upright : 0.5F), 0.0F}, tumble::Frame::body);
}

// 0 if the drone obeys all commands.
template <class N>
int fly() {
    tumble::World<Drone<N>> world{tumble::Seconds{1, 256}, {.gravity = {0, -9.81, 0}}};
    const tumble::BodyId drone = world.add(body);
    if (!drone) return 1;
    for (const Command& command : commands) {
        // A gust from below at one rotor: N s in the drone's axes, at a point, m.
        world.apply_impulse(drone, Vector{0.02F, 0.05F, 0}, Vector{0.1F, 0, 0.05F}, tumble::Frame::body);
        for (int i = 0; i < 6 * 256; ++i) {
            control(world, drone, command);
            if (!world.step().ok()) return 2;
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

}  // namespace

int main() {
    if (const int status = fly<tumble::Q32<tumble::NearRange>>()) return status;
    if (const int status = fly<tumble::F32>()) return 10 + status;
    if (const int status = fly<tumble::F64>()) return 20 + status;
    return 0;
}

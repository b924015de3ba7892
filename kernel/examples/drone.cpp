// A drone under commands. Heights and headings arrive while it flies. A controller reads the state after each step and
// applies the impulses of the rotors.
#include <tumble/tumble.hpp>

using namespace tumble::literals;
using tumble::Real;

namespace {

struct Drone : tumble::Scene {
    using Numbers = tumble::Q32<tumble::NearRange>;
};
using World = tumble::World<Drone>;

constexpr Real step = Real{1} / 256, gravity = 9.81;  // s, m/s^2
constexpr tumble::BodySpec body = tumble::box(0.25_kg, {0.2_m, 0.05_m, 0.2_m});
constexpr tumble::RealVec3 rotors[] = {{0.1_m, 0, 0}, {-0.1_m, 0, 0}};  // body axes

struct Command {
    Real height;              // m
    Real half_cos, half_sin;  // of half the heading about the vertical
};
constexpr Command commands[] = {{2, 1, 0}, {2, 0.70710678, 0.70710678}, {0.5, 1, 0}};  // up; quarter turn; back down

Real clamped(Real value, Real limit) { return value > limit ? limit : value < -limit ? -limit : value; }

// The rotors share the lift, against gravity and towards the height. Their couple turns the drone to its heading.
void control(World& world, tumble::BodyId drone, const Command& to) {
    const auto q = world.orientation(drone);
    const Real height = world.position(drone).y().to_real(), yaw_rate = world.angular_velocity(drone).y().to_real();
    // The impulses act before a step, gravity during it: the mean velocity is g h / 2 above the velocity at its end.
    const Real climb = world.velocity(drone).y().to_real() + gravity * step / 2;
    const Real half_yaw_left = to.half_sin * q.w.to_real() - to.half_cos * q.v.y().to_real();
    // Both controllers are critically damped, with 1/3 s. N s of a rotor in a step.
    const Real lift = body.mass * clamped(gravity + (to.height - height) * 9 - climb * 6, 2 * gravity) * step / 2;
    const Real couple = body.inertia.yy * (half_yaw_left * 18 - yaw_rate * 6) * step / 2 / rotors[0].x;
    // The drone's z axis in the world.
    const Real cos = 1 - 2 * q.v.y().to_real() * q.v.y().to_real(), sin = 2 * q.w.to_real() * q.v.y().to_real();
    world.apply_impulse(drone, {-couple * sin, lift, -couple * cos}, rotors[0]);
    world.apply_impulse(drone, {couple * sin, lift, couple * cos}, rotors[1]);
}

World world{tumble::Seconds{1, 256}, {.gravity = {0, -gravity, 0}}};

}  // namespace

int main() {
    const tumble::BodyId drone = world.add(body);
    if (!drone) return 1;
    for (const Command& command : commands) {
        for (int i = 0; i < 6 * 256; ++i) {
            control(world, drone, command);
            if (!world.step().ok()) return 2;
        }
        const auto q = world.orientation(drone);
        if (abs(world.position(drone).y().to_real() - command.height) > 1e-3) return 3;
        if (abs(q.w.to_real() - command.half_cos) > 1e-3 || abs(q.v.y().to_real() - command.half_sin) > 1e-3) return 4;
    }
    return 0;
}

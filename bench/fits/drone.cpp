// A drone that hovers: a force and a torque in its own axes after each step, from its pose and from its inertial
// sensor. The controller computes in integers of 20 fraction bits.
#include <tumble/tumble.hpp>

using namespace tumble::literals;

namespace {

struct Drone : tumble::Scene {
    using Numbers = tumble::Q32<tumble::NearRange>;
    static constexpr tumble::Seconds step{1, 256};
    static constexpr tumble::Features features{.control = true, .imu = true};
};
using Number = tumble::Fixed<20>;
consteval Number number(tumble::Real value) { return Number::from(value); }

constexpr tumble::Real mass = 0.25, gravity = 9.81, height = 2;  // kg, m/s^2, m
constexpr tumble::BodySpec body = tumble::box(mass, {0.2_m, 0.05_m, 0.2_m});

constinit tumble::World<Drone> world = [] {
    tumble::World<Drone> start{{.gravity = {0, -gravity, 0}}};
    tumble::BodySpec drone = body;
    drone.orientation = {0.995, {0.1, 0, 0}};
    drone.angular_velocity = {0.2, 0.5, 0};  // rad/s
    start.add(drone);
    return start;
}();

// Critically damped: the height with 1/3 s, the attitude with 1/6 s.
[[gnu::noinline]] tumble::Status step_world() {
    const tumble::BodyId drone{0};
    const auto [position, orientation] = world.pose<Number>(drone);
    const auto rate = world.imu<Number>(drone).angular_velocity;
    const Number lift = number(gravity) + (number(height) - position.y) * number(9) -
                        world.motion<Number>(drone).velocity.y * number(6);  // m/s^2
    const auto gain = orientation.v * number(-72) - rate * number(12);       // rad/s^2
    world.set_force(drone, {Number{}, number(mass) * lift, Number{}}, tumble::Frame::body);
    world.set_torque(
        drone, {number(body.inertia.xx) * gain.x, number(body.inertia.yy) * gain.y, number(body.inertia.zz) * gain.z},
        tumble::Frame::body);
    return world.step();
}

}  // namespace

int main() {
    for (int i = 0; i < 6 * 256; ++i)
        if (!step_world().ok()) return 1;
    const auto [position, orientation] = world.pose<Number>(tumble::BodyId{0});
    const Number off = position.y - number(height), tilt = orientation.v.x;
    const auto is_small = [](Number x) { return x < number(0.001) && -x < number(0.001); };
    return is_small(off) && is_small(tilt) ? 0 : 2;
}

// A gyroscope in a gimbal. The outer ring turns about the vertical, the inner ring about a level axis in it, and the
// rotor spins in the inner ring. The inner ring is heavier on one side. In place of falling there, it makes the outer
// ring precess at the torque of its weight over the angular momentum of the rotor. The program prints the hash of the
// end.
#include <tumble/tumble.hpp>

#include "port.hpp"

namespace {

constexpr tumble::Real inner_mass = 0.15, off_centre = 0.002, axial_moment = 0.0005, spin = 60, gravity = 9.81;
// That keeps the inner ring level, rad/s. L. D. Landau, E. M. Lifshitz, Mechanics, section 35: the axis is level, so no
// other moment counts.
constexpr tumble::Real precession = inner_mass * gravity * off_centre / (axial_moment * spin);
constexpr int steps = 1024;  // 4 s

struct Gimbal : tumble::Scene {
    static constexpr tumble::Seconds step{1, 256};
    // All of its joints are hinges.
    static constexpr tumble::Features features{
        .bodies = 3, .joints = 3, .balls = false, .fixed_joints = false, .sliders = false, .universals = false};
};
// kg; kg m^2, about x, y and z
constexpr tumble::BodySpec body(tumble::Real mass, tumble::Real x, tumble::Real y, tumble::Real z) {
    tumble::BodySpec spec;
    spec.mass = mass;
    spec.inertia = {x, y, z, 0, 0, 0};
    return spec;
}
// The world with the ids of its joints.
struct Mechanism {
    tumble::World<Gimbal> world{{.gravity = {0, -gravity, 0}}};
    tumble::JointId outer_bearing, inner_bearing, rotor_bearing;
};
// The compiler sets it up, so the firmware has no code for that.
constinit Mechanism gimbal = [] {
    Mechanism start;
    tumble::BodySpec spec = body(0.2, 0.002, 0.001, 0.002);
    spec.angular_velocity = {0, precession, 0};
    const tumble::BodyId outer = start.world.add(spec);
    spec = body(inner_mass, 0.0007, 0.0007, 0.0013);
    spec.position = {0, 0, off_centre};
    spec.angular_velocity = {0, precession, 0};
    spec.velocity = {precession * off_centre, 0, 0};
    const tumble::BodyId inner = start.world.add(spec);
    spec = body(0.5, 0.0003, 0.0003, axial_moment);
    spec.angular_velocity = {0, precession, spin};
    const tumble::BodyId rotor = start.world.add(spec);
    start.outer_bearing = start.world.add(tumble::HingeSpec{.body = outer, .axis = {0, 1, 0}});
    start.inner_bearing = start.world.add(tumble::HingeSpec{.body = inner, .to_body = outer, .axis = {1, 0, 0}});
    start.rotor_bearing = start.world.add(tumble::HingeSpec{.body = rotor, .to_body = inner, .axis = {0, 0, 1}});
    return start;
}();
// What the tests measure.
[[gnu::noinline]] bool spin_once() { return gimbal.world.step().ok(); }

bool is_within(tumble::Real value, tumble::Real wanted, tumble::Real most) { return abs(value - wanted) < most; }
tumble::Real real(float value) { return tumble::Real{value}; }

}  // namespace

int main() {
    tumble::port::init();
    for (int step = 0; step < steps; ++step) {
        if (!spin_once()) return 1;
        const tumble::Real tilt = real(gimbal.world.joint<float>(gimbal.inner_bearing).angle);
        if (!is_within(tilt, 0, 1e-4)) return 2;  // rad
    }
    const tumble::Real angle = real(gimbal.world.joint<float>(gimbal.outer_bearing).angle),
                       speed = real(gimbal.world.joint<float>(gimbal.rotor_bearing).speed);
    if (!is_within(angle, precession * steps * tumble::Real::scaled(1, -8), 1e-3)) return 3;
    if (!is_within(speed, spin, 0.001)) return 4;
    tumble::port::write_hash(gimbal.world.hash());
    return 0;
}

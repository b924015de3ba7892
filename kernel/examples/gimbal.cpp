// A gyroscope in a gimbal. The outer ring turns about the vertical, the inner ring about a level axis in it, and the
// rotor spins in the inner ring. The inner ring is heavier on one side. In place of falling there, it makes the outer
// ring precess at the torque of its weight over the angular momentum of the rotor. The program prints the hash of the
// end.
#include <tumble/tumble.hpp>

#include "port.hpp"

namespace {

constexpr tumble::Real inner_mass = 0.15, off_centre = 0.002, axial_moment = 0.0005, spin = 60, gravity = 9.81;
constexpr int steps = 1024;  // 4 s

struct Gimbal : tumble::Scene {
    static constexpr tumble::Seconds step{1, 256};
    // All of its joints are hinges.
    static constexpr tumble::Features features{
        .bodies = 3, .joints = 3, .balls = false, .fixed_joints = false, .sliders = false, .universals = false};
};
tumble::World<Gimbal> world{{.gravity = {0, -gravity, 0}}};
tumble::JointId outer_bearing, inner_bearing, rotor_bearing;

// kg; kg m^2, about x, y and z
tumble::BodySpec body(tumble::Real mass, tumble::Real x, tumble::Real y, tumble::Real z) {
    tumble::BodySpec spec;
    spec.mass = mass;
    spec.inertia = {x, y, z, 0, 0, 0};
    return spec;
}
// With the precession that keeps the inner ring level, rad/s.
bool set_up(tumble::Real precession) {
    tumble::BodySpec spec = body(0.2, 0.002, 0.001, 0.002);
    spec.angular_velocity = {0, precession, 0};
    const tumble::BodyId outer = world.add(spec);
    spec = body(inner_mass, 0.0007, 0.0007, 0.0013);
    spec.position = {0, 0, off_centre};
    spec.angular_velocity = {0, precession, 0};
    spec.velocity = {precession * off_centre, 0, 0};
    const tumble::BodyId inner = world.add(spec);
    spec = body(0.5, 0.0003, 0.0003, axial_moment);
    spec.angular_velocity = {0, precession, spin};
    const tumble::BodyId rotor = world.add(spec);
    outer_bearing = world.add(tumble::HingeSpec{.body = outer, .axis = {0, 1, 0}});
    inner_bearing = world.add(tumble::HingeSpec{.body = inner, .to_body = outer, .axis = {1, 0, 0}});
    rotor_bearing = world.add(tumble::HingeSpec{.body = rotor, .to_body = inner, .axis = {0, 0, 1}});
    return outer_bearing && inner_bearing && rotor_bearing;
}
// What the tests measure.
[[gnu::noinline]] bool spin_once() { return world.step().ok(); }

bool is_within(tumble::Real value, tumble::Real wanted, tumble::Real most) { return abs(value - wanted) < most; }
tumble::Real real(float value) { return tumble::Real{value}; }

void write_hash(std::uint64_t hash) {
    char line[17];
    for (int i = 0; i < 16; ++i) line[i] = "0123456789abcdef"[(hash >> (60 - 4 * i)) & 15];
    line[16] = '\n';
    tumble::port::write(line, sizeof line);
}

}  // namespace

int main() {
    tumble::port::init();
    // L. D. Landau, E. M. Lifshitz, Mechanics, section 35: the axis is level, so no other moment counts.
    const tumble::Real precession = inner_mass * gravity * off_centre / (axial_moment * spin);
    if (!set_up(precession)) return 1;
    for (int step = 0; step < steps; ++step) {
        if (!spin_once()) return 2;
        const tumble::Real tilt = real(world.joint<float>(inner_bearing).angle);
        if (!is_within(tilt, 0, 1e-4)) return 3;  // rad
    }
    const tumble::Real angle = real(world.joint<float>(outer_bearing).angle),
                       speed = real(world.joint<float>(rotor_bearing).speed);
    if (!is_within(angle, precession * steps * tumble::Real::scaled(1, -8), 1e-3)) return 4;
    if (!is_within(speed, spin, 0.001)) return 5;
    write_hash(world.hash());
    return 0;
}

// A satellite in an orbit, with a wheel for each axis: the motors brake its spin, and the gravity gradient acts.
#include <tumble/tumble.hpp>

using namespace tumble::literals;

namespace {

using Numbers = tumble::Q32<tumble::NearRange>;
struct Satellite : tumble::Scene {
    using Numbers = ::Numbers;
    static constexpr tumble::Seconds step{1, 16};
    static constexpr tumble::Features features{.gravity_gradient = true, .wheels = true, .control = true};
};
using Number = tumble::Fixed<20>;
consteval Number number(tumble::Real value) { return Number::from(value); }

constexpr tumble::BodySpec body = tumble::box(12_kg, {0.2_m, 0.2_m, 0.34_m});
constexpr tumble::Real orbit_rate = 0.0011;  // rad/s

tumble::World<Satellite> world;
tumble::Vector3<Number> momentum{Number{}, number(0.004), Number{}};  // of the wheels, N m s

[[gnu::noinline]] tumble::Status step_world() {
    const tumble::BodyId id{0};
    const auto spin = world.motion<Number>(id).angular_velocity;
    const tumble::Vector3<Number> torque = spin * number(-0.01);  // N m
    world.set_torque(id, torque, tumble::Frame::body);
    momentum = momentum - torque * number(0.0625);
    world.change_load<tumble::Wheels<Numbers, 1>>().set_momentum(id, momentum);
    return world.step();
}

}  // namespace

int main() {
    tumble::BodySpec satellite = body;
    satellite.angular_velocity = {0.02, -0.03, 0.05};  // rad/s
    const tumble::BodyId id = world.add(satellite);
    world.change_load<tumble::GravityGradient<Numbers, 1>>().set_orbit(orbit_rate, {0.6, 0, -0.8});
    world.change_load<tumble::Wheels<Numbers, 1>>().set_momentum(id, momentum);
    for (int i = 0; i < 120 * 16; ++i)
        if (!step_world().ok()) return 1;
    const auto spin = world.motion<Number>(id).angular_velocity;
    return dot(spin, spin) < number(0.0001) ? 0 : 2;
}

// A satellite with three reaction wheels that turns to a target and holds it. The controller computes in floats: it
// reads attitude and spin, asks for a torque by quaternion feedback, and the motors of the wheels give it. What a motor
// gives to the body it takes from its wheel, so body and wheels together keep their angular momentum; only the gravity
// gradient changes it, and the wheels take that up while the satellite holds. The same code runs in a world of
// integers, of floats and of doubles, where the machine has them. B. Wie, Space Vehicle Dynamics and Control, 1998,
// section 7.3.
#include <tumble/tumble.hpp>

using namespace tumble::literals;

namespace {

using Vector = tumble::Vector3<float>;
using Quaternion = tumble::Quaternion<float>;

template <class N>
struct Satellite : tumble::Scene {
    using Numbers = N;
    static constexpr tumble::Features features{.gravity_gradient = true, .wheels = true, .control = true};
};

constexpr tumble::BodySpec body = tumble::box(12_kg, {0.2_m, 0.2_m, 0.34_m});
constexpr Vector inertia{static_cast<float>(body.inertia.xx), static_cast<float>(body.inertia.yy),
                         static_cast<float>(body.inertia.zz)};  // kg m^2
constexpr Vector times_inertia(const Vector& v) { return {inertia.x * v.x, inertia.y * v.y, inertia.z * v.z}; }
constexpr float step = 1.0F / 16;      // s
constexpr float orbit_rate = 0.0011F;  // rad/s: 500 km above the Earth
// To the Earth, world axes. The hold of 256 s is short against the orbit of 5700 s, so the direction stands still.
constexpr Vector to_centre{0.6F, 0.0F, -0.8F};

// Each wheel turns about an axis of the body.
struct Wheels {
    static constexpr float most_torque = 0.004F, most_momentum = 0.05F;  // N m; N m s
    Vector momentum{0, 0.004F, 0};  // N m s; with this bias, a satellite that turns precesses

    // What the motors give the body in a step, N m, when this is asked for. A wheel at its greatest speed gives none.
    [[nodiscard]] Vector torque(const Vector& asked) const {
        Vector given;
        for (int i = 0; i < 3; ++i) {
            given[i] = asked[i] > most_torque ? most_torque : asked[i] < -most_torque ? -most_torque : asked[i];
            const float after = momentum[i] - given[i] * step;
            if (after > most_momentum || after < -most_momentum) given[i] = 0;
        }
        return given;
    }
};

constexpr Quaternion targets[] = {
    {0.70710678F, {0.70710678F, 0, 0}}, {0.5F, {0.5F, 0.5F, 0.5F}}, {0.96592583F, {0, 0.25881905F, 0}}};

// rad/s^2. Critically damped with 1/5 s; the angle is limited to 1/2 rad, so that a turn has at most 0.05 rad/s.
Vector feedback(const Quaternion& attitude, const Vector& spin, const Quaternion& target) {
    const Quaternion left = attitude.conjugate() * target;  // the rotation that is left, in the body's axes
    Vector angle = left.v * (left.w < 0 ? -2.0F : 2.0F);    // twice its vector part is the angle
    const float size = tumble::sqrt(dot(angle, angle));
    if (size > 0.5F) angle = angle * (0.5F / size);
    return angle * 0.04F - spin * 0.4F;
}

// What a flight computer does 16 times a second: feedback, and the torque that turns the momentum of body and wheels
// with the body. In the step the wheels have the mean of their momentum before and after it.
template <class N>
bool steer(tumble::World<Satellite<N>>& world, tumble::BodyId satellite, Wheels& wheels, const Quaternion& target) {
    const Vector spin = world.template motion<float>(satellite).angular_velocity;
    const Vector wanted = feedback(world.template pose<float>(satellite).orientation, spin, target);
    const Vector torque = wheels.torque(times_inertia(wanted) + cross(spin, times_inertia(spin) + wheels.momentum));
    world.set_torque(satellite, torque, tumble::Frame::body);
    world.template change_load<tumble::Wheels<N, 1>>().set_momentum(satellite, wheels.momentum - torque * (step / 2));
    wheels.momentum = wheels.momentum - torque * step;
    return world.step().ok();
}
// The tests measure it, so each number system has a function of its own.
using Integers = tumble::Q32<tumble::NearRange>;
using Floats = tumble::F32Plain;
using Doubles = tumble::F64;
[[gnu::noinline]] bool steer_in_q32(tumble::World<Satellite<Integers>>& world, tumble::BodyId satellite, Wheels& wheels,
                                    const Quaternion& target) {
    return steer(world, satellite, wheels, target);
}
[[maybe_unused, gnu::noinline]] bool steer_in_f32(tumble::World<Satellite<Floats>>& world, tumble::BodyId satellite,
                                                  Wheels& wheels, const Quaternion& target) {
    return steer(world, satellite, wheels, target);
}

// N m s, world axes, of body and wheels.
template <class N>
Vector momentum_of(const tumble::World<Satellite<N>>& world, tumble::BodyId satellite, const Wheels& wheels) {
    const Vector w = world.template motion<float>(satellite).angular_velocity;
    return rotate(world.template pose<float>(satellite).orientation, times_inertia(w) + wheels.momentum);
}
bool is_within(const Vector& v, float most) { return dot(v, v) < most * most; }

// 0 if the satellite turns to each target and holds it.
template <class N>
int fly(bool (*step_once)(tumble::World<Satellite<N>>&, tumble::BodyId, Wheels&, const Quaternion&) = steer<N>) {
    tumble::World<Satellite<N>> world{tumble::Seconds{1, 16}};
    const tumble::BodyId satellite = world.add(body);
    if (!satellite) return 1;
    world.template change_load<tumble::GravityGradient<N, 1>>().set_orbit(tumble::Real{orbit_rate},
                                                                          to_centre.template as<tumble::Real>());
    Wheels wheels;
    for (const Quaternion& target : targets) {
        const Vector before = momentum_of(world, satellite, wheels);
        for (int i = 0; i < 128 * 16; ++i)
            if (!step_once(world, satellite, wheels, target)) return 2;
        // Within 1e-4 rad and 1e-5 rad/s: the gradient's torque stands against an angle of 2e-5 rad.
        const Quaternion left = world.template pose<float>(satellite).orientation.conjugate() * target;
        if (!is_within(left.v, 0.5e-4F)) return 3;
        if (!is_within(world.template motion<float>(satellite).angular_velocity, 1e-5F)) return 4;
        // The gradient's torque is at most 1.5 w^2 (I_x - I_z), 1.4e-7 N m. Rounding adds less than 5e-6 N m s.
        const Vector turned = momentum_of(world, satellite, wheels);
        if (!is_within(turned - before, 128 * 1.4e-7F + 5e-6F)) return 5;
    }
    // While the satellite holds for 256 s, the wheels take up the torque 3 w^2 r x J r of the gradient, 6e-9 N m s a
    // step. Floats round a momentum of 0.004 N m s to 2.3e-10 N m s, 4 percent of that.
    const Quaternion& held = targets[2];
    const Vector r = rotate_back(held, to_centre);
    const Vector torque = cross(r, times_inertia(r)) * (3 * orbit_rate * orbit_rate);
    const Vector before = wheels.momentum;
    for (int i = 0; i < 256 * 16; ++i)
        if (!step_once(world, satellite, wheels, held)) return 6;
    const Vector taken_up = wheels.momentum - before;
    return is_within(taken_up - torque * 256, 0.05F * 256 * tumble::sqrt(dot(torque, torque))) ? 0 : 7;
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
    if (const int status = fly<Integers>(steer_in_q32)) return status;
    if constexpr ((hardware & 4) != 0)
        if (const int status = fly<Floats>(steer_in_f32)) return 10 + status;
    if constexpr ((hardware & 8) != 0)
        if (const int status = fly<Doubles>()) return 20 + status;
    return 0;
}

// A drone with four rotors that holds a height and a heading. The controller reads the pose, the motion and the
// inertial sensor after each step, shares the lift and the torque among the rotors, and sets the force and the torque
// that they make in the drone's own axes. It computes in floats where the machine has them, and else in integers of 20
// fraction bits. The same code runs in a world of integers, of floats and of doubles.
#include <tumble/tumble.hpp>

using namespace tumble::literals;

namespace {

template <class N>
struct Drone : tumble::Scene {
    using Numbers = N;
    static constexpr tumble::Features features{.control = true, .imu = true};
};
template <class N>
using World = tumble::World<Drone<N>>;

// The numbers of a controller: floats, or integers with a range of 2048 and a resolution of 1e-6. Values stay below
// 600 while the drone turns by less than 32 rad/s; a torque of 1e-6 N m turns it by 1e-3 rad/s^2.
using Float = float;
using Integer = tumble::Fixed<20>;
template <class T>
consteval T number(tumble::Real value) {
    if constexpr (std::is_same_v<T, float>) return static_cast<float>(value);
    else return T::from(value);
}

constexpr tumble::Real gravity = 9.81;  // m/s^2
constexpr tumble::BodySpec body = tumble::box(0.25_kg, {0.2_m, 0.05_m, 0.2_m});

struct Command {
    tumble::Real height;       // m
    tumble::RealQuat heading;  // level; a rotation about the vertical
};
constexpr Command commands[] = {
    {2, {}}, {2, {0.70710678, {0, 0.70710678, 0}}}, {0.5, {}}};  // up; quarter turn; back down

// Both controllers are critically damped: the height with 1/3 s, the attitude with 1/6 s.
template <class T>
class Controller {
    using Vector = tumble::Vector3<T>;
    using Quaternion = tumble::Quaternion<T>;

public:
    explicit Controller(const Command& command)
        : height{convert(command.height)}, heading{convert(command.heading.w),
                                                   {convert(command.heading.v.x), convert(command.heading.v.y),
                                                    convert(command.heading.v.z)}} {}

    template <class World>
    void act(World& world, tumble::BodyId drone) const {
        const auto [position, orientation] = world.template pose<T>(drone);
        const Vector velocity = world.template motion<T>(drone).velocity;
        const Vector rate = world.template imu<T>(drone).angular_velocity;  // the gyro
        // The rotation that is left, in the drone's axes: twice its vector part is the angle.
        const Quaternion left = orientation.conjugate() * heading;
        const Vector half_angle = left.w < T{} ? -left.v : left.v;
        const Vector gain = half_angle * number<T>(72) - rate * number<T>(12);  // rad/s^2
        // The rotors push along the drone's own y axis, which leans while it levels out.
        const Vector& v = orientation.v;
        const T half = v.x * v.x + v.z * v.z, lean = half + half;  // 1 less the y component of the drone's y axis
        const T lift = number<T>(gravity) + clamped((height - position.y) * number<T>(9) - velocity.y * number<T>(6),
                                                    number<T>(gravity));  // m/s^2
        const Rotors r = mix(number<T>(body.mass) * lift * over_one_less(lean < number<T>(0.5) ? lean : number<T>(0.5)),
                             {number<T>(body.inertia.xx) * gain.x, number<T>(body.inertia.yy) * gain.y,
                              number<T>(body.inertia.zz) * gain.z});
        const T front = r.front_left + r.front_right, back = r.back_left + r.back_right;
        world.set_force(drone, {T{}, front + back, T{}}, tumble::Frame::body);
        world.set_torque(drone,
                         {number<T>(arm) * (r.front_left + r.back_left - r.front_right - r.back_right),
                          number<T>(drag) * (r.front_left + r.back_right - r.front_right - r.back_left),
                          number<T>(arm) * (front - back)},
                         tumble::Frame::body);
    }

private:
    // Four rotors at the corners push along the drone's y axis and turn in opposite pairs: each drags the drone about
    // y.
    static constexpr tumble::Real arm = 0.1, drag = 0.02, most_thrust = 2;  // m, along x and z; N m per N; N of a rotor
    struct Rotors {
        T front_left, front_right, back_left, back_right;  // N; front: +x, right: +z; these two turn one way: fl, br
    };

    static T convert(tumble::Real value) {
        if constexpr (std::is_same_v<T, float>) return static_cast<float>(value);
        else return T::from(value);
    }
    static T clamped(T value, T limit) { return value > limit ? limit : value < -limit ? -limit : value; }
    // 1 / (1 - d) by eight terms of the geometric series: exact for 0, 0.4 % less for 1/2.
    static T over_one_less(T d) {
        constexpr T one = number<T>(1);
        const T d2 = d * d;
        return (one + d) * (one + d2) * (one + d2 * d2);
    }
    // The thrusts that make a force along y and a torque, within what the rotors give.
    static Rotors mix(T lift, const Vector& torque) {
        const auto thrust = [](T value) {
            return value < T{} ? T{} : value > number<T>(most_thrust) ? number<T>(most_thrust) : value;
        };
        constexpr T per_arm = number<T>(tumble::Real{0.25} / arm), per_drag = number<T>(tumble::Real{0.25} / drag);
        const T each = lift * number<T>(0.25), about_x = torque.x * per_arm,
                about_y = clamped(torque.y * per_drag, each * number<T>(0.5)), about_z = torque.z * per_arm;
        const T front = each + about_z, back = each - about_z, with = about_x + about_y, against = about_x - about_y;
        return {thrust(front + with), thrust(front - with), thrust(back + against), thrust(back - against)};
    }

    T height;            // m
    Quaternion heading;  // level
};

// What a flight computer does 256 times a second. The tests measure it, so each number system has a function of its
// own.
template <class N, class T>
bool hover(World<N>& world, tumble::BodyId drone, const Controller<T>& controller) {
    controller.act(world, drone);
    return world.step().ok();
}
template <class N, class T>
using Hover = bool(World<N>&, tumble::BodyId, const Controller<T>&);

bool is_near(float a, float b, float margin) { return a - b < margin && b - a < margin; }

// 0 if the drone obeys all commands.
template <class N, class T>
int fly(Hover<N, T>* step = hover<N, T>) {
    World<N> world{tumble::Seconds{1, 256}, {.gravity = {0, -gravity, 0}}};
    const tumble::BodyId drone = world.add(body);
    if (!drone) return 1;
    for (const Command& command : commands) {
        const Controller<T> controller{command};
        // A gust from below at one rotor: N s in the drone's axes, at a point, m.
        world.apply_impulse(drone, {0.02F, 0.05F, 0.0F}, {0.1F, 0.0F, 0.05F}, tumble::Frame::body);
        for (int i = 0; i < 6 * 256; ++i) {
            if (!step(world, drone, controller)) return 2;
        }
        const auto [position, orientation] = world.template pose<float>(drone);
        if (!is_near(position.y, static_cast<float>(command.height), 1e-3F)) return 3;
        const auto left = orientation.conjugate() * command.heading.as<float>();
        if (dot(left.v, left.v) > 1e-8F) return 4;
        // A drone that hovers feels its weight along its own y axis.
        const auto felt = world.template imu<float>(drone).specific_force;
        if (!is_near(felt.x, 0, 0.02F) || !is_near(felt.y, static_cast<float>(gravity), 0.02F) ||
            !is_near(felt.z, 0, 0.02F))
            return 5;
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

using Q32 = tumble::Q32<tumble::NearRange>;
using F32 = tumble::F32Plain;
using Number = std::conditional_t<(hardware & 4) != 0, Float, Integer>;
[[gnu::noinline]] bool hover_in_q32(World<Q32>& world, tumble::BodyId drone, const Controller<Number>& controller) {
    return hover(world, drone, controller);
}
[[maybe_unused, gnu::noinline]] bool hover_in_f32(World<F32>& world, tumble::BodyId drone,
                                                  const Controller<Float>& controller) {
    return hover(world, drone, controller);
}

}  // namespace

int main() {
    if (const int status = fly<Q32, Number>(hover_in_q32)) return status;
    if constexpr ((hardware & 4) != 0)
        if (const int status = fly<F32, Float>(hover_in_f32)) return 10 + status;
    if constexpr ((hardware & 8) != 0) {
        if (const int status = fly<tumble::F64, Float>()) return 20 + status;
        if (const int status = fly<Q32, Integer>()) return 30 + status;
    }
    return 0;
}

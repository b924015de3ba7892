// A free body. A box that spins about its middle axis turns over again and again. Its kinetic energy and the length of
// its angular momentum stay the same.
#include <tumble/tumble.hpp>

using namespace tumble::literals;

namespace {

struct Box : tumble::Scene {};  // one body in 32-bit integers, with the default method; no loads, no contacts

constexpr tumble::BodySpec box() {
    tumble::BodySpec spec = tumble::box(1.5_kg, {0.1_m, 0.2_m, 0.3_m});
    spec.angular_velocity = {0.01, 3, 0.01};  // rad/s
    return spec;
}

// 2 T and |L|^2 from the principal moments and the angular velocity w about the same axes.
struct Kept {
    tumble::Real energy, momentum;

    explicit Kept(const tumble::RealVec3& w) {
        constexpr tumble::InertiaTensor inertia = box().inertia;
        const tumble::RealVec3 l{inertia.xx * w.x, inertia.yy * w.y, inertia.zz * w.z};
        energy = dot(l, w);
        momentum = dot(l, l);
    }
};

bool is_within(tumble::Real share, tumble::Real value, tumble::Real of) { return abs(value - of) < abs(of) * share; }

tumble::World<Box> world{tumble::Seconds{1, 256}};

}  // namespace

int main() {
    const tumble::BodyId id = world.add(box());
    if (!id) return 1;
    const Kept start{world.angular_velocity(id).as<tumble::Real>()};
    int turns_over = 0;
    bool was_up = true;
    for (int step = 0; step < 30 * 256; ++step) {
        if (!world.step().ok()) return 2;
        const auto w = world.angular_velocity(id).as<tumble::Real>();
        const Kept now{w};
        if (!is_within(1e-6, now.momentum, start.momentum) || !is_within(1e-3, now.energy, start.energy)) return 3;
        const bool is_up = w.y > 0;
        turns_over += is_up != was_up;
        was_up = is_up;
    }
    return turns_over >= 3 ? 0 : 4;
}

// A load of the program's own: a magnet that attracts a steel ball, written here in one struct and named in the scene.
// No file of the kernel knows it. The ball falls beside the magnet and is drawn aside; its energy stays the same.
#include <tumble/tumble.hpp>

using namespace tumble::literals;

namespace {

// A force that falls with the fourth power of the distance: a dipole and the dipole that it induces, both along the
// line between them. F = strength / r^4, to the magnet.
struct Magnet {
    tumble::Vector3<float> place{};  // m, world
    float strength = 0;              // N m^4

    [[nodiscard]] bool acts_on(const auto& /*bodies*/, int /*body*/) const { return strength > 0; }

    template <class Group>
    void apply_to(const Group& group) const {
        using Work = typename Group::Work;
        for (int k = 0; k < group.count; ++k) {
            const auto r = place.as<Work>() - group.position(k);
            const Work square = dot(r, r);
            // r / |r|^5 is the direction times 1 / |r|^4.
            group.push(k, r * (static_cast<Work>(strength) / (square * square * sqrt(square))));
        }
    }
    // J, of a body at this place.
    [[nodiscard]] float energy(const tumble::Vector3<float>& at) const {
        const tumble::Vector3<float> r = at - place;
        const float square = dot(r, r);
        return -strength / (3 * square * tumble::sqrt(square));
    }
};

struct Ball : tumble::Scene {
    using Numbers = tumble::Q32<tumble::NearRange>;
    using Loads = tumble::LoadList<Magnet>;
};

constexpr float gravity = 9.81F, mass = 0.5F;  // m/s^2, kg

tumble::World<Ball> world{tumble::Seconds{1, 256}, {.gravity = {0, -9.81, 0}}};

float energy(tumble::BodyId ball) {
    const auto at = world.pose<float>(ball).position, v = world.motion<float>(ball).velocity;
    return mass * (dot(v, v) / 2 + gravity * at.y) + world.load<Magnet>().energy(at);
}

}  // namespace

int main() {
    tumble::BodySpec spec = tumble::sphere(0.5_kg, 0.02_m);
    spec.position = {0, 1, 0};
    const tumble::BodyId ball = world.add(spec);
    if (!ball) return 1;
    world.change_load<Magnet>() = {.place = {0.5F, 0.5F, 0}, .strength = 0.2F};
    const float start = energy(ball);
    for (int step = 0; step < 128; ++step) {
        if (!world.step().ok()) return 2;
        const float gained = energy(ball) - start;
        if (gained > 1e-3F || gained < -1e-3F) return 3;  // J, of a fall of 5 J a metre
    }
    const auto at = world.pose<float>(ball).position;
    return at.x > 0.05F && at.y < 0 ? 0 : 4;  // drawn aside, and past the magnet
}

// A box that lands. It falls on an edge, bounces, slides, tips over onto a face and comes to rest. From then on it
// costs nothing.
#include <tumble/tumble.hpp>

using namespace tumble::literals;
using tumble::Real;

namespace {

struct Landing : tumble::Scene {
    using Numbers = tumble::Q32<tumble::NearRange>;
    static constexpr tumble::Features features{.planes = 1, .boxes = true, .friction = true, .sleep = true};
};

constexpr tumble::RealVec3 edges{0.4_m, 0.2_m, 0.3_m};

constexpr tumble::BodySpec box() {
    tumble::BodySpec spec = tumble::box(2_kg, edges);
    spec.position = {0, 2, 0};
    spec.velocity = {0.5, 0, 0};  // m/s
    spec.orientation = {0.9, {0, 0.1, 0.4}};
    spec.angular_velocity = {1, 0, 2};  // rad/s
    return spec;
}

constexpr tumble::WorldSpec earth{
    .gravity = {0, -9.81, 0},
    .contact = {.restitution = 0.3, .friction = 0.5, .tolerance = 0.001_m, .sleep = {.on = true}},
};

// The compiler sets the world up, so the firmware holds no code for that.
constinit tumble::World<Landing> world = [] {
    tumble::World<Landing> start{tumble::Seconds{1, 256}, earth};
    start.add(box());
    start.add(tumble::PlaneSpec{});  // the plane y = 0
    return start;
}();

}  // namespace

int main() {
    const tumble::BodyId id{0};
    while (!world.asleep(id)) {
        if (!world.step().ok()) return 1;
        if (world.steps_taken() > 10 * 256) return 2;  // not at rest after 10 s
    }
    // On a face: the centre is half an edge above the ground, to within the contact tolerance.
    const Real height = world.position(id).y.to_real();
    bool on_a_face = false;
    for (int i = 0; i < 3; ++i) on_a_face = on_a_face || abs(height - edges[i] / 2) < earth.contact.tolerance;
    if (!on_a_face) return 3;
    // A sleeping body does not move by a bit until an impulse wakes it.
    const std::uint64_t hash = world.hash();
    for (int i = 0; i < 256; ++i) world.step();
    if (world.hash() != hash) return 4;
    world.apply_impulse(id, {0, 6, 0});  // N s: upwards, 3 m/s
    world.step();
    return !world.asleep(id) && world.velocity(id).y > 2 ? 0 : 5;
}

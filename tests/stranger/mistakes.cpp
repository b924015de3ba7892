// Programs that do not compile, one for each MISTAKE_<name>, and say why. Without a mistake the program compiles.
#include <tumble/tumble.hpp>

using namespace tumble::literals;

namespace {

constexpr tumble::Seconds step{1, 256};

struct Free : tumble::Scene {};
struct Floor : tumble::Scene {
    static constexpr tumble::Features features{.planes = 1};
};
struct Stepped : tumble::Scene {
    static constexpr tumble::Seconds step{1, 256};
};
struct Floats : tumble::Scene {
#ifdef MISTAKE_FLOAT_AS_NUMBERS
    using Numbers = float;
#endif
};

struct Wind {
    [[nodiscard]] bool acts_on(const auto&, int) const { return true; }
#ifndef MISTAKE_LOAD_WITHOUT_FORCE
    void apply_to(const auto&) const {}
#endif
#ifdef MISTAKE_TURNS_OF_A_LOAD
    [[nodiscard]] bool turns(int) const { return true; }
#elif defined MISTAKE_COUPLES_ALONE
    [[nodiscard]] bool couples(const auto&, int) const { return true; }
#elif defined MISTAKE_SET_BODY_OF_A_LOAD
    void set_body(int) {}
#elif defined MISTAKE_EACH_OF_A_LOAD
    void each(auto&) {}
#endif
};
struct Windy : tumble::Scene {
    using Loads = tumble::LoadList<Wind>;
};

constexpr tumble::BodySpec body() {
    tumble::BodySpec spec = tumble::box(1_kg, {1_m, 2_m, 3_m});
#ifdef MISTAKE_BOX_AS_POINT
    spec = tumble::point_mass(1_kg);
#elif defined MISTAKE_TURNTABLE
    spec.fixed = true;
    spec.angular_velocity = {0, 1, 0};
#endif
    return spec;
}
constinit tumble::World<Free> prepared = [] {
    tumble::WorldSpec spec;
#ifdef MISTAKE_DRAG
    spec.linear_drag = 0.5;
#endif
    tumble::World<Free> world{step, spec};
    world.add(body());
    return world;
}();

}  // namespace

int main() {
    const tumble::BodyId id{0};
    tumble::World<Floor> floor{step};
    tumble::World<Floats> floats{step};
    tumble::World<Windy> windy{step};
#ifdef MISTAKE_CONTROL
    prepared.set_torque(id, {1, 0, 0}, tumble::Frame::body);
#elif defined MISTAKE_IMU
    (void)prepared.imu<float>(id);
#elif defined MISTAKE_READOUT
    (void)floor.contacts(id);
#elif defined MISTAKE_SCRIPT
    prepared.set_script({});
#elif defined MISTAKE_SNAPSHOT
    (void)prepared.save(nullptr, 0);
#elif defined MISTAKE_REMOVAL
    prepared.remove(id);
#elif defined MISTAKE_PLANE
    (void)prepared.add(tumble::PlaneSpec{});
#elif defined MISTAKE_SPRING
    (void)prepared.add(tumble::SpringSpec{});
#elif defined MISTAKE_NUMBER_AS_STEP
    tumble::World<Free> world{0.01};
#elif defined MISTAKE_TWO_STEPS
    tumble::World<Stepped> world{step};
#endif
    return prepared.step().ok() && floor.step().ok() && floats.step().ok() && windy.step().ok() && prepared.contains(id)
               ? 0
               : 1;
}

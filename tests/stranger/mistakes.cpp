// Programs that do not compile, one for each MISTAKE, and say why. Without a mistake the program compiles.
#include <tumble/tumble.hpp>

#define NOTHING 0
#define CONTROL 1
#define IMU 2
#define READOUT 3
#define SCRIPT 4
#define SNAPSHOT 5
#define REMOVAL 6
#define PLANE 7
#define SPRING 8
#define NUMBER_AS_STEP 9
#define TWO_STEPS 10
#define FLOAT_AS_NUMBERS 11
#define DRAG 12
#define BOX_AS_POINT 13
#define TURNTABLE 14
#define TURNS_OF_A_LOAD 15
#define COUPLES_ALONE 16
#define SET_BODY_OF_A_LOAD 17
#define LOAD_WITHOUT_FORCE 18
#define EACH_OF_A_LOAD 19

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
#if MISTAKE == FLOAT_AS_NUMBERS
    using Numbers = float;
#endif
};

struct Wind {
    [[nodiscard]] bool acts_on(const auto&, int) const { return true; }
#if MISTAKE != LOAD_WITHOUT_FORCE
    void apply_to(const auto&) const {}
#endif
#if MISTAKE == TURNS_OF_A_LOAD
    [[nodiscard]] bool turns(int) const { return true; }
#elif MISTAKE == COUPLES_ALONE
    [[nodiscard]] bool couples(const auto&, int) const { return true; }
#elif MISTAKE == SET_BODY_OF_A_LOAD
    void set_body(int) {}
#elif MISTAKE == EACH_OF_A_LOAD
    void each(auto&) {}
#endif
};
struct Windy : tumble::Scene {
    using Loads = tumble::LoadList<Wind>;
};

constexpr tumble::BodySpec body() {
    tumble::BodySpec spec = tumble::box(1_kg, {1_m, 2_m, 3_m});
#if MISTAKE == BOX_AS_POINT
    spec = tumble::point_mass(1_kg);
#elif MISTAKE == TURNTABLE
    spec.fixed = true;
    spec.angular_velocity = {0, 1, 0};
#endif
    return spec;
}
constinit tumble::World<Free> prepared = [] {
    tumble::WorldSpec spec;
#if MISTAKE == DRAG
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
#if MISTAKE == CONTROL
    prepared.set_torque(id, {1, 0, 0}, tumble::Frame::body);
#elif MISTAKE == IMU
    (void)prepared.imu<float>(id);
#elif MISTAKE == READOUT
    (void)floor.contacts(id);
#elif MISTAKE == SCRIPT
    prepared.set_script({});
#elif MISTAKE == SNAPSHOT
    (void)prepared.save(nullptr, 0);
#elif MISTAKE == REMOVAL
    prepared.remove(id);
#elif MISTAKE == PLANE
    (void)prepared.add(tumble::PlaneSpec{});
#elif MISTAKE == SPRING
    (void)prepared.add(tumble::SpringSpec{});
#elif MISTAKE == NUMBER_AS_STEP
    tumble::World<Free> world{0.01};
#elif MISTAKE == TWO_STEPS
    tumble::World<Stepped> world{step};
#endif
    return prepared.step().ok() && floor.step().ok() && floats.step().ok() && windy.step().ok() && prepared.contains(id)
               ? 0
               : 1;
}

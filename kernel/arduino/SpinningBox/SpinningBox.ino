// A box that spins about its middle axis turns over again and again. Prints the component of its spin along that axis.
// The board's compiler must run with -std=gnu++20.
#include <tumble.h>

using namespace tumble::literals;

constexpr tumble::BodySpec box() {
    tumble::BodySpec spec = tumble::box(1_kg, {0.1_m, 0.2_m, 0.3_m});
    spec.angular_velocity = {0.05, 8, 0.05};  // rad/s
    return spec;
}

// The compiler sets the world up; its only body has the id 0.
constinit tumble::World<tumble::Scene> world = [] {
    tumble::World<tumble::Scene> made{tumble::Seconds{1, 256}};
    made.add(box());
    return made;
}();
constexpr tumble::BodyId id{0};

void setup() { Serial.begin(115200); }

void loop() {
    if (!world.step().ok()) Serial.println("the box left the range of its numbers");
    if (world.steps_taken() % 16 == 0) Serial.println(world.motion<float>(id).angular_velocity.y);
    delay(4);
}

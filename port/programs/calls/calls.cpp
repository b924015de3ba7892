// The calls by which a program controls a body and reads it, each as a function call_* of its own, whose cycles
// `measure` counts. Their vectors are numbers that the compiler does not know. TUMBLE_VARIANT is the number system.
//
// Prints a row with the number of rounds and a hash of all that was set and read, which every machine must agree on.
#include <tumble/tumble.hpp>

#include "../step/json_row.hpp"
#include "port.hpp"

using namespace tumble;
using namespace tumble::literals;

namespace {

constexpr std::uint64_t rounds = 32;
using N = NumbersOf<TUMBLE_VARIANT, NearRange>;

struct Controlled : Scene {
    using Numbers = N;
    static constexpr Features features{.control = true, .imu = true};
};
struct Free : Scene {
    using Numbers = N;
};
struct Kept : Scene {
    using Numbers = N;
    static constexpr Features features{
        .bodies = 2, .control = true, .script = true, .recording = true, .removal = true, .snapshots = true};
};

// Two moments differ, and the principal axes are not the user's.
constexpr BodySpec spec = box(0.25_kg, {0.2_m, 0.05_m, 0.15_m});

}  // namespace

// With names that other files could see, so that the compiler knows neither values nor who else writes them.
namespace inputs {
Vector3<float> a, b;
Quaternion<float> q;
Vector3<Real> real_a, real_b;
InputVector<N> prepared_a, prepared_b;
Pose<float> pose;
Motion<float> motion;
Imu<float> imu;
BodyId body;
std::uint8_t bytes[1024];
int size;
}  // namespace inputs

namespace {

using namespace inputs;

World<Controlled> world{Seconds{1, 256}, {.gravity = {0, -9.81, 0}}};
World<Free> free_world{Seconds{1, 256}, {.gravity = {0, -9.81, 0}}};
World<Kept> kept{Seconds{1, 256}, {.gravity = {0, -9.81, 0}}}, copy{kept};
Recorder<N, 8> recorder;

}  // namespace

// Each is a function that the compiler neither inlines nor splits.
#define CALL(name) extern "C" [[gnu::noinline]] void call_##name()

CALL(free_step) { (void)free_world.step(); }
CALL(step) { (void)world.step(); }
CALL(step_under_body_torque) { (void)world.step(); }
CALL(step_under_world_force) { (void)world.step(); }
CALL(step_under_body_force) { (void)world.step(); }
CALL(set_torque) { world.set_torque(body, a, Frame::body); }
CALL(set_world_force) { world.set_force(body, a, Frame::world); }
CALL(set_body_force) { world.set_force(body, a, Frame::body); }
CALL(set_gravity) { world.set_gravity(a); }
CALL(impulse_at_point) { world.apply_impulse(body, a, b, Frame::world); }
CALL(impulse_prepared) { world.apply_impulse(body, prepared_a, prepared_b, Frame::world); }
CALL(impulse_at_centre) { world.apply_impulse(body, a, {}, Frame::world); }
CALL(impulse_of_reals) { world.apply_impulse(body, real_a, real_b); }
CALL(pose_and_motion) {
    pose = world.pose<float>(body);
    motion = world.motion<float>(body);
}
CALL(pose_and_spin) {
    pose = world.pose<float>(body);
    motion.angular_velocity = world.motion<float>(body).angular_velocity;
}
CALL(imu) { imu = world.imu<float>(body); }
CALL(set_velocity) { world.set_velocity(body, a); }
CALL(set_angular_velocity) { world.set_angular_velocity(body, b); }
CALL(set_pose) { world.set_pose(body, a, q); }
CALL(recorded_torque) { kept.set_torque(body, a, Frame::body); }
CALL(scripted_step) { (void)copy.step(); }
CALL(copy) { copy = kept; }
CALL(save) { size = kept.save(bytes, sizeof bytes); }
CALL(restore) { size = static_cast<int>(copy.restore(bytes, size)); }
CALL(remove) { kept.remove(body); }
CALL(add) { body = kept.add(spec); }

namespace {

std::uint32_t seed = 1;
// In [-1, 1), 24 bits.
float number() {
    seed = seed * 1664525 + 1013904223;
    return static_cast<float>(static_cast<std::int32_t>(seed) >> 8) * 0x1p-23F;
}
Vector3<float> vector(float size) { return {size * number(), size * number(), size * number()}; }
Vector3<Real> real(const Vector3<float>& v) { return {Real{v.x}, Real{v.y}, Real{v.z}}; }

Hash hash;
void add(float value) { hash.add(std::bit_cast<std::uint32_t>(value)); }
void add(const Vector3<float>& v) {
    add(v.x);
    add(v.y);
    add(v.z);
}
void add(std::uint64_t value) {
    hash.add(static_cast<std::uint32_t>(value));
    hash.add(static_cast<std::uint32_t>(value >> 32));
}

void take_round() {
    const Vector3<float> none{};
    // Near rest at the origin, and turned anyhow.
    a = vector(0.5F);
    q = {1.0F + number(), vector(1.0F)};
    call_set_pose();
    a = vector(1.0F);
    b = vector(2.0F);
    call_set_velocity();
    call_set_angular_velocity();
    call_free_step();
    world.set_force(body, none, Frame::world);
    world.set_torque(body, none, Frame::body);
    call_step();
    a = vector(0.01F);
    call_set_torque();
    call_step_under_body_torque();
    world.set_torque(body, none, Frame::body);
    a = vector(1.0F);
    call_set_world_force();
    call_step_under_world_force();
    call_set_body_force();
    call_step_under_body_force();
    call_imu();
    a = vector(0.01F);
    b = vector(0.1F);
    real_a = real(a);
    real_b = real(b);
    prepared_a = a;
    prepared_b = b;
    call_impulse_at_point();
    call_impulse_prepared();
    call_impulse_of_reals();
    call_impulse_at_centre();
    call_pose_and_spin();
    call_pose_and_motion();
    a = {b.x, -9.81F, b.z};
    call_set_gravity();
    add(world.gravity().as<float>());
    a.x = a.z = 0;
    world.set_gravity(a);
    add(pose.position);
    add(pose.orientation.w);
    add(pose.orientation.v);
    add(motion.velocity);
    add(motion.angular_velocity);
    add(imu.specific_force);
    add(imu.angular_velocity);
    add(world.hash());
}

// The program's second world: what it records and saves is what it did.
bool take_kept_round() {
    call_copy();
    recorder.clear();
    kept.record(&recorder);
    a = vector(0.01F);
    call_recorded_torque();
    (void)kept.step();
    kept.record(nullptr);
    copy.set_script(recorder.script());
    call_scripted_step();
    if (copy.hash() != kept.hash()) return false;
    call_save();
    (void)kept.step();
    call_restore();
    if (size != 0) return false;
    (void)copy.step();
    if (copy.hash() != kept.hash()) return false;
    kept.record(&recorder);
    recorder.clear();
    call_remove();
    kept.record(nullptr);
    call_add();
    add(kept.hash());
    return kept.contains(body);
}

}  // namespace

int main() {
    port::init();
    body = world.add(spec);
    (void)free_world.add(spec);
    for (std::uint64_t round = 0; round < rounds; ++round) take_round();
    body = kept.add(spec);
    for (std::uint64_t round = 0; round < rounds; ++round)
        if (!take_kept_round()) return 1;
    port::JsonRow row;
    row.add("core", port::core());
    row.add("numbers", N::name);
    row.add("carry", N::carry);
    row.add("tumble_bits", static_cast<std::uint64_t>(TUMBLE_BITS));
    row.add("rounds", rounds);
    row.add("status_bits", static_cast<std::uint64_t>(world.status().bits | kept.status().bits));
    row.add_hex("state_hash", hash.value());
    row.write();
    return 0;
}

// A double pendulum that keeps its energy. Two rods on hinges are let go aslant and never repeat their motion. The
// error of the method swings with them and has no trend: the mean energy of the last tenth of the steps is that of the
// first. The program prints both means and the hash of the end, which is the same on every machine.
#include <tumble/tumble.hpp>

#include "port.hpp"

using namespace tumble::literals;

namespace {

#ifdef TUMBLE_EXAMPLE_STEPS
constexpr int steps = TUMBLE_EXAMPLE_STEPS;  // the tests take fewer
#else
constexpr int steps = 1'000'000;  // 65 minutes
#endif

struct Pendulum : tumble::Scene {
    using Numbers = tumble::Q32<tumble::NearRange>;
    static constexpr tumble::Seconds step{1, 256};
    // All of its joints are hinges.
    static constexpr tumble::Features features{
        .bodies = 2, .joints = 2, .balls = false, .fixed_joints = false, .sliders = false, .universals = false};
};
constexpr tumble::BodyId upper{0}, lower{1};  // in the order of add()
// The compiler sets it up, so the firmware has no code for that.
constinit tumble::World<Pendulum> world = [] {
    tumble::World<Pendulum> start{{.gravity = {0, -9.81, 0}}};
    const tumble::RealQuat lean = tumble::rotation_about({0, 0, 1}, 57_deg),
                           more = tumble::rotation_about({0, 0, 1}, 86_deg);
    const tumble::RealVec3 half{0, -0.5, 0}, knee = rotate(lean, half) * 2;
    tumble::BodySpec rod = tumble::box(1_kg, {0.1_m, 1_m, 0.1_m});
    rod.orientation = lean;
    rod.position = rotate(lean, half);
    start.add(rod);
    rod.orientation = more;
    rod.position = knee + rotate(more, half);
    start.add(rod);
    start.add(tumble::HingeSpec{.body = upper});
    start.add(tumble::HingeSpec{.body = lower, .to_body = upper, .anchor = knee});
    return start;
}();
// What the tests measure.
[[gnu::noinline]] bool swing_once() { return world.step().ok(); }

tumble::Real energy() {
    tumble::Real sum{};
    for (const tumble::BodyId rod : {upper, lower})
        sum += world.kinetic_energy(rod).to_real() + world.potential_energy(rod).to_real();
    return sum;
}

// An energy in J with six decimals.
void write(const char* name, tumble::Real energy) {
    char line[24];
    char* first = line + sizeof line;
    *--first = '\n';
    *--first = 'J';
    *--first = ' ';
    std::int64_t micro = (energy * 1'000'000).to_fixed(0, 64);
    const bool is_negative = micro < 0;
    if (is_negative) micro = -micro;
    for (int digit = 0; digit < 7 || micro != 0; ++digit) {
        if (digit == 6) *--first = '.';
        *--first = static_cast<char>('0' + micro % 10);
        micro /= 10;
    }
    if (is_negative) *--first = '-';
    tumble::port::write(name);
    tumble::port::write({first, static_cast<std::size_t>(line + sizeof line - first)});
}

}  // namespace

int main() {
    tumble::port::init();
    constexpr int tenth = steps / 10;
    const tumble::Real start = energy(), scale = 2 * 9.81 * 2;  // m g l, of both rods
    tumble::Real first{}, last{};
    for (int step = 0; step < steps; ++step) {
        if (!swing_once()) return 1;
        const bool is_first = step < tenth, is_last = step >= steps - tenth;
        if (!is_first && !is_last) continue;
        const tumble::Real now = energy();
        if (abs(now - start) > scale * 0.001) return 2;
        (is_first ? first : last) += now * (tumble::Real{1} / tenth);
    }
    write("first tenth: ", first);
    write("last tenth: ", last);
    tumble::port::write_hash(world.hash());
    return abs(last - first) < scale * (steps < 100'000 ? 0.001 : 0.00005) ? 0 : 3;
}

// Where the bodies of scenes in bench/laws are known to be. Every program that measures these scenes compares with it.
#pragma once

#include <cmath>
#include <utility>

namespace tumble::bench {

// m, horizontal.
struct KnownPlace {
    long double x, z;
};
// The centre of the leaning hoop, which starts at (0, 0, radius) with a speed along x (m, m/s, s).
[[nodiscard]] inline KnownPlace on_the_circle(long double radius, long double speed, long double time) {
    const long double angle = speed / radius * time;
    return {radius * std::sin(angle), radius * std::cos(angle)};
}
// The ball on a turntable of this rate (rad/s), which starts at (x, 0, 0) with a speed along z: it turns by 2/7 of it.
[[nodiscard]] inline KnownPlace on_the_circle_on_a_table(long double x, long double speed, long double table_rate,
                                                         long double time) {
    const long double rate = 2 * table_rate / 7, angle = rate * time;
    return {x + speed / rate * (1 - std::cos(angle)), speed / rate * std::sin(angle)};
}
// Of the break, by index: the bodies that are each other's image across z = 0. A body on it is its own.
inline constexpr std::pair<int, int> mirrored[] = {{0, 0}, {1, 1}, {2, 3}, {4, 4}, {5, 6}};

}  // namespace tumble::bench

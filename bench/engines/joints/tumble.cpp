// This kernel in the number system of TUMBLE_NUMBERS: a world with as many bodies and joints as each mechanism has.
#include "tumble_worlds.hpp"

void tumble::bench::add_tumble_joints(Contenders& contenders) {
    add_tumble<NumbersOf<TUMBLE_NUMBERS, RoomRange>, integrators::Verlet>(contenders, [](auto&& f) {
        f.template operator()<Features{.bodies = 1, .joints = 1}>();
        f.template operator()<Features{.bodies = 2, .joints = 2}>();
        f.template operator()<Features{.bodies = 6, .joints = 6}>();
        f.template operator()<Features{.bodies = 10, .joints = 10}>();
    });
}

// This kernel on the scenes of contacts.cpp, in the number system of TUMBLE_NUMBERS: a world with exactly the features
// of each scene.
#include "tumble_worlds.hpp"

void tumble::bench::add_tumble_contacts(Contenders& contenders) {
    add_tumble<NumbersOf<TUMBLE_NUMBERS, NearRange>, integrators::Verlet>(contenders, [](auto&& f) {
        // Stack and pyramid, cradle, break, turntable, leaning hoop, incline.
        f.template operator()<Features{
            .bodies = 10, .planes = 1, .pairs = true, .boxes = true, .friction = true, .bounded_steps = true}>();
        f.template operator()<Features{.bodies = 5, .planes = 3, .pairs = true}>();
        f.template operator()<Features{.bodies = 7, .pairs = true}>();
        f.template
        operator()<Features{.bodies = 2, .pairs = true, .boxes = true, .friction = true, .turntables = true}>();
        f.template operator()<Features{.bodies = 1, .planes = 1, .round_shapes = true, .friction = true}>();
        f.template operator()<Features{.bodies = 1, .planes = 1, .boxes = true, .friction = true}>();
    });
}

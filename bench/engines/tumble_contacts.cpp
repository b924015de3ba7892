// This kernel on the scenes of contacts.cpp: a world with exactly the features of each scene.
#include "contacts.hpp"
#include "host/tumble_worlds.hpp"

namespace {

using namespace tumble;
using namespace tumble::bench;

using Numbers = NumbersOf<TUMBLE_NUMBERS, NearRange>;

// Calls f<features>() for the worlds of the scenes.
template <class F>
void for_each_world_of_contacts(F&& f) {
    // Stack and pyramid, cradle, break, turntable, leaning hoop, incline.
    f.template operator()<Features{.bodies = 10, .planes = 1, .pairs = true, .boxes = true, .friction = true}>();
    f.template operator()<Features{.bodies = 5, .planes = 3, .pairs = true}>();
    f.template operator()<Features{.bodies = 7, .pairs = true}>();
    f.template operator()<Features{.bodies = 2, .pairs = true, .boxes = true, .friction = true, .turntables = true}>();
    f.template operator()<Features{.bodies = 1, .planes = 1, .round_shapes = true, .friction = true}>();
    f.template operator()<Features{.bodies = 1, .planes = 1, .boxes = true, .friction = true}>();
}

std::unique_ptr<Runner> make(const Problem& problem) {
    std::unique_ptr<Runner> made;
    for_each_world_of_contacts([&]<Features features>() {
        if (problem.features == features)
            made = std::make_unique<TumbleRunner<Numbers, integrators::Verlet, features>>(problem);
    });
    if (!made) throw std::runtime_error{"no world of this kernel has the features of '" + problem.name + "'"};
    return made;
}

}  // namespace

void tumble::bench::add_tumble_contacts(std::vector<Contender>& contenders) {
    contenders.push_back({"tumble", "", integrators::Verlet::name, Numbers::name, Numbers::carry, make});
}

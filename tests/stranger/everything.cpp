// Every feature and every method of the number system STRANGER_NUMBERS, instantiated; and what a user may call. Worlds
// of bodies that rotate and worlds of nothing but point masses; with STRANGER_POINTS the latter alone, with
// STRANGER_METHOD one of the former by this method.
#include <tumble/tumble.hpp>

namespace {

#define STRANGER_TEXT_OF(name) #name
#define STRANGER_TEXT(name) STRANGER_TEXT_OF(name)
using Numbers = tumble::NumbersOf<STRANGER_TEXT(STRANGER_NUMBERS), tumble::RoomRange>;
inline constexpr tumble::Features everything =
    tumble::Features{.bodies = 3, .planes = 2, .springs = 2, .joints = 2}.with_everything();

inline constexpr tumble::Features points = [] {
    tumble::Features features = everything;
    features.rotation = false;
    features.joints = 0;
    return features;
}();

#ifndef STRANGER_POINTS
template <class Method>
tumble::Status use_bodies() {
    static tumble::World<tumble::SceneOf<Numbers, Method, everything>> world{tumble::Seconds{1, 256}};
    using namespace tumble::literals;
    const auto box = world.add(tumble::box(0.25_kg, {0.2_m, 0.05_m, 0.2_m}));
    if (box) world.apply_impulse(*box, {1, 0, 0}, {0, tumble::Real{0.1}, 0});
    if (box) (void)world.add(tumble::HingeSpec{.body = *box, .anchor = {1, 0, 0}});
    return world.step();
}
#endif

template <class Method>
tumble::Status use_points() {
    static tumble::World<tumble::SceneOf<Numbers, Method, points>> world{tumble::Seconds{1, 256}};
    const auto point = world.add(tumble::point_mass(1));
    if (point) world.apply_impulse(*point, {1, 0, 0});
    return world.step();
}

#ifdef STRANGER_METHOD
// Set up by the compiler, which it is in fixed point.
constinit auto prepared = [] {
    tumble::World<tumble::SceneOf<Numbers, tumble::integrators::Verlet, points>> world{tumble::Seconds{1, 256}};
    (void)world.add(tumble::point_mass(1));
    return world;
}();
#endif

}  // namespace

tumble::Status use_everything() {
    tumble::Status status;
#ifdef STRANGER_METHOD
    status = prepared.step();
    status = use_bodies<tumble::integrators::STRANGER_METHOD>();
#else
#ifndef STRANGER_POINTS
    tumble::Integrators::for_each_in<Numbers>([&]<class Method>() { status = use_bodies<Method>(); });
#endif
    tumble::Integrators::for_each_in<Numbers>([&]<class Method>() { status = use_points<Method>(); });
#endif
    return status;
}

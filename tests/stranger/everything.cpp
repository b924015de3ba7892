// Every feature and every method of the number system STRANGER_NUMBERS, instantiated; and what a user may call.
#include <tumble/tumble.hpp>

namespace {

#define STRANGER_TEXT_OF(name) #name
#define STRANGER_TEXT(name) STRANGER_TEXT_OF(name)
using Numbers = tumble::NumbersOf<STRANGER_TEXT(STRANGER_NUMBERS), tumble::RoomRange>;
inline constexpr tumble::Features everything =
    tumble::Features{.bodies = 3, .planes = 2, .springs = 2}.with_everything();

template <class Method>
tumble::Status use() {
    static tumble::World<tumble::SceneOf<Numbers, Method, everything>> world{tumble::Seconds{1, 256}};
    using namespace tumble::literals;
    const auto box = world.add(tumble::box(0.25_kg, {0.2_m, 0.05_m, 0.2_m}));
    if (box) world.apply_impulse(*box, {1, 0, 0}, {0, tumble::Real{0.1}, 0});
    return world.step();
}

}  // namespace

tumble::Status use_everything() {
    tumble::Status status;
    tumble::Integrators::for_each_in<Numbers>([&]<class Method>() { status = use<Method>(); });
    return status;
}

// Replays every shipped scene with every integrator of a list that runs in the number system TUMBLE_VARIANT, and prints
// a line each: scene, number system, integrator, steps, state hash. The same source for the host and for every core.
// Worlds have every feature compiled in that the scenes could use; other tests show that a minimal world gives the same
// bits. With TUMBLE_CONTACT_SCENES it replays the first steps of the contact scenes instead, whose worlds are larger
// than a stack: as many as make 4096 steps of a body.
#pragma once

#include <tumble/numbers/variants.hpp>
#include <tumble/replay.hpp>
#include <tumble/tumble.hpp>

#ifdef TUMBLE_CONTACT_SCENES
#include "contact_scenes.hpp"
#else
#include "all_scenes.hpp"
#endif
#include "port.hpp"

namespace {

#ifdef TUMBLE_CONTACT_SCENES
inline constexpr bool contact_scenes = true;
inline constexpr int room = 27;
#define TUMBLE_STORAGE static
#else
inline constexpr bool contact_scenes = false;
inline constexpr int room = 4;
#define TUMBLE_STORAGE
#endif

template <class System, class Method>
struct Everything : tumble::Scene {
    using Numbers = System;
    using Integrator = Method;
    static constexpr int bodies = room, planes = contact_scenes ? 6 : 4, springs = 4;
    static constexpr int near_pairs = contact_scenes ? 0 : 2;  // the smallest core has room for few
    static constexpr bool drag = true, gravitation = true, forces = true, script = true, boxes = true, friction = true;
    static constexpr bool pairs = contact_scenes, cylinders = contact_scenes, sleep = contact_scenes,
                          turntables = contact_scenes, contact_springs = contact_scenes;
};

void write_number(std::uint64_t value, unsigned base, int width) {
    char digits[20];
    int first = 20;
    do {
        digits[--first] = "0123456789abcdef"[value % base];
        value /= base;
    } while (value != 0 || 20 - first < width);
    tumble::port::write(digits + first, static_cast<std::size_t>(20 - first));
}

// Not inlined: the stack holds the worlds of one scene at a time.
template <class Method, class Scene>
[[gnu::noinline]] void replay_scene(const char* variant) {
    using Numbers =
        typename tumble::variants::TUMBLE_VARIANT::template Numbers<typename Scene::Features::Numbers::Range>;
    using Config = Everything<Numbers, Method>;
    TUMBLE_STORAGE tumble::Replay<Config, Scene> replay;
    static_assert(Scene::Features::bodies <= Config::bodies && Scene::Features::planes <= Config::planes &&
                  Scene::Features::springs <= Config::springs);
    constexpr std::uint32_t most = 4096u / static_cast<std::uint32_t>(Scene::Features::bodies);
    constexpr std::uint32_t steps = contact_scenes && most < Scene::steps ? most : Scene::steps;
    while (replay.world().steps_taken() < steps && replay.step().ok()) {}
    namespace port = tumble::port;
    port::write(Scene::name);
    port::write(" ");
    port::write(variant);
    port::write(" ");
    port::write(Method::name);
    port::write(" ");
    write_number(replay.world().steps_taken(), 10, 1);
    port::write(" ");
    write_number(replay.world().hash(), 16, 16);
    port::write("\n");
}

#define TUMBLE_NAME_OF(variant) TUMBLE_TEXT(variant)
#define TUMBLE_TEXT(variant) #variant

// The whole program.
template <class Methods>
int replay_all() {
    tumble::port::init();
    using Numbers = tumble::variants::TUMBLE_VARIANT::Numbers<tumble::RoomRange>;  // of any range
    Methods::template for_each_in<Numbers>([]<class Method>() {
        for_each_scene([]<class Scene>() { replay_scene<Method, Scene>(TUMBLE_NAME_OF(TUMBLE_VARIANT)); });
    });
    return 0;
}

}  // namespace

// Replays every shipped scene with every integrator of a list that runs in the number system TUMBLE_VARIANT, and prints
// a line each: scene, number system, integrator, steps, state hash. The same source for the host and for every core.
// Worlds have every feature compiled in that the scenes could use, but for those of point masses alone; other tests
// show that a minimal world gives the same bits. With TUMBLE_SUITE, a header with scenes, it replays the first steps of
// these instead, whose worlds are larger than a stack: as many as make 4096 steps of a body. TUMBLE_MOST_STEPS ends
// every scene after so many steps.
#pragma once

#include <tumble/replay.hpp>
#include <tumble/tumble.hpp>

#ifdef TUMBLE_SUITE
#include TUMBLE_SUITE
#else
#include "all_scenes.hpp"
#endif
#include "port.hpp"

#include <cstddef>
#include <new>

#include "../write_number.hpp"

#define TUMBLE_NAME_OF(variant) TUMBLE_TEXT(variant)
#define TUMBLE_TEXT(variant) #variant

namespace {

#ifdef TUMBLE_SUITE
inline constexpr bool is_suite = true;
#else
inline constexpr bool is_suite = false;
#endif

// What one scene or another needs, of those with a body that rotates.
inline constexpr tumble::Features all_features = [] {
    tumble::Features all;
    for_each_scene([&]<class Scene>() {
        if (Scene::Config::features.rotation) all = all.united_with(Scene::Config::features);
    });
    all.round_shapes = true;            // of a scene without a plane, which others have
    if (!is_suite) all.near_pairs = 2;  // the smallest core has room for few
    return all;
}();

#ifndef TUMBLE_MOST_STEPS
#define TUMBLE_MOST_STEPS 0xFFFF'FFFF
#endif
inline constexpr std::uint32_t most_steps = TUMBLE_MOST_STEPS;

// One of point masses alone has a world without rotation: its bits are those of the simulator, which has all.
template <class Scene>
inline constexpr tumble::Features features_of =
    Scene::Config::features.rotation ? all_features : Scene::Config::features;
template <class Method, class Scene>
using ReplayOf = tumble::Replay<
    tumble::SceneOf<tumble::NumbersOf<TUMBLE_NAME_OF(TUMBLE_VARIANT), typename Scene::Config::Numbers::Range>, Method,
                    features_of<Scene>>,
    Scene>;

#ifdef TUMBLE_SUITE
// The memory of one scene after the other.
template <class Method>
inline constexpr std::size_t largest_replay = [] {
    std::size_t most = 0;
    for_each_scene([&]<class Scene>() {
        if (sizeof(ReplayOf<Method, Scene>) > most) most = sizeof(ReplayOf<Method, Scene>);
    });
    return most;
}();
template <class Method>
alignas(std::max_align_t) inline unsigned char memory[largest_replay<Method>];
#endif

// Not inlined: the stack holds the worlds of one scene at a time.
template <class Method, class Scene>
[[gnu::noinline]] void replay_scene(const char* variant) {
    using Replay = ReplayOf<Method, Scene>;
#ifdef TUMBLE_SUITE
    Replay& replay = *new (memory<Method>) Replay;
#else
    Replay replay;
#endif
    constexpr std::uint32_t most =
        is_suite ? 4096u / static_cast<std::uint32_t>(Scene::Config::features.bodies) : most_steps;
    constexpr std::uint32_t steps = most < Scene::steps ? most : Scene::steps;
    while (replay.world().steps_taken() < steps && replay.step().ok()) {}
    namespace port = tumble::port;
    for (const char* word : {Scene::name, variant, Method::name}) {
        port::write(word);
        port::write(" ");
    }
    write_number(replay.world().steps_taken(), 10, 1);
    port::write(" ");
    write_number(replay.world().hash(), 16, 16);
    port::write("\n");
}

// The whole program.
template <class Methods>
int replay_all() {
    tumble::port::init();
    using Numbers = tumble::NumbersOf<TUMBLE_NAME_OF(TUMBLE_VARIANT), tumble::RoomRange>;  // of any range
    Methods::template for_each_in<Numbers>([]<class Method>() {
        for_each_scene([]<class Scene>() { replay_scene<Method, Scene>(TUMBLE_NAME_OF(TUMBLE_VARIANT)); });
    });
    return 0;
}

}  // namespace

// Box2D-Lite, in a plane: boxes only.
#pragma once

#include "scene.hpp"

#include <cfloat>  // its headers use FLT_MAX

#include <box2d-lite/World.h>

#include <box2d-lite/Body.h>

namespace tumble::bench {

class Engine {
public:
    static constexpr const char* name = "Box2D-Lite";
    static constexpr const char* numbers = "f32";
    static constexpr bool carry = false;

    Engine() {
        for (std::size_t i = 0; i < scene_slabs.size(); ++i)
            add(slabs_[i], scene_slabs[i].centre, scene_slabs[i].half, FLT_MAX);
        for (std::size_t i = 0; i < body_count; ++i)
            add(bodies_[i], scene_bodies[i].position, scene_bodies[i].half, scene_bodies[i].mass);
    }
    void step() { world_.Step(step_seconds); }
    [[nodiscard]] Vec position(std::size_t i) const { return {bodies_[i].position.x, bodies_[i].position.y, 0}; }

private:
    void add(::Body& body, const Vec& position, const Vec& half, float mass) {
        body.Set({2 * half.x, 2 * half.y}, mass);
        body.friction = friction;
        body.position.Set(position.x, position.y);
        world_.Add(&body);
    }

    ::World world_{{gravity.x, gravity.y}, TUMBLE_COUNT};
    std::array<::Body, scene_slabs.size()> slabs_;
    std::array<::Body, body_count> bodies_;
};

}  // namespace tumble::bench

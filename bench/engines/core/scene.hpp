// The scene of a program of bench/engines/core, in the float that engines read. All of it is constant, so its
// conversion takes no flash.
#pragma once

#include <tumble/replay.hpp>

#include TUMBLE_SCENE_HEADER

#include <array>
#include <cstddef>
#include <cstdint>

namespace tumble::bench {

using Recorded = scenes::TUMBLE_SCENE;

struct Vec {
    float x = 0, y = 0, z = 0;
};
// A unit quaternion, from the axes of a body to the world.
struct Turn {
    float w = 1, x = 0, y = 0, z = 0;
};
[[nodiscard]] constexpr Vec vec(const RealVec3& v) { return {v.x.to_float(), v.y.to_float(), v.z.to_float()}; }

// A ball, or a box.
struct SceneBody {
    bool is_ball;
    float radius;  // m, of a ball
    Vec half;      // m, half of a box's edges
    Vec position;  // m
    float mass;    // kg
    Turn turn;
};
inline constexpr auto scene_bodies = [] {
    std::array<SceneBody, Recorded::bodies.size()> all{};
    for (std::size_t i = 0; i < all.size(); ++i) {
        const BodySpec& body = Recorded::bodies[i];
        const Vec size = vec(body.shape.size);
        all[i] = {body.shape.kind == ShapeKind::sphere,
                  size.x,
                  {size.x / 2, size.y / 2, size.z / 2},
                  vec(body.position),
                  body.mass.to_float(),
                  {body.orientation.w.to_float(), body.orientation.v.x.to_float(), body.orientation.v.y.to_float(),
                   body.orientation.v.z.to_float()}};
    }
    return all;
}();
inline constexpr std::size_t body_count = scene_bodies.size();

// A plane along axes of the world, for engines that have none: a fixed box with one face on it, 2 m thick.
struct Slab {
    Vec normal, centre, half;  // m
    float offset;              // m, of the plane
};
inline constexpr auto scene_slabs = [] {
    std::array<Slab, Recorded::planes.size()> all{};
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Vec n = vec(Recorded::planes[i].normal);
        const float offset = Recorded::planes[i].offset.to_float(), back = -offset - 1;
        const auto half = [](float along) { return along == 0 ? 50.0f : 1.0f; };
        all[i] = {n, {back * n.x, back * n.y, back * n.z}, {half(n.x), half(n.y), half(n.z)}, offset};
    }
    return all;
}();

// An impulse of the scene at the centre of a body.
struct Push {
    std::uint32_t step;  // before which it acts, from 0
    std::size_t body;
    Vec impulse;  // N s
};
// Those of a scene whose events, if it has any, are impulses.
template <class Data>
constexpr auto pushes_of() {
    if constexpr (requires { Data::events; }) {
        std::array<Push, Data::events.size()> all{};
        for (std::size_t i = 0; i < all.size(); ++i) {
            const EventSpec& event = Data::events[i];
            const double steps = (event.time / Data::step.value).to_double();
            all[i] = {static_cast<std::uint32_t>(steps + 0.5), static_cast<std::size_t>(int{event.body}),
                      vec(event.value)};
        }
        return all;
    } else return std::array<Push, 0>{};
}
inline constexpr auto scene_pushes = pushes_of<Recorded>();

inline constexpr Vec gravity = vec(Recorded::world.gravity);  // m/s^2
inline constexpr float friction = Recorded::world.contact.friction.to_float();
inline constexpr float restitution = Recorded::world.contact.restitution.to_float();
inline constexpr float restitution_threshold = Recorded::world.contact.restitution_threshold.to_float();  // m/s
inline constexpr float step_seconds = Recorded::step.value.to_float();

}  // namespace tumble::bench

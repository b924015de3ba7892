// How deep the bodies of a scene are in each other and in its planes, by a judge of its own: the separating axis test
// of boxes in float (Gottschalk, Lin and Manocha 1996). It runs outside the timed step.
#pragma once

#include "scene.hpp"

#include <cmath>

namespace tumble::bench {

// Where a body is: its centre, m, and the unit vectors of its axes.
struct Placed {
    Vec at;
    std::array<Vec, 3> axis;
};
[[nodiscard]] inline Placed placed(const Vec& at, const Turn& q) {
    const float w = q.w, x = q.x, y = q.y, z = q.z;
    return {at,
            {Vec{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
             Vec{2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
             Vec{2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}}};
}
[[nodiscard]] inline float dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
// How far a body reaches from its centre along a unit vector, m.
[[nodiscard]] inline float reach(const SceneBody& body, const Placed& place, const Vec& along) {
    if (body.is_ball) return body.radius;
    const std::array<float, 3> half{body.half.x, body.half.y, body.half.z};
    float sum = 0;
    for (std::size_t i = 0; i < 3; ++i) sum += half[i] * std::abs(dot(place.axis[i], along));
    return sum;
}
[[nodiscard]] inline float overlap(const Slab& slab, const SceneBody& body, const Placed& place) {
    return reach(body, place, slab.normal) - dot(slab.normal, place.at) - slab.offset;
}
// m; negative where the bodies are apart. Two balls, or two boxes.
[[nodiscard]] inline float overlap(const SceneBody& a, const Placed& at_a, const SceneBody& b, const Placed& at_b) {
    const Vec between{at_b.at.x - at_a.at.x, at_b.at.y - at_a.at.y, at_b.at.z - at_a.at.z};
    if (a.is_ball && b.is_ball) return a.radius + b.radius - std::sqrt(dot(between, between));
    float least = 1e9f;
    const auto look_along = [&](const Vec& axis) {
        const float here = reach(a, at_a, axis) + reach(b, at_b, axis) - std::abs(dot(between, axis));
        if (here < least) least = here;
    };
    for (const Vec& axis : at_a.axis) look_along(axis);
    for (const Vec& axis : at_b.axis) look_along(axis);
    for (const Vec& p : at_a.axis)
        for (const Vec& q : at_b.axis) {
            const Vec n{p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
            const float size = std::sqrt(dot(n, n));
            if (size < 1e-2f) continue;  // nearly parallel edges: the faces tell
            const float part = 1 / size;
            look_along({n.x * part, n.y * part, n.z * part});
        }
    return least;
}
// The deepest of all, m; 0 where nothing overlaps.
template <class Engine>
[[nodiscard]] float deepest_overlap(const Engine& engine) {
    std::array<Placed, body_count> places;
    for (std::size_t i = 0; i < body_count; ++i) places[i] = placed(engine.position(i), engine.turn(i));
    float most = 0;
    for (std::size_t i = 0; i < body_count; ++i) {
        for (const Slab& slab : scene_slabs) most = std::fmax(most, overlap(slab, scene_bodies[i], places[i]));
        for (std::size_t k = 0; k < i; ++k)
            most = std::fmax(most, overlap(scene_bodies[i], places[i], scene_bodies[k], places[k]));
    }
    return most;
}

}  // namespace tumble::bench

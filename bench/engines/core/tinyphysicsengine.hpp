// TinyPhysicsEngine: soft bodies of spheres and springs in whole numbers. A box is eight spheres. Its velocities are
// whole units a step, and so is gravity: 6 units of 1/2048 m at 1/60 s are 10.5 m/s^2 in place of 9.81. At 1/256 s
// gravity would be 0. Nothing sleeps.
#pragma once

#include "scene.hpp"

#include <cstdint>

#include <tinyphysicsengine.h>

namespace tumble::bench {

// A metre is 2048 units.
[[nodiscard]] constexpr TPE_Unit units(float metres) {
    return static_cast<TPE_Unit>(metres * 2048 + (metres < 0 ? -0.5f : 0.5f));
}
[[nodiscard]] inline float metres(TPE_Unit units) { return static_cast<float>(units) / 2048; }

class Engine {
public:
    static constexpr const char* name = "TinyPhysicsEngine";
    static constexpr const char* numbers = "int32";
    static constexpr bool carry = false;

    Engine() {
        for (std::size_t i = 0; i < body_count; ++i) add(i);
        TPE_worldInit(&world_, bodies_.data(), body_count, environment<scene_slabs.size()>);
    }
    void step() {
        constexpr TPE_Unit fall = units(-gravity.y * step_seconds * step_seconds);
        static_assert(fall > 0, "gravity is less than a unit a step");
        for (TPE_Body& body : bodies_) TPE_bodyApplyGravity(&body, fall);
        TPE_worldStep(&world_);
    }
    [[nodiscard]] Vec position(std::size_t i) const {
        const TPE_Vec3 at = TPE_bodyGetCenterOfMass(&bodies_[i]);
        return {metres(at.x), metres(at.y), metres(at.z)};
    }
    // A ball is a single sphere.
    void push(std::size_t i, const Vec& impulse) {
        const float mass = scene_bodies[i].mass;
        TPE_bodyAccelerate(&bodies_[i], {units(impulse.x / mass * step_seconds), units(impulse.y / mass * step_seconds),
                                         units(impulse.z / mass * step_seconds)});
    }

private:
    static constexpr TPE_Unit radius = 512;  // of the spheres of a box; those of 1 m leave no gap

    void add(std::size_t i) {
        const SceneBody& body = scene_bodies[i];
        auto& joints = joints_[i];
        if (body.is_ball) {
            joints[0] = TPE_joint({0, 0, 0}, units(body.radius));
            TPE_bodyInit(&bodies_[i], joints.data(), 1, springs_[i].data(), 0, TPE_F);
        } else {
            const auto between = [](float half) { return units(2 * half) - 2 * radius; };
            TPE_makeBox(joints.data(), springs_[i].data(), between(body.half.x), between(body.half.z),
                        between(body.half.y), radius);
            TPE_bodyInit(&bodies_[i], joints.data(), 8, springs_[i].data(), 16, TPE_F);
        }
        TPE_bodyMoveBy(&bodies_[i], {units(body.position.x), units(body.position.y), units(body.position.z)});
        bodies_[i].friction = static_cast<TPE_UnitReduced>(friction * TPE_F);
        bodies_[i].elasticity = static_cast<TPE_UnitReduced>(restitution * TPE_F);
        bodies_[i].flags |= TPE_BODY_FLAG_ALWAYS_ACTIVE;
    }
    // What is behind a plane of the scene. The ground has a cheaper function.
    template <std::size_t plane>
    static TPE_Vec3 behind(TPE_Vec3 point) {
        constexpr const Slab& slab = scene_slabs[plane];
        constexpr Vec n = slab.normal;
        constexpr TPE_Unit x = units(-slab.offset * n.x), y = units(-slab.offset * n.y), z = units(-slab.offset * n.z);
        if constexpr (n.y == 1) return TPE_envGround(point, y);
        else return TPE_envHalfPlane(point, {x, y, z}, {scaled(n.x), scaled(n.y), scaled(n.z)});
    }
    static constexpr TPE_Unit scaled(float unit) { return static_cast<TPE_Unit>(unit * TPE_F); }
    // One plane, or three.
    template <std::size_t planes>
    static TPE_Vec3 environment(TPE_Vec3 point, TPE_Unit) {
        if constexpr (planes == 1) {
            return behind<0>(point);
        } else {
            static_assert(planes == 3);
            TPE_ENV_START(behind<planes - 3>(point), point)
            TPE_ENV_NEXT(behind<planes - 2>(point), point)
            TPE_ENV_NEXT(behind<planes - 1>(point), point)
            TPE_ENV_END
        }
    }

    TPE_World world_;
    std::array<TPE_Body, body_count> bodies_;
    std::array<std::array<TPE_Joint, 8>, body_count> joints_;
    std::array<std::array<TPE_Connection, 16>, body_count> springs_;
};

}  // namespace tumble::bench

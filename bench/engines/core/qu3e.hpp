// qu3e: boxes only. Nothing sleeps, and nothing is damped.
#pragma once

#include "scene.hpp"

#include <q3.h>

namespace tumble::bench {

class Engine {
public:
    static constexpr const char* name = "qu3e";
    static constexpr const char* numbers = "f32";
    static constexpr bool carry = false;

    Engine() {
        scene_.SetAllowSleep(false);
        for (const Slab& slab : scene_slabs) add(eStaticBody, slab.centre, slab.half, 0);
        for (std::size_t i = 0; i < body_count; ++i) {
            const SceneBody& body = scene_bodies[i];
            bodies_[i] = add(eDynamicBody, body.position, body.half, body.mass);
        }
    }
    void step() { scene_.Step(); }
    [[nodiscard]] Vec position(std::size_t i) const {
        const q3Vec3 at = bodies_[i]->GetTransform().position;
        return {at.x, at.y, at.z};
    }

private:
    q3Body* add(q3BodyType type, const Vec& position, const Vec& half, float mass) {
        q3BodyDef def;
        def.bodyType = type;
        def.position.Set(position.x, position.y, position.z);
        def.allowSleep = false;
        def.angularDamping = 0;
        q3Body* body = scene_.CreateBody(def);
        q3BoxDef box;
        q3Transform place;
        q3Identity(place);
        box.Set(place, {2 * half.x, 2 * half.y, 2 * half.z});
        box.SetRestitution(restitution);
        box.SetFriction(friction);
        box.SetDensity(mass / (8 * half.x * half.y * half.z));
        body->AddBox(box);
        return body;
    }

    q3Scene scene_{step_seconds, {gravity.x, gravity.y, gravity.z}, TUMBLE_COUNT};
    std::array<q3Body*, body_count> bodies_;
};

}  // namespace tumble::bench

// Box2D of version 3, in a plane: spheres as circles and boxes as polygons. One thread; nothing sleeps.
#pragma once

#include "scene.hpp"

#include <box2d/box2d.h>

namespace tumble::bench {

class Engine {
public:
    static constexpr const char* name = "Box2D";
    static constexpr const char* numbers = "f32";
    static constexpr bool carry = false;

    Engine() {
        b2WorldDef world = b2DefaultWorldDef();
        world.gravity = {gravity.x, gravity.y};
        world.restitutionThreshold = restitution_threshold;
        world.enableSleep = false;
        world_ = b2CreateWorld(&world);
        for (const Slab& slab : scene_slabs) add(b2_staticBody, slab.centre, slab.half, 1);
        for (std::size_t i = 0; i < body_count; ++i) {
            const SceneBody& body = scene_bodies[i];
            bodies_[i] = body.is_ball ? add_ball(body) : add(b2_dynamicBody, body.position, body.half, body.mass);
        }
    }
    void step() { b2World_Step(world_, step_seconds, TUMBLE_COUNT); }
    [[nodiscard]] Vec position(std::size_t i) const {
        const b2Vec2 at = b2Body_GetPosition(bodies_[i]);
        return {at.x, at.y, 0};
    }
    void push(std::size_t i, const Vec& impulse) {
        b2Body_ApplyLinearImpulseToCenter(bodies_[i], {impulse.x, impulse.y}, true);
    }

private:
    [[nodiscard]] b2BodyId body_at(b2BodyType type, const Vec& position) {
        b2BodyDef def = b2DefaultBodyDef();
        def.type = type;
        def.position = {position.x, position.y};
        return b2CreateBody(world_, &def);
    }
    [[nodiscard]] static b2ShapeDef shape_of(float density) {
        b2ShapeDef def = b2DefaultShapeDef();
        def.density = density;
        def.material.friction = friction;
        def.material.restitution = restitution;
        return def;
    }
    b2BodyId add(b2BodyType type, const Vec& position, const Vec& half, float mass) {
        const b2BodyId body = body_at(type, position);
        const b2ShapeDef def = shape_of(mass / (4 * half.x * half.y));
        const b2Polygon box = b2MakeBox(half.x, half.y);
        b2CreatePolygonShape(body, &def, &box);
        return body;
    }
    b2BodyId add_ball(const SceneBody& ball) {
        const b2BodyId body = body_at(b2_dynamicBody, ball.position);
        const b2ShapeDef def = shape_of(ball.mass / (3.14159265f * ball.radius * ball.radius));
        const b2Circle circle{{0, 0}, ball.radius};
        b2CreateCircleShape(body, &def, &circle);
        return body;
    }

    b2WorldId world_;
    std::array<b2BodyId, body_count> bodies_;
};

}  // namespace tumble::bench

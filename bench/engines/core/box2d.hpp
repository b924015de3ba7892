// Box2D of version 2.4, in a plane: spheres as circles and boxes as polygons. Its polygons have a skin, by which they
// are made smaller, so that their outer surface is that of the scene. Nothing sleeps.
#pragma once

#include "scene.hpp"

#include <box2d/box2d.h>

#include <cmath>

namespace tumble::bench {

class Engine {
public:
    static constexpr const char* name = "Box2D";
    static constexpr const char* numbers = "f32";
    static constexpr bool carry = false;

    Engine() {
        world_.SetAllowSleeping(false);
        for (const Slab& slab : scene_slabs) add(b2_staticBody, slab.centre, slab.half, 1);
        for (std::size_t i = 0; i < body_count; ++i) {
            const SceneBody& body = scene_bodies[i];
            bodies_[i] = body.is_ball ? add_ball(body) : add(b2_dynamicBody, body.position, body.half, body.mass);
        }
    }
    void step() { world_.Step(step_seconds, TUMBLE_COUNT, 3); }
    [[nodiscard]] Vec position(std::size_t i) const {
        const b2Vec2& at = bodies_[i]->GetPosition();
        return {at.x, at.y, 0};
    }
    [[nodiscard]] Turn turn(std::size_t i) const {
        const float half = bodies_[i]->GetAngle() / 2;
        return {std::cos(half), 0, 0, std::sin(half)};
    }
    void push(std::size_t i, const Vec& impulse) {
        bodies_[i]->ApplyLinearImpulseToCenter({impulse.x, impulse.y}, true);
    }

private:
    b2Body* body_at(b2BodyType type, const Vec& position) {
        b2BodyDef def;
        def.type = type;
        def.position = {position.x, position.y};
        return world_.CreateBody(&def);
    }
    static void touch(b2Body* body, const b2Shape& shape, float density) {
        b2FixtureDef def;
        def.shape = &shape;
        def.density = density;
        def.friction = friction;
        def.restitution = restitution;
        def.restitutionThreshold = restitution_threshold;
        body->CreateFixture(&def);
    }
    b2Body* add(b2BodyType type, const Vec& position, const Vec& half, float mass) {
        b2Body* body = body_at(type, position);
        b2PolygonShape box;
        const float x = half.x - b2_polygonRadius, y = half.y - b2_polygonRadius;
        box.SetAsBox(x, y);
        touch(body, box, mass / (4 * x * y));
        return body;
    }
    b2Body* add_ball(const SceneBody& ball) {
        b2Body* body = body_at(b2_dynamicBody, ball.position);
        b2CircleShape circle;
        circle.m_radius = ball.radius;
        touch(body, circle, ball.mass / (3.14159265f * ball.radius * ball.radius));
        return body;
    }

    b2World world_{{gravity.x, gravity.y}};
    std::array<b2Body*, body_count> bodies_;
};

}  // namespace tumble::bench

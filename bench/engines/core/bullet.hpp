// Bullet in float: sequential impulses with its default settings. Nothing sleeps, nothing is damped. Its pools have
// room for 64 pairs in place of 4096, of which the memory would be 4 MB.
#pragma once

#include "scene.hpp"

#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <new>

namespace tumble::bench {

class Engine {
public:
    static constexpr const char* name = "Bullet";
    static constexpr const char* numbers = "f32";
    static constexpr bool carry = false;

    Engine() {
        world_.getSolverInfo().m_numIterations = TUMBLE_COUNT;
        world_.setGravity({gravity.x, gravity.y, gravity.z});
        for (const Slab& slab : scene_slabs) {
            auto* shape = new btStaticPlaneShape({slab.normal.x, slab.normal.y, slab.normal.z}, -slab.offset);
            add(0, {0, 0, 0}, shape, {0, 0, 0}, 2, 1);
        }
        for (std::size_t i = 0; i < body_count; ++i) {
            const SceneBody& body = scene_bodies[i];
            btCollisionShape* shape = body.is_ball ? static_cast<btCollisionShape*>(new btSphereShape(body.radius))
                                                   : new btBoxShape({body.half.x, body.half.y, body.half.z});
            btVector3 moments;
            shape->calculateLocalInertia(body.mass, moments);
            bodies_[i] = add(body.mass, moments, shape, {body.position.x, body.position.y, body.position.z}, 1, 3);
            bodies_[i]->setCenterOfMassTransform(
                btTransform{btQuaternion(body.turn.x, body.turn.y, body.turn.z, body.turn.w),
                            bodies_[i]->getCenterOfMassPosition()});
        }
    }
    void step() { world_.stepSimulation(step_seconds, 0); }
    [[nodiscard]] Vec position(std::size_t i) const {
        const btVector3& at = bodies_[i]->getWorldTransform().getOrigin();
        return {at.x(), at.y(), at.z()};
    }
    [[nodiscard]] Turn turn(std::size_t i) const {
        const btQuaternion q = bodies_[i]->getWorldTransform().getRotation();
        return {q.w(), q.x(), q.y(), q.z()};
    }
    void push(std::size_t i, const Vec& impulse) { bodies_[i]->applyCentralImpulse({impulse.x, impulse.y, impulse.z}); }

private:
    btRigidBody* add(float mass, const btVector3& moments, btCollisionShape* shape, const btVector3& at, int group,
                     int mask) {
        auto* body = new btRigidBody(btRigidBody::btRigidBodyConstructionInfo{mass, nullptr, shape, moments});
        body->setCenterOfMassTransform(btTransform{btQuaternion::getIdentity(), at});
        body->setRestitution(std::sqrt(restitution));
        body->setFriction(std::sqrt(friction));
        body->setActivationState(DISABLE_DEACTIVATION);
        world_.addRigidBody(body, group, mask);
        return body;
    }
    static btDefaultCollisionConstructionInfo small() {
        btDefaultCollisionConstructionInfo info;
        info.m_defaultMaxPersistentManifoldPoolSize = 64;
        info.m_defaultMaxCollisionAlgorithmPoolSize = 64;
        return info;
    }

    btDefaultCollisionConfiguration configuration_{small()};
    btCollisionDispatcher dispatcher_{&configuration_};
    btDbvtBroadphase broadphase_;
    btSequentialImpulseConstraintSolver solver_;
    btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
    std::array<btRigidBody*, body_count> bodies_;
};

}  // namespace tumble::bench

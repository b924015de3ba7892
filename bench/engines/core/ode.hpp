// The Open Dynamics Engine in float. TUMBLE_COUNT: iterations of its quick step; 0: its direct step.
#pragma once

#include "ode_contacts.hpp"
#include "scene.hpp"

namespace tumble::bench {

class Engine {
public:
    static constexpr const char* name = "ODE";
    static constexpr const char* numbers = "f32";
    static constexpr bool carry = false;

    Engine() {
        dInitODE2(0);
        dAllocateODEDataForThread(dAllocateMaskAll);
        world_ = dWorldCreate();
        space_ = dHashSpaceCreate(nullptr);
        contacts_ = dJointGroupCreate(0);
        dWorldSetGravity(world_, gravity.x, gravity.y, gravity.z);
        if (TUMBLE_COUNT > 0) dWorldSetQuickStepNumIterations(world_, TUMBLE_COUNT);
        for (const Slab& slab : scene_slabs)
            dCreatePlane(space_, slab.normal.x, slab.normal.y, slab.normal.z, -slab.offset);
        for (std::size_t i = 0; i < body_count; ++i) {
            const SceneBody& body = scene_bodies[i];
            bodies_[i] = dBodyCreate(world_);
            dMass mass;
            dGeomID shape;
            if (body.is_ball) {
                dMassSetSphereTotal(&mass, body.mass, body.radius);
                shape = dCreateSphere(space_, body.radius);
            } else {
                dMassSetBoxTotal(&mass, body.mass, 2 * body.half.x, 2 * body.half.y, 2 * body.half.z);
                shape = dCreateBox(space_, 2 * body.half.x, 2 * body.half.y, 2 * body.half.z);
            }
            dBodySetMass(bodies_[i], &mass);
            dBodySetPosition(bodies_[i], body.position.x, body.position.y, body.position.z);
            dGeomSetBody(shape, bodies_[i]);
            const dQuaternion q{body.turn.w, body.turn.x, body.turn.y, body.turn.z};
            dBodySetQuaternion(bodies_[i], q);
        }
    }
    void step() {
        dSpaceCollide(space_, this, meet);
        if (TUMBLE_COUNT > 0) dWorldQuickStep(world_, step_seconds);
        else dWorldStep(world_, step_seconds);
        dJointGroupEmpty(contacts_);
    }
    [[nodiscard]] Vec position(std::size_t i) const {
        const dReal* at = dBodyGetPosition(bodies_[i]);
        return {at[0], at[1], at[2]};
    }
    [[nodiscard]] Turn turn(std::size_t i) const {
        const dReal* q = dBodyGetQuaternion(bodies_[i]);
        return {q[0], q[1], q[2], q[3]};
    }
    void push(std::size_t i, const Vec& impulse) {
        const dReal* v = dBodyGetLinearVel(bodies_[i]);
        const float mass = scene_bodies[i].mass;
        dBodySetLinearVel(bodies_[i], v[0] + impulse.x / mass, v[1] + impulse.y / mass, v[2] + impulse.z / mass);
    }

private:
    static void meet(void* of, dGeomID a, dGeomID b) {
        Engine& engine = *static_cast<Engine*>(of);
        if (dGeomGetBody(a) == nullptr && dGeomGetBody(b) == nullptr) return;
        add_contacts(engine.world_, engine.contacts_, a, b, friction, restitution);
    }

    dWorldID world_;
    dSpaceID space_;
    dJointGroupID contacts_;
    std::array<dBodyID, body_count> bodies_;
};

}  // namespace tumble::bench

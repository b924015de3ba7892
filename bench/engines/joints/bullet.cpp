// Bullet, in the precision that BT_USE_DOUBLE_PRECISION selects: joints between rigid bodies by sequential impulses,
// and Featherstone's multibody, whose joints are its coordinates. No damping and no sleeping; otherwise its default
// settings.
#include "contest.hpp"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

namespace {

using namespace tumble::bench;
using tumble::reference::Motion, tumble::reference::Rotation, tumble::reference::Vector;

btVector3 vector(Vector v) {
    return {static_cast<btScalar>(v.x), static_cast<btScalar>(v.y), static_cast<btScalar>(v.z)};
}
btQuaternion quaternion(Rotation q) {
    return {static_cast<btScalar>(q.v.x), static_cast<btScalar>(q.v.y), static_cast<btScalar>(q.v.z),
            static_cast<btScalar>(q.w)};
}
Vector vector(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
Rotation rotation(const btQuaternion& q) { return {q.w(), {q.x(), q.y(), q.z()}}; }

class BulletWorld {
public:
    explicit BulletWorld(int rate) : step_{btScalar(1) / static_cast<btScalar>(rate)} {
        world.setGravity({0, static_cast<btScalar>(-gravity), 0});
    }
    void step() { world.stepSimulation(step_, 0); }

private:
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_{&configuration_};
    btDbvtBroadphase broadphase_;
    btMultiBodyConstraintSolver solver_;
    btScalar step_;

public:
    btMultiBodyDynamicsWorld world{&dispatcher_, &broadphase_, &solver_, &configuration_};
};

class RigidRunner final : public Runner {
public:
    RigidRunner(const Mechanism& mechanism, int rate) : world_{rate} {
        for (std::size_t i = 0; i < mechanism.links.size(); ++i) {
            const Link& link = mechanism.links[i];
            btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(link.mass), nullptr, &shape_,
                                                          vector(link.moments));
            info.m_startWorldTransform = btTransform{quaternion(link.start.q), vector(link.start.x)};
            auto& body = *bodies_.emplace_back(std::make_unique<btRigidBody>(info));
            body.setActivationState(DISABLE_DEACTIVATION);
            body.setLinearVelocity(vector(link.start.v));
            body.setAngularVelocity(vector(link.start.q.rotate(link.start.w)));
            world_.world.addRigidBody(&body, 0, 0);
            const btVector3 own = vector(link.to_own), axis = vector(link.own_axis());
            if (i == 0) {
                if (link.is_hinge()) add(std::make_unique<btHingeConstraint>(body, own, axis));
                else add(std::make_unique<btPoint2PointConstraint>(body, own));
                continue;
            }
            const Link& before = mechanism.links[i - 1];
            const btVector3 next = vector(before.to_next), its = vector(before.start.q.rotate_back(link.axis));
            if (link.is_hinge()) add(std::make_unique<btHingeConstraint>(body, *bodies_[i - 1], own, next, axis, its));
            else add(std::make_unique<btPoint2PointConstraint>(body, *bodies_[i - 1], own, next));
        }
    }
    RigidRunner(const RigidRunner&) = delete;
    RigidRunner& operator=(const RigidRunner&) = delete;
    ~RigidRunner() override {
        for (const auto& joint : joints_) world_.world.removeConstraint(joint.get());
        for (const auto& body : bodies_) world_.world.removeRigidBody(body.get());
    }

    void step() override { world_.step(); }
    [[nodiscard]] std::vector<Motion> motions() override {
        std::vector<Motion> motions;
        for (const auto& body : bodies_) {
            const Rotation q = rotation(body->getWorldTransform().getRotation());
            motions.push_back({vector(body->getWorldTransform().getOrigin()), vector(body->getLinearVelocity()), q,
                               q.rotate_back(vector(body->getAngularVelocity()))});
        }
        return motions;
    }

private:
    void add(std::unique_ptr<btTypedConstraint> joint) {
        world_.world.addConstraint(joint.get(), true);
        joints_.push_back(std::move(joint));
    }

    BulletWorld world_;
    btEmptyShape shape_;
    std::vector<std::unique_ptr<btRigidBody>> bodies_;
    std::vector<std::unique_ptr<btTypedConstraint>> joints_;
};

// The frame of a link is that of its start, so that all coordinates start at zero.
class MultibodyRunner final : public Runner {
public:
    MultibodyRunner(const Mechanism& mechanism, int rate)
        : mechanism_{mechanism}, world_{rate}, body_{static_cast<int>(mechanism.links.size()),
                                                     0,
                                                     {0, 0, 0},
                                                     true,
                                                     false} {
        Motion before;
        Vector pivot = mechanism.links[0].anchor;  // from the centre of mass of the link before, in its axes
        for (int i = 0; i < body_.getNumLinks(); ++i) {
            const Link& link = mechanism.links[static_cast<std::size_t>(i)];
            const btQuaternion into = quaternion(link.start.q.conjugate() * before.q);
            const auto mass = static_cast<btScalar>(link.mass);
            if (link.is_hinge())
                body_.setupRevolute(i, mass, vector(link.moments), i - 1, into, vector(link.own_axis()), vector(pivot),
                                    vector(-link.to_own), true);
            else
                body_.setupSpherical(i, mass, vector(link.moments), i - 1, into, vector(pivot), vector(-link.to_own),
                                     true);
            before = link.start;
            pivot = link.to_next;
        }
        body_.finalizeMultiDof();
        body_.setLinearDamping(0);
        body_.setAngularDamping(0);
        body_.setUseGyroTerm(true);
        body_.setCanSleep(false);
        Vector spin{};
        for (int i = 0; i < body_.getNumLinks(); ++i) {
            const Link& link = mechanism.links[static_cast<std::size_t>(i)];
            const Vector own = link.start.w - link.start.q.rotate_back(spin);
            if (link.is_hinge()) body_.setJointVel(i, static_cast<btScalar>(dot(link.own_axis(), own)));
            else {
                const btVector3 speeds = vector(own);
                body_.setJointVelMultiDof(i, &speeds.m_floats[0]);
            }
            spin = link.start.q.rotate(link.start.w);
        }
        world_.world.addMultiBody(&body_);
    }
    MultibodyRunner(const MultibodyRunner&) = delete;
    MultibodyRunner& operator=(const MultibodyRunner&) = delete;
    ~MultibodyRunner() override { world_.world.removeMultiBody(&body_); }

    void step() override { world_.step(); }
    [[nodiscard]] std::vector<Motion> motions() override {
        body_.forwardKinematics(rotations_, places_);
        std::vector<Motion> motions;
        std::vector<Vector> turns;
        for (int i = 0; i < body_.getNumLinks(); ++i) {
            const Link& link = mechanism_.links[static_cast<std::size_t>(i)];
            const btTransform& at = body_.getLink(i).m_cachedWorldTransform;
            motions.push_back({vector(at.getOrigin()), {}, rotation(at.getRotation()), {}});
            const btScalar* speed = body_.getJointVelMultiDof(i);
            turns.push_back(link.is_hinge() ? link.own_axis() * static_cast<long double>(*speed)
                                            : tumble::reference::vector_of(speed));
        }
        mechanism_.set_velocities(motions, turns);
        return motions;
    }

private:
    const Mechanism& mechanism_;
    BulletWorld world_;
    btMultiBody body_;
    btAlignedObjectArray<btQuaternion> rotations_;
    btAlignedObjectArray<btVector3> places_;
};

}  // namespace

int main(int argc, char** argv) {
    const std::string version = std::to_string(btGetVersion() / 100) + "." + std::to_string(btGetVersion() % 100),
                      numbers = sizeof(btScalar) == 8 ? "f64" : "f32";
    return joint_contest(
        argc, argv,
        {{"Bullet", version, "sequential impulses", numbers, false,
          [](const Mechanism& mechanism, int rate) { return std::make_unique<RigidRunner>(mechanism, rate); }},
         {"Bullet", version, "multibody", numbers, false,
          [](const Mechanism& mechanism, int rate) { return std::make_unique<MultibodyRunner>(mechanism, rate); }}});
}

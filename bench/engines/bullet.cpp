// Bullet, in the precision that BT_USE_DOUBLE_PRECISION selects, with its default settings: a discrete dynamics world
// with the sequential-impulse solver, and Featherstone's multibody, whose joints are its coordinates. Drag is Bullet's
// damping. It has no springs to a point and no gravitation.
#include "contender.hpp"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>

namespace {

using namespace tumble;
using namespace tumble::bench;
using reference::Motion, reference::Rotation, reference::Vector;

template <class... T>
btVector3 scalars(const T&... xyz) {
    return {static_cast<btScalar>(xyz)...};
}
btVector3 vector(const Vector& v) { return scalars(v.x, v.y, v.z); }
btVector3 vector(const RealVec3& v) { return vector(reference::vector_of(array_of<double>(v))); }
btQuaternion quaternion(const Rotation& q) {
    const btVector3 v = vector(q.v);
    return {v.x(), v.y(), v.z(), static_cast<btScalar>(q.w)};
}
btScalar scalar(Real value) { return static_cast<btScalar>(value.to_double()); }
btVector3 moments_of(const BodySpec& body) {
    const auto moments = principal_moments(body);
    return scalars(moments[0], moments[1], moments[2]);
}
Vector vector(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
Rotation rotation(const btQuaternion& q) { return {q.w(), {q.x(), q.y(), q.z()}}; }

template <class Solver, class DynamicsWorld>
class BulletWorld {
public:
    explicit BulletWorld(const Problem& problem) : step_{static_cast<btScalar>(problem.step())} {
        world_.setGravity(vector(problem.scene.world.gravity));
    }

protected:
    void advance() { world_.stepSimulation(step_, 0); }

    btScalar step_;  // s

private:
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_{&configuration_};
    btDbvtBroadphase broadphase_;
    Solver solver_;

protected:
    DynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
};

// The treatment of the gyroscopic torque that suits the moments of a body. Bullet's default is an implicit solution,
// which takes determinants below 1e-7 for singular. The moments of small bodies have such determinants.
constexpr int by_moments = -1;

class RigidBodies : BulletWorld<btSequentialImpulseConstraintSolver, btDiscreteDynamicsWorld> {
public:
    RigidBodies(const Problem& problem, int gyroscopic) : BulletWorld{problem} {
        const SceneData& scene = problem.scene;
        const ContactSpec& contact = scene.world.contact;
        // While all bodies sleep, their bounds do not change.
        if (problem.sleeps()) {
            world_.setForceUpdateAllAabbs(false);
            gDeactivationTime = scalar(contact.sleep.time);
        }
        const auto touch = [&](btRigidBody& body) {
            // Bullet multiplies the restitutions of the two sides.
            body.setRestitution(std::sqrt(scalar(contact.restitution)));
            body.setFriction(std::sqrt(scalar(contact.friction)));
        };
        for (const BodySpec& spec : scene.bodies) {
            btCollisionShape& shape = *shapes_.emplace_back(shape_of(spec, problem.touches()));
            const btVector3 moments = moments_of(spec);
            auto body = std::make_unique<btRigidBody>(
                btRigidBody::btRigidBodyConstructionInfo{spec.is_fixed() ? 0 : scalar(spec.mass), nullptr, &shape,
                                                         spec.is_fixed() ? btVector3(0, 0, 0) : moments});
            const Motion start = start_of(spec);
            const btTransform place{quaternion(start.q), vector(start.x)};
            body->setCenterOfMassTransform(place);
            body->setLinearVelocity(vector(start.v));
            body->setAngularVelocity(vector(start.q.rotate(start.w)));
            // The share of the velocity that is lost in a second.
            body->setDamping(1 - std::exp(-scalar(scene.world.linear_drag / spec.mass)), 0);
            if (problem.sleeps())
                body->setSleepingThresholds(scalar(contact.sleep.speed), scalar(contact.sleep.angular_speed));
            else body->setActivationState(DISABLE_DEACTIVATION);
            if (gyroscopic != by_moments) body->setFlags(gyroscopic);
            else if (moments.x() * moments.y() * moments.z() < btScalar(1e-6))
                body->setFlags(BT_ENABLE_GYROSCOPIC_FORCE_EXPLICIT);
            if (spec.is_fixed()) {
                body->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
                turning_.push_back({body.get(), place, body->getAngularVelocity()});
            }
            touch(*body);
            constexpr int bodies = 1, planes = 2;
            world_.addRigidBody(body.get(), bodies, problem.features.pairs ? bodies | planes : planes);
            bodies_.push_back(std::move(body));
        }
        for (const PlaneSpec& plane : scene.planes) {
            auto& shape =
                shapes_.emplace_back(std::make_unique<btStaticPlaneShape>(vector(plane.normal), -scalar(plane.offset)));
            auto body = std::make_unique<btRigidBody>(
                btRigidBody::btRigidBodyConstructionInfo{0, nullptr, shape.get(), btVector3(0, 0, 0)});
            touch(*body);
            world_.addRigidBody(body.get(), 2, 1);
            planes_.push_back(std::move(body));
        }
        for (std::size_t i = 0; i < problem.joints.size(); ++i) {
            joints_.push_back(constraint_of(problem, i));
            world_.addConstraint(joints_.back().get(), true);
        }
    }
    RigidBodies(const RigidBodies&) = delete;
    RigidBodies& operator=(const RigidBodies&) = delete;
    ~RigidBodies() {
        for (const auto& joint : joints_) world_.removeConstraint(joint.get());
        for (auto* list : {&bodies_, &planes_})
            for (auto& body : *list) world_.removeRigidBody(body.get());
    }

    void step() {
        // Bullet derives the velocity of a kinematic body from its places.
        time_ += step_;
        for (const Turning& t : turning_)
            if (!t.rate.isZero())
                t.body->setWorldTransform(
                    btTransform(btQuaternion(t.rate.normalized(), t.rate.length() * time_) * t.start.getRotation(),
                                t.start.getOrigin()));
        advance();
    }
    [[nodiscard]] Motions motions() const {
        Motions motions;
        for (const auto& body : bodies_) {
            const Rotation q = rotation(body->getWorldTransform().getRotation());
            motions.push_back({vector(body->getWorldTransform().getOrigin()), vector(body->getLinearVelocity()), q,
                               q.normalized().rotate_back(vector(body->getAngularVelocity()))});
        }
        return motions;
    }
    [[nodiscard]] bool asleep(int body) const { return !bodies_[static_cast<std::size_t>(body)]->isActive(); }

private:
    // A fixed body that turns.
    struct Turning {
        btRigidBody* body;
        btTransform start;
        btVector3 rate;  // rad/s, world
    };

    static std::unique_ptr<btCollisionShape> shape_of(const BodySpec& body, bool touches) {
        if (!touches) return std::make_unique<btEmptyShape>();
        if (body.shape.kind == ShapeKind::sphere) return std::make_unique<btSphereShape>(scalar(body.shape.size.x));
        // A hoop is a disc without thickness.
        if (body.shape.kind == ShapeKind::hoop)
            return std::make_unique<btCylinderShapeZ>(
                btVector3(scalar(body.shape.size.x), scalar(body.shape.size.x), 0));
        return std::make_unique<btBoxShape>(vector(body.shape.size) * btScalar(0.5));
    }
    std::unique_ptr<btTypedConstraint> constraint_of(const Problem& problem, std::size_t i) const {
        const Joint& joint = problem.joints[i];
        const btVector3 own = vector(joint.on_own), other = vector(joint.on_other), axis = vector(joint.own_axis);
        if (i == 0) {
            if (joint.is_hinge()) return std::make_unique<btHingeConstraint>(*bodies_[0], own, axis);
            return std::make_unique<btPoint2PointConstraint>(*bodies_[0], own);
        }
        btRigidBody &body = *bodies_[i], &before = *bodies_[i - 1];
        if (!joint.is_hinge()) return std::make_unique<btPoint2PointConstraint>(body, before, own, other);
        const btVector3 its = vector(start_of(problem.scene.bodies[i - 1]).q.rotate_back(joint.axis));
        return std::make_unique<btHingeConstraint>(body, before, own, other, axis, its);
    }

    std::vector<std::unique_ptr<btCollisionShape>> shapes_;
    std::vector<std::unique_ptr<btRigidBody>> bodies_, planes_;
    std::vector<std::unique_ptr<btTypedConstraint>> joints_;
    std::vector<Turning> turning_;
    btScalar time_ = 0;  // s
};

// Bodies that joints tie in a chain. The frame of a body is that of its start, so that all coordinates start at zero.
class Multibody : BulletWorld<btMultiBodyConstraintSolver, btMultiBodyDynamicsWorld> {
public:
    explicit Multibody(const Problem& problem)
        : BulletWorld{problem}, joints_{problem.joints}, body_{static_cast<int>(joints_.size()),
                                                               0,
                                                               {0, 0, 0},
                                                               true,
                                                               false} {
        Rotation before;
        for (int i = 0; i < body_.getNumLinks(); ++i) {
            const BodySpec& spec = problem.scene.bodies[static_cast<std::size_t>(i)];
            const Joint& joint = joints_[static_cast<std::size_t>(i)];
            const Rotation q = start_of(spec).q;
            const btQuaternion into = quaternion(q.conjugate() * before);
            const btVector3 pivot = vector(joint.on_other), to_centre = vector(-joint.on_own);
            if (joint.is_hinge())
                body_.setupRevolute(i, scalar(spec.mass), moments_of(spec), i - 1, into, vector(joint.own_axis), pivot,
                                    to_centre, true);
            else body_.setupSpherical(i, scalar(spec.mass), moments_of(spec), i - 1, into, pivot, to_centre, true);
            before = q;
        }
        body_.finalizeMultiDof();
        body_.setLinearDamping(0);
        body_.setAngularDamping(0);
        body_.setUseGyroTerm(true);
        body_.setCanSleep(false);
        for (int i = 0; i < body_.getNumLinks(); ++i) {
            const Joint& joint = joints_[static_cast<std::size_t>(i)];
            const btVector3 speeds =
                joint.is_hinge() ? scalars(dot(joint.own_axis, joint.spin), 0, 0) : vector(joint.spin);
            body_.setJointVelMultiDof(i, &speeds.m_floats[0]);
        }
        world_.addMultiBody(&body_);
    }
    Multibody(const Multibody&) = delete;
    Multibody& operator=(const Multibody&) = delete;
    ~Multibody() { world_.removeMultiBody(&body_); }

    void step() { advance(); }
    [[nodiscard]] Motions motions() {
        body_.forwardKinematics(rotations_, places_);
        Motions motions;
        std::vector<Vector> turns;
        for (int i = 0; i < body_.getNumLinks(); ++i) {
            const Joint& joint = joints_[static_cast<std::size_t>(i)];
            const btTransform& at = body_.getLink(i).m_cachedWorldTransform;
            motions.push_back({vector(at.getOrigin()), {}, rotation(at.getRotation()), {}});
            const btScalar* speed = body_.getJointVelMultiDof(i);
            turns.push_back(joint.is_hinge() ? joint.own_axis * static_cast<long double>(*speed)
                                             : reference::vector_of(speed));
        }
        set_velocities(joints_, turns, motions);
        return motions;
    }
    [[nodiscard]] static bool asleep(int /*body*/) { return false; }

private:
    std::vector<Joint> joints_;
    btMultiBody body_;
    btAlignedObjectArray<btQuaternion> rotations_;
    btAlignedObjectArray<btVector3> places_;
};

template <class World, class... Method>
void add(Contenders& contenders, const char* name, Method... method) {
    const std::string version = std::to_string(btGetVersion() / 100) + "." + std::to_string(btGetVersion() % 100);
    contenders.push_back({"Bullet", version, name, sizeof(btScalar) == 8 ? "f64" : "f32", false,
                          [=](const Problem& problem) -> std::unique_ptr<Runner> {
                              if (problem.features.springs > 0 || problem.features.gravitation) return nullptr;
                              return std::make_unique<RemakingRunner<World>>(problem, method...);
                          }});
}

}  // namespace

void tumble::bench::add_bullet(Contenders& contenders) {
    add<RigidBodies>(contenders, "sequential impulses", by_moments);
}
void tumble::bench::add_bullet_tops(Contenders& contenders) {
    add<RigidBodies>(contenders, "gyroscopic torque implicit, body frame", BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY);
    add<RigidBodies>(contenders, "gyroscopic torque implicit, world frame", BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_WORLD);
    add<RigidBodies>(contenders, "gyroscopic torque explicit", BT_ENABLE_GYROSCOPIC_FORCE_EXPLICIT);
    add<RigidBodies>(contenders, "no gyroscopic torque", 0);
}
void tumble::bench::add_bullet_joints(Contenders& contenders) {
    add<RigidBodies>(contenders, "sequential impulses", BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY);
    add<Multibody>(contenders, "multibody");
}

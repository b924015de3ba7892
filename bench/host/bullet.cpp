// Bullet in float, its default: a discrete dynamics world with the sequential-impulse solver and its default settings.
// Drag is Bullet's damping. It has no springs to a point and no gravitation.
#include "contender.hpp"

#include <btBulletDynamicsCommon.h>

#include <cmath>

namespace {

using namespace tumble;
using namespace tumble::bench;

btVector3 vector(const RealVec3& v) {
    const auto a = array_of<btScalar>(v);
    return {a[0], a[1], a[2]};
}
btScalar scalar(Real value) { return static_cast<btScalar>(value.to_double()); }

class World {
public:
    explicit World(const Problem& problem) {
        const SceneData& scene = problem.scene;
        const ContactSpec& contact = scene.world.contact;
        world_.setGravity(vector(scene.world.gravity));
        // While all bodies sleep, their bounds do not change.
        if (problem.sleeps()) world_.setForceUpdateAllAabbs(false);
        const auto touch = [&](btRigidBody& body) {
            // Bullet multiplies the restitutions of the two sides.
            body.setRestitution(std::sqrt(scalar(contact.restitution)));
            body.setFriction(std::sqrt(scalar(contact.friction)));
        };
        for (const BodySpec& spec : scene.bodies) {
            btCollisionShape& shape = *shapes_.emplace_back(shape_of(spec, problem.touches()));
            const auto moments = principal_moments(spec);
            auto body = std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo{
                spec.is_fixed() ? 0 : scalar(spec.mass), nullptr, &shape,
                spec.is_fixed() ? btVector3(0, 0, 0)
                                : btVector3(static_cast<btScalar>(moments[0]), static_cast<btScalar>(moments[1]),
                                            static_cast<btScalar>(moments[2]))});
            const RealQuat q = normalized(spec.orientation);
            const btVector3 axis = vector(q.v);
            const btTransform place{btQuaternion(axis.x(), axis.y(), axis.z(), scalar(q.w)), vector(spec.position)};
            body->setCenterOfMassTransform(place);
            body->setLinearVelocity(vector(spec.velocity));
            body->setAngularVelocity(place.getBasis() * vector(spec.angular_velocity));
            // The share of the velocity that is lost in a second.
            body->setDamping(1 - std::exp(-scalar(scene.world.linear_drag / spec.mass)), 0);
            if (problem.sleeps())
                body->setSleepingThresholds(scalar(contact.sleep.speed), scalar(contact.sleep.angular_speed));
            else body->setActivationState(DISABLE_DEACTIVATION);
            // Bullet's default is an implicit solution, which treats determinants below 1e-7 as singular. The moments
            // of small bodies have such determinants.
            if (moments[0] * moments[1] * moments[2] < 1e-6) body->setFlags(BT_ENABLE_GYROSCOPIC_FORCE_EXPLICIT);
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
    }
    World(const World&) = delete;
    World& operator=(const World&) = delete;
    ~World() {
        for (auto* list : {&bodies_, &planes_})
            for (auto& body : *list) world_.removeRigidBody(body.get());
    }

    void step(btScalar seconds) {
        // Bullet derives the velocity of a kinematic body from its places.
        time_ += seconds;
        for (const Turning& t : turning_)
            if (!t.rate.isZero())
                t.body->setWorldTransform(
                    btTransform(btQuaternion(t.rate.normalized(), t.rate.length() * time_) * t.start.getRotation(),
                                t.start.getOrigin()));
        world_.stepSimulation(seconds, 0);
    }
    [[nodiscard]] const btRigidBody& body(int index) const { return *bodies_[static_cast<std::size_t>(index)]; }

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

    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_{&configuration_};
    btDbvtBroadphase broadphase_;
    btSequentialImpulseConstraintSolver solver_;
    btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
    std::vector<std::unique_ptr<btCollisionShape>> shapes_;
    std::vector<std::unique_ptr<btRigidBody>> bodies_, planes_;
    std::vector<Turning> turning_;
    btScalar time_ = 0;  // s
};

class BulletRunner final : public Runner {
public:
    explicit BulletRunner(const Problem& problem) : problem_{problem}, step_{static_cast<btScalar>(problem.step())} {
        if (problem.sleeps()) gDeactivationTime = scalar(problem.scene.world.contact.sleep.time);
        restart();
    }

    void restart() override {
        world_.reset();
        world_ = std::make_unique<World>(problem_);
    }
    void run(int steps) override {
        for (int i = 0; i < steps; ++i) world_->step(step_);
    }
    [[nodiscard]] reference::Motion motion(int index) const override {
        const btRigidBody& body = world_->body(index);
        const auto vector_of = [](const btVector3& v) { return reference::Vector{v.x(), v.y(), v.z()}; };
        const btQuaternion q = body.getWorldTransform().getRotation();
        const reference::Rotation turn{q.w(), {q.x(), q.y(), q.z()}};
        return {vector_of(body.getWorldTransform().getOrigin()), vector_of(body.getLinearVelocity()), turn,
                turn.rotate_back(vector_of(body.getAngularVelocity()))};
    }
    [[nodiscard]] bool asleep(int body) const override { return !world_->body(body).isActive(); }

private:
    const Problem& problem_;
    btScalar step_;
    std::unique_ptr<World> world_;
};

}  // namespace

void tumble::bench::add_bullet(std::vector<Contender>& contenders) {
    const std::string version = std::to_string(btGetVersion() / 100) + "." + std::to_string(btGetVersion() % 100);
    contenders.push_back({"Bullet", version, "sequential impulses", sizeof(btScalar) == 8 ? "f64" : "f32", false,
                          [](const Problem& problem) -> std::unique_ptr<Runner> {
                              if (problem.features.springs > 0 || problem.features.gravitation) return nullptr;
                              return std::make_unique<BulletRunner>(problem);
                          }});
}

// Bullet, in the precision that BT_USE_DOUBLE_PRECISION selects: a discrete dynamics world with one body, no gravity,
// no damping and no sleeping, with each of btRigidBody's treatments of the gyroscopic torque.
#include "contender.hpp"

#include <btBulletDynamicsCommon.h>

namespace {

using namespace tumble::bench;

class BulletTop final : public Runner {
public:
    explicit BulletTop(int flags) {
        world_.setGravity({0, 0, 0});
        body_.setFlags(flags);
        body_.setActivationState(DISABLE_DEACTIVATION);
        body_.setAngularVelocity(vector(top_spin));
        world_.addRigidBody(&body_);
    }
    ~BulletTop() override { world_.removeRigidBody(&body_); }

    void step() override { world_.stepSimulation(btScalar(1) / top_steps_per_second, 0); }
    [[nodiscard]] std::array<double, 4> orientation() const override {
        const btQuaternion q = body_.getWorldTransform().getRotation();
        return {q.w(), q.x(), q.y(), q.z()};
    }
    [[nodiscard]] std::array<double, 3> spin() const override {
        const btVector3& w = body_.getAngularVelocity();
        return to_body(orientation(), {w.x(), w.y(), w.z()});
    }

private:
    static btVector3 vector(const std::array<double, 3>& v) {
        return {static_cast<btScalar>(v[0]), static_cast<btScalar>(v[1]), static_cast<btScalar>(v[2])};
    }

    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_{&configuration_};
    btDbvtBroadphase broadphase_;
    btSequentialImpulseConstraintSolver solver_;
    btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
    btEmptyShape shape_;
    btRigidBody body_{{1, nullptr, &shape_, vector(top_moments)}};
};

}  // namespace

int main(int argc, char** argv) {
    const std::string version = std::to_string(btGetVersion() / 100) + "." + std::to_string(btGetVersion() % 100),
                      numbers = sizeof(btScalar) == 8 ? "f64" : "f32";
    std::vector<Contender> contenders;
    for (const auto& [method, flags] :
         {std::pair<const char*, int>{"gyroscopic torque implicit, body frame",
                                      BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY},
          std::pair<const char*, int>{"gyroscopic torque implicit, world frame",
                                      BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_WORLD},
          std::pair<const char*, int>{"gyroscopic torque explicit", BT_ENABLE_GYROSCOPIC_FORCE_EXPLICIT},
          std::pair<const char*, int>{"no gyroscopic torque", 0}}) {
        contenders.push_back({"Bullet", version, method, numbers, false,
                              [flags = flags] { return std::make_unique<BulletTop>(flags); }});
    }
    return contest(argc, argv, contenders);
}

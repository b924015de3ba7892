// The Open Dynamics Engine: one body without gravity, with and without its gyroscopic torque (implicit), and with both
// of its updates of an orientation: by the derivative of the quaternion ("infinitesimal", the default) or by a rotation
// about the current axis ("finite").
#include "contender.hpp"

#include <ode/ode.h>

namespace {

using namespace tumble::bench;

class OdeTop final : public Runner {
public:
    OdeTop(bool gyroscopic, bool finite) {
        dMass mass;
        dMassSetParameters(&mass, 1, 0, 0, 0, top_moments[0], top_moments[1], top_moments[2], 0, 0, 0);
        dBodySetMass(body_, &mass);
        dBodySetAngularVel(body_, top_spin[0], top_spin[1],
                           top_spin[2]);  // world frame: at first the body frame
        dBodySetGyroscopicMode(body_, gyroscopic ? 1 : 0);
        dBodySetFiniteRotationMode(body_, finite ? 1 : 0);
    }
    OdeTop(const OdeTop&) = delete;
    OdeTop& operator=(const OdeTop&) = delete;
    ~OdeTop() override { dWorldDestroy(world_); }

    void step() override { dWorldStep(world_, dReal(1) / top_steps_per_second); }
    [[nodiscard]] std::array<double, 4> orientation() const override {
        const dReal* q = dBodyGetQuaternion(body_);
        return {q[0], q[1], q[2], q[3]};
    }
    [[nodiscard]] std::array<double, 3> spin() const override {
        const dReal* w = dBodyGetAngularVel(body_);
        return to_body(orientation(), {w[0], w[1], w[2]});
    }

private:
    dWorldID world_ = dWorldCreate();
    dBodyID body_ = dBodyCreate(world_);
};

}  // namespace

int main(int argc, char** argv) {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    const std::string numbers = sizeof(dReal) == 8 ? "f64" : "f32";
    std::vector<Contender> contenders;
    const auto add = [&](const char* method, bool gyroscopic, bool finite) {
        contenders.push_back({"ODE", TUMBLE_ENGINE_VERSION, method, numbers, false,
                              [=] { return std::make_unique<OdeTop>(gyroscopic, finite); }});
    };
    add("gyroscopic torque, infinitesimal rotation", true, false);
    add("gyroscopic torque, finite rotation", true, true);
    add("no gyroscopic torque", false, false);
    const int status = contest(argc, argv, contenders);
    dCloseODE();
    return status;
}

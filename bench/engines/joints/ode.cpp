// The Open Dynamics Engine: joints are constraints between bodies, solved directly by its step and by sweeps in its
// quick step. Otherwise its default settings.
#include "contest.hpp"

#include <ode/ode.h>

#include <stdexcept>

namespace {

using namespace tumble::bench;
using tumble::reference::Motion, tumble::reference::Rotation, tumble::reference::Vector;

dReal number(long double value) { return static_cast<dReal>(value); }

class OdeRunner final : public Runner {
public:
    OdeRunner(const Mechanism& mechanism, int rate, bool quick) : step_{dReal(1) / rate}, quick_{quick} {
        dWorldSetGravity(world_, 0, -gravity, 0);
        for (const Link& link : mechanism.links) {
            const dBodyID body = dBodyCreate(world_), before = bodies_.empty() ? nullptr : bodies_.back();
            const Motion& start = link.start;
            dMass mass;
            dMassSetParameters(&mass, number(link.mass), 0, 0, 0, number(link.moments.x), number(link.moments.y),
                               number(link.moments.z), 0, 0, 0);
            dBodySetMass(body, &mass);
            dBodySetPosition(body, number(start.x.x), number(start.x.y), number(start.x.z));
            const dQuaternion q{number(start.q.w), number(start.q.v.x), number(start.q.v.y), number(start.q.v.z)};
            dBodySetQuaternion(body, q);
            dBodySetLinearVel(body, number(start.v.x), number(start.v.y), number(start.v.z));
            const Vector w = start.q.rotate(start.w);
            dBodySetAngularVel(body, number(w.x), number(w.y), number(w.z));
            const Vector &at = link.anchor, &axis = link.axis;
            const dJointID joint =
                link.is_hinge() ? dJointCreateHinge(world_, nullptr) : dJointCreateBall(world_, nullptr);
            dJointAttach(joint, body, before);
            if (link.is_hinge()) {
                dJointSetHingeAnchor(joint, number(at.x), number(at.y), number(at.z));
                dJointSetHingeAxis(joint, number(axis.x), number(axis.y), number(axis.z));
            } else dJointSetBallAnchor(joint, number(at.x), number(at.y), number(at.z));
            bodies_.push_back(body);
        }
        dRandSetSeed(0);  // of the order in which the quick step visits constraints
    }
    OdeRunner(const OdeRunner&) = delete;
    OdeRunner& operator=(const OdeRunner&) = delete;
    ~OdeRunner() override { dWorldDestroy(world_); }

    void step() override {
        if ((quick_ ? dWorldQuickStep(world_, step_) : dWorldStep(world_, step_)) == 0)
            throw std::runtime_error{"ODE cannot allocate memory for a step"};
    }
    [[nodiscard]] std::vector<Motion> motions() override {
        std::vector<Motion> motions;
        for (const dBodyID body : bodies_) {
            const Rotation q = tumble::reference::rotation_of(dBodyGetQuaternion(body));
            motions.push_back({tumble::reference::vector_of(dBodyGetPosition(body)),
                               tumble::reference::vector_of(dBodyGetLinearVel(body)), q,
                               q.rotate_back(tumble::reference::vector_of(dBodyGetAngularVel(body)))});
        }
        return motions;
    }

private:
    dWorldID world_ = dWorldCreate();
    std::vector<dBodyID> bodies_;
    dReal step_;
    bool quick_;
};

}  // namespace

int main(int argc, char** argv) {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    std::vector<Contender> contenders;
    for (const bool quick : {false, true})
        contenders.push_back({"ODE", TUMBLE_ENGINE_VERSION, quick ? "quick step" : "step",
                              sizeof(dReal) == 8 ? "f64" : "f32", false, [quick](const Mechanism& mechanism, int rate) {
                                  return std::make_unique<OdeRunner>(mechanism, rate, quick);
                              }});
    const int status = joint_contest(argc, argv, contenders);
    dCloseODE();
    return status;
}

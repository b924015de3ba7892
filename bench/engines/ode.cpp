// The Open Dynamics Engine with its direct step and its iterative quick step; without contacts the direct step only.
// Bodies that cannot touch each other are tested against the plane only. Drag is ODE's damping. ODE has no springs to a
// point and no gravitation. By default a body has its gyroscopic torque (implicit), and its orientation is updated by
// the derivative of the quaternion ("infinitesimal"), not by a rotation about the current axis ("finite").
#include "contender.hpp"
#include "core/ode_contacts.hpp"

#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace {

using namespace tumble;
using namespace tumble::bench;

dReal scalar(Real value) { return static_cast<dReal>(value.to_double()); }
// Calls f with the elements.
void with(const reference::Vector& v, const auto& f) {
    f(static_cast<dReal>(v.x), static_cast<dReal>(v.y), static_cast<dReal>(v.z));
}

struct OdeMethod {
    bool quick = false, gyroscopic = true, finite = false;
};

// Keeps the library initialized while there are worlds.
class Library {
public:
    Library() {
        dInitODE2(0);
        dAllocateODEDataForThread(dAllocateMaskAll);
        // ODE prints a message for every step whose contacts it has not solved.
        dSetMessageHandler([](int, const char* format, va_list values) {
            char text[200];
            (void)std::vsnprintf(text, sizeof text, format, values);
            message = text;
        });
    }
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;
    ~Library() { dCloseODE(); }

    static inline std::string message;  // the last one
};

class World {
public:
    World(const Problem& problem, const OdeMethod& method)
        : step_{static_cast<dReal>(problem.step())}, quick_{method.quick}, touches_{problem.touches()},
          touch_each_other_{problem.features.pairs}, restitution_{scalar(problem.scene.world.contact.restitution)},
          friction_{scalar(problem.scene.world.contact.friction)} {
        Library::message.clear();
        dRandSetSeed(0);  // of the order in which the quick step visits contacts
        const SceneData& scene = problem.scene;
        const auto gravity = array_of<dReal>(scene.world.gravity);
        dWorldSetGravity(world_, gravity[0], gravity[1], gravity[2]);
        if (problem.sleeps()) {
            const SleepSpec& sleep = scene.world.contact.sleep;
            dWorldSetAutoDisableFlag(world_, 1);
            dWorldSetAutoDisableLinearThreshold(world_, scalar(sleep.speed));
            dWorldSetAutoDisableAngularThreshold(world_, scalar(sleep.angular_speed));
            dWorldSetAutoDisableTime(world_, scalar(sleep.time));
            dWorldSetAutoDisableSteps(world_, 0);
        }
        for (const BodySpec& spec : scene.bodies) {
            const dBodyID body = dBodyCreate(world_);
            bodies_.push_back(body);
            const auto moments = principal_moments(spec);
            dMass mass;
            dMassSetParameters(&mass, scalar(spec.mass), 0, 0, 0, moments[0], moments[1], moments[2], 0, 0, 0);
            dBodySetMass(body, &mass);
            if (spec.is_fixed()) dBodySetKinematic(body);
            dBodySetGyroscopicMode(body, method.gyroscopic ? 1 : 0);
            dBodySetFiniteRotationMode(body, method.finite ? 1 : 0);
            const reference::Motion start = start_of(spec);
            with(start.x, [&](auto... x) { dBodySetPosition(body, x...); });
            with(start.q.v, [&](auto... v) {
                const dQuaternion q{static_cast<dReal>(start.q.w), v...};
                dBodySetQuaternion(body, q);
            });
            with(start.v, [&](auto... v) { dBodySetLinearVel(body, v...); });
            with(start.q.rotate(start.w), [&](auto... w) { dBodySetAngularVel(body, w...); });
            if (scene.world.linear_drag > Real{}) {
                // The share of the velocity that a step loses.
                dBodySetLinearDamping(body,
                                      1 - std::exp(-scalar(scene.world.linear_drag / spec.mass) * problem.step()));
                dBodySetLinearDampingThreshold(body, 0);
            }
            if (!problem.touches()) continue;
            const auto size = array_of<dReal>(spec.shape.size);
            // A hoop is a thin cylinder.
            constexpr dReal thin = 1e-6;  // m
            const dGeomID shape = spec.shape.kind == ShapeKind::sphere ? dCreateSphere(space_, size[0])
                                  : spec.shape.kind == ShapeKind::hoop ? dCreateCylinder(space_, size[0], thin)
                                                                       : dCreateBox(space_, size[0], size[1], size[2]);
            dGeomSetBody(shape, body);
        }
        for (const PlaneSpec& plane : scene.planes) {
            const auto n = array_of<dReal>(plane.normal);
            planes_.push_back(
                dCreatePlane(touch_each_other_ ? space_ : nullptr, n[0], n[1], n[2], -scalar(plane.offset)));
        }
        for (std::size_t i = 0; i < problem.joints.size(); ++i) {
            const Joint& tie = problem.joints[i];
            const dJointID joint =
                tie.is_hinge() ? dJointCreateHinge(world_, nullptr) : dJointCreateBall(world_, nullptr);
            dJointAttach(joint, bodies_[i], i == 0 ? nullptr : bodies_[i - 1]);
            const auto set_anchor = tie.is_hinge() ? dJointSetHingeAnchor : dJointSetBallAnchor;
            with(tie.anchor, [&](auto... x) { set_anchor(joint, x...); });
            if (tie.is_hinge()) with(tie.axis, [&](auto... x) { dJointSetHingeAxis(joint, x...); });
        }
    }
    World(const World&) = delete;
    World& operator=(const World&) = delete;
    ~World() {
        dJointGroupDestroy(contacts_);
        if (!touch_each_other_)
            for (const dGeomID plane : planes_) dGeomDestroy(plane);
        dSpaceDestroy(space_);
        dWorldDestroy(world_);
    }

    void step() {
        if (touches_) meet();
        if ((quick_ ? dWorldQuickStep(world_, step_) : dWorldStep(world_, step_)) == 0)
            throw std::runtime_error{"ODE cannot allocate memory for a step"};
    }
    [[nodiscard]] Motions motions() const {
        Motions motions;
        for (const dBodyID body : bodies_) {
            const reference::Rotation q = reference::rotation_of(dBodyGetQuaternion(body));
            motions.push_back({reference::vector_of(dBodyGetPosition(body)),
                               reference::vector_of(dBodyGetLinearVel(body)), q,
                               q.normalized().rotate_back(reference::vector_of(dBodyGetAngularVel(body)))});
        }
        return motions;
    }
    [[nodiscard]] bool asleep(int body) const { return dBodyIsEnabled(bodies_[static_cast<std::size_t>(body)]) == 0; }
    [[nodiscard]] static std::string trouble() { return Library::message; }

private:
    void meet() {
        dJointGroupEmpty(contacts_);
        if (touch_each_other_) dSpaceCollide(space_, this, meet);
        else
            for (const dGeomID plane : planes_) dSpaceCollide2(plane, reinterpret_cast<dGeomID>(space_), this, meet);
    }
    static void meet(void* of, dGeomID a, dGeomID b) {
        World& world = *static_cast<World*>(of);
        const auto is_still = [](dBodyID body) { return body == nullptr || dBodyIsEnabled(body) == 0; };
        if (is_still(dGeomGetBody(a)) && is_still(dGeomGetBody(b))) return;
        add_contacts(world.world_, world.contacts_, a, b, world.friction_, world.restitution_);
    }

    dWorldID world_ = dWorldCreate();
    dSpaceID space_ = dHashSpaceCreate(nullptr);
    dJointGroupID contacts_ = dJointGroupCreate(0);
    std::vector<dBodyID> bodies_;
    std::vector<dGeomID> planes_;
    dReal step_;  // s
    bool quick_, touches_, touch_each_other_;
    dReal restitution_, friction_;
};

void add(Contenders& contenders, const char* name, const OdeMethod& method) {
    static const Library library;
    contenders.push_back({"ODE", TUMBLE_ODE_VERSION, name, sizeof(dReal) == 8 ? "f64" : "f32", false,
                          [=](const Problem& problem) -> std::unique_ptr<Runner> {
                              const bool lacks = problem.features.springs > 0 || problem.features.gravitation;
                              if (lacks || (method.quick && !problem.touches() && problem.joints.empty()))
                                  return nullptr;
                              return std::make_unique<RemakingRunner<World>>(problem, method);
                          }});
}

}  // namespace

void tumble::bench::add_ode(Contenders& contenders) {
    add(contenders, "step", {});
    add(contenders, "quick step", {.quick = true});
}
void tumble::bench::add_ode_tops(Contenders& contenders) {
    add(contenders, "gyroscopic torque, infinitesimal rotation", {});
    add(contenders, "gyroscopic torque, finite rotation", {.finite = true});
    add(contenders, "no gyroscopic torque", {.gyroscopic = false});
}

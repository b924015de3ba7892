// The Open Dynamics Engine with its direct step and its iterative quick step; without contacts the direct step only.
// Bodies that cannot touch each other are tested against the plane only. Drag is ODE's damping. ODE has no springs to a
// point and no gravitation.
#include "contender.hpp"

#include <ode/ode.h>

#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace {

using namespace tumble;
using namespace tumble::bench;

dReal scalar(Real value) { return static_cast<dReal>(value.to_double()); }

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
    World(const Problem& problem, bool quick)
        : quick_{quick}, touch_each_other_{problem.features.pairs},
          restitution_{scalar(problem.scene.world.contact.restitution)}, friction_{scalar(
                                                                             problem.scene.world.contact.friction)} {
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
            const auto x = array_of<dReal>(spec.position), v = array_of<dReal>(spec.velocity);
            const RealQuat q = normalized(spec.orientation);
            const auto u = array_of<dReal>(q.v);
            const dQuaternion orientation{scalar(q.w), u[0], u[1], u[2]};
            dBodySetPosition(body, x[0], x[1], x[2]);
            dBodySetQuaternion(body, orientation);
            dBodySetLinearVel(body, v[0], v[1], v[2]);
            const auto w = array_of<dReal>(spec.angular_velocity);
            dVector3 spin;
            dBodyVectorToWorld(body, w[0], w[1], w[2], spin);
            dBodySetAngularVel(body, spin[0], spin[1], spin[2]);
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

    void step(dReal seconds) {
        if (touch_each_other_) dSpaceCollide(space_, this, meet);
        else
            for (const dGeomID plane : planes_) dSpaceCollide2(plane, reinterpret_cast<dGeomID>(space_), this, meet);
        if ((quick_ ? dWorldQuickStep(world_, seconds) : dWorldStep(world_, seconds)) == 0)
            throw std::runtime_error{"ODE cannot allocate memory for a step"};
        dJointGroupEmpty(contacts_);
    }
    [[nodiscard]] dBodyID body(int index) const { return bodies_[static_cast<std::size_t>(index)]; }

private:
    static void meet(void* of, dGeomID a, dGeomID b) {
        World& world = *static_cast<World*>(of);
        const dBodyID body_a = dGeomGetBody(a), body_b = dGeomGetBody(b);
        const auto is_still = [](dBodyID body) { return body == nullptr || dBodyIsEnabled(body) == 0; };
        if (is_still(body_a) && is_still(body_b)) return;
        constexpr int most = 8;
        dContact contacts[most]{};
        const int count = dCollide(a, b, most, &contacts[0].geom, sizeof(dContact));
        for (int i = 0; i < count; ++i) {
            dSurfaceParameters& surface = contacts[i].surface;
            surface.mode = dContactBounce | dContactApprox1;
            surface.mu = world.friction_;
            surface.bounce = world.restitution_;
            dJointAttach(dJointCreateContact(world.world_, world.contacts_, &contacts[i]), body_a, body_b);
        }
    }

    dWorldID world_ = dWorldCreate();
    dSpaceID space_ = dHashSpaceCreate(nullptr);
    dJointGroupID contacts_ = dJointGroupCreate(0);
    std::vector<dBodyID> bodies_;
    std::vector<dGeomID> planes_;
    bool quick_, touch_each_other_;
    dReal restitution_, friction_;
};

class OdeRunner final : public Runner {
public:
    OdeRunner(const Problem& problem, bool quick) : problem_{problem}, quick_{quick} { restart(); }

    void restart() override {
        world_.reset();
        world_ = std::make_unique<World>(problem_, quick_);
        Library::message.clear();
        dRandSetSeed(0);  // of the order in which the quick step visits contacts
    }
    void run(int steps) override {
        for (int i = 0; i < steps; ++i) world_->step(step_);
    }
    [[nodiscard]] reference::Motion motion(int index) const override {
        const dBodyID body = world_->body(index);
        const reference::Rotation q = reference::rotation_of(dBodyGetQuaternion(body));
        return {reference::vector_of(dBodyGetPosition(body)), reference::vector_of(dBodyGetLinearVel(body)), q,
                q.rotate_back(reference::vector_of(dBodyGetAngularVel(body)))};
    }
    [[nodiscard]] bool asleep(int body) const override { return dBodyIsEnabled(world_->body(body)) == 0; }
    [[nodiscard]] std::string trouble() const override { return Library::message; }

private:
    const Problem& problem_;
    bool quick_;
    dReal step_ = static_cast<dReal>(problem_.step());
    std::unique_ptr<World> world_;
};

}  // namespace

void tumble::bench::add_ode(std::vector<Contender>& contenders) {
    static const Library library;
    for (const bool quick : {false, true}) {
        contenders.push_back(
            {"ODE", TUMBLE_ODE_VERSION, quick ? "quick step" : "step", sizeof(dReal) == 8 ? "f64" : "f32", false,
             [=](const Problem& problem) -> std::unique_ptr<Runner> {
                 if (problem.features.springs > 0 || problem.features.gravitation || (quick && !problem.touches()))
                     return nullptr;
                 return std::make_unique<OdeRunner>(problem, quick);
             }});
    }
}

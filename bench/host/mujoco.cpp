// MuJoCo with its Euler and its RK4, and with its constraint solvers: Newton's method for small scenes, and conjugate
// gradients, which need no matrix of all bodies. Contacts are soft, the default; a bouncing contact is a spring with
// the damping of its restitution. A spring is a tendon, and drag is the damping of a joint. MuJoCo has no gravitation
// and, in this version, no sleep.
#include "contender.hpp"
#include "engines/mujoco_model.hpp"
#include "tools/text.hpp"

#include <cmath>
#include <numbers>
#include <sstream>

namespace {

using namespace tumble;
using namespace tumble::bench;

std::string text(double x) { return host::seventeen_digits(x); }
std::string text(const RealVec3& v) {
    const auto a = array_of<double>(v);
    return text(a[0]) + " " + text(a[1]) + " " + text(a[2]);
}

struct MujocoMethod {
    const char *name, *integrator, *solver;
};

// The attributes of a contact.
std::string contact_xml(const Problem& problem) {
    const ContactSpec& spec = problem.scene.world.contact;
    std::string xml =
        problem.features.friction ? "condim='3' friction='" + text(spec.friction.to_double()) + " 0 0'" : "condim='1'";
    const double restitution = spec.restitution.to_double();
    if (restitution > 0) {
        // The contact is half an oscillation that ten steps resolve; at its end the speed is that of the restitution.
        const double rate = std::numbers::pi / (5 * problem.step()), log = -std::log(restitution);
        const double damping = log / std::hypot(log, std::numbers::pi);
        xml += " solref='" + text(-rate * rate) + " " + text(-2 * damping * rate) + "' solimp='0.99 0.99 0.001 0.5 2'";
    }
    return xml;
}

// The springs, between sites that are named after their indices.
std::string tendons_xml(const std::vector<SpringSpec>& springs) {
    std::ostringstream xml;
    for (std::size_t s = 0; s < springs.size(); ++s) {
        const SpringSpec& spring = springs[s];
        xml << "<spatial stiffness='" << text(spring.stiffness.to_double()) << "' damping='"
            << text(spring.damping.to_double()) << "' springlength='" << text(spring.rest_length.to_double())
            << "'><site site='from" << s << "'/><site site='to" << s << "'/></spatial>";
    }
    return springs.empty() ? "" : "<tendon>" + xml.str() + "</tendon>";
}

// The joint of a body. There are no kinematic bodies; a fixed one that turns is a flywheel.
std::string joint_xml(const Problem& problem, const BodySpec& body) {
    if (!body.is_fixed())
        return "<joint type='free' damping='" + text(problem.scene.world.linear_drag.to_double()) + "'/>";
    constexpr double inertia = 1e6;  // kg m^2
    return "<joint type='hinge' axis='" + text(body.angular_velocity) + "' armature='" + text(inertia) + "'/>";
}

std::string xml_of(const Problem& problem, const MujocoMethod& method) {
    const SceneData& scene = problem.scene;
    const std::size_t bodies = scene.bodies.size();
    std::ostringstream xml;
    xml << "<mujoco><option timestep='" << text(problem.step()) << "' gravity='" << text(scene.world.gravity)
        << "' integrator='" << method.integrator << "' solver='" << method.solver << "'/>";
    // Four points for each body on the plane, twice as many in a stack; with friction four rows for each point.
    const bool rough = problem.features.friction;
    const std::size_t points = problem.touches() ? (rough ? 8 : 4) * bodies : 0;
    xml << "<size nconmax='" << points << "' njmax='" << (rough ? 4 : 1) * points << "'/>";

    const std::string contact = contact_xml(problem);
    xml << "<worldbody>";
    for (const PlaneSpec& plane : scene.planes) {
        const auto n = array_of<double>(normalized(plane.normal));
        const double d = -plane.offset.to_double();
        xml << "<geom type='plane' size='0 0 1' zaxis='" << text(plane.normal) << "' pos='" << text(n[0] * d) << " "
            << text(n[1] * d) << " " << text(n[2] * d) << "' contype='1' conaffinity='2' " << contact << "/>";
    }
    for (std::size_t b = 0; b < bodies; ++b) {
        const BodySpec& body = scene.bodies[b];
        const RealQuat q = normalized(body.orientation);
        const auto moments = principal_moments(body);
        xml << "<body pos='" << text(body.position) << "' quat='" << text(q.w.to_double()) << " " << text(q.v) << "'>"
            << joint_xml(problem, body) << "<inertial pos='0 0 0' mass='" << text(body.mass.to_double())
            << "' diaginertia='" << text(moments[0]) << " " << text(moments[1]) << " " << text(moments[2]) << "'/>";
        for (std::size_t s = 0; s < scene.springs.size(); ++s)
            if (scene.springs[s].body == static_cast<int>(b))
                xml << "<site name='from" << s << "' pos='" << text(scene.springs[s].point) << "'/>";
        if (problem.touches()) {
            // A hoop is a thin cylinder.
            const ShapeKind kind = body.shape.kind;
            const auto size = array_of<double>(body.shape.size);
            xml << "<geom type='"
                << (kind == ShapeKind::sphere ? "sphere' size='" + text(size[0])
                    : kind == ShapeKind::hoop
                        ? "cylinder' size='" + text(size[0]) + " 1e-6"
                        : "box' size='" + text(size[0] / 2) + " " + text(size[1] / 2) + " " + text(size[2] / 2))
                << "' contype='2' conaffinity='" << (problem.features.pairs ? 3 : 1) << "' " << contact << "/>";
        }
        xml << "</body>";
    }
    for (std::size_t s = 0; s < scene.springs.size(); ++s)
        xml << "<site name='to" << s << "' pos='" << text(scene.springs[s].to) << "'/>";
    xml << "</worldbody>" << tendons_xml(scene.springs) << "</mujoco>";
    return xml.str();
}

class MujocoRunner final : public Runner {
public:
    MujocoRunner(const Problem& problem, const MujocoMethod& method)
        : bodies_{problem.scene.bodies}, model_{mujoco_model(xml_of(problem, method))}, data_{
                                                                                            mj_makeData(model_.get())} {
        if (!data_) throw std::runtime_error{"MuJoCo cannot allocate its data"};
        restart();
    }

    void restart() override {
        mj_resetData(model_.get(), data_.get());
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            const auto v = array_of<double>(bodies_[b].velocity), w = array_of<double>(bodies_[b].angular_velocity);
            mjtNum* velocity = data_->qvel + model_->jnt_dofadr[b];
            if (bodies_[b].is_fixed()) {
                *velocity = std::hypot(w[0], w[1], w[2]);
                continue;
            }
            for (std::size_t i = 0; i < 3; ++i) {
                velocity[i] = v[i];
                velocity[3 + i] = w[i];  // body frame
            }
        }
    }
    void run(int steps) override {
        for (int i = 0; i < steps; ++i) mj_step(model_.get(), data_.get());
    }
    [[nodiscard]] reference::Motion motion(int body) const override {
        for (int warning = 0; warning < mjNWARNING; ++warning)
            if (data_->warning[warning].number > 0)
                throw std::runtime_error{std::string{"MuJoCo: "} +
                                         mju_warningText(warning, data_->warning[warning].lastinfo)};
        const mjtNum *x = data_->qpos + model_->jnt_qposadr[body], *v = data_->qvel + model_->jnt_dofadr[body];
        return {reference::vector_of(x), reference::vector_of(v), reference::rotation_of(x + 3),
                reference::vector_of(v + 3)};
    }
    [[nodiscard]] bool asleep(int) const override { return false; }

private:
    const std::vector<BodySpec>& bodies_;
    MujocoModel model_;
    MujocoData data_;
};

}  // namespace

void tumble::bench::add_mujoco(std::vector<Contender>& contenders) {
    // With more bodies Newton's matrix is too large. Without contacts there is nothing to solve.
    constexpr std::size_t most_for_newton = 10;
    static constexpr MujocoMethod methods[]{{"Euler", "Euler", "CG"},
                                            {"RK4", "RK4", "CG"},
                                            {"Euler, Newton", "Euler", "Newton"},
                                            {"Euler, conjugate gradients", "Euler", "CG"}};
    for (const MujocoMethod& method : methods) {
        const bool solves = std::string{method.name}.find(',') != std::string::npos,
                   newton = method.solver == std::string{"Newton"};
        contenders.push_back({"MuJoCo", mj_versionString(), method.name, sizeof(mjtNum) == 8 ? "f64" : "f32", false,
                              [=](const Problem& problem) -> std::unique_ptr<Runner> {
                                  if (problem.features.gravitation || problem.features.springs > 1 ||
                                      problem.sleeps() || problem.touches() != solves ||
                                      (newton && problem.scene.bodies.size() > most_for_newton))
                                      return nullptr;
                                  return std::make_unique<MujocoRunner>(problem, method);
                              }});
    }
}

// MuJoCo with its integrators, and with its constraint solvers: Newton's method for small scenes, and conjugate
// gradients, which need no matrix of all bodies. Contacts are soft, the default; a bouncing contact is a spring with
// the damping of its restitution. A spring is a tendon, and drag is the damping of a joint. The joints of a
// mechanism are its coordinates, without a gap. MuJoCo has no gravitation and, in this version, no sleep.
#include "contender.hpp"
#include "tools/text.hpp"

#include <mujoco/mujoco.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <sstream>

namespace {

using namespace tumble;
using namespace tumble::bench;
using reference::Motion, reference::Vector;

struct Deleter {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
};
using Model = std::unique_ptr<mjModel, Deleter>;

// The model of a description. Throws std::runtime_error with MuJoCo's own message.
Model model_of(const std::string& xml) {
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "scene.xml", static_cast<int>(xml.size()) + 1);
    const int file = mj_findFileVFS(files.get(), "scene.xml");
    if (file < 0) throw std::runtime_error{"MuJoCo takes no file"};
    std::memcpy(files->filedata[file], xml.c_str(), xml.size() + 1);
    char message[1000] = "";
    Model model{mj_loadXML("scene.xml", files.get(), message, sizeof message)};
    mj_deleteVFS(files.get());
    if (!model) throw std::runtime_error{message};
    return model;
}

std::string text(double x) { return host::seventeen_digits(x); }
std::string text(const Vector& v) {
    const auto number = [](long double x) { return text(static_cast<double>(x)); };
    return number(v.x) + " " + number(v.y) + " " + number(v.z);
}
std::string text(const RealVec3& v) { return text(reference::vector_of(array_of<double>(v))); }

struct MujocoMethod {
    const char *name, *integrator;
    const char* solver = nullptr;  // null: the default one, with its default room for contacts
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
std::string joint_xml(const Problem& problem, std::size_t b) {
    const BodySpec& body = problem.scene.bodies[b];
    if (!problem.joints.empty()) {
        const Joint& joint = problem.joints[b];
        return (joint.is_hinge() ? "<joint type='hinge' axis='" + text(joint.own_axis) : "<joint type='ball") +
               "' pos='" + text(joint.on_own) + "'/>";
    }
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
        << "' integrator='" << method.integrator;
    if (method.solver != nullptr) {
        // Four points for each body on the plane, twice as many in a stack; with friction four rows for each point.
        const bool rough = problem.features.friction;
        const std::size_t points = problem.touches() ? (rough ? 8 : 4) * bodies : 0;
        xml << "' solver='" << method.solver << "'/><size nconmax='" << points << "' njmax='"
            << (rough ? 4 : 1) * points;
    }
    xml << "'/>";

    const std::string contact = contact_xml(problem);
    const bool tied = !problem.joints.empty();
    Motion parent;
    xml << "<worldbody>";
    for (const PlaneSpec& plane : scene.planes) {
        const auto n = array_of<double>(normalized(plane.normal));
        const double d = -plane.offset.to_double();
        xml << "<geom type='plane' size='0 0 1' zaxis='" << text(plane.normal) << "' pos='" << text(n[0] * d) << " "
            << text(n[1] * d) << " " << text(n[2] * d) << "' contype='1' conaffinity='2' " << contact << "/>";
    }
    for (std::size_t b = 0; b < bodies; ++b) {
        const BodySpec& body = scene.bodies[b];
        const Motion start = start_of(body);
        // A tied body is part of the one before, at its place in its frame.
        const reference::Rotation q = parent.q.conjugate() * start.q;
        const auto moments = principal_moments(body);
        xml << "<body pos='" << text(parent.q.rotate_back(start.x - parent.x)) << "' quat='"
            << text(static_cast<double>(q.w)) << " " << text(q.v) << "'>" << joint_xml(problem, b)
            << "<inertial pos='0 0 0' mass='" << text(body.mass.to_double()) << "' diaginertia='" << text(moments[0])
            << " " << text(moments[1]) << " " << text(moments[2]) << "'/>";
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
        if (tied) parent = start;
        else xml << "</body>";
    }
    if (tied)
        for (std::size_t b = 0; b < bodies; ++b) xml << "</body>";
    for (std::size_t s = 0; s < scene.springs.size(); ++s)
        xml << "<site name='to" << s << "' pos='" << text(scene.springs[s].to) << "'/>";
    xml << "</worldbody>" << tendons_xml(scene.springs) << "</mujoco>";
    return xml.str();
}

class MujocoRunner final : public Runner {
public:
    MujocoRunner(const Problem& problem, const MujocoMethod& method)
        : problem_{problem}, model_{model_of(xml_of(problem, method))}, data_{mj_makeData(model_.get())} {
        if (!data_) throw std::runtime_error{"MuJoCo cannot allocate its data"};
        restart();
    }

    void restart() override {
        mj_resetData(model_.get(), data_.get());
        for (std::size_t b = 0; b < problem_.scene.bodies.size(); ++b) {
            const BodySpec& body = problem_.scene.bodies[b];
            const Motion start = start_of(body);
            mjtNum* velocity = data_->qvel + model_->jnt_dofadr[b];
            const auto set = [&](mjtNum* to, const Vector& v) {
                for (int i = 0; i < 3; ++i) to[i] = static_cast<mjtNum>(v[i]);
            };
            if (!problem_.joints.empty()) {
                const Joint& joint = problem_.joints[b];
                if (joint.is_hinge()) *velocity = static_cast<mjtNum>(dot(joint.own_axis, joint.spin));
                else set(velocity, joint.spin);
            } else if (body.is_fixed()) *velocity = static_cast<mjtNum>(norm(start.w));
            else {
                set(velocity, start.v);
                set(velocity + 3, start.w);  // body frame
            }
        }
    }
    void step() override { mj_step(model_.get(), data_.get()); }
    [[nodiscard]] Motions motions() override {
        if (!problem_.joints.empty()) return motions_of_mechanism();
        if (!trouble().empty()) throw std::runtime_error{"MuJoCo: " + trouble()};
        Motions motions;
        for (std::size_t b = 0; b < problem_.scene.bodies.size(); ++b) {
            if (problem_.scene.bodies[b].is_fixed()) {
                motions.emplace_back();
                continue;
            }
            const mjtNum *x = data_->qpos + model_->jnt_qposadr[b], *v = data_->qvel + model_->jnt_dofadr[b];
            motions.push_back({reference::vector_of(x), reference::vector_of(v), reference::rotation_of(x + 3),
                               reference::vector_of(v + 3)});
        }
        return motions;
    }
    [[nodiscard]] bool asleep(int) const override { return false; }
    [[nodiscard]] std::string trouble() const override {
        for (int warning = 0; warning < mjNWARNING; ++warning)
            if (data_->warning[warning].number > 0) return mju_warningText(warning, data_->warning[warning].lastinfo);
        return "";
    }

private:
    [[nodiscard]] Motions motions_of_mechanism() {
        mj_kinematics(model_.get(), data_.get());  // a step leaves the places of its start
        Motions motions;
        std::vector<Vector> turns;
        for (std::size_t b = 0; b < problem_.joints.size(); ++b) {
            const Joint& joint = problem_.joints[b];
            motions.push_back({reference::vector_of(data_->xpos + 3 * (b + 1)),
                               {},
                               reference::rotation_of(data_->xquat + 4 * (b + 1)),
                               {}});
            const mjtNum* speed = data_->qvel + model_->jnt_dofadr[b];
            turns.push_back(joint.is_hinge() ? joint.own_axis * static_cast<long double>(*speed)
                                             : reference::vector_of(speed));
        }
        set_velocities(problem_.joints, turns, motions);
        return motions;
    }

    const Problem& problem_;
    Model model_;
    std::unique_ptr<mjData, Deleter> data_;
};

void add(Contenders& contenders, const MujocoMethod& method) {
    mju_user_warning = [](const char*) {};  // trouble() tells
    // With more bodies Newton's matrix is too large. Without contacts there is nothing to solve.
    constexpr std::size_t most_for_newton = 10;
    const bool solves = std::string{method.name}.find(',') != std::string::npos,
               newton = solves && method.solver == std::string{"Newton"};
    contenders.push_back({"MuJoCo", mj_versionString(), method.name, sizeof(mjtNum) == 8 ? "f64" : "f32", false,
                          [=](const Problem& problem) -> std::unique_ptr<Runner> {
                              if (problem.features.gravitation || problem.features.springs > 1 || problem.sleeps() ||
                                  problem.touches() != solves ||
                                  (newton && problem.scene.bodies.size() > most_for_newton))
                                  return nullptr;
                              return std::make_unique<MujocoRunner>(problem, method);
                          }});
}

}  // namespace

void tumble::bench::add_mujoco(Contenders& contenders) {
    add(contenders, {"Euler", "Euler", "CG"});
    add(contenders, {"RK4", "RK4", "CG"});
    add(contenders, {"Euler, Newton", "Euler", "Newton"});
    add(contenders, {"Euler, conjugate gradients", "Euler", "CG"});
}
void tumble::bench::add_mujoco_tops(Contenders& contenders) {
    for (const char* integrator : {"Euler", "implicit", "RK4"}) add(contenders, {integrator, integrator});
}
void tumble::bench::add_mujoco_joints(Contenders& contenders) {
    for (const char* integrator : {"Euler", "RK4"}) add(contenders, {integrator, integrator});
}

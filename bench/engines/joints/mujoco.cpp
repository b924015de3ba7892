// MuJoCo: joints are its coordinates, so there is no constraint, no contact and no gap.
#include "contest.hpp"

#include "../mujoco_model.hpp"

#include <sstream>

namespace {

using namespace tumble::bench;
using tumble::reference::Motion, tumble::reference::Rotation, tumble::reference::Vector;

std::string text(Vector v) {
    std::ostringstream out;
    out.precision(17);
    out << static_cast<double>(v.x) << ' ' << static_cast<double>(v.y) << ' ' << static_cast<double>(v.z);
    return out.str();
}

// A link's frame is that of its start, so that all coordinates start at zero.
std::string xml_of(const Mechanism& mechanism) {
    std::ostringstream xml;
    xml.precision(17);
    xml << "<mujoco><option gravity='0 " << -gravity << " 0'/><worldbody>";
    Motion before;
    for (const Link& link : mechanism.links) {
        const Rotation q = before.q.conjugate() * link.start.q;
        xml << "<body pos='" << text(before.q.rotate_back(link.start.x - before.x)) << "' quat='"
            << static_cast<double>(q.w) << ' ' << text(q.v) << "'><joint type='"
            << (link.is_hinge() ? "hinge' axis='" + text(link.own_axis()) : "ball") << "' pos='" << text(link.to_own)
            << "'/><inertial pos='0 0 0' mass='" << link.mass << "' diaginertia='" << text(link.moments) << "'/>";
        before = link.start;
    }
    for (std::size_t i = 0; i < mechanism.links.size(); ++i) xml << "</body>";
    xml << "</worldbody></mujoco>";
    return xml.str();
}

class MujocoRunner final : public Runner {
public:
    MujocoRunner(const Mechanism& mechanism, int rate, int integrator)
        : mechanism_{mechanism}, model_{mujoco_model(xml_of(mechanism))} {
        model_->opt.timestep = 1.0 / rate;
        model_->opt.integrator = integrator;
        data_.reset(mj_makeData(model_.get()));
        Vector spin{};
        mjtNum* speed = data_->qvel;
        for (const Link& link : mechanism.links) {
            const Vector own = link.start.w - link.start.q.rotate_back(spin);
            if (link.is_hinge()) *speed++ = static_cast<mjtNum>(dot(link.own_axis(), own));
            else
                for (int i = 0; i < 3; ++i) *speed++ = static_cast<mjtNum>(own[i]);
            spin = link.start.q.rotate(link.start.w);
        }
    }

    void step() override { mj_step(model_.get(), data_.get()); }
    [[nodiscard]] std::vector<Motion> motions() override {
        mj_kinematics(model_.get(), data_.get());  // a step leaves the places of its start
        std::vector<Motion> motions;
        std::vector<Vector> turns;
        const mjtNum* speed = data_->qvel;
        for (std::size_t i = 0; i < mechanism_.links.size(); ++i) {
            const Link& link = mechanism_.links[i];
            motions.push_back({tumble::reference::vector_of(data_->xpos + 3 * (i + 1)),
                               {},
                               tumble::reference::rotation_of(data_->xquat + 4 * (i + 1)),
                               {}});
            turns.push_back(link.is_hinge() ? link.own_axis() * static_cast<long double>(*speed)
                                            : tumble::reference::vector_of(speed));
            speed += link.is_hinge() ? 1 : 3;
        }
        mechanism_.set_velocities(motions, turns);
        return motions;
    }
    [[nodiscard]] std::string trouble() const override {
        for (int warning = 0; warning < mjNWARNING; ++warning)
            if (data_->warning[warning].number > 0) return mju_warningText(warning, data_->warning[warning].lastinfo);
        return "";
    }

private:
    const Mechanism& mechanism_;
    MujocoModel model_;
    MujocoData data_;
};

}  // namespace

int main(int argc, char** argv) {
    mju_user_warning = [](const char*) {};  // trouble() tells
    std::vector<Contender> contenders;
    for (const auto& [method, integrator] : {std::pair{"Euler", mjINT_EULER}, std::pair{"RK4", mjINT_RK4}})
        contenders.push_back({"MuJoCo", mj_versionString(), method, sizeof(mjtNum) == 8 ? "f64" : "f32", false,
                              [i = integrator](const Mechanism& mechanism, int rate) {
                                  return std::make_unique<MujocoRunner>(mechanism, rate, i);
                              }});
    return joint_contest(argc, argv, contenders);
}

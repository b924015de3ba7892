// MuJoCo: one body with a free joint and no gravity, with each integrator of its version.
#include "contender.hpp"
#include "mujoco_model.hpp"

namespace {

using namespace tumble::bench;

class MujocoTop final : public Runner {
public:
    explicit MujocoTop(int integrator) {
        const auto text = [](double x) { return std::to_string(x); };
        const std::string xml =
            "<mujoco><option gravity='0 0 0'/><worldbody><body><freejoint/><inertial pos='0 0 0' mass='1' "
            "diaginertia='" +
            text(top_moments[0]) + " " + text(top_moments[1]) + " " + text(top_moments[2]) +
            "'/></body></worldbody></mujoco>";
        model_ = mujoco_model(xml);
        model_->opt.timestep = 1.0 / top_steps_per_second;
        model_->opt.integrator = integrator;
        data_.reset(mj_makeData(model_.get()));
        for (int i = 0; i < 3; ++i) data_->qvel[3 + i] = top_spin[static_cast<std::size_t>(i)];  // rad/s, body frame
    }

    void step() override { mj_step(model_.get(), data_.get()); }
    [[nodiscard]] std::array<double, 4> orientation() const override {
        const mjtNum* q = data_->qpos + 3;
        return {q[0], q[1], q[2], q[3]};
    }
    [[nodiscard]] std::array<double, 3> spin() const override {
        return {data_->qvel[3], data_->qvel[4], data_->qvel[5]};
    }

private:
    MujocoModel model_;
    MujocoData data_;
};

}  // namespace

int main(int argc, char** argv) {
    std::vector<Contender> contenders;
    for (const auto& [method, integrator] :
         {std::pair{"Euler", mjINT_EULER}, std::pair{"implicit", mjINT_IMPLICIT}, std::pair{"RK4", mjINT_RK4}}) {
        contenders.push_back({"MuJoCo", mj_versionString(), method, sizeof(mjtNum) == 8 ? "f64" : "f32", false,
                              [i = integrator] { return std::make_unique<MujocoTop>(i); }});
    }
    return contest(argc, argv, contenders);
}

// This kernel: a world for each set of features that the problems need.
#pragma once

#include "contender.hpp"

#include <tumble/integrators/list.hpp>
#include <tumble/tumble.hpp>

#include "simulation/motion_of.hpp"

namespace tumble::bench {

template <class N, class Method, Features features>
class TumbleRunner final : public Runner {
public:
    explicit TumbleRunner(const Problem& problem)
        : replay_{Unjointed{problem.scene, {}}}, start_{with_joints(problem)} {
        for (const BodySpec& body : problem.scene.bodies) axes_.emplace_back(principal_inertia(body.inertia));
    }

    void restart() override { world() = start_; }
    // The whole step is one function, as in the firmware that the cores run.
    [[gnu::flatten]] void step() override { (void)world().step(); }
    [[nodiscard]] Motions motions() override {
        Motions motions;
        for (const host::PrincipalAxes& axes : axes_)
            motions.push_back(host::motion_of(world().bodies(), axes, static_cast<int>(motions.size())));
        return motions;
    }
    [[nodiscard]] bool asleep(int body) const override { return replay_.world().asleep(BodyId{body}); }
    [[nodiscard]] std::string trouble() const override {
        std::string names;
        for (const Issue issue : all_issues)
            if (replay_.world().status().has(issue)) names += (names.empty() ? "" : " ") + std::string{name_of(issue)};
        return names;
    }

private:
    // Without the list of joints of any kind, which would need a world with the features of all kinds.
    struct Unjointed : SceneData {
        std::tuple<> joints;
    };
    using Replayed = Replay<SceneOf<N, Method, features>, Unjointed>;
    [[nodiscard]] auto& world() { return replay_.world(); }
    [[nodiscard]] const auto& with_joints(const Problem& problem) {
        for (int i = 0; const Joint& joint : problem.joints) {
            if constexpr (features.has_joints()) {
                const RealVec3 anchor = real_vector(joint.anchor), axis = real_vector(joint.axis);
                if (joint.is_hinge())
                    (void)world().add(HingeSpec{.body = i, .to_body = i - 1, .anchor = anchor, .axis = axis});
                else (void)world().add(BallSpec{.body = i, .to_body = i - 1, .anchor = anchor});
            }
            ++i;
        }
        return world();
    }
    [[nodiscard]] static RealVec3 real_vector(const reference::Vector& v) {
        const auto real = [](long double x) { return Real{static_cast<double>(x)}; };
        return {real(v.x), real(v.y), real(v.z)};
    }

    Replayed replay_;
    World<SceneOf<N, Method, features>> start_;
    std::vector<host::PrincipalAxes> axes_;
};

// Adds this kernel by a method. for_each_world(f) calls f<features>() for each world that there is.
template <class N, class Method>
void add_tumble(Contenders& contenders, const auto& for_each_world) {
    contenders.push_back({"tumble", "", Method::name, N::name, N::carry, [=](const Problem& problem) {
                              std::unique_ptr<Runner> made;
                              for_each_world([&]<Features features>() {
                                  if (problem.features == features)
                                      made = std::make_unique<TumbleRunner<N, Method, features>>(problem);
                              });
                              if (!made)
                                  throw std::runtime_error{"no world of this kernel has the features of '" +
                                                           problem.name + "'"};
                              return made;
                          }});
}

}  // namespace tumble::bench

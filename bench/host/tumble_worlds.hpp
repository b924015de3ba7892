// This kernel in bench/host, in one number system: a world for each set of features that the problems need.
#pragma once

#include "contender.hpp"

#include <tumble/integrators/list.hpp>
#include <tumble/tumble.hpp>

#include "simulation/motion_of.hpp"

namespace tumble::bench {

template <class N, class Method, Features features>
class TumbleRunner final : public Runner {
public:
    explicit TumbleRunner(const Problem& problem) : replay_{problem.scene}, start_{world()} {
        for (const BodySpec& body : problem.scene.bodies) axes_.emplace_back(principal_inertia(body.inertia));
    }

    void restart() override { world() = start_; }
    // The whole step is one function, as in the firmware that the cores run.
    [[gnu::flatten]] void run(int steps) override {
        for (int i = 0; i < steps; ++i) (void)world().step();
    }
    [[nodiscard]] reference::Motion motion(int body) const override {
        return host::motion_of(replay_.world().bodies(), axes_[static_cast<std::size_t>(body)], body);
    }
    [[nodiscard]] bool asleep(int body) const override { return replay_.world().asleep(BodyId{body}); }
    [[nodiscard]] std::string trouble() const override {
        std::string names;
        for (const Issue issue : all_issues)
            if (replay_.world().status().has(issue)) names += (names.empty() ? "" : " ") + std::string{name_of(issue)};
        return names;
    }

private:
    using Replayed = Replay<SceneOf<N, Method, features>, SceneData>;
    [[nodiscard]] auto& world() { return replay_.world(); }

    Replayed replay_;
    World<SceneOf<N, Method, features>> start_;
    std::vector<host::PrincipalAxes> axes_;
};

// Calls f<features>() for the worlds of one body and of small scenes, and for those of many bodies, which only the
// default method runs.
template <class F>
void for_each_small_world(F&& f) {
    f.template operator()<Features{.bodies = 1}>();
    f.template operator()<Features{.bodies = 1, .rotation = false, .point_masses = true, .drag = true}>();
    f.template operator()<Features{.bodies = 1, .springs = 1, .rotation = false, .point_masses = true}>();
    f.template operator()<Features{.bodies = 2, .rotation = false, .point_masses = true, .gravitation = true}>();
    f.template operator()<Features{.bodies = 1, .planes = 1}>();
    f.template operator()<Features{.bodies = 1, .planes = 1, .boxes = true}>();
    f.template operator()<Features{
        .bodies = 10, .planes = 1, .pairs = true, .boxes = true, .friction = true, .bounded_steps = true}>();
}
template <int bodies, class F>
void for_each_world_of(F&& f) {
    if constexpr (bodies > 1) {
        f.template operator()<Features{.bodies = bodies}>();
        f.template operator()<Features{.bodies = bodies, .springs = bodies, .rotation = false, .point_masses = true}>();
        f.template operator()<Features{.bodies = bodies, .planes = 1, .boxes = true}>();
    }
    f.template operator()<Features{.bodies = bodies, .planes = 1, .boxes = true, .sleep = true}>();
    f.template operator()<Features{.bodies = bodies, .planes = 1, .pairs = true, .boxes = true}>();
    f.template operator()<Features{.bodies = bodies, .planes = 1, .drag = true, .pairs = true, .boxes = true}>();
}

// The runner in the world with the features of the problem.
template <class N, class Method>
std::unique_ptr<Runner> make_tumble(const Problem& problem) {
    constexpr bool is_default = std::is_same_v<Method, integrators::Verlet>;
    if (problem.table == "many" && !is_default) return nullptr;
    std::unique_ptr<Runner> made;
    const auto consider = [&]<Features features>() {
        if (problem.features == features) made = std::make_unique<TumbleRunner<N, Method, features>>(problem);
    };
    for_each_small_world(consider);
    if constexpr (is_default) {
        for_each_world_of<1>(consider);
        for_each_world_of<10>(consider);
        for_each_world_of<100>(consider);
        for_each_world_of<1000>(consider);
        for_each_world_of<10000>(consider);
    }
    if (!made) throw std::runtime_error{"no world of this kernel has the features of '" + problem.name + "'"};
    return made;
}

template <class N>
void add_tumble(std::vector<Contender>& contenders) {
    const auto add = [&]<class Method>() {
        contenders.push_back({"tumble", "", Method::name, N::name, N::carry, make_tumble<N, Method>});
    };
    add.template operator()<integrators::Verlet>();
    add.template operator()<integrators::Rk4>();
}

}  // namespace tumble::bench

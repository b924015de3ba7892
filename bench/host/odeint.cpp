// Boost.Odeint's RK4, as in its documentation, on free bodies and on point masses under loads.
#include "peers/odeint.hpp"
#include "engines/contender.hpp"

#include <boost/version.hpp>

namespace {

using namespace tumble;
using namespace tumble::bench;

// A body under gravity: position and velocity (world), orientation (w, x, y, z) and angular velocity (body axes).
template <class Number>
struct BodyEquations {
    using T = Number;
    using Top = TopEquations<T, false>;
    using State = std::array<T, 13>;

    std::array<T, 3> gravity;  // m/s^2
    Top top;

    static BodyEquations of(const SceneData& scene) { return {vector_as<T>(scene.world.gravity), Top::of(scene)}; }
    static State start(const BodySpec& body) {
        const auto x = vector_as<T>(body.position), v = vector_as<T>(body.velocity),
                   w = vector_as<T>(body.angular_velocity);
        const RealQuat q = normalized(body.orientation);
        const auto u = vector_as<T>(q.v);
        return {as<T>(q.w), u[0], u[1], u[2], w[0], w[1], w[2], x[0], x[1], x[2], v[0], v[1], v[2]};
    }

    void operator()(const State& s, State& rate, T time) const {
        typename Top::State turned, turns;
        for (std::size_t i = 0; i < turned.size(); ++i) turned[i] = s[i];
        top(turned, turns, time);
        for (std::size_t i = 0; i < turned.size(); ++i) rate[i] = turns[i];
        for (std::size_t i = 0; i < 3; ++i) {
            rate[7 + i] = s[10 + i];
            rate[10 + i] = gravity[i];
        }
    }
    static void normalise(State& s) { Top::normalise(s); }
    static reference::Motion motion(const State& s) {
        return {{s[7], s[8], s[9]}, {s[10], s[11], s[12]}, {s[0], {s[1], s[2], s[3]}}, {s[4], s[5], s[6]}};
    }
};

// The equations of a scene's only moving body.
template <class Number>
struct LoadedPoint : PointEquations<Number> {
    using typename PointEquations<Number>::State;

    static LoadedPoint of(const SceneData& scene) { return {PointEquations<Number>::of(scene)}; }
    static State start(const BodySpec& body) {
        const auto x = vector_as<Number>(body.position), v = vector_as<Number>(body.velocity);
        return {x[0], x[1], x[2], v[0], v[1], v[2]};
    }
    static reference::Motion motion(const State& s) { return {{s[0], s[1], s[2]}, {s[3], s[4], s[5]}}; }
};

// Independent bodies: the same equations and stepper for each, one after the other.
template <class Equations>
class OdeintRunner final : public Runner {
    using T = typename Equations::T;

public:
    explicit OdeintRunner(const Problem& problem)
        : equations_{Equations::of(problem.scene)}, step_{static_cast<T>(problem.step())} {
        for (const BodySpec& body : problem.scene.bodies)
            if (!body.fixed) start_.push_back(Equations::start(body));
        fixed_ = problem.scene.bodies.size() - start_.size();
        states_ = start_;
    }

    void restart() override { states_ = start_; }
    void step() override {
        for (auto& state : states_) {
            stepper_.do_step(equations_, state, T(0), step_);
            Equations::normalise(state);
        }
    }
    [[nodiscard]] Motions motions() override {
        Motions motions(fixed_);
        for (const auto& state : states_) motions.push_back(Equations::motion(state));
        return motions;
    }
    [[nodiscard]] bool asleep(int) const override { return false; }

private:
    Equations equations_;
    std::vector<typename Equations::State> start_, states_;
    std::size_t fixed_;  // bodies; they come first
    T step_;
    OdeintRk4<Equations> stepper_;
};

template <class Number>
void add(Contenders& contenders) {
    const std::string version =
        std::to_string(BOOST_VERSION / 100000) + "." + std::to_string(BOOST_VERSION / 100 % 1000);
    contenders.push_back({"Boost.Odeint", version, "RK4", sizeof(Number) == 4 ? "f32" : "f64", false,
                          [](const Problem& problem) -> std::unique_ptr<Runner> {
                              if (problem.touches() || problem.features.springs > 1) return nullptr;
                              if (problem.features.loads())
                                  return std::make_unique<OdeintRunner<LoadedPoint<Number>>>(problem);
                              return std::make_unique<OdeintRunner<BodyEquations<Number>>>(problem);
                          }});
}

}  // namespace

void tumble::bench::add_odeint(Contenders& contenders) {
    add<float>(contenders);
    add<double>(contenders);
}

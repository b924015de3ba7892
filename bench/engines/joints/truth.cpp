#include "truth.hpp"

#include <cmath>
#include <stdexcept>

#include "truth/joint_trees.hpp"

namespace tumble::bench {

namespace {

using reference::Motion, reference::Number, reference::Vector;

// The rates of host::JointTrees under gravity, integrated by Runge and Kutta's method of order 4.
class Chain {
public:
    explicit Chain(const Mechanism& mechanism) {
        const auto triple = [](Vector v) {
            return host::Triple{static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
        };
        std::vector<host::JointTrees::Body> bodies;
        std::vector<host::JointDescription> joints;
        for (const Link& link : mechanism.links) {
            host::JointDescription& joint = joints.emplace_back();
            joint.kind = link.is_hinge() ? host::JointKind::hinge : host::JointKind::ball;
            joint.body = static_cast<int>(bodies.size());
            joint.to_body = joint.body - 1;
            joint.anchor = triple(link.anchor);
            joint.axis = triple(link.axis);
            bodies.push_back({link.mass, {{link.moments.x, 0, 0}, {0, link.moments.y, 0}, {0, 0, link.moments.z}}});
            loads_.push_back({Vector{0, -gravity, 0} * link.mass, {}});
            motions_.push_back(link.start);
        }
        trees_ = {bodies, joints, motions_};
        state_ = trees_.start();
        trees_.end_velocities_across(state_, motions_);
    }
    void run(int steps, Number h) {
        for (int i = 0; i < steps; ++i) {
            const State a = rate(state_), b = rate(moved(state_, a, h / 2)), c = rate(moved(state_, b, h / 2)),
                        d = rate(moved(state_, c, h));
            state_ = moved(moved(moved(moved(state_, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
            trees_.normalize(state_);
        }
    }
    [[nodiscard]] std::vector<Motion> motions() {
        (void)trees_.place(state_, motions_);
        return motions_;
    }

private:
    using State = std::vector<Number>;

    [[nodiscard]] State rate(const State& state) {
        const auto links = trees_.place(state, motions_);
        State rate(state.size());
        trees_.rate(state, links, motions_, loads_, rate);
        return rate;
    }
    static State moved(State state, const State& rate, Number h) {
        for (std::size_t i = 0; i < state.size(); ++i) state[i] += rate[i] * h;
        return state;
    }

    host::JointTrees trees_;
    State state_;
    host::JointTrees::Motions motions_;
    std::vector<reference::Wrench> loads_;
};

std::vector<std::vector<Motion>> run(const Mechanism& mechanism, int samples, int rate) {
    Chain chain{mechanism};
    std::vector<std::vector<Motion>> motions;
    const int steps = static_cast<int>(mechanism.seconds * rate) / samples;
    for (int i = 0; i < samples; ++i) {
        chain.run(steps, Number(1) / rate);
        motions.push_back(chain.motions());
    }
    return motions;
}

}  // namespace

std::vector<std::vector<Motion>> truth_of(const Mechanism& mechanism, int samples) {
    constexpr int rate = 8192;  // steps a second
    constexpr double bound = 1e-9;
    const auto fine = run(mechanism, samples, rate), coarse = run(mechanism, samples, rate / 2);
    const double energy = mechanism.energy(Chain{mechanism}.motions());
    for (std::size_t i = 0; i < fine.size(); ++i) {
        const double change = mechanism.energy(fine[i]) - energy;
        if (!(std::abs(change) < bound * mechanism.energy_scale()))
            throw std::runtime_error{"the reference of the " + mechanism.name + " does not keep its energy"};
        for (std::size_t link = 0; link < fine[i].size(); ++link)
            if (!(norm(fine[i][link].x - coarse[i][link].x) < bound))
                throw std::runtime_error{"the reference of the " + mechanism.name + " depends on its step"};
    }
    return fine;
}

}  // namespace tumble::bench

// The state is the turn of each joint, a quaternion, and its speeds, in the axes of the link. Kane's equations: with J
// the velocities of a link at unit speeds, and a its acceleration where no speed changes,
//   sum J^T m J s' = sum J^T (m g - m a, -(I a_w + w x I w)),
// over all links; the matrix is factored as it is, and the rates are integrated by Runge and Kutta's method of order 4.
#include "truth.hpp"

#include <cmath>
#include <stdexcept>

namespace tumble::bench {

namespace {

using reference::Motion, reference::Number, reference::Rotation, reference::Vector;

struct State {
    std::vector<Rotation> turn;
    std::vector<Number> speed;
};

class Chain {
public:
    explicit Chain(const Mechanism& mechanism) : mechanism_{mechanism} {
        const auto& links = mechanism.links;
        Rotation before{};
        Vector spin{};
        for (std::size_t i = 0; i < links.size(); ++i) {
            const Motion& start = links[i].start;
            rest_.push_back(before.conjugate() * start.q);
            state_.turn.emplace_back();
            const Vector own = start.w - start.q.rotate_back(spin);
            for (int k = 0; k < 3; ++k) {
                Vector axis{};
                axis[k] = 1;
                if (links[i].is_hinge() && k > 0) break;
                if (links[i].is_hinge()) axis = links[i].own_axis();
                free_.push_back({i, axis});
                state_.speed.push_back(dot(axis, own));
            }
            before = start.q;
            spin = start.q.rotate(start.w);
        }
    }
    void run(int steps, Number h) {
        for (int i = 0; i < steps; ++i) {
            const State a = rate(state_), b = rate(moved(state_, a, h / 2)), c = rate(moved(state_, b, h / 2)),
                        d = rate(moved(state_, c, h));
            state_ = moved(moved(moved(moved(state_, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
            for (Rotation& turn : state_.turn) turn = turn.normalized();
        }
    }
    [[nodiscard]] std::vector<Motion> motions() const {
        auto motions = poses(state_);
        mechanism_.set_velocities(motions, turns(state_));
        return motions;
    }

private:
    struct Free {
        std::size_t link;
        Vector axis;  // of the link
    };

    [[nodiscard]] std::vector<Motion> poses(const State& state) const {
        std::vector<Motion> poses(rest_.size());
        Rotation before{};
        Vector anchor = mechanism_.links[0].anchor;
        for (std::size_t i = 0; i < poses.size(); ++i) {
            const Link& link = mechanism_.links[i];
            poses[i].q = before = before * rest_[i] * state.turn[i];
            poses[i].x = anchor - before.rotate(link.to_own);
            anchor = poses[i].x + before.rotate(link.to_next);
        }
        return poses;
    }
    [[nodiscard]] std::vector<Vector> turns(const State& state) const {
        std::vector<Vector> turns(rest_.size());
        for (std::size_t f = 0; f < free_.size(); ++f)
            turns[free_[f].link] = turns[free_[f].link] + free_[f].axis * state.speed[f];
        return turns;
    }
    static State moved(const State& state, const State& rate, Number h) {
        State next = state;
        for (std::size_t i = 0; i < next.turn.size(); ++i) next.turn[i] = next.turn[i] + rate.turn[i] * h;
        for (std::size_t f = 0; f < next.speed.size(); ++f) next.speed[f] += rate.speed[f] * h;
        return next;
    }
    [[nodiscard]] State rate(const State& unit_or_not) const {
        State state = unit_or_not, rate = state;
        for (Rotation& turn : state.turn) turn = turn.normalized();
        const auto own = turns(state);
        auto motions = poses(state);
        mechanism_.set_velocities(motions, own);
        const std::size_t count = free_.size();
        std::vector<std::vector<Number>> mass(count, std::vector<Number>(count));
        std::vector<Number> force(count);
        // Of the link before: where no speed changes, its spin, its angular acceleration and that of its next joint.
        Vector spin{}, turning{}, anchor{};
        std::vector<Vector> axis(count), linear(count);
        for (std::size_t i = 0; i < motions.size(); ++i) {
            const Link& link = mechanism_.links[i];
            const Motion& now = motions[i];
            rate.turn[i] = unit_or_not.turn[i] * Rotation{0, own[i] * 0.5L};
            const Vector w = now.q.rotate(now.w), up = now.q.rotate(link.to_own), next = now.q.rotate(link.to_next);
            turning = turning + cross(spin, w - spin);
            spin = w;
            const auto bias = [&](Vector arm) { return cross(turning, arm) + cross(w, cross(w, arm)); };
            const Vector a = anchor - bias(up);
            anchor = a + bias(next);
            const Vector push = (Vector{0, -gravity, 0} - a) * link.mass;
            const Vector turn = -(times(link.moments, now.q.rotate_back(turning)) +
                                  cross(now.w, times(link.moments, now.w)));  // in the link's axes
            std::size_t moving = 0;  // directions of this link and those before
            for (; moving < count && free_[moving].link <= i; ++moving) {
                const std::size_t of = free_[moving].link;
                const Motion& turned = motions[of];
                const Vector about = turned.q.rotate(free_[moving].axis);
                axis[moving] = now.q.rotate_back(about);
                linear[moving] = cross(about, now.x - turned.x - turned.q.rotate(mechanism_.links[of].to_own));
                force[moving] += dot(linear[moving], push) + dot(axis[moving], turn);
            }
            for (std::size_t r = 0; r < moving; ++r) {
                const Vector momentum = linear[r] * Number{link.mass}, angular = times(link.moments, axis[r]);
                for (std::size_t c = 0; c <= r; ++c) mass[r][c] += dot(linear[c], momentum) + dot(axis[c], angular);
            }
        }
        rate.speed = solved(mass, force);
        return rate;
    }
    // By Cholesky's factor.
    static std::vector<Number> solved(std::vector<std::vector<Number>>& a, std::vector<Number> b) {
        const std::size_t count = b.size();
        for (std::size_t r = 0; r < count; ++r) {
            for (std::size_t c = 0; c <= r; ++c) {
                for (std::size_t k = 0; k < c; ++k) a[r][c] -= a[r][k] * a[c][k];
                a[r][c] = c < r ? a[r][c] / a[c][c] : std::sqrt(a[r][r]);
            }
            for (std::size_t k = 0; k < r; ++k) b[r] -= a[r][k] * b[k];
            b[r] /= a[r][r];
        }
        for (std::size_t r = count; r-- > 0;) {
            for (std::size_t k = r + 1; k < count; ++k) b[r] -= a[k][r] * b[k];
            b[r] /= a[r][r];
        }
        return b;
    }

    const Mechanism& mechanism_;
    std::vector<Rotation> rest_;  // of each link in the one before, at the start
    std::vector<Free> free_;
    State state_;
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

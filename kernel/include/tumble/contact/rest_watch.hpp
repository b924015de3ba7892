// How far the bodies of a pile have moved since a while ago: it rests where none of them has moved.
#pragma once

#include <tumble/contact/narrow_phase.hpp>

namespace tumble {

// Sweeps in bounded number leave some of each load, and so bodies of a pile tremble about the place where they rest, or
// creep. What n sweeps leave is about 1/n of a load. So a body is at rest that in half a second moves no farther than
// it would at 1/n of the speed that gravity adds in a step, or than a quarter of the tolerance where this is more.
template <class N, Spin spin, Features features>
class RestWatch {
public:
    using NarrowPhase = tumble::NarrowPhase<N, spin, features>;
    using Bodies = typename NarrowPhase::Bodies;
    using BodyGroup = SomeBodies<features.bodies>;
    using Length = typename NarrowPhase::Length;

    constexpr RestWatch() = default;
    constexpr explicit RestWatch(Real step) {
        const std::int64_t steps = (Real{1} / (step + step)).to_fixed(0, 31);
        rest_ = static_cast<std::uint32_t>(steps > 1 ? steps : 1);
    }
    // Call at the end of a bounded step, with the states of its start.
    void note(const NarrowPhase& shapes, const Bodies& bodies, const BodyGroup& group,
              const SavedMotions<Bodies>& start) {
        const std::uint32_t now = bodies.steps_taken;
        const Length least = least_way(shapes);
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            Motion& motion = motion_[b];
            const bool goes_on = motion.seen + 1 == now;
            motion.seen = now;
            motion.is_held = false;
            if (goes_on && stays(motion, shapes, least, b, start[k], bodies.state[b])) continue;
            motion.way = motion.turn = {};
            motion.since = now;
        }
    }
    // Call where the motion of a body changes other than by a step: as if it had not been noted in the last one.
    constexpr void forget(int b, std::uint32_t now) {
        motion_[b].seen = now - not_in_last;
        motion_[b].is_held = false;
    }
    // True of a body whose last step was a bounded one.
    [[nodiscard]] bool was_noted(int b, std::uint32_t now) const { return motion_[b].seen + 1 == now; }
    // Call where bodies take an exact step.
    void let_go(const BodyGroup& group) {
        for (int k = 0; k < group.count; ++k) motion_[group.id[k]].is_held = false;
    }
    // True where no body has moved for half a second, in bounded steps alone.
    [[nodiscard]] bool are_at_rest(const Bodies& bodies, const BodyGroup& group) const {
        return all_of(group, [&](const Motion& motion) {
            return motion.seen + 1 == bodies.steps_taken && bodies.steps_taken - motion.since > rest_;
        });
    }
    // Holds the bodies where they are, overlaps included.
    void hold(const BodyGroup& group) {
        for (int k = 0; k < group.count; ++k) motion_[group.id[k]].is_held = true;
    }
    [[nodiscard]] bool are_held(const BodyGroup& group) const {
        return all_of(group, [](const Motion& motion) { return motion.is_held; });
    }

    // Writes or reads what a snapshot holds.
    template <class Self, class Archive>
    static void archive(Self& self, const Bodies& bodies, Archive& to) {
        for (int b = 0; b < bodies.count; ++b)
            if (auto& motion = self.motion_[b]; !bodies.constants[b].fixed())
                to(motion.way, motion.turn, motion.since, motion.seen, motion.is_held);
    }

private:
    static constexpr std::uint32_t not_in_last = 2;  // steps ago

    struct Motion {
        StoredVec3<Length> way{}, turn{};                  // since then; turns as ways of the surface
        std::uint32_t since = 0, seen = 0u - not_in_last;  // steps: when it began anew, and when it was noted last
        bool is_held = false;
    };

    template <class F>
    [[nodiscard]] bool all_of(const BodyGroup& group, F&& is_so) const {
        bool all = true;
        for (int k = 0; k < group.count; ++k) all = all && is_so(motion_[group.id[k]]);
        return all;
    }
    [[nodiscard]] Length least_way(const NarrowPhase& shapes) const {
        using Work = typename N::Work;
        constexpr int part = ContactBounds<N>::slow_in_falls * contact::max_sweeps;
        const Length depth = ContactBounds<N>::resting_depth(shapes.tolerance()),
                     creep = shapes.scale().length(shapes.slow() * Work(static_cast<int>(rest_)) / Work(part));
        return creep > depth ? creep : depth;
    }
    // Adds the step. The vector of a quaternion is half of the turn.
    [[nodiscard]] static bool stays(Motion& motion, const NarrowPhase& shapes, Length least, int b,
                                    const typename Bodies::State& start, const typename Bodies::State& end) {
        const Length radius = shapes.shape(b).radius;
        const auto &from = start.q_wb.value(), &to = end.q_wb.value();
        bool all = true;
        for (int i = 0; i < 3; ++i) {
            motion.way[i] += shapes.scale().between(N::sum(end.x_w[i]), N::sum(start.x_w[i]));
            const Length half = narrow<Length>(mul(to.v[i] - from.v[i], radius));
            motion.turn[i] += half + half;
            all = all && !(magnitude_of(motion.way[i]) > least) && !(magnitude_of(motion.turn[i]) > least);
        }
        return all;
    }

    Motion motion_[features.bodies]{};
    std::uint32_t rest_ = 1;  // steps
};

}  // namespace tumble

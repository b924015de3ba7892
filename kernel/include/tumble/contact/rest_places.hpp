// Where the bodies of a pile were when they moved last: it rests where none of them has moved for a while.
#pragma once

#include <tumble/contact/narrow_phase.hpp>

namespace tumble {

// Sweeps in bounded number leave some of each load, and so bodies of a pile tremble about the place where they rest.
// What they do within half a second and a quarter of the tolerance is no motion.
template <class N, Spin spin, Features features>
class RestPlaces {
public:
    using NarrowPhase = tumble::NarrowPhase<N, spin, features>;
    using Bodies = typename NarrowPhase::Bodies;
    using BodyGroup = SomeBodies<features.bodies>;

    constexpr RestPlaces() = default;
    constexpr explicit RestPlaces(Real step) {
        const std::int64_t steps = (Real{1} / (step + step)).to_fixed(0, 31);
        rest_ = static_cast<std::uint32_t>(steps > 1 ? steps : 1);
    }
    // Call at the end of a bounded step.
    void note(const NarrowPhase& shapes, const Bodies& bodies, const BodyGroup& group) {
        const std::uint32_t now = bodies.steps_taken;
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            Place& place = place_[b];
            if (place.seen + 1 != now || moves(shapes, bodies, b)) {
                const auto& s = bodies.state[b];
                for (int i = 0; i < 3; ++i) place.x[i] = N::sum(s.x_w[i]);
                place.q = s.q_wb.value();
                place.since = now;
            }
            place.seen = now;
            place.is_held = false;
        }
    }
    // Call where the motion of a body changes other than by a step.
    constexpr void forget(int b, std::uint32_t now) { place_[b].seen = now - 2; }
    // True where no body has moved for half a second, in bounded steps alone.
    [[nodiscard]] bool rest(const Bodies& bodies, const BodyGroup& group) const {
        return all_of(group, [&](const Place& place) {
            return place.seen + 1 == bodies.steps_taken && bodies.steps_taken - place.since > rest_;
        });
    }
    // Holds the bodies where they are, overlaps included.
    void hold(const BodyGroup& group) {
        for (int k = 0; k < group.count; ++k) place_[group.id[k]].is_held = true;
    }
    [[nodiscard]] bool are_held(const BodyGroup& group) const {
        return all_of(group, [](const Place& place) { return place.is_held; });
    }

    // Writes or reads what a snapshot holds.
    template <class Self, class Archive>
    static void archive(Self& self, const Bodies& bodies, Archive& to) {
        for (int b = 0; b < bodies.count; ++b)
            if (auto& place = self.place_[b]; !bodies.constants[b].fixed())
                to(place.x, place.q, place.since, place.seen, place.is_held);
    }

private:
    struct Place {
        typename N::PositionSum x[3]{};
        Quat<typename N::Unit> q{};
        std::uint32_t since = 0, seen = 0;  // steps: when it moved last, and when it was noted last
        bool is_held = false;
    };

    template <class F>
    [[nodiscard]] bool all_of(const BodyGroup& group, F&& is_so) const {
        bool all = true;
        for (int k = 0; k < group.count; ++k) all = all && is_so(place_[group.id[k]]);
        return all;
    }
    // By more than a point of a resting body may be deep without a correction. The vector of a quaternion is half of
    // the turn.
    [[nodiscard]] bool moves(const NarrowPhase& shapes, const Bodies& bodies, int b) const {
        using Length = typename NarrowPhase::Length;
        const auto least = ContactBounds<N>::resting_depth(shapes.tolerance());
        const auto& s = bodies.state[b];
        const auto& q = s.q_wb.value();
        bool any = false;
        for (int i = 0; i < 3; ++i) {
            const Length turn = narrow<Length>(mul(magnitude_of(q.v[i] - place_[b].q.v[i]), shapes.shape(b).radius));
            any = any || turn + turn > least ||
                  magnitude_of(shapes.scale().between(N::sum(s.x_w[i]), place_[b].x[i])) > least;
        }
        return any;
    }

    Place place_[features.bodies]{};
    std::uint32_t rest_ = 1;  // steps
};

}  // namespace tumble

// The forces of a step between touching bodies.
#pragma once

#include <tumble/contact/statics.hpp>

namespace tumble {

// What the solution for the forces of a step has found.
enum class Touch : std::uint8_t { nothing, rests, strikes };

template <class N, Spin spin, Features features>
class Resting {
public:
    using Rows = ContactRows<N, spin, features>;
    using C = typename Rows::C;
    using Bounds = ContactBounds<N>;
    using Length = typename Rows::Length;
    using Speed = typename Rows::Speed;
    using Work = typename N::Work;
    using NarrowPhase = typename Rows::NarrowPhase;
    using Pair = typename Rows::Pair;
    using Point = typename Rows::Point;
    using PairList = typename Rows::PairList;
    using Island = typename Rows::Island;
    using Velocities = typename Rows::Velocities;
    using Kicks = typename Rows::Kicks;

    Resting(const NarrowPhase& shapes, PairList& pairs, Velocities& velocities, typename NarrowPhase::Bodies& bodies,
            const Island& island)
        : shapes_{shapes}, pairs_{pairs},
          velocities_{velocities}, bodies_{bodies}, island_{island}, rows_{shapes, pairs, velocities, bodies, island} {}

    // Solves for the contact forces over a part of the step, so that no touching point approaches at its end. Writes
    // them into `forces`, as changes of motion in that part. A point strikes if it is below the surface and approaches
    // faster than NarrowPhase::slow(). The impact must then be resolved first: unless `struck`, no forces are computed.
    Touch solve(const Kicks& loads, Work part, bool whole, bool struck, Kicks& forces) {
        bool any = false;
        pairs_.for_each(island_, [&](const Pair& pair) { any = any || pair.count > 0; });
        if (!any) return Touch::nothing;
        const bool same = rows_.set_velocities(loads, part, whole);
        int active = 0;
        bool strikes = false;
        pairs_.for_each(island_, [&](Pair& pair) {
            if (!same || !(pair.scale == velocities_.scale)) pair.still = 0;
            if (pair.count == 0) return;
            const bool hit = pair.touched && (struck || !whole);
            pair.touched = false;
            const Speed slow = rows_.pair_speed(pair, shapes_.slow());
            rows_.make_rows(pair);
            for (int i = 0; i < pair.count; ++i) {
                Point& point = pair.point[i];
                const Speed approach = -rows_.velocity(velocities_.start, pair, point),
                            closing = rows_.speed(pair, point, point.gap);
                const bool fast = approach > Rows::along(point, slow), above = point.gap > Length{};
                const Speed late = hit ? Bounds::late(closing) : Speed{};
                point.active = !(above && fast && approach - late > closing);
                if (!point.active) {
                    Rows::clear_impulses(point);
                    continue;
                }
                strikes = strikes || (!above && fast);
                point.row[0].target = above ? -closing : correction(pair, point);
                for (auto& row : point.row) row.impulse = velocities_.scale.from(row.impulse, pair.scale);
                pair.touched = true;
                ++active;
            }
            pair.scale = velocities_.scale;
        });
        if (active == 0) return Touch::nothing;
        if (strikes && !struck) return Touch::strikes;
        if (whole && Statics<N, spin, features>{shapes_, pairs_, velocities_, island_}.solve()) {
            velocities_.stop(forces, loads, bodies_, island_.group);
        } else {
            rows_.push_all();
            rows_.sweep(velocities_.scale.enough_at_rest(), contact::max_sweeps);
            velocities_.write(forces, bodies_, shapes_, island_.group);
        }
        pairs_.count_points(island_);
        return Touch::rests;
    }

private:
    // Position correction of a penetration.
    [[nodiscard]] Speed correction(const Pair& pair, const Point& point) const {
        const Length excess = -point.gap - Bounds::resting_depth(shapes_.tolerance());
        if (!(excess > Length{})) return Speed{};
        Length lift = Bounds::correction(excess);
        const Length most = Bounds::most_correction(shapes_.tolerance());
        if (lift > most) lift = most;
        return rows_.speed(pair, point, lift);
    }

    const NarrowPhase& shapes_;
    PairList& pairs_;
    Velocities& velocities_;
    typename NarrowPhase::Bodies& bodies_;
    const Island& island_;
    Rows rows_;
};

}  // namespace tumble

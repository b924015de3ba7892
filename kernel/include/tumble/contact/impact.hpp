// The impacts of an island at one moment.
#pragma once

#include <tumble/contact/contact_log.hpp>
#include <tumble/contact/statics.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class Impact {
public:
    using Rows = ContactRows<N, spin, features>;
    using C = typename Rows::C;
    using Unit = typename Rows::Unit;
    using Bounds = ContactBounds<N>;
    using Length = typename Rows::Length;
    using Speed = typename Rows::Speed;
    using Work = typename N::Work;
    using NarrowPhase = typename Rows::NarrowPhase;
    using Bodies = typename Rows::Bodies;
    using Pair = typename Rows::Pair;
    using Point = typename Rows::Point;
    using PairList = typename Rows::PairList;
    using Island = typename Rows::Island;
    using Velocities = typename Rows::Velocities;
    using Velocity = typename Rows::Velocity;
    using Kicks = typename Rows::Kicks;
    using Log = If<features.contact_readout, ContactLog<N, spin, features>, 0>;

    // threshold: m a step; slower approaches do not bounce. fastest: the fastest approach of the step, a weighted
    // speed.
    Impact(const NarrowPhase& shapes, PairList& pairs, Velocities& velocities, Bodies& bodies, const Island& island,
           Work threshold, Work& fastest, Log& log)
        : shapes_{shapes}, pairs_{pairs}, velocities_{velocities}, bodies_{bodies}, island_{island},
          rows_{shapes, pairs, velocities, bodies, island}, threshold_{threshold}, fastest_{fastest}, log_{log} {}

    // Solves the impact of the island, of which the points have been found. In each round all points that approach
    // bounce together, from the velocities at its start: Newton's law, v' = -e v. A round may let others approach, as
    // an impact passes through a row of balls. Then all points together stop what still approaches. With `stop` nothing
    // bounces. `loads`: over a whole step. `rest`: of the step, after the impact.
    [[gnu::noinline, gnu::cold]] void resolve(Kicks& loads, bool stop, Work rest) {
        rest_ = C::unit(rest);
        (void)rows_.set_velocities(loads, Work(1), true);
        int pairs = 0;
        Speed fastest{};
        const Length hit = Bounds::largest_impact_gap(shapes_.tolerance());
        pairs_.set_balanced(island_, false);
        pairs_.for_each(island_, [&](Pair& pair) {
            // The impact leaves out pairs with a larger gap.
            pair.set_struck(pair.count > 0 && !(pair.gap > hit));
            for (int i = 0; i < pair.count; ++i) pair.point[i].active = false;
            if (!pair.is_struck()) return;
            pair.scale = velocities_.scale;
            rows_.make_rows(pair);
            for (int i = 0; i < pair.count; ++i) {
                Point& point = pair.point[i];
                if (is_apart(point)) continue;
                const Speed speed = rows_.velocity(velocities_.start, pair, point);
                point.change_by_loads = magnitude_of(rows_.velocity(velocities_.now, pair, point) - speed);
                if (-speed > fastest) fastest = -speed;
            }
            ++pairs;
        });
        if (pairs == 0) return;
        if (const Work speed = velocities_.scale.work(fastest); speed > fastest_) fastest_ = speed;
        copy(velocities_.now, velocities_.start);
        bool bounced = !stop, any = false, sinks = false;
        for (int round = 0; bounced && !is_spent() && round < contact::max_rounds + pairs; ++round) {
            bounced = bounce();
            any = any || bounced;
        }
        pairs_.for_each(island_, [&](Pair& pair) {
            for (int i = 0; pair.is_struck() && i < pair.count; ++i) {
                Point& point = pair.point[i];
                point.active = !is_apart(point) || comes_down(pair, point, rest);
                point.row[0].target = target_of_gap(pair, point);
                sinks = sinks || (point.active && this->sinks(pair, point));
                Rows::clear_impulses(point);
            }
        });
        if ((bounced && !is_spent()) || stop) [[unlikely]]
            report_cut_off();
        if (!any || (sinks && !is_spent())) {
            solve(false, true);
            log_impulses(is_spent() ? scale_back() : C::one());
        }
        if constexpr (features.impact_bounds)
            if (bounced && is_spent()) velocities_.sweeps_left.missing = true;
        velocities_.add_to(bodies_, loads, shapes_.weights(), island_.group);
        pairs_.count_points(island_, shapes_.tolerance());
        // The impulses of an impact are no warm start for the forces of the next step.
        pairs_.for_each_active(island_, [&](Pair&, Point& point) { Rows::clear_impulses(point); });
    }

private:
    [[nodiscard]] bool is_spent() const { return velocities_.sweeps_are_spent(); }
    void copy(typename Velocities::Velocities& to, const typename Velocities::Velocities& from) {
        for (int k = 0; k < island_.group.count; ++k) to[island_.group.id[k]] = from[island_.group.id[k]];
    }
    // True of a point of a rim that does not touch. It cannot bounce.
    [[nodiscard]] bool is_apart(const Point& point) const { return point.is_apart(shapes_.tolerance()); }
    // Whether it reaches the surface in the rest of the step. It is then held, like any point above the surface.
    [[nodiscard]] bool comes_down(const Pair& pair, const Point& point, Work rest) const {
        const Work gap = shapes_.scale().metres(point.gap);
        return rest > Work(0) &&
               -rows_.velocity(velocities_.now, pair, point) > Rows::along(point, rows_.pair_speed(pair, gap / rest));
    }
    // The least velocity of a point that does not bounce: one above the surface reaches it at the end of the step.
    [[nodiscard]] Speed target_of_gap(const Pair& pair, const Point& point) const {
        const Speed surface = Rows::surface_of(pair, point);
        return point.gap > Length{} ? surface - rows_.speed(pair, point, point.gap) : surface;
    }
    // True of a point that is to be stopped at once. A point that moved away slowly has bounced with its face, and so
    // comes as slowly. The forces of the rest of the step stop it where until then it sinks by no more than a resting
    // point may be above the surface.
    [[nodiscard]] bool sinks(const Pair& pair, const Point& point) const {
        const Speed stays = point.row[0].target - Rows::surface_of(pair, point);
        return stays - rows_.velocity(velocities_.now, pair, point) >
               rows_.speed(pair, point, Bounds::resting_gap(shapes_.tolerance()));
    }
    // True of an approach that bounces: it is faster than the scene's threshold, and the bounce lasts longer than the
    // step under the loads.
    [[nodiscard]] bool bounces(const Pair& pair, const Point& point, Speed approach) const {
        if (!(approach > velocities_.scale.noise())) return false;
        const Speed bounce = narrow<Speed>(mul(approach, pair.restitution));
        if (!(bounce + bounce > narrow<Speed>(mul(point.change_by_loads, rest_)))) return false;
        if (!(threshold_ > Work(0))) return true;
        return !(approach < Rows::along(point, rows_.pair_speed(pair, threshold_)));
    }
    // True if it is an error to leave out a bounce: it is faster than the change of speed by all loads in a step,
    // faster than a resting point, which is twice gravity's change, and not a small part of the step's approaches, as
    // at the end of an inelastic collapse. A slower bounce returns no faster than it left, and the forces of the next
    // step then hold it: without the bounce the body comes to rest a few steps earlier. A pile that comes to rest has
    // infinitely many such bounces in finite time, and a shorter step makes them no fewer.
    [[nodiscard, gnu::noinline, gnu::cold]] bool bounces_far(const Pair& pair, const Point& point) const {
        const Speed approach = -rows_.velocity(velocities_.now, pair, point);
        const Speed bounce = narrow<Speed>(mul(approach, pair.restitution));
        return bounces(pair, point, approach) && bounce > point.change_by_loads &&
               bounce > Rows::along(point, rows_.pair_speed(pair, shapes_.slow())) &&
               velocities_.scale.work(bounce) > Bounds::left_by_collapse(fastest_);
    }
    [[gnu::noinline, gnu::cold]] void report_cut_off() {
        pairs_.for_each_active(island_, [&](const Pair& pair, const Point& point) {
            if (!is_apart(point) && bounces_far(pair, point)) bodies_.report(Issue::step_bound_hit, pair.a);
        });
    }
    // Solves for the impulses of the active points from the present velocities. Of one pair without friction, plain
    // sweeps converge best. `last`: nothing bounces. Then statics may know what too few sweeps do not find.
    void solve(bool one_smooth_pair, bool last = false) {
        copy(velocities_.round_start(), velocities_.now);
        const Speed enough = velocities_.scale.enough_in_impact(),
                    left = rows_.sweep(rows_.from_nothing(enough), !one_smooth_pair);
        // Each impulse is applied once, not in one part per sweep: this rounds less.
        copy(velocities_.now, velocities_.round_start());
        if constexpr (features.pairs)
            if (last && island_.group.count > 1 && left > enough && !is_spent() &&
                Statics<N, spin, features>{shapes_, pairs_, velocities_, bodies_, island_}.solve_impact())
                return;
        rows_.push_all();
    }
    // One round. False where no point bounces.
    bool bounce() {
        int active = 0, pairs = 0;
        bool rough = false;
        pairs_.for_each(island_, [&](Pair& pair) {
            if (!pair.is_struck()) return;
            bool any = false;
            Speed approach[Pair::max_points]{};
            for (int i = 0; i < pair.count; ++i) {
                const Point& point = pair.point[i];
                approach[i] = -rows_.velocity(velocities_.now, pair, point);
                any = any || (!is_apart(point) && bounces(pair, point, approach[i]));
            }
            if (any) ++pairs;
            for (int i = 0; i < pair.count; ++i) {
                Point& point = pair.point[i];
                // Points that rest beside one that bounces take part: rounding must not turn a body that lands flat. A
                // point that moves away does not, for an impulse there would add energy.
                point.active = any && !is_apart(point) && !bounces(pair, point, -approach[i]);
                if (!point.active) continue;
                Rows::clear_impulses(point);
                // Newton's law for all of them: so the targets of a face are those of a motion of the body. Others, of
                // more points than it has freedoms, would have the sweeps shift impulses among the points without end.
                point.row[0].target = narrow<Speed>(mul(approach[i], pair.restitution)) + Rows::surface_of(pair, point);
                rough = rough || pair.has_friction;
                ++active;
            }
        });
        if (active == 0) return false;
        solve(pairs == 1 && !rough);
        // One smooth point makes no energy.
        const Unit share = Rows::is_one_row || (!rough && active == 1) ? C::one() : scale_back();
        log_impulses(share);
        return !(share == Unit{});
    }
    // The change p of the velocities u by a round makes no energy: |u + s p|^2 <= |u|^2, with s as large as that
    // allows, at most 1. Newton's law with friction may make energy (Kane 1984), and sweeps that end early may.
    // Returns s.
    Unit scale_back() {
        using Square = decltype(dot(velocities_.now[0].linear, velocities_.now[0].linear));
        Square work{}, square{};
        for_each_component([&](Speed u, Speed& end) {
            const Speed p = end - u;
            work = mul_add(work, u, p);
            square = mul_add(square, p, p);
        });
        if constexpr (features.moving_surfaces()) take_off_surfaces(work);
        work = -(work + work);
        if (!(square > work)) return C::one();
        const Unit share = work > Square{} ? C::ratio_of_squares(work, square) : Unit{};
        for_each_component([&](Speed u, Speed& end) { end = u + narrow<Speed>(mul(end - u, share)); });
        return share;
    }
    // Takes off what the impulses of surfaces that move do by their velocities, so that what is left is as seen from
    // them.
    template <class Square>
    void take_off_surfaces(Square& work) requires(features.moving_surfaces()) {
        pairs_.for_each_active(island_, [&](const Pair& pair, const Point& point) {
            if (!pair.surface_moves) return;
            const auto take_off = [&](Speed impulse, Speed surface) { work = mul_add(work, -impulse, surface); };
            take_off(point.row[0].impulse, Rows::surface_of(pair, point));
            for (int k = 1; k < pair.rows(); ++k) take_off(point.row[k].impulse, point.row[k].target);
            if constexpr (features.rolling_resistance)
                for (int k = 0; k < 3 && pair.resists_spin(); ++k)
                    take_off(point.spin[k].impulse, point.spin[k].target);
        });
    }
    // Adds `share` of the impulses that solve() has found to the log, with the speeds of approach before them. A slower
    // one than the search for the impact resolves is none.
    void log_impulses([[maybe_unused]] Unit share) {
        if constexpr (features.contact_readout) {
            const Work least = Bounds::search_gap(shapes_.scale().metres(shapes_.tolerance()));
            pairs_.for_each(island_, [&](const Pair& pair) {
                if (!pair.is_struck()) return;
                Work fastest = least;
                for (int i = 0; i < pair.count; ++i) {
                    const Point& point = pair.point[i];
                    if (!point.active || !(point.row[0].impulse > Speed{})) continue;
                    const Speed approach = -rows_.velocity(velocities_.round_start(), pair, point);
                    const Work speed = rows_.metres_per_step(pair, point, approach);
                    if (speed > fastest) fastest = speed;
                }
                auto* const entry = log_.add(pair, shapes_, bodies_, N::work(share));
                if (entry != nullptr && fastest > least && fastest > entry->hit_speed) entry->hit_speed = fastest;
            });
        }
    }
    // Calls f(velocity at the start of the round, velocity).
    template <class F>
    void for_each_component(F&& f) {
        for (int k = 0; k < island_.group.count; ++k) {
            const int b = island_.group.id[k];
            const Velocity& u = velocities_.round_start()[b];
            Velocity& end = velocities_.now[b];
            for (int i = 0; i < 3; ++i) {
                f(u.linear[i], end.linear[i]);
                f(u.angular[i], end.angular[i]);
            }
        }
    }

    const NarrowPhase& shapes_;
    PairList& pairs_;
    Velocities& velocities_;
    Bodies& bodies_;
    const Island& island_;
    Rows rows_;
    Work threshold_;
    Unit rest_{};  // of the step
    Work& fastest_;
    Log& log_;
};

}  // namespace tumble

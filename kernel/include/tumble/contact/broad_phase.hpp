// Broad phase: finds the pairs that may touch within a step. For every other pair it keeps a lower bound on the time to
// contact, and examines the pair again only when that time is over.
#pragma once

#include <tumble/contact/clear_times.hpp>
#include <tumble/contact/seams.hpp>
#include <tumble/contact/sleepers.hpp>
#include <tumble/solver/marks.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class BroadPhase {
public:
    using NarrowPhase = tumble::NarrowPhase<N, spin, features>;
    using Bodies = typename NarrowPhase::Bodies;
    using BodyGroup = tumble::BodyGroup<features.bodies>;
    using Pair = typename NarrowPhase::Pair;
    using C = typename NarrowPhase::C;
    using Length = typename NarrowPhase::Length;
    using PairList = tumble::PairList<N, features>;
    using Sleepers = tumble::Sleepers<N, spin, features>;
    using Times = ClearTimes<N, features>;
    using Seams = tumble::Seams<N, spin, features>;

    // `keeps`: pairs that are apart stay in the list until their bodies are examined again.
    BroadPhase(NarrowPhase& shapes, PairList& pairs, Times& times, Bodies& bodies, bool keeps = false)
        : shapes_{shapes}, pairs_{pairs}, times_{times}, bodies_{bodies}, keeps_{keeps} {}

    // Examines the pairs of body b whose time to contact may be over. Adds sleeping bodies that b may touch to `wakes`.
    // Of a kinematic body only pairs with sleeping bodies: those that are awake look for it themselves.
    template <class Marks>
    [[gnu::noinline]] void update(int b, const Marks& marks, const Sleepers& sleepers,
                                  BodyGroup& wakes) requires(features.pairs) {
        const std::uint32_t now = bodies_.steps_taken;
        const auto loaded = [&] { return feels_loads(b, marks); };  // changes where the body comes near something
        examine_pairs_of(b, [&](const Vec3<Length>& own, bool is_kinematic) {
            int until = is_kinematic ? contact::most_clear_steps : examine_planes(b, own, marks, loaded);
            const ShapeKind kind = shapes_.shape(b).kind;
            const auto look_at = [&](int other, [[maybe_unused]] Pair* pair) {
                const ShapeKind kind_of_other = shapes_.shape(other).kind;
                if (other == b || !touches_bodies(kind_of_other) || !touching_meet(kind, kind_of_other)) return;
                if constexpr (features.layers)
                    if (!shapes_.share_a_layer(b, other)) return;
                const bool asleep = sleepers.is_asleep(other);
                const int first = first_of(b, other, is_kinematic), second = first == b ? other : b;
                if constexpr (features.grid()) {
                    if (is_kinematic && !asleep && !bodies_.constants[other].fixed()) times_.set(other, now);
                }
                if (is_kinematic && !asleep) return;
                const bool fixed = cannot_move(other, asleep);
                const auto clear_steps = [&] {
                    return steps_to_body(b, other, own, loaded() || (!fixed && feels_loads(other, marks)), fixed);
                };
                const auto near = [&](bool listed) {
                    if (!listed || asleep) pair = pair_of(first, second, marks);
                    if (!asleep || pair == nullptr) return contact::most_clear_steps_near;
                    shapes_.place(bodies_, b);
                    seams().measure(*pair);
                    if (!(pair->gap > reach_in_step(b))) wakes.add_once(other);
                    return 1;
                };
                const auto apart = [&] {
                    forget(first, second, marks[b]);
                    pair = nullptr;
                };
                int steps;
                if constexpr (features.grid()) {
                    steps = pair == nullptr ? 0 : steps_left(*pair);
                    if (steps == 0) {
                        steps = examine_now(pair != nullptr, clear_steps, near, apart);
                        if (pair != nullptr) set_due(*pair, steps);
                    }
                } else {
                    steps = examine_if_due(Times::body_slot(b, other), clear_steps, near, apart);
                }
                if (steps < until) until = steps;
            };
            if (!touches_bodies(kind)) return until;
            if constexpr (features.grid()) {
                if (const int steps = put(b, own, loaded(), is_kinematic); steps < until) until = steps;
                for_each_that_may_meet(b, is_kinematic, look_at);
            } else {
                for (int other = 0; other < bodies_.count; ++other) look_at(other, nullptr);
            }
            return until;
        });
    }
    // The same where no two bodies touch each other.
    template <class Marks>
    [[gnu::noinline]] void update(int b, const Marks& marks) requires(!features.pairs) {
        examine_pairs_of(b, [&](const Vec3<Length>& own, bool is_kinematic) {
            return is_kinematic ? contact::most_clear_steps
                                : examine_planes(b, own, marks, [&] { return marks[b].driven; });
        });
    }

    // Begins a step. With a grid puts bodies that have come into it, and ends the bounds of bodies that others may
    // push.
    void begin([[maybe_unused]] const Sleepers& sleepers) requires(features.pairs) {
        times_.push.ask();
        if constexpr (features.grid()) begin_grid(sleepers);
    }
    // With a grid. The bodies that may meet body b before the next step are examined then.
    void examine_around(int b) requires(features.grid()) {
        times_.many.grid.for_each_near(b, shapes_.scale(), [&](int other) { times_.set(other, bodies_.steps_taken); });
    }

    // Connects the bodies of every pair that is awake. A pair sleeps where its moving bodies do. Measures the pairs
    // that have changed since the end of the last step: those left out of it, and those with a turntable.
    void connect(Islands<features.bodies>& islands, const Sleepers& sleepers) requires(features.pairs) {
        bool any = false;
        for (int i = 0; i < pairs_.count(); ++i) {
            Pair& pair = pairs_[i];
            const auto is_awake = [&] { return !sleepers.is_asleep(pair.a) && !sleepers.is_asleep(pair.b); };
            bool turned = pair.surface_moves;
            if constexpr (features.kinematic) {
                shapes_.note_motion(pair, bodies_);
                if (pair.surface_moves) pairs_.unbalance(pair);
                turned = turned && !bodies_.constants[pair.b].kinematic();
            }
            pair.selected = (pair.left_out || turned) && is_awake();
            if (pair.selected) {
                any = true;
                pair.moved = pair.moved || pair.left_out;
                pair.left_out = false;
            }
            if (pair.moves_b() && is_awake()) islands.connect(pair.a, pair.b);
        }
        // After all of them are in: a seam asks for the other pairs of a body.
        for (int i = 0; any && i < pairs_.count(); ++i)
            if (pairs_[i].selected) examine(pairs_[i]);
    }

private:
    // Sets when body b is examined again to the steps that examine(its drift, is_kinematic) returns.
    template <class F>
    TUMBLE_INLINE void examine_pairs_of(int b, F&& examine) {
        const std::uint32_t now = bodies_.steps_taken;
        times_.set(b, now + contact::most_clear_steps);
        if (shapes_.response() != ContactResponse::impulse || shapes_.shape(b).is(ShapeKind::none)) return;
        const bool was_near = pairs_.is_near(b);
        if (!was_near) pairs_.forget_points_of(b);
        int until = examine(drift(b), features.kinematic && bodies_.constants[b].kinematic());
        // Examined again in the next step: a body whose bounds were ended meanwhile, and one that has just left
        // everything.
        if (!times_.is_clear(b, now) || (was_near && !pairs_.is_near(b))) until = 1;
        times_.set(b, now + static_cast<std::uint32_t>(until));
    }
    // Examines a pair: near(whether it is in the list) adds it, apart() removes it. Returns the steps until it is due.
    template <class ClearSteps, class Near, class Apart>
    TUMBLE_INLINE static int examine_now(bool listed, ClearSteps&& clear_steps, Near&& near, Apart&& apart) {
        int steps = clear_steps();
        if (steps == 0) steps = near(listed);
        else if (listed) apart();
        return steps;
    }
    // The same where it is due.
    template <class... Parts>
    TUMBLE_INLINE int examine_if_due(int slot, Parts&&... parts) {
        const std::uint32_t now = bodies_.steps_taken;
        int steps = times_.steps_left(slot, now);
        if (steps <= 0 || steps > contact::most_clear_steps) {
            steps = examine_now(times_.is_listed(slot), parts...);
            times_.set_due(slot, now + static_cast<std::uint32_t>(steps));
        }
        return steps;
    }
    // Returns the steps until a pair of body b and a plane is due.
    template <class Marks, class Loaded>
    TUMBLE_INLINE int examine_planes(int b, const Vec3<Length>& own, const Marks& marks, Loaded&& loaded) {
        int until = contact::most_clear_steps;
        for (int p = 0; p < shapes_.plane_count(); ++p) {
            const int steps = examine_if_due(
                Times::plane_slot(b, p), [&] { return steps_to_plane(b, p, own, loaded()); },
                [&](bool listed) {
                    if (!listed) (void)pair_of(b, -1 - p, marks);
                    return contact::most_clear_steps_near;
                },
                [&] { forget(b, -1 - p, marks[b]); });
            if (steps < until) until = steps;
        }
        return until;
    }
    void begin_grid(const Sleepers& sleepers) requires(features.grid()) {
        auto& many = times_.many;
        for (int b = 0; many.come && b < bodies_.count; ++b) {
            if (many.grid.has(b) || !touches_bodies(shapes_.shape(b).kind)) continue;
            const bool fixed = bodies_.constants[b].fixed();
            (void)put(b, drift(b), !fixed, fixed);
            examine_around(b);
        }
        for (int k = 0; many.near && k < sleepers.awake_count(); ++k)
            if (pairs_.is_near(sleepers.awake(k))) end_times(sleepers.awake(k));
        many.come = many.near = false;
    }
    // Whether a load may act on body b in this step: one that is near something may be pushed by others, which have
    // loads of their own.
    template <class Marks>
    [[nodiscard]] bool feels_loads(int b, const Marks& marks) {
        return marks[b].driven || (pushes_something(marks) && pairs_.is_near(b));
    }
    // Whether a load acts on a body that is near something, and may so push others.
    template <class Marks>
    [[nodiscard]] bool pushes_something([[maybe_unused]] const Marks& marks) {
        bool any = false;
        if constexpr (features.pairs)
            any = times_.push.answer([&] {
                for (int b = 0; b < bodies_.count; ++b) any = any || (pairs_.is_near(b) && marks[b].driven);
                return any;
            });
        return any;
    }
    // Of a body that does not move in the step, as far as is known.
    [[nodiscard]] bool cannot_move(int b, bool asleep) const {
        if constexpr (features.kinematic)
            if (bodies_.constants[b].kinematic()) return false;
        return asleep || bodies_.constants[b].fixed();
    }
    // The body that comes first in the pair of two bodies.
    [[nodiscard]] int first_of(int b, int other, bool is_kinematic) const {
        return is_kinematic || (!bodies_.constants[other].fixed() && other < b) ? other : b;
    }
    // Calls f(other, pair) for the bodies whose balls meet that of body b and for those with which it has a pair, whose
    // balls may have parted since. In the order of their index, as without a grid: a pair that is listed changes the
    // bounds of those that are tested after it. Null where they have no pair.
    template <class F>
    void for_each_that_may_meet(int b, bool is_kinematic, F&& f) requires(features.grid()) {
        BodySet<features.bodies> others;
        Pair* pair_with[features.bodies];  // of those bodies
        int unseen = pairs_.pairs_with_bodies_of(b);
        const auto find = [&](int other) {
            const int first = first_of(b, other, is_kinematic);
            return near_pair(first, first == b ? other : b);
        };
        times_.many.grid.for_each_near(b, shapes_.scale(), [&](int other) {
            others.add(other);
            pair_with[other] = unseen > 0 ? find(other) : nullptr;
            if (pair_with[other] != nullptr) --unseen;
        });
        if (unseen > 0)
            pairs_.for_each_near(b, [&](int other) {
                others.add(other);
                pair_with[other] = find(other);
            });
        others.for_each([&](int other) { f(other, pair_with[other]); });
    }
    // The pair of two bodies; null where it is not in the list.
    [[nodiscard]] Pair* near_pair(int a, int b) requires(features.grid()) {
        if (pairs_.pairs_with_bodies_of(a) == 0 || pairs_.pairs_with_bodies_of(b) == 0) return nullptr;
        const std::uint32_t key = Pair::key_of(a, b);
        const int at = pairs_.place_of(key);
        return pairs_.has(at, key) ? &pairs_[at] : nullptr;
    }
    // Steps from now until a near pair is examined again; 0 where it is due.
    [[nodiscard]] int steps_left(const Pair& pair) const requires(features.grid()) {
        const int steps = Times::steps_left(pair.due, bodies_.steps_taken);
        return pair.ends != ends_of(pair) || steps <= 0 || steps > contact::most_clear_steps ? 0 : steps;
    }
    void set_due(Pair& pair, int steps) requires(features.grid()) {
        pair.due = static_cast<std::uint16_t>(bodies_.steps_taken + static_cast<std::uint32_t>(steps));
        pair.ends = ends_of(pair);
    }
    [[nodiscard]] std::uint16_t ends_of(const Pair& pair) const requires(features.grid()) {
        return static_cast<std::uint16_t>(times_.many.ends[pair.a] + times_.many.ends[pair.b]);
    }
    // Puts the body into the grid. Returns the steps in which it surely stays in its ball. In each of them the ball has
    // room for twice the drift, as a pair is tested with that where loads act on the other body. The ball of a body
    // that flies without loads has room for a move by its radius, too. One that is near something is examined again
    // soon anyway, and a smaller ball meets fewer.
    [[nodiscard]] int put(int b, const Vec3<Length>& drift, bool loaded, bool is_fixed) requires(features.grid()) {
        const auto& x = bodies_.state[b].x_w;
        const typename Grid<N, features.bodies>::Place place{N::sum(x.x), N::sum(x.y), N::sum(x.z)};
        const bool near = pairs_.is_near(b);
        const Length radius = shapes_.shape(b).radius, touch = radius + shapes_.tolerance(),
                     closing = twice(size_of(drift)), fall = is_fixed ? Length{} : twice(fall_of(near));
        const auto travel = C::travel(closing, fall, 1);
        const Length ball = times_.many.grid.put(b, place, shapes_.scale(), [&](Length enough) {
            const Length room = enough - touch;
            return (loaded || near || !(room < radius)) && !C::exceeds(travel, room);
        });
        return clear_steps(closing, fall, foresight(loaded, near),
                           [&](auto way) { return ball < C::longest() && C::exceeds(way, ball - touch); });
    }
    [[nodiscard]] static Length twice(Length l) { return l + l; }
    // A bound on the way in a step.
    [[nodiscard]] static Length size_of(const Vec3<Length>& drift) { return C::rounded_up(sum_of_magnitudes(drift)); }
    // Two free bodies fall alike, but something may hold one of them up.
    [[nodiscard]] Length fall_of(bool near) const {
        return C::rounded_up(near ? twice(shapes_.fall_bound()) : shapes_.fall_bound());
    }
    [[nodiscard]] Vec3<Length> drift(int b) const { return shapes_.drift(bodies_, b); }
    // The largest power of two of steps, up to `longest`, in which `reaches(travel)` stays false, with
    // travel >= speed k + fall k^2; 0 when one step is too long. It is convex in k: what it does not reach in one step
    // and in `longest`, it does not reach between.
    template <class Reaches>
    [[nodiscard]] static int clear_steps(Length speed, Length fall, int longest, Reaches&& reaches) {
        const auto is_clear = [&](int k) { return !reaches(C::travel(speed, fall, k)); };
        if (!is_clear(1)) return 0;
        if (is_clear(longest)) return longest;
        int steps = 1;
        while (is_clear(2 * steps)) steps *= 2;
        return steps;
    }
    // The most steps between two examinations of a pair. The bounds assume that loads at most double a speed within a
    // step. A body near something may be pushed.
    [[nodiscard]] static int foresight(bool loaded, bool near) {
        return loaded ? 1 : near ? contact::most_clear_steps_near : contact::most_clear_steps;
    }
    [[nodiscard]] int steps_to_plane(int b, int p, const Vec3<Length>& d, bool loaded) const {
        const Plane<N>& plane = shapes_.plane(p);
        Length closing = C::rounded_up(-narrow<Length>(dot(plane.normal, d)));
        if (loaded) closing = twice(size_of(d));
        Length fall = C::rounded_up(-narrow<Length>(dot(plane.normal, shapes_.fall())));
        if (fall < Length{}) fall = Length{};
        const bool near = pairs_.is_near(b);
        if (near) fall = C::rounded_up(twice(shapes_.fall_bound()));
        const Length gap = shapes_.height(bodies_, b, plane) - shapes_.shape(b).radius - shapes_.tolerance();
        return clear_steps(closing, fall, foresight(loaded, near),
                           [&](auto travel) { return C::exceeds(travel, gap); });
    }
    [[nodiscard]] int steps_to_body(int a, int b, Vec3<Length> d, bool loaded, bool fixed) const {
        const Vec3<Length> reach = shapes_.reach_between(bodies_, a, b);
        if (!fixed) d -= drift(b);
        const Length closing = loaded ? twice(size_of(d)) : size_of(d);
        const Length touch = shapes_.shape(a).radius + shapes_.shape(b).radius + shapes_.tolerance();
        const auto distance2 = dot(reach, reach);
        const bool near = pairs_.is_near(a) || pairs_.is_near(b);
        return clear_steps(closing, fall_of(near), foresight(loaded, near),
                           [&](auto travel) { return C::reaches(travel, touch, distance2); });
    }
    // Bound on the way of a point of the body in one step.
    [[nodiscard]] Length reach_in_step(int b) const {
        return size_of(drift(b)) + shapes_.fall_bound() + shapes_.tolerance() + shapes_.way_of_turn(bodies_, b);
    }
    // `mark`: of the body whose pairs are tested. Where a load acts on it, it may push others in this step: the answer
    // must not depend on whether the pair was removed before the first question. Otherwise its own test has asked.
    void forget(int a, int b, [[maybe_unused]] Mark mark) {
        if (features.bounded_steps && keeps_) return;
        if constexpr (features.pairs)
            if (mark.driven) times_.push.begin();
        pairs_.forget(a, b);
        times_.unlist(a, b);
    }
    // Returns the pair, and adds it where it is new. Null, and reported, when there is no room.
    template <class Marks>
    Pair* pair_of(int a, int b, [[maybe_unused]] const Marks& marks) {
        const std::uint32_t key = Pair::key_of(a, b);
        const int at = pairs_.place_of(key);
        if (pairs_.has(at, key)) return &pairs_[at];
        if (pairs_.is_full()) {
            bodies_.report(Issue::contacts_full, a);
            pairs_.refuse();
            return nullptr;
        }
        const bool is_first_of_a = !pairs_.is_near(a), is_first_of_b = b >= 0 && !pairs_.is_near(b);
        Pair& pair = pairs_.insert(at, a, b);
        times_.list(a, b);
        const auto begin_near = [&](int body) {
            end_times(body);
            if constexpr (features.grid()) examine_around(body);
            if constexpr (features.pairs) {
                if (!marks[body].driven) return;
                times_.push.begin();
                for (int other = 0; other < bodies_.count; ++other)
                    if (pairs_.is_near(other)) end_times(other);
            }
        };
        if (is_first_of_a) begin_near(a);
        if (is_first_of_b) begin_near(b);
        shapes_.set_up(pair, bodies_);
        examine(pair);
        if constexpr (Seams::exist) examine_seams(pair);
        return &pair;
    }
    void end_times(int b) { times_.end(b, shapes_.plane_count(), bodies_.steps_taken); }
    // Places the bodies of a new pair, measures it and finds its contact points.
    void examine(Pair& pair) {
        shapes_.place(bodies_, pair.a);
        if (!pair.with_plane()) shapes_.place(bodies_, pair.b);
        seams().measure(pair);
        shapes_.find(bodies_, pair);
    }
    // A new pair may bring a neighbour that covers a side.
    void examine_seams(const Pair& fresh) requires Seams::exist {
        for (int i = 0; i < pairs_.count(); ++i) {
            Pair& pair = pairs_[i];
            if (!seams().may_change(pair, fresh)) continue;
            if (pair.at_edge || pair.surface_moves) {
                seams().measure(pair);
                if (pair.axis.covered) shapes_.find(bodies_, pair);
            } else {
                // Without a side to choose, measuring finds what it found before. The rows are made anew alike.
                pair.moved = pair.moved || shapes_.has_turned(pair);
            }
        }
    }
    [[nodiscard]] Seams seams() const { return {shapes_, pairs_, bodies_}; }

    NarrowPhase& shapes_;
    PairList& pairs_;
    Times& times_;
    Bodies& bodies_;
    bool keeps_;
};

}  // namespace tumble

// Broad phase: finds the pairs that may touch within a step. For every other pair it keeps a lower bound on the time to
// contact, and examines the pair again only when that time is over.
#pragma once

#include <tumble/contact/marks.hpp>
#include <tumble/contact/narrow_phase.hpp>
#include <tumble/contact/pair_list.hpp>
#include <tumble/contact/sleepers.hpp>

namespace tumble {

// Until which step bodies and pairs surely touch nothing.
template <Features features>
class ClearTimes {
public:
    // Body b can touch nothing before step `now`.
    [[nodiscard]] TUMBLE_INLINE bool is_clear(int b, std::uint32_t now) const {
        return static_cast<std::int32_t>(clear_until_[b] - now) > 0;
    }
    void set(int b, std::uint32_t until) { clear_until_[b] = until; }
    // Steps from now until a pair is examined again; at most 0 where it is due.
    [[nodiscard]] int steps_left(int slot, std::uint32_t now) const {
        const auto left = static_cast<std::uint16_t>(due_[slot] - static_cast<std::uint16_t>(now));
        return static_cast<std::int16_t>(left);
    }
    void set_due(int slot, std::uint32_t step) { due_[slot] = static_cast<std::uint16_t>(step); }
    // Call where the body's motion changes other than by its flight: ends the bounds of the body and of its pairs.
    void end(int b, int planes, std::uint32_t now) {
        clear_until_[b] = now;
        for (int p = 0; p < planes; ++p) set_due(plane_slot(b, p), now);
        if constexpr (features.pairs) {
            for (int other = 0; other < features.bodies; ++other) {
                if (other == b) continue;
                set_due(body_slot(b, other), now);
                clear_until_[other] = now;
            }
        }
    }
    [[nodiscard]] static constexpr int plane_slot(int b, int p) { return b * features.planes + p; }
    [[nodiscard]] static constexpr int body_slot(int a, int b) {
        const int high = a < b ? b : a, low = a < b ? a : b;
        return features.bodies * features.planes + high * (high - 1) / 2 + low;
    }

    // Writes or reads what a snapshot holds.
    template <class Self, class Visit>
    static void each(Self& self, Visit& visit) {
        visit(self.clear_until_, self.due_);
    }

private:
    static constexpr int slots =
        features.bodies * features.planes + (features.pairs ? features.bodies * (features.bodies - 1) / 2 : 0);

    std::uint32_t clear_until_[features.bodies]{};  // its pairs are examined again in this step
    std::uint16_t due_[slots > 0 ? slots : 1]{};    // the lower half of the step in which a pair is examined again
};

template <class N, Spin spin, Features features>
class BroadPhase {
public:
    using NarrowPhase = tumble::NarrowPhase<N, spin, features>;
    using Bodies = typename NarrowPhase::Bodies;
    using BodyGroup = tumble::BodyGroup<features.bodies>;
    using Pair = typename NarrowPhase::Pair;
    using C = typename NarrowPhase::C;
    using Length = typename NarrowPhase::Length;
    using Work = typename N::Work;
    using PairList = tumble::PairList<N, features>;
    using Sleepers = tumble::Sleepers<N, spin, features>;
    using Times = ClearTimes<features>;

    BroadPhase(NarrowPhase& shapes, PairList& pairs, Times& times, Bodies& bodies)
        : shapes_{shapes}, pairs_{pairs}, times_{times}, bodies_{bodies} {}

    // Examines the pairs of body b whose time to contact may be over. Adds sleeping bodies that b may touch to `wakes`.
    // Of a kinematic body only pairs with sleeping bodies: those that are awake look for it themselves.
    template <class Marks>
    [[gnu::noinline]] void update(int b, const Marks& marks, const Sleepers& sleepers, BodyGroup& wakes) {
        const std::uint32_t now = bodies_.steps_taken;
        if (shapes_.response() != ContactResponse::impulse || shapes_.shape(b).is(ShapeKind::none)) {
            times_.set(b, now + contact::most_clear_steps);
            return;
        }
        const bool was_near = pairs_.is_near(b);
        // A body near something may be pushed by others, which have loads of their own.
        bool loaded = marks[b].driven;
        for (int other = 0; was_near && other < bodies_.count; ++other)
            loaded = loaded || (pairs_.is_near(other) && marks[other].driven);
        if (!was_near) pairs_.forget_points_of(b);
        int until = contact::most_clear_steps;
        // Examines a pair if it is due: near() adds it to the list, apart() removes it.
        const auto meet = [&](int slot, auto&& clear_steps, auto&& near, auto&& apart) {
            int steps = times_.steps_left(slot, now);
            if (steps <= 0 || steps > contact::most_clear_steps) {
                steps = clear_steps();
                if (steps == 0) steps = near();
                else apart();
                times_.set_due(slot, now + static_cast<std::uint32_t>(steps));
            }
            if (steps < until) until = steps;
        };
        const bool is_kinematic = features.kinematic && bodies_.constants[b].kinematic();
        for (int p = 0; p < shapes_.plane_count() && !is_kinematic; ++p) {
            meet(
                Times::plane_slot(b, p), [&] { return steps_to_plane(b, p, loaded); },
                [&] {
                    (void)pair_of(b, -1 - p);
                    return contact::most_clear_steps_near;
                },
                [&] { pairs_.forget(b, -1 - p); });
        }
        if constexpr (features.pairs) {
            const ShapeKind kind = shapes_.shape(b).kind;
            for (int other = 0; other < bodies_.count && touches_bodies(kind); ++other) {
                const ShapeKind kind_of_other = shapes_.shape(other).kind;
                if (other == b || !touches_bodies(kind_of_other) || !touching_meet(kind, kind_of_other)) continue;
                const bool other_moves = !bodies_.constants[other].fixed(), asleep = sleepers.is_asleep(other);
                if (is_kinematic && !asleep) continue;
                const int first = is_kinematic || (other_moves && other < b) ? other : b,
                          second = first == b ? other : b;
                bool still = !other_moves || asleep;
                if constexpr (features.kinematic) still = still && !bodies_.constants[other].kinematic();
                meet(
                    Times::body_slot(b, other),
                    [&] { return steps_to_body(b, other, loaded || (!still && marks[other].driven), still); },
                    [&] {
                        Pair* pair = pair_of(first, second);
                        if (pair == nullptr || !asleep) return contact::most_clear_steps_near;
                        shapes_.place(bodies_, b);
                        shapes_.measure(bodies_, *pair);
                        if (!(pair->gap > reach_in_step(b))) wakes.add_once(other);
                        return 1;
                    },
                    [&] { pairs_.forget(first, second); });
            }
        }
        // Examined again in the next step: a body that has just come near something, and one that has just left
        // everything.
        if (was_near != pairs_.is_near(b)) until = 1;
        times_.set(b, now + static_cast<std::uint32_t>(until));
    }

    // Connects the bodies of every pair that is awake. A pair sleeps where its moving bodies do. Measures the pairs
    // that have changed since the end of the last step: those left out of it, and those with a turntable.
    void connect(Islands<features.bodies>& islands, const Sleepers& sleepers) {
        for (int i = 0; i < pairs_.count(); ++i) {
            Pair& pair = pairs_[i];
            const auto is_awake = [&] { return !sleepers.is_asleep(pair.a) && !sleepers.is_asleep(pair.b); };
            bool turned = pair.surface_moves;
            if constexpr (features.kinematic) {
                shapes_.note_motion(pair, bodies_);
                if (pair.surface_moves) pair.still = 0;
                turned = turned && !bodies_.constants[pair.b].kinematic();
            }
            if ((pair.left_out || turned) && is_awake()) {
                pair.moved = pair.moved || pair.left_out;
                pair.left_out = false;
                examine(pair);
            }
            if (pair.moves_b() && is_awake()) islands.connect(pair.a, pair.b);
        }
    }

private:
    [[nodiscard]] Vec3<Length> drift(int b) const {
        const auto& s = bodies_.state[b];
        return {shapes_.scale().drift(N::sum(s.d_w.x), bodies_.scale),
                shapes_.scale().drift(N::sum(s.d_w.y), bodies_.scale),
                shapes_.scale().drift(N::sum(s.d_w.z), bodies_.scale)};
    }
    // The largest power of two of steps, up to `longest`, in which `reaches(travel)` stays false, with
    // travel >= speed k + fall k^2; 0 when one step is too long.
    template <class Reaches>
    [[nodiscard]] static int clear_steps(Length speed, Length fall, int longest, Reaches&& reaches) {
        int steps = 0;
        for (int k = 1; k <= longest; k *= 2) {
            if (reaches(C::travel(speed, fall, k))) break;
            steps = k;
        }
        return steps;
    }
    // The most steps between two examinations of a pair. The bounds assume that loads at most double a speed within a
    // step. A body near something may be pushed.
    [[nodiscard]] static int foresight(bool loaded, bool near) {
        return loaded ? 1 : near ? contact::most_clear_steps_near : contact::most_clear_steps;
    }
    [[nodiscard]] int steps_to_plane(int b, int p, bool loaded) const {
        const Plane<N>& plane = shapes_.plane(p);
        const Vec3<Length> d = drift(b);
        Length closing = C::rounded_up(-narrow<Length>(dot(plane.normal, d)));
        if (loaded) closing = C::rounded_up(sum_of_magnitudes(d));
        if (loaded) closing = closing + closing;
        Length fall = C::rounded_up(-narrow<Length>(dot(plane.normal, shapes_.fall())));
        if (fall < Length{}) fall = Length{};
        const bool near = pairs_.is_near(b);
        if (near) fall = C::rounded_up(shapes_.fall_bound() + shapes_.fall_bound());
        const Length gap = shapes_.height(bodies_, b, plane) - shapes_.shape(b).radius - shapes_.tolerance();
        return clear_steps(closing, fall, foresight(loaded, near),
                           [&](auto travel) { return C::exceeds(travel, gap); });
    }
    [[nodiscard]] int steps_to_body(int a, int b, bool loaded, bool still) const {
        const Vec3<Length> reach = shapes_.reach_between(bodies_, a, b);
        Vec3<Length> d = drift(a);
        if (!still) d -= drift(b);
        Length closing = C::rounded_up(sum_of_magnitudes(d));
        if (loaded) closing = closing + closing;
        const Length touch = shapes_.shape(a).radius + shapes_.shape(b).radius + shapes_.tolerance();
        const auto distance2 = dot(reach, reach);
        // Two free bodies fall alike, but something may hold one of them up.
        const bool near = pairs_.is_near(a) || pairs_.is_near(b);
        const Length fall = C::rounded_up(near ? shapes_.fall_bound() + shapes_.fall_bound() : shapes_.fall_bound());
        return clear_steps(closing, fall, foresight(loaded, near),
                           [&](auto travel) { return C::reaches(travel, touch, distance2); });
    }
    // Bound on the way of a point of the body in one step.
    [[nodiscard]] Length reach_in_step(int b) const {
        Work turn(0);
        for (int i = 0; i < 3; ++i) turn += magnitude_of(bodies_.turn(b, i));
        return C::rounded_up(sum_of_magnitudes(drift(b))) + shapes_.fall_bound() + shapes_.tolerance() +
               shapes_.scale().length(turn * shapes_.scale().metres(shapes_.shape(b).radius));
    }
    // Returns the pair, and adds it where it is new. Null, and reported, when there is no room.
    Pair* pair_of(int a, int b) {
        const std::uint32_t key = Pair::key_of(a, b);
        const int at = pairs_.place_of(key);
        if (pairs_.has(at, key)) return &pairs_[at];
        if (pairs_.is_full()) {
            bodies_.report(Issue::contacts_full, a);
            return nullptr;
        }
        const bool is_first_of_a = !pairs_.is_near(a), is_first_of_b = b >= 0 && !pairs_.is_near(b);
        Pair& pair = pairs_.insert(at, a, b);
        if (is_first_of_a) end_times(a);
        if (is_first_of_b) end_times(b);
        shapes_.set_up(pair, bodies_);
        examine(pair);
        return &pair;
    }
    void end_times(int b) { times_.end(b, shapes_.plane_count(), bodies_.steps_taken); }
    // Places the bodies of a new pair, measures it and finds its contact points.
    void examine(Pair& pair) {
        shapes_.place(bodies_, pair.a);
        if (!pair.with_plane()) shapes_.place(bodies_, pair.b);
        shapes_.measure(bodies_, pair);
        shapes_.find(bodies_, pair);
    }

    NarrowPhase& shapes_;
    PairList& pairs_;
    Times& times_;
    Bodies& bodies_;
};

}  // namespace tumble

// Broad phase: finds the pairs that may touch within a step. For every other pair it keeps a lower bound on the time to
// contact, and examines the pair again only when that time is over.
#pragma once

#include <tumble/contact/islands.hpp>
#include <tumble/contact/narrow_phase.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class BroadPhase : public NarrowPhase<N, spin, features> {
    using Base = NarrowPhase<N, spin, features>;

public:
    using typename Base::Bodies;
    using typename Base::C;
    using typename Base::Length;
    using typename Base::Pair;
    using typename Base::State;
    using typename Base::Work;

    BroadPhase(Real step, const ContactSpec& spec) : Base(step, spec), response_{spec.response} {}

    // Sets the collision shape of body b.
    [[gnu::noinline]] void set_shape(int b, const BodySpec& spec, const PrincipalInertia& inertia,
                                     const SpinUnits<N, spin>& units) {
        if (make_room(reach_of(spec.shape))) forget_all();
        touching_[b] = 0;
        set_collision_shape<N, spin, features.mixed()>(shape_[b], spec, inertia, scale(), units);
    }

    // Body b can touch nothing before step `now`.
    [[nodiscard]] TUMBLE_INLINE bool is_foreseen(int b, std::uint32_t now) const {
        return static_cast<std::int32_t>(foreseen_until_[b] - now) > 0;
    }
    // Body b has a pair in the list.
    [[nodiscard]] TUMBLE_INLINE bool is_near(int b) const { return pairs_of_[b] != 0; }
    // Pairs in the list.
    [[nodiscard]] int pair_count() const { return pair_count_; }
    // Call where the body's motion changes other than by its flight: drops its bounds on the time to contact.
    void startle(int b, std::uint32_t now) {
        foreseen_until_[b] = now;
        for (int p = 0; p < plane_count_; ++p) due_[plane_slot(b, p)] = static_cast<std::uint16_t>(now);
        if constexpr (features.pairs) {
            for (int other = 0; other < features.bodies; ++other) {
                if (other == b) continue;
                due_[body_slot(b, other)] = static_cast<std::uint16_t>(now);
                foreseen_until_[other] = now;
            }
        }
    }

    // The same for the body and for all bodies near something, which it may push.
    void startle_all_near(int b, std::uint32_t now) {
        startle(b, now);
        for (int other = 0; is_near(b) && other < features.bodies; ++other)
            if (is_near(other)) startle(other, now);
    }

    // Removes the pairs of body b from the list. The next look finds them anew.
    [[gnu::noinline]] void forget_pairs_of(int b) {
        for (int i = pair_count_ - 1; i >= 0; --i)
            if (pair_[i].a == b || pair_[i].b == b) forget(pair_[i].a, pair_[i].b);
    }

    // Examines the pairs of body b whose time to contact may be over. is_loaded(b) is true of bodies with loads other
    // than gravity, is_still(b) of fixed and sleeping ones. Calls wake(b) for a sleeping body that b may touch.
    template <class IsLoaded, class IsStill, class Wake>
    [[gnu::noinline]] void look_around(Bodies& bodies, int b, IsLoaded&& is_loaded, IsStill&& is_still, Wake&& wake) {
        const std::uint32_t now = bodies.steps_taken;
        if (response_ != ContactResponse::impulse || shape_[b].is(ShapeKind::none)) {
            foreseen_until_[b] = now + contact::longest_look;
            return;
        }
        const bool was_near = is_near(b);
        // A body near something may be pushed by others, which have loads of their own.
        bool loaded = is_loaded(b);
        for (int other = 0; was_near && other < bodies.count; ++other)
            loaded = loaded || (is_near(other) && is_loaded(other));
        if (!was_near) touching_[b] = 0;
        int until = contact::longest_look;
        // Examines a pair if it is due: near() adds it to the list, apart() removes it.
        const auto meet = [&](int slot, auto&& clear_steps, auto&& near, auto&& apart) {
            int steps =
                static_cast<std::int16_t>(static_cast<std::uint16_t>(due_[slot] - static_cast<std::uint16_t>(now)));
            if (steps <= 0 || steps > contact::longest_look) {
                steps = clear_steps();
                if (steps == 0) steps = near();
                else apart();
                due_[slot] = static_cast<std::uint16_t>(now + static_cast<std::uint32_t>(steps));
            }
            if (steps < until) until = steps;
        };
        for (int p = 0; p < plane_count_; ++p) {
            meet(
                plane_slot(b, p), [&] { return steps_to_plane(bodies, b, p, loaded); },
                [&] {
                    (void)pair_of(bodies, b, -1 - p);
                    return contact::near_look;
                },
                [&] { forget(b, -1 - p); });
        }
        if constexpr (features.pairs) {
            for (int other = 0; other < bodies.count && touches_bodies(shape_[b].kind); ++other) {
                if (other == b || !touches_bodies(shape_[other].kind)) continue;
                if (!touching_meet(shape_[b].kind, shape_[other].kind)) continue;
                const bool other_moves = !bodies.constants[other].fixed;
                const int first = other_moves && other < b ? other : b, second = first == b ? other : b;
                const bool still = is_still(other);
                meet(
                    body_slot(b, other),
                    [&] { return steps_to_body(bodies, b, other, loaded || (!still && is_loaded(other)), still); },
                    [&] {
                        Pair* pair = pair_of(bodies, first, second);
                        if (pair == nullptr || !still || !other_moves) return contact::near_look;
                        place(bodies, b);
                        measure(bodies, *pair);
                        if (!(pair->gap > reach_in_step(bodies, b))) wake(other);
                        return 1;
                    },
                    [&] { forget(first, second); });
            }
        }
        // Examined again in the next step: a body that has just come near something, and one that has just left
        // everything.
        if (was_near != is_near(b)) until = 1;
        foreseen_until_[b] = now + static_cast<std::uint32_t>(until);
    }

    // Connects the bodies of every pair that is awake. A pair sleeps where its moving bodies do. Measures the pairs
    // that have changed since the end of the last step: those left out of it, and those with a fixed body that turns.
    template <class IsAwake>
    void connect(Islands<features.bodies>& islands, const Bodies& bodies, IsAwake&& is_awake) {
        for (int i = 0; i < pair_count_; ++i) {
            Pair& pair = pair_[i];
            if ((pair.left_out || pair.turns) && is_awake(pair.a) && is_awake(pair.b)) {
                pair.moved = pair.moved || pair.left_out;
                pair.left_out = false;
                look_at(bodies, pair);
            }
            if (moves_b(pair) && is_awake(pair.a) && is_awake(pair.b)) islands.connect(pair.a, pair.b);
        }
    }
    // Lists the pairs of the island with this root. A pair of two islands, which has come near only in this step, is
    // left out until the next.
    [[nodiscard]] int list(Islands<features.bodies>& islands, int root) {
        int first = -1;
        for (int i = pair_count_ - 1; i >= 0; --i) {
            Pair& pair = pair_[i];
            const bool has_a = islands.root(pair.a) == root, has_b = moves_b(pair) && islands.root(pair.b) == root;
            if (moves_b(pair) && has_a != has_b) pair.left_out = true;
            if (!has_a || (moves_b(pair) && !has_b)) continue;
            pair.next = static_cast<std::int16_t>(first);
            first = i;
        }
        return first;
    }
    // Calls f(a, b) for every two bodies that were within the tolerance.
    template <class F>
    void for_each_touching(F&& f) const {
        for (int i = 0; i < pair_count_; ++i)
            if (pair_[i].b >= 0 && pair_[i].count > 0) f(pair_[i].a, pair_[i].b);
    }

    // Writes or reads what a snapshot holds.
    template <class Archive>
    static void archive(std::conditional_t<Archive::reads, BroadPhase, const BroadPhase>& self, const Bodies& bodies,
                        Archive& to) {
        Base::archive(self, to);
        to(self.foreseen_until_, self.due_, self.touching_, self.pairs_of_, self.pair_count_);
        for (int i = 0; i < self.pair_count_; ++i) {
            auto& pair = self.pair_[i];
            std::int16_t a = pair.a, b = pair.b;
            to(a, b);
            if constexpr (Archive::reads) {
                pair.begin(a, b);
                self.set_up(pair, bodies);
            }
            to(pair);
        }
    }

protected:
    using Base::axes_;
    using Base::fall_;
    using Base::fall_bound_;
    using Base::find;
    using Base::height;
    using Base::make_room;
    using Base::measure;
    using Base::moves_b;
    using Base::place;
    using Base::plane_;
    using Base::plane_count_;
    using Base::reach_between;
    using Base::scale;
    using Base::set_up;
    using Base::shape_;
    using Base::tolerance_;
    template <class T, int n>
    using Array = typename Base::template Array<T, n>;
    static constexpr int room = features.room_for_pairs();

    Array<Pair, room> pair_{};  // in the order of their keys
    int pair_count_ = 0;
    // A body has a pair with each plane and each other body at most.
    static constexpr int most_pairs_of_a_body = features.planes + (features.pairs ? features.bodies - 1 : 0);
    CountTo<most_pairs_of_a_body * Pair::max_points> touching_[features.bodies]{};  // contact points in the last step

private:
    static constexpr int slots =
        features.bodies * features.planes + (features.pairs ? features.bodies * (features.bodies - 1) / 2 : 0);

    // --- time to contact ---------------------------------------------------------------------------------------------

    [[nodiscard]] Vec3<Length> drift(const Bodies& bodies, int b) const {
        const State& s = bodies.state[b];
        return {scale().drift(N::sum(s.d_w.x), bodies.scale), scale().drift(N::sum(s.d_w.y), bodies.scale),
                scale().drift(N::sum(s.d_w.z), bodies.scale)};
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
    // The most steps that a pair is foreseen. The bounds assume that loads at most double a speed within a step. A body
    // near something may be pushed.
    [[nodiscard]] static int foresight(bool loaded, bool near) {
        return loaded ? 1 : near ? contact::near_look : contact::longest_look;
    }
    [[nodiscard]] int steps_to_plane(const Bodies& bodies, int b, int p, bool loaded) const {
        const Plane<N>& plane = plane_[p];
        const Vec3<Length> d = drift(bodies, b);
        Length closing = C::rounded_up(-narrow<Length>(dot(plane.normal, d)));
        if (loaded) closing = C::rounded_up(sum_of_magnitudes(d));
        if (loaded) closing = closing + closing;
        Length fall = C::rounded_up(-narrow<Length>(dot(plane.normal, fall_)));
        if (fall < Length{}) fall = Length{};
        const bool near = is_near(b);
        if (near) fall = C::rounded_up(fall_bound_ + fall_bound_);
        const Length gap = height(bodies, b, plane) - shape_[b].radius - tolerance_;
        return clear_steps(closing, fall, foresight(loaded, near),
                           [&](auto travel) { return C::exceeds(travel, gap); });
    }
    [[nodiscard]] int steps_to_body(const Bodies& bodies, int a, int b, bool loaded, bool still) const {
        const Vec3<Length> reach = reach_between(bodies, a, b);
        Vec3<Length> d = drift(bodies, a);
        if (!still) d -= drift(bodies, b);
        Length closing = C::rounded_up(sum_of_magnitudes(d));
        if (loaded) closing = closing + closing;
        const Length touch = shape_[a].radius + shape_[b].radius + tolerance_;
        const auto distance2 = dot(reach, reach);
        // Two free bodies fall alike, but something may hold one of them up.
        const bool near = is_near(a) || is_near(b);
        const Length fall = C::rounded_up(near ? fall_bound_ + fall_bound_ : fall_bound_);
        return clear_steps(closing, fall, foresight(loaded, near),
                           [&](auto travel) { return C::reaches(travel, touch, distance2); });
    }
    // Bound on the way of a point of the body in one step.
    [[nodiscard]] Length reach_in_step(const Bodies& bodies, int b) const {
        Work turn(0);
        for (int i = 0; i < 3; ++i) turn += magnitude_of(bodies.turn(b, i));
        return C::rounded_up(sum_of_magnitudes(drift(bodies, b))) + fall_bound_ + tolerance_ +
               scale().length(turn * scale().metres(shape_[b].radius));
    }
    [[nodiscard]] static constexpr int plane_slot(int b, int p) { return b * features.planes + p; }
    [[nodiscard]] static constexpr int body_slot(int a, int b) {
        const int high = a < b ? b : a, low = a < b ? a : b;
        return features.bodies * features.planes + high * (high - 1) / 2 + low;
    }

    // --- near pairs ----------------------------------------------------------------------------------------------

    // Returns the pair, and adds it where it is new. Null, and reported, when there is no room. Pairs are sorted by
    // their keys, so that the solution does not depend on which came near first.
    Pair* pair_of(Bodies& bodies, int a, int b) {
        const std::uint32_t key = Pair::key_of(a, b);
        int at = 0;
        while (at < pair_count_ && pair_[at].key() < key) ++at;
        if (at < pair_count_ && pair_[at].key() == key) return &pair_[at];
        if (pair_count_ == room) {
            bodies.report(Issue::contacts_full, a);
            return nullptr;
        }
        for (int i = room - 1; i > at; --i)
            if (i <= pair_count_) pair_[i] = pair_[i - 1];
        ++pair_count_;
        Pair& pair = pair_[at];
        pair.begin(a, b);
        if (pairs_of_[a]++ == 0) startle(a, bodies.steps_taken);
        if (b >= 0 && pairs_of_[b]++ == 0) startle(b, bodies.steps_taken);
        set_up(pair, bodies);
        look_at(bodies, pair);
        return &pair;
    }
    // Places the bodies of a new pair, measures it and finds its contact points.
    void look_at(const Bodies& bodies, Pair& pair) {
        place(bodies, pair.a);
        if (!pair.with_plane()) place(bodies, pair.b);
        measure(bodies, pair);
        find(bodies, pair);
    }
    void forget_all() {
        pair_count_ = 0;
        for (auto& count : pairs_of_) count = 0;
    }
    void forget(int a, int b) {
        for (int i = 0; i < pair_count_; ++i) {
            if (pair_[i].a != a || pair_[i].b != b) continue;
            --pairs_of_[a];
            if (b >= 0) --pairs_of_[b];
            --pair_count_;
            for (int k = i + 1; k < room && k <= pair_count_; ++k) pair_[k - 1] = pair_[k];
            return;
        }
    }

    ContactResponse response_;
    std::uint32_t foreseen_until_[features.bodies]{};  // its pairs are examined again in this step
    CountTo<most_pairs_of_a_body> pairs_of_[features.bodies]{};
    Array<std::uint16_t, slots> due_{};  // the lower half of the step in which a pair is examined again
};

}  // namespace tumble

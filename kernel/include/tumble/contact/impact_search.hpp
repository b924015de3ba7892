// The search for an impact: how deep the pairs of an island are at the end of a flight, and which may have passed
// through each other.
#pragma once

#include <tumble/contact/seams.hpp>
#include <tumble/touch/path.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class ImpactSearch {
public:
    using NarrowPhase = tumble::NarrowPhase<N, spin, features>;
    using Bodies = typename NarrowPhase::Bodies;
    using Bounds = typename NarrowPhase::Bounds;
    using Length = typename NarrowPhase::Length;
    using C = ContactNumbers<N>;
    using Pair = typename NarrowPhase::Pair;
    using Work = typename N::Work;
    using PairList = tumble::PairList<N, features>;
    using Island = tumble::Island<features>;
    static constexpr bool has_edges = features.pairs && features.boxes;
    using Seams = tumble::Seams<N, spin, features>;

    ImpactSearch(NarrowPhase& shapes, PairList& pairs, const Bodies& bodies, const Island& island)
        : shapes_{shapes}, pairs_{pairs}, bodies_{bodies}, island_{island} {}

    // m.
    [[nodiscard]] Work tolerance() const { return shapes_.scale().metres(shapes_.tolerance()); }
    // Keeps the gaps and normals of the start of a flight.
    void start_flight() {
        pairs_.for_each(island_, [](Pair& pair) {
            pair.passed = false;
            if (pair.count == 0) pair.touched = false;
            if constexpr (Seams::exist) pair.start_covered = pair.axis.covered;
            pair.start_gap = pair.gap;
            if constexpr (features.pairs) pair.start_normal = pair.normal;
        });
    }
    // Measures the bodies and pairs of the island where they are now.
    void measure() {
        for (int k = 0; k < island_.group.count; ++k) shapes_.place(bodies_, island_.group.id[k]);
        if constexpr (features.kinematic)
            pairs_.for_each(island_, [&](const Pair& pair) {
                if (pair.surface_moves) shapes_.place(bodies_, pair.b);
            });
        pairs_.for_each(island_, [&](Pair& pair) { seams().measure(pair); });
    }
    // True of bodies that are apart and slide onto each other over a seam.
    [[nodiscard]] bool slides_onto([[maybe_unused]] const Pair& pair) const {
        if constexpr (Seams::exist) return pair.gap > shapes_.tolerance() && seams().slides_onto(pair);
        else return false;
    }
    // Call at the end of a flight. A pair that has come together over a seam is no new one: its bodies have touched.
    void note_seams() {
        if constexpr (Seams::exist) {
            bool any = false;
            pairs_.for_each(island_, [&](Pair& pair) {
                pair.selected = !pair.touched && !pair.with_plane() && seams().is_crossed(pair);
                any = any || pair.selected;
            });
            if (any) pairs_.for_each(island_, [](Pair& pair) { pair.touched = pair.touched || pair.selected; });
        }
    }
    // Finds the contact points of the pairs, which have been measured.
    void find() {
        pairs_.for_each(island_, [&](Pair& pair) { shapes_.find(bodies_, pair); });
    }
    // True where the bodies of all selected pairs come to flat surfaces that stand.
    [[nodiscard]] bool is_to_flat([[maybe_unused]] const SavedMotions<Bodies>& start) const {
        bool all = true;
        if constexpr (features.pairs)
            pairs_.for_each(island_, [&](const Pair& pair) {
                all = all && (!pair.selected || pair.with_plane() || (is_flat(pair) && is_parted_by_face(pair, start)));
            });
        return all;
    }
    // The gap of the point that is the first at its level, in the flight of this length from `start` to where the
    // bodies are. The selected pairs are with flat surfaces.
    [[nodiscard, gnu::noinline, gnu::cold]] GapCurve<N> first_gap(const SavedMotions<Bodies>& start,
                                                                  Work length) const {
        GapCurve<N> first{};
        bool any = false;
        auto root = C::one();
        const Work third = length * N::template constant<Work>(Real{1} / Real{3});
        pairs_.for_each(
            island_, [&](const Pair& pair) __attribute__((cold)) {
                if (!pair.selected) return;
                path_of(pair, place_of(pair), start, third)
                    .for_each_point([&](const GapCurve<N>& gap) __attribute__((cold)) {
                        if (any && gap.is_above(first)) return;
                        const auto at = gap.root(root);
                        if (any && !(at < root)) return;
                        any = true;
                        root = at;
                        first = gap;
                    });
            });
        return first;
    }
    // The least gap of the pairs that are selected, each above its level(). In the search for the end of a contact: how
    // far the first of the pairs is from being open, cut off at both ends.
    [[nodiscard]] Length least_gap(bool at_start) const {
        bool any = false;
        Length least{};
        pairs_.for_each(island_, [&](const Pair& pair) {
            if (!pair.selected) return;
            Length gap = (at_start ? pair.start_gap : pair.gap) - level(pair);
            if constexpr (has_edges)
                if (ends_contact_) gap = left_to_open(pair, at_start);
            if (!any || gap < least) least = gap;
            any = true;
        });
        return least;
    }
    [[nodiscard]] Work metres(Length gap) const { return shapes_.scale().metres(gap); }
    // Selects the pairs below their level for the search. Pairs that rest beside them would mislead it.
    void select() {
        if constexpr (has_edges) ends_contact_ = false;
        pairs_.for_each(island_, [&](Pair& pair) { pair.selected = pair.gap < level(pair); });
    }
    // True where a contact has ended at an edge within the flight: its force has acted, but the bodies are apart, and
    // no other pair holds them there. Selects these pairs for the search for the time at which they came apart. One of
    // the bodies is a box: other surfaces have no edges. `loads`: over a whole step.
    template <class Kicks>
    [[nodiscard]] bool select_ended(const Kicks& loads) requires(has_edges) {
        bool any = false;
        pairs_.for_each(island_, [&](Pair& pair) {
            pair.selected = !pair.with_plane() && pair.gap > open_gap(pair) && is_pushed(pair) &&
                            (shapes_.shape(pair.a).is(ShapeKind::box) || shapes_.shape(pair.b).is(ShapeKind::box)) &&
                            leaves(pair, loads) && !is_held_alike(pair);
            any = any || pair.selected;
        });
        ends_contact_ = any;
        return any;
    }
    // Keeps those of the selected pairs that are open now. Returns the time since the first of them began to open, as a
    // part of a step. The gap of a ball at an edge grows with the square of this time.
    [[nodiscard, gnu::noinline, gnu::cold]] Work time_since_open() requires(has_edges) {
        Work longest(0);
        pairs_.for_each(island_, [&](Pair& pair) {
            pair.selected = pair.selected && left_to_open(pair, false) < Pair::C::half(opening());
            if (!pair.selected || !is_round(pair)) return;
            const Work speed = speed_of_leaving(pair);
            if (!(speed > Work(0))) return;
            const Work gap = shapes_.scale().metres(pair.start_gap > Length{} ? pair.gap - pair.start_gap : pair.gap),
                       time = (gap + gap) / speed;
            if (time > longest) longest = time;
        });
        return longest;
    }
    // In the flight that starts, the selected pairs have no points, and they do not pass through each other.
    void end_selected() requires(has_edges) {
        pairs_.for_each(island_, [](Pair& pair) {
            if (!pair.selected) return;
            pair.count = 0;
            pair.touched = false;
            pair.passed = true;
        });
    }
    // True when a pair is deeper than the end of a flight allows: lowest() where it touched at the start, else the
    // surface.
    [[nodiscard]] bool is_too_deep() const { return is_too_deep(false); }
    // The same with lowest() for all pairs.
    [[nodiscard]] bool is_far_too_deep() const { return is_too_deep(true); }

    // A pair that is apart at both ends of the flight, but along the direction in which it was apart at the start it is
    // now deeper than the tolerance: it may have passed through. Null when there is none, or when pairs never do
    // (planes have no other side).
    struct Crossing {
        Pair* pair = nullptr;
        Vec3<Length> reach;  // at the end of the flight
        Axes<N> a, b;

        void at_start() const {
            if constexpr (features.pairs) {
                pair->gap = pair->start_gap;
                pair->normal = pair->start_normal;
            }
        }
    };
    [[nodiscard, gnu::noinline]] Crossing find_crossing() {
        Crossing found;
        if constexpr (features.pairs) {
            pairs_.for_each(island_, [&](Pair& pair) {
                if (found.pair != nullptr || pair.with_plane() || pair.touched || pair.passed || pair.gap < Length{})
                    return;
                const PairView<N> view = shapes_.view_of(bodies_, pair);
                if (!(view.separation(pair.start_normal, features.boxes) < -shapes_.tolerance())) return;
                found = {&pair, view.reach, shapes_.axes(pair.a), shapes_.axes(pair.b)};
            });
        }
        return found;
    }
    // True where bodies overlap beyond the middle: they are parted along another direction than that in which they were
    // apart.
    [[nodiscard]] bool is_on_the_other_side() const {
        bool any = false;
        if constexpr (features.pairs)
            pairs_.for_each(island_, [&](const Pair& pair) {
                any = any || (!pair.with_plane() && pair.gap < Length{} &&
                              narrow<typename Pair::Unit>(dot(pair.normal, pair.start_normal)) < typename Pair::Unit{});
            });
        return any;
    }
    // The part of the rest of the flight in which the pair surely stays apart: until the separation along its present
    // direction runs out. Negative: the whole rest.
    [[nodiscard]] Work part_apart(const Crossing& crossing) const {
        const Pair& pair = *crossing.pair;
        const PairView<N> end{shapes_.shape(pair.a), shapes_.shape(pair.b), crossing.a, crossing.b, crossing.reach};
        const Length left = end.separation(pair.normal, features.boxes);
        if (!(left < -shapes_.tolerance())) return Work(-1);
        if (!(pair.gap > Length{})) return Work(0);
        const Work gap = shapes_.scale().metres(pair.gap);
        return gap / (gap - shapes_.scale().metres(left));
    }
    // The bodies are as close as conservative advancement brings them. The gap along a face of a box may be negative
    // where an edge is in front of it.
    [[nodiscard]] bool is_close(const Crossing& crossing) {
        Pair& pair = *crossing.pair;
        const Length close = Bounds::crossing_gap(shapes_.tolerance());
        if (pair.gap > close) return false;
        seams().measure(pair, Length{});
        if (pair.gap > close) return false;
        seams().measure(pair);
        return true;
    }
    // The bodies touch in a point, so that an impact can stop them. Boxes may have none though they are close along
    // every axis, as corners that pass each other.
    [[nodiscard]] bool has_points(const Crossing& crossing) {
        shapes_.find(bodies_, *crossing.pair);
        return crossing.pair->count > 0;
    }

private:
    // Of body a of a pair in the island.
    [[nodiscard]] int place_of(const Pair& pair) const {
        int k = 0;
        while (island_.group.id[k] != pair.a) ++k;
        return k;
    }
    // True where body b of the pair is a fixed box that stands and has met the other body with the same face at both
    // ends of the flight: gaps along another direction have another start and another level.
    [[nodiscard]] bool is_flat(const Pair& pair) const {
        bool flat = false;
        if constexpr (has_edges) {
            if (pair.moves_b() || pair.surface_moves || !shapes_.shape(pair.b).is(ShapeKind::box)) return false;
            if (!(narrow<typename Pair::Unit>(dot(pair.normal, pair.start_normal)) > Bounds::along_face()))
                return false;
            const Axes<N> box = shapes_.shape(pair.b).axes(shapes_.axes(pair.b));
            for (int i = 0; i < 3; ++i)
                flat = flat ||
                       magnitude_of(narrow<typename Pair::Unit>(dot(box.axis(i), pair.normal))) > Bounds::along_face();
        }
        return flat;
    }
    // True where the plane of that face parts the bodies as far as anything does, at both ends. A box that lies across
    // the other one has its lowest vertex beside the face.
    [[nodiscard]] bool is_parted_by_face([[maybe_unused]] const Pair& pair,
                                         [[maybe_unused]] const SavedMotions<Bodies>& start) const {
        if constexpr (has_edges) {
            const auto is_parted = [&](const auto& state, const Axes<N>& axes, Length gap) {
                const PlaneView<N, features> view{shapes_.shape(pair.a), axes, pair.normal, height(pair, state)};
                return !(gap > view.gap() + Bounds::resting_gap(shapes_.tolerance()));
            };
            const auto& begin = start[place_of(pair)];
            return is_parted(bodies_.state[pair.a], shapes_.axes(pair.a), pair.gap) &&
                   is_parted(begin, Axes<N>::of(begin.q_wb.value()), pair.start_gap);
        }
        return true;
    }
    // Of the centre of body a of a pair above the flat surface of b.
    [[nodiscard]] Length height(const Pair& pair, const typename Bodies::State& a) const {
        if constexpr (has_edges)
            if (!pair.with_plane()) return shapes_.view_of(bodies_, pair, a).height(pair.normal, true);
        return shapes_.height(a, shapes_.plane(pair.plane()));
    }
    // The path of body k of the island to the flat surface of a pair. `third`: of the length of the flight, in steps.
    [[nodiscard, gnu::cold]] PlanePath<N, features> path_of(const Pair& pair, int k, const SavedMotions<Bodies>& start,
                                                            Work third) const {
        using Unit = typename Pair::Unit;
        const int a = pair.a;
        const Vec3<Unit> normal = pair.normal;
        Vec3<Length> drift;
        for (int i = 0; i < 3; ++i) drift[i] = shapes_.scale().fall(N::sum(start[k].d_w[i]), bodies_.scale);
        const Length low = level(pair);
        PlanePath<N, features> path{shapes_.shape(a), height(pair, start[k]) - low,
                                    height(pair, bodies_.state[a]) - low,
                                    mul(narrow<Length>(dot(normal, drift)), C::unit(third))};
        if constexpr (features.boxes || features.round_shapes) {
            const auto turn = [&](const auto& state, typename N::Scale unit) __attribute__((cold)) {
                Vec3<Unit> angle;
                for (int i = 0; i < 3; ++i) angle[i] = C::unit(bodies_.turn(a, i, state, unit) * third);
                return angle;
            };
            if (!shapes_.shape(a).is(ShapeKind::sphere))
                path.set_normals(Axes<N>::of(start[k].q_wb.value()).to_body(normal),
                                 turn(start[k], start.spin_scale(k, bodies_)), shapes_.axes(a).to_body(normal),
                                 turn(bodies_.state[a], bodies_.spin_scale(a)));
        }
        return path;
    }
    // A pair is open at a gap above rounding and above that of its start.
    [[nodiscard]] Length opening() const { return Bounds::resting_gap(shapes_.tolerance()); }
    [[nodiscard]] Length open_gap(const Pair& pair) const {
        return pair.start_gap > Length{} ? pair.start_gap + opening() : opening();
    }
    [[nodiscard]] Length left_to_open(const Pair& pair, bool at_start) const {
        const Length left = open_gap(pair) - (at_start ? pair.start_gap : pair.gap), most = opening();
        return left < -most ? -most : left > most ? most : left;
    }
    [[nodiscard]] static bool is_pushed(const Pair& pair) {
        bool any = false;
        for (int i = 0; i < pair.count; ++i)
            any = any || (pair.point[i].active && pair.point[i].row[0].impulse > typename Pair::C::Speed{});
        return any;
    }
    [[nodiscard]] bool is_round(const Pair& pair) const {
        return shapes_.shape(pair.a).is(ShapeKind::sphere) || shapes_.shape(pair.b).is(ShapeKind::sphere);
    }
    // True where the bodies would move apart without the force. The gap of a ball at an edge grows with the square of
    // the time: its acceleration is speed^2 / (2 gap). This must exceed the acceleration by the loads. Of two boxes,
    // the gap must exceed the tolerance.
    template <class Kicks>
    [[nodiscard, gnu::noinline, gnu::cold]] bool leaves(const Pair& pair, const Kicks& loads) const {
        if (!is_round(pair)) return pair.gap > shapes_.tolerance();
        const Work speed = speed_of_leaving(pair);
        if (!(speed > Work(0))) return false;
        WorkVec3<N> back;
        for (int i = 0; i < 3; ++i) {
            back[i] = -N::metres(loads[pair.a].linear[i], bodies_.scale);
            if (pair.moves_b()) back[i] += N::metres(loads[pair.b].linear[i], bodies_.scale);
        }
        const Work gap = shapes_.scale().metres(pair.gap), pull = dot(back, work_unit<N>(pair.normal));
        return speed * speed > (gap + gap) * pull;
    }
    // m a step, along the normal, where one of the bodies is a sphere.
    [[nodiscard, gnu::noinline, gnu::cold]] Work speed_of_leaving(const Pair& pair) const {
        WorkVec3<N> velocity;
        for (int i = 0; i < 3; ++i) velocity[i] = bodies_.drift(pair.a, i) - bodies_.drift(pair.b, i);
        WorkVec3<N> reach = bodies_.position(pair.a);
        reach -= bodies_.position(pair.b);
        const bool is_a = shapes_.shape(pair.a).is(ShapeKind::sphere);
        const int other = is_a ? pair.b : pair.a;
        velocity -= cross<Work>(
            shapes_.to_world(other, {bodies_.turn(other, 0), bodies_.turn(other, 1), bodies_.turn(other, 2)}), reach);
        return dot(velocity, work_unit<N>(pair.normal));
    }
    // True where another pair in touch supports a body in the direction of this one: the next block of a floor.
    [[nodiscard, gnu::noinline, gnu::cold]] bool is_held_alike(const Pair& pair) const {
        bool any = false;
        pairs_.for_each(island_, [&](const Pair& other) {
            if (any || &other == &pair || other.gap > shapes_.tolerance()) return;
            const auto is_of = [&](int b) { return b == other.a || (other.moves_b() && b == other.b); };
            const auto along = [&](int b) {
                const auto cosine = narrow<typename Pair::Unit>(dot(pair.start_normal, other.normal));
                const bool same = (b == pair.a) == (b == other.a);
                return Pair::C::half(Pair::C::one()) < (same ? cosine : -cosine);
            };
            any = (is_of(pair.a) && along(pair.a)) || (pair.moves_b() && is_of(pair.b) && along(pair.b));
        });
        return any;
    }
    [[nodiscard]] Seams seams() const { return {shapes_, pairs_, bodies_}; }
    [[nodiscard]] bool is_too_deep(bool far) const {
        bool deep = false;
        pairs_.for_each(island_, [&](const Pair& pair) {
            const bool may_sink = far || pair.start_gap < Length{} || pair.touched;
            deep = deep || pair.gap < (may_sink ? lowest(pair) : Length{});
        });
        return deep;
    }
    // The gap of a pair that touched at the start of the flight, at most zero.
    [[nodiscard]] static Length start_of(const Pair& pair) {
        return pair.start_gap < Length{} ? pair.start_gap : Length{};
    }
    // The least gap at the end of a flight: that of its start, or the tolerance below the surface where that is lower.
    // What rattles or rolls on a plane changes the point on which it stands, so it would sink from flight to flight.
    // Two bodies may sink by the tolerance below start_of() in each: forces that bounded sweeps have not found stop
    // them later.
    [[nodiscard]] Length lowest(const Pair& pair) const {
        const Length tolerance = shapes_.tolerance(), start = start_of(pair);
        if (pair.moves_b()) return start - tolerance;
        return start < -tolerance ? start : -tolerance;
    }
    // Where the search for an impact ends: at the surface, or halfway from the start to the least gap.
    [[nodiscard]] Length level(const Pair& pair) const {
        if (!(pair.start_gap < Length{}) && !pair.touched) return Length{};
        const Length start = start_of(pair);
        return start - C::half(start - lowest(pair));
    }

    NarrowPhase& shapes_;
    PairList& pairs_;
    const Bodies& bodies_;
    const Island& island_;
    [[no_unique_address]] If<has_edges, bool, 0> ends_contact_{};  // the search is for the end of a contact
};

}  // namespace tumble

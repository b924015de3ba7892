// The search for an impact: how deep the pairs of an island are at the end of a flight, and which may have passed
// through each other.
#pragma once

#include <tumble/contact/narrow_phase.hpp>
#include <tumble/contact/pair_list.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class ImpactSearch {
public:
    using NarrowPhase = tumble::NarrowPhase<N, spin, features>;
    using Bodies = typename NarrowPhase::Bodies;
    using Bounds = typename NarrowPhase::Bounds;
    using Length = typename NarrowPhase::Length;
    using Pair = typename NarrowPhase::Pair;
    using Work = typename N::Work;
    using PairList = tumble::PairList<N, features>;
    using Island = tumble::Island<features.bodies>;

    ImpactSearch(NarrowPhase& shapes, PairList& pairs, const Bodies& bodies, const Island& island)
        : shapes_{shapes}, pairs_{pairs}, bodies_{bodies}, island_{island} {}

    // m.
    [[nodiscard]] Work tolerance() const { return shapes_.scale().metres(shapes_.tolerance()); }
    // Keeps the gaps and normals of the start of a flight.
    void start_flight() {
        pairs_.for_each(island_, [](Pair& pair) {
            pair.passed = false;
            if (pair.count == 0) pair.touched = false;
            pair.start_gap = pair.gap;
            if constexpr (features.pairs) pair.start_normal = pair.normal;
        });
    }
    // Measures the bodies and pairs of the island where they are now.
    void measure() {
        for (int k = 0; k < island_.group.count; ++k) shapes_.place(bodies_, island_.group.id[k]);
        pairs_.for_each(island_, [&](Pair& pair) {
            if constexpr (features.kinematic)
                if (pair.surface_moves) shapes_.place(bodies_, pair.b);
            shapes_.measure(bodies_, pair);
        });
    }
    // Finds the contact points of the pairs, which have been measured.
    void find() {
        pairs_.for_each(island_, [&](Pair& pair) { shapes_.find(bodies_, pair); });
    }
    // The least gap of the pairs that are selected, each above the level at which a flight ends: the surface, or
    // halfway to the tolerance below for a pair that touched when the flight began. Metres.
    [[nodiscard]] Work least_gap(bool at_start) const {
        bool any = false;
        Length least{};
        pairs_.for_each(island_, [&](const Pair& pair) {
            if (!pair.selected) return;
            const Length gap = (at_start ? pair.start_gap : pair.gap) - level(pair);
            if (!any || gap < least) least = gap;
            any = true;
        });
        return shapes_.scale().metres(least);
    }
    // Selects the pairs below their level for the search. Pairs that rest beside them would mislead it.
    void select() {
        pairs_.for_each(island_, [&](Pair& pair) { pair.selected = pair.gap < level(pair); });
    }
    // True when a pair is deeper than the end of a flight allows: by the tolerance where it touched at the start (from
    // its gap there if that was negative), else below the surface.
    [[nodiscard]] bool is_too_deep() const { return is_too_deep(false); }
    // The same with the tolerance for all pairs.
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
    [[nodiscard]] Crossing find_crossing() {
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
        shapes_.measure(bodies_, pair, Length{});
        if (pair.gap > close) return false;
        shapes_.measure(bodies_, pair);
        return true;
    }
    // The bodies touch in a point, so that an impact can stop them. Boxes may have none though they are close along
    // every axis, as corners that pass each other.
    [[nodiscard]] bool has_points(const Crossing& crossing) {
        shapes_.find(bodies_, *crossing.pair);
        return crossing.pair->count > 0;
    }

private:
    [[nodiscard]] bool is_too_deep(bool far) const {
        bool deep = false;
        pairs_.for_each(island_, [&](const Pair& pair) {
            Length limit{};
            if (pair.start_gap < Length{}) limit = pair.start_gap - shapes_.tolerance();
            else if (far || pair.touched) limit = -shapes_.tolerance();
            deep = deep || pair.gap < limit;
        });
        return deep;
    }
    // Where the search for an impact ends.
    [[nodiscard]] Length level(const Pair& pair) const {
        const Length half = Bounds::search_depth(shapes_.tolerance());
        if (pair.start_gap < Length{}) return pair.start_gap - half;
        return pair.touched ? -half : Length{};
    }

    NarrowPhase& shapes_;
    PairList& pairs_;
    const Bodies& bodies_;
    const Island& island_;
};

}  // namespace tumble

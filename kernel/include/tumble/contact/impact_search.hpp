// The search for an impact: how deep the pairs of an island are at the end of a flight, and which may have passed
// through each other.
#pragma once

#include <tumble/contact/broad_phase.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class ImpactSearch : public BroadPhase<N, spin, features> {
    using Base = BroadPhase<N, spin, features>;

public:
    using typename Base::Bodies;
    using typename Base::Bounds;
    using typename Base::Length;
    using typename Base::Pair;
    using typename Base::Work;
    using BodyGroup = tumble::BodyGroup<features.bodies>;

    using Base::Base;

    // One island's part of a step.
    struct Island {
        const BodyGroup& group;
        int root;        // its first body
        int first_pair;  // -1: none is near
    };

    // Measures the bodies and pairs of the island where they are now.
    void measure(const Bodies& bodies, const Island& island) {
        for (int k = 0; k < island.group.count; ++k) place(bodies, island.group.id[k]);
        for_each_pair(island, [&](Pair& pair) { measure(bodies, pair); });
    }
    // Finds the contact points of the pairs, which have been measured.
    void find(const Bodies& bodies, const Island& island) {
        for_each_pair(island, [&](Pair& pair) { find(bodies, pair); });
    }
    // The least gap of the pairs that are sought, each above the level at which a flight ends: the surface, or halfway
    // to the tolerance below for a pair that touched when the flight began. Metres.
    [[nodiscard]] Work least_gap(const Island& island, bool at_start) const {
        bool any = false;
        Length least{};
        for_each_pair(island, [&](const Pair& pair) {
            if (!pair.sought) return;
            const Length gap = (at_start ? pair.start_gap : pair.gap) - level(pair);
            if (!any || gap < least) least = gap;
            any = true;
        });
        return scale().metres(least);
    }
    // Selects the pairs below their level for the search. Pairs that rest beside them would mislead it.
    void seek(const Island& island) {
        for_each_pair(island, [&](Pair& pair) { pair.sought = pair.gap < level(pair); });
    }
    // True when a pair is deeper than the end of a flight allows: by the tolerance where it touched at the start (from
    // its gap there if that was negative), else below the surface.
    [[nodiscard]] bool is_too_deep(const Island& island) const { return is_too_deep(island, false); }
    // The same with the tolerance for all pairs.
    [[nodiscard]] bool is_far_too_deep(const Island& island) const { return is_too_deep(island, true); }

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
    [[nodiscard]] Crossing find_crossing([[maybe_unused]] const Bodies& bodies, [[maybe_unused]] const Island& island) {
        Crossing found;
        if constexpr (features.pairs) {
            for_each_pair(island, [&](Pair& pair) {
                if (found.pair != nullptr || pair.with_plane() || pair.touched || pair.passed || pair.gap < Length{})
                    return;
                const PairView<N> view = view_of(bodies, pair);
                if (!(view.separation(pair.start_normal, features.boxes) < -tolerance_)) return;
                found = {&pair, view.reach, axes_[pair.a], axes_[pair.b]};
            });
        }
        return found;
    }
    // The part of the rest of the flight in which the pair surely stays apart: until the separation along its present
    // direction runs out. Negative: the whole rest.
    [[nodiscard]] Work part_apart(const Crossing& crossing) const {
        const Pair& pair = *crossing.pair;
        const PairView<N> end{shape_[pair.a], shape_[pair.b], crossing.a, crossing.b, crossing.reach};
        const Length left = end.separation(pair.normal, features.boxes);
        if (!(left < -tolerance_)) return Work(-1);
        if (!(pair.gap > Length{})) return Work(0);
        const Work gap = scale().metres(pair.gap);
        return gap / (gap - scale().metres(left));
    }
    // The bodies are as close as conservative advancement brings them.
    [[nodiscard]] bool is_close(const Crossing& crossing) const {
        return !(crossing.pair->gap > Bounds::crossing_gap(tolerance_));
    }

protected:
    using Base::axes_;
    using Base::find;
    using Base::measure;
    using Base::pair_;
    using Base::place;
    using Base::scale;
    using Base::shape_;
    using Base::tolerance_;
    using Base::view_of;

    template <class F>
    void for_each_pair(const Island& island, F&& f) {
        for (int i = island.first_pair; i >= 0; i = pair_[i].next) f(pair_[i]);
    }
    template <class F>
    void for_each_pair(const Island& island, F&& f) const {
        for (int i = island.first_pair; i >= 0; i = pair_[i].next) f(pair_[i]);
    }

private:
    [[nodiscard]] bool is_too_deep(const Island& island, bool far) const {
        bool deep = false;
        for_each_pair(island, [&](const Pair& pair) {
            Length limit{};
            if (pair.start_gap < Length{}) limit = pair.start_gap - tolerance_;
            else if (far || pair.touched) limit = -tolerance_;
            deep = deep || pair.gap < limit;
        });
        return deep;
    }
    // Where the search for an impact ends.
    [[nodiscard]] Length level(const Pair& pair) const {
        const Length half = Bounds::search_depth(tolerance_);
        if (pair.start_gap < Length{}) return pair.start_gap - half;
        return pair.touched ? -half : Length{};
    }
};

}  // namespace tumble

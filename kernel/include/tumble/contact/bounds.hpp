// The bounds and thresholds of this room: value, unit and reason. A part of a tolerance, a speed or a step is a power
// of two, so that it is exact in every number system. Not here: what is only rounding (numbers/), when a shape lies
// flat or rolls (shapes/), what of a change sweeps repeat (solver/sweep.hpp), and which normals of two contacts count
// as alike (a cosine above 1/2: seams.hpp, impact_search.hpp).
#pragma once

#include <tumble/numbers/systems.hpp>

namespace tumble {

// Bounds of loops. They bound the time of a step. contact::max_points, of a pair, is in shapes/manifold.hpp.
namespace contact {
// Impacts of an island's step that are resolved at their own time. A ball that comes to rest bounces without end in
// finite time.
inline constexpr int max_impacts = 8;
// Pairs of an island's flight that are examined because they may have passed through each other.
inline constexpr int max_crossings = 4;
// Flights redone to find one impact, or for one such pair.
inline constexpr int max_resteps = 12;
// Pairs on which a body may stand by statics. The sums over their points, 16 at the most, fit the formats.
inline constexpr int max_supports = 4;
// Sweeps over the points of an island, for the forces of a step. They carry the load of a stack from box to box.
inline constexpr int max_sweeps = 32;
// Visits of points by the sweeps of a bounded step. A stack of ten boxes gets 20 sweeps.
inline constexpr int bounded_visits = 800;
// The fewest of these sweeps.
inline constexpr int least_bounded_sweeps = 16;
// Sweeps of a bounded step in which only faces touch.
inline constexpr int face_sweeps = 24;
// Halvings of a bounded step in which bodies would come deep into each other.
inline constexpr int most_halvings = 2;
// Sweeps of a bounded step that correct overlaps.
inline constexpr int bounded_corrections = 4;
// Sweeps over the points of an impact, and for a motion that corrects penetrations: neither has a warm start.
inline constexpr int max_impact_sweeps = 80;
// Rounds of impacts that pass from pair to pair at one moment, besides one for each pair.
inline constexpr int max_rounds = 32;
// Most steps between two examinations of a pair that is far apart.
inline constexpr int most_clear_steps = 128;
// The same of a near pair, or of a body near something, which may be pushed.
inline constexpr int most_clear_steps_near = 8;
}  // namespace contact

// What an island may do in a step where its scene sets bounds. 0: the usual ones.
struct ImpactBounds {
    int impacts = 0;
    int searches = 0;  // flights that are redone
    int sweeps = 0;    // of all solutions; each has one at least

    [[nodiscard]] bool are_set() const { return impacts > 0 || searches > 0 || sweeps > 0; }
};

// Thresholds, from the quantity that each is a part of. C: ContactNumbers<N>.
template <class N>
struct ContactBounds {
    using C = ContactNumbers<N>;
    using Length = typename C::Length;
    using Speed = typename C::Speed;
    using Work = typename N::Work;

    // The most sweeps, from that of contact. In double sweeps stop at 2^-40 of the speeds and not at 2^-20, so there
    // are four times as many: then a box that tumbles and a pyramid whose top slides move like their turned and
    // mirrored images to 4e-12 m in a second, and to 2e-5 m without.
    [[nodiscard]] static constexpr int sweeps(int most) { return std::is_same_v<Work, double> ? 4 * most : most; }

    // --- lengths, from the tolerance ---

    // A point of a resting body that is not farther above the surface carries: float resolves positions up to 30 m so.
    [[nodiscard]] static Length resting_gap(Length tolerance) { return C::sixteenth(C::sixteenth(tolerance)); }
    // An impact leaves out pairs with a larger gap. The search for the impact ends much closer to the surface.
    [[nodiscard]] static Length largest_impact_gap(Length tolerance) { return C::half(C::half(tolerance)); }
    // Penetration that is not corrected: the points of a resting body stay in touch.
    [[nodiscard]] static Length resting_depth(Length tolerance) { return C::half(C::half(tolerance)); }
    // Position correction of a step: an eighth of the excess penetration, at most an eighth of the tolerance. It begins
    // where the excess is resting_gap().
    [[nodiscard]] static bool is_lifted(Length gap, Length tolerance) {
        return gap + resting_depth(tolerance) < -resting_gap(tolerance);
    }
    [[nodiscard]] static Length lift(Length gap, Length tolerance) {
        if (!is_lifted(gap, tolerance)) return Length{};
        const Length lift = C::eighth(-gap - resting_depth(tolerance)), most = most_lift(tolerance);
        return lift > most ? most : lift;
    }
    [[nodiscard]] static Length most_lift(Length tolerance) { return C::eighth(tolerance); }
    // In a bounded step: a quarter of the excess of overlaps deeper than half of the tolerance, at most 16 tolerances.
    [[nodiscard]] static bool is_overlap(Length gap, Length tolerance) { return gap + C::half(tolerance) < Length{}; }
    [[nodiscard]] static Length correction(Length gap, Length tolerance) {
        if (!is_overlap(gap, tolerance)) return Length{};
        const Length quarter = C::half(C::half(-gap - resting_depth(tolerance))), most = most_correction(tolerance);
        return quarter > most ? most : quarter;
    }
    [[nodiscard]] static Length most_correction(Length tolerance) {
        const Length twice = tolerance + tolerance, four = twice + twice, eight = four + four;
        return eight + eight;
    }
    // A face axis of two boxes is preferred to an edge axis up to this difference, so that rounding does not decide.
    [[nodiscard]] static Length axis_margin(Length tolerance) { return C::half(C::half(tolerance)); }
    // Cosine between a contact's normal and an axis of a box. Above it the normal is that of the face: 16 times what
    // float resolves near 1.
    [[nodiscard]] static typename C::Unit along_face() {
        return C::unit(Work(1) - N::template constant<Work>(Real::scaled(1, -20)));
    }
    // A body at an edge of a box that is deeper than this is beside the face, not above it. Searches leave
    // bodies less deep.
    [[nodiscard]] static Length edge_depth(Length tolerance) {
        const Length twice = tolerance + tolerance;
        return twice + twice;
    }
    // Conservative advancement ends at this gap.
    [[nodiscard]] static Length crossing_gap(Length tolerance) { return C::sixteenth(C::sixteenth(tolerance)); }
    // A contact point inherits the impulses of a point within this distance, from the radius of its body.
    [[nodiscard]] static Length same_point(Length radius) { return C::sixteenth(radius); }

    // Edges with a larger slope against each other, as a sine, cross. Along others the crossing runs more than
    // sqrt(8) times as far as the bodies move.
    [[nodiscard]] static bool cross(Work slope) { return slope * slope > N::half_of(N::half_of(N::half_of(Work(1)))); }
    // The normal of a ball at an edge is followed where it turns by at most half a radian in half a flight. From the
    // square of the turn.
    [[nodiscard]] static bool is_followed(Work square) { return !(square > N::half_of(N::half_of(Work(1)))); }
    // The radius of a body over each radius of gyration, below 64, fits the formats of rows. That of a rod that is
    // thinner does not.
    [[nodiscard]] static bool has_levers(const StoredVec3<Length>& gyration, Length radius) {
        bool all = true;
        for (int i = 0; i < 3; ++i) all = all && gyration[i] > C::eighth(C::eighth(radius));
        return all;
    }

    // --- lengths, m, from the tolerance ---

    // The search for an impact ends within this gap of its level.
    [[nodiscard]] static Work search_gap(Work tolerance) {
        return tolerance * N::template constant<Work>(Real::scaled(1, -16));
    }

    // --- times, as a part of a step ---

    // The shortest flight.
    [[nodiscard]] static constexpr Work min_portion() { return N::template constant<Work>(Real::scaled(1, -20)); }

    // --- speeds ---

    // A point that approaches more slowly rests, in multiples of gravity's change of speed in a step: the contact holds
    // it by the step's end, and the last step has added one such change.
    static constexpr int slow_in_falls = 2;
    // Gravity's change of speed in a step, from the speed above.
    [[nodiscard]] static Speed fall(Speed slow) { return C::half(slow); }
    // After an impact, points approach at exactly the closing speed. This margin keeps rounding from deciding which of
    // them are held.
    [[nodiscard]] static Speed late(Speed closing) { return C::eighth(C::eighth(closing)); }
    // Statics are tried where nothing moves at the start of a step by more than this part of what loads change in it.
    // What slides or falls is faster after a few steps, and then costs nothing here.
    [[nodiscard]] static Speed slow(Speed loads) { return C::eighth(loads); }
    // The same in a bounded step: what has been set down from a low height comes to rest as a whole, where the points
    // of its pairs can carry that. Sweeps in bounded number would leave a stack leaning.
    [[nodiscard]] static Speed slow_when_bounded(Speed loads) {
        const Speed twice = loads + loads;
        return twice + twice;
    }
    // A pair carries by statics only where more than this part of what loads change in a step is against it. Boxes side
    // by side carry nothing.
    [[nodiscard]] static Speed across(Speed loads) { return C::eighth(loads); }
    // A moving surface takes a point along that comes within this of its target, from the largest change of a surface.
    [[nodiscard]] static Speed held_along(Speed change) { return C::eighth(change); }
    // What a dozen roundings may make of a speed, from the rounding of one.
    [[nodiscard]] static Speed slack(Speed rounding) { return rounding + rounding + rounding + rounding; }
    // What several supports may leave of the motion that they stop: 2^-18, about what sweeps in q32 leave.
    [[nodiscard]] static Speed left_by_supports(Speed motion) {
        for (int i = 0; i < 6; ++i) motion = C::eighth(motion);
        return motion;
    }
    // A bounce that is left out is told from this part of the fastest approach of its step on, as weighted speeds. A
    // collapse in which each impact leaves less than half of the approach is slower after max_impacts.
    [[nodiscard]] static Work left_by_collapse(Work fastest) {
        return fastest * N::template constant<Work>(Real::scaled(1, -contact::max_impacts));
    }
    // What bounded sweeps may leave of the fastest approach of a step: up to 2^-10.4 in a stack of twelve boxes that
    // stands (measured).
    [[nodiscard]] static Speed left_by_sweeps(Speed fastest) {
        return C::half(C::eighth(C::eighth(C::eighth(fastest))));
    }
    // A change of motion is no acceleration below this part of what contacts change. On ice a box rests where the tilt
    // is below 2^-10, which is 0.06 degrees.
    [[nodiscard]] static Speed balance(Speed by_contacts) { return left_by_sweeps(by_contacts); }
};

}  // namespace tumble

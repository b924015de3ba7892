// A pair that may touch: a body and a plane, or two bodies. It keeps the impulses of its points from step to step, for
// the warm start.
#pragma once

#include <tumble/contact/bounds.hpp>
#include <tumble/shapes/boxes.hpp>
#include <tumble/solver/modes.hpp>

namespace tumble {

// The smallest unsigned type that counts to `most`.
template <int most>
using CountTo =
    std::conditional_t<(most > 0xffff), std::uint32_t, std::conditional_t<(most > 0xff), std::uint16_t, std::uint8_t>>;

template <class N, Features features>
struct ContactPoint {
    using C = ContactNumbers<N>;
    using Length = typename C::Length;
    using Speed = typename C::Speed;
    static constexpr int directions = features.friction ? 3 : 1;

    Vec3<Length> arm;  // from the centre of mass of body a, its principal axes
    [[no_unique_address]] If<features.pairs, Vec3<Length>, 0> arm_b;
    Length gap;
    bool active;                  // part of the present solution
    bool rows_are_valid = false;  // for where the bodies are
    bool waits = false;           // in sweep_pressed()
    union {
        Speed change_by_loads;  // in an impact: of the velocity along the normal, in a step
        Speed resting_impulse;  // while penetrations are corrected: along the normal, without that
    };
    [[no_unique_address]] If<features.kinematic, Speed, 3> surface{};  // of the other side, along the normal
    Row<N, features.pairs> row[directions];  // the normal, of which the target is the least velocity; the tangents
    [[no_unique_address]] If<features.friction, Couplings<N>, 4> couplings;  // for the sweeps
    // Of the relative spin: about the tangents and the normal.
    [[no_unique_address]] If<features.rolling_resistance, Row<N, features.pairs>[3], 1> spin;

    // True of a point that does not touch: its pair has it because it may come down in a step. Of a rim, and in a
    // bounded step.
    [[nodiscard]] bool is_apart([[maybe_unused]] Length tolerance) const {
        if constexpr (features.round_shapes || features.bounded_steps) return gap > tolerance;
        else return false;
    }
    template <class F>
    void for_each_row(F&& f) {
        for (auto& r : row) f(r);
        if constexpr (features.rolling_resistance)
            for (auto& r : spin) f(r);
    }
};

// The points of a pair that carry a load by statics, from the lowest bit on, and whether one of its points must move.
struct Carriers {
    static constexpr std::uint8_t motion = 0x80;
    std::uint8_t bits = 0;

    void add(int point) { bits = static_cast<std::uint8_t>(bits | 1u << point); }
    void add_motion() { bits |= motion; }
    [[nodiscard]] bool none() const { return bits == 0; }
    [[nodiscard]] bool has(int point) const { return (bits >> point & 1) != 0; }
    [[nodiscard]] bool has_several() const { return (bits & ~motion & (bits - 1)) != 0; }
    [[nodiscard]] bool must_move() const { return (bits & motion) != 0; }
    [[nodiscard]] bool operator==(const Carriers&) const = default;
};

template <class N, Features features>
struct Pair {
    using C = ContactNumbers<N>;
    using Length = typename C::Length;
    using Unit = typename C::Unit;
    using Point = ContactPoint<N, features>;
    // Spheres touch in a point.
    static constexpr int max_points = features.boxes || features.round_shapes ? contact::max_points : 1;

    std::int16_t a = 0, b = 0;  // a moves; b < 0: plane -1 - b
    std::int16_t next = -1;     // slot of the next pair of its island
    std::uint8_t count = 0;     // points within the tolerance, and of a rim those that may come down in a step
    Carriers carriers;          // that statics have used
    bool moved = true;          // a body has turned or the normal has changed: the rows are invalid
    bool touched = false;       // where the flight begins: by forces, after an impact, or since over a seam
    bool left_out = false;      // it came near in this step, between two islands
    bool passed = false;        // its bodies went past each other in this flight
    bool selected = false;      // the search for an impact considers it
    bool has_friction = false;
    bool surface_moves = false;  // body b is fixed and turns, or it is kinematic and moves
    bool start_covered = false;  // BoxAxis::covered where the flight began
    bool at_edge = true;         // another side of a box is as near, or nobody has asked
    // With a grid: the lower half of the step in which it is examined again, and how often the bounds of its bodies had
    // been ended when it was examined last.
    [[no_unique_address]] If<features.grid(), std::uint16_t, 5> due{};
    [[no_unique_address]] If<features.grid(), std::uint16_t, 6> ends{};
    Length gap{};                   // least distance; of boxes apart a lower bound
    Length start_gap{};             // where the flight began
    StoredVec3<Unit> normal{};      // world, from b to a
    StoredVec3<Unit> tangent[2]{};  // world
    [[no_unique_address]] If<features.pairs && features.boxes, BoxAxis, 1> axis{};
    [[no_unique_address]] If<features.pairs, Vec3<Unit>, 0> start_normal{};  // where the flight began
    Unit share_a{}, share_b{};  // roots of the parts of the motion that each takes: shares of the inverse mass
    typename N::Work weight{};  // root of the reduced mass
    Unit restitution{};
    typename C::Friction friction{};
    // Moments against rolling and spinning, over the spin arm and the normal force. Zero: it rolls freely.
    [[no_unique_address]] If<features.rolling_resistance, typename C::Friction, 2> rolling{};
    [[no_unique_address]] If<features.rolling_resistance, typename C::Friction, 3> spinning{};
    [[no_unique_address]] If<features.rolling_resistance, Length, 4> spin_arm{};  // by which a spin counts as a speed
    typename C::SpeedScale scale{};                                               // of the points' impulses
    Point point[max_points];
    // While a bounded step solves an island of faces.
    static constexpr bool has_faces = features.bounded_steps && max_points > 2;
    struct Face {
        bool whole = false;         // the normals are solved at once
        bool has_tangents = false;  // and the tangents
        Modes<N, features.pairs, max_points> normals;
        [[no_unique_address]] If<features.friction, Modes<N, features.pairs, 2 * max_points>, 0> tangents;
    };
    [[no_unique_address]] If<has_faces, Face, 7> face{};

    // Writes or reads what a snapshot holds. The rest follows from the bodies and from the points, or a step computes
    // it anew.
    template <class Self, class Archive>
    static void archive(Self& self, Archive& to, bool with_plane) {
        std::uint32_t bits = 0;
        if constexpr (!Archive::reads) bits = self.bits();
        bits = to.bits(bits);
        const int points = static_cast<int>(bits & 7u), count = points < max_points ? points : max_points;
        to.require(points == count && !(with_plane && (bits & of_bodies) != 0));
        if constexpr (Archive::reads) self.set(bits);
        to(self.gap);
        if (count > 0) to(self.scale);
        if constexpr (features.pairs) {
            if (!with_plane) to(self.normal);
            if (!with_plane && count > 0) to(self.tangent);
        }
        if constexpr (features.pairs && features.boxes) BoxAxis::archive(self.axis, to);
        if constexpr (features.grid()) to(self.due, self.ends);
        for (int i = 0; i < count; ++i) {
            auto& point = self.point[i];
            to(point.arm, point.gap);
            for (auto& row : point.row) to(row.impulse);
            if constexpr (features.rolling_resistance)
                for (auto& row : point.spin) to(row.impulse);
            if constexpr (features.pairs) {
                if (!with_plane) to(point.arm_b);
                else if constexpr (Archive::reads) point.arm_b = Vec3<Length>::Constant(Length{});
            }
        }
    }

    // Another pair in this place.
    void begin(int first, int second) {
        a = static_cast<std::int16_t>(first);
        b = static_cast<std::int16_t>(second);
        count = 0;
        carriers = {};
        moved = true;
        touched = left_out = passed = selected = has_friction = surface_moves = start_covered = false;
        at_edge = true;
        share_b = {};
        if constexpr (features.pairs && features.boxes) axis = {};
        if constexpr (features.grid()) due = ends = 0;
    }
    // In an impact: whether the pair takes part. Such a pair touches where the next flight begins.
    [[nodiscard]] bool is_struck() const { return touched; }
    void set_struck(bool struck) { touched = struck; }
    // Of a point: the normal, and two tangents where there is friction.
    [[nodiscard]] int rows() const {
        if constexpr (features.friction) return has_friction ? 3 : 1;
        else return 1;
    }
    // Whether f(gap) is true of a point. The pair itself may be deeper: by a vertex that is beside the other's face.
    template <class F>
    [[nodiscard]] bool any_gap(F&& f) const {
        bool any = false;
        for (int i = 0; i < count; ++i) any = any || f(point[i].gap);
        return any;
    }
    // A step makes no row anew while the bodies stay where they are. It makes those of a surface that moves.
    [[nodiscard]] bool rows_are_valid() const {
        bool valid = count > 0 && !surface_moves;
        for (int i = 0; i < count; ++i) valid = valid && point[i].rows_are_valid;
        return valid;
    }
    // Rolling and spinning meet a resistance.
    [[nodiscard]] bool resists_spin() const {
        if constexpr (features.rolling_resistance)
            return rolling > typename C::Friction{} || spinning > typename C::Friction{};
        else return false;
    }
    // Body b moves too: it is neither a plane nor a fixed body.
    [[nodiscard]] bool moves_b() const { return features.pairs && b >= 0 && !(share_b == Unit{}); }
    [[nodiscard]] bool with_plane() const { return b < 0; }
    [[nodiscard]] int plane() const { return -1 - b; }
    // Pairs are sorted by it.
    [[nodiscard]] std::uint32_t key() const { return key_of(a, b); }
    [[nodiscard]] static std::uint32_t key_of(int a, int b) {
        return static_cast<std::uint32_t>(a) << 16 |
               (b < 0 ? static_cast<std::uint32_t>(-1 - b) : 0x8000u | static_cast<std::uint32_t>(b));
    }

private:
    // Of bits(): left_out and surface_moves, which no pair with a plane is.
    static constexpr std::uint32_t of_bodies = 1u << 5 | 1u << 6;
    // The small members of a snapshot, and back: count, what is true of the pair, whether all rows are valid, the
    // carriers.
    [[nodiscard]] std::uint32_t bits() const {
        std::uint32_t bits = count | static_cast<std::uint32_t>(carriers.bits) << 8;
        return bits | static_cast<std::uint32_t>(moved << 3 | touched << 4 | left_out << 5 | surface_moves << 6 |
                                                 rows_are_valid() << 7);
    }
    void set(std::uint32_t bits) {
        const auto has = [&](int bit) { return (bits >> bit & 1) != 0; };
        count = static_cast<std::uint8_t>(bits & 7u);
        carriers.bits = static_cast<std::uint8_t>(bits >> 8);
        moved = has(3);
        touched = has(4);
        left_out = has(5);
        surface_moves = has(6);
        for (int i = 0; i < count; ++i) point[i].rows_are_valid = has(7);
    }
};

}  // namespace tumble

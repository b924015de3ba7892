// Sweeps over rows until no impulse changes any more (sequential impulses, Catto 2005, with momentum).
#pragma once

#include <tumble/solver/cone.hpp>

namespace tumble {

// What has rows: it calls f(block) for each of its blocks of rows, always in the same order.
template <class Source>
concept RowSource = requires(Source& for_each_block) {
    for_each_block([](const auto&) {});
};

template <class N, bool two_bodies, bool friction, bool resists_spin = false>
struct Sweep {
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;
    using Speed = typename C::Speed;
    using Row = tumble::Row<N, two_bodies>;
    using Velocity = WeightedVelocity<N>;
    using Cone = FrictionCone<N, two_bodies>;
    using Couplings = tumble::Couplings<N>;
    static constexpr int most_rows = friction ? 3 : 1;

    // Rows of the relative spin, about two tangents and about the normal, with the resistance to it.
    struct Resistance {
        Row* row = nullptr;
        typename C::Friction rolling{}, spinning{};
    };
    using Motion = SweepMotion<N>;
    // Rows that are solved at one visit: a normal, which only pushes, and two tangents where there is friction.
    struct Block {
        Row (&row)[most_rows];
        int rows;
        const Couplings* couplings = nullptr;  // of three rows
        typename C::Friction coefficient{};
        Velocity& a;
        Velocity* b = nullptr;  // null where only a moves
        [[no_unique_address]] If<resists_spin, Resistance, 0> resistance{};

        // Calls f(first row, its number of rows as a constant) for the rows that have a place together.
        template <class F>
        void for_each_group(F&& f) const {
            if constexpr (friction) {
                if (rows > 1) f(row, std::integral_constant<int, most_rows>{});
                else f(row, std::integral_constant<int, 1>{});
            } else {
                f(row, std::integral_constant<int, 1>{});
            }
            if constexpr (resists_spin)
                if (resistance.row != nullptr) f(resistance.row, std::integral_constant<int, 3>{});
        }
    };
    // Raises `most` to the largest change of an impulse.
    static void visit(const Block& block, Speed& most) { visit(block, push_of(block.row[0], block, most), most); }
    // A face: the normals of its points are solved at once where all of them then push, or none. So is their friction
    // where it then is in the cones of all. Else the points are visited one after the other. A face has Modes of its
    // normals and tangents, and rows_of(i) and point(i), the rows and the Block of point i.
    template <class FaceBlock>
    static void visit(const FaceBlock& face, Speed& most) requires requires {
        face.has_tangents();
    }
    {
        const bool push = push_at_once(face, most);
        const bool whole = push || let_go(face, most);
        if (push && face.has_tangents() && rub_at_once(face, most)) return;
        for (int i = 0; i < face.count; ++i) {
            const Block point = face.point(i);
            if (whole) visit(point, Speed{}, most);
            else visit(point, most);
        }
    }
    // The same where the normal is to change by `push`.
    static void visit(const Block& block, Speed push, Speed& most) {
        Row* const row = block.row;
        const Speed wanted = row[0].impulse + push;
        if (wanted == Speed{} && is_idle(block)) return;
        [[maybe_unused]] const auto limit = [&](typename C::Friction coefficient) {
            return Cone::limit_of(row[0], wanted, coefficient);
        };
        if constexpr (friction) {
            if (block.rows > 1) {
                const Couplings& couplings = *block.couplings;
                Speed excess[2], by[3] = {push, {}, {}};
                for (int k = 0; k < 2; ++k)
                    excess[k] = row[k + 1].excess(block.a, block.b) + Row::product(push, couplings.normal[k]);
                Cone::solve(row + 1, excess, couplings, limit(block.coefficient), by + 1);
                for (int k = 1; k < 3; ++k)
                    if (!C::fits(row[k].impulse + by[k])) [[unlikely]]
                        by[k] = Speed{};
                change(block, row, by, most);
            } else {
                change(block, row, {push}, most);
            }
        } else {
            change(block, row, {push}, most);
        }
        if constexpr (resists_spin) {
            const Resistance& resists = block.resistance;
            if (resists.row == nullptr) return;
            Row* const spin = resists.row;
            const Speed excess[2] = {spin[0].excess(block.a, block.b), spin[1].excess(block.a, block.b)};
            Couplings couplings;
            couplings.set_tangents(spin, block.b != nullptr);
            Speed by[2];
            Cone::solve(spin, excess, couplings, limit(resists.rolling), by);
            change(block, spin, by, most);
            const Speed about = spin[2].excess(block.a, block.b);
            change(block, spin + 2, {Cone::solve_one(spin[2], about, limit(resists.spinning))}, most);
        }
    }
    // True of a block without impulses. Where its normal wants none, it is done.
    static bool is_idle(const Block& block) {
        bool idle = true;
        block.for_each_group([&](const Row* row, auto count) {
            for (int k = 0; k < count; ++k) idle = idle && row[k].impulse == Speed{};
        });
        return idle;
    }
    // Applies the impulses of a block to velocities that do not hold them yet.
    static void push(const Block& block) {
        block.for_each_group([&](const Row* row, auto count) {
            Speed by[count];
            for (int k = 0; k < count; ++k) by[k] = row[k].impulse;
            Row::push(row, by, block.a, block.b);
        });
    }

    // Sweeps until no impulse changes by more than `enough` or none is left. Plain sweeps carry a load through a stack
    // by one box per sweep. So each begins with a part of the whole last change, as a heavy ball goes on (Polyak 1964).
    // The part is at most 1, and the one with which the last two sweeps together would have changed the velocities
    // least (Anderson 1965, of depth one). A sweep that leaves a part r of the error has still to make r / (1 - r) of
    // its change. for_each_velocity(f) calls f(velocity, its Motion) for each of the bodies. Returns the largest change
    // of the last sweep.
    //
    // `patience`: ends also where so many sweeps, one after the other, have changed no velocity by more than
    // `rounding`. They only shift impulses among points. What is left contradicts itself: no velocity meets the targets
    // of all points of a face that is not quite flat on another.
    template <RowSource Source, class Velocities>
    static Speed run(Source&& for_each_block, const Velocities& for_each_velocity, Speed enough, Speed rounding,
                     int& left, int patience, bool with_momentum = true) {
        Speed most{};
        int idle = 0;
        if (with_momentum) for_each_velocity([](const Velocity& now, Motion& motion) { motion.before = now; });
        for (int sweep = 0; left > 0; ++sweep) {
            if (with_momentum && sweep > 0) {
                Speed moved{};
                const Unit momentum = momentum_of(for_each_velocity, sweep == 1, moved);
                idle = moved > rounding ? 0 : idle + 1;
                if (idle >= patience) break;
                go_on(for_each_block, for_each_velocity, momentum);
            }
            --left;
            most = {};
            for_each_block([&](const auto& block) { visit(block, most); });
            if (!(most > enough)) break;
        }
        return most;
    }

private:
    // The normals of a face. False, and nothing changes, where a point would pull.
    template <class FaceBlock>
    static bool push_at_once(const FaceBlock& face, Speed& most) {
        const auto& normals = face.face.normals;
        Speed by[3], wanted[FaceBlock::most_points];
        stop(normals, face, by);
        for (int i = 0; i < face.count; ++i) {
            wanted[i] = face.rows_of(i)->impulse + normals.change(i, by);
            if (wanted[i] < Speed{} || !C::fits(wanted[i])) return false;
        }
        for (int i = 0; i < face.count; ++i) face.rows_of(i)->impulse = wanted[i];
        push(normals, face, by, most);
        return true;
    }
    // The tangents. False, and nothing changes, where a point would slip.
    template <class FaceBlock>
    static bool rub_at_once(const FaceBlock& face, Speed& most) {
        if constexpr (friction) {
            const auto& tangents = face.face.tangents;
            Speed by[3], wanted[FaceBlock::most_points][2];
            stop(tangents, face, by);
            for (int i = 0; i < face.count; ++i) {
                const Row* const row = face.rows_of(i);
                for (int k = 0; k < 2; ++k) {
                    wanted[i][k] = row[1 + k].impulse + tangents.change(2 * i + k, by);
                    if (!C::fits(wanted[i][k])) return false;
                }
                if (!Cone::contains(row + 1, wanted[i], Cone::limit_of(row[0], row[0].impulse, face.pair.friction)))
                    return false;
            }
            for (int i = 0; i < face.count; ++i)
                for (int k = 0; k < 2; ++k) face.rows_of(i)[1 + k].impulse = wanted[i][k];
            push(tangents, face, by, most);
        }
        return friction;
    }
    // The impulses that give all modes their targets.
    static void stop(const auto& modes, const auto& face, Speed (&by)[3]) {
        for (int k = 0; k < 3; ++k) by[k] = -modes.mode[k].excess(face.a, face.b);
    }
    static void push(const auto& modes, const auto& face, const Speed (&by)[3], Speed& most) {
        bool any = false;
        for (const Speed each : by) {
            note(each, most);
            any = any || !(each == Speed{});
        }
        if (any) Row::push(modes.mode, by, face.a, face.b);
    }
    // Takes the normal impulses off a face, where then no point comes nearer but by rounding.
    [[gnu::noinline]] static bool let_go(const auto& face, Speed& most) {
        Velocity a = face.a, b;
        Velocity* const other = face.b == nullptr ? nullptr : &(b = *face.b);
        for (int i = 0; i < face.count; ++i) face.rows_of(i)->push(-face.rows_of(i)->impulse, a, other);
        for (int i = 0; i < face.count; ++i)
            if (face.rows_of(i)->excess(a, other) < -face.rounding) return false;
        face.a = a;
        if (other != nullptr) *face.b = b;
        for (int i = 0; i < face.count; ++i) {
            note(face.rows_of(i)->impulse, most);
            face.rows_of(i)->impulse = Speed{};
        }
        return true;
    }
    // The change of a normal's impulse in one visit. An impulse that does not fit belongs to no solution, as of a body
    // that is squeezed between two that come on: it stays as it is.
    TUMBLE_INLINE static Speed push_of(const Row& row, const Block& block, Speed& most) {
        const Speed excess = row.excess(block.a, block.b);
        const Speed wanted = row.impulse - excess;
        if (wanted < Speed{}) return -row.impulse;
        // An impact turns a speed round, which takes twice its impulse.
        if (C::fits(C::half(wanted))) [[likely]]
            return -excess;
        note(excess, most);
        return Speed{};
    }
    // The part of the whole last change that the next sweep begins with: none after the first sweep. Raises `moved` to
    // the largest change of a velocity by the last sweep.
    template <class Velocities>
    [[gnu::noinline]] static Unit momentum_of(const Velocities& for_each_velocity, bool first, Speed& moved) {
        using Square = decltype(dot(Vec3<Speed>{}, Vec3<Speed>{}));
        Square along{}, square{};
        for_each_velocity([&](const Velocity& now, Motion& motion) {
            for (Vec3<Speed> Velocity::*part : Velocity::parts) {
                Vec3<Speed>& swept = motion.swept.*part;
                const Vec3<Speed> change = now.*part - motion.before.*part;
                for (const Speed component : change) note(component, moved);
                if (first) {
                    swept = change;
                    motion.further.*part = Vec3<Speed>::Constant(Speed{});
                    continue;
                }
                // Halves: the norm of the velocities has 29 bits, so that of this difference may have 32.
                Vec3<Speed> half, less;
                for (int i = 0; i < 3; ++i) {
                    half[i] = C::half(change[i]);
                    less[i] = C::half(swept[i]) - half[i];
                }
                swept = change;
                along += dot(less, half);
                square += dot(less, less);
            }
        });
        if (!(along > Square{})) return {};
        return along < square ? C::ratio_of_squares(along, square) : C::one();
    }
    // Repeats a part of the whole last change: what the sweep began with, and what it changed. Impulses and velocities
    // take the same part, since they belong together.
    template <class Source, class Velocities>
    static void go_on(Source&& for_each_block, const Velocities& for_each_velocity, Unit momentum) {
        const bool any = !(momentum == Unit{});
        for_each_velocity([&](Velocity& now, Motion& motion) {
            for (Vec3<Speed> Velocity::*part : Velocity::parts) {
                Vec3<Speed>& further = motion.further.*part;
                further = any ? Row::products(motion.swept.*part + further, momentum) : Vec3<Speed>::Constant(Speed{});
                now.*part += further;
            }
            motion.before = now;
        });
        for_each_block([&](const auto& block) {
            block.for_each_group([&](Row* row, auto count) {
                for (int k = 0; k < count; ++k) {
                    const Speed now = row[k].impulse;
                    if (any) {
                        const Speed further = Row::product(now - row[k].before, momentum);
                        if (C::fits(further) && C::fits(now + further)) [[likely]]
                            row[k].impulse += further;
                        else row[k].push(-further, block.a, block.b);
                    }
                    row[k].before = now;
                }
            });
        });
    }
    template <int count>
    TUMBLE_INLINE static void change(const Block& block, Row* row, const Speed (&by)[count], Speed& most) {
        for (int k = 0; k < count; ++k) note(by[k], most);
        Row::change(row, by, block.a, block.b);
    }
    TUMBLE_INLINE static void note(Speed change, Speed& most) {
        const Speed size = magnitude_of(change);
        if (size > most) most = size;
    }
};

}  // namespace tumble

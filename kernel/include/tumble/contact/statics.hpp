// Islands at rest, solved by statics. Where everything rests, the velocity at the end of the step is known: it is zero.
// What each pair carries then follows from the balance of one body after another, from the bodies that carry nothing to
// the ground, whatever the masses are. If the points of every pair can carry it, this is the solution. No sweep is
// needed. A body on which nothing stands may move on one that rests: its pair is solved by itself.
#pragma once

#include <tumble/contact/contact_rows.hpp>
#include <tumble/contact/weld.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class Statics {
public:
    using Rows = ContactRows<N, spin, features>;
    using C = typename Rows::C;
    using W = WeldNumbers<N>;
    using Bounds = ContactBounds<N>;
    using Unit = typename Rows::Unit;
    using Length = typename Rows::Length;
    using Speed = typename Rows::Speed;
    using NarrowPhase = typename Rows::NarrowPhase;
    using Pair = typename Rows::Pair;
    using Point = typename Rows::Point;
    using PairList = typename Rows::PairList;
    using Island = typename Rows::Island;
    using Velocities = typename Rows::Velocities;
    using Velocity = typename Rows::Velocity;
    using Row = tumble::Row<N, features.pairs>;
    using Weld = tumble::Weld<N>;

    Statics(const NarrowPhase& shapes, PairList& pairs, Velocities& velocities, const Island& island)
        : shapes_{shapes}, pairs_{pairs}, velocities_{velocities}, island_{island} {}

    // True where the forces are found: the velocities and the impulses of the points are then set. Otherwise nothing
    // changes. The targets of the points must be set.
    //
    // Each body must stand on one pair, and no pair must be left over: the pairs are a tree whose root is the ground.
    // All bodies must come to rest, but for bodies on which nothing stands: these may move on one that rests.
    bool solve() {
        const bool slow = is_slow([](int) { return true; });
        const bool may = (slow || island_.group.count > 1) && find_carrying(), known = may && slow && is_known();
        if (known)
            for (int k = 0; k < island_.group.count; ++k) stop(island_.group.id[k]);
        const bool found = known || (may && balance(slow));
        pairs_.for_each(island_, [&](Pair& pair) {
            pair.still = found && !moves_ ? static_cast<std::int16_t>(carrying_) : std::int16_t{0};
        });
        return found;
    }

private:
    static constexpr int bodies = features.bodies;
    static constexpr unsigned must_move = 0x80;  // among the bits of Pair::carrying

    void stop(int b) { velocities_.now[b].linear = velocities_.now[b].angular = Vec3<Speed>::Constant(Speed{}); }
    // Whether none of the bodies for which counts(b) moves faster at the start than a part of what loads change.
    template <class F>
    [[nodiscard]] bool is_slow(F&& counts) const {
        Speed fastest{}, most{};
        const auto note = [](Speed s, Speed& largest) {
            const Speed size = magnitude_of(s);
            if (size > largest) largest = size;
        };
        for (int k = 0; k < island_.group.count; ++k) {
            const int b = island_.group.id[k];
            const Velocity &start = velocities_.start[b], &loaded = velocities_.loaded[b];
            const bool counted = counts(b);
            for (int i = 0; i < 3; ++i) {
                if (counted) note(start.linear[i], fastest);
                if (counted) note(start.angular[i], fastest);
                note(loaded.linear[i] - start.linear[i], most);
                note(loaded.angular[i] - start.angular[i], most);
            }
        }
        return !(fastest > Bounds::still(most));
    }
    // Finds the points that may carry: those at the surface. Points above it are open. A pair with a point that must
    // move is marked. False where there are not as many pairs with such points as bodies.
    bool find_carrying() {
        const Length touch = Bounds::resting_gap(shapes_.tolerance());
        carrying_ = 0;
        bool may = true;
        pairs_.for_each(island_, [&](Pair& pair) {
            unsigned carrying = 0;
            for (int i = 0; i < pair.count; ++i) {
                const Point& point = pair.point[i];
                if (!point.active) continue;
                if (!(point.gap > touch)) carrying |= 1u << i;
                if (point.row[0].target > Speed{}) carrying |= must_move;
            }
            if (carrying != pair.carrying) pair.still = 0;
            pair.carrying = static_cast<std::uint8_t>(carrying);
            if (carrying == 0) return;
            may = may && !pair.on_turntable;
            ++carrying_;
        });
        return may && carrying_ == island_.group.count;
    }
    // Whether the last solution was this one.
    [[nodiscard]] bool is_known() const {
        bool known = true;
        pairs_.for_each(island_,
                        [&](const Pair& pair) { known = known && (pair.carrying == 0 || pair.still == carrying_); });
        return known;
    }

    // From the leaves of the tree to the ground. Of a body with one pair left, `last` is that pair.
    [[gnu::noinline, gnu::cold]] bool balance(bool slow) {
        std::int16_t left[bodies], last[bodies];
        bool is_leaf[bodies]{};
        const auto& group = island_.group;
        for (int k = 0; k < group.count; ++k) left[group.id[k]] = last[group.id[k]] = 0;
        for_each_carrying([&](int i, const Pair& pair) {
            const auto join = [&](int b) {
                ++left[b];
                last[b] = static_cast<std::int16_t>(last[b] ^ i);
            };
            join(pair.a);
            if (pair.moves_b()) join(pair.b);
        });
        for (int k = 0; k < group.count; ++k) is_leaf[group.id[k]] = left[group.id[k]] == 1;
        if (!slow && !is_slow([&](int b) { return !is_leaf[b]; })) return false;
        int solved = 0;
        bool found = true;
        for (int k = 0; found && k < group.count; ++k) {
            int b = group.id[k];
            while (found && b >= 0 && left[b] == 1) {
                const int i = last[b];
                Pair& pair = pairs_[i];
                found = ((pair.carrying & must_move) == 0 && carry(pair, b)) || (is_leaf[b] && slide(pair, b));
                left[b] = 0;
                ++solved;
                const int other = b == pair.a ? pair.b : pair.a;
                b = -1;
                if (!pair.moves_b()) continue;
                b = other;
                --left[b];
                last[b] = static_cast<std::int16_t>(last[b] ^ i);
            }
        }
        found = found && solved == group.count && (!moves_ || open_points_hold());
        if (found) {
            set_impulses();
        } else {
            moves_ = false;
            for (int k = 0; k < group.count; ++k) velocities_.now[group.id[k]] = velocities_.loaded[group.id[k]];
        }
        return found;
    }
    // Whether no point of the other pairs, which carry nothing, comes too deep.
    [[nodiscard]] bool open_points_hold() {
        bool hold = true;
        const Speed slack = Bounds::slack(velocities_.scale.enough_in_impact());
        pairs_.for_each_active(island_, [&](Pair& pair, Point& point) {
            if (pair.carrying != 0) return;
            const Speed excess =
                point.row[0].excess(velocities_.now[pair.a], pair.moves_b() ? &velocities_.now[pair.b] : nullptr);
            hold = hold && !(excess < -slack);
        });
        return hold;
    }
    // What stands still in the world, in the axes that the body has where its rows act.
    template <class T>
    [[nodiscard]] Vec3<T> in_middle([[maybe_unused]] int b, const Vec3<T>& v) const {
        if constexpr (Velocities::shapes_turn)
            if (velocities_.turns(b)) return velocities_.turn[b].later(v);
        return v;
    }
    // Solves the pair of a body that moves on one that rests, by sweeps over its points alone, and hands on what they
    // push. `before` of the points' rows gets this as impulses of the body.
    bool slide([[maybe_unused]] Pair& pair, [[maybe_unused]] int b) {
        if constexpr (!features.pairs) {
            return false;
        } else {
            if (!pair.moves_b()) return false;
            using Solver = typename Rows::Solver;
            const bool is_a = b == pair.a;
            const Unit share = is_a ? pair.share_a : pair.share_b;
            const CollisionShape<N>& shape = shapes_.shape(b);
            Velocity &now = velocities_.now[b], &other = velocities_.now[is_a ? pair.b : pair.a];
            const int rows = Rows::rows(pair);
            typename Solver::Row row[Pair::max_points][Point::directions];
            const auto for_each_block = [&](auto&& f) {
                for (int i = 0; i < pair.count; ++i)
                    if (pair.point[i].active) f(typename Solver::Block{row[i], rows, pair.friction, now, nullptr});
            };
            const Vec3<Unit> frame[3] = {pair.normal, pair.tangent[0], pair.tangent[1]};
            for (int k = 0; k < rows; ++k) {
                Vec3<Unit> direction = frame[k];
                if (!is_a) direction = -direction;
                const Vec3<Unit> in_body = in_middle(b, shapes_.axes(b).to_body(direction));
                for (int i = 0; i < pair.count; ++i) {
                    const Point& point = pair.point[i];
                    row[i][k].set(direction, Rows::levers(shape, in_middle(b, arm_of(point, is_a)), in_body));
                    // Between the rows of two bodies and of one: their lengths, and what the body takes of the motion.
                    const auto of_pair = [&](Speed s) { return Row::product(s, point.row[k].inverse); };
                    row[i][k].target = Row::product(W::over(W::over(point.row[k].target, point.row[k].inverse), share),
                                                    row[i][k].inverse);
                    row[i][k].impulse = W::over(Row::product(of_pair(point.row[k].impulse), share), row[i][k].inverse);
                }
            }
            for_each_block([](const auto& block) { Solver::push(block); });
            Solver::sweep(for_each_block, velocities_.scale.enough_at_rest(), contact::max_sweeps);
            unsigned carrying = must_move;
            Velocity unused = now;
            for (int i = 0; i < pair.count; ++i) {
                if (!pair.point[i].active) continue;
                carrying |= 1u << i;
                for (int k = 0; k < Point::directions; ++k) {
                    auto& to = pair.point[i].row[k];
                    to.before = Speed{};
                    if (k >= rows) continue;
                    to.before = over_share(Row::product(row[i][k].impulse, row[i][k].inverse), pair, is_a);
                    const Speed impulse = W::over(to.before, to.inverse);
                    to.push(impulse, is_a ? unused : other, is_a ? &other : &unused);
                }
            }
            pair.carrying = static_cast<std::uint8_t>(carrying);
            moves_ = true;
            for (int i = 0; i < 3; ++i)
                if (!W::fits(other.linear[i]) || !W::fits(other.angular[i])) return false;
            return true;
        }
    }
    // Stops a body through its last pair, and hands on to the other one what this takes. `before` of the points' rows
    // gets what they push, as impulses of the body.
    bool carry(Pair& pair, int b) {
        const bool is_a = b == pair.a;
        const CollisionShape<N>& shape = shapes_.shape(b);
        const Velocity& now = velocities_.now[b];
        Vec3<Unit> frame[3] = {pair.normal, pair.tangent[0], pair.tangent[1]};
        if (!features.friction || !pair.has_friction) {
            Vec3<Unit> tangent[2];
            set_tangents<N>(pair.normal, tangent);
            frame[1] = tangent[0];
            frame[2] = tangent[1];
        }
        const Side side{shapes_.axes(b), frame, pair, is_a};
        // What stops the body. A pair pulls at body b what it pushes at body a.
        typename Weld::Wrench wrench;
        const Vec3<Speed> linear = is_a ? Vec3<Speed>(-now.linear) : now.linear;
        const Vec3<Speed> angular = is_a ? Vec3<Speed>(-now.angular) : now.angular;
        for (int k = 0; k < 3; ++k) {
            wrench.force[k] = narrow<Speed>(dot(frame[k], linear));
            const Vec3<Unit>& axis = side.frame[k];
            const auto part = [&](int i) { return narrow<Length>(mul(axis[i], shape.gyration[i])); };
            wrench.moment[k] = mul_add(mul_add(mul(part(0), angular[0]), part(1), angular[1]), part(2), angular[2]);
        }
        for (int k = 0; k < 3; ++k) wrench.moment[k] -= side.moment_of(wrench.force, k);
        Weld weld;
        typename Weld::Shares shares;
        if (!weld.set(side.x, side.z, side.count, shape.radius) ||
            !weld.share(wrench, features.friction && pair.has_friction, pair.friction,
                        Bounds::slack(velocities_.scale.enough_in_impact()), shares))
            return false;
        for (int i = 0, j = 0; i < pair.count; ++i) {
            if (!is_carrying(pair, i)) continue;
            for (int k = 0; k < Point::directions; ++k)
                pair.point[i].row[k].before = over_share(shares[j][k], pair, is_a);
            ++j;
        }
        if constexpr (features.pairs)
            if (pair.moves_b() && !hand_on(pair, is_a, frame, wrench, linear)) return false;
        stop(b);
        return true;
    }

    // The frame of a pair in the axes of one of its bodies, and the places of the points that carry.
    struct Side {
        Vec3<Unit> frame[3];
        Length middle[3];                     // of the points, from the centre of mass
        Length x[Weld::most], z[Weld::most];  // along the tangents from there
        int count = 0;

        Side(const Axes<N>& axes, const Vec3<Unit> (&world)[3], const Pair& pair, bool is_a) {
            Length sum[3] = {};
            for (int k = 0; k < 3; ++k) frame[k] = axes.to_body(world[k]);
            for (int i = 0; i < pair.count; ++i) {
                if (!is_carrying(pair, i)) continue;
                const Vec3<Length>& arm = arm_of(pair.point[i], is_a);
                const Length along[3] = {narrow<Length>(dot(frame[0], arm)), narrow<Length>(dot(frame[1], arm)),
                                         narrow<Length>(dot(frame[2], arm))};
                for (int k = 0; k < 3; ++k) sum[k] += along[k];
                x[count] = along[1];
                z[count] = along[2];
                ++count;
            }
            for (int k = 0; k < 3; ++k) middle[k] = W::mean(sum[k], count);
            for (int i = 0; i < count; ++i) {
                x[i] -= middle[1];
                z[i] -= middle[2];
            }
        }
        // About the centre of mass, of a force at the middle: component k.
        [[nodiscard]] auto moment_of(const Vec3<Speed>& force, int k) const {
            const int i = k == 2 ? 0 : k + 1, j = 3 - k - i;
            return mul_sub(mul(middle[i], force[j]), middle[j], force[i]);
        }
    };
    // Gives the other body of a pair what it carries. False where it is too fast for the scale.
    bool hand_on(const Pair& pair, bool from_a, const Vec3<Unit> (&world)[3], const typename Weld::Wrench& wrench,
                 const Vec3<Speed>& linear) requires(features.pairs) {
        const int b = from_a ? pair.b : pair.a;
        const CollisionShape<N>& shape = shapes_.shape(b);
        const Side side{shapes_.axes(b), world, pair, !from_a};
        const auto extent = W::Extent::above(shape.radius);
        Speed moment[3];
        for (int k = 0; k < 3; ++k) moment[k] = extent.speed(wrench.moment[k] + side.moment_of(wrench.force, k));
        Velocity& now = velocities_.now[b];
        const auto add = [&](Speed& to, Speed change) {
            const Speed scaled =
                over_share(narrow<Speed>(mul(change, from_a ? pair.share_b : pair.share_a)), pair, from_a);
            to = from_a ? to - scaled : to + scaled;
            return W::fits(to);
        };
        bool fits = true;
        for (int i = 0; i < 3; ++i) {
            fits = add(now.linear[i], linear[i]) && fits;
            const Speed turn = narrow<Speed>(mul_add(
                mul_add(mul(side.frame[0][i], moment[0]), side.frame[1][i], moment[1]), side.frame[2][i], moment[2]));
            fits = add(now.angular[i], W::speed(mul(shape.per_gyration[i](extent.length()), turn))) && fits;
        }
        return fits;
    }
    // An impulse of a body as one of the pair.
    [[nodiscard]] static Speed over_share(Speed impulse, const Pair& pair, bool of_a) {
        return pair.moves_b() ? W::over(impulse, of_a ? pair.share_a : pair.share_b) : impulse;
    }
    void set_impulses() {
        pairs_.for_each(island_, [&](Pair& pair) {
            for (int i = 0; i < pair.count; ++i) {
                for (auto& row : pair.point[i].row) {
                    const bool pushes = is_carrying(pair, i) && !(row.before == Speed{});
                    row.impulse = pushes ? W::over(row.before, row.inverse) : Speed{};
                }
            }
        });
    }
    [[nodiscard]] static bool is_carrying(const Pair& pair, int i) { return (pair.carrying >> i & 1) != 0; }
    [[nodiscard]] static const Vec3<Length>& arm_of(const Point& point, bool is_a) {
        if constexpr (features.pairs)
            if (!is_a) return point.arm_b;
        return point.arm;
    }
    template <class F>
    void for_each_carrying(F&& f) {
        for (int i = island_.first_pair; i >= 0; i = pairs_[i].next)
            if (pairs_[i].carrying != 0) f(i, pairs_[i]);
    }

    const NarrowPhase& shapes_;
    PairList& pairs_;
    Velocities& velocities_;
    const Island& island_;
    int carrying_ = 0;    // pairs
    bool moves_ = false;  // a body of the solution
};

}  // namespace tumble

// The rows of an island's contact points, and what a length, a speed and a surface are along them.
#pragma once

#include <tumble/contact/narrow_phase.hpp>
#include <tumble/contact/pair_list.hpp>
#include <tumble/solver/sweep.hpp>
#include <tumble/solver/velocities.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class ContactRows {
public:
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;
    using Length = typename C::Length;
    using Speed = typename C::Speed;
    using Work = typename N::Work;
    using NarrowPhase = tumble::NarrowPhase<N, spin, features>;
    using Bodies = typename NarrowPhase::Bodies;
    using Pair = typename NarrowPhase::Pair;
    using Point = typename NarrowPhase::Point;
    using PairList = tumble::PairList<N, features>;
    using Island = tumble::Island<features>;
    using Velocities = SolverVelocities<N, spin, features>;
    using Velocity = WeightedVelocity<N>;
    using Kicks = typename Velocities::Kicks;
    static constexpr bool has_edges = features.pairs && features.boxes;
    using Sweep = tumble::Sweep<N, features.pairs, features.friction, features.rolling_resistance>;
    // There are rows at right angles to the normals.
    static constexpr bool has_across = features.friction || features.rolling_resistance;
    static constexpr bool is_one_row = Velocities::is_one_row;

    ContactRows(const NarrowPhase& shapes, PairList& pairs, Velocities& velocities, const Bodies& bodies,
                const Island& island)
        : shapes_{shapes}, pairs_{pairs}, velocities_{velocities}, bodies_{bodies}, island_{island} {}

    // Sets the velocities of the island's bodies, with `part` of the loads' change; `whole`: all of it. True where they
    // are what they were, apart from their scale.
    // `lifts`: the scale has room for the correction of penetrations, lift(gap, tolerance).
    // `in_halves`: half of each kick acts before the flight, half after it.
    template <auto lift = &ContactBounds<N>::lift>
    bool set_velocities(const Kicks& loads, Work part, bool whole, bool lifts = false, bool in_halves = false) {
        velocities_.set_turns(bodies_, island_.group, part, in_halves,
                              [&](int b) { return shapes_.shape(b).is(ShapeKind::sphere); });
        auto least = C::nothing();
        if (lifts) [[unlikely]]
            pairs_.for_each(island_, [&](const Pair& pair) {
                const auto size = C::size(lift(pair.gap, shapes_.tolerance()), shapes_.scale(), pair.weight);
                if (size > least) least = size;
            });
        velocities_.set_scale(bodies_, shapes_.weights(), island_.group, loads, least,
                              [&](int b) { return touches_several(b); });
        make_room_for_surfaces();
        return velocities_.set(bodies_, shapes_.weights(), island_.group, loads, part, whole);
    }
    // The part of a step after which kinematic bodies are where the rows act: none in an impact. `turntables`: bodies
    // on these, too. Others are on them where they are at the end of the step.
    void look_ahead(Work part, bool turntables = false) requires(features.moving_surfaces()) {
        ahead_ = part;
        turntables_ahead_ = turntables;
    }
    // The part of a step in the middle of which the rows act; none of an impact, and where kicks act at one end.
    void act_in_middle(Work part) requires(has_edges) { half_ = N::half_of(part); }
    // Makes the rows of a pair's points anew where these or the bodies have moved. Sets the targets of the rows to the
    // velocity that the point has at the end without them: that of a turning surface, and what the turn of the bodies
    // changes after the middle of the flight. Of bodies that turn only the normals are made, where tangents can wait.
    void make_rows(Pair& pair) {
        const bool turns = this->turns(pair);
        bool valid = !turns;
        for (int i = 0; i < pair.count; ++i) {
            if (!turns) pair.point[i].row[0].target = Speed{};
            valid = valid && pair.point[i].rows_are_valid;
        }
        if constexpr (has_edges)
            if (may_round(pair)) [[unlikely]]
                if (make_rounding_rows(pair)) valid = true;
        if (!valid) {
            pairs_.unbalance(pair);
            const Directions directions = directions_of(pair);
            if constexpr (Velocities::bodies_turn)
                if (turns) make_turning_rows(pair, directions, 0, tangents_wait(pair) ? 1 : pair.rows());
            bool moves = false;
            if constexpr (has_edges) moves = may_shift(pair);
            for (int i = 0; i < pair.count; ++i) {
                Point& point = pair.point[i];
                bool shifts = false;
                if (!turns && (moves || !point.rows_are_valid)) {
                    Vec3<Length> arm = point.arm;
                    if (moves) {
                        if constexpr (has_edges) arm += shift(pair, point);
                        shifts = !(arm == point.arm);
                    }
                    for (int k = 0; k < pair.rows(); ++k) set_row(point, arm, directions, k, pair);
                }
                point.rows_are_valid = !turns && !shifts;
                if constexpr (features.rolling_resistance)
                    if (pair.resists_spin()) set_spin_rows(point, directions, pair);
            }
        }
        if constexpr (features.rolling_resistance)
            if (pair.resists_spin()) set_spin_targets(pair);
        if constexpr (features.moving_surfaces()) {
            if (!pair.surface_moves) return;
            for (int i = 0; i < pair.count; ++i) {
                if constexpr (features.kinematic) {
                    Speed& surface = pair.point[i].surface = {};
                    if (bodies_.constants[pair.b].kinematic())
                        surface = along(pair.point[i], velocities_.scale.speed(surface_speed(pair, pair.point[i], 0)));
                }
                for (int k = 1; k < pair.rows(); ++k) {
                    auto& row = pair.point[i].row[k];
                    if (!turns) row.target = Speed{};
                    row.target +=
                        narrow<Speed>(mul(velocities_.scale.speed(surface_speed(pair, pair.point[i], k)), row.inverse));
                }
            }
        }
    }

    // Makes the tangents that have waited for make_rows(): a step that begins with an impact needs none of them.
    void make_tangents([[maybe_unused]] Pair& pair) const {
        if constexpr (Velocities::bodies_turn && has_across)
            if (tangents_wait(pair)) make_turning_rows(pair, directions_of(pair), 1, pair.rows());
    }

    // The rows of a point, with the velocities that their impulses change.
    [[nodiscard]] typename Sweep::Block block(Pair& pair, Point& point) {
        typename Sweep::Block block = normal_block(pair, point);
        block.rows = pair.rows();
        block.coefficient = pair.friction;
        if constexpr (features.friction) block.couplings = &point.couplings;
        if constexpr (features.rolling_resistance)
            if (pair.resists_spin()) block.resistance = {point.spin, pair.rolling, pair.spinning};
        return block;
    }
    // Whether sweeps solve the faces of a bounded step at once.
    void solve_faces(bool faces) requires(Pair::has_faces) { faces_ = faces; }

    // Along the normal of a point, against the other side.
    [[nodiscard]] Speed velocity(const auto& of, const Pair& pair, const Point& point) const {
        return point.row[0].velocity(of[pair.a], pair.moves_b() ? &of[pair.b] : nullptr) - surface_of(pair, point);
    }
    // Of the other side, along the normal.
    [[nodiscard]] static Speed surface_of([[maybe_unused]] const Pair& pair, [[maybe_unused]] const Point& point) {
        if constexpr (features.kinematic)
            if (pair.surface_moves) return point.surface;
        return Speed{};
    }
    // A length per step along the pair's normal, as a speed along the point's row.
    [[nodiscard]] Speed speed(const Pair& pair, const Point& point, Length per_step) const {
        return narrow<Speed>(
            mul(velocities_.scale.speed(per_step, pair.weight, shapes_.scale()), point.row[0].inverse));
    }
    // A speed along the point's row, as a length in m per step along the pair's normal.
    [[nodiscard]] Work metres_per_step(const Pair& pair, const Point& point, Speed speed) const {
        return velocities_.scale.work(speed) / (pair.weight * N::work(point.row[0].inverse));
    }
    // A length in m per step along the pair's normal, as a speed of the pair.
    [[nodiscard]] Speed pair_speed(const Pair& pair, Work per_step) const {
        return velocities_.scale.speed(per_step * pair.weight);
    }
    [[nodiscard]] static Speed along(const Point& point, Speed of_pair) { return along(point.row[0], of_pair); }
    [[nodiscard]] static Speed along(const Row<N, features.pairs>& row, Speed of_pair) {
        return narrow<Speed>(mul(of_pair, row.inverse));
    }

    // By how much the velocity of a fixed body's surface at a point has changed since the last step, as far as the
    // other body does not have this change yet. m a step, world. `changes`: of the velocities of fixed bodies.
    [[nodiscard]] WorkVec3<N> change_ahead(const Kicks& changes, const Pair& pair, const Point& point) const
        requires(features.moving_surfaces() && features.pairs) {
        const WorkVec3<N> arm = shapes_.world_arm(pair.b, point.arm_b), normal = work_unit<N>(pair.normal);
        WorkVec3<N> change = cross<Work>(change_of_turn(changes, pair.b), arm),
                    ahead = cross<Work>(turn_of(pair.b), arm) -
                            cross<Work>(turn_of(pair.a), shapes_.world_arm(pair.a, point.arm));
        change += change_of_drift(changes, pair.b);
        ahead += WorkVec3<N>(drift_of(pair.b) - drift_of(pair.a));
        const WorkVec3<N> along = scaled_by(normal, dot(change, normal)), across = change - along;
        return scaled_by(along, share_ahead(ahead, along)) + scaled_by(across, share_ahead(ahead, across));
    }
    // m a step.
    [[nodiscard]] WorkVec3<N> change_of_drift(const Kicks& changes, int b) const {
        WorkVec3<N> change;
        for (int i = 0; i < 3; ++i) change[i] = N::metres(changes[b].linear[i], bodies_.scale);
        return change;
    }
    // Rad a step, world.
    [[nodiscard]] WorkVec3<N> change_of_turn(const Kicks& changes, int b) const {
        WorkVec3<N> change;
        for (int i = 0; i < 3; ++i)
            change[i] = N::half_turn(changes[b].angular[i], bodies_.finest_scale()) *
                        bodies_.constants[b].units.rate(i, Work(1));
        return shapes_.to_world(b, change);
    }
    // The share of a change that is still ahead.
    [[nodiscard]] static Work share_ahead(const WorkVec3<N>& ahead, const WorkVec3<N>& change) {
        const Work part = dot(ahead, change), all = dot(change, change);
        return !(part > Work(0)) ? Work(0) : part < all ? part / all : Work(1);
    }

    // When sweeps end: Sweep::run.
    struct Until {
        Speed enough;
        int most, patience = 1;  // the latter only with momentum
    };
    // From no impulses. Of several bodies impulses that change no velocity may carry a load from body to body: sweeps
    // wait as long as conjugate gradients would take, for six velocities of each.
    [[nodiscard]] Until from_nothing(Speed enough) const {
        const int most = ContactBounds<N>::sweeps(contact::max_impact_sweeps), count = island_.group.count;
        return {enough, most, count > 1 ? 6 * count : patience_of_one(most)};
    }
    // From the impulses of the step before. Then the changes between several bodies are small, and may not get smaller
    // before the impulse of a point is used up.
    [[nodiscard]] Until from_last_step(Speed enough) const {
        const int most = ContactBounds<N>::sweeps(contact::max_sweeps);
        return {enough, most, island_.group.count > 1 ? most : patience_of_one(most)};
    }
    // Solves all points that take part by sweeps. Returns the largest change of an impulse in the last one.
    Speed sweep(const Until& until, bool with_momentum = true) {
        if constexpr (features.friction)
            pairs_.for_each_active(island_, [](const Pair& pair, Point& point) {
                if (pair.rows() > 1) point.couplings.set(point.row, pair.moves_b());
            });
        if constexpr (!has_across) return sweep_normals(until, with_momentum);
        else if constexpr (!features.pairs) return sweep_blocks(BlockOf{*this, false}, until, with_momentum);
        else return sweep_blocks([&](Pair& pair, Point& point) { return block(pair, point); }, until, with_momentum);
    }
    // The same from the impulses of the step before, for the forces of a step. Of a body that moves alone on several
    // surfaces, those to which it does not move wait until the forces of others move it there. Forces of two walls that
    // cancel are a solution too: sweeps leave some, and each step would add to those of the step before.
    Speed sweep_pressed(Speed enough) {
        bool wait = false;
        if constexpr (features.pairs || features.planes > 1)
            if (island_.group.count == 1 && touches_several()) wait = start_waiting(enough);
        push_all();
        Speed left = sweep(from_last_step(enough));
        if (wait) [[unlikely]]
            left = sweep_waiting(left, enough);
        return left;
    }
    // The same, as if the points were smooth.
    Speed sweep_normals(const Until& until, bool with_momentum) {
        if constexpr (has_across && !features.pairs) return sweep_blocks(BlockOf{*this, true}, until, with_momentum);
        else
            return sweep_blocks([&](Pair& pair, Point& point) { return normal_block(pair, point); }, until,
                                with_momentum, true);
    }
    // Visits once more the points on what nothing pushes, so that what sweeps leave is between bodies.
    void sweep_surfaces(bool smooth) requires(features.bounded_steps) {
        Speed most{};
        const auto block_of = [&](Pair& pair, Point& point) {
            return smooth ? normal_block(pair, point) : block(pair, point);
        };
        pairs_.for_each(island_, [&](Pair& pair) {
            if (!pair.moves_b() && pair.gap + shapes_.tolerance() < Length{})
                for_each_block(
                    pair, [&](const auto& block) { Sweep::visit(block, most); }, block_of, smooth);
        });
    }
    // Applies the impulses of all points that take part.
    void push_all() {
        pairs_.for_each_active(island_, [&](Pair& pair, Point& point) { Sweep::push(block(pair, point)); });
    }
    static void clear_impulses(Point& point) {
        point.for_each_row([](auto& row) { row.impulse = Speed{}; });
    }

private:
    // How fast the body comes to the surface at a point.
    [[nodiscard]] Speed approach_at(const Pair& pair, const Point& point) const {
        return -point.row[0].excess(velocities_.now[pair.a], nullptr);
    }
    // Whether the body has points with several others. Those that are only near push nothing.
    [[nodiscard]] bool touches_several(int b) const {
        if (pairs_.pairs_of(b) < 2) return false;
        int touched = 0;
        pairs_.for_each(island_, [&](const Pair& pair) {
            touched += pair.count > 0 && (pair.a == b || (pair.moves_b() && pair.b == b));
        });
        return touched > 1;
    }
    [[nodiscard]] bool touches_several() const {
        int touched = 0;
        pairs_.for_each(island_, [&](const Pair& pair) { touched += pair.touched; });
        return touched > 1;
    }
    // Takes out of the solution the points of pairs that the body approaches by no more than sweeps leave: a part of
    // its fastest approach, or `enough`. True where there are some.
    [[nodiscard, gnu::noinline, gnu::cold]] bool start_waiting(Speed enough) {
        bool any = false;
        Speed fastest{};
        pairs_.for_each_active(island_, [&](const Pair& pair, const Point& point) {
            const Speed approach = approach_at(pair, point);
            if (approach > fastest) fastest = approach;
        });
        const Speed least = larger_of(ContactBounds<N>::left_by_sweeps(fastest), enough);
        pairs_.for_each(island_, [&](Pair& pair) {
            bool pressed = false;
            for (int i = 0; i < pair.count; ++i)
                pressed = pressed || (pair.point[i].active && approach_at(pair, pair.point[i]) > least);
            for (int i = 0; i < pair.count; ++i) {
                Point& point = pair.point[i];
                point.waits = point.active && !pressed;
                point.active = point.active && pressed;
                any = any || point.waits;
            }
        });
        return any;
    }
    // Sweeps again as long as points that wait are pressed, such as those of a wall by forces of a floor. Points
    // that nothing presses carry nothing. Returns the largest change of the last sweep.
    [[nodiscard, gnu::noinline, gnu::cold]] Speed sweep_waiting(Speed left, Speed enough) {
        const auto for_each_waiting = [&](auto&& f) {
            pairs_.for_each(island_, [&](Pair& pair) {
                for (int i = 0; i < pair.count; ++i)
                    if (pair.point[i].waits) f(pair, pair.point[i]);
            });
        };
        const auto join = [](Point& point) {
            point.waits = false;
            point.active = true;
        };
        for (int round = 0; round < contact::max_supports; ++round) {
            bool pressed = false;
            const Speed least = larger_of(left, enough);
            for_each_waiting([&](Pair& pair, Point& point) {
                if (!(approach_at(pair, point) > least)) return;
                pressed = true;
                join(point);
                Sweep::push(block(pair, point));
            });
            if (!pressed) break;
            left = sweep(from_last_step(enough));
        }
        for_each_waiting([&](const Pair&, Point& point) {
            join(point);
            clear_impulses(point);
        });
        return left;
    }
    [[nodiscard]] typename Sweep::Block normal_block(Pair& pair, Point& point) {
        return {.row = point.row,
                .rows = 1,
                .a = velocities_.now[pair.a],
                .b = pair.moves_b() ? &velocities_.now[pair.b] : nullptr};
    }
    // A face with its points, as a block of sweeps.
    struct FaceBlock {
        static constexpr int most_points = Pair::max_points;
        ContactRows& rows;
        Pair& pair;
        bool smooth;
        const typename Pair::Face& face;
        int count;
        Velocity& a;
        Velocity* b;
        Speed rounding;

        [[nodiscard]] Row<N, features.pairs>* rows_of(int i) const { return pair.point[i].row; }
        [[nodiscard]] bool has_tangents() const { return features.friction && !smooth && face.has_tangents; }
        [[nodiscard]] typename Sweep::Block point(int i) const {
            return smooth ? rows.normal_block(pair, pair.point[i]) : rows.block(pair, pair.point[i]);
        }
        template <class F>
        void for_each_group(F&& f) const {
            for (int i = 0; i < count; ++i) point(i).for_each_group(f);
        }
    };
    [[nodiscard]] FaceBlock face_block(Pair& pair, bool smooth) requires(Pair::has_faces) {
        return {*this,
                pair,
                smooth,
                pair.face,
                pair.count,
                velocities_.now[pair.a],
                pair.moves_b() ? &velocities_.now[pair.b] : nullptr,
                velocities_.scale.rounding()};
    }
    // Blocks of either kind, for one copy of the sweeps.
    struct BlockOf {
        ContactRows& rows;
        bool smooth;

        [[nodiscard]] typename Sweep::Block operator()(Pair& pair, Point& point) const {
            return smooth ? rows.normal_block(pair, point) : rows.block(pair, point);
        }
    };
    // Calls f(velocity, its Motion) for each body. A type with a name, so that all sweeps share one copy of what f
    // does.
    struct ForEachVelocity {
        Velocities& velocities;
        const Island& island;

        template <class F>
        void operator()(F&& f) const {
            if constexpr (!is_one_row)
                for (int k = 0; k < island.group.count; ++k) {
                    const int b = island.group.id[k];
                    f(velocities.now[b], velocities.sweeping[b]);
                }
        }
    };
    template <class Block>
    Speed sweep_blocks(Block&& block_of, const Until& until, bool with_momentum, [[maybe_unused]] bool smooth = false) {
        return velocities_.within_bounds(until.most, until.enough, [&](int& left) {
            return Sweep::run(
                [&](auto&& f) {
                    if constexpr (Pair::has_faces)
                        if (faces_)
                            return pairs_.for_each(island_,
                                                   [&](Pair& pair) { for_each_block(pair, f, block_of, smooth); });
                    pairs_.for_each_active(island_, [&](Pair& pair, Point& point) { f(block_of(pair, point)); });
                },
                ForEachVelocity{velocities_, island_}, until.enough, velocities_.scale.enough_in_impact(), left,
                until.patience, with_momentum && !is_one_row);
        });
    }
    template <class F, class Block>
    void for_each_block(Pair& pair, F&& f, Block&& block_of, bool smooth) requires(features.bounded_steps) {
        if constexpr (Pair::has_faces)
            if (faces_ && pair.count > 0 && pair.face.whole) return f(face_block(pair, smooth));
        for (int i = 0; i < pair.count; ++i)
            if (pair.point[i].active) f(block_of(pair, pair.point[i]));
    }
    // Of one body on one surface, or on smooth ones, impulses that change no velocity only shift among its points. On
    // several rough ones the friction of each works against the normals of others: their impulses rise together, and
    // no velocity changes, until a cone is reached.
    [[nodiscard]] int patience_of_one(int most) const {
        if constexpr (PairList::is_single || !features.friction) return 1;
        int pairs = 0;
        bool rough = false;
        pairs_.for_each(island_, [&](const Pair& pair) {
            bool any = false;
            for (int i = 0; i < pair.count; ++i) any = any || pair.point[i].active;
            if (!any) return;
            ++pairs;
            rough = rough || pair.has_friction;
        });
        return rough && pairs > 1 ? most : 1;
    }
    [[nodiscard]] bool turns(const Pair& pair) const {
        return velocities_.turns(pair.a) || (pair.moves_b() && velocities_.turns(pair.b));
    }
    // True of a pair whose tangents nothing needs before it is known whether a point strikes.
    [[nodiscard]] bool tangents_wait(const Pair& pair) const {
        if (pair.count == 0 || pair.rows() == 1 || !turns(pair)) return false;
        if constexpr (features.moving_surfaces())
            if (pair.surface_moves) return false;
        if constexpr (features.rolling_resistance)
            if (pair.resists_spin()) return false;
        return true;
    }
    [[nodiscard]] auto directions_of(const Pair& pair) const {
        return Directions{pair, shapes_.axes(pair.a), pair.moves_b() ? &shapes_.axes(pair.b) : nullptr};
    }
    // The directions of a pair's rows, in the principal axes of its bodies, times the bodies' shares of the motion.
    struct Directions {
        Vec3<Unit> linear[Point::directions], angular[Point::directions];
        [[no_unique_address]] If<features.pairs, Vec3<Unit>[Point::directions], 0> linear_b;
        [[no_unique_address]] If<features.pairs, Vec3<Unit>[Point::directions], 1> angular_b;
        bool moves_b = false;

        Directions(const Pair& pair, const Axes<N>& axes, [[maybe_unused]] const Axes<N>* axes_b) {
            using Row = tumble::Row<N, features.pairs>;
            for (int k = 0; k < pair.rows(); ++k) {
                const StoredVec3<Unit>& direction = k == 0 ? pair.normal : pair.tangent[k - 1];
                if constexpr (features.pairs) {
                    if (axes_b != nullptr) {
                        moves_b = true;
                        linear[k] = Row::times(direction, pair.share_a);
                        linear_b[k] = Row::times(direction, pair.share_b);
                        angular[k] = axes.to_body(linear[k]);
                        angular_b[k] = axes_b->to_body(linear_b[k]);
                        continue;
                    }
                }
                linear[k] = direction;
                angular[k] = axes.to_body(linear[k]);
            }
        }
    };
    // True of a box that moves over a body which nothing pushes. Points on it may shift.
    [[nodiscard]] bool may_shift(const Pair& pair) const requires(has_edges) {
        return half_ > Work(0) && !pair.with_plane() && !pair.moves_b() && bodies_.is_drifting(pair.a) &&
               shapes_.shape(pair.a).is(ShapeKind::box);
    }
    // By how much the place of a point on the box shifts until the middle of the flight, in principal axes. A vertex of
    // the box is always the same place on it. A point on the other body stays there, such as one on the edge of a table
    // that the box leaves. Where two edges cross, the point runs along both.
    [[nodiscard, gnu::noinline, gnu::cold]] Vec3<Length> shift(const Pair& pair, const Point& point) const
        requires(has_edges) {
        const Axes<N>& axes = shapes_.axes(pair.a);
        const Edge own = edge_of(pair.a, point.arm);
        Vec3<Length> shift = Vec3<Length>::Constant(Length{});
        if (own.open == 0) return shift;
        const WorkVec3<N> normal = work_unit<N>(pair.normal);
        WorkVec3<N> way = -drift_of(pair.a);
        way -= cross<Work>(turn_of(pair.a), shapes_.world_arm(pair.a, point.arm));
        if constexpr (features.moving_surfaces())
            if (pair.surface_moves) {
                way += cross<Work>(turn_of(pair.b), shapes_.world_arm(pair.b, point.arm_b));
                if (bodies_.constants[pair.b].kinematic()) way += drift_of(pair.b);
            }
        way -= scaled_by(normal, dot(way, normal));
        way = scaled_by(way, half_);
        if (own.open == 1 && shapes_.shape(pair.b).is(ShapeKind::box)) {
            const Edge other = edge_of(pair.b, point.arm_b);
            const WorkVec3<N> along = work_unit<N>(own.axis), across = cross<Work>(normal, work_unit<N>(other.axis));
            const Work slope = dot(along, across);
            if (other.open != 1 || !ContactBounds<N>::cross(slope)) return shift;
            way = scaled_by(along, dot(way, across) / slope);
        }
        for (int i = 0; i < 3; ++i) shift[i] = shapes_.scale().length(dot(way, work_unit<N>(axes.axis(i))));
        return shift;
    }
    // True of a ball that moves over a box which nothing pushes.
    [[nodiscard]] bool may_round(const Pair& pair) const requires(has_edges) {
        return half_ > Work(0) && !pair.with_plane() && !pair.moves_b() && pair.count == 1 &&
               bodies_.is_drifting(pair.a) && shapes_.shape(pair.a).is(ShapeKind::sphere) &&
               shapes_.shape(pair.b).is(ShapeKind::box);
    }
    // Makes the row of a ball at an edge or a vertex of a box, round which its normal turns. The row acts in the middle
    // of the flight, and its target is that of the end. False where the normal does not turn, as on a face.
    [[gnu::noinline, gnu::cold]] bool make_rounding_rows(Pair& pair) requires(has_edges) {
        Point& point = pair.point[0];
        const Axes<N> axes_b = shapes_.shape(pair.b).axes(shapes_.axes(pair.b));
        const Edge edge = edge_of(pair.b, point.arm_b);
        if (edge.open > 1) return false;
        for (int i = 0; i < 3; ++i) {
            const Unit cosine = narrow<Unit>(dot(pair.normal, axes_b.axis(i)));
            if (magnitude_of(cosine) > ContactBounds<N>::along_face()) return false;
        }
        const WorkVec3<N> normal = work_unit<N>(pair.normal);
        WorkVec3<N> way = drift_of(pair.a);
        if constexpr (features.moving_surfaces())
            if (pair.surface_moves) {
                way -= cross<Work>(turn_of(pair.b), shapes_.world_arm(pair.b, point.arm_b));
                if (bodies_.constants[pair.b].kinematic()) way -= drift_of(pair.b);
            }
        way -= scaled_by(normal, dot(way, normal));
        if (edge.open == 1) {
            const WorkVec3<N> along = work_unit<N>(edge.axis);
            way -= scaled_by(along, dot(way, along));
        }
        const Length radius = shapes_.shape(pair.a).half.x();
        const WorkVec3<N> turn = scaled_by(way, half_ / shapes_.scale().metres(radius + point.gap));
        const Work square = dot(turn, turn);
        if (!ContactBounds<N>::is_followed(square)) return false;
        WorkVec3<N> middle = normal;
        middle += turn;
        middle = scaled_by(middle, Work(1) / sqrt(Work(1) + square));
        const Vec3<Unit> start = pair.normal;
        for (int i = 0; i < 3; ++i) pair.normal[i] = C::unit(middle[i]);
        if constexpr (features.friction)
            if (pair.has_friction) set_tangents<N>(pair.normal, pair.tangent);
        const Directions directions{pair, shapes_.axes(pair.a), nullptr};
        const Vec3<Length> arm = tumble::along(Vec3<Unit>(-directions.angular[0]), radius);
        for (int k = 0; k < pair.rows(); ++k) set_row(point, arm, directions, k, pair);
        set_target(point.row[0], velocities_.scale.speed(-dot(turn, way) * pair.weight));
        if constexpr (features.rolling_resistance)
            if (pair.resists_spin()) set_spin_rows(point, directions, pair);
        pair.normal = start;
        if constexpr (features.friction)
            if (pair.has_friction) set_tangents<N>(pair.normal, pair.tangent);
        pairs_.unbalance(pair);
        point.rows_are_valid = false;
        return true;
    }
    // In how many directions a place is not at the end of a box, and the last of them, world.
    struct Edge {
        int open = 0;
        Vec3<Unit> axis{};
    };
    [[nodiscard, gnu::noinline, gnu::cold]] Edge edge_of(int b, const Vec3<Length>& arm) const requires(has_edges) {
        const CollisionShape<N>& shape = shapes_.shape(b);
        const Axes<N> axes = shape.axes(shapes_.axes(b));
        const Vec3<Length> place = shape.turned ? shape.edges.to_body(arm) : arm;
        Edge edge;
        for (int i = 0; i < 3; ++i) {
            if (!(magnitude_of(place[i]) + shapes_.tolerance() < shape.half[i])) continue;
            ++edge.open;
            edge.axis = axes.axis(i);
        }
        return edge;
    }
    // Makes a row of bodies that do not turn.
    void set_row(Point& point, const Vec3<Length>& arm, const Directions& directions, int k, const Pair& pair) const {
        auto& row = point.row[k];
        row.target = Speed{};
        const auto lever = shapes_.weights()[pair.a].levers(arm, directions.angular[k]);
        if constexpr (features.pairs) {
            if (directions.moves_b) {
                row.set(directions.linear[k], lever, directions.linear_b[k],
                        shapes_.weights()[pair.b].levers(point.arm_b, directions.angular_b[k]));
                return;
            }
        }
        row.set(directions.linear[k], lever);
    }
    // Makes the rows of the relative spin, in the axes of the start.
    void set_spin_rows(Point& point, const Directions& directions, const Pair& pair) const
        requires(features.rolling_resistance) {
        for (int k = 0; k < 3; ++k) {
            auto& row = point.spin[k];
            const int about = spin_direction(k);
            const auto lever = shapes_.weights()[pair.a].spin_levers(directions.angular[about], pair.spin_arm);
            if constexpr (features.pairs) {
                if (directions.moves_b) {
                    row.set_spin(lever,
                                 shapes_.weights()[pair.b].spin_levers(directions.angular_b[about], pair.spin_arm));
                    continue;
                }
            }
            row.set_spin(lever);
        }
    }
    // Sets the targets of the rows of the spin: a fixed body may turn.
    void set_spin_targets(Pair& pair) const requires(features.rolling_resistance) {
        for (int k = 0; k < 3; ++k) {
            [[maybe_unused]] const Work turn = turntable_spin(pair, k);
            for (int i = 0; i < pair.count; ++i) {
                auto& row = pair.point[i].spin[k];
                row.target = Speed{};
                if constexpr (features.moving_surfaces())
                    if (pair.surface_moves) row.target = narrow<Speed>(mul(velocities_.scale.speed(turn), row.inverse));
            }
        }
    }
    // The spin of a turning fixed body along row k, as a speed of the pair.
    [[nodiscard]] Work turntable_spin([[maybe_unused]] const Pair& pair, [[maybe_unused]] int k) const
        requires(features.rolling_resistance) {
        if constexpr (features.moving_surfaces() && features.pairs) {
            if (!pair.surface_moves) return Work(0);
            const int about = spin_direction(k);
            const WorkVec3<N> direction = work_unit<N>(about == 0 ? pair.normal : pair.tangent[about - 1]);
            return dot(turn_of(pair.b), direction) * shapes_.scale().metres(pair.spin_arm) * pair.weight;
        }
        return Work(0);
    }
    // The direction of the pair about which row k of the spin is: the tangents, then the normal.
    [[nodiscard]] static int spin_direction(int k) { return k < 2 ? k + 1 : 0; }
    // Directions in the axes of a body, in the middle and at the end of a flight.
    struct Turned {
        Vec3<Unit> middle[Point::directions], end[Point::directions];

        Turned(const Vec3<Unit> (&start)[Point::directions], const MiddleTurn<N>& turn, int count) {
            for (int k = 0; k < count; ++k) {
                middle[k] = turn.later(start[k]);
                end[k] = turn.later(middle[k]);
            }
        }
    };
    struct Arms {
        Vec3<Length> middle, end;
    };
    // Makes the rows `first` to `count` - 1 of bodies that turn. A point on a surface that stands still is a place on
    // the body, but round shapes roll over it. Between two bodies that move, the arms stand still in the world.
    [[gnu::noinline]] void make_turning_rows(Pair& pair, const Directions& directions, int first, int count) const
        requires(Velocities::bodies_turn) {
        const Turned a{directions.angular, velocities_.turn[pair.a], count};
        if constexpr (features.pairs) {
            if (directions.moves_b) {
                const Turned b{directions.angular_b, velocities_.turn[pair.b], count};
                for (int i = 0; i < pair.count; ++i) {
                    Point& point = pair.point[i];
                    const Arms arms = world_arms(pair.a, point.arm), arms_b = world_arms(pair.b, point.arm_b);
                    for (int k = first; k < count; ++k) {
                        const Levers of_a = levers_of(pair.a, arms, a, k), of_b = levers_of(pair.b, arms_b, b, k);
                        point.row[k].set(directions.linear[k], of_a.middle, directions.linear_b[k], of_b.middle);
                        set_target(point.row[k], change(pair.b, of_b) - change(pair.a, of_a));
                    }
                }
                return;
            }
        }
        const auto make = [&](auto&& arms_of) {
            for (int i = 0; i < pair.count; ++i) {
                Point& point = pair.point[i];
                const Arms arms = arms_of(point);
                for (int k = first; k < count; ++k) {
                    const Levers of_a = levers_of(pair.a, arms, a, k);
                    point.row[k].set(directions.linear[k], of_a.middle);
                    set_target(point.row[k], -change(pair.a, of_a));
                }
            }
        };
        if constexpr (features.round_shapes) {
            const CollisionShape<N>& shape = shapes_.shape(pair.a);
            const auto& turn = velocities_.turn[pair.a];
            if (!shape.is(ShapeKind::box)) {
                const RollingPoints<N> start{shape, directions.angular[0]}, middle{shape, a.middle[0]},
                    end{shape, a.end[0]};
                if (end.rolls_from(turn.later(turn.later(start.down())))) {
                    make([&](const Point& point) {
                        return Arms{middle.place_of(point.arm, start), end.place_of(point.arm, start)};
                    });
                    return;
                }
            }
        }
        make([&](const Point& point) {
            Arms arms{point.arm, point.arm};
            if constexpr (has_edges)
                if (may_shift(pair)) {
                    const Vec3<Length> by = shift(pair, point);
                    arms.middle += by;
                    arms.end = arms.middle + by;
                }
            return arms;
        });
    }
    [[nodiscard]] Arms world_arms(int b, const Vec3<Length>& arm) const requires(Velocities::bodies_turn) {
        const Vec3<Length> middle = velocities_.turn[b].later(arm);
        return {middle, velocities_.turn[b].later(middle)};
    }
    // The levers of a row about a body in the middle of the flight, and by how much they change from there to its end.
    struct Levers {
        Vec3<typename C::Lever> middle, change;
    };
    [[nodiscard]] Levers levers_of(int b, const Arms& arms, const Turned& turned, int k) const {
        const BodyWeight<N>& weight = shapes_.weights()[b];
        const auto middle = weight.levers(arms.middle, turned.middle[k]);
        return {middle, weight.levers(arms.end, turned.end[k]) - middle};
    }
    // A row acts in the middle of the flight. Its target at the end is zero along the row of then: (J + dJ) u = 0, so
    // J u = -dJ u, where the bodies' velocities without the row stand for u. `change`: dJ u of one body.
    [[nodiscard]] Speed change(int b, const Levers& levers) const {
        return C::speed(dot(levers.change, velocities_.loaded[b].angular));
    }
    static void set_target(Row<N, features.pairs>& row, Speed wanted) {
        row.target = narrow<Speed>(mul(wanted, row.inverse));
    }

    // The surface of a fixed body that turns may be much faster than the bodies.
    void make_room_for_surfaces() {
        if constexpr (N::fixed_point && features.moving_surfaces() && features.pairs)
            pairs_.for_each(island_, [&](const Pair& pair) {
                if (!pair.surface_moves) return;
                if constexpr (features.rolling_resistance)
                    for (int k = 0; k < 3 && pair.resists_spin(); ++k)
                        velocities_.scale.make_room(turntable_spin(pair, k));
                // Along a unit direction, turn x arm is below four times the product of the largest components. Most
                // surfaces are so slow that this bound suffices.
                int log2 = -1000;  // of no turn
                for (int i = 0; i < 3; ++i) {
                    const Work turn = bodies_.turn(pair.b, i);
                    if (!turn.is_zero() && turn.exponent() > log2) log2 = turn.exponent();
                }
                log2 += pair.weight.exponent() + 2 * 31 + 2;
                const bool drifts = features.kinematic && bodies_.constants[pair.b].kinematic();
                for (int i = 0; i < pair.count; ++i) {
                    if (!drifts && velocities_.scale.fits(log2 + shapes_.scale().log2(pair.point[i].arm_b))) continue;
                    for (int k = drifts ? 0 : 1; k < pair.rows(); ++k)
                        velocities_.scale.make_room(surface_speed(pair, pair.point[i], k));
                }
            });
    }
    // The velocity of a fixed body's surface along direction k of a point, as a speed of the pair: where the point is
    // when the solution is for. That is the end of the step or, of a kinematic body, after `ahead_` of it. A row of the
    // start leaves out by how much the point's own velocity turns until then, w x (w x arm), so that is taken off the
    // tangents.
    [[nodiscard]] Work surface_speed([[maybe_unused]] const Pair& pair, [[maybe_unused]] const Point& point,
                                     [[maybe_unused]] int k) const {
        if constexpr (features.moving_surfaces() && features.pairs) {
            if (!pair.surface_moves) return Work(0);
            WorkVec3<N> turn = WorkVec3<N>::Constant(Work(0)), along_arm = turn;
            // The arm of a sphere does not turn with it.
            if (!shapes_.shape(pair.a).is(ShapeKind::sphere)) {
                turn = turn_of(pair.a);
                along_arm = cross<Work>(turn, shapes_.world_arm(pair.a, point.arm));
            }
            WorkVec3<N> place = shapes_.world_arm(pair.b, point.arm_b), own = cross<Work>(turn, along_arm),
                        way = drift_of(pair.a) + along_arm;
            const bool drifts = features.kinematic && bodies_.constants[pair.b].kinematic();
            if (drifts) way -= drift_of(pair.b);
            if (drifts || turntables_ahead_) {
                way = scaled_by(way, ahead_);
                own = scaled_by(own, ahead_);
            }
            place += way;
            WorkVec3<N> surface = cross<Work>(turn_of(pair.b), place);
            if (drifts) surface += drift_of(pair.b);
            const WorkVec3<N> direction = work_unit<N>(k == 0 ? pair.normal : pair.tangent[k - 1]);
            const Work speed = dot(surface, direction);
            return (k == 0 || velocities_.turns(pair.a) ? speed : speed - dot(own, direction)) * pair.weight;
        }
        return Work(0);
    }
    // m a step.
    [[nodiscard]] WorkVec3<N> drift_of(int b) const {
        return {bodies_.drift(b, 0), bodies_.drift(b, 1), bodies_.drift(b, 2)};
    }
    // Rad a step, world.
    [[nodiscard]] WorkVec3<N> turn_of(int b) const {
        return shapes_.to_world(b, {bodies_.turn(b, 0), bodies_.turn(b, 1), bodies_.turn(b, 2)});
    }

    const NarrowPhase& shapes_;
    PairList& pairs_;
    Velocities& velocities_;
    const Bodies& bodies_;
    const Island& island_;
    [[no_unique_address]] If<features.moving_surfaces(), Work, 0> ahead_{};
    [[no_unique_address]] If<features.moving_surfaces(), bool, 3> turntables_ahead_{};
    [[no_unique_address]] If<has_edges, Work, 1> half_{};
    [[no_unique_address]] If<Pair::has_faces, bool, 2> faces_{};
};

}  // namespace tumble

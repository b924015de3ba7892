// The forces of a step between touching bodies.
#pragma once

#include <tumble/contact/statics.hpp>

namespace tumble {

// What the solution for the forces of a step has found.
enum class Touch : std::uint8_t { nothing, rests, strikes };
struct Solution {
    bool lifts = false;      // SolverVelocities::added() has a motion that corrects penetrations
    bool unchanged = false;  // nothing has changed since, and it corrects no penetration
    bool at_rest = false;    // nothing moves, and nothing will in this step
};

template <class N, Spin spin, Features features>
class Resting {
public:
    using Rows = ContactRows<N, spin, features>;
    using C = typename Rows::C;
    using Bounds = ContactBounds<N>;
    using Length = typename Rows::Length;
    using Speed = typename Rows::Speed;
    using Work = typename N::Work;
    using NarrowPhase = typename Rows::NarrowPhase;
    using Pair = typename Rows::Pair;
    using Point = typename Rows::Point;
    using PairList = typename Rows::PairList;
    using Island = typename Rows::Island;
    using Velocities = typename Rows::Velocities;
    using Velocity = typename Rows::Velocity;
    using Kicks = typename Rows::Kicks;

    Resting(const NarrowPhase& shapes, PairList& pairs, Velocities& velocities, typename NarrowPhase::Bodies& bodies,
            const Island& island)
        : shapes_{shapes}, pairs_{pairs},
          velocities_{velocities}, bodies_{bodies}, island_{island}, rows_{shapes, pairs, velocities, bodies, island} {}

    // Solves for the contact forces over a part of the step, so that no touching point approaches at its end. Writes
    // them into `forces`, as changes of motion in that part. A point strikes if it is below the surface and approaches
    // faster than NarrowPhase::slow(). The impact must then be resolved first: unless `struck`, no forces are computed.
    // `loads` have the changes of the velocities of surfaces, too. `only_at_rest`: nothing is computed unless
    // the island is at rest.
    Touch solve(const Kicks& loads, Work part, bool whole, bool struck, Coasting coasting, Kicks& forces,
                Solution& solution, [[maybe_unused]] bool only_at_rest = false) {
        if constexpr (features.moving_surfaces()) velocities_.surfaces.carry = false;
        bool any = false;
        solution = {};
        pairs_.for_each(island_, [&](const Pair& pair) { any = any || pair.count > 0; });
        if (!any) return Touch::nothing;
        const bool lifts = is_lifted();
        if constexpr (features.kinematic) rows_.look_ahead(part);
        if constexpr (Rows::has_edges)
            if (coasting == Coasting::mean) rows_.act_in_middle(part);
        const bool same = rows_.set_velocities(loads, part, whole, lifts, coasting == Coasting::mean);
        int active = 0;
        bool strikes = false;
        pairs_.for_each(island_, [&](Pair& pair) {
            if (!same || !(pair.scale == velocities_.scale)) pairs_.unbalance(pair);
            if (pair.count == 0) return;
            const bool hit = pair.is_struck() && (struck || !whole);
            pair.touched = false;
            const Speed slow = rows_.pair_speed(pair, shapes_.slow());
            rows_.make_rows(pair);
            for (int i = 0; i < pair.count; ++i) {
                Point& point = pair.point[i];
                const Speed approach = -rows_.velocity(velocities_.start, pair, point) - point.row[0].target,
                            closing = rows_.speed(pair, point, point.gap);
                const bool fast = approach > Rows::along(point, slow), above = point.gap > Length{};
                const Speed late = hit ? Bounds::late(closing) : Speed{};
                // What an impact has left over strikes in the next step.
                point.active = !(fast && (above ? approach - late > closing : struck && is_spent()));
                if (!point.active) {
                    Rows::clear_impulses(point);
                    continue;
                }
                strikes = strikes || (!above && fast);
                if (above) point.row[0].target -= closing;
                else if (!whole && coasting == Coasting::mean && bounces_off(pair, point, approach))
                    point.row[0].target += approach;
                point.row[0].target += Rows::surface_of(pair, point);
                point.for_each_row([&](auto& row) { row.impulse = velocities_.scale.from(row.impulse, pair.scale); });
                pair.touched = true;
                ++active;
            }
            pair.scale = velocities_.scale;
        });
        if (active == 0) return Touch::nothing;
        if (strikes && !struck) return Touch::strikes;
        pairs_.for_each(island_, [&](Pair& pair) { rows_.make_tangents(pair); });
        if (whole && Statics<N, spin, features>{shapes_, pairs_, velocities_, bodies_, island_}.solve(only_at_rest)) {
            velocities_.write(forces, bodies_, shapes_.weights(), island_.group, &loads);
            // What sweeps have left of the motion at the start, statics stop in this step.
            solution.at_rest = !lifts && pairs_.are_balanced(island_) && velocities_.start_at_rest(island_.group);
        } else if (features.control && only_at_rest) {
            return Touch::nothing;
        } else {
            const Speed enough = velocities_.scale.enough_at_rest();
            if (rows_.sweep_pressed(enough) > enough && !is_spent()) report_far_from_solved(enough);
            solution.at_rest = whole && !lifts && settles(enough);
            if (solution.at_rest) {
                for (int k = 0; k < island_.group.count; ++k) velocities_.stop(island_.group.id[k]);
                pairs_.set_balanced(island_, true);
            }
            velocities_.write(forces, bodies_, shapes_.weights(), island_.group, solution.at_rest ? &loads : nullptr);
        }
        pairs_.count_points(island_, shapes_.tolerance());
        solution.unchanged = true;
        if constexpr (features.moving_surfaces())
            if (velocities_.surfaces.changed) [[unlikely]]
                velocities_.surfaces.carry = coasting != Coasting::end && find_taken_along(loads, coasting);
        if (lifts) [[unlikely]] {
            if constexpr (features.sleep) solution.unchanged = is_balanced();
            solution.lifts = find_lifts();
            solution.unchanged = solution.unchanged && !solution.lifts;
        }
        if constexpr (features.moving_surfaces())
            if (velocities_.surfaces.carry) [[unlikely]]
                add_taken_along(solution);
        return Touch::rests;
    }

    // Whether a penetration is to be corrected.
    [[nodiscard]] bool is_lifted() const {
        return pairs_.any_gap(island_, [&](Length gap) { return Bounds::is_lifted(gap, shapes_.tolerance()); });
    }
    // True where the last solution is that of this step too: nothing has changed since the island was at rest, and the
    // loads are those that the forces have cancelled. `corrects`: penetrations are to be corrected.
    [[nodiscard]] bool is_unchanged(const Kicks& loads, const Kicks& forces, bool corrects) const {
        if (corrects || !pairs_.are_balanced(island_)) return false;
        for (int k = 0; k < island_.group.count; ++k) {
            const int b = island_.group.id[k];
            if (!bodies_.is_at_rest(b)) return false;
            for (int i = 0; i < 3; ++i)
                if (!(forces[b].linear[i] == -loads[b].linear[i]) || !(forces[b].angular[i] == -loads[b].angular[i]))
                    return false;
        }
        return true;
    }
    // Takes off what sweeps and rounding have left of the motion.
    void stop_all() {
        for (int k = 0; k < island_.group.count; ++k) bodies_.stop(island_.group.id[k]);
    }

    // Adds the motion that corrects penetrations to that of the bodies, or takes it off. It ends with the flight, so it
    // leaves no momentum.
    void lift(bool off) {
        for (int k = 0; k < island_.group.count; ++k) {
            const int b = island_.group.id[k];
            const Velocity& by = velocities_.added()[b];
            velocities_.add_to(bodies_, b, shapes_.weights()[b], off ? Velocity{-by.linear, -by.angular} : by);
        }
    }

    // True of an island at rest, after solve(): something fixed that does not turn holds each body, directly or through
    // others, and no body accelerates.
    [[nodiscard]] bool may_sleep(const Solution& solution) const {
        if (!solution.unchanged) return false;
        // What is unchanged is known to be balanced, and its velocities may be older than the last solution.
        return are_held() && (solution.at_rest || is_balanced());
    }

private:
    [[nodiscard]] bool is_spent() const { return velocities_.sweeps_are_spent(); }
    // Of a point at the surface after an impact: whether loads leave it above the surface at the end of the step. It
    // then comes down as fast as it left at most, so that others drive it no deeper. Stopped above the surface, a body
    // would hover.
    [[nodiscard]] bool bounces_off(const Pair& pair, const Point& point, Speed approach) const {
        return approach < Speed{} && rows_.velocity(velocities_.loaded, pair, point) > approach;
    }
    // Whether sweeps have found the forces of rest, where statics find none: each body is held, and its velocity was
    // and is what sweeps leave anyway.
    [[nodiscard]] bool settles(Speed enough) const {
        bool all = velocities_.start_at_rest(island_.group);
        for (int k = 0; k < island_.group.count; ++k)
            all = all && !(velocities_.now[island_.group.id[k]].largest() > enough);
        if constexpr (features.moving_surfaces())
            pairs_.for_each(island_, [&](const Pair& pair) { all = all && !pair.surface_moves; });
        return all && are_held();
    }
    // Whether something holds each body. Bodies that do not touch each other need one look.
    [[nodiscard]] bool are_held() const {
        bool held[features.bodies]{};
        for (bool more = true; more; more = more && features.pairs) {
            more = false;
            pairs_.for_each(island_, [&](const Pair& pair) {
                // A fixed body needs no hold.
                const bool by_b = pair.moves_b() ? held[pair.b] : !pair.surface_moves;
                if (held[pair.a] == by_b || !is_pushed(pair)) return;
                if (by_b) held[pair.a] = more = true;
                else if (pair.moves_b()) held[pair.b] = more = true;
            });
        }
        bool all = true;
        for (int k = 0; k < island_.group.count; ++k) all = all && held[island_.group.id[k]];
        return all;
    }
    // Reports a point that the forces leave approaching faster than gravity changes a speed in a step, where it so
    // comes deeper than the tolerance by the end of the step: without any force it would be slower. Reports a face that
    // the forces leave turning. Call where the sweeps ended early. `enough`: what sweeps leave anyway.
    [[gnu::noinline, gnu::cold]] void report_far_from_solved(Speed enough) {
        const Pair* found = nullptr;
        pairs_.for_each(island_, [&](const Pair& pair) {
            if (pair.count == 0) return;
            const Speed fall = Bounds::fall(rows_.pair_speed(pair, shapes_.slow()));
            for (int i = 0; i < pair.count; ++i) {
                const Point& point = pair.point[i];
                if (!point.active) continue;
                const Speed left = left_of(pair, point);
                // A point above the surface would reach it without what is left.
                const Length depth = point.gap > Length{} ? Length{} : point.gap;
                if ((left > enough && left > Rows::along(point, fall) &&
                     left > rows_.speed(pair, point, depth + shapes_.tolerance())) ||
                    turns_about(pair, point))
                    found = &pair;
            }
        });
        if (found != nullptr) bodies_.report(Issue::step_bound_hit, found->a);
    }
    // How much slower than its target a point is. Negative: it leaves the surface.
    [[nodiscard, gnu::noinline, gnu::cold]] Speed left_of(const Pair& pair, const Point& point) const {
        return point.row[0].target - Rows::surface_of(pair, point) - rows_.velocity(velocities_.now, pair, point);
    }
    // True where this point approaches another one of its face, which pushes and so should stay, by more than a step's
    // position correction. Then the face tilts from step to step, and what stands on it walks off. A face has three
    // points at least.
    [[nodiscard, gnu::noinline, gnu::cold]] bool turns_about([[maybe_unused]] const Pair& pair,
                                                             [[maybe_unused]] const Point& point) const {
        bool turns = false;
        if constexpr (Velocities::bodies_turn) {
            if (pair.count < 3) return false;
            const auto times = [](Speed s, const Point& other) {
                return tumble::Row<N, features.pairs>::product(s, other.row[0].inverse);
            };
            const Speed most = rows_.speed(pair, point, Bounds::most_lift(shapes_.tolerance()));
            for (int i = 0; i < pair.count; ++i) {
                const Point& other = pair.point[i];
                if (!other.active || !(other.row[0].impulse > Speed{})) continue;
                // Each is a velocity along its own row: over `inverse`, of the pair.
                turns = turns ||
                        times(left_of(pair, point), other) - times(left_of(pair, other), point) > times(most, other);
            }
        }
        return turns;
    }
    [[nodiscard]] Speed lift_of(const Pair& pair, const Point& point) const {
        return rows_.speed(pair, point, Bounds::lift(point.gap, shapes_.tolerance()));
    }
    // Reports a point that is deeper than the tolerance and sinks, though its penetration is corrected. `moves`: with
    // the correction. Along a row of a body that turns, a point that stays has a velocity: the target without the
    // correction.
    void report_sinking(const typename Velocities::Velocities& moves) {
        const Speed enough = velocities_.scale.enough_at_rest();
        pairs_.for_each_active(island_, [&](const Pair& pair, const Point& point) {
            const Speed stays = point.row[0].target - Rows::surface_of(pair, point) - lift_of(pair, point);
            if (point.gap + shapes_.tolerance() < Length{} && rows_.velocity(moves, pair, point) < stays - enough)
                bodies_.report(Issue::step_bound_hit, pair.a);
        });
    }
    // Finds the motion that corrects penetrations, and writes it into added(): the least at which no point sinks.
    // Friction takes no part in it, and it has no warm start. False where it is not found, as for a body squeezed
    // between fixed ones: then its points push against each other by about their corrections in every sweep. Where it
    // is found, a small part of them is left. The last two sweeps have no momentum, so that only the points themselves
    // decide.
    [[gnu::noinline, gnu::cold]] bool find_lifts() {
        const auto& group = island_.group;
        Speed largest{};
        pairs_.for_each_active(island_, [&](Pair& pair, Point& point) {
            if (point.gap > Length{}) return;
            Speed& target = point.row[0].target;
            const Speed lift = lift_of(pair, point);
            target += lift;
            if (lift > largest) largest = lift;
        });
        // The points may be less deep than the pair.
        if (!(largest > Speed{})) return false;
        // Without the correction, until the difference takes its place.
        for (int k = 0; k < group.count; ++k) velocities_.added()[group.id[k]] = velocities_.now[group.id[k]];
        pairs_.for_each_active(island_, [](Pair&, Point& point) {
            point.resting_impulse = point.row[0].impulse;
            point.row[0].impulse = Speed{};
        });
        const Speed enough = velocities_.scale.enough_at_rest();
        (void)rows_.sweep_normals(rows_.from_nothing(enough), true);
        const Speed left = rows_.sweep_normals({enough, 2}, false);
        pairs_.for_each_active(island_, [](Pair&, Point& point) { point.row[0].impulse = point.resting_impulse; });
        // Where sweeps are missing the part that is found is a step towards the solution.
        const bool solved = is_spent() || !(left > C::half(largest));
        if (!is_spent()) report_sinking(solved ? velocities_.now : velocities_.added());
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            auto& lifted = velocities_.added()[b];
            const auto& now = velocities_.now[b];
            // Without a solution nothing moves: may_sleep() finds no change.
            if (!solved) lifted = velocities_.now[b] = velocities_.start[b];
            lifted.linear = now.linear - lifted.linear;
            lifted.angular = now.angular - lifted.angular;
        }
        return solved;
    }
    // A surface whose velocity has changed moves by its new velocity from the start of the step. A contact force acts
    // half before the flight and half after it, so the body moves by the mean of its old velocity and the new one.
    // Finds the motion that is missing, and writes it into taken_along(): the least one that gives half of the change
    // to the points that the surface holds, and keeps the other points that hold. It is added before the flight and
    // taken off after it. False where there is none.
    [[gnu::noinline, gnu::cold]] bool find_taken_along(const Kicks& changes,
                                                       Coasting coasting) requires(features.moving_surfaces()) {
        bool any = false;
        pairs_.for_each(island_, [&](const Pair& pair) { any = any || !(pair.with_plane() || pair.moves_b()); });
        if (!any) return false;
        Speed largest{};
        pairs_.for_each_active(island_, [&](Pair& pair, Point& point) {
            WorkVec3<N> ahead = zero_vector<N>();
            if constexpr (features.pairs)
                if (is_on_changed(changes, pair)) ahead = rows_.change_ahead(changes, pair, point);
            for (int k = 0; k < pair.rows(); ++k) {
                const Work along = dot(ahead, work_unit<N>(k == 0 ? pair.normal : pair.tangent[k - 1]));
                Speed& missing = point.row[k].missing;
                missing = Rows::along(point.row[k], rows_.pair_speed(pair, along));
                if (coasting == Coasting::mean) missing = C::half(missing);
                const Speed size = magnitude_of(missing);
                if (size > largest) largest = size;
            }
        });
        const Speed enough = velocities_.scale.enough_at_rest();
        if (!(largest > enough)) return false;
        const Speed slack = larger_of(Bounds::held_along(largest), enough);
        guess_taken_along(changes, coasting, slack);
        auto& moves = velocities_.taken_along();
        velocities_.within_bounds(Bounds::sweeps(contact::max_impact_sweeps), enough, [&](int& left) {
            Speed most{};
            while (left > 0) {
                --left;
                most = {};
                pairs_.for_each_active(island_, [&](Pair& pair, Point& point) {
                    Velocity* const b = pair.moves_b() ? &moves[pair.b] : nullptr;
                    const Velocity* const end_b = pair.moves_b() ? &velocities_.now[pair.b] : nullptr;
                    const auto is_within = [&](int k) {
                        return !(magnitude_of(point.row[k].excess(velocities_.now[pair.a], end_b)) > slack);
                    };
                    if (!(point.row[0].impulse > Speed{}) || !is_within(0)) return;
                    const bool sticks = pair.rows() > 1 && is_within(1) && is_within(2);
                    for (int k = 0; k < (sticks ? pair.rows() : 1); ++k) {
                        auto& row = point.row[k];
                        const Speed by = row.missing - row.velocity(moves[pair.a], b), size = magnitude_of(by);
                        row.push(by, moves[pair.a], b);
                        if (size > most) most = size;
                    }
                });
                if (!(most > enough)) break;
            }
            return most;
        });
        return true;
    }
    [[nodiscard]] bool is_on_changed(const Kicks& changes, const Pair& pair) const {
        if (pair.with_plane() || pair.moves_b()) return false;
        bool any = false;
        for (int i = 0; i < 3; ++i)
            any = any || !(changes[pair.b].linear[i] == typename N::DriftSum{}) ||
                  !(changes[pair.b].angular[i] == typename N::TurnSum{});
        return any;
    }
    // The first guess: where the whole island moves with a surface that does not turn, the motion is known. In a stack,
    // sweeps alone find it slowly.
    void guess_taken_along(const Kicks& changes, Coasting coasting, Speed slack) requires(features.moving_surfaces()) {
        const auto& group = island_.group;
        const Pair* on = nullptr;
        pairs_.for_each_active(island_, [&](const Pair& pair, const Point&) {
            if (on == nullptr && is_on_changed(changes, pair)) on = &pair;
        });
        const WorkVec3<N> change = rows_.change_of_drift(changes, on->b), turn = rows_.change_of_turn(changes, on->b);
        bool as_one = !bodies_.is_turning(on->b) && dot(turn, turn) == Work(0);
        const Work most = velocities_.scale.work(slack);
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            const Work root_mass = shapes_.weights()[b].root_mass;
            const Velocity &start = velocities_.start[b], &now = velocities_.now[b];
            for (int i = 0; i < 3; ++i) {
                const Work end = bodies_.drift(on->b, i) * root_mass;
                const auto is = [&](Speed speed, Work wanted) {
                    return !(magnitude_of(velocities_.scale.work(speed) - wanted) > most);
                };
                as_one = as_one && is(now.linear[i], end) && is(start.linear[i], end - change[i] * root_mass) &&
                         is(now.angular[i], Work(0)) && is(start.angular[i], Work(0));
            }
        }
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            Velocity& moves = velocities_.taken_along()[b];
            moves.angular = Vec3<Speed>::Constant(Speed{});
            for (int i = 0; i < 3; ++i) {
                moves.linear[i] =
                    as_one ? velocities_.scale.speed(change[i] * shapes_.weights()[b].root_mass) : Speed{};
                if (coasting == Coasting::mean) moves.linear[i] = C::half(moves.linear[i]);
            }
        }
    }
    // Adds what find_taken_along() has found to the motion that corrects penetrations.
    void add_taken_along(Solution& solution) {
        for (int k = 0; k < island_.group.count; ++k) {
            const int b = island_.group.id[k];
            auto &moves = velocities_.added()[b], &taken_along = velocities_.taken_along()[b];
            if (!solution.lifts) moves = taken_along;
            else moves = {moves.linear + taken_along.linear, moves.angular + taken_along.angular};
        }
        solution.unchanged = solution.at_rest = false;
    }
    [[nodiscard]] static bool is_pushed(const Pair& pair) {
        for (int i = 0; i < pair.count; ++i)
            if (pair.point[i].row[0].impulse > Speed{}) return true;
        return false;
    }
    // True where no body accelerates: contacts cancel its loads, to rounding.
    [[nodiscard]] bool is_balanced() const {
        bool all = true;
        for (int k = 0; k < island_.group.count; ++k) {
            const int b = island_.group.id[k];
            const auto &start = velocities_.start[b], &loaded = velocities_.loaded[b], &now = velocities_.now[b];
            const auto largest_change = [&](const auto& from) {
                return WeightedVelocity<N>{now.linear - from.linear, now.angular - from.angular}.largest();
            };
            const Speed change = largest_change(start), by_contacts = largest_change(loaded);
            all = all && (!(change > Bounds::balance(by_contacts)) || !(change > velocities_.scale.rounding()));
        }
        return all;
    }

    const NarrowPhase& shapes_;
    PairList& pairs_;
    Velocities& velocities_;
    typename NarrowPhase::Bodies& bodies_;
    const Island& island_;
    Rows rows_;
};

}  // namespace tumble

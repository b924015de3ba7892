// The contacts of a world by impulses. look_around() finds the pairs that may touch within the step. press() computes
// the forces that keep touching points apart; they act through the whole step, as gravity does. World then flies the
// bodies, and the pairs are measured. If a pair is too deep, the flight is redone up to its impact, and resolve()
// resolves the impact there.
#pragma once

#include <tumble/body/stage.hpp>
#include <tumble/contact/impact_search.hpp>
#include <tumble/contact/row.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class ContactSet : public ImpactSearch<N, spin, features> {
    using Base = ImpactSearch<N, spin, features>;

public:
    using typename Base::Bodies;
    using typename Base::BodyGroup;
    using typename Base::Bounds;
    using typename Base::C;
    using typename Base::Island;
    using typename Base::Length;
    using typename Base::Pair;
    using typename Base::Speed;
    using typename Base::State;
    using typename Base::Work;

    ContactSet(Real step, const ContactSpec& spec)
        : Base(step, spec), threshold_{N::template constant<Work>(spec.restitution_threshold * step)} {}

    // Contact points of the body in the last step.
    [[nodiscard]] int count(int b) const { return touching_[b]; }

    void forget_touching(const BodyGroup& group) {
        for (int k = 0; k < group.count; ++k) touching_[group.id[k]] = 0;
    }

    // Before press(): the expected change of motion by loads over the whole step. After press(): that by contacts. The
    // spin's part has the scale of the body's spin.
    [[nodiscard]] Kick<N>& kick(int b) { return kick_[b]; }
    // Converts the kick to a scale with more halvings, or fewer.
    TUMBLE_INLINE void rescale_kick(int b, int halvings) {
        if (halvings != 0) [[unlikely]]
            halve_kick(b, halvings);
    }

    // Solves for the contact forces over a part of the step, so that no touching point approaches at its end. Writes
    // them into kick(), as changes of motion in that part. A point strikes if it is below the surface and approaches
    // faster than `slow`. The impact must then be resolved first: unless `struck`, no forces are computed. A change
    // beyond the range is reported.
    enum class Touch : std::uint8_t { nothing, presses, strikes };
    Touch press(Bodies& bodies, const Island& island, Work part, bool whole, bool struck) {
        bool any = false;
        for_each_pair(island, [&](Pair& pair) {
            pair.passed = false;
            if (pair.count == 0) pair.touched = false;
            pair.start_gap = pair.gap;
            if constexpr (features.pairs) pair.start_normal = pair.normal;
            any = any || pair.count > 0;
        });
        if (!any) return Touch::nothing;
        weigh(bodies, island, part, whole);
        int active = 0;
        bool strikes = false;
        for_each_pair(island, [&](Pair& pair) {
            if (pair.count == 0) return;
            const bool hit = pair.touched && (struck || !whole);
            pair.touched = false;
            const Speed slow = pair_speed(pair, slow_);
            make_rows(bodies, pair);
            for (int i = 0; i < pair.count; ++i) {
                auto& point = pair.point[i];
                const Speed approach = -velocity(start_, pair, point), closing = speed(pair, point, point.gap);
                const bool fast = approach > along(point, slow), above = point.gap > Length{};
                const Speed late = hit ? Bounds::late(closing) : Speed{};
                point.active = !(above && fast && approach - late > closing);
                if (!point.active) {
                    for (Speed& pushed : point.pushed) pushed = Speed{};
                    continue;
                }
                strikes = strikes || (!above && fast);
                point.target = above ? -closing : correction(pair, point);
                for (Speed& pushed : point.pushed) pushed = speeds_.from(pushed, pair.scale);
                pair.touched = true;
                ++active;
            }
            pair.scale = speeds_;
        });
        if (active == 0) return Touch::nothing;
        if (strikes && !struck) return Touch::strikes;
        for_each_active(island, [&](Pair& pair, auto& point) { push_all(pair, point); });
        sweep(island, speeds_.enough_at_rest(), contact::max_sweeps);
        for (int k = 0; k < island.group.count; ++k) {
            const int b = island.group.id[k];
            const CollisionShape<N>& shape = shape_[b];
            Kick<N>& kick = kick_[b];
            bool within = true;
            for (int i = 0; i < 3; ++i) {
                kick.linear[i] = C::template as<typename N::DriftSum>(
                    speeds_.sum(motion_[b].linear[i] - loaded_[b].linear[i], C::drift_bits(bodies.scale),
                                shape.per_root_mass, within));
                kick.angular[i] = C::template as<typename N::TurnSum>(
                    speeds_.sum(motion_[b].angular[i] - loaded_[b].angular[i], C::turn_bits(bodies.spin_scale(b)),
                                shape.per_weight[i], within));
            }
            if (!within) [[unlikely]]
                bodies.report(Issue::range_left, b);
        }
        count_points(island);
        return Touch::presses;
    }

    // True where the island touches something, and touches no fixed body that turns.
    [[nodiscard]] bool presses(const Island& island) const {
        bool any = false, turns = false;
        for_each_pair(island, [&](const Pair& pair) {
            any = any || pair.count > 0;
            turns = turns || (pair.count > 0 && pair.turns);
        });
        return any && !turns;
    }

    // Solves the impact of the island as it is measured. With restitution, one pair after another bounces by itself, as
    // an impact passes through a row of balls. Then all pairs together stop the points that still approach. With `stop`
    // nothing bounces.
    void resolve(Bodies& bodies, const Island& island, bool stop) {
        this->find(bodies, island);
        weigh(bodies, island, Work(1), true);
        int active = 0;
        const Length hit = Bounds::largest_impact_gap(tolerance_);
        for_each_pair(island, [&](Pair& pair) {
            pair.touched = pair.count > 0 && !(pair.gap > hit);
            for (int i = 0; i < pair.count; ++i) pair.point[i].active = pair.touched;
            if (!pair.touched) return;
            pair.scale = speeds_;
            make_rows(bodies, pair);
            for (int i = 0; i < pair.count; ++i) {
                auto& point = pair.point[i];
                // Change of the approach speed by the loads in a step.
                point.loads = magnitude_of(velocity(motion_, pair, point) - velocity(start_, pair, point));
                ++active;
            }
        });
        if (active == 0) return;
        for (int k = 0; k < island.group.count; ++k) motion_[island.group.id[k]] = start_[island.group.id[k]];
        bool bounced = !stop;
        for (int round = 0; bounced && round < contact::max_rounds; ++round) {
            bounced = false;
            for_each_pair(island, [&](Pair& pair) {
                if (pair.touched && collide(pair)) bounced = true;
            });
        }
        if (bounced || stop) [[unlikely]]
            report_cut_off(bodies, island);
        for_each_active(island, [&](Pair& pair, auto& point) {
            point.target = point.gap > Length{} ? -speed(pair, point, point.gap) : Speed{};
            for (Speed& p : point.pushed) p = Speed{};
        });
        for (int k = 0; k < island.group.count; ++k) loaded_[island.group.id[k]] = motion_[island.group.id[k]];
        sweep(island, speeds_.enough_in_impact(), contact::max_impact_sweeps);
        // Each impulse is applied once, not in one part per sweep: this rounds less.
        for (int k = 0; k < island.group.count; ++k) motion_[island.group.id[k]] = loaded_[island.group.id[k]];
        for_each_active(island, [&](Pair& pair, auto& point) { push_all(pair, point); });
        for (int k = 0; k < island.group.count; ++k) {
            const int b = island.group.id[k];
            const CollisionShape<N>& shape = shape_[b];
            for (int i = 0; i < 3; ++i) {
                const Speed linear = motion_[b].linear[i] - start_[b].linear[i];
                N::add_any(bodies.state[b].d_w[i], speeds_.work(linear) * shape.per_root_mass, bodies.scale);
            }
            const int halvings = bodies.halvings_of(b);
            bodies.change_spin(b, [&](auto& t_b, typename N::Scale unit) {
                for (int i = 0; i < 3; ++i) {
                    const Speed angular = motion_[b].angular[i] - start_[b].angular[i];
                    N::add_any(t_b[i], speeds_.work(angular) * shape.per_weight[i], unit);
                }
            });
            rescale_kick(b, bodies.halvings_of(b) - halvings);
        }
        count_points(island);
        // The impulses of an impact are no warm start for the forces of the next step.
        for_each_active(island, [&](Pair&, auto& point) {
            for (Speed& p : point.pushed) p = Speed{};
        });
    }

private:
    [[gnu::noinline, gnu::cold]] void halve_kick(int b, int halvings) {
        for (auto& change : kick_[b].angular) change = N::halved(change, halvings);
    }
    using Rows = Solver<N, features>;
    using Motion = WeightedMotion<N>;
    using Point = ContactPoint<N, features>;
    using Base::axes_;
    using Base::for_each_pair;
    using Base::moves_b;
    using Base::pair_;
    using Base::place;
    using Base::scale;
    using Base::shape_;
    using Base::slow_;
    using Base::tolerance_;
    using Base::touching_;
    using Base::view_of;

    template <class F>
    void for_each_active(const Island& island, F&& f) {
        for_each_pair(island, [&](Pair& pair) {
            for (int i = 0; i < pair.count; ++i)
                if (pair.point[i].active) f(pair, pair.point[i]);
        });
    }

    // Sets the bodies' weighted motions, all in one scale: start_ as they are, motion_ and loaded_ with `part` of the
    // change by loads in kick().
    void weigh(const Bodies& bodies, const Island& island, Work part, bool whole) {
        const BodyGroup& group = island.group;
        const int drift_bits = C::drift_bits(bodies.scale);
        auto largest = C::nothing();
        // Calls f(now, with loads, the sum now, the loads' change, its fraction bits, its weight) for each component.
        const auto for_each_component = [&](auto&& f) {
            for (int k = 0; k < group.count; ++k) {
                const int b = group.id[k];
                const CollisionShape<N>& shape = shape_[b];
                const State& s = bodies.state[b];
                const int spin_bits = C::turn_bits(bodies.spin_scale(b));
                for (int i = 0; i < 3; ++i) {
                    f(start_[b].linear[i], motion_[b].linear[i], C::raw(N::sum(s.d_w[i])), C::raw(kick_[b].linear[i]),
                      drift_bits, shape.root_mass);
                    f(start_[b].angular[i], motion_[b].angular[i], C::raw(N::sum(s.t_b[i])),
                      C::raw(kick_[b].angular[i]), spin_bits, shape.weight[i]);
                }
            }
        };
        for_each_component([&](Speed&, Speed&, auto now, auto load, int bits, Work weight) {
            const auto note = [&](auto size) {
                if (size > largest) largest = size;
            };
            note(C::size(now, bits, weight));
            note(C::size(load, bits, weight));
        });
        // The root of the mass ratio, as a power of two. Several bodies need one bit more.
        int heaviest = C::log2(shape_[group.id[0]].root_mass), lightest = heaviest;
        for (int k = 1; k < group.count; ++k) {
            const int log2 = C::log2(shape_[group.id[k]].root_mass);
            if (log2 > heaviest) heaviest = log2;
            if (log2 < lightest) lightest = log2;
        }
        speeds_ = C::SpeedScale::of(largest, group.count, heaviest - lightest + (group.count > 1 ? 2 : 0));
        make_room_for_surfaces(bodies, island);
        const typename N::Unit fraction = whole ? C::one() : C::unit(part);
        for_each_component([&](Speed& start, Speed& end, auto now, auto load, int bits, Work weight) {
            start = speeds_.speed(now, bits, weight);
            end = speeds_.speed(load, bits, weight);
            if (!whole) end = narrow<Speed>(mul(end, fraction));
            end += start;
        });
        for (int k = 0; k < group.count; ++k) loaded_[group.id[k]] = motion_[group.id[k]];
    }
    // The surface of a fixed body that turns may be much faster than the bodies.
    void make_room_for_surfaces([[maybe_unused]] const Bodies& bodies, [[maybe_unused]] const Island& island) {
        if constexpr (N::fixed_point && features.turntables && features.pairs && features.friction)
            for_each_pair(island, [&](const Pair& pair) {
                if (!pair.turns) return;
                // Along a unit direction, turn x arm is below four times the product of the largest components. Most
                // surfaces are so slow that this bound suffices.
                int log2 = -1000;  // of no turn
                for (int i = 0; i < 3; ++i) {
                    const Work turn = bodies.turn(pair.b, i);
                    if (!turn.is_zero() && turn.exponent() > log2) log2 = turn.exponent();
                }
                log2 += pair.weight.exponent() + 2 * 31 + 2;
                for (int i = 0; i < pair.count; ++i) {
                    if (speeds_.holds(log2 + scale().log2(pair.point[i].arm_b))) continue;
                    for (int k = 1; k < Rows::rows(pair); ++k)
                        speeds_.make_room(surface_speed(bodies, pair, pair.point[i], k));
                }
            });
    }
    [[nodiscard]] Motion* other_motion(const Pair& pair) { return moves_b(pair) ? &motion_[pair.b] : nullptr; }
    // Makes the rows of a pair's points anew where these or the bodies have moved.
    void make_rows([[maybe_unused]] const Bodies& bodies, Pair& pair) {
        bool hold = true;
        for (int i = 0; i < pair.count; ++i) hold = hold && pair.point[i].rows_hold;
        if (!hold) {
            const typename Rows::Directions directions{pair, axes_[pair.a], moves_b(pair) ? &axes_[pair.b] : nullptr};
            for (int i = 0; i < pair.count; ++i) {
                Point& point = pair.point[i];
                if (point.rows_hold) continue;
                for (int k = 0; k < Rows::rows(pair); ++k)
                    Rows::make_row(point.row[k], point, directions, k, shape_[pair.a],
                                   moves_b(pair) ? &shape_[pair.b] : nullptr);
                point.rows_hold = true;
            }
        }
        if constexpr (features.turntables && features.friction) {
            for (int i = 0; i < pair.count; ++i)
                for (int k = 1; k < Rows::rows(pair); ++k)
                    pair.point[i].carried[k] = narrow<Speed>(mul(
                        speeds_.speed(surface_speed(bodies, pair, pair.point[i], k)), pair.point[i].row[k].inverse));
        }
    }
    [[nodiscard]] Speed velocity(const Motion (&motion)[features.bodies], const Pair& pair, const Point& point) const {
        return Rows::velocity(point.row[0], motion[pair.a], moves_b(pair) ? &motion[pair.b] : nullptr);
    }
    // A length per step along the pair's normal, as a speed along the point's row.
    [[nodiscard]] Speed speed(const Pair& pair, const Point& point, Length per_step) const {
        return narrow<Speed>(mul(speeds_.speed(per_step, pair.weight, scale()), point.row[0].inverse));
    }
    // A length in m per step along the pair's normal, as a speed of the pair.
    [[nodiscard]] Speed pair_speed(const Pair& pair, Work per_step) const {
        return speeds_.speed(per_step * pair.weight);
    }
    [[nodiscard]] static Speed along(const Point& point, Speed of_pair) {
        return narrow<Speed>(mul(of_pair, point.row[0].inverse));
    }
    // The velocity of a turning fixed body's surface along direction k of a point, as a speed of the pair.
    [[nodiscard]] Work surface_speed([[maybe_unused]] const Bodies& bodies, [[maybe_unused]] const Pair& pair,
                                     [[maybe_unused]] const Point& point, [[maybe_unused]] int k) const {
        if constexpr (features.turntables && features.pairs && features.friction) {
            if (!pair.turns) return Work(0);
            const int b = pair.b;
            WorkVec3<N> turn, arm, direction;
            const Vec3<typename N::Unit> direction_b = axes_[b].to_body(pair.tangent[k - 1]);
            for (int i = 0; i < 3; ++i) {
                turn[i] = bodies.turn(b, i);
                arm[i] = scale().metres(point.arm_b[i]);
                direction[i] = N::work(direction_b[i]);
            }
            return dot(cross<Work>(turn, arm), direction) * pair.weight;
        }
        return Work(0);
    }
    // Position correction: an eighth of the penetration beyond tolerance / 4 per step, at most tolerance / 8.
    [[nodiscard]] Speed correction(const Pair& pair, const Point& point) const {
        const Length excess = -point.gap - Bounds::resting_depth(tolerance_);
        if (!(excess > Length{})) return Speed{};
        Length lift = Bounds::correction(excess);
        const Length most = Bounds::most_correction(tolerance_);
        if (lift > most) lift = most;
        return speed(pair, point, lift);
    }
    // True of an approach that bounces: it is faster than the scene's threshold, and the bounce lasts longer than an
    // eighth of a step under the loads.
    [[nodiscard]] bool bounces(const Pair& pair, const Point& point, Speed approach, Speed loads) const {
        if (!(approach > speeds_.enough_at_rest())) return false;
        const Speed bounce = narrow<Speed>(mul(approach, pair.restitution));
        if (!Bounds::bounce_lasts(bounce, loads)) return false;
        if (!(threshold_ > Work(0))) return true;
        return !(approach < along(point, pair_speed(pair, threshold_)));
    }
    // True if it is an error to leave out a bounce: it is faster than the change of speed by all loads in a step, and
    // faster than a resting point, which is twice gravity's change. A slower bounce returns no faster than it left, and
    // press() then holds it: without the bounce the body comes to rest a few steps earlier. A pile that comes to rest
    // has infinitely many such bounces in finite time, and a shorter step makes them no fewer.
    [[nodiscard]] bool bounces_far(const Pair& pair, const Point& point) const {
        const Speed approach = -velocity(motion_, pair, point);
        const Speed bounce = narrow<Speed>(mul(approach, pair.restitution));
        return bounces(pair, point, approach, point.loads) && bounce > point.loads &&
               bounce > along(point, pair_speed(pair, slow_));
    }
    [[gnu::noinline]] void report_cut_off(Bodies& bodies, const Island& island) {
        for_each_active(island, [&](Pair& pair, Point& point) {
            if (bounces_far(pair, point)) bodies.report(Issue::step_bound_hit, pair.a);
        });
    }
    void push_all(const Pair& pair, const Point& point) {
        for (int k = 0; k < Rows::rows(pair); ++k)
            if (!(point.pushed[k] == Speed{}))
                Rows::push(point.row[k], point.pushed[k], motion_[pair.a], other_motion(pair));
    }
    // Solves the impact of one pair by itself. False where no point of it bounces.
    bool collide(Pair& pair) {
        bool any = false;
        for (int i = 0; i < pair.count; ++i) {
            const Point& point = pair.point[i];
            any = any || bounces(pair, point, -velocity(motion_, pair, point), point.loads);
        }
        if (!any) return false;
        // Where one point bounces, all do: rounding must not turn a body that lands flat.
        for (int i = 0; i < pair.count; ++i) {
            Point& point = pair.point[i];
            const Speed approach = -velocity(motion_, pair, point);
            for (Speed& p : point.pushed) p = Speed{};
            point.target = point.gap > Length{} ? -speed(pair, point, point.gap) : Speed{};
            if (approach > Speed{}) point.target = narrow<Speed>(mul(approach, pair.restitution));
        }
        const Motion a = motion_[pair.a], b = moves_b(pair) ? motion_[pair.b] : a;
        for (int sweep = 0; sweep < contact::max_impact_sweeps; ++sweep) {
            Speed most{};
            for (int i = 0; i < pair.count; ++i)
                Rows::visit(pair, pair.point[i], motion_[pair.a], other_motion(pair), most);
            if (!(most > speeds_.enough_in_impact())) break;
        }
        motion_[pair.a] = a;
        if (moves_b(pair)) motion_[pair.b] = b;
        for (int i = 0; i < pair.count; ++i) push_all(pair, pair.point[i]);
        return true;
    }
    // Sweeps over the points until no impulse changes by more than `enough`, at most `bound` times. The change of a
    // sweep counts as the gradient of a function that is least at the solution. The next sweep starts with a step along
    // it, as conjugate gradients do (Silcowitz, Niebe and Erleben 2010). Plain sweeps carry a load through a stack by
    // one box per sweep. The momentum is the ratio of the squares of the largest changes, at most 1. It restarts from 0
    // where these grow by more than an eighth.
    void sweep(const Island& island, Speed enough, int bound) {
        Speed last{};
        typename N::Unit momentum{};
        for (int sweep = 0; sweep < bound; ++sweep) {
            if (sweep > 0) go_on(island, momentum);
            Speed most{};
            for_each_active(island, [&](Pair& pair, Point& point) {
                for (int k = 0; k < Rows::rows(pair); ++k) point.before[k] = point.pushed[k];
                Rows::visit(pair, point, motion_[pair.a], other_motion(pair), most);
            });
            if (!(most > enough)) break;
            if (sweep == 0 || Bounds::diverges(most, last)) {
                momentum = {};
            } else {
                const typename N::Unit ratio = most < last ? C::ratio(most, last) : C::one();
                momentum = C::product(ratio, ratio);
            }
            last = most;
        }
    }
    void go_on(const Island& island, typename N::Unit momentum) {
        for_each_active(island, [&](Pair& pair, Point& point) {
            for (int k = 0; k < Rows::rows(pair); ++k) {
                const Speed changed = point.pushed[k] - point.before[k];
                const Speed further =
                    momentum == typename N::Unit{} ? Speed{} : narrow<Speed>(mul(point.course[k], momentum));
                point.course[k] = changed + further;
                if (further == Speed{}) continue;
                point.pushed[k] += further;
                Rows::push(point.row[k], further, motion_[pair.a], other_motion(pair));
            }
        });
    }
    void count_points(const Island& island) {
        for (int k = 0; k < island.group.count; ++k) touching_[island.group.id[k]] = 0;
        for_each_active(island, [&](Pair& pair, Point&) {
            ++touching_[pair.a];
            if (moves_b(pair)) ++touching_[pair.b];
        });
    }

    Work threshold_;  // of restitution, m a step
    typename C::SpeedScale speeds_{};
    Motion start_[features.bodies]{}, motion_[features.bodies]{}, loaded_[features.bodies]{};
    Kick<N> kick_[features.bodies]{};
};

}  // namespace tumble

// The contacts of a world by impulses. A step with contacts: pairs that could touch within it are found (look_around);
// what is in touch already is given the forces that keep it apart, which act through the whole step as gravity does
// (press); after the flight the pairs are measured, and where one has come too deep the flight is redone to the moment
// of its impact, which is resolved there (resolve). World does the flying.
#pragma once

#include <tumble/body/stage.hpp>
#include <tumble/contact/broad_phase.hpp>
#include <tumble/contact/row.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class ContactSet : public Surroundings<N, spin, features> {
    using Base = Surroundings<N, spin, features>;

public:
    using typename Base::Bodies;
    using typename Base::Length;
    using typename Base::Numbers;
    using typename Base::Pair;
    using typename Base::Speed;
    using typename Base::State;
    using typename Base::Work;
    using Unit = tumble::Unit<features.bodies>;

    ContactSet(Real step, const ContactSpec& spec)
        : Base(step, spec), threshold_{N::template constant<Work>(spec.restitution_threshold * step)} {}

    // Contact points of the body in the last step.
    [[nodiscard]] int count(int b) const { return touching_[b]; }

    // One island's part of a step.
    struct Island {
        const Unit& unit;
        int root;        // its first body
        int first_pair;  // -1: none is near
    };
    void forget_touching(const Unit& unit) {
        for (int k = 0; k < unit.count; ++k) touching_[unit.id[k]] = 0;
    }

    // What the loads will change in the whole step, foreseen; press() replaces it by what the contacts push.
    [[nodiscard]] Kick<N>& kick(int b) { return kick_[b]; }

    // The forces of the points in touch over a part of the step, such that at its end nothing approaches that touches:
    // as changes of motion in that part, in kick(). Where a point strikes (it is below the surface and comes faster
    // than what rests may), nothing is pressed unless `struck`: that is an impact, to be resolved first.
    enum class Touch : std::uint8_t { nothing, presses, strikes };
    Touch press(const Bodies& bodies, const Island& island, Work part, bool whole, bool struck) {
        bool any = false;
        for_each_pair(island, [&](Pair& pair) {
            pair.touched = pair.passed = false;
            pair.start_gap = pair.gap;
            if constexpr (features.pairs) pair.start_normal = pair.normal;
            any = any || pair.count > 0;
        });
        if (!any) return Touch::nothing;
        weigh(bodies, island.unit, part, whole);
        int active = 0;
        bool strikes = false;
        for_each_pair(island, [&](Pair& pair) {
            if (pair.count == 0) return;
            const Speed slow = pair_speed(pair, slow_);
            make_rows(bodies, pair);
            for (int i = 0; i < pair.count; ++i) {
                auto& point = pair.point[i];
                const Speed approach = -velocity(start_, pair, point), closing = speed(pair, point, point.gap);
                const bool fast = approach > along(point, slow), above = point.gap > Length{};
                point.active = !(above && fast && approach > closing);
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
        for (int k = 0; k < island.unit.count; ++k) {
            const int b = island.unit.id[k];
            const ContactShape<N>& shape = shape_[b];
            Kick<N>& kick = kick_[b];
            for (int i = 0; i < 3; ++i) {
                kick.linear[i] = Numbers::template as<typename N::DriftSum>(
                    speeds_.sum(motion_[b].linear[i] - loaded_[b].linear[i], Numbers::drift_bits(bodies.scale),
                                shape.per_root_mass));
                kick.angular[i] = Numbers::template as<typename N::TurnSum>(
                    speeds_.sum(motion_[b].angular[i] - loaded_[b].angular[i], Numbers::turn_bits(bodies.scale),
                                shape.per_weight[i]));
            }
        }
        count_points(island);
        return Touch::presses;
    }

    // Where the bodies of the island and its pairs are now.
    void measure(const Bodies& bodies, const Island& island) {
        for (int k = 0; k < island.unit.count; ++k) place(bodies, island.unit.id[k]);
        for_each_pair(island, [&](Pair& pair) { measure(bodies, pair); });
    }
    // The points of the pairs as they are measured.
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
    // Seeks the impacts of the pairs that have come below their level: others, which rest beside them, would mislead
    // the search.
    void seek(const Island& island) {
        for_each_pair(island, [&](Pair& pair) { pair.sought = pair.gap < level(pair); });
    }
    // Has a pair come deeper than is allowed at the end of a flight?
    [[nodiscard]] bool is_too_deep(const Island& island) const {
        bool deep = false;
        for_each_pair(island, [&](const Pair& pair) {
            Length limit{};
            if (pair.start_gap < Length{}) limit = pair.start_gap - tolerance_;
            else if (pair.touched) limit = -tolerance_;
            deep = deep || pair.gap < limit;
        });
        return deep;
    }
    // Does the island rest on something, which does not turn?
    [[nodiscard]] bool presses(const Island& island) const {
        bool any = false, turns = false;
        for_each_pair(island, [&](const Pair& pair) {
            any = any || pair.count > 0;
            turns = turns || (pair.count > 0 && pair.turns);
        });
        return any && !turns;
    }

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
    // Of the flight from now to its end, the part that surely leaves the pair apart: until the separation along the
    // direction of now runs out. Negative: all of it.
    [[nodiscard]] Work part_apart(const Crossing& crossing) const {
        const Pair& pair = *crossing.pair;
        const PairView<N> end{shape_[pair.a], shape_[pair.b], crossing.a, crossing.b, crossing.reach};
        const Length left = end.separation(pair.normal, features.boxes);
        if (!(left < -tolerance_)) return Work(-1);
        if (!(pair.gap > Length{})) return Work(0);
        const Work gap = scale().metres(pair.gap);
        return gap / (gap - scale().metres(left));
    }
    // Near enough to its impact, at the least.
    [[nodiscard]] bool is_close(const Crossing& crossing) const {
        return !(crossing.pair->gap > Numbers::sixteenth(Numbers::sixteenth(tolerance_)));
    }

    // Impulses at the points of the island as they are measured. Where an impact comes with restitution, pair after
    // pair bounces by itself, as it passes through a row of balls; then what still approaches is stopped by all
    // together. `stop`: nothing bounces.
    void resolve(Bodies& bodies, const Island& island, bool stop) {
        find(bodies, island);
        weigh(bodies, island.unit, Work(1), true);
        int active = 0;
        const Length hit = Numbers::half(Numbers::half(tolerance_));
        for_each_pair(island, [&](Pair& pair) {
            // What is above the surface is on its way, to an impact of its own.
            pair.touched = pair.count > 0 && !(pair.gap > hit);
            for (int i = 0; i < pair.count; ++i) pair.point[i].active = pair.touched;
            if (!pair.touched) return;
            pair.scale = speeds_;
            make_rows(bodies, pair);
            for (int i = 0; i < pair.count; ++i) {
                auto& point = pair.point[i];
                // Held here until the pair's turn: what loads change in a step.
                point.loads = magnitude_of(velocity(motion_, pair, point) - velocity(start_, pair, point));
                ++active;
            }
        });
        if (active == 0) return;
        for (int k = 0; k < island.unit.count; ++k) motion_[island.unit.id[k]] = start_[island.unit.id[k]];
        bool bounced = !stop;
        for (int round = 0; bounced && round < contact::max_rounds; ++round) {
            bounced = false;
            for_each_pair(island, [&](Pair& pair) {
                if (pair.touched && collide(pair)) bounced = true;
            });
        }
        if (bounced && !stop) bodies.report(Issue::step_bound_hit, island.root);
        for_each_active(island, [&](Pair& pair, auto& point) {
            point.target = point.gap > Length{} ? -speed(pair, point, point.gap) : Speed{};
            if (stop && bounces(pair, point, -velocity(motion_, pair, point), point.loads) &&
                narrow<Speed>(mul(-velocity(motion_, pair, point), pair.restitution)) >
                    along(point, pair_speed(pair, slow_)))
                bodies.report(Issue::step_bound_hit, pair.a);
            for (Speed& p : point.pushed) p = Speed{};
        });
        for (int k = 0; k < island.unit.count; ++k) loaded_[island.unit.id[k]] = motion_[island.unit.id[k]];
        sweep(island, speeds_.enough_in_impact(), contact::max_impact_sweeps);
        // Each impulse once instead of in as many parts as there were sweeps: so much less is rounded.
        for (int k = 0; k < island.unit.count; ++k) motion_[island.unit.id[k]] = loaded_[island.unit.id[k]];
        for_each_active(island, [&](Pair& pair, auto& point) { push_all(pair, point); });
        for (int k = 0; k < island.unit.count; ++k) {
            const int b = island.unit.id[k];
            const ContactShape<N>& shape = shape_[b];
            for (int i = 0; i < 3; ++i) {
                const Speed linear = motion_[b].linear[i] - start_[b].linear[i],
                            angular = motion_[b].angular[i] - start_[b].angular[i];
                N::add_any(bodies.state[b].d_w[i], speeds_.work(linear) * shape.per_root_mass, bodies.scale);
                N::add_any(bodies.state[b].t_b[i], speeds_.work(angular) * shape.per_weight[i], bodies.scale);
            }
        }
        count_points(island);
        // The impulses of an impact are no guess for the forces of the next step.
        for_each_active(island, [&](Pair&, auto& point) {
            for (Speed& p : point.pushed) p = Speed{};
        });
    }

private:
    using Rows = Solver<N, features>;
    using Motion = WeightedMotion<N>;
    using Point = ContactPoint<N, features>;
    using Base::axes_;
    using Base::find;
    using Base::measure;
    using Base::moves_b;
    using Base::pair_;
    using Base::place;
    using Base::scale;
    using Base::shape_;
    using Base::slow_;
    using Base::tolerance_;
    using Base::touching_;
    using Base::view_of;

    // Where the search for an impact ends.
    [[nodiscard]] Length level(const Pair& pair) const {
        const Length half = Numbers::half(tolerance_);
        if (pair.start_gap < Length{}) return pair.start_gap - half;
        return pair.touched ? -half : Length{};
    }

    template <class F>
    void for_each_pair(const Island& island, F&& f) {
        for (int i = island.first_pair; i >= 0; i = pair_[i].next) f(pair_[i]);
    }
    template <class F>
    void for_each_pair(const Island& island, F&& f) const {
        for (int i = island.first_pair; i >= 0; i = pair_[i].next) f(pair_[i]);
    }
    template <class F>
    void for_each_active(const Island& island, F&& f) {
        for_each_pair(island, [&](Pair& pair) {
            for (int i = 0; i < pair.count; ++i)
                if (pair.point[i].active) f(pair, pair.point[i]);
        });
    }

    // The bodies' weighted motions: start_ as they are, motion_ and loaded_ with the part of the loads' change that is
    // in kick(). All in one scale.
    void weigh(const Bodies& bodies, const Unit& unit, Work part, bool whole) {
        const int drift_bits = Numbers::drift_bits(bodies.scale), turn_bits = Numbers::turn_bits(bodies.scale);
        auto largest = Numbers::nothing();
        // Calls f(now, with loads, the sum now, the loads' change, its fraction bits, its weight) for each component.
        const auto for_each_component = [&](auto&& f) {
            for (int k = 0; k < unit.count; ++k) {
                const int b = unit.id[k];
                const ContactShape<N>& shape = shape_[b];
                const State& s = bodies.state[b];
                for (int i = 0; i < 3; ++i) {
                    f(start_[b].linear[i], motion_[b].linear[i], Numbers::raw(N::sum(s.d_w[i])),
                      Numbers::raw(kick_[b].linear[i]), drift_bits, shape.root_mass);
                    f(start_[b].angular[i], motion_[b].angular[i], Numbers::raw(N::sum(s.t_b[i])),
                      Numbers::raw(kick_[b].angular[i]), turn_bits, shape.weight[i]);
                }
            }
        };
        for_each_component([&](Speed&, Speed&, auto now, auto load, int bits, Work weight) {
            const auto note = [&](auto size) {
                if (size > largest) largest = size;
            };
            note(Numbers::size(now, bits, weight));
            note(Numbers::size(load, bits, weight));
        });
        // Root of a mass over another's: as a power of two, and one more for many bodies.
        int heaviest = Numbers::log2(shape_[unit.id[0]].root_mass), lightest = heaviest;
        for (int k = 1; k < unit.count; ++k) {
            const int log2 = Numbers::log2(shape_[unit.id[k]].root_mass);
            if (log2 > heaviest) heaviest = log2;
            if (log2 < lightest) lightest = log2;
        }
        speeds_ = Numbers::SpeedScale::of(largest, unit.count, heaviest - lightest + (unit.count > 1 ? 2 : 0));
        const typename N::Unit fraction = whole ? Numbers::one() : Numbers::unit(part);
        for_each_component([&](Speed& start, Speed& end, auto now, auto load, int bits, Work weight) {
            start = speeds_.speed(now, bits, weight);
            end = speeds_.speed(load, bits, weight);
            if (!whole) end = narrow<Speed>(mul(end, fraction));
            end += start;
        });
        for (int k = 0; k < unit.count; ++k) loaded_[unit.id[k]] = motion_[unit.id[k]];
    }
    [[nodiscard]] Motion* other_motion(const Pair& pair) { return moves_b(pair) ? &motion_[pair.b] : nullptr; }
    // The rows of a pair's points, where they do not hold any more.
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
                    pair.point[i].carried[k] = surface_speed(bodies, pair, pair.point[i], k);
        }
    }
    [[nodiscard]] Speed velocity(const Motion (&motion)[features.bodies], const Pair& pair, const Point& point) const {
        return Rows::velocity(point.row[0], motion[pair.a], moves_b(pair) ? &motion[pair.b] : nullptr);
    }
    // A length of a step along the pair's normal as a speed along the point's row.
    [[nodiscard]] Speed speed(const Pair& pair, const Point& point, Length per_step) const {
        return narrow<Speed>(mul(speeds_.speed(per_step, pair.weight, scale()), point.row[0].inverse));
    }
    // A distance of a step along the pair's normal, m.
    [[nodiscard]] Speed pair_speed(const Pair& pair, Work per_step) const {
        return speeds_.speed(per_step * pair.weight);
    }
    [[nodiscard]] static Speed along(const Point& point, Speed of_pair) {
        return narrow<Speed>(mul(of_pair, point.row[0].inverse));
    }
    // The velocity of a turning fixed body's surface along direction k of a point.
    [[nodiscard]] Speed surface_speed([[maybe_unused]] const Bodies& bodies, [[maybe_unused]] const Pair& pair,
                                      [[maybe_unused]] const Point& point, [[maybe_unused]] int k) const {
        if constexpr (features.turntables && features.pairs && features.friction) {
            if (!pair.turns) return Speed{};
            const int b = pair.b;
            WorkVec3<N> turn, arm, direction;
            const Vec3<typename N::Unit> direction_b = axes_[b].to_body(pair.tangent[k - 1]);
            for (int i = 0; i < 3; ++i) {
                turn[i] = bodies.turn(b, i);
                arm[i] = scale().metres(point.arm_b[i]);
                direction[i] = N::work(direction_b[i]);
            }
            return narrow<Speed>(
                mul(speeds_.speed(dot(cross<Work>(turn, arm), direction) * pair.weight), point.row[k].inverse));
        }
        return Speed{};
    }
    // A speed at which a point below the surface leaves it by and by: an eighth of what it is deeper than a quarter of
    // the tolerance in each step, at most an eighth of the tolerance.
    [[nodiscard]] Speed correction(const Pair& pair, const Point& point) const {
        const Length excess = -point.gap - Numbers::half(Numbers::half(tolerance_));
        if (!(excess > Length{})) return Speed{};
        Length lift = Numbers::eighth(excess);
        const Length most = Numbers::eighth(tolerance_);
        if (lift > most) lift = most;
        return speed(pair, point, lift);
    }
    // Does an approach bounce? Unless the scene's threshold forbids it, or the bounce would be over within an eighth of
    // a step, because the loads bring it back that soon.
    [[nodiscard]] bool bounces(const Pair& pair, const Point& point, Speed approach, Speed loads) const {
        if (!(approach > speeds_.enough_at_rest())) return false;
        const Speed bounce = narrow<Speed>(mul(approach, pair.restitution));
        if (!(bounce + bounce > Numbers::eighth(loads))) return false;
        if (!(threshold_ > Work(0))) return true;
        return !(approach < along(point, pair_speed(pair, threshold_)));
    }
    void push_all(const Pair& pair, const Point& point) {
        for (int k = 0; k < Rows::rows(pair); ++k)
            if (!(point.pushed[k] == Speed{}))
                Rows::push(point.row[k], point.pushed[k], motion_[pair.a], other_motion(pair));
    }
    // The impact of one pair by itself; false when nothing of it bounces.
    bool collide(Pair& pair) {
        bool any = false;
        for (int i = 0; i < pair.count; ++i) {
            const Point& point = pair.point[i];
            any = any || bounces(pair, point, -velocity(motion_, pair, point), point.loads);
        }
        if (!any) return false;
        // Where one point bounces, all do: a body that lands flat must not be turned by rounding.
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
    // Until nothing changes any more, or the bound. What a sweep changes is taken for the gradient of a function that
    // is least at the solution, and the next sweep begins by going on along it as conjugate gradients do (Silcowitz,
    // Niebe and Erleben 2010): sweeps alone would carry a load through a stack by one box in each. The momentum is the
    // ratio of the squares of the largest changes, at most 1, and is lost when these grow by more than an eighth.
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
            if (sweep == 0 || most > last + Numbers::eighth(last)) {
                momentum = {};
            } else {
                const typename N::Unit ratio = most < last ? Numbers::ratio(most, last) : Numbers::one();
                momentum = Numbers::product(ratio, ratio);
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
        for (int k = 0; k < island.unit.count; ++k) touching_[island.unit.id[k]] = 0;
        for_each_active(island, [&](Pair& pair, Point&) {
            ++touching_[pair.a];
            if (moves_b(pair)) ++touching_[pair.b];
        });
    }

    Work threshold_;  // of restitution, m a step
    typename Numbers::SpeedScale speeds_{};
    Motion start_[features.bodies]{}, motion_[features.bodies]{}, loaded_[features.bodies]{};
    Kick<N> kick_[features.bodies]{};
};

}  // namespace tumble

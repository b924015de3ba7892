// Islands at rest, solved by statics. Where everything rests, the velocity at the end of the step is known: it is zero.
// What each pair carries then follows from the balance of one body after another, from the bodies that carry nothing to
// the ground, whatever the masses are. If the points of every pair can carry it, this is a solution, and no sweep is
// needed. (A body that stands on several others may share its load otherwise. Where Coulomb's law also allows motion,
// rest is taken.) A body on which nothing stands may move on one that rests: its pair is solved by itself. Bodies that
// slide as one are at rest for one that moves along.
#pragma once

#include <tumble/contact/contact_rows.hpp>
#include <tumble/solver/weld.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class Statics {
public:
    using Rows = ContactRows<N, spin, features>;
    using C = typename Rows::C;
    using W = MomentNumbers<N>;
    using Bounds = ContactBounds<N>;
    using Unit = typename Rows::Unit;
    using Work = typename Rows::Work;
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
    static constexpr int most_supports = features.pairs ? contact::max_supports : 1;
    static constexpr int most_points = most_supports * Pair::max_points;
    using Weld = tumble::Weld<N, most_points, features.friction>;

    // `bounded`: in a bounded step.
    Statics(const NarrowPhase& shapes, PairList& pairs, Velocities& velocities, const typename NarrowPhase::Bodies& all,
            const Island& island, [[maybe_unused]] bool bounded = false)
        : shapes_{shapes}, pairs_{pairs}, velocities_{velocities}, bodies_{all}, island_{island} {
        if constexpr (features.bounded_steps) bounded_ = bounded;
    }

    // True where the forces are found: the velocities and the impulses of the points are then set. Otherwise nothing
    // changes. The targets of the points must be set.
    //
    // Each body must stand on one pair, or on several that push alike, as in a pyramid or under a bridge. All bodies
    // must come to rest, but for bodies on which nothing stands: these may move on one that rests. Or all bodies move
    // together, as on a lift. Those on single points are left to sweeps, which solve them at once. `only_at_rest`: only
    // where all bodies come to rest.
    bool solve([[maybe_unused]] bool only_at_rest = false) {
        if constexpr (may_ask) only_at_rest_ = only_at_rest;
        const bool may = find_carrying(), slow = !surface_moves_ && are_slow([](int) { return true; }),
                   known = may && slow && pairs_.are_balanced(island_);
        bool found = known;
        if (known) {
            for (int k = 0; k < island_.group.count; ++k) velocities_.stop(island_.group.id[k]);
        } else if (may && !surface_moves_ && (slow || island_.group.count > 1)) {
            leave_out_sides(false);
            found = finish(balance(slow) && (!features.pairs || !moves_ || open_points_stay_apart()));
        }
        if constexpr (Pair::max_points > 1) {
            if (!found && may && has_faces_ && !must_rest() && moves_as_one()) {
                (void)find_carrying();
                leave_out_sides(true);
                found = slide_as_one();
            }
        }
        bool balanced = found && !moves_;
        if constexpr (features.moving_surfaces())
            pairs_.for_each(island_, [&](const Pair& pair) { balanced = balanced && !pair.surface_moves; });
        pairs_.set_balanced(island_, balanced);
        return found;
    }
    // True where impulses that end the motion of all bodies are found, as of a light body between a heavy one and a
    // wall, or those that end it but for bodies on which nothing stands. What they start from is `loaded`.
    [[gnu::noinline, gnu::cold]] bool solve_impact() requires(features.pairs) {
        if (!find_carrying() || surface_moves_) return false;
        in_impact_ = true;
        leave_out_sides(slides_);
        return finish(balance(true) && (!moves_ || open_points_stay_apart()));
    }

private:
    static constexpr int bodies = features.bodies;
    // solve() may be asked for islands that stand alone.
    static constexpr bool may_ask = features.control || features.bounded_steps;

    // Whether all bodies are slow at the start of the step. motion(b) is what counts of a body's velocity, and
    // Bounds::slow() has the limit.
    template <class F>
    [[nodiscard]] bool is_slow(F&& motion) const {
        Speed fastest{}, most{};
        const auto note = [](const Velocity& v, Speed& largest) {
            const Speed size = v.largest();
            if (size > largest) largest = size;
        };
        for (int k = 0; k < island_.group.count; ++k) {
            const int b = island_.group.id[k];
            const Velocity &start = velocities_.start[b], &loaded = velocities_.loaded[b];
            note(motion(b), fastest);
            note({loaded.linear - start.linear, loaded.angular - start.angular}, most);
        }
        return !(fastest > (is_bounded() ? Bounds::slow_when_bounded(most) : Bounds::slow(most)));
    }
    // The same of the bodies for which counts(b).
    template <class F>
    [[nodiscard]] bool are_slow(F&& counts) const {
        return is_slow([&](int b) { return counts(b) ? velocities_.start[b] : Velocity{zero(), zero()}; });
    }
    // Whether the bodies hardly turn, or move against each other. Then `common_` is their velocity at the start, unless
    // one body stands on one pair.
    [[nodiscard]] bool moves_as_one() {
        if (!is_slow([&](int b) { return Velocity{zero(), velocities_.start[b].angular}; })) return false;
        if (island_.group.count == 1 && carrying_ == 1) return true;
        (void)set_common(velocities_.start);
        return is_slow([&](int b) { return Velocity{velocities_.start[b].linear - common_[b], zero()}; });
    }
    [[nodiscard]] bool is_bounded() const {
        if constexpr (features.bounded_steps) return bounded_;
        else return false;
    }
    [[nodiscard]] Speed slack_of_statics() const {
        if constexpr (features.pairs)
            if (in_impact_) [[unlikely]]
                return slack_of_impact();
        return is_bounded() ? velocities_.scale.enough_at_rest() : Bounds::slack(velocities_.scale.rounding());
    }
    // The faces of a body between two others are tilted against each other by rounding.
    [[nodiscard, gnu::noinline, gnu::cold]] Speed slack_of_impact() const {
        Speed motion{};
        for (int k = 0; k < island_.group.count; ++k)
            motion = larger_of(motion, velocities_.loaded[island_.group.id[k]].largest());
        return larger_of(Bounds::left_by_supports(motion), velocities_.scale.enough_at_rest());
    }
    [[nodiscard]] bool must_rest() const {
        if constexpr (may_ask) return only_at_rest_;
        else return false;
    }
    [[nodiscard]] static Vec3<Speed> zero() { return Vec3<Speed>::Constant(Speed{}); }
    // Sets `common_` to the mean velocity, weighted by mass. Returns it, m a step.
    WorkVec3<N> set_common(const typename Velocities::Velocities& of) {
        WorkVec3<N> momentum = zero_vector<N>();
        Work mass(0);
        for (int k = 0; k < island_.group.count; ++k) {
            const int b = island_.group.id[k];
            const Work root_mass = shapes_.weights()[b].root_mass;
            for (int i = 0; i < 3; ++i) momentum[i] += velocities_.scale.work(of[b].linear[i]) * root_mass;
            mass += root_mass * root_mass;
        }
        const WorkVec3<N> mean = scaled_by(momentum, Work(1) / mass);
        set_common(mean);
        return mean;
    }
    void set_common(const WorkVec3<N>& velocity) {
        for (int k = 0; k < island_.group.count; ++k) {
            const int b = island_.group.id[k];
            for (int i = 0; i < 3; ++i)
                common_[b][i] = velocities_.scale.speed(velocity[i] * shapes_.weights()[b].root_mass);
        }
    }
    // Solves bodies that slide as one over surfaces across one direction. Where all surfaces have one friction, the law
    // of Coulomb gives the common velocity at the end, from the sum of momenta. Seen from there, all bodies are at
    // rest.
    [[gnu::noinline, gnu::cold]] bool slide_as_one() {
        const Pair* ground = nullptr;
        bool alike = true;
        pairs_.for_each(island_, [&](const Pair& pair) {
            if (pair.carriers.none() || pair.moves_b()) return;
            if (ground == nullptr) ground = &pair;
            alike = alike && pair.normal == ground->normal && pair.friction == ground->friction &&
                    pair.has_friction == ground->has_friction && velocity_of(pair) == velocity_of(*ground);
        });
        if (ground == nullptr || !alike) return false;
        const WorkVec3<N> surface = velocity_of(*ground), normal = work_unit<N>(ground->normal);
        WorkVec3<N> loaded = set_common(velocities_.loaded);
        loaded -= surface;
        const Work along = dot(loaded, normal);
        if (along > Work(0)) return false;
        WorkVec3<N> end = loaded - scaled_by(normal, along);
        if constexpr (features.friction) {
            const Work speed = sqrt(dot(end, end)),
                       stopped = ground->has_friction ? -along * C::work(ground->friction) : Work(0);
            end = speed > stopped ? scaled_by(end, (speed - stopped) / speed) : zero_vector<N>();
        }
        end += surface;
        set_common(end);
        const auto& group = island_.group;
        slides_ = true;
        for (int k = 0; k < group.count; ++k) velocities_.now[group.id[k]] = {common_[group.id[k]], zero()};
        bool found = open_points_stay_apart();
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            velocities_.now[b] = {velocities_.loaded[b].linear - common_[b], velocities_.loaded[b].angular};
        }
        found = found && balance(true);
        for (int k = 0; k < group.count; ++k) velocities_.now[group.id[k]].linear += common_[group.id[k]];
        found = finish(found && (!moves_ || open_points_stay_apart()));
        moves_ = found;
        return found;
    }
    // Of the surface of a fixed body or a plane, m a step, where it does not turn.
    [[nodiscard]] WorkVec3<N> velocity_of([[maybe_unused]] const Pair& pair) const {
        WorkVec3<N> velocity = zero_vector<N>();
        if constexpr (features.kinematic && features.pairs)
            for (int i = 0; pair.surface_moves && i < 3; ++i) velocity[i] = bodies_.drift(pair.b, i);
        return velocity;
    }
    // Finds the points that may carry: those at the surface. Points above it are open. A pair with a point that must
    // move is marked. False where there are fewer pairs with such points than bodies, or one is on a surface that
    // turns.
    bool find_carrying() {
        const Length touch =
            is_bounded() ? Bounds::resting_depth(shapes_.tolerance()) : Bounds::resting_gap(shapes_.tolerance());
        bool may = true;
        carrying_ = 0;
        pairs_.for_each(island_, [&](Pair& pair) {
            Carriers carriers;
            for (int i = 0; i < pair.count; ++i) {
                const Point& point = pair.point[i];
                if (!point.active) continue;
                if (!(point.gap > touch)) carriers.add(i);
                if (point.row[0].target > Rows::surface_of(pair, point)) carriers.add_motion();
            }
            has_faces_ = has_faces_ || carriers.has_several();
            if (carriers != pair.carriers) pairs_.unbalance(pair);
            pair.carriers = carriers;
            if (carriers.none()) return;
            if constexpr (features.moving_surfaces()) {
                surface_moves_ = surface_moves_ || pair.surface_moves;
                may = may && !(pair.surface_moves && bodies_.is_turning(pair.b));
            }
            ++carrying_;
        });
        return may && carrying_ >= island_.group.count;
    }
    // Where there are more pairs than bodies: a pair whose normal is at right angles to the load of its bodies carries
    // no force, such as that of boxes side by side. `slides`: the bodies have the velocity `common_` together.
    void leave_out_sides(bool slides) {
        if (features.all_pairs() == 1 || carrying_ == island_.group.count) return;
        const auto presses = [&](const Pair& pair, int b) {
            const Vec3<Speed>& v = velocities_.now[b].linear;
            return presses_on(pair, b, slides ? Vec3<Speed>(v - common_[b]) : v);
        };
        pairs_.for_each(island_, [&](Pair& pair) {
            if (!presses(pair, pair.a) && !(pair.moves_b() && presses(pair, pair.b))) pair.carriers = {};
        });
    }
    // Whether the body, with this velocity, presses on the pair.
    [[nodiscard]] static bool presses_on(const Pair& pair, int b, const Vec3<Speed>& v) {
        const Speed along = narrow<Speed>(dot(pair.normal, v)), away = b == pair.a ? along : -along;
        return -away > Bounds::across(magnitude_of(v[0]) + magnitude_of(v[1]) + magnitude_of(v[2]));
    }

    // The pairs of bodies that have not been solved. Of a body with one pair left, `last` is that pair.
    struct Left {
        std::int16_t count[bodies], last[bodies];

        void note(int b, int i, int change) {
            count[b] = static_cast<std::int16_t>(count[b] + change);
            last[b] = static_cast<std::int16_t>(last[b] ^ i);
        }
    };
    // Bodies that only planes carry: each on one pair.
    bool balance(bool) requires(!features.pairs) {
        const auto& group = island_.group;
        for (int k = 0; k < group.count; ++k) {
            Supports on;
            pairs_.for_each_of(group.id[k], [&](Pair& pair) {
                if (!pair.carriers.none()) on.add(pair);
            });
            if (on.several || on.pair[0] == nullptr || on.pair[0]->carriers.must_move() || !carry(on, group.id[k]))
                return false;
        }
        return true;
    }
    // From the bodies that carry nothing to the ground.
    [[gnu::noinline, gnu::cold]] bool balance(bool slow) requires(features.pairs) {
        Left left;
        bool is_leaf[bodies];
        const auto& group = island_.group;
        for (int k = 0; k < group.count; ++k) left.count[group.id[k]] = left.last[group.id[k]] = 0;
        for (int i = island_.first_pair; i >= 0; i = pairs_.in_slot(i).next) {
            const Pair& pair = pairs_.in_slot(i);
            if (pair.carriers.none()) continue;
            left.note(pair.a, i, 1);
            if (pair.moves_b()) left.note(pair.b, i, 1);
        }
        for (int k = 0; k < group.count; ++k) is_leaf[group.id[k]] = left.count[group.id[k]] == 1;
        if (!slow && !are_slow([&](int b) { return !is_leaf[b]; })) return false;
        const bool on_planes = is_on_planes_alone();
        int solved = 0;
        bool found = true;
        for (int before = -1; found && before < solved && solved < group.count;) {
            before = solved;
            for (int k = 0; found && k < group.count; ++k) {
                int b = group.id[k];
                while (found && b >= 0 && left.count[b] == 1) {
                    const int i = left.last[b];
                    Pair& pair = pairs_.in_slot(i);
                    found = (!pair.carriers.must_move() && carry({{&pair}, 1}, b)) ||
                            (is_leaf[b] && !must_rest() && slide(pair, b));
                    left.count[b] = 0;
                    ++solved;
                    const int other = b == pair.a ? pair.b : pair.a;
                    b = -1;
                    if (!pair.moves_b()) continue;
                    b = other;
                    left.note(b, i, -1);
                }
                Supports supports;
                if (!found || b < 0 || left.count[b] < 2 || on_planes || !take_supports(left, b, supports)) continue;
                found = carry(supports, b);
                ++solved;
            }
        }
        return found && solved == group.count;
    }
    // True of a body that planes carry: it is solved as where there are no pairs, which is on one plane.
    [[nodiscard]] bool is_on_planes_alone() const requires(features.pairs) {
        bool all = island_.group.count == 1;
        pairs_.for_each(island_, [&](const Pair& pair) { all = all && (pair.with_plane() || pair.carriers.none()); });
        return all;
    }
    // Takes the impulses over, or sets the velocities back.
    [[nodiscard]] bool finish(bool found) {
        if (found) {
            set_impulses();
        } else {
            moves_ = false;
            for (int k = 0; k < island_.group.count; ++k)
                velocities_.now[island_.group.id[k]] = velocities_.loaded[island_.group.id[k]];
        }
        return found;
    }
    // Whether no point of the other pairs, which carry nothing, comes too deep.
    [[nodiscard]] bool open_points_stay_apart() {
        bool all = true;
        const Speed slack = slack_of_statics();
        pairs_.for_each_active(island_, [&](Pair& pair, Point& point) {
            if (!pair.carriers.none()) return;
            const Speed excess =
                point.row[0].excess(velocities_.now[pair.a], pair.moves_b() ? &velocities_.now[pair.b] : nullptr);
            all = all && !(excess < -slack);
        });
        return all;
    }
    // How far a force may be outside its cone: where bodies slide, forces lie on the cones, to what sweeps leave.
    [[nodiscard]] Speed beyond() const { return slides_ ? velocities_.scale.enough_at_rest() : Speed{}; }
    // What stands still in the world, in the axes that the body has where its rows act.
    template <class T>
    [[nodiscard]] Vec3<T> in_middle([[maybe_unused]] int b, const Vec3<T>& v) const {
        if constexpr (Velocities::bodies_turn)
            if (velocities_.turns(b)) return velocities_.turn[b].later(v);
        return v;
    }
    // Solves the pair of a body that moves on one that rests, by sweeps over its points alone, and hands on what they
    // push. `unscaled` of the points' rows gets this as impulses of the body.
    bool slide(Pair& pair, int b) requires(features.pairs) {
        if (!pair.moves_b()) return false;
        using Sweep = typename Rows::Sweep;
        const bool is_a = b == pair.a;
        const Unit share = is_a ? pair.share_a : pair.share_b;
        const typename W::Over over_share{share};
        const BodyWeight<N>& weight = shapes_.weights()[b];
        Velocity& now = velocities_.now[b];
        const int rows = pair.rows();
        typename Sweep::Row row[Pair::max_points][Point::directions];
        [[maybe_unused]] If<features.friction, Couplings<N>[Pair::max_points], 0> couplings;
        [[maybe_unused]] If<features.rolling_resistance, SpinOfOne, 0> own_spin{pair, shapes_, b};
        const auto for_each_block = [&](auto&& f) {
            for (int i = 0; i < pair.count; ++i)
                if (pair.point[i].active) {
                    typename Sweep::Block block{.row = row[i], .rows = rows, .coefficient = pair.friction, .a = now};
                    if constexpr (features.friction) block.couplings = couplings + i;
                    if constexpr (features.rolling_resistance)
                        if (pair.resists_spin()) block.resistance = own_spin.resistance(i);
                    f(block);
                }
        };
        const Vec3<Unit> frame[3] = {pair.normal, pair.tangent[0], pair.tangent[1]};
        for (int k = 0; k < rows; ++k) {
            Vec3<Unit> direction = frame[k];
            if (!is_a) direction = -direction;
            const Vec3<Unit> at_start = shapes_.axes(b).to_body(direction), in_body = in_middle(b, at_start);
            if constexpr (features.rolling_resistance)
                if (pair.resists_spin()) own_spin.set(pair, k, at_start);
            for (int i = 0; i < pair.count; ++i) {
                const Point& point = pair.point[i];
                row[i][k].set(direction, weight.levers(in_middle(b, arm_of(point, is_a)), in_body));
                // Between the rows of two bodies and of one: their lengths, and what the body takes of the motion.
                const Row& whole = point.row[k];
                row[i][k].target = Row::product(over_share(W::over(whole.target, whole.inverse)), row[i][k].inverse);
                row[i][k].impulse =
                    W::over(Row::product(Row::product(whole.impulse, whole.inverse), share), row[i][k].inverse);
            }
        }
        if constexpr (features.friction)
            for (int i = 0; rows > 1 && i < pair.count; ++i) couplings[i].set(row[i], false);
        for_each_block([](const auto& block) { Sweep::push(block); });
        typename Sweep::Motion motion;
        const Speed enough = velocities_.scale.enough_at_rest();
        const int most = Bounds::sweeps(contact::max_sweeps);
        velocities_.within_bounds(most, enough, [&](int& left) {
            return Sweep::run(
                for_each_block, [&](auto&& f) { f(now, motion); }, enough, enough, left, most);
        });
        moves_ = true;
        return hand_on(pair, is_a, over_share, row, own_spin);
    }
    // Hands on to the other body of a pair what its points push, from the rows of one body. False where that does not
    // fit.
    bool hand_on(Pair& pair, bool is_a, const typename W::Over& over_share, const auto& row,
                 [[maybe_unused]] const auto& own_spin) requires(features.pairs) {
        Velocity unused = velocities_.now[is_a ? pair.a : pair.b], &other = velocities_.now[is_a ? pair.b : pair.a];
        Velocity &now_a = is_a ? unused : other, &now_b = is_a ? other : unused;
        const int rows = pair.rows();
        pair.carriers = {};
        pair.carriers.add_motion();
        for (int i = 0; i < pair.count; ++i) {
            if (!pair.point[i].active) continue;
            pair.carriers.add(i);
            for (int k = 0; k < Point::directions; ++k) {
                auto& to = pair.point[i].row[k];
                propose(to, k < rows ? over_share(Row::product(row[i][k].impulse, row[i][k].inverse)) : Speed{});
                if (k < rows) to.push(to.proposed, now_a, &now_b);
            }
            if constexpr (features.rolling_resistance)
                for (int k = 0; k < 3; ++k) {
                    auto& to = pair.point[i].spin[k];
                    propose(to, pair.resists_spin() ? over_share(own_spin.of_pair(i, k)) : Speed{});
                    if (!(to.unscaled == Speed{})) to.push(to.proposed, now_a, &now_b);
                }
        }
        return C::fits(other.largest());
    }
    // Rows of the spin of one body of a pair, with its radius as the arm.
    struct SpinOfOne {
        typename Rows::Sweep::Row row[Pair::max_points][3];
        const BodyWeight<N>& weight;
        Length radius;
        typename C::Friction rolling{}, spinning{}, to_pair{};  // the last: the body's arm over the pair's

        SpinOfOne(const Pair& pair, const NarrowPhase& shapes, int b)
            : weight{shapes.weights()[b]}, radius{shapes.shape(b).radius} {
            if (!pair.resists_spin()) return;
            if constexpr (features.rolling_resistance) {
                const Work ratio = shapes.scale().metres(radius) / shapes.scale().metres(pair.spin_arm);
                rolling = C::friction(C::work(pair.rolling) / ratio);
                spinning = C::friction(C::work(pair.spinning) / ratio);
                to_pair = C::friction(ratio);
            }
        }
        [[nodiscard]] typename Rows::Sweep::Resistance resistance(int i) { return {row[i], rolling, spinning}; }
        // Makes the rows about direction k of the pair, in the axes of the body, without an impulse.
        void set(const Pair& pair, int k, const Vec3<Unit>& about) {
            const int to = k == 0 ? 2 : k - 1;
            for (int i = 0; i < pair.count; ++i) {
                row[i][to].set_spin(weight.spin_levers(about, radius));
                row[i][to].target = row[i][to].impulse = Speed{};
            }
        }
        // An impulse as one of the pair, before it is divided by the share.
        [[nodiscard]] Speed of_pair(int i, int k) const {
            return C::times_friction(to_pair, Row::product(row[i][k].impulse, row[i][k].inverse));
        }
    };
    // The pairs on which a body stands; the one, if no two bodies touch each other.
    struct SeveralSupports {
        Pair* pair[most_supports];
        int count = 0;
    };
    struct OneSupport {
        Pair* pair[1] = {nullptr};
        static constexpr int count = 1;
        bool several = false;

        void add(Pair& on) {
            several = pair[0] != nullptr;
            pair[0] = &on;
        }
    };
    using Supports = std::conditional_t<features.pairs, SeveralSupports, OneSupport>;
    // Finds the pairs that are left of a body and takes them off. False where one does not push against its load, as
    // where something stands on the body that has not been solved, or where they are too many: then none is taken.
    bool take_supports(Left& left, int b, Supports& supports) requires(features.pairs) {
        std::int16_t taken[most_supports];
        for (int i = island_.first_pair; i >= 0; i = pairs_.in_slot(i).next) {
            Pair& pair = pairs_.in_slot(i);
            const bool is_left =
                !pair.carriers.none() && left.count[pair.a] > 0 && (!pair.moves_b() || left.count[pair.b] > 0);
            if ((pair.a != b && pair.b != b) || !is_left) continue;
            if (supports.count == most_supports || pair.carriers.must_move() ||
                !presses_on(pair, b, velocities_.now[b].linear))
                return false;
            taken[supports.count] = static_cast<std::int16_t>(i);
            supports.pair[supports.count++] = &pair;
        }
        for (int s = 0; s < supports.count; ++s) {
            const Pair& pair = *supports.pair[s];
            if (pair.moves_b()) left.note(pair.a == b ? pair.b : pair.a, taken[s], -1);
        }
        left.count[b] = 0;
        return true;
    }
    // Stops a body through its supports, which push along one direction at points of one plane, and hands on what each
    // of them pushes. `unscaled` of the points' rows gets this as impulses of the body.
    bool carry(const Supports& supports, int b) {
        const Pair& first = *supports.pair[0];
        // Towards the body.
        Vec3<Unit> frame[3] = {first.normal, first.tangent[0], first.tangent[1]};
        if constexpr (features.pairs) {
            if (first.a != b) {
                frame[0] = -frame[0];
                frame[1] = -frame[1];
            }
        }
        bool rough = features.friction;
        auto friction = first.friction;
        for (int s = 0; s < supports.count; ++s) {
            const Pair& pair = *supports.pair[s];
            rough = rough && pair.has_friction;
            if (pair.friction < friction) friction = pair.friction;
        }
        if constexpr (features.pairs) {
            if (!rough) {
                StoredVec3<Unit> tangent[2];
                set_tangents<N>(frame[0], tangent);
                frame[1] = tangent[0];
                frame[2] = tangent[1];
            }
        }
        Side side{shapes_.axes(b), frame};
        for (int s = 0; s < supports.count; ++s) side.add(*supports.pair[s], supports.pair[s]->a == b);
        side.set_middle();
        Weld weld;
        typename Weld::Shares shares;
        if (!weld.set(side.x, side.z, side.count, shapes_.shape(b).radius) ||
            !weld.share(side.wrench_to_stop(frame, velocities_.now[b], shapes_.weights()[b]), rough, friction,
                        slack_of_statics(), beyond(), shares))
            return false;
        const Speed motion = velocities_.now[b].largest();
        bool fits = true;
        for (int s = 0, j = 0; s < supports.count; ++s) {
            Pair& pair = *supports.pair[s];
            Parts parts{pair, frame, pair.a == b};
            for (int i = 0; i < pair.count; ++i)
                if (pair.carriers.has(i)) {
                    fits = push(pair, pair.point[i], b, parts, shares[j++], supports.count > 1) && fits;
                    fits = fits && (supports.count == 1 || is_in_cone(pair, pair.point[i]));
                }
        }
        // Supports that push along other directions, or at other heights, leave some.
        const Speed allowed = Bounds::left_by_supports(motion), enough = velocities_.scale.enough_at_rest();
        if (supports.count > 1) fits = fits && !(velocities_.now[b].largest() > larger_of(allowed, enough));
        velocities_.stop(b);
        return fits;
    }
    // Whether a point pushes and its friction is in its cone: the supports of a body may be tilted against each other.
    [[nodiscard]] bool is_in_cone(const Pair& pair, const Point& point) const {
        const Speed slack = slack_of_statics() + beyond(), normal = point.row[0].unscaled;
        if (normal < -slack) return false;
        if constexpr (features.friction) {
            if (pair.rows() == 1) return true;
            const Speed limit = C::times_friction(pair.friction, normal) + slack, x = point.row[1].unscaled,
                        y = point.row[2].unscaled;
            return !(mul_add(mul(x, x), y, y) > mul(limit, limit));
        }
        return true;
    }
    // The directions of a pair's rows in the frame in which its points share a wrench.
    struct Parts {
        Unit of[Point::directions][3];
        bool shared;            // the other body moves too
        typename W::Over over;  // the body's share
        [[no_unique_address]] If<features.control, typename W::OverRecent[Point::directions], 0> over_inverse{};

        Parts(const Pair& pair, const Vec3<Unit> (&frame)[3], bool is_a)
            : shared{pair.moves_b()}, over{is_a ? pair.share_a : pair.share_b} {
            for (int k = 0; features.pairs && k < pair.rows(); ++k)
                for (int j = 0; j < 3; ++j)
                    of[k][j] = narrow<Unit>(dot(k == 0 ? pair.normal : pair.tangent[k - 1], frame[j]));
        }
        // An impulse of the body as one of the pair.
        [[nodiscard]] Speed over_share(Speed impulse) const { return shared ? over(impulse) : impulse; }
    };
    // Sets the impulse that a row may get, times its `inverse`.
    static void propose(Row& row, Speed impulse) {
        row.unscaled = impulse;
        row.proposed = impulse == Speed{} ? Speed{} : W::over(impulse, row.inverse);
    }
    // The same for row k of a pair whose points are often alike. Worlds in which gravity may change in every step give
    // flash for it.
    static void propose(Row& row, Speed impulse, [[maybe_unused]] Parts& parts, [[maybe_unused]] int k) {
        if constexpr (features.control) {
            row.unscaled = impulse;
            row.proposed = impulse == Speed{} ? Speed{} : parts.over_inverse[k](impulse, row.inverse);
        } else {
            propose(row, impulse);
        }
    }
    // Pushes a body at a point, and the other one back. False where that is too fast for the scale. `counts`: the
    // velocity of the body is asked for.
    bool push(Pair& pair, Point& point, int b, Parts& parts, const Speed (&share)[3], [[maybe_unused]] bool counts) {
        const bool is_a = pair.a == b;
        bool fits = true;
        for (int k = 0; k < pair.rows(); ++k) {
            auto& row = point.row[k];
            if constexpr (!features.pairs) {
                propose(row, share[k], parts, k);
            } else {
                const auto& part = parts.of[k];
                const Speed along =
                    narrow<Speed>(mul_add(mul_add(mul(part[0], share[0]), part[1], share[1]), part[2], share[2]));
                propose(row, parts.over_share(is_a ? along : -along), parts, k);
                Velocity* const partner = pair.moves_b() ? &velocities_.now[pair.b] : nullptr;
                if constexpr (features.control) {
                    if (counts) row.push_one(row.proposed, is_a, velocities_.now[b]);
                    if (partner != nullptr)
                        row.push_one(row.proposed, !is_a, is_a ? *partner : velocities_.now[pair.a]);
                } else {
                    row.push(row.proposed, velocities_.now[pair.a], partner);
                }
                if (partner == nullptr) continue;
                const Velocity& other = is_a ? *partner : velocities_.now[pair.a];
                fits = fits && C::fits(other.largest());
            }
        }
        for (int k = pair.rows(); k < Point::directions; ++k) propose(point.row[k], Speed{});
        if constexpr (features.rolling_resistance)
            for (auto& row : point.spin) propose(row, Speed{});
        return fits;
    }

    // The frame of a pair in the axes of one of its bodies, and the places of the points that carry.
    struct Side {
        Vec3<Unit> frame[3];
        Length middle[3] = {};                  // of the points, from the centre of mass
        Length x[most_points], z[most_points];  // along the tangents from there
        int count = 0;

        Side(const Axes<N>& axes, const Vec3<Unit> (&world)[3]) {
            for (int k = 0; k < 3; ++k) frame[k] = axes.to_body(world[k]);
        }
        void add(const Pair& pair, bool is_a) {
            for (int i = 0; i < pair.count; ++i) {
                if (!pair.carriers.has(i)) continue;
                const Vec3<Length>& arm = arm_of(pair.point[i], is_a);
                const auto along = [&](int k) { return narrow<Length>(dot(frame[k], arm)); };
                x[count] = along(1);
                z[count] = along(2);
                middle[0] += along(0);
                middle[1] += x[count];
                middle[2] += z[count];
                ++count;
            }
        }
        void set_middle() {
            if constexpr (most_points == 1) return;
            for (Length& sum : middle) sum = W::template mean<most_points>(sum, count);
            for (int i = 0; i < count; ++i) {
                x[i] -= middle[1];
                z[i] -= middle[2];
            }
        }
        // What stops the body, at the middle.
        [[nodiscard]] typename Weld::Wrench wrench_to_stop(const Vec3<Unit> (&world)[3], const Velocity& now,
                                                           const BodyWeight<N>& weight) const {
            typename Weld::Wrench wrench;
            for (int k = 0; k < 3; ++k) {
                wrench.force[k] = -narrow<Speed>(dot(world[k], now.linear));
                const auto part = [&](int i) { return narrow<Length>(mul(frame[k][i], weight.gyration[i])); };
                wrench.moment[k] =
                    -mul_add(mul_add(mul(part(0), now.angular[0]), part(1), now.angular[1]), part(2), now.angular[2]);
            }
            for (int k = 0; k < 3; ++k) wrench.moment[k] -= moment_of(wrench.force, k);
            return wrench;
        }
        // About the centre of mass, of a force at the middle: component k.
        [[nodiscard]] auto moment_of(const Vec3<Speed>& force, int k) const {
            const int i = k == 2 ? 0 : k + 1, j = 3 - k - i;
            return mul_sub(mul(middle[i], force[j]), middle[j], force[i]);
        }
    };
    void set_impulses() {
        pairs_.for_each(island_, [&](Pair& pair) {
            for (int i = 0; i < pair.count; ++i) {
                pair.point[i].for_each_row(
                    [&](Row& row) { row.impulse = pair.carriers.has(i) ? row.proposed : Speed{}; });
            }
        });
    }
    [[nodiscard]] static const Vec3<Length>& arm_of(const Point& point, bool is_a) {
        if constexpr (features.pairs)
            if (!is_a) return point.arm_b;
        return point.arm;
    }

    const NarrowPhase& shapes_;
    PairList& pairs_;
    Velocities& velocities_;
    const typename NarrowPhase::Bodies& bodies_;
    const Island& island_;
    int carrying_ = 0;            // pairs
    bool has_faces_ = false;      // a pair carries at several points
    bool moves_ = false;          // a body of the solution
    bool surface_moves_ = false;  // of something on which they stand
    Vec3<Speed> common_[bodies];  // of bodies that slide as one, weighted
    bool slides_ = false;         // `now` is relative to `common_` of the end
    bool only_at_rest_ = false;
    [[no_unique_address]] If<features.bounded_steps, bool, 7> bounded_{};
    [[no_unique_address]] If<features.pairs, bool, 8> in_impact_{};
};

}  // namespace tumble

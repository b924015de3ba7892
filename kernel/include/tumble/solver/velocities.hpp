// The weighted velocities of an island's bodies while its rows are solved, all in one scale.
#pragma once

#include <tumble/solver/kicks.hpp>
#include <tumble/solver/middle_turn.hpp>
#include <tumble/solver/row.hpp>
#include <tumble/solver/weights.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class SolverVelocities {
public:
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;
    using Speed = typename C::Speed;
    using Work = typename N::Work;
    using Velocity = WeightedVelocity<N>;
    using Bodies = tumble::Bodies<N, spin, features.bodies, features.mixed()>;
    using Weights = tumble::Weights<N, features.bodies>;
    using BodyGroup = SomeBodies<features.bodies>;
    using Kicks = tumble::Kicks<N, features.bodies>;

    using Velocities = ZeroedArray<Velocity, features.bodies>;
    Velocities start{};   // before the loads
    Velocities loaded{};  // before the impulses of the rows
    Velocities now{};     // with the impulses of the rows
    // There is one row. A visit solves it, but for rounding, and so it needs no momentum.
    static constexpr bool is_one_row = features.all_pairs() == 1 && !features.boxes && !features.round_shapes &&
                                       !features.friction && !features.rolling_resistance;
    [[no_unique_address]] If<!is_one_row, ZeroedArray<SweepMotion<N>, features.bodies>, 2> sweeping{};
    // The sweeps that the bound of the scene leaves of the step.
    struct SweepsLeft {
        int count = std::numeric_limits<int>::max();
        bool missing = false;  // more were needed
    };
    [[no_unique_address]] If<features.impact_bounds, SweepsLeft, 3> sweeps_left{};
    // True where they are used up. What still approaches then strikes in the next step.
    [[nodiscard]] bool sweeps_are_spent() const {
        if constexpr (features.impact_bounds) return sweeps_left.count == 0;
        else return false;
    }
    // Calls solve(int&) with how many sweeps a solution may have: its usual bound, and what that of the scene leaves of
    // it, one at least. It takes off what it uses, and returns the largest change of the last. Returns this.
    template <class Solve>
    Speed within_bounds(int usual, Speed enough, Solve&& solve) {
        int count = usual;
        if constexpr (features.impact_bounds) {
            SweepsLeft& left = sweeps_left;
            if (count > left.count) count = left.count > 1 ? left.count : 1;
            const int most = count;
            const Speed change = solve(count);
            left.count = left.count > most - count ? left.count - (most - count) : 0;
            if (left.count == 0 && change > enough) left.missing = true;
            return change;
        } else {
            return solve(count);
        }
    }
    // The room of `loaded` has these where it is needed no more: a motion that is added to that of the bodies for a
    // flight, and in an impact the velocities at the start of a round.
    [[nodiscard]] Velocities& added() { return loaded; }
    [[nodiscard]] Velocities& round_start() { return loaded; }
    // The room of `start`, likewise: the part of the added motion that surfaces cause.
    [[nodiscard]] Velocities& taken_along() { return start; }
    typename C::SpeedScale scale{};
    // Of bodies that move and that nothing pushes.
    struct Surfaces {
        bool changed = false;  // some have another velocity since the last step
        bool carry = false;    // added() has a motion that this causes
    };
    [[no_unique_address]] If<features.moving_surfaces(), Surfaces, 1> surfaces{};
    // None where kicks act at one end of the flight, and of a body on whose axes nothing depends, such as a ball.
    static constexpr bool bodies_turn = features.has_axes();
    [[no_unique_address]] If<bodies_turn, ZeroedArray<MiddleTurn<N>, features.bodies>, 0> turn{};
    [[nodiscard]] bool turns([[maybe_unused]] int b) const {
        if constexpr (bodies_turn) return static_cast<bool>(turn[b]);
        else return false;
    }

    void forget_turns() {
        if constexpr (bodies_turn)
            for (auto& t : turn) t = {};
    }
    // Whether no body moves at the start by more than sweeps leave.
    [[nodiscard]] bool start_at_rest(const BodyGroup& group) const {
        const Speed slack = scale.enough_at_rest();
        bool all = true;
        for (int k = 0; k < group.count; ++k) all = all && !(start[group.id[k]].largest() > slack);
        return all;
    }
    // Of a body that is known to stand at the end.
    void stop(int b) { now[b].linear = now[b].angular = Vec3<Speed>::Constant(Speed{}); }
    // Sets how far the bodies turn in `part` of a step. `in_halves`: half of each kick acts before the flight, half
    // after. is_alike(b): nothing about the body depends on its axes.
    template <class IsAlike>
    void set_turns([[maybe_unused]] const Bodies& bodies, [[maybe_unused]] const BodyGroup& group,
                   [[maybe_unused]] Work part, [[maybe_unused]] bool in_halves, [[maybe_unused]] IsAlike&& is_alike) {
        if constexpr (bodies_turn) {
            for (int k = 0; k < group.count; ++k) {
                const int b = group.id[k];
                turn[b] = {};
                if (!in_halves || is_alike(b) || !bodies.is_turning(b)) continue;
                WorkVec3<N> whole;
                for (int i = 0; i < 3; ++i) whole[i] = bodies.turn(b, i) * part;
                turn[b] = MiddleTurn<N>{whole};
            }
        }
    }
    // Chooses the scale for these bodies, the changes of their motion by loads, and other speeds up to the size
    // `largest`. is_between(b): the body has rows with several others.
    template <class IsBetween>
    void set_scale(const Bodies& bodies, const Weights& weights, const BodyGroup& group, const Kicks& loads,
                   decltype(C::nothing()) largest, IsBetween&& is_between) {
        for_each_component(bodies, weights, group, loads,
                           [&](Speed&, Speed&, auto motion, auto load, int bits, Work weight) {
                               const auto note = [&](auto size) {
                                   if (size > largest) largest = size;
                               };
                               note(C::size(motion, bits, weight));
                               note(C::size(load, bits, weight));
                           });
        // The root of the mass ratio, as a power of two: a light body between a heavy one and another takes impulses
        // that are larger than its velocities. Several bodies need one bit more.
        int heaviest = C::log2(weights[group.id[0]].root_mass);
        for (int k = 1; k < group.count; ++k) {
            const int log2 = C::log2(weights[group.id[k]].root_mass);
            if (log2 > heaviest) heaviest = log2;
        }
        int lightest = heaviest;
        for (int k = 0; k < group.count; ++k) {
            const int log2 = C::log2(weights[group.id[k]].root_mass);
            if (log2 < lightest && is_between(group.id[k])) lightest = log2;
        }
        scale = C::SpeedScale::of(largest, group.count, heaviest - lightest + (group.count > 1 ? 2 : 0));
    }
    // Sets the velocities in the scale: `start` as the bodies move, `loaded` and `now` with `part` of the change by
    // loads; `whole`: all of it. The turns must be set. True where `loaded` is what it was.
    bool set(const Bodies& bodies, const Weights& weights, const BodyGroup& group, const Kicks& loads, Work part,
             bool whole) {
        const typename N::Unit fraction = whole ? C::one() : C::unit(part);
        for_each_component(bodies, weights, group, loads,
                           [&](Speed& before, Speed& end, auto motion, auto load, int bits, Work weight) {
                               before = scale.speed(motion, bits, weight);
                               end = scale.speed(load, bits, weight);
                               if (!whole) end = narrow<Speed>(mul(end, fraction));
                               end += before;
                           });
        bool same = true;
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            if constexpr (bodies_turn)
                if (turn[b]) precess(now[b].angular, weights[b], turn[b]);
            same = same && loaded[b].linear == now[b].linear && loaded[b].angular == now[b].angular;
            loaded[b] = now[b];
        }
        return same;
    }
    // Writes what the rows have changed as kicks. A change beyond the range is reported. `loads`: where bodies that end
    // without velocity or without spin shall have exactly none at the end of a whole step.
    void write(Kicks& kicks, Bodies& bodies, const Weights& weights, const BodyGroup& group,
               const Kicks* loads = nullptr) const {
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            const BodyWeight<N>& weight = weights[b];
            Kick<N>& kick = kicks[b];
            const bool within = write(
                kick, [&](int i) { return now[b].linear[i] - loaded[b].linear[i]; },
                [&](int i) { return now[b].angular[i] - loaded[b].angular[i]; }, bodies, weight, b);
            if (!within) [[unlikely]]
                bodies.report(Issue::range_left, b);
            if (loads != nullptr) stop(kick, (*loads)[b], bodies.state[b], now[b]);
        }
    }
    // Writes a change of velocity of body b, linear(i) and angular(i), as a kick, in the scale that its spin has now.
    // False where it is beyond the range.
    template <class Linear, class Angular>
    TUMBLE_INLINE bool write(Kick<N>& kick, Linear&& linear, Angular&& angular, const Bodies& bodies,
                             const BodyWeight<N>& weight, int b) const {
        bool within = true;
        for (int i = 0; i < 3; ++i) {
            kick.linear[i] = C::template as<typename N::DriftSum>(
                scale.sum(linear(i), C::drift_bits(bodies.scale), weight.per_root_mass, within));
            kick.angular[i] = C::template as<typename N::TurnSum>(
                scale.sum(angular(i), C::turn_bits(bodies.spin_scale(b)), weight.per_turn[i], within));
        }
        return within;
    }
    // Adds a change to the motion of body b.
    void add_to(Bodies& bodies, int b, const BodyWeight<N>& weight, const Velocity& change) const {
        for (int i = 0; i < 3; ++i)
            N::add_any(bodies.state[b].d_w[i], scale.work(change.linear[i]) * weight.per_root_mass, bodies.scale);
        bodies.change_spin(b, [&](auto& t_b, typename N::Scale unit) {
            for (int i = 0; i < 3; ++i) N::add_any(t_b[i], scale.work(change.angular[i]) * weight.per_turn[i], unit);
        });
    }
    // Adds the change since `start` to the motion of the bodies. `loads` keep the scale of the spins.
    void add_to(Bodies& bodies, Kicks& loads, const Weights& weights, const BodyGroup& group) const {
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k], halvings = bodies.halvings_of(b);
            add_to(bodies, b, weights[b], {now[b].linear - start[b].linear, now[b].angular - start[b].angular});
            loads.rescale(b, bodies.halvings_of(b) - halvings);
        }
    }

private:
    // The next axis in a cycle, without a remainder: some cores have no division.
    [[nodiscard]] static constexpr int next(int axis) { return axis == 2 ? 0 : axis + 1; }
    // Euler's equations by the midpoint method: sqrt(I_i) dw_i = (I_j - I_k) / sqrt(I_i) w_j w_k. Of the two factors,
    // that of the larger moment I_m is u_m / sqrt(I_m), and the other is the turn.
    static void precess(Vec3<Speed>& u, const BodyWeight<N>& weight, const MiddleTurn<N>& turn) {
        const auto quarter_of_change = [&](const Vec3<Speed>& speed, const Vec3<Unit>& quarter) {
            Vec3<Speed> change;
            for (int i = 0; i < 3; ++i) {
                const int j = next(i), k = next(j);
                const bool last = weight.gyration[j] < weight.gyration[k];
                const Speed product = narrow<Speed>(mul(speed[last ? k : j], quarter[last ? j : k]));
                change[i] = narrow<Speed>(mul(product, weight.gyroscopic[i]));
            }
            return change;
        };
        const Vec3<Unit>& quarter = turn.quarter();
        Vec3<Unit> middle;
        for (int i = 0; i < 3; ++i) {
            const Unit product = C::product(quarter[next(i)], quarter[next(next(i))]);
            const Unit half = C::product(product, weight.euler[i]);
            middle[i] = quarter[i] + half + half;
        }
        Vec3<Speed> change = quarter_of_change(u, quarter);
        change = quarter_of_change(u + change + change, middle);
        for (int i = 0; i < 3; ++i) u[i] += change[i] + change[i] + change[i] + change[i];
    }
    // Where the rows end a motion or a spin, the kick ends it exactly.
    static void stop(Kick<N>& kick, const Kick<N>& load, const typename Bodies::State& state, const Velocity& end) {
        const Vec3<Speed> zero = Vec3<Speed>::Constant(Speed{});
        const bool moves = !(end.linear == zero), spins = !(end.angular == zero);
        for (int i = 0; i < 3; ++i) {
            if (!moves) kick.linear[i] = -(N::sum(state.d_w[i]) + load.linear[i]);
            if (!spins) kick.angular[i] = -(N::sum(state.t_b[i]) + load.angular[i]);
        }
    }
    // Calls f(start, with loads, the sum now, the loads' change, its fraction bits, its weight) for each component.
    template <class F>
    void for_each_component(const Bodies& bodies, const Weights& weights, const BodyGroup& group, const Kicks& loads,
                            F&& f) {
        const int drift_bits = C::drift_bits(bodies.scale);
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            const BodyWeight<N>& weight = weights[b];
            const auto& s = bodies.state[b];
            const int spin_bits = C::turn_bits(bodies.spin_scale(b));
            for (int i = 0; i < 3; ++i) {
                f(start[b].linear[i], now[b].linear[i], C::raw(N::sum(s.d_w[i])), C::raw(loads[b].linear[i]),
                  drift_bits, weight.root_mass);
                f(start[b].angular[i], now[b].angular[i], C::raw(N::sum(s.t_b[i])), C::raw(loads[b].angular[i]),
                  spin_bits, weight.of_turn[i]);
            }
        }
    }
};

}  // namespace tumble

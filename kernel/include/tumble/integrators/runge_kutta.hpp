// Explicit Runge-Kutta methods: one stepping function for every Butcher table, on translation and rotation. The
// rotation is integrated as a delta quaternion relative to identity: stage s has K_s = (1 + sum_j a_sj K_j) u_s, with
// u_s the half turn of the stage. This is the method applied to q' = q u, because that equation is linear in q from the
// left. Cost: 3 multiplications for the spin and 12 for the delta in each stage but the first, and 20 for the product
// with the quaternion.
//
// A method of order 4 with classical stages (at 0, 1/2, 1/2 and 1) turns by one exponential in place of the weighted
// sum of deltas. Its half angle is the Magnus series to order 4, with u_s the half turn of stage s:
//   (u_1 + 2 u_2 + 2 u_3 + u_4) / 6 + u_1 x u_4 / 6,
// Simpson's sum and the commutator of the two ends (S. Blanes, F. Casas, J. A. Oteo and J. Ros, Phys. Rep. 470 (2009)
// 151). A free body then needs no delta of a stage, and its quaternion keeps its length.
#pragma once

#include <tumble/integrators/butcher.hpp>
#include <tumble/integrators/method.hpp>
#include <tumble/integrators/rotation/euler_equations.hpp>
#include <tumble/integrators/stability.hpp>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push  // GCC does not see that a body that rotates in a stage has rotated in those before
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

namespace tumble::detail {

// A stage of the rotation, as the weighted sums at the end of the step need it.
template <class N>
struct RotationStage {
    Delta<N> delta;
    Vec3<typename N::Angle> half_turn;
    TurnProducts<N> products;
};

// True of the tables whose stages the Magnus series needs.
template <const auto& table>
inline constexpr bool turns_by_exponential =
    table.stages == 4 && table.a[1][0] == Rational{1, 2} && table.a[2][1] == Rational{1, 2} &&
    table.a[3][2] == Rational{1, 1} && table.b[0] == Rational{1, 6} && table.b[1] == Rational{1, 3} &&
    table.b[2] == Rational{1, 3} && table.b[3] == Rational{1, 6};

// The turn of a step from the half turns of four classical stages.
template <class N>
[[nodiscard]] TUMBLE_INLINE Delta<N> magnus_delta(const RotationStage<N>* stages, Dither d) {
    using Angle = typename N::Angle;
    constexpr Rational sixth{1, 6}, third{1, 3};
    const auto share = N::template constant<Angle>(Real{1} / Real{6});
    const auto &u1 = stages[0].half_turn, &u2 = stages[1].half_turn, &u3 = stages[2].half_turn,
               &u4 = stages[3].half_turn;
    const Vec3<Angle> part{N::Block::angle(u1.x(), share, d.turn), N::Block::angle(u1.y(), share, d.turn),
                           N::Block::angle(u1.z(), share, d.turn)};
    const auto component = [&](auto axis) {
        constexpr int i = axis;
        return N::round_angle(
            add_cross_component<i>(weighted<sixth>(u1[i] + u4[i]) + weighted<third>(u2[i] + u3[i]), part, u4), d);
    };
    using std::integral_constant;
    const Vec3<Angle> a{component(integral_constant<int, 0>{}), component(integral_constant<int, 1>{}),
                        component(integral_constant<int, 2>{})};
    const auto series = SinCosSeries<Angle>::of(upper_word(dot(a, a)));
    const auto stretched = [&](Angle angle) { return N::Block::stretched(angle, series.sinc_less_one, d.angle); };
    return {series.cos_less_one, {stretched(a.x()), stretched(a.y()), stretched(a.z())}};
}

// Delta (1 + before) u, exact to first order in u.
template <class N>
[[nodiscard]] TUMBLE_INLINE Delta<N> stage_delta(const Delta<N>& before, const Vec3<typename N::Angle>& u, Dither d) {
    const auto& v = before.v;
    return {-N::round_angle(dot(v, u), d),
            {u.x() + N::round_angle(add_cross_component<0>(mul(before.w, u.x()), v, u), d),
             u.y() + N::round_angle(add_cross_component<1>(mul(before.w, u.y()), v, u), d),
             u.z() + N::round_angle(add_cross_component<2>(mul(before.w, u.z()), v, u), d)}};
}

// The spin of a stage, from the stages before it, without torques.
template <const auto& table, int s, class N, class Inertia>
[[nodiscard]] TUMBLE_INLINE Vec3<typename N::Turn> stage_turn(const Vec3<typename N::Turn>& start,
                                                              const RotationStage<N>* stages, const Inertia& inertia,
                                                              typename N::Scale scale) {
    const auto component = [&](auto axis) {
        constexpr int i = axis;
        typename N::Turn t = start[i];
        unroll<s>([&](auto earlier) {
            constexpr int j = earlier;
            constexpr Rational a = table.a[s][j];
            if constexpr (!a.is_zero()) {
                constexpr Rational twice = Rational{2, 1} * a;
                t += times<twice>(N::stage_turn(inertia.kappa[i], stages[j].products.v[i], scale));
            }
        });
        return t;
    };
    using std::integral_constant;
    return {component(integral_constant<int, 0>{}), component(integral_constant<int, 1>{}),
            component(integral_constant<int, 2>{})};
}

// Adds a term to a sum. The first one replaces the zero: floating point would add it in earnest.
template <bool is_first, class T>
TUMBLE_INLINE void gather(T& sum, T term) {
    if constexpr (is_first) sum = term;
    else sum += term;
}

// The weighted sum of the stages before stage s.
template <const auto& table, int s, class N>
[[nodiscard]] TUMBLE_INLINE Delta<N> delta_before(const RotationStage<N>* stages) {
    Delta<N> before = Delta<N>::identity();
    unroll<s>([&](auto earlier) {
        constexpr int j = earlier;
        constexpr Rational a = table.a[s][j];
        if constexpr (!a.is_zero()) {
            constexpr bool is_first = table.first_before(s) == j;
            const Delta<N>& delta = stages[j].delta;
            gather<is_first>(before.w, times<a>(delta.w));
            gather<is_first>(before.v.x(), times<a>(delta.v.x()));
            gather<is_first>(before.v.y(), times<a>(delta.v.y()));
            gather<is_first>(before.v.z(), times<a>(delta.v.z()));
        }
    });
    return before;
}

// Applies the weighted sums of all stages to the body. In fixed point sums are exact, so stages of one weight are added
// before they are multiplied by it. Two of them fit one angle, whose range is 1/2: with turns of 1/4 at turn_shift 1
// and kicks of 1/16, the angles of the four stages of rk4 are below 0.13, 0.18, 0.20 and 0.30 rad.
template <const auto& table, class N, class Inertia>
TUMBLE_INLINE void finish_rotation(BodyState<N, Spin::angular_velocity>& body, const RotationStage<N>* stages,
                                   const Inertia& inertia, const StepInfo<N>& step) {
    constexpr bool by_exponential = turns_by_exponential<table>;
    [[maybe_unused]] typename N::AngleSum w{}, x{}, y{}, z{};
    TurnProducts<N> sum{};
    unroll<table.stages>([&](auto stage) {
        constexpr int s = stage;
        if constexpr (!table.b[s].is_zero() && (!N::fixed_point || table.first_of_weight(s) == s)) {
            const auto of_weight = [&](auto&& part) {
                auto total = part(stages[s]);
                unroll<table.stages>([&](auto later) {
                    if constexpr (N::fixed_point && later > s && table.b[later] == table.b[s])
                        total += part(stages[later]);
                });
                return total;
            };
            constexpr bool is_first = table.first_weighted() == s;
            constexpr Rational b = table.b[s], weight{table.weight(s), 1};
            if constexpr (!by_exponential) {
                gather<is_first>(w, weighted<b>(of_weight([](const auto& k) { return k.delta.w; })));
                gather<is_first>(x, weighted<b>(of_weight([](const auto& k) { return k.delta.v.x(); })));
                gather<is_first>(y, weighted<b>(of_weight([](const auto& k) { return k.delta.v.y(); })));
                gather<is_first>(z, weighted<b>(of_weight([](const auto& k) { return k.delta.v.z(); })));
            }
            unroll<3>([&](auto axis) {
                gather<is_first>(sum.v[axis],
                                 times<weight>(of_weight([&](const auto& k) { return k.products.v[axis]; })));
            });
        }
    });
    const Dither d = step.dither;
    if constexpr (by_exponential) {
        turn<N>(body.q_wb, magnus_delta<N>(stages, d));
    } else {
        const Vec3<typename N::Angle> v{N::round_angle(x, d), N::round_angle(y, d), N::round_angle(z, d)};
        if constexpr (table.stages == 1) turn<N>(body.q_wb, Delta<N>::of(v));
        else turn<N>(body.q_wb, Delta<N>{N::round_angle(w, d), v});
    }
    N::add_turn(body.t_b.x, inertia.summed[0], sum.v[0], step.scale);
    N::add_turn(body.t_b.y, inertia.summed[1], sum.v[1], step.scale);
    N::add_turn(body.t_b.z, inertia.summed[2], sum.v[2], step.scale);
}

// 1 + sum_s b_s K_s with K_s = A (1 + sum_j a_sj K_j), A the equation.
template <const auto& table>
struct RungeKuttaOnOscillator {
    static constexpr OscillatorStep step(double k, double c) {
        const auto number = [](Rational r) { return static_cast<double>(r.numerator) / r.denominator; };
        const OscillatorStep equation = OscillatorStep::of_equation(k, c);
        OscillatorStep stages[table.stages], end;
        for (int s = 0; s < table.stages; ++s) {
            OscillatorStep before;
            for (int j = 0; j < s; ++j) before = before + number(table.a[s][j]) * stages[j];
            stages[s] = equation * before;
        }
        for (int s = 0; s < table.stages; ++s) end = end + number(table.b[s]) * stages[s];
        return end;
    }
};

}  // namespace tumble::detail

namespace tumble::integrators {

template <const auto& table>
struct RungeKutta : Stability<tumble::detail::RungeKuttaOnOscillator<table>> {
    static constexpr Spin spin = Spin::angular_velocity;
    static constexpr Coasting coasting = table.stages == 1 ? Coasting::start : Coasting::mean;

    template <class N>
    using Inertia = EulerInertia<N, table.denominator()>;

    template <class N>
    TUMBLE_INLINE static void rotate(BodyState<N, Spin::angular_velocity>& body, const Inertia<N>& inertia,
                                     const StepInfo<N>& step) {
        detail::RotationStage<N> stages[table.stages];
        const Vec3<typename N::Turn> start = body.t_b.take();
        detail::unroll<table.stages>([&](auto stage) {
            constexpr int s = stage;
            const auto t = detail::stage_turn<table, s, N>(start, stages, inertia, step.scale);
            const auto u = angles<N>(t, step);
            stages[s].products = TurnProducts<N>::of(t);
            if constexpr (detail::turns_by_exponential<table>) stages[s].half_turn = u;
            else if constexpr (s == 0) stages[s].delta = {{}, {u.x(), u.y(), u.z()}};
            else stages[s].delta = detail::stage_delta<N>(detail::delta_before<table, s, N>(stages), u, step.dither);
        });
        detail::finish_rotation<table, N>(body, stages, inertia, step);
    }

    // Steps all bodies of the group stage by stage. Calls `evaluate(stage states, kicks)` once a stage. A stage has the
    // drift only where loads depend on it.
    template <class N, int capacity, class Group, class Evaluate>
    static bool advance(const Group& group, Evaluate&& evaluate, const StepInfo<N>& step) {
        group.has_bodies();
        [[maybe_unused]] detail::RotationStage<N> rotation[Group::rotation ? capacity : 1][table.stages];
        typename Group::Kick kick[table.stages][capacity];
        typename Group::Stage start[capacity], state[capacity];
        const bool velocity_matters = evaluate.depends_on_velocity();
        for (int b = 0; b < group.count; ++b) {
            group.take(b, start[b]);
            if constexpr (Group::rotation)
                if (group.rotates(b)) start[b].t_b = group.body[b]->t_b.take();
            copy_stage(state[b], start[b]);
        }
        detail::unroll<table.stages>([&](auto stage) {
            constexpr int s = stage;
            for (int b = 0; b < group.count; ++b) {
                auto& now = state[b];
                if constexpr (s > 0)
                    detail::for_axes<N>([&](int i) __attribute__((always_inline)) {
                        const auto d = start[b].d_w[i];
                        now.x_w[i] =
                            N::displaced(start[b].x_w[i],
                                         with_kicks<s, true>(detail::times<table.node(s)>(d), kick, b, i), step.scale);
                        if (velocity_matters) now.d_w[i] = with_kicks<s, false>(d, kick, b, i);
                    });
                if constexpr (Group::rotation)
                    if (group.rotates(b)) rotate_stage<s, N>(start[b], now, group, b, rotation[b], kick, step);
            }
            evaluate(state, kick[s]);
        });
        for (int b = 0; b < group.count; ++b) {
            auto& body = *group.body[b];
            constexpr Rational share{1, table.denominator()};
            detail::for_axes<N>([&](int i) __attribute__((always_inline)) {
                constexpr auto arrivals = table.arrivals();
                constexpr Rational part{1, arrivals.denominator()};
                typename N::DriftSum linear{}, travelled{};
                detail::unroll<table.stages>([&](auto stage) {
                    constexpr Rational drifts{table.weight(stage), 1}, travels = arrivals.whole(stage);
                    const auto change = kick[stage][b].linear[i];
                    if constexpr (!drifts.is_zero()) linear += detail::times<drifts>(change);
                    if constexpr (!travels.is_zero()) travelled += detail::times<travels>(change);
                });
                N::coast(body.x_w[i], body.d_w[i], detail::times<part>(travelled), step.scale);
                N::add(body.d_w[i], detail::times<share>(linear));
            });
            if constexpr (Group::rotation) {
                if (!group.rotates(b)) continue;
                detail::finish_rotation<table, N>(body, rotation[b], *group.inertia[b], step);
                for (int i = 0; i < 3; ++i) {
                    typename N::TurnSum angular{};
                    detail::unroll<table.stages>([&](auto stage) {
                        constexpr int s = stage;
                        constexpr Rational weight{table.weight(s), 1};
                        if constexpr (weight.numerator != 0) angular += detail::times<weight>(kick[s][b].angular[i]);
                    });
                    body.t_b[i].add(detail::times<share>(angular));
                }
            }
        }
        return true;
    }

private:
    // A sum and what the kicks of axis i before stage s add: to the way, or to the drift.
    template <int s, bool to_way, class Sum, class Kick, int capacity>
    [[nodiscard]] TUMBLE_INLINE static Sum with_kicks(Sum sum, const Kick (&kick)[table.stages][capacity], int b,
                                                      int i) {
        detail::unroll<s>([&](auto earlier) {
            constexpr int j = earlier;
            constexpr Rational weight = to_way ? table.of_kick(s, j) : table.a[s][j];
            if constexpr (!weight.is_zero()) sum += detail::times<weight>(kick[j][b].linear[i]);
        });
        return sum;
    }
    // The rotation of a body of the group at stage s, from the stages before it.
    template <int s, class N, class Group, int capacity>
    TUMBLE_INLINE static void rotate_stage(const StageState<N>& start, StageState<N>& now, const Group& group, int b,
                                           detail::RotationStage<N> (&stages)[table.stages],
                                           const Kick<N> (&kick)[table.stages][capacity], const StepInfo<N>& step) {
        now.t_b = detail::stage_turn<table, s, N>(start.t_b, stages, *group.inertia[b], step.scale);
        detail::unroll<s>([&](auto earlier) {
            constexpr int j = earlier;
            constexpr Rational a = table.a[s][j];
            if constexpr (!a.is_zero())
                for (int i = 0; i < 3; ++i) now.t_b[i] += N::narrow_turn(detail::times<a>(kick[j][b].angular[i]));
        });
        const Delta<N> before = detail::delta_before<table, s, N>(stages);
        if constexpr (s > 0) now.q_wb = turned<N>(start.q_wb, before);
        stages[s].products = TurnProducts<N>::of(now.t_b);
        stages[s].half_turn = angles<N>(now.t_b, step);
        stages[s].delta = detail::stage_delta<N>(before, stages[s].half_turn, step.dither);
    }
};

// Order 1. Gains energy, unstable on oscillations.
struct ExplicitEuler : RungeKutta<euler_table> {
    static constexpr const char* name = "explicit_euler";
    static constexpr int order = 1;
};
// Order 2, two stages.
struct Midpoint : RungeKutta<midpoint_table> {
    static constexpr const char* name = "midpoint";
    static constexpr int order = 2;
};
// Order 2, two stages: the explicit trapezoidal rule.
struct Heun : RungeKutta<heun_table> {
    static constexpr const char* name = "heun";
    static constexpr int order = 2;
};
// The classical method: order 4, four stages. It turns by the exponential of its stages' half turns, so a free sphere
// turns exactly.
struct Rk4 : RungeKutta<rk4_table> {
    static constexpr const char* name = "rk4";
    static constexpr int order = 4;
    static constexpr bool exact_for_spheres = true;
};

}  // namespace tumble::integrators

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif

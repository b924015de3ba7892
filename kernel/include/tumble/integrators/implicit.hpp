// Implicit one-stage methods: the loads and the gyroscopic term at one point of the step, solved by Newton's iteration
// with a fixed bound. A free body needs 3 x 3 Newton steps on its spin only. Bodies under loads are solved together, by
// a Jacobian of the loads from differences and a dense elimination in working numbers: (6 n)^3 / 3 multiplications and
// 6 n divisions a step for n loaded bodies. Use these methods for stiff springs, not for speed.
#pragma once

#include <tumble/integrators/butcher.hpp>
#include <tumble/integrators/method.hpp>
#include <tumble/integrators/rotation/euler_equations.hpp>
#include <tumble/integrators/stability.hpp>

namespace tumble {

// The point of the one stage: the end of the step or its middle.
enum class Stage : std::uint8_t { end, middle };

namespace detail {

// (1 - share A)^-1 (1 + (1 - share) A) with A the equation.
template <Stage stage>
struct OneStageOnOscillator {
    static constexpr OscillatorStep step(double k, double c) {
        constexpr double share = stage == Stage::end ? 1 : 0.5;
        const OscillatorStep equation = OscillatorStep::of_equation(k, c), left = OscillatorStep{} + -share * equation;
        const OscillatorStep adjugate{left.vv, -left.xv, -left.vx, left.xx};
        return 1 / left.determinant() * (adjugate * (OscillatorStep{} + (1 - share) * equation));
    }
};

}  // namespace detail

template <Stage stage>
struct OneStageImplicit : Stability<detail::OneStageOnOscillator<stage>> {
    static constexpr Spin spin = Spin::angular_velocity;
    static constexpr Coasting coasting = stage == Stage::end ? Coasting::end : Coasting::mean;
    static constexpr int max_iterations = 12;

    template <class N>
    using Inertia = EulerInertia<N, 1>;

    // Newton's iteration for t' = t + 2 kappa t' t', or for the mean spin m = t + kappa m m. The linear system is 1 - E
    // with a small E, so the series of E solves it without a division; the next iteration corrects the truncation.
    // Converges if the body turns less than about half a radian in a step, and otherwise returns false.
    template <class N>
    TUMBLE_INLINE static bool rotate(BodyState<N, spin>& body, const Inertia<N>& inertia, const StepInfo<N>& step) {
        using Turn = typename N::Turn;
        const Vec3<Turn> start = body.t_b.take();
        Vec3<Turn> t = start;
        bool converged = false;
        for (int iteration = 0; iteration < max_iterations && !converged; ++iteration) {
            const auto products = TurnProducts<N>::of(t);
            Vec3<Turn> rest;
            for (int i = 0; i < 3; ++i) {
                const Turn half = N::stage_turn(inertia.kappa[i], products.v[i], step.scale);
                rest[i] = t[i] - start[i] - half;
                if constexpr (stage == Stage::end) rest[i] -= half;
            }
            const Vec3<Turn> once = coupling<N>(inertia, t, rest, step), twice = coupling<N>(inertia, t, once, step);
            t -= rest + once + twice;
            converged = N::is_rounding(rest, t);
        }
        const auto products = TurnProducts<N>::of(t);
        for (int i = 0; i < 3; ++i) N::add_turn(body.t_b[i], inertia.summed[i], products.v[i], step.scale);
        turn<N>(body.q_wb, delta_of<N>(angles<N>(t, step)));
        return converged;
    }

    template <class N, int capacity, class Group, class Evaluate>
    static bool advance(const Group& group, Evaluate&& evaluate, const StepInfo<N>& step) {
        group.has_bodies();
        Solver<N, capacity, Group, std::remove_reference_t<Evaluate>> solver{group, evaluate, step};
        return solver.solve();
    }

private:
    // The turn of the step from the half turn of the stage. In the middle it is Cayley's map, which rotates the
    // momentum in the body as the implicit midpoint rule does. Energy, momentum norm and the world's momentum are then
    // all exact.
    template <class N>
    [[nodiscard]] TUMBLE_INLINE static Delta<N> delta_of(const Vec3<typename N::Angle>& u) {
        if constexpr (stage == Stage::end) {
            return Delta<N>::of(u);
        } else {
            const auto r = inverse_length_less_one<N>(upper_word(dot(u, u)));
            const auto shorter = [&](typename N::Angle a) { return a + mul_upper(a, r); };
            return {r, {shorter(u.x()), shorter(u.y()), shorter(u.z())}};
        }
    }

    // E v, with E_ij the derivative of the gyroscopic term.
    template <class N>
    [[nodiscard]] static Vec3<typename N::Turn> coupling(const Inertia<N>& inertia, const Vec3<typename N::Turn>& t,
                                                         const Vec3<typename N::Turn>& v, const StepInfo<N>& step) {
        Vec3<typename N::Turn> r;
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            const auto half = N::stage_turn(inertia.kappa[i], mul_add(mul(t[j], v[k]), t[k], v[j]), step.scale);
            r[i] = stage == Stage::end ? half + half : half;
        }
        return r;
    }

    // Newton's iteration on the increments z of drift (m) and spin (half turns) of all bodies: z = kick(end of step) +
    // gyroscopic term. A point mass has the first three only.
    template <class N, int capacity, class Group, class Evaluate>
    struct Solver {
        using Work = typename N::Work;
        static constexpr int of_body = Group::rotation ? 6 : 3, unknowns = of_body * capacity;

        const Group& group;
        Evaluate& evaluate;
        const StepInfo<N>& step;
        typename Group::Stage start[capacity]{}, end[capacity]{};  // `end` is the stage
        Work z[unknowns]{}, value[unknowns]{}, column[unknowns]{}, jacobian[unknowns][unknowns]{};

        bool solve() {
            for (int b = 0; b < group.count; ++b) {
                group.take(b, start[b]);
                if constexpr (Group::rotation)
                    if (group.rotates(b)) start[b].t_b = group.body[b]->t_b.take();
            }
            const int n = first_of(group.count);
            bool converged = false;  // z starts from 0: the explicit guess is far off for stiff loads
            for (int iteration = 0; iteration < max_iterations && !converged; ++iteration) {
                right_hand_side(value);
                if (iteration == 0) differentiate(n);
                for (int i = 0; i < n; ++i) column[i] = value[i] - z[i];
                eliminate_or_substitute(n, iteration == 0);
                converged = true;
                for (int b = 0; b < group.count; ++b) {
                    const int first = first_of(b);
                    // Corrections below the rounding error of the numbers are noise: of metres, or of the whole spin of
                    // the body.
                    const auto correct = [&](int i, auto&& add_size) {
                        z[i] += column[i];
                        Work size = magnitude(z[i]);
                        add_size(size);
                        if (size * N::rounding_unit() < magnitude(column[i])) converged = false;
                    };
                    for (int i = 0; i < 3; ++i) correct(first + i, [](Work& size) { size += Work(1); });
                    if constexpr (Group::rotation) {
                        for (int i = 0; i < 3 && group.rotates(b); ++i)
                            correct(first + 3 + i, [&](Work& size) {
                                size += N::template constant<Work>(Real::scaled(1, -8));
                                for (int k = 0; k < 3; ++k) size += magnitude(N::half_turn(end[b].t_b[k], step.scale));
                            });
                    }
                }
            }
            place_ends();
            for (int b = 0; b < group.count; ++b) {
                auto& body = *group.body[b];
                const int first = first_of(b);
                for (int i = 0; i < 3; ++i) {
                    if constexpr (stage == Stage::middle) N::move(body.x_w[i], end[b].d_w[i], step.scale);
                    N::add_any(body.d_w[i], z[first + i], step.scale);
                    if constexpr (stage == Stage::end) N::coast(body.x_w[i], body.d_w[i], {}, step.scale);
                }
                if constexpr (Group::rotation) {
                    if (!group.rotates(b)) continue;
                    for (int i = 0; i < 3; ++i) N::add_any(body.t_b[i], z[first + 3 + i], step.scale);
                    turn<N>(body.q_wb, delta_of<N>(angles<N>(end[b].t_b, step)));
                }
            }
            return converged;
        }

    private:
        [[nodiscard]] static Work magnitude(Work a) { return a < Work(0) ? -a : a; }

        // The index of the body's first unknown.
        [[nodiscard]] int first_of(int body) const {
            if constexpr (!Group::has_points) return of_body * body;
            int first = 0;
            for (int b = 0; b < body; ++b) first += group.rotates(b) ? 6 : 3;
            return first;
        }

        // The share of z at the stage.
        [[nodiscard]] static Work share(Work of_z) { return stage == Stage::end ? of_z : N::half_of(of_z); }

        // Computes the stage and the end of the step from z.
        void place_ends() {
            for (int b = 0; b < group.count; ++b) {
                const auto& from = start[b];
                auto& to = end[b];
                const int first = first_of(b);
                for (int i = 0; i < 3; ++i) {
                    to.d_w[i] = from.d_w[i] + N::drift_sum(share(z[first + i]), step.scale);
                    to.x_w[i] =
                        N::displaced(from.x_w[i], stage == Stage::end ? to.d_w[i] : N::half(to.d_w[i]), step.scale);
                }
                if constexpr (Group::rotation) {
                    if (!group.rotates(b)) continue;
                    for (int i = 0; i < 3; ++i)
                        to.t_b[i] = from.t_b[i] + N::narrow_turn(N::turn_sum(share(z[first + 3 + i]), step.scale));
                    Vec3<typename N::Angle> u = angles<N>(to.t_b, step);
                    if constexpr (stage == Stage::middle)
                        for (int i = 0; i < 3; ++i) u[i] = N::half_angle(u[i]);
                    to.q_wb = turned<N>(from.q_wb, Delta<N>::of(u));
                }
            }
        }

        // The increments that the loads and the gyroscopic term make at the end of a step reached with z.
        void right_hand_side(Work* out) {
            WorkKick<N, Group::rotation> kick[capacity];
            place_ends();
            evaluate(end, kick);
            for (int b = 0; b < group.count; ++b) {
                const int first = first_of(b);
                for (int i = 0; i < 3; ++i) out[first + i] = kick[b].linear[i];
                if constexpr (Group::rotation) {
                    if (!group.rotates(b)) continue;
                    const auto products = TurnProducts<N>::of(end[b].t_b);
                    for (int i = 0; i < 3; ++i) {
                        const Work twice_kappa = N::work(group.inertia[b]->kappa[i]) * Work(2);
                        out[first + 3 + i] =
                            mul_add(kick[b].angular[i], twice_kappa, N::turn_product(products.v[i], step.scale));
                    }
                }
            }
        }

        // jacobian = 1 - d(right hand side)/dz, by forward differences of 2^-12 (m, rad).
        void differentiate(int n) {
            const Work difference = N::template constant<Work>(Real::scaled(1, -12)), inverse = Work(4096);
            for (int j = 0; j < n; ++j) {
                const Work kept = z[j];
                z[j] += difference;
                right_hand_side(column);
                z[j] = kept;
                for (int i = 0; i < n; ++i)
                    jacobian[i][j] = (i == j ? Work(1) : Work(0)) - (column[i] - value[i]) * inverse;
            }
            right_hand_side(value);
        }

        // Gaussian elimination. The factors stay in the matrix for later iterations. The matrix is near 1 or dominated
        // by its stiffness, so the pivots are taken in order.
        void eliminate_or_substitute(int n, bool eliminate) {
            for (int k = 0; k < n; ++k) {
                if (eliminate) {
                    if (!(magnitude(jacobian[k][k]) > Work(0))) jacobian[k][k] = Work(1);
                    jacobian[k][k] = Work(1) / jacobian[k][k];
                }
                for (int i = k + 1; i < n; ++i) {
                    if (eliminate) {
                        jacobian[i][k] = jacobian[i][k] * jacobian[k][k];
                        for (int j = k + 1; j < n; ++j) jacobian[i][j] -= jacobian[i][k] * jacobian[k][j];
                    }
                    column[i] -= jacobian[i][k] * column[k];
                }
            }
            for (int k = n - 1; k >= 0; --k) {
                for (int j = k + 1; j < n; ++j) column[k] -= jacobian[k][j] * column[j];
                column[k] = column[k] * jacobian[k][k];
            }
        }
    };
};

}  // namespace tumble

namespace tumble::integrators {

// Implicit (backward) Euler: everything at the end of the step. Order 1, A-stable, damps. No square root for a free
// body.
struct ImplicitEuler : OneStageImplicit<Stage::end> {
    static constexpr const char* name = "implicit_euler";
    static constexpr int order = 1;
};

// The implicit midpoint rule: everything in the middle of the step. Order 2, symmetric in time, A-stable without
// damping. For a free body it conserves energy, momentum norm and the world's angular momentum to the rounding of the
// solver. In floating point a step takes a square root and a division.
struct ImplicitMidpoint : OneStageImplicit<Stage::middle> {
    static constexpr const char* name = "implicit_midpoint";
    static constexpr int order = 2;
    static constexpr const char* needs = "sqrt and division in floating point";
};

}  // namespace tumble::integrators

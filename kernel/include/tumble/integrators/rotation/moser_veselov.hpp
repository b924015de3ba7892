// Free rotation by the discrete Moser-Veselov map with modified moments (E. Hairer and G. Vilmart, J. Phys. A 39 (2006)
// 13225: "preprocessed", order 4, 6, 8 or 10). Conserves energy, |m| and the world's angular momentum to rounding.
//
// With I_y = 1 and t = h/2 m, a step turns the body by the quaternion (1, c) / sqrt(1 + |c|^2), where c solves
//   J_i c_i = (1 + |c|^2) t_i + (J_j - J_k) c_j c_k,   (i, j, k) cyclic,
// and t_i += 2 (J_j - J_k) c_j c_k / (1 + |c|^2). The modified moments J, 1/J_i = (1 + s) / I_i + d, are constant in
// free flight: s and d are polynomials in |t|^2 and the energy. They are computed anew only after something else has
// changed the spin. The same rounded J are in every place, so rounding makes the motion that of a slightly different
// body, without drift. No trigonometry. Cost: an iteration for c with a fixed bound; one division for each moment when
// the spin is changed; in floating point one square root and one division a step, in fixed point none.
#pragma once

#include <tumble/body/orientation.hpp>
#include <tumble/body/stage.hpp>
#include <tumble/numbers/vectors.hpp>

namespace tumble {

namespace detail {

// Coefficients of the polynomials, for moments in units of the middle one. Term [p - 1][a] belongs to N^(p-a) H^a, with
// N = h^2 |m|^2 / 2 and H = h^2 times the energy.
struct MoserVeselovTerms {
    Real s[4][5]{}, d[4][5]{};

    [[nodiscard]] static constexpr MoserVeselovTerms of(RealVec3 moments) {
        const Real a = moments.x, b = moments.y, c = moments.z, one = 1;
        const auto power = [](Real x, int n) {
            Real y = 1;
            for (int i = 0; i < n; ++i) y *= x;
            return y;
        };
        const auto sum = [&](int p) { return power(a, p) + power(b, p) + power(c, p); };
        const auto inverse_sum = [&](int p) { return one / power(a, p) + one / power(b, p) + one / power(c, p); };
        const auto ratio = [&](int p, int q) {
            return (power(a, p) + power(b, p)) / power(c, q) + (power(b, p) + power(c, p)) / power(a, q) +
                   (power(c, p) + power(a, p)) / power(b, q);
        };
        const Real D = a * b * c, D2 = D * D, D3 = D2 * D, D4 = D3 * D;
        const Real s1 = sum(1), s2 = sum(2), s3 = sum(3), s4 = sum(4);
        const Real x1 = inverse_sum(1), x2 = inverse_sum(2), x3 = inverse_sum(3), x4 = inverse_sum(4);
        const Real r = ratio(1, 1), r21 = ratio(2, 1), r12 = ratio(1, 2), r31 = ratio(3, 1), r13 = ratio(1, 3),
                   r22 = ratio(2, 2);
        const auto n = [](int k) { return Real{k}; };
        return {{{s1 / (n(6) * D), -x1 / n(3)},
                 {(s2 / D - x1) / (n(30) * D), (one - r) / (n(30) * D), (n(3) * s1 / D + n(2) * x2) / n(60)},
                 {(n(4) * D + n(17) * s3 - n(15) * D * r) / (n(2520) * D3),
                  (n(9) * s1 + n(10) * D * x2 - n(6) * r21) / (n(420) * D2),
                  ((n(6) * r12 - n(100) * x1) * D + n(53) * s2) / (n(2520) * D2),
                  (n(15) - D * x3 - n(2) * r) / (n(630) * D)},
                 {(n(62) * s4 - n(94) * D * r21 + n(66) * D2 * x2 + n(81) * D * s1) / (n(45360) * D4),
                  (n(-77) * r31 + n(75) * D * r12 + n(214) * s2 - n(240) * D * x1) / (n(22680) * D3),
                  (n(26) * D * r22 + n(55) * s3 + n(204) * D - n(50) * D2 * x3 - n(59) * D * r) / (n(7560) * D3),
                  (n(137) * D * x2 - D * r13 + n(3) * s1 - n(69) * r21) / (n(11340) * D2),
                  (n(2) * D2 * x4 + n(5) * D * r12 - n(171) * D * x1 + n(159) * s2) / (n(45360) * D2)}},
                {{-one / (n(3) * D), s1 / (n(6) * D)},
                 {-s1 / (n(60) * D2), x1 / (n(10) * D) - s2 / (n(60) * D2), -(n(9) + r) / (n(60) * D)},
                 {(n(34) * D * x1 - n(19) * s2) / (n(2520) * D3), (s3 + n(2) * D * r - n(85) * D) / (n(1260) * D3),
                  (n(47) * s1 + n(13) * r21 - n(38) * D * x2) / (n(2520) * D2),
                  (n(9) * D * x1 + D * r12 - n(11) * s2) / (n(1260) * D2)},
                 {(n(60) * D * r - n(61) * s3 - n(247) * D) / (n(45360) * D4),
                  (n(54) * D * s1 - s4 + n(218) * D * r21 - n(426) * D2 * x2) / (n(45360) * D4),
                  (n(125) * D * x1 - n(5) * r31 - n(130) * s2 + n(4) * D * r12) / (n(7560) * D3),
                  (n(67) * s3 - n(735) * D - n(15) * D * r22 + n(87) * D * r + n(34) * D2 * x3) / (n(22680) * D3),
                  (n(165) * s1 - D * r13 - n(9) * r21 - n(145) * D * x2) / (n(45360) * D2)}}};
    }
};

}  // namespace detail

template <class N, int order>
struct MoserVeselovInertia {
    using Work = typename N::Work;
    using Factor = typename N::template CoefficientOf<30>;
    static constexpr int degree = order / 2 - 1;
    static constexpr int terms = degree * (degree + 3) / 2;

    // Bodies whose smallest moment is below this, in units of the middle one, are slender. Their polynomials are in N
    // and H - N, because those in N and H cancel by a power of the ratio of moments.
    static constexpr Real slender = 0.15625;
    // Fixed point needs care for slender bodies, for fast spins about z, and for J_x >= 2, which a factor cannot hold.
    // For these, this number is added to z_shift. No spin has room for such a shift, so the flow's existing check of
    // room finds it. See MoserVeselovFlow::careful_flow.
    static constexpr int with_care = 64;

    Work x{}, x_less_y{}, z{};    // I_x / I_y, I_x / I_y - 1, I_z / I_y
    Work s[terms]{}, d[terms]{};  // in |t|^2 and sum t_i^2 / I_i, whose doubles are N and H; see `slender`
    Factor modified[3]{};         // J_i, for the present spin; with care J_x - 1, (J_x - J_y) 2^z_shift, J_z 2^z_shift
    Factor inverse[3]{};          // 1 / J_i; that of z times 2^-z_shift
    std::int8_t z_shift = 0, most_up = 0;
    bool is_slender = false;

    [[nodiscard]] static constexpr MoserVeselovInertia of(RealVec3 moments, typename N::Scale scale) {
        const RealVec3 relative = moments * (Real{1} / moments.y);
        const auto terms_of = detail::MoserVeselovTerms::of(relative);
        MoserVeselovInertia inertia{};
        inertia.x = N::template constant<Work>(relative.x);
        inertia.x_less_y = N::template constant<Work>((moments.x - moments.y) / moments.y);
        inertia.z = N::template constant<Work>(relative.z);
        inertia.is_slender = relative.z < slender;
        // N^(p-a) H^a; or with H = N + (H - N) the sum over k of (a over k) N^(p-k) (H - N)^k.
        const auto coefficient = [&](const Real(&term)[5], int p, int a) {
            Real sum = term[a];
            for (int more = 1, choices = 1; inertia.is_slender && a + more <= p; ++more) {
                choices = choices * (a + more) / more;
                sum += term[a + more] * Real{choices};
            }
            return N::template constant<Work>(sum * Real::scaled(1, p));
        };
        int at = 0;
        for (int p = 1; p <= degree; ++p) {
            for (int a = 0; a <= p; ++a, ++at) {
                inertia.s[at] = coefficient(terms_of.s[p - 1], p, a);
                inertia.d[at] = coefficient(terms_of.d[p - 1], p, a);
            }
        }
        // A factor holds up to 2. 1 / J_z may exceed 1 / I_z by a quarter at the end of the range.
        if (N::fixed_point && relative.z < Real{0.625}) {
            inertia.z_shift = static_cast<std::int8_t>((Real{0.625} / relative.z).ceil_log2_bound());
        }
        inertia.most_up = static_cast<std::int8_t>(N::Block::most_up(scale, inertia.z_shift));
        return inertia;
    }

    // The flow follows a spin about z that has room times 2^z_room.
    [[nodiscard]] constexpr int z_room() const { return z_shift % with_care; }
    // Calls visit with the members that a snapshot holds.
    template <class Self, class Visit>
    static void each(Self& self, Visit& visit) {
        visit(self.modified, self.inverse);
        bool needs_care = self.z_shift >= with_care;
        visit(needs_care);
        if constexpr (Visit::reads)
            self.z_shift = static_cast<std::int8_t>(self.z_shift % with_care + (needs_care ? with_care : 0));
    }
    // Computes the modified moments for the body's spin.
    constexpr void prepare(const BodyState<N, Spin::angular_momentum>& body, typename N::Scale scale) {
        const Work moment[3] = {x, Work(1), z};
        Work n(0), e(0);
        for (int i = 0; i < 3; ++i) {
            const Work t = N::half_turn(N::sum(body.t_b[i]), scale), t2 = t * t;
            n += t2;
            if (!is_slender) e += t2 / moment[i];
            else if (i == 0) e -= t2 * x_less_y / x;
            else if (i == 2) e += t2 * (Work(1) - z) / z;
        }
        Work sum_s(0), sum_d(0), n_power(1);
        int at = 0;
        for (int p = 1; p <= degree; ++p) {
            n_power = n_power * n;
            Work product = n_power;
            for (int a = 0; a <= p; ++a, ++at) {
                sum_s += s[at] * product;
                sum_d += d[at] * product;
                if (a < p && n > Work(0)) product = product * (e / n);
            }
        }
        // A correction beyond a quarter of a moment is outside the region of convergence of the series (a thin rod, a
        // very long step). The map without correction, of order 2, is then the better one.
        Work ratio[3];
        bool converges = true;
        for (int i = 0; i < 3; ++i) {
            const Work excess = sum_s + sum_d * moment[i];
            ratio[i] = Work(1) + excess;
            if (!(excess * Work(4) < Work(1) && Work(-1) < excess * Work(4))) converges = false;
        }
        const int up = z_shift % with_care;
        for (int i = 0; i < 3; ++i) {
            if (!converges) ratio[i] = Work(1);
            modified[i] = N::template factor<30>(moment[i] / ratio[i]);
            const Work reciprocal = ratio[i] / moment[i];
            inverse[i] = N::template factor<30>(i == 2 ? N::times_power_of_two(reciprocal, -up) : reciprocal);
        }
        if constexpr (N::fixed_point) {
            const Work j_x = x / ratio[0];
            // Fast spins about z need care too. t_z^2 is at most (e - n / I_x) / (1 / I_z - 1 / I_x) in this motion.
            // Care begins where t_z times 2 (J_x - J_z) / J_z may exceed 0.43; a turn holds 1/2.
            const Work most =
                N::times_power_of_two(z, -2 * scale.turn_shift) * N::template constant<Work>(Real{0.046875});
            const bool fast = !is_slender && !((x - z) * (e * x - n) < most);
            const bool care = is_slender || fast || !(j_x < Work(2));
            z_shift = static_cast<std::int8_t>(care ? with_care + up : up);
            if (!care) return;
            // J_x - J_y = (I_x - I_y) (1 + s) / (ratio_x ratio_y), without cancellation.
            const Work s_one = converges ? Work(1) + sum_s : Work(1);
            modified[0] = N::template factor<30>(j_x - Work(1));
            modified[1] = N::template factor<30>(N::times_power_of_two(x_less_y * s_one / (ratio[0] * ratio[1]), up));
            modified[2] = N::template factor<30>(N::times_power_of_two(z / ratio[2], up));
        }
    }
};

template <int order>
struct MoserVeselovFlow {
    static constexpr int max_sweeps = 24;

    template <class N>
    using Inertia = MoserVeselovInertia<N, order>;

    // not_converged: c was not found within max_sweeps.
    template <class N>
    TUMBLE_INLINE static Turned flow(BodyState<N, Spin::angular_momentum>& body, const Inertia<N>& inertia,
                                     const StepInfo<N>& step) {
        using Turn = typename N::Turn;
        using Angle = typename N::Angle;
        using Block = typename N::Block;
        const Dither d = step.dither;
        const auto block = Block::of(N::sum(body.t_b.x), N::sum(body.t_b.y), N::sum(body.t_b.z), inertia.z_shift,
                                     inertia.most_up, step.scale);
        if (block.is_out_of_range()) [[unlikely]]
            return careful_flow<N>(body, inertia, step);
        const Turn z_up = block.turn(N::sum(body.t_b.z), d, inertia.z_shift);
        const Vec3<Turn> t{block.turn(N::sum(body.t_b.x), d), block.turn(N::sum(body.t_b.y), d),
                           block.down(z_up, inertia.z_shift)};
        const auto& J = inertia.modified;
        typename Inertia<N>::Factor difference[3] = {J[1] - J[2], J[2] - J[0], J[0] - J[1]};

        Vec3<Turn> c{Block::times(inertia.inverse[0], t.x()), Block::times(inertia.inverse[1], t.y()),
                     Block::times(inertia.inverse[2], z_up)};
        Angle square{};
        bool converged = false;
        for (int sweep = 0; sweep < max_sweeps && !converged; ++sweep) {
            square = block.square(dot(c, c));
            const Vec3<Turn> product{block.turn(mul(c.y(), c.z())), block.turn(mul(c.z(), c.x())),
                                     block.turn(mul(c.x(), c.y()))};
            const auto correction = [&](auto axis, int up) {
                constexpr int i = axis;
                return Block::times(inertia.inverse[i], Block::rest(Block::stretched(t[i], square, d.angle),
                                                                    difference[i], product[i], J[i], c[i], up));
            };
            const Vec3<Turn> change{correction(std::integral_constant<int, 0>{}, 0),
                                    correction(std::integral_constant<int, 1>{}, 0),
                                    correction(std::integral_constant<int, 2>{}, inertia.z_shift)};
            c += change;
            converged = block.vanishes_times_itself(change, c);
        }
        // The iteration comes to a solution where that is less than a quarter turn, |c| < 1; close to it slowly, from
        // below. Otherwise it runs away, to numbers that are not finite. The body turns by the first guess then, and
        // keeps its spin.
        if constexpr (!N::fixed_point)
            for (int i = 0; !converged && !(square < Angle(1)) && i < 3; ++i) {
                c[i] = inertia.inverse[i] * t[i];
                difference[i] = {};
            }

        const auto less = [&](int i, Turn v, Turn w) { return mul(Block::twice(-difference[i], v, d), w); };
        finish<N>(body, block, c, less, step);
        return converged ? Turned::done : Turned::not_converged;
    }

private:
    // Applies the unit quaternion (1 + r, v), and t += 2 (J_j - J_k) v_j v_k. less(i, v_j, v_k) is the negative of that
    // change.
    template <class N, class Less>
    TUMBLE_INLINE static void finish(BodyState<N, Spin::angular_momentum>& body, const typename N::Block& block,
                                     const Vec3<typename N::Turn>& c, Less&& less, const StepInfo<N>& step) {
        using Block = typename N::Block;
        const Dither d = step.dither;
        const typename N::Angle r = inverse_length_less_one<N>(block.square(dot(c, c)));
        const Vec3<typename N::Turn> v{Block::stretched(c.x(), r, d.turn), Block::stretched(c.y(), r, d.turn),
                                       Block::stretched(c.z(), r, d.turn)};
        block.lower(body.t_b.x, less(0, v.y(), v.z()));
        block.lower(body.t_b.y, less(1, v.z(), v.x()));
        block.lower(body.t_b.z, less(2, v.x(), v.y()));
        turn<N>(body.q_wb,
                Delta<N>{r, {block.whole_angle(v.x(), d), block.whole_angle(v.y(), d), block.whole_angle(v.z(), d)}});
    }

    // The flow of a body whose constants need care in fixed point. It uses J_x and J_y less one, which a factor holds
    // up to J = 3, and the whole equation of z times 2^z_shift, which keeps the digits of a small J_z and its spin. Out
    // of line, because few bodies are so flat, so slender or so fast. `step` is a value, because a reference would
    // force it into memory.
    template <class N>
    [[gnu::noinline]] static Turned careful_flow(BodyState<N, Spin::angular_momentum>& body, const Inertia<N>& inertia,
                                                 StepInfo<N> step) {
        if constexpr (N::fixed_point) {
            using Turn = typename N::Turn;
            using Angle = typename N::Angle;
            using Block = typename N::Block;
            using Factor = typename Inertia<N>::Factor;
            const Dither d = step.dither;
            const int up = inertia.z_shift - Inertia<N>::with_care;
            const auto block =
                Block::of(N::sum(body.t_b.x), N::sum(body.t_b.y), N::sum(body.t_b.z), up, inertia.most_up, step.scale);
            if (up < 0 || block.is_out_of_range()) return Turned::too_far;
            const Vec3<Turn> t{block.turn(N::sum(body.t_b.x), d), block.turn(N::sum(body.t_b.y), d),
                               block.turn(N::sum(body.t_b.z), d, up)};
            constexpr Factor one = Factor::from_raw(1 << 30);
            const auto& given = inertia.modified;
            const Factor j_z{given[2].raw >> up};
            const Factor J[3] = {given[0], given[0] - Factor{given[1].raw >> up}, given[2]};
            const Factor difference[3] = {J[1] + one - j_z, j_z - J[0] - one, given[1]};

            Vec3<Turn> c{Block::times(inertia.inverse[0], t.x()), Block::times(inertia.inverse[1], t.y()),
                         Block::times(inertia.inverse[2], t.z())};
            bool converged = false;
            for (int sweep = 0; sweep < max_sweeps && !converged; ++sweep) {
                const Angle square = block.square(dot(c, c));
                const Vec3<Turn> product{block.turn(mul(c.y(), c.z())), block.turn(mul(c.z(), c.x())),
                                         block.turn(mul(c.x(), c.y()))};
                Vec3<Turn> change;
                for (int i = 0; i < 3; ++i) {
                    const Turn stretched = Block::stretched(t[i], square, d.angle);
                    change[i] = Block::times(inertia.inverse[i], Block::rest(i == 2 ? stretched : stretched - c[i],
                                                                             difference[i], product[i], J[i], c[i], 0));
                }
                c += change;
                converged = block.vanishes_times_itself(change, c);
            }
            // Doubled last: for a rod, twice the difference times v may leave the format of turns.
            const auto less = [&](int i, Turn v, Turn w) {
                const auto once = mul(Block::once(-difference[i], v, d), w);
                return typename N::TurnProduct{i == 2 ? once.raw * 2 >> up : once.raw * 2};
            };
            finish<N>(body, block, c, less, step);
            return converged ? Turned::done : Turned::not_converged;
        } else {
            return Turned::done;  // floating point has room for every spin
        }
    }
};

}  // namespace tumble

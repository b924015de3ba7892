// The exact rotation of a free rigid body over a step, by Jacobi's elliptic functions. A step may be as long as one
// likes, over any number of turns and flips, and its error is rounding alone. Floating point only.
//
// The spin is m = h/2 L / I_y, and time is counted in half steps. With alpha = 1 - I_y/I_x, beta = I_y/I_z - 1 and
// gamma = alpha + beta, none negative, Euler's equations are m_x' = beta m_y m_z, m_y' = -gamma m_z m_x,
// m_z' = alpha m_x m_y, and
//   X^2 = m_x^2 + beta/gamma m_y^2,  Z^2 = m_z^2 + alpha/gamma m_y^2,  D = alpha m_x^2 - beta m_z^2,  X^2 + Z^2 = |m|^2
// are constants: X and Z are what m_x and m_z are when m_y = 0. Let f' = sqrt((1 - A f^2) (1 - B f^2)) from f(0) = 0
// with A = alpha gamma X^2 and B = beta gamma Z^2, and p^2 = 1 - A f^2, q^2 = 1 - B f^2. Where A > B these are sn /
// sqrt(A), cn and dn, where A < B cn and dn change places, and nothing below asks which. After half a step, by the
// addition theorems (DLMF 22.8), where f, p, q are taken,
//   m (1 - alpha beta f^2 m_y^2) = (q m_x + beta f p m_y m_z, p q m_y - gamma f m_z m_x, p m_z + alpha f q m_x m_y).
// The whole step turns the body by a quaternion along (w, x m_x, y m_y, z m_z) with this m of its middle, where
//   w = R cos t,  y = p x + alpha f w = q z - beta f w,  R^2 = 1 - (gamma X Z f / |m|)^2,
//   x = (q sin t - gamma Z^2 f p cos t / |m|) / (R |m|),  z = (p sin t + gamma X^2 f q cos t / |m|) / (R |m|)
// are constants of the motion too, and only t needs an integral of the third kind: |m| times that of
// 1 - D / (|m|^2 - m_y^2) over half a step from m_y = 0. It is the half angle by which the middle axis precesses about
// L. (This follows from Jacobi's solution, for which see R. van Zon and J. Schofield, J. Comput. Phys. 225 (2007) 145,
// with the middle axis as the figure axis, and from the addition theorems.) So a step is two quadratic forms of the
// spin and one square root: the elliptic functions are needed only when something else has changed the spin. There they
// are summed for a part of the step so small that short series serve, and doubled.
#pragma once

#include <tumble/body/orientation.hpp>
#include <tumble/body/stage.hpp>
#include <tumble/integrators/rotation/elliptic.hpp>

namespace tumble {

template <class N>
class ExactInertia {
public:
    using T = typename N::Work;

    [[nodiscard]] static constexpr ExactInertia of(RealVec3 moments, typename N::Scale) {
        static_assert(!N::fixed_point, "the exact rotation is for floating point: use F32 or F64, or pdmv10 in Q32");
        const auto constant = [](Real value) { return N::template constant<T>(value); };
        const Real x = moments.y / moments.x, z = moments.y / moments.z;
        const Real alpha = Real{1} - x, beta = z - Real{1}, gamma = z - x;
        const Real share = gamma > Real{} ? beta / gamma : Real{};
        ExactInertia inertia{};
        inertia.inverse_x_ = constant(x);
        inertia.inverse_z_ = constant(z);
        inertia.alpha_ = constant(alpha);
        inertia.beta_ = constant(beta);
        inertia.gamma_ = constant(gamma);
        inertia.root_alpha_ = constant(sqrt(alpha));
        inertia.root_beta_ = constant(sqrt(beta));
        inertia.share_x_ = constant(share);
        inertia.share_z_ = constant(Real{1} - share);
        return inertia;
    }

    // Finds the constants of the motion for a body's spin. Five square roots and three divisions, and two of each for
    // every doubling: one for each factor of two by which half a step turns the body by more than about 1/16 rad.
    [[gnu::noinline]] constexpr void prepare(const BodyState<N, Spin::angular_momentum>& body, typename N::Scale) {
        const T m_x = N::sum(body.t_b.x), m_y = N::sum(body.t_b.y), m_z = N::sum(body.t_b.z);
        const T xx = m_x * m_x, yy = m_y * m_y, zz = m_z * m_z, mm = xx + yy + zz;
        HalfStep h{T(1), T(1), T(1), T(1), inverse_x_, T(1), inverse_z_};
        // Slower than this, the first term of every series is exact to rounding.
        constexpr T smallest = sizeof(T) == 4 ? T(0x1p-60) : T(0x1p-120);
        if (mm > smallest) {
            const T difference = (root_alpha_ * m_x - root_beta_ * m_z) * (root_alpha_ * m_x + root_beta_ * m_z);
            Motion motion{};
            motion.mm = mm;
            motion.twice_energy = xx * inverse_x_ + yy + zz * inverse_z_;
            motion.x2 = xx + share_x_ * yy;
            motion.z2 = zz + share_z_ * yy;
            motion.gamma_x2 = gamma_ * xx + beta_ * yy;
            motion.gamma_z2 = gamma_ * zz + alpha_ * yy;
            motion.a = alpha_ * motion.gamma_x2;
            motion.b = beta_ * motion.gamma_z2;
            motion.d = difference;
            h = half_step(motion);
        }
        constant_ = h.w;
        square_ = -(alpha_ * beta_ * h.f * h.f * h.w);
        linear_[0] = h.x * h.q;
        linear_[1] = h.y * h.p * h.q;
        linear_[2] = h.z * h.p;
        product_[0] = h.x * beta_ * h.f * h.p;
        product_[1] = -(h.y * gamma_ * h.f);
        product_[2] = h.z * alpha_ * h.f * h.q;
    }

    // Calls visit with the members that a snapshot holds.
    template <class Self, class Visit>
    static void each(Self& self, Visit& visit) {
        visit(self.constant_, self.square_, self.linear_, self.product_);
    }
    // The quaternion of a step that starts with the spin m, not of unit length: 11 multiplications.
    [[nodiscard]] TUMBLE_INLINE Quat<T> turn_of(const Vec3<T>& m) const {
        return {constant_ + square_ * (m.y() * m.y()),
                {linear_[0] * m.x() + product_[0] * (m.y() * m.z()), linear_[1] * m.y() + product_[1] * (m.z() * m.x()),
                 linear_[2] * m.z() + product_[2] * (m.x() * m.y())}};
    }

private:
    // The letters are those of the header's text; d is D.
    struct Motion {
        T mm, twice_energy, x2, z2, gamma_x2, gamma_z2, a, b, d;
    };
    struct HalfStep {
        T f, p, q, w, x, y, z;
    };

    [[nodiscard]] constexpr HalfStep half_step(const Motion& m) const {
        const T inverse_length = T(1) / sqrt(m.mm), rate = m.twice_energy * inverse_length;
        // The loop's bound follows from the exponents. Finite numbers never reach it.
        constexpr int most_doublings = sizeof(T) == 4 ? 70 : 520;
        T part = 1, part2 = 1;
        int doublings = 0;
        while ((m.a * part2 > T(0x1p-8) || m.b * part2 > T(0x1p-8) || rate * part > T(1)) &&
               doublings < most_doublings) {
            part *= T(0.5);
            part2 *= T(0.25);
            ++doublings;
        }
        HalfStep h = small_part(m, part, inverse_length, rate);
        if (doublings == 0) return h;

        // A - B, computed from D so that it keeps its digits near the separatrix. On the separatrix, where the spin
        // tends to the middle axis for ever, it is held this far from zero. That is less than the spin's own rounding
        // error and keeps p and q from underflow.
        constexpr T least = sizeof(T) == 4 ? T(0x1p-30) : T(0x1p-64);
        T a_less_b = gamma_ * m.d;
        if (N::magnitude(a_less_b) < least * m.a) a_less_b = least * m.a;
        for (; doublings > 0; --doublings) h = doubled(h, m, a_less_b);
        return h;
    }

    // A part of the half step.
    [[nodiscard]] constexpr HalfStep small_part(const Motion& m, T part, T inverse_length, T rate) const {
        HalfStep h{};
        const T part2 = part * part;
        h.f = part * elliptic_sine(m.a * part2, m.b * part2);
        const T f2 = h.f * h.f, a = m.a * f2, b = m.b * f2;
        const T c = (m.gamma_x2 * inverse_length) * (m.gamma_z2 * inverse_length) * f2;
        h.p = sqrt(T(1) - a);
        h.q = sqrt(T(1) - b);
        const T t = rate * part - m.d * inverse_length * (c * h.f * T(1.0 / 3) * carlson_rj_near_one(a, b, c));
        const auto series = SinCosSeries<T>::of(t * t);
        const T sine = t + t * series.sinc_less_one, cosine = T(1) + series.cos_less_one;
        const T r = sqrt(T(1) - c), scale = inverse_length / r, slope = h.f * (cosine * inverse_length);
        h.w = r * cosine;
        h.x = (h.q * sine - m.gamma_z2 * slope * h.p) * scale;
        h.z = (h.p * sine + m.gamma_x2 * slope * h.q) * scale;
        h.y = middle(h, m);
        return h;
    }

    // y from x or from z, whichever has more digits. The accuracy of x matters little where X is small.
    [[nodiscard]] constexpr T middle(const HalfStep& h, const Motion& m) const {
        return m.x2 > m.z2 ? h.p * h.x + alpha_ * h.f * h.w : h.q * h.z - beta_ * h.f * h.w;
    }

    // Twice the half step: the product of the turns of two steps, and the double argument. Both are scaled to w^2 + X^2
    // x^2 + Z^2 z^2 = 1 and p^2 + A f^2 = q^2 + B f^2 = 1, so that their rounding errors do not double.
    [[nodiscard]] constexpr HalfStep doubled(const HalfStep& h, const Motion& m, T a_less_b) const {
        HalfStep twice{};
        const T x = h.q * h.x, y = h.f * h.y, z = h.p * h.z;
        const T w2 = h.w * h.w - m.x2 * x * x - m.z2 * z * z + (m.gamma_x2 * y) * (m.gamma_z2 * y);
        const T x2 = T(2) * (h.w * x + m.gamma_z2 * y * z), z2 = T(2) * (h.w * z - m.gamma_x2 * y * x);
        const T unit = T(1) / sqrt(w2 * w2 + m.x2 * x2 * x2 + m.z2 * z2 * z2);
        twice.w = w2 * unit;
        twice.x = x2 * unit;
        twice.z = z2 * unit;
        const T pq = h.p * h.q, square = pq * pq, change = a_less_b * h.f * h.f, f2 = T(2) * h.f * pq;
        const T p2 = square - change, q2 = square + change, scale = T(1) / sqrt(p2 * p2 + m.a * f2 * f2);
        twice.f = f2 * scale;
        twice.p = p2 * scale;
        twice.q = q2 * scale;
        twice.y = middle(twice, m);
        return twice;
    }

    T inverse_x_{}, inverse_z_{};   // I_y / I_x, I_y / I_z
    T alpha_{}, beta_{}, gamma_{};  // as in the header's text
    T root_alpha_{}, root_beta_{};
    T share_x_{}, share_z_{};                               // beta / gamma, alpha / gamma
    T constant_{}, square_{}, linear_[3]{}, product_[3]{};  // for the present spin; see turn_of
};

struct ExactFlow {
    template <class N>
    using Inertia = ExactInertia<N>;

    template <class N>
    TUMBLE_INLINE static void flow(BodyState<N, Spin::angular_momentum>& body, const Inertia<N>& inertia,
                                   const StepInfo<N>&) {
        using T = typename N::Work;
        const Vec3<T> m{N::sum(body.t_b.x), N::sum(body.t_b.y), N::sum(body.t_b.z)};
        Quat<T> turned = inertia.turn_of(m);
        // The same turn, but by less than pi, so that 1 - cosine is |v|^2 / (1 + cosine) in every step.
        if (turned.w < T(0)) turned = {-turned.w, {-turned.v.x(), -turned.v.y(), -turned.v.z()}};
        const T vv = dot(turned.v, turned.v), length = sqrt(turned.w * turned.w + vv);
        const T excess = length + turned.w, inverse = T(1) / (length * excess), unit = excess * inverse;
        const T less = -(vv * inverse);
        const Vec3<T> v{turned.v.x() * unit, turned.v.y() * unit, turned.v.z() * unit};
        // m <- m rotated back: m + 2 (v x k - (1 + less) k), k = v x m.
        const Vec3<T> k{T(2) * (v.y() * m.z() - v.z() * m.y()), T(2) * (v.z() * m.x() - v.x() * m.z()),
                        T(2) * (v.x() * m.y() - v.y() * m.x())};
        body.t_b.x.add((v.y() * k.z() - v.z() * k.y() - less * k.x()) - k.x());
        body.t_b.y.add((v.z() * k.x() - v.x() * k.z() - less * k.y()) - k.y());
        body.t_b.z.add((v.x() * k.y() - v.y() * k.x() - less * k.z()) - k.z());
        turn<N>(body.q_wb, Delta<N>{less, v});
    }
};

}  // namespace tumble

// Every tolerance of the kernel's tests, with its derivation. Units: last places of the number concerned ("units"), or
// SI.
#pragma once

#include "worlds.hpp"

#include <cmath>

namespace tumble::test {

// A row of the table of tolerances: a column for each kind of number. Plain: without carried residuals.
struct PerSystem {
    Number f64, q32, f32, q32_plain, f32_plain;
    [[nodiscard]] Number of(const System& s) const {
        if (s.bits == 64) return f64;
        return s.fixed_point ? (s.carry ? q32 : q32_plain) : (s.carry ? f32 : f32_plain);
    }
};

namespace tests {
inline constexpr int many = 100000;  // random inputs a property is tried with
// Steps of 2^-n s: 2^-12 for order 1, 2^-7 for 2, 2^-5 for 4: errors of 1e-4 to 1e-8, the next order a hundredth of it.
inline constexpr int order_step_exponent(int order) { return 3 + 9 / order; }
}  // namespace tests

namespace tolerance {

// --- numbers -----------------------------------------------------------------------------------------------------
// Real keeps 64 bits and promises one unit of 2^-63.
inline constexpr double real_unit = 0x1p-63;
inline constexpr double real_sum = 3 * 0x1p-63;       // room for the carry costs one bit of each operand, 1 + 2 units
inline constexpr double real_root = 0x1p-61;          // Newton's last quotient, sum and halving, twice for the square
inline constexpr long double real_vector = 0x1p-58L;  // about 20 operations of 2^-63
// Scaled rounds to 31 bits: half of 2^-30 of a mantissa in [1, 2).
inline constexpr long double scaled_unit = 0x1p-31L;
inline constexpr long double scaled_quotient =
    0x1.01p-31L;                                        // the quotient is truncated 1 bit further down, then rounded
inline constexpr long double scaled_sum = 0x1.01p-31L;  // the smaller operand loses bits 31 below the larger's last
inline constexpr long double scaled_root = 0x1p-30L;    // a floor of 32 bits, then rounded to 31
// Series: truncation below the last place, and one rounding a term.
inline constexpr long double series_f32 = 0x1p-24L;
inline constexpr long double series_f64 = 0x1p-53L;
inline constexpr long double series_beyond =
    256;  // |x| to 6.3: three doublings, each up to 4 times the error, and sin^2 there
inline constexpr long double series_q32 = 0x1p-30L;  // 4 units of 2^-32: three roundings and the 2^-33 of truncation
// Kahan: 2 units^2 a step on top of the residual's own rounding.
inline constexpr long double kahan_f32 = 0x1p-40L;
inline constexpr long double kahan_f64 = 0x1p-63L;   // all that the long double it is compared with can hold
inline constexpr long double shaped_units = 1.001L;  // what is left out is always less than one unit
inline constexpr long double dither_units =
    16;  // discrepancy of a Weyl sequence: c log2 1e5, c below 1 for these alphas
inline constexpr long double dither_correlation = 1e-2;  // three times what 1e5 independent pairs would show

// --- mass properties ---------------------------------------------------------------------------------------------
inline constexpr long double closed_form = 0x1p-58L;  // a dozen operations of Real, relative
inline constexpr long double quadrature =
    1e-9L;  // Simpson's rule on 2^12 slices of a sphere: (1/4096)^2.5 at the poles
inline constexpr long double pi_as_double = 2e-16L;  // the kernel's pi is a double
inline constexpr long double jacobi = 1e-17L;        // 24 rotations of 2^-63 each, relative to the largest element

// --- order and accuracy ------------------------------------------------------------------------------------------
// The next term of the error is below a fifth of the first at the steps tried.
inline constexpr long double order_low = 0.8L;
inline constexpr long double order_high = 1.25L;
inline constexpr long double rounding_of_a_flight = 1e-12L;  // 1e4 roundings of 2^-53, all one way
inline constexpr long double reference = 1e-14L;  // 1e4 controlled steps of 1e-17, times the top's sensitivity
// The budgets of a free top after 100 s at 1/256 s.
inline constexpr long double top_pdmv6_q32 = 1e-5L;  // the same, with a rounded c whose products drive the spin
inline constexpr long double top_rk4_q32 =
    2e-6L;  // the method's own error is 8e-10: rounding to 2^-32 of a turn, carried
inline constexpr long double top_rk4_f32 = 5e-5L;
inline constexpr long double top_rk4_f64 = 2e-9L;           // h^4 w^4 of the method
inline constexpr long double top_verlet_f64 = 7e-6L;        // h^2 w^2 of the method
inline constexpr long double top_verlet_q32_excess = 0.1L;  // rounding must not show beside it
// The same top at 0.005 s. What verlet errs by is the method's own; rounding adds 0.3 %. What rk4 in q32 errs by is
// rounding: as much a step as at 1/256 s, in fewer steps, but it leans another way at each step size. Step sizes from
// 1/128 s to 1/512 s show half to eleven times the error at 1/256 s, and 0.005 s shows 2.6 times.
inline constexpr long double decimal_step_verlet_q32_excess = 0.03L;
inline constexpr long double decimal_step_rk4_q32_growth = 4;

// Flat and slender bodies in 5 s of pdmv, turning by up to 5 rad in 64 steps: what rounding adds to the method's own.
// Measured at most 7.3e-7, of a rod of 0.17 : 1 : 1, and 2.2e-7 of a hoop.
inline constexpr Number pdmv_of_any_shape = 3e-6L;
// The same in double against the exact rotation: 2.7e-10 of a rod of 1e-5, whose polynomials cancel.
inline constexpr Number pdmv10_f64 = 1e-9L;

// The exact rotation after 20 s: hundreds of roundings, to which the method adds nothing; times the growth of the
// flight.
inline constexpr PerSystem exact_rotation{2e-13L, 0, 5e-5L, 0, 1e-3L};
// A random walk of 1e-16 a step (and what a constant rounded once adds up to), of 1e-14 in steps of many turns.
inline constexpr long double million_exact_steps = 1e-12L, million_long_steps = 2e-11L;

// --- laws --------------------------------------------------------------------------------------------------------
// A method of order p after turning (or oscillating) through an angle in steps of hw: hw^p times the angle, and a
// margin.
inline Number method_error(int order, Number hw, Number angle) {
    return 2 * std::pow(hw, static_cast<Number>(order)) * angle;
}
// |q| - 1: the renormalisation follows one step behind, so (hw / 2)^2 / 2 of a step remains; and rounding.

// What |q| may be off by while the status is ok: |q|^2 within 2^-9.
inline constexpr Number unit_while_ok = 0x1.01p-10L;
//                                  f64     q32    f32    q32 plain  f32 plain
inline constexpr PerSystem start{1e-15L, 1e-8L, 1e-6L, 1e-4L, 1e-6L};
inline constexpr PerSystem reported{1e-15L, 1e-7L, 1e-6L, 1e-7L, 1e-6L};
inline constexpr PerSystem impulse{1e-14L, 1e-7L, 1e-5L, 1e-4L, 1e-5L};
inline constexpr PerSystem flight_rounding{1e-12L, 1e-6L, 1e-5L, 1e-3L, 1e-3L};
inline constexpr PerSystem coasting{1e-11L, 1e-7L, 1e-5L, 1e-3L, 1e-3L};
inline constexpr PerSystem same_flight{1e-12L, 1e-6L, 1e-4L, 1e-3L, 1e-3L};
inline constexpr PerSystem there_and_back{1e-12L, 1e-7L, 1e-4L, 1e-3L, 1e-3L};
// q32: an implicit stage is found within three units of 2^-34 of a half turn, at every step.
inline constexpr PerSystem oracle{1e-12L, 3e-7L, 1e-5L, 1e-4L, 1e-3L};
inline constexpr PerSystem loaded_oracle{1e-12L, 3e-7L, 1e-5L, 1e-4L, 1e-3L};
inline constexpr PerSystem loaded_flight{1e-12L, 1e-7L, 1e-5L, 1e-3L, 1e-3L};
inline constexpr PerSystem pair_momentum{1e-12L, 1e-7L, 1e-5L, 1e-3L, 1e-3L};
inline constexpr PerSystem stiff_floor{1e-9L, 1e-6L, 1e-5L, 1e-4L, 1e-5L};
inline Number momentum_norm(const System& s) { return PerSystem{1e-12L, 1e-7L, 1e-5L, 1e-3L, 1e-3L}.of(s); }
inline constexpr Number splitting_energy = 1e-4L;
inline Number unit_length(int order, const System& s) {
    const Number behind = order == 1 ? std::pow(0.01L, Number(2)) : std::pow(0.01L, Number(order + 1));
    return behind + PerSystem{1e-14L, 1e-8L, 1e-6L, 1e-8L, 1e-6L}.of(s);
}

// --- contacts ----------------------------------------------------------------------------------------------------
// Of the apex of an elastic ball, m: the search for the impact ends within 2^-16 of the contact band.
inline constexpr PerSystem landing{1e-7L, 2e-7L, 1e-6L, 1e-6L, 1e-5L};
inline constexpr PerSystem apex{1e-4L, 1e-3L, 1e-3L, 1e-2L, 1e-2L};
// Plain: 3e6 sums rounded to 2^-24 of themselves, which is 1e-4 at random and ten times that where they lean one way.
inline constexpr PerSystem elastic_gain{1e-3L, 1e-3L, 1e-3L, 1e-2L, 1e-2L};
inline constexpr Number contact_band = 0.001L;  // ContactSpec::tolerance
inline constexpr Number rest_speed = 1e-2L;
inline constexpr Number rest_tilt = 1e-4L;
inline constexpr PerSystem contact_impulse{1e-10L, 1e-6L, 1e-4L, 1e-3L, 1e-3L};
// What rounding leaves of a symmetric solution. At the end a corner may close its gap within a step, and corners whose
// gaps rounding has made differ by 5e-7 m then close by 1e-4 rad/s; with the method of order 1, whose last hops are
// higher, by four times that. In double precision it is what the bound of 32 sweeps leaves in the step in which a box
// comes to rest, 1.4e-9 rad/s.
inline constexpr PerSystem symmetric_spin{3e-9L, 5e-4L, 5e-4L, 5e-4L, 1e-3L};
inline constexpr Number stop_distance = 0.02L;
inline constexpr Number roll_speed = 0.01L;

// Pairs: relative to the largest speed (momentum) there, and to it times an arm. A dozen roundings: of speeds that
// contacts keep with 27 bits of the largest in fixed point, twice that where dozens of sweeps change them, and with 24
// in float; of levers, with 24 bits in both.
inline constexpr PerSystem exchange{1e-13L, 2e-7L, 1e-6L, 1e-4L, 1e-5L};
inline constexpr PerSystem levered{1e-12L, 1e-6L, 4e-6L, 1e-4L, 1e-4L};
// The same where the normal depends on the place of the impact: a gap of 2^-16 of the contact band is 1.5e-8 m, over
// half a metre between the centres, six times as much across as along, and the factor 2 of the law; and a position's
// rounding of 6e-8 m where it is a float.
inline constexpr PerSystem oblique{1e-6L, 2e-6L, 1e-5L, 1e-4L, 1e-4L};
// 200 m/s between spheres of 0.1 m: a tenth of the band, over 0.2 m, and the three-fold of a glancing impact.
inline constexpr Number bullet = 2e-3L;
// Four exchanges, and the row's own gaps: what rounding leaves of them lets a sphere move for so long.
inline constexpr Number cradle = 1e-4L;

// Rest. A tenth of the contact band in seconds of holding on: a law would say 0.
inline constexpr Number creep = 1e-4L;
inline constexpr Number still = 1e-6L;        // m and rad over 100 steps
inline constexpr Number stack_shift = 1e-2L;  // of a box's edge, the issue's
inline constexpr Number sliding = 1e-2L;      // distances, speeds and times, relative: the issue's
// What the top of a pile moves by while the rest settles below it, m: what the sweeps of a step leave of the loads,
// which they carry from box to box. Of ten boxes, sweeps alone leave 0.7 mm aside and 0.14 mm down, sweeps that go on
// as conjugate gradients do 0.35 mm and 0.025 mm. A pyramid of four rows they solve within a few steps, to 1.3 um; with
// a quarter of their bound, 20 um are left.
inline constexpr Number stack_top_aside = 5e-4L, stack_top_down = 1e-4L, pyramid_top = 1e-5L;
// Of an orbit's radius: order 1 in W h = 3.5 / 1024, for 2 pi.
inline constexpr Number turntable_orbit = 2e-2L;

// Springs. A contact that begins or ends within a step is felt from the next stage on: a kick of k x h / 2 is wrong by
// up to (w h)^2 v / 8, and the frequency of verlet by (w h)^2 / 24.
inline Number spring_speed(Number wh) { return 0.2L * wh * wh; }
inline Number spring_time(Number wh) { return 0.1L * wh * wh; }
// With damping the force jumps to c v at touch: up to a step late or early, half of it at the most: 2 z w h / 2.
inline Number damped_speed(Number damping_ratio, Number wh) { return 1.5L * damping_ratio * wh + spring_speed(wh); }
inline constexpr PerSystem spring_rounding{1e-9L, 1e-6L, 1e-5L, 1e-3L, 1e-3L};
// Nearest sample to the turning point, B / (m d^2) h^2 / 8 of d, and the method's error, (w h)^2 / 24 with w^2 = 2 B /
// (m d^3): 2e-3 at w h = 0.13; half as much again.
inline constexpr Number closest_approach = 3e-3L;
// The largest safe step against 2 / w, where verlet and every symplectic method of order 2 become unstable: never more,
// and not less than half. A lower bound is what a bouncing ball needs, because it also gains by touching down late.
inline constexpr Number safe_step_least = 0.5L, safe_step_most = 1 + 1e-6L;
// A stable oscillator of verlet at 0.9 of the limit keeps to an ellipse 1 / sqrt(1 - 0.81) = 2.3 times as long as wide.
inline constexpr Number stable_growth = 3;

}  // namespace tolerance
}  // namespace tumble::test

// What the tolerances of the kernel's tests are of, and what decides them. Their values stand in tolerances.txt, a line
// for each test that needs one; `make tolerances` prints them beside the largest errors. In SI units, relative where a
// comment or the test says so, or in last places ("units") of the number concerned.
#pragma once

#include "bound.hpp"

#include <cmath>

namespace tumble::test {

namespace tests {
inline constexpr int many = 100000;  // random inputs a property is tried with
// Steps of 2^-n s: 2^-12 for order 1, 2^-7 for 2, 2^-5 for 4: errors of 1e-4 to 1e-8, the next order a hundredth of it.
inline constexpr int order_step_exponent(int order) { return 3 + 9 / order; }
// What a load is integrated exactly to: 1e4 roundings of 2^-53, all one way.
inline constexpr Number exactly = 1e-12L;
}  // namespace tests

namespace tolerance {

inline constexpr Number contact_band = 0.001L;  // ContactSpec::tolerance

// --- numbers -----------------------------------------------------------------------------------------------------
// Real keeps 64 bits and promises one unit of 2^-63. A sum: room for the carry costs one bit of each operand, 1 + 2
// units. A root: Newton's last quotient, sum and halving, twice for the square. Vectors: about 20 operations.
inline constexpr Tolerance real_unit{"real_unit"}, real_sum{"real_sum"}, real_root{"real_root"},
    real_vector{"real_vector"};
// Scaled rounds to 31 bits: half of 2^-30 of a mantissa in [1, 2). A quotient is truncated 1 bit further down, then
// rounded; of a sum the smaller operand loses bits 31 below the larger's last; a root is a floor of 32 bits, then
// rounded to 31.
inline constexpr Tolerance scaled_unit{"scaled_unit"}, scaled_quotient{"scaled_quotient"}, scaled_sum{"scaled_sum"},
    scaled_root{"scaled_root"};
// Series: truncation below the last place, and one rounding a term. Beyond |x| = 1, to 6.3: three doublings, each up to
// 4 times the error, and sin^2 there. In fixed point units of 2^-32: three roundings and the 2^-33 of truncation.
inline constexpr Tolerance series_f32{"series_f32"}, series_f64{"series_f64"}, series_beyond_f32{"series_beyond_f32"},
    series_beyond_f64{"series_beyond_f64"}, series_q32{"series_q32"};
// Kahan: 2 units^2 a step on top of the residual's own rounding; of a double it is all that the long double it is
// compared with can hold.
inline constexpr Tolerance kahan_f32{"kahan_f32"}, kahan_f64{"kahan_f64"}, residual{"residual"};
inline constexpr Tolerance shaped_units{"shaped_units"};  // what is left out is always less than one unit
// The discrepancy of a Weyl sequence: c log2 1e5, c below 1 for these alphas. 1e5 independent pairs would correlate by
// 3e-3.
inline constexpr Tolerance dither_units{"dither_units"}, dither_correlation{"dither_correlation"};

// --- mass properties, relative ------------------------------------------------------------------------------------
inline constexpr Tolerance closed_form{"closed_form"};    // operations of Real
inline constexpr Tolerance quadrature{"quadrature"};      // Simpson's rule on 2^12 slices: (1/4096)^2.5 at a pole
inline constexpr Tolerance pi_as_double{"pi_as_double"};  // the kernel's pi is a double
inline constexpr Tolerance jacobi{"jacobi"};              // 24 rotations of 2^-63 each, of the largest element

// --- order and accuracy ------------------------------------------------------------------------------------------
// Of log2 of the ratio of errors: the next term of the error is below a fifth of the first at the steps tried.
inline constexpr Tolerance order{"order"};
inline constexpr Tolerance rounding_of_a_fall{"rounding_of_a_fall"};
inline constexpr Tolerance reference{"reference"};  // controlled steps of 1e-17, times the top's sensitivity
// A free top after 100 s at 1/256 s and 0.005 s, rad: of rk4 in f64 h^4 w^4 of the method, of verlet h^2 w^2; in 32
// bits of rk4 and pdmv rounding, to 2^-32 of a turn, carried, and of pdmv a rounded c whose products drive the spin.
inline constexpr Tolerance top_after_100_s{"top_after_100_s"}, top_after_1000_s{"top_after_1000_s"};
// Relative to the method's own error: rounding must not show beside it.
inline constexpr Tolerance top_excess{"top_excess"};
// What rk4 in q32 errs by is rounding: as much a step at 0.005 s as at 1/256 s, in fewer steps, but it leans another
// way at each step size. Step sizes from 1/128 s to 1/512 s show half to eleven times the error at 1/256 s.
inline constexpr Tolerance top_growth{"top_growth"};
inline constexpr Tolerance generic_top{"generic_top"}, heavy_top{"heavy_top"};  // the method's own
// Flat and slender bodies in 5 s of pdmv, turning by up to 5 rad in 64 steps: what rounding adds to the method's own,
// most for a rod of 0.17 : 1 : 1. In double against the exact rotation: the polynomials of a rod of 1e-5 cancel.
inline constexpr Tolerance pdmv_of_any_shape{"pdmv_of_any_shape"}, pdmv10_of_any_shape{"pdmv10_of_any_shape"};
// The exact rotation: roundings, to which the method adds nothing; times the growth of the flight.
inline constexpr Tolerance exact_rotation{"exact_rotation"};
// Energy and momentum, relative, after 1e6 steps: a random walk of 1e-16 a step (and what a constant rounded once adds
// up to), of 1e-14 in steps of many turns.
inline constexpr Tolerance million_steps_energy{"million_steps_energy"},
    million_steps_momentum{"million_steps_momentum"}, million_long_steps_energy{"million_long_steps_energy"};

// --- laws --------------------------------------------------------------------------------------------------------
// A method of order p after turning (or oscillating) through an angle in steps of hw: times hw^p and the angle.
inline constexpr Tolerance method{"method"};
inline Bound method_error(int p, Number hw, Number angle) {
    return method.of_order(p) * (std::pow(hw, static_cast<Number>(p)) * angle);
}
// A step of a rotation of order n is off by the angle of the step to the power n + 1.
inline constexpr Tolerance truncation{"truncation"};
inline Bound truncation_error(int n, Number angle) {
    return truncation.of_order(n) * std::pow(angle, static_cast<Number>(n) + 1);
}
// |q| - 1: the renormalisation follows one step behind, so a power of a step's angle remains; and rounding.
inline constexpr Tolerance unit_behind{"unit_behind"}, unit_rounding{"unit_rounding"};
inline Bound unit_length(int p, const System& s) {
    return unit_behind.of_order(p) * std::pow(0.01L, static_cast<Number>(p + 1)) + unit_rounding.of(s);
}
inline constexpr Tolerance unit{"unit"};
inline constexpr Tolerance unit_while_ok{"unit_while_ok"};  // while the status is ok |q|^2 is within 2^-9 of 1

// Rounding of a state, of what accessors report of it, of an impulse.
inline constexpr Tolerance start{"start"}, reported{"reported"}, impulse{"impulse"};
// Rounding in flights, of the spin and the orientation. Carried, it is that of the last step but for what is rounded
// before it is summed; plain, it adds up.
inline constexpr Tolerance flight_rounding{"flight_rounding"}, coasting{"coasting"}, same_flight{"same_flight"},
    there_and_back{"there_and_back"}, momentum_norm{"momentum_norm"};
// q32: an implicit stage is found within three units of 2^-34 of a half turn, at every step.
inline constexpr Tolerance oracle{"oracle"};
inline constexpr Tolerance loaded_flight{"loaded_flight"}, pair_momentum{"pair_momentum"};
inline constexpr Tolerance splitting_energy{"splitting_energy"};
inline constexpr Tolerance stiff_floor{"stiff_floor"};    // where rounding ends the decay
inline constexpr Tolerance stiff_length{"stiff_length"};  // the weight over the stiffness, and the rest of the swing
inline constexpr Tolerance saturated{"saturated"};        // of the end of a range, m or m/s
inline constexpr Tolerance wide_spring{"wide_spring"};    // of a speed in double precision, relative

// --- contacts ----------------------------------------------------------------------------------------------------
// Of the apex of an elastic ball, m: the search for the impact ends within 2^-16 of the contact band.
inline constexpr Tolerance landing{"landing"}, apex{"apex"};
// Of the energy, relative: what 1e4 searches for an impact leave, and sums rounded to 2^-24 of themselves.
inline constexpr Tolerance elastic_gain{"elastic_gain"}, elastic_loss{"elastic_loss"};
// How deep a body is beyond what it touches, and how far it is from its place, m: within the contact band where it is
// hit or put too deep, which is corrected to a quarter of the band; else what the search for the impact and rounding
// leave.
inline constexpr Tolerance depth{"depth"}, place{"place"};
inline constexpr Tolerance rest_speed{"rest_speed"}, rest_tilt{"rest_tilt"};
inline constexpr Tolerance pressed_hop{"pressed_hop"};  // times what gravity and the force add in a step
inline constexpr Tolerance contact_impulse{"contact_impulse"};
// What rounding leaves of a symmetric solution. At the end a corner may close its gap within a step, and corners whose
// gaps rounding has made differ by 5e-7 m then close by 1e-4 rad/s; with the method of order 1, whose last hops are
// higher, by four times that. In double precision it is what the bound of 32 sweeps leaves in the step in which a box
// comes to rest.
inline constexpr Tolerance symmetric_spin{"symmetric_spin"};
inline constexpr Tolerance stop_distance{"stop_distance"}, roll_speed{"roll_speed"};

// Pairs: relative to the largest speed (momentum) there, and to it times an arm. A dozen roundings: of speeds that
// contacts keep with 27 bits of the largest in fixed point, twice that where dozens of sweeps change them, and with 24
// in float; of levers, with 24 bits in both.
inline constexpr Tolerance exchange{"exchange"}, levered{"levered"};
// The same where the normal depends on the place of the impact: a gap of 2^-16 of the contact band is 1.5e-8 m, over
// half a metre between the centres, six times as much across as along, and the factor 2 of the law; and a position's
// rounding of 6e-8 m where it is a float.
inline constexpr Tolerance oblique{"oblique"};
// 200 m/s between spheres of 0.1 m: a tenth of the band, over 0.2 m, and the three-fold of a glancing impact.
inline constexpr Tolerance bullet{"bullet"};
inline constexpr Tolerance slid_lever{"slid_lever"};  // of the impulse of a contact that lasts, times the way slid
// Exchanges, and the row's own gaps: what rounding leaves of them lets a sphere move for so long.
inline constexpr Tolerance cradle{"cradle"};
inline constexpr Tolerance passed{"passed"};            // a flight without contacts
inline constexpr Tolerance whole_steps{"whole_steps"};  // by which a way there and back differs from them

// Rest: a law would say 0.
inline constexpr Tolerance creep{"creep"};
inline constexpr Tolerance still{"still"};              // m and rad over 100 steps
inline constexpr Tolerance stack_shift{"stack_shift"};  // of a box's edge
inline constexpr Tolerance sliding{"sliding"};          // distances, speeds and times, relative
inline constexpr Tolerance slip{"slip"};                // of the speed, once it rolls
// What the top of a pile moves by while the rest settles below it, m: what the sweeps of a step leave of the loads,
// which they carry from box to box.
inline constexpr Tolerance stack_top_aside{"stack_top_aside"}, stack_top_down{"stack_top_down"},
    pyramid_top{"pyramid_top"};
inline constexpr Tolerance turntable_rounding{"turntable_rounding"}, turntable_spin{"turntable_spin"};
// Of an orbit's radius: order 1 in W h = 3.5 / 1024, for 2 pi.
inline constexpr Tolerance turntable_orbit{"turntable_orbit"};
inline constexpr Tolerance brief_bounce{"brief_bounce"};  // of the speed
inline constexpr Tolerance far_plane{"far_plane"};        // of a place in double precision, m

// Springs, relative. A contact that begins or ends within a step is felt from the next stage on: a kick of k x h / 2 is
// wrong by up to (w h)^2 v / 8, and the frequency of verlet by (w h)^2 / 24.
inline constexpr Tolerance spring_speed_in_wh{"spring_speed_in_wh"}, spring_time_in_wh{"spring_time_in_wh"};
inline Bound spring_speed(Number wh) { return spring_speed_in_wh * (wh * wh); }
inline Bound spring_time(Number wh) { return spring_time_in_wh * (wh * wh); }
// With damping the force jumps to c v at touch: up to a step late or early, half of it at the most: 2 z w h / 2.
inline constexpr Tolerance damped_speed_in_wh{"damped_speed_in_wh"};
inline Bound damped_speed(Number damping_ratio, Number wh) {
    return damped_speed_in_wh * (damping_ratio * wh + wh * wh / 8);
}
inline constexpr Tolerance spring_rounding{"spring_rounding"};
inline constexpr Tolerance barrier_energy{"barrier_energy"}, barrier_height{"barrier_height"};
inline constexpr Tolerance rest_depth{"rest_depth"};
// Nearest sample to the turning point, B / (m d^2) h^2 / 8 of d, and the method's error, (w h)^2 / 24 with w^2 = 2 B /
// (m d^3): 2e-3 at w h = 0.13.
inline constexpr Tolerance closest_approach{"closest_approach"};
// The largest safe step against 2 / w, where verlet and every symplectic method of order 2 become unstable: never more,
// and not less than half. A lower bound is what a bouncing ball needs, because it also gains by touching down late.
inline constexpr Number safe_step_least = 0.5L, safe_step_most = 1 + 1e-6L;
inline constexpr Tolerance safe_step{"safe_step"};  // relative
// A stable oscillator of verlet at 0.9 of the limit keeps to an ellipse 1 / sqrt(1 - 0.81) = 2.3 times as long as wide.
inline constexpr Tolerance stable_growth{"stable_growth"};

}  // namespace tolerance
}  // namespace tumble::test

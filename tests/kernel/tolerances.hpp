// The quantities of the tolerances of the kernel's tests, and the reasons for their sizes. The values are in
// tolerances.txt, one line for each test that needs one. `make tolerances` prints them beside the largest errors. They
// are in SI units, relative if a comment or the test says so, or in last places ("units") of the number.
#pragma once

#include "bound.hpp"

#include <cmath>

namespace tumble::test {

namespace tests {
inline constexpr int many = 100000;  // random inputs for each property
// Steps of 2^-n s: 2^-12 for order 1, 2^-7 for 2, 2^-5 for 4: errors of 1e-4 to 1e-8, the next order a hundredth of it.
inline constexpr int order_step_exponent(int order) { return 3 + 9 / order; }
// The error of a load that is integrated exactly: 1e4 rounding errors of 2^-53, all in one direction.
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
// Kahan: 2 units^2 a step besides the rounding of the residual itself. For a double that is below the resolution of the
// long double of the comparison.
inline constexpr Tolerance kahan_f32{"kahan_f32"}, kahan_f64{"kahan_f64"}, residual{"residual"};
inline constexpr Tolerance shaped_units{"shaped_units"};  // the error that is left for the next step is below one unit
// The discrepancy of a Weyl sequence: c log2 1e5, c below 1 for these alphas. 1e5 independent pairs would correlate by
// 3e-3.
inline constexpr Tolerance dither_units{"dither_units"}, dither_correlation{"dither_correlation"};

// --- mass properties, relative ------------------------------------------------------------------------------------
inline constexpr Tolerance closed_form{"closed_form"};    // operations of Real
inline constexpr Tolerance quadrature{"quadrature"};      // Simpson's rule on 2^12 slices: (1/4096)^2.5 at a pole
inline constexpr Tolerance pi_as_double{"pi_as_double"};  // the kernel's pi is a double
inline constexpr Tolerance jacobi{"jacobi"};              // 24 rotations of 2^-63 each, of the largest element

// --- order and accuracy ------------------------------------------------------------------------------------------
// Error of log2 of the ratio of errors. At the steps of the test, the next term of the error is below a fifth of the
// first.
inline constexpr Tolerance order{"order"};
inline constexpr Tolerance rounding_of_a_fall{"rounding_of_a_fall"};
inline constexpr Tolerance reference{"reference"};  // controlled steps of 1e-17, times the top's sensitivity
// A free top after 100 s at 1/256 s and 0.005 s, rad. For rk4 in f64 it is the method's h^4 w^4, for verlet h^2 w^2. In
// 32 bits, for rk4 and pdmv, it is rounding to 2^-32 of a turn, carried; for pdmv also the rounded c, whose products
// change the spin.
inline constexpr Tolerance top_after_100_s{"top_after_100_s"}, top_after_1000_s{"top_after_1000_s"};
// Relative to the error of the method: the rounding error must be negligible beside it.
inline constexpr Tolerance top_excess{"top_excess"};
// The error of rk4 in q32 is rounding: the same in a step at 0.005 s as at 1/256 s, in fewer steps, but with another
// sign at each step size. From 1/128 s to 1/512 s the error is half to eleven times that at 1/256 s.
inline constexpr Tolerance top_growth{"top_growth"};
inline constexpr Tolerance generic_top{"generic_top"}, heavy_top{"heavy_top"};  // the error of the method
// Flat and slender bodies in 5 s of pdmv, with turns of up to 5 rad in 64 steps: the rounding error besides the error
// of the method, largest for a rod of 0.17 : 1 : 1. In double against the exact rotation: the polynomials of a rod of
// 1e-5 cancel.
inline constexpr Tolerance pdmv_of_any_shape{"pdmv_of_any_shape"}, pdmv10_of_any_shape{"pdmv10_of_any_shape"};
// The exact rotation: rounding only, because the method has no error, times the growth of the flight.
inline constexpr Tolerance exact_rotation{"exact_rotation"};
// Energy and momentum, relative, after 1e6 steps: a random walk of 1e-16 a step, and the sum of the error of a constant
// that is rounded once; a random walk of 1e-14 for steps of many turns.
inline constexpr Tolerance million_steps_energy{"million_steps_energy"},
    million_steps_momentum{"million_steps_momentum"}, million_long_steps_energy{"million_long_steps_energy"};

// --- laws --------------------------------------------------------------------------------------------------------
// The error of a method of order p after a rotation or oscillation through an angle in steps of hw. Multiplied by hw^p
// and the angle.
inline constexpr Tolerance method{"method"};
inline Bound method_error(int p, Number hw, Number angle) {
    return method.of_order(p) * (std::pow(hw, static_cast<Number>(p)) * angle);
}
// A step of a rotation of order n is off by the angle of the step to the power n + 1.
inline constexpr Tolerance truncation{"truncation"};
inline Bound truncation_error(int n, Number angle) {
    return truncation.of_order(n) * std::pow(angle, static_cast<Number>(n) + 1);
}
// |q| - 1. The renormalisation is one step late, so a power of the angle of a step remains, and rounding.
inline constexpr Tolerance unit_behind{"unit_behind"}, unit_rounding{"unit_rounding"};
inline Bound unit_length(int p, const System& s) {
    return unit_behind.of_order(p) * std::pow(0.01L, static_cast<Number>(p + 1)) + unit_rounding.of(s);
}
inline constexpr Tolerance unit{"unit"};
inline constexpr Tolerance unit_while_ok{"unit_while_ok"};  // while the status is ok |q|^2 is within 2^-9 of 1

// Rounding of a state, of the accessors' values, and of an impulse.
inline constexpr Tolerance start{"start"}, reported{"reported"}, impulse{"impulse"};
// Rounding of the spin and the orientation in flights. With carry it is that of the last step, and of values that are
// rounded before they are summed. Without carry it adds up.
inline constexpr Tolerance flight_rounding{"flight_rounding"}, coasting{"coasting"}, same_flight{"same_flight"},
    there_and_back{"there_and_back"}, momentum_norm{"momentum_norm"};
// Spins of up to 100 rad/s at 1/60 s: rounding of the orientation, a rad/s, and of the spin, relative. A spin in parts
// of a step against one in steps of that length, which have other dithers: a rad/s, relative, and in m and m/s, where a
// part of a step is a fraction of 31 bits.
inline constexpr Tolerance fast_turn{"fast_turn"}, fast_spin{"fast_spin"}, parts_turn{"parts_turn"},
    parts_spin{"parts_spin"}, parts_drift{"parts_drift"};
// m/s, of a ball that slid until it rolled: a step of friction begins and ends with a whole step.
inline constexpr Tolerance rolling{"rolling"};
// q32: each step finds its implicit stage to within three units of 2^-34 of a half turn.
inline constexpr Tolerance oracle{"oracle"};
inline constexpr Tolerance loaded_flight{"loaded_flight"}, pair_momentum{"pair_momentum"};
inline constexpr Tolerance splitting_energy{"splitting_energy"};
inline constexpr Tolerance stiff_floor{"stiff_floor"};    // the level at which rounding ends the decay
inline constexpr Tolerance stiff_length{"stiff_length"};  // the weight over the stiffness, and the rest of the swing
inline constexpr Tolerance saturated{"saturated"};        // of the end of a range, m or m/s
inline constexpr Tolerance wide_spring{"wide_spring"};    // of a speed in double precision, relative

// --- contacts ----------------------------------------------------------------------------------------------------
// Error of the apex of an elastic ball, m. The search for the impact ends within 2^-16 of the contact band.
inline constexpr Tolerance landing{"landing"}, apex{"apex"};
// Relative error of the energy: the residual errors of 1e4 searches for an impact, and sums rounded to 2^-24 relative.
inline constexpr Tolerance elastic_gain{"elastic_gain"}, elastic_loss{"elastic_loss"};
// The penetration of a body and its distance from its place, m. Within the contact band if the body was hit or placed
// too deep, which is corrected to a quarter of the band. Otherwise the errors of the search for the impact and of
// rounding.
inline constexpr Tolerance depth{"depth"}, place{"place"};
inline constexpr Tolerance rest_speed{"rest_speed"}, rest_tilt{"rest_tilt"};
inline constexpr Tolerance pressed_hop{"pressed_hop"};  // times the change of speed by gravity and the force in a step
inline constexpr Tolerance contact_impulse{"contact_impulse"};
// The asymmetry of a symmetric solution. At the end a corner may close its gap within a step. Rounding makes the gaps
// of corners differ by 5e-7 m; closing them gives a spin of 1e-4 rad/s, and four times that with the method of order 1,
// whose last hops are higher. In double precision it is the residual of 32 sweeps in the step in which a box comes to
// rest.
inline constexpr Tolerance symmetric_spin{"symmetric_spin"};

// Pairs: relative to their largest speed or momentum, and to that times an arm. A dozen rounding errors. Speeds have 27
// bits of the largest one in fixed point and 24 in float; the error is doubled where dozens of sweeps change them.
// Levers have 24 bits in both.
inline constexpr Tolerance exchange{"exchange"}, levered{"levered"};
// The same if the normal depends on the place of the impact: a gap of 2^-16 of the contact band is 1.5e-8 m, over half
// a metre between the centres, six times as much across as along, and the factor 2 of the law. In float also the
// rounding error of 6e-8 m of a position.
inline constexpr Tolerance oblique{"oblique"};
// 200 m/s between spheres of 0.1 m: a tenth of the band, over 0.2 m, and the three-fold of a glancing impact.
inline constexpr Tolerance bullet{"bullet"};
inline constexpr Tolerance slid_lever{"slid_lever"};  // of the impulse of a contact that lasts, times the way slid
// Exchanges, and the gaps of the row: their rounding errors let a sphere move for the rest of the test.
inline constexpr Tolerance cradle{"cradle"};
inline constexpr Tolerance passed{"passed"};            // a flight without contacts
inline constexpr Tolerance whole_steps{"whole_steps"};  // difference of a way there and back from whole steps

// Rest: by the law, 0.
inline constexpr Tolerance creep{"creep"};
inline constexpr Tolerance still{"still"};              // m and rad over 100 steps
inline constexpr Tolerance stack_shift{"stack_shift"};  // of a box's edge
inline constexpr Tolerance sliding{"sliding"};          // distances, speeds and times, relative
inline constexpr Tolerance slip{"slip"};                // of the speed, once it rolls
inline constexpr Tolerance turntable_rounding{"turntable_rounding"}, turntable_spin{"turntable_spin"};
inline constexpr Tolerance brief_bounce{"brief_bounce"};  // of the speed
inline constexpr Tolerance far_plane{"far_plane"};        // of a place in double precision, m

// Springs, relative. A contact that begins or ends within a step acts from the next stage on: a kick of k x h / 2 is
// off by up to (w h)^2 v / 8, and the frequency of verlet by (w h)^2 / 24.
inline constexpr Tolerance spring_speed_in_wh{"spring_speed_in_wh"}, spring_time_in_wh{"spring_time_in_wh"};
inline Bound spring_speed(Number wh) { return spring_speed_in_wh * (wh * wh); }
inline Bound spring_time(Number wh) { return spring_time_in_wh * (wh * wh); }
// With damping the force jumps to c v at contact, up to a step late or early; half of that counts at most: 2 z w h / 2.
inline constexpr Tolerance damped_speed_in_wh{"damped_speed_in_wh"};
inline Bound damped_speed(Number damping_ratio, Number wh) {
    return damped_speed_in_wh * (damping_ratio * wh + wh * wh / 8);
}
inline constexpr Tolerance spring_rounding{"spring_rounding"};
inline constexpr Tolerance barrier_energy{"barrier_energy"}, barrier_height{"barrier_height"};
inline constexpr Tolerance rest_depth{"rest_depth"};
// The distance of the nearest sample from the turning point, B / (m d^2) h^2 / 8 relative to d, and the error of the
// method, (w h)^2 / 24 with w^2 = 2 B / (m d^3): 2e-3 at w h = 0.13.
inline constexpr Tolerance closest_approach{"closest_approach"};
// The largest safe step relative to 2 / w, beyond which verlet and every symplectic method of order 2 are unstable:
// never more, and not less than half. A bouncing ball needs a lower bound, because its late touch-down adds energy too.
inline constexpr Number safe_step_least = 0.5L, safe_step_most = 1 + 1e-6L;
inline constexpr Tolerance safe_step{"safe_step"};  // relative
// An oscillator of verlet at 0.9 of the limit stays on an ellipse that is 1 / sqrt(1 - 0.81) = 2.3 times as long as
// wide.
inline constexpr Tolerance stable_growth{"stable_growth"};

}  // namespace tolerance
}  // namespace tumble::test

// Switches that every tumble header agrees on; each of them includes this first, so users never order includes.
// Eigen is used for fixed-size storage and element-wise work only: no heap, no streams, no SIMD reordering of sums.
//
// Conventions of the whole kernel: SI units and radians; world frame `_w`, body frame `_b` (origin at the centre of
// mass, axes along the principal axes); quaternions are Hamilton's, stored w, x, y, z, and `q_wb` rotates body
// vectors into the world.
#pragma once

// What would give other bits than every other build has; each with the option that mends it.
#if __cplusplus < 202002L
#error "tumble needs C++20: compile with -std=c++20 or newer"
#endif
#ifdef __FAST_MATH__
#error "tumble gives the same bits everywhere, which -ffast-math and -Ofast do not: add -fno-fast-math behind them"
#elif defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
#error "tumble reports what is not finite: compile without -ffinite-math-only, or add -fno-finite-math-only behind it"
#elif defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__)
#error "tumble gives the same bits everywhere: add -fno-unsafe-math-optimizations, drop -fassociative-math and the like"
#elif defined(__NO_SIGNED_ZEROS__)
#error "tumble gives the same bits everywhere, the sign of zero among them: add -fsigned-zeros"
#endif
#if defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ != 0 && __FLT_EVAL_METHOD__ != 16  // 16: _Float16 alone
#error "tumble gives the same bits everywhere, which excess precision does not: compile with -msse2 -mfpmath=sse"
#endif
static_assert(sizeof(0.1) == sizeof(double),
              "tumble's constants are of double precision: compile without -fsingle-precision-constant");

#ifdef EIGEN_CORE_H
#error                                                                                                                 \
    "include <tumble/tumble.hpp> before Eigen, or define EIGEN_DONT_VECTORIZE and EIGEN_NO_MALLOC for the whole program"
#endif
#ifndef EIGEN_NO_MALLOC
#define EIGEN_NO_MALLOC
#endif
#ifndef EIGEN_NO_IO
#define EIGEN_NO_IO
#endif
#ifndef EIGEN_DONT_VECTORIZE
#define EIGEN_DONT_VECTORIZE
#endif
#ifndef eigen_assert
#define eigen_assert(condition) ((void)0)
#endif

// All that the kernel uses of others. A warning of Eigen's code, where its directory is not a system's, is nobody's
// here.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-variable"
#include <Eigen/Core>
#pragma GCC diagnostic pop

#include <bit>
#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <type_traits>
#include <utility>

// Misuse (a bad id, a mass that is not positive) ends here. Define it before the first include to send it elsewhere,
// for example to a semihosting console; it must not return.
#ifndef TUMBLE_ASSERT
#define TUMBLE_ASSERT(condition) ((condition) ? (void)0 : __builtin_trap())
#endif

// The step's inner functions must be inlined for values to stay in registers; compilers stop too early at -O2.
#ifndef TUMBLE_INLINE
#define TUMBLE_INLINE [[gnu::always_inline]] inline
#endif

#ifndef TUMBLE_SET_UP
#ifdef __clang__
#define TUMBLE_SET_UP [[gnu::noinline]]
#else
// Set-up is kept out of line, and whole: of functions that take numbers of set-up by value GCC 12 makes copies at -O3,
// cut to the parts that callers need (IPA-SRA), which read what was not passed (measured on ARM and RISC-V: three
// constants of pdmv6 in doubles were wrong).
#define TUMBLE_SET_UP [[gnu::noinline, gnu::noclone]]
#endif
#endif

// A product and a sum are rounded each, whatever the compiler's own choice is for the core: from here on no
// multiply-add is fused. <tumble/tumble.hpp> ends that where the kernel ends; behind another header that is included
// first it holds to the end of the file. GCC does not inline functions with such an option of their own into the
// user's, so they have it only where there is an instruction that fuses; with -ffp-contract=off on the command line
// nothing differs. What -ffp-contract=fast makes of clang, no pragma ends: give it -ffp-contract=on or off.
#if defined(__clang__)
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wignored-pragmas"  // not every core has float_control
#pragma float_control(precise, on)
#pragma clang diagnostic pop
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__) && (defined(__FP_FAST_FMAF) || defined(__FP_FAST_FMA) || defined(__FMA__))
#pragma GCC optimize("fp-contract=off")
#endif

// Switches on which every tumble header agrees. Each header includes this one first, so users need no order of
// includes. Eigen is used for fixed-size storage and element-wise work only: no heap, no streams, no SIMD that reorders
// sums.
//
// Conventions of the whole kernel: SI units and radians. World frame `_w`; body frame `_b`, with its origin at the
// centre of mass and its axes along the principal axes. Quaternions are Hamilton's, stored w, x, y, z; `q_wb` rotates
// body vectors into the world.
#pragma once

// Options that would change the bits are errors. Each message names the option that cures it.
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

// All headers of others that the kernel uses. Warnings in Eigen's code are switched off, also if its directory is not a
// system directory.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-variable"
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"  // of copies of stages, which are in loops over a group
#endif
#include <Eigen/Core>
#pragma GCC diagnostic pop

#include <bit>
#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <tuple>
#include <type_traits>
#include <utility>

// Misuse (a bad id, a mass that is not positive) ends here. Define the macro before the first include to handle misuse
// otherwise, for example to print to a semihosting console. It must not return.
#ifndef TUMBLE_ASSERT
#define TUMBLE_ASSERT(condition) ((condition) ? (void)0 : __builtin_trap())
#endif

// The inner functions of a step must be inlined, so that values stay in registers. At -O2 compilers inline too few of
// them.
#ifndef TUMBLE_INLINE
#define TUMBLE_INLINE [[gnu::always_inline]] inline
#endif

#ifndef TUMBLE_SET_UP
#ifdef __clang__
#define TUMBLE_SET_UP [[gnu::noinline]]
#else
// Set-up functions are neither inlined nor cloned. At -O3, GCC 12 clones functions that take set-up numbers by value
// and passes only the parts that callers need (IPA-SRA). The clones read parts that were not passed: on ARM and RISC-V
// three constants of pdmv6 in double were wrong.
#define TUMBLE_SET_UP [[gnu::noinline, gnu::noclone]]
#endif
#endif

// A set-up function that runs once a body or less: compiled for size. A caller that programs call reaches it through
// detail::run_once().
#define TUMBLE_COLD TUMBLE_SET_UP [[gnu::cold]]

namespace tumble::detail {

// Calls f, which calls cold functions. GCC takes a function that always calls a cold one for cold itself, and so its
// callers, up to a program's loop of steps. It cannot see that this call is always made.
template <class F>
TUMBLE_INLINE constexpr void run_once(F&& f) {
    int always = 1;
    if (!std::is_constant_evaluated()) asm("" : "+r"(always));
    if (always != 0) f();
}

}  // namespace tumble::detail

// From here on no multiply-add is fused, so a product and a sum are rounded each, whatever the compiler's default for
// the core. At the end of the kernel <tumble/tumble.hpp> restores the user's choice. If another header of the kernel is
// included first, the setting holds to the end of the file. GCC does not inline functions with this option into
// functions without it, so they have it only on cores with fused instructions. With -ffp-contract=off on the command
// line nothing differs. No pragma ends clang's -ffp-contract=fast: use -ffp-contract=on or off.
#if defined(__clang__)
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wignored-pragmas"  // not every core has float_control
#pragma float_control(precise, on)
#pragma clang diagnostic pop
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__) && (defined(__FP_FAST_FMAF) || defined(__FP_FAST_FMA) || defined(__FMA__))
#pragma GCC optimize("fp-contract=off")
#endif

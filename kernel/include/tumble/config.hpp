// Switches that every tumble header agrees on; each of them includes this first, so users never order includes.
// Eigen is used for fixed-size storage and element-wise work only: no heap, no streams, no SIMD reordering of sums.
//
// Conventions of the whole kernel: SI units and radians; world frame `_w`, body frame `_b` (origin at the centre of
// mass, axes along the principal axes); quaternions are Hamilton's, stored w, x, y, z, and `q_wb` rotates body
// vectors into the world.
#pragma once

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

// Misuse (a bad id, a mass that is not positive) ends here. Define it before the first include to send it elsewhere,
// for example to a semihosting console; it must not return.
#ifndef TUMBLE_ASSERT
#define TUMBLE_ASSERT(condition) ((condition) ? (void)0 : __builtin_trap())
#endif

// The step's inner functions must be inlined for values to stay in registers; compilers stop too early at -O2.
#ifndef TUMBLE_INLINE
#define TUMBLE_INLINE [[gnu::always_inline]] inline
#endif

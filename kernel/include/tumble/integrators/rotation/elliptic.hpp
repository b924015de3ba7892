// The two elliptic functions that the exact free rotation begins with, for arguments so small that a short series is
// exact to rounding. Larger arguments are reached by doubling (exact_flow.hpp). float and double; no square root but
// one.
#pragma once

#include <tumble/numbers/functions.hpp>

namespace tumble {

// f(1), where f(0) = 0 and f' = sqrt((1 - a f^2) (1 - b f^2)): sn(sqrt(a), k) / sqrt(a) of the modulus k^2 = b / a, but
// symmetric in a and b, so that neither need be the larger and both may be zero. 0 <= a, b <= 1/256; the first term
// left out is below a third of a unit in the last place. Maclaurin's series of sn (DLMF 22.10.4), in a + b and ab.
template <class T>
[[nodiscard]] constexpr T elliptic_sine(T a, T b) {
    const T sum = a + b, square = sum * sum, product = a * b;
    const T c1 = sum * T(1.0 / 6);
    const T c2 = (square + T(12) * product) * T(1.0 / 120);
    if constexpr (sizeof(T) == 4) {
        return T(1) - (c1 - c2);
    } else {
        const T c3 = sum * (square + T(132) * product) * T(1.0 / 5040);
        const T c4 = (square * (square + T(1224) * product) + T(3024) * product * product) * T(1.0 / 362880);
        const T c5 = sum * (square * (square + T(11064) * product) + T(132624) * product * product) * T(1.0 / 39916800);
        return T(1) - (c1 - (c2 - (c3 - (c4 - c5))));
    }
}

// The integral of f^2 / (1 - c f^2) over dt, from 0 to where f is what it is at the end, for squares a f^2, b f^2 and
// c f^2 in [0, 1/256] and c between a and b: f^3 / 3 R_J(1 - a f^2, 1 - b f^2, 1, 1 - c f^2). This is R_J, by the
// series about its arguments' mean (B. C. Carlson, Numer. Algorithms 10 (1995) 13; DLMF 19.36.2) to 1e-13 in double and
// 1e-5 in float, which is less than rounding in a term that is a thousandth of what it is added to. One square root.
template <class T>
[[nodiscard]] constexpr T carlson_rj_near_one(T a, T b, T c) {
    const T mean = (a + b + c + c) * T(0.2), inverse = T(1) / (T(1) - mean), leading = inverse * sqrt(inverse);
    if constexpr (sizeof(T) == 4) {
        return leading;
    } else {
        const T x = (a - mean) * inverse, y = (b - mean) * inverse, z = -mean * inverse, p = (c - mean) * inverse;
        const T pp = p * p, xyz = x * y * z;
        const T e2 = x * y + (x + y) * z - T(3) * pp;
        const T e3 = xyz + T(2) * p * (e2 + T(2) * pp);
        const T e4 = p * (T(2) * xyz + p * (e2 + T(3) * pp));
        const T e5 = xyz * pp;
        return leading * (T(1) - (e2 * T(3.0 / 14) - (e3 * T(1.0 / 6) + e2 * e2 * T(9.0 / 88) - e4 * T(3.0 / 22) -
                                                      e2 * e3 * T(9.0 / 52) + e5 * T(3.0 / 26))));
    }
}

}  // namespace tumble

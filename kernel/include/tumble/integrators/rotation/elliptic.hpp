// The two elliptic functions with which the exact free rotation begins, for arguments so small that a short series is
// exact to rounding. exact_flow.hpp reaches larger arguments by doubling. For float and double. One square root.
#pragma once

#include <tumble/numbers/functions.hpp>

namespace tumble {

// f(1), where f(0) = 0 and f' = sqrt((1 - a f^2) (1 - b f^2)). This is sn(sqrt(a), k) / sqrt(a) with the modulus k^2 =
// b / a, but symmetric in a and b: either may be the larger, and both may be zero. 0 <= a, b <= 1/256. The first
// omitted term is below a third of a unit in the last place. Maclaurin's series of sn (DLMF 22.10.4), in a + b and ab.
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

// R_J in the integral of f^2 / (1 - c f^2) over t, which is f^3 / 3 R_J(1 - a f^2, 1 - b f^2, 1, 1 - c f^2), from 0 to
// the end value of f. For a f^2, b f^2 and c f^2 in [0, 1/256] and c between a and b. By the series about the mean of
// the arguments (B. C. Carlson, Numer. Algorithms 10 (1995) 13; DLMF 19.36.2), to 1e-13 in double and 1e-5 in float.
// The term is a thousandth of the number to which it is added, so that error is below rounding. One square root.
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

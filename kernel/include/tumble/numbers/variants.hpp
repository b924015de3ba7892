// The number systems with and without carried residuals, under the names that programs and result rows use. Each maps
// the range that a scene declares to a type; floating point has no range to declare.
#pragma once

#include <tumble/numbers/systems.hpp>

namespace tumble::variants {

struct q32 {
    template <class Range>
    using Numbers = Q32<Range, true>;
};
struct q32_plain {
    template <class Range>
    using Numbers = Q32<Range, false>;
};
struct f32 {
    template <class>
    using Numbers = Float<float, true>;
};
struct f32_plain {
    template <class>
    using Numbers = Float<float, false>;
};
struct f64 {
    template <class>
    using Numbers = Float<double, false>;
};

}  // namespace tumble::variants

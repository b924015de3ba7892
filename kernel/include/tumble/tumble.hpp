// tumble: rigid bodies on small hardware, with the same bits everywhere. Includes the whole kernel. After it, the
// user's macros and floating-point options are the same as before.
#pragma once

// Macros of Arduino, of its boards' pins and of others whose names the kernel, Eigen or the standard library use.
#pragma push_macro("A0")
#pragma push_macro("A1")
#pragma push_macro("A2")
#pragma push_macro("A3")
#pragma push_macro("B0")
#pragma push_macro("B1")
#pragma push_macro("B2")
#pragma push_macro("B3")
#pragma push_macro("C0")
#pragma push_macro("C1")
#pragma push_macro("C2")
#pragma push_macro("C3")
#pragma push_macro("D0")
#pragma push_macro("D1")
#pragma push_macro("D2")
#pragma push_macro("D3")
#pragma push_macro("F")
#pragma push_macro("K")
#pragma push_macro("abs")
#pragma push_macro("max")
#pragma push_macro("min")
#pragma push_macro("round")
#undef A0
#undef A1
#undef A2
#undef A3
#undef B0
#undef B1
#undef B2
#undef B3
#undef C0
#undef C1
#undef C2
#undef C3
#undef D0
#undef D1
#undef D2
#undef D3
#undef F
#undef K
#undef abs
#undef max
#undef min
#undef round

// See the end of config.hpp.
#if defined(__clang__)
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wignored-pragmas"
#pragma float_control(push)
#pragma clang diagnostic pop
#elif defined(__GNUC__)
#pragma GCC push_options
// GCC warns that the constant bound of an array, an int, changes its sign.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-conversion"
#endif

#include <tumble/integrators/list.hpp>
#include <tumble/loads/air.hpp>
#include <tumble/loads/gravity_gradient.hpp>
#include <tumble/loads/wheels.hpp>
#include <tumble/replay.hpp>
#include <tumble/version.hpp>
#include <tumble/world.hpp>

#if defined(__clang__)
#pragma STDC FP_CONTRACT DEFAULT
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wignored-pragmas"
#pragma float_control(pop)
#pragma clang diagnostic pop
#elif defined(__GNUC__)
#pragma GCC pop_options
#pragma GCC diagnostic pop
#endif

#pragma pop_macro("A0")
#pragma pop_macro("A1")
#pragma pop_macro("A2")
#pragma pop_macro("A3")
#pragma pop_macro("B0")
#pragma pop_macro("B1")
#pragma pop_macro("B2")
#pragma pop_macro("B3")
#pragma pop_macro("C0")
#pragma pop_macro("C1")
#pragma pop_macro("C2")
#pragma pop_macro("C3")
#pragma pop_macro("D0")
#pragma pop_macro("D1")
#pragma pop_macro("D2")
#pragma pop_macro("D3")
#pragma pop_macro("F")
#pragma pop_macro("K")
#pragma pop_macro("abs")
#pragma pop_macro("max")
#pragma pop_macro("min")
#pragma pop_macro("round")

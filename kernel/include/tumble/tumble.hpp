// tumble: rigid bodies on small hardware, with the same bits everywhere. Includes the whole kernel. After it, the
// user's macros and floating-point options are the same as before.
#pragma once

// Macros of Arduino and others whose names the kernel, Eigen or the standard library use.
#pragma push_macro("B1")
#pragma push_macro("F")
#pragma push_macro("abs")
#pragma push_macro("max")
#pragma push_macro("min")
#pragma push_macro("round")
#undef B1
#undef F
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

#pragma pop_macro("B1")
#pragma pop_macro("F")
#pragma pop_macro("abs")
#pragma pop_macro("max")
#pragma pop_macro("min")
#pragma pop_macro("round")

// All integrators. A new method is one header and one line here. The simulator, the firmware, the tests and the
// benchmarks read this list.
#pragma once

#include <tumble/integrators/exact.hpp>
#include <tumble/integrators/implicit.hpp>
#include <tumble/integrators/pdmv.hpp>
#include <tumble/integrators/runge_kutta.hpp>
#include <tumble/integrators/semi_implicit_euler.hpp>
#include <tumble/integrators/strang.hpp>
#include <tumble/integrators/suzuki4.hpp>
#include <tumble/integrators/verlet.hpp>

namespace tumble {

template <class... Methods>
struct IntegratorList {
    static constexpr int count = sizeof...(Methods);

    // Calls f.template operator()<Method>() for each method.
    template <class F>
    static constexpr void for_each(F&& f) {
        (f.template operator()<Methods>(), ...);
    }
    // The same for the methods that run in the number system N.
    template <class N, class F>
    static constexpr void for_each_in(F&& f) {
        for_each([&]<class Method>() {
            if constexpr (runs_in<Method, N>) f.template operator()<Method>();
        });
    }
};

// One entry a line, because builds read them (kernel/lists.cmake).
// clang-format off
using Integrators = IntegratorList<
    integrators::ExplicitEuler,
    integrators::SemiImplicitEuler,
    integrators::ImplicitEuler,
    integrators::ImplicitMidpoint,
    integrators::Midpoint,
    integrators::Heun,
    integrators::Rk4,
    integrators::Verlet,
    integrators::Strang,
    integrators::Suzuki4,
    integrators::Pdmv4,
    integrators::Pdmv6,
    integrators::Pdmv8,
    integrators::Pdmv10,
    integrators::Exact>;
// clang-format on

}  // namespace tumble

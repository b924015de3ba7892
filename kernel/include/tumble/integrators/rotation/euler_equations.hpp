// Rotation by Euler's equations in the body frame, for methods whose spin is the angular velocity. With t the half turn
// in a step, the equations do not contain the step: dt_i/dn = 2 kappa_i t_j t_k, (i, j, k) cyclic, kappa_i = (I_j -
// I_k) / I_i. The triangle inequality of moments bounds every kappa to [-1, 1], so one format serves all bodies.
#pragma once

#include <tumble/body/orientation.hpp>
#include <tumble/body/stage.hpp>

namespace tumble {

template <class N, int weight_denominator>
struct EulerInertia {
    // 2 kappa / weight_denominator, in as many bits as fit, so that weighted sums of stages need no division.
    static constexpr int summed_bits = weight_denominator == 1 ? 30 : weight_denominator == 2 ? 31 : 32;
    using Summed = typename N::template CoefficientOf<summed_bits>;

    typename N::Coefficient kappa[3];
    Summed summed[3];

    [[nodiscard]] static constexpr EulerInertia of(RealVec3 moments, typename N::Scale) {
        EulerInertia inertia{};
        for (int i = 0; i < 3; ++i) {
            const Real kappa = (moments[(i + 1) % 3] - moments[(i + 2) % 3]) / moments[i];
            inertia.kappa[i] = N::template constant<typename N::Coefficient>(kappa);
            inertia.summed[i] = N::template constant<Summed>(kappa * Real{2} / Real{weight_denominator});
        }
        return inertia;
    }
};

// t_j t_k for each axis.
template <class N>
struct TurnProducts {
    typename N::TurnProduct v[3];

    [[nodiscard]] TUMBLE_INLINE static TurnProducts of(const Vec3<typename N::Turn>& t) {
        return {{mul(t.y(), t.z()), mul(t.z(), t.x()), mul(t.x(), t.y())}};
    }
};

}  // namespace tumble

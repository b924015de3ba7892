// The weights of the bodies: the roots of mass and of moments of inertia by which row.hpp weights velocities, and what
// else rows need of mass and inertia. A body needs no shape for it: a point mass has a root of its mass, and no spin.
// Lengths are in units of ContactNumbers::LengthScale.
#pragma once

#include <tumble/body/bodies.hpp>

namespace tumble {

template <class N>
struct BodyWeight {
    using C = ContactNumbers<N>;
    using Work = typename N::Work;
    using Unit = typename C::Unit;
    using Length = typename C::Length;
    using Levers = Vec3<typename C::Lever>;
    using Scale = typename C::LengthScale;

    typename C::PerLength per_gyration[3]{};  // one over the radii of gyration
    StoredVec3<Length> gyration{};
    // Of Euler's equations, for axes i, j, k in a cycle: (I_j - I_k) / sqrt(I_i I_m), I_m the larger one of I_j and
    // I_k, and (I_j - I_k) / I_i. By the triangle inequality of moments both are at most 1.
    StoredVec3<Unit> gyroscopic{}, euler{};
    Work root_mass{};                  // sqrt(m)
    Work of_turn[3]{}, per_turn[3]{};  // from half turns to sqrt(I_i) w_i h, and back
    Work per_root_mass{};

    // Converts the lengths to a coarser scale.
    constexpr void rescale(const Scale& from, const Scale& to) {
        for (int i = 0; i < 3; ++i) {
            per_gyration[i].rescale(from, to);
            gyration[i] = to.coarser(gyration[i], from);
        }
    }
    // With `points` the body may be a point mass.
    template <bool points, Spin spin>
    TUMBLE_COLD constexpr void set(const BodySpec& spec, const PrincipalInertia& inertia, const Scale& scale,
                                   const SpinUnits<N, spin>& units) {
        const auto unit = [](Real v) { return N::template constant<Unit>(v); };
        const Real root = sqrt(spec.mass);
        root_mass = N::template constant<Work>(root);
        per_root_mass = N::template constant<Work>(Real{1} / root);
        if constexpr (points) {
            if (is_point_mass(spec)) {
                for (int i = 0; i < 3; ++i) of_turn[i] = per_turn[i] = Work(1);  // of a spin that is zero
                return;
            }
        }
        for (int i = 0; i < 3; ++i) {
            const Real root_moment = sqrt(inertia.moments[i]);
            per_gyration[i] = C::PerLength::of(root_moment / root, scale);
            gyration[i] = scale.length(root_moment / root);
            of_turn[i] = N::template constant<Work>(root_moment) * units.rate(i, Work(1));
            per_turn[i] = Work(1) / of_turn[i];
            const Real next = inertia.moments[(i + 1) % 3], last = inertia.moments[(i + 2) % 3];
            gyroscopic[i] = unit((next - last) / sqrt(inertia.moments[i] * (next < last ? last : next)));
            euler[i] = unit((next - last) / inertia.moments[i]);
        }
    }

    // arm x direction over the radii of gyration, in principal axes.
    [[nodiscard]] Levers levers(const Vec3<Length>& arm, const Vec3<Unit>& direction) const {
        return over_gyration(cross<Length>(arm, direction));
    }
    // An axis times an arm over the radii of gyration, in principal axes.
    [[nodiscard]] Levers spin_levers(const Vec3<Unit>& about, Length arm) const {
        return over_gyration(along(about, arm));
    }

private:
    [[nodiscard]] Levers over_gyration(const Vec3<Length>& v) const {
        return {per_gyration[0](v.x()), per_gyration[1](v.y()), per_gyration[2](v.z())};
    }
};

template <class N, int bodies>
using Weights = typename detail::RoomFor<BodyWeight<N>, bodies>::Array;

}  // namespace tumble

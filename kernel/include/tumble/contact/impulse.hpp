// Impulse response of one body at several points at once, by a bounded number of sequential-impulse sweeps.
// At one point it is the textbook impulse  J = -(1 + e) v_n / (1/m + (r x n) . I^-1 (r x n)), exact after one sweep.
// Everything is in principal axes and SI units; the immovable world has no velocity.
#pragma once

#include <tumble/contact/geometry.hpp>

namespace tumble {

template <class N>
struct ContactPoint {
    using Work = typename N::Work;

    WorkVec3<N> arm, normal, turning;  // r, n, r x n
    Work gap{};                        // m
    Work target{};                     // normal velocity that the impulse must reach, m/s
    Work mass{};                       // effective mass along the normal, kg
    Work friction{};
    Work pushed{};                           // normal impulse so far, N s: never negative
    WorkVec3<N> dragged = zero_vector<N>();  // tangential impulse so far, N s
};

template <class N>
struct RigidMotion {
    using Work = typename N::Work;

    WorkVec3<N> v, w;  // m/s, rad/s, both in principal axes
    Work inverse_mass{};
    WorkVec3<N> inverse_moments;

    [[nodiscard]] WorkVec3<N> at(const WorkVec3<N>& arm) const { return v + cross<Work>(w, arm); }
    void apply(const WorkVec3<N>& impulse, const WorkVec3<N>& arm) {
        v += scaled_by(impulse, inverse_mass);
        const WorkVec3<N> angular = cross<Work>(arm, impulse);
        for (int i = 0; i < 3; ++i) w[i] = mul_add(w[i], inverse_moments[i], angular[i]);
    }
    // The inverse effective mass at a point in a direction: 1/m + (r x d) . I^-1 (r x d).
    [[nodiscard]] Work response(const WorkVec3<N>& turning) const {
        Work sum = inverse_mass;
        for (int i = 0; i < 3; ++i) sum = mul_add(sum, turning[i] * inverse_moments[i], turning[i]);
        return sum;
    }
};

namespace contact {
inline constexpr int max_points = 16;  // of one body at one time
inline constexpr int sweeps = 12;
}  // namespace contact

// Solves for the impulses at the points; `motion` ends as the motion after the impact.
template <class N, bool friction>
void solve_impulses(RigidMotion<N>& motion, ContactPoint<N>* points, int count) {
    using Work = typename N::Work;
    // One point without friction is exact at once; the choice depends on the scene, not on what is compiled in.
    const int rounds = count == 1 && !(friction && points[0].friction > Work(0)) ? 1 : contact::sweeps;
    for (int sweep = 0; sweep < rounds; ++sweep) {
        for (int c = 0; c < count; ++c) {
            ContactPoint<N>& p = points[c];
            const Work approach = dot(motion.at(p.arm), p.normal);
            Work pushed = mul_add(p.pushed, p.target - approach, p.mass);
            if (pushed < Work(0)) pushed = Work(0);
            const Work change = pushed - p.pushed;
            p.pushed = pushed;
            motion.apply(scaled_by(p.normal, change), p.arm);
            if constexpr (friction) {
                if (!(p.friction > Work(0))) continue;
                // Coulomb's cone, isotropic: stop the tangential motion as far as friction * normal impulse allows.
                WorkVec3<N> slip = motion.at(p.arm);
                slip -= scaled_by(p.normal, dot(slip, p.normal));
                const Work speed2 = dot(slip, slip);
                if (!(speed2 > Work(0))) continue;
                const Work speed = sqrt(speed2);
                const WorkVec3<N> along = scaled_by(slip, Work(1) / speed);
                const WorkVec3<N> wanted =
                    p.dragged - scaled_by(along, speed / motion.response(cross<Work>(p.arm, along)));
                const Work size = sqrt(dot(wanted, wanted)), limit = p.friction * p.pushed;
                const WorkVec3<N> dragged = size > limit ? scaled_by(wanted, limit / size) : wanted;
                motion.apply(dragged - p.dragged, p.arm);
                p.dragged = dragged;
            }
        }
    }
}

}  // namespace tumble

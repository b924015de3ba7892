// LoadedGroup: the bodies of one evaluation as loads see them, at a stage of a step, and the sums of what the loads
// change. A load adds its change of drift (m) and of half a turn (rad) in a step.
// The functions of a group with vectors of working numbers are the simplest: SI units, and the user's body axes. Those
// of blocks and factors (numbers/load_numbers.hpp) are the fastest.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/integrators/method.hpp>
#include <tumble/numbers/load_numbers.hpp>

namespace tumble {

// Stage: a StageState. Kick: a Kick or a WorkKick. `is_alone`: a body that loads do not couple to another.
template <class N, class Bodies, class Stage, class Kick, bool is_alone>
struct LoadedGroup : std::conditional_t<is_alone, GroupCount<1>, GroupCount<2>> {
    using Work = typename N::Work;                                           // working numbers
    using L = LoadNumbers<N>;                                                // arithmetic of blocks and factors
    using Vector = typename L::Vector;                                       // a vector as a block
    using Factor = typename L::Factor;                                       // a factor of a vector
    static constexpr bool alone = is_alone;                                  // one body
    static constexpr bool rotation = requires(Stage stage) { stage.q_wb; };  // bodies may have an orientation
    // Such an end of a step is only solved for a body alone.
    static constexpr bool can_end = alone && requires(Kick kick) { kick.linear[0] = typename N::DriftSum{}; };

    Bodies& bodies;             // of the world
    const Stage* stage;         // of each body of the group
    Kick* kick;                 // of each body of the group: in the formats of L::add
    const std::int16_t* id;     // the bodies of the group
    const std::int16_t* place;  // BodyPlaces::of the group, for place_of(); null of a body alone
    Factor per_length;          // portions in a step: 1 where the portion is a whole step
    bool whole;                 // the portion is a whole step
    bool turned;                // else no body of the group rotates in the stages
    // Null, or gravity's change of drift in a step that ends with half a kick: see velocity().
    const typename N::DriftSum* ends_with_half_of;
    Work seconds;           // in a whole step
    Work steps_per_second;  // of whole steps

    // The place in the group of body b of the world; -1 outside of it.
    [[nodiscard]] TUMBLE_INLINE int place_of(int b) const {
        if constexpr (Bodies::room == 1) return 0;
        else if constexpr (alone) return b == id[0] ? 0 : -1;
        else return place[b] < this->count && id[place[b]] == b ? place[b] : -1;
    }
    // True of a body that rotates in the stages.
    [[nodiscard]] TUMBLE_INLINE bool rotates(int k) const {
        if constexpr (!rotation) return false;
        else return turned && bodies.rotates(id[k]);
    }
    // The drift of a body that a load depends on: that of the stage. At the end of a step, half of the kick comes after
    // the stage, and the load depends on the drift after it. Of a load that comes last, this is the drift with half of
    // all other kicks: with a coefficient c / (1 + h c / 2m) in place of c, its kick is that of the drift after it.
    [[nodiscard]] TUMBLE_INLINE typename N::DriftSum velocity(int k, int i) const {
        if constexpr (can_end)
            if (ends_with_half_of != nullptr) {
                bool within = true;
                return stage[k].d_w[i] + N::half(L::clamped(kick[k].linear[i], ends_with_half_of[i], within));
            }
        return stage[k].d_w[i];
    }
    // True at the end of a step, where a load that comes last solves for its own kick: see velocity().
    [[nodiscard]] TUMBLE_INLINE bool at_end() const { return can_end && ends_with_half_of != nullptr; }
    // A coefficient of the velocity: drifts and turns are those of the portion.
    [[nodiscard]] TUMBLE_INLINE Factor of_velocity(Factor coefficient) const {
        return whole ? coefficient : L::product(coefficient, per_length);
    }
    // h / m.
    [[nodiscard]] TUMBLE_INLINE Factor step_per_mass(int k) const {
        return L::factor(bodies.constants[id[k]].drift_per_impulse());
    }
    // Half a turn in a step, rad, by 1 N m s about a principal axis.
    [[nodiscard]] TUMBLE_INLINE Factor half_turn_per_impulse(int k, int axis) const requires(rotation) {
        return L::factor(bodies.constants[id[k]].units.per_impulse(axis));
    }

    // Adds f v, the change of momentum in a step (N s), at the centre of mass of body k.
    TUMBLE_INLINE void push(int k, const Vector& v, Factor f) const {
        L::add(kick[k].linear, v, L::product(f, step_per_mass(k)), bodies.scale);
    }
    // The same at a point (m, principal axes).
    TUMBLE_INLINE void push(int k, const Vector& v, Factor f, const Vector& point_b) const {
        push(k, v, f);
        if constexpr (rotation) {
            if (point_b.is_zero() || !rotates(k)) return;
            turn(k, L::cross(point_b, L::rotated_back(stage[k].q_wb, v)), f);
        }
    }
    // Adds v, or f v, the change of angular momentum in a step (N m s, principal axes).
    TUMBLE_INLINE void turn(int k, const Vector& v) const requires(rotation) {
        for (int i = 0; i < 3; ++i) L::add(kick[k].angular[i], v, i, half_turn_per_impulse(k, i), bodies.scale);
    }
    // The same times f.
    TUMBLE_INLINE void turn(int k, const Vector& v, Factor f) const requires(rotation) {
        for (int i = 0; i < 3; ++i)
            L::add(kick[k].angular[i], v, i, L::product(f, half_turn_per_impulse(k, i)), bodies.scale);
    }

    // Portions a second.
    [[nodiscard]] Work rate() const { return whole ? steps_per_second : steps_per_second * L::work(per_length); }
    // At a stage of a body: m/s, world.
    [[nodiscard]] WorkVec3<N> velocity_at(const Stage& s) const {
        const Work per_second = rate();
        WorkVec3<N> v;
        for (int i = 0; i < 3; ++i) v[i] = N::metres(s.d_w[i], bodies.scale) * per_second;
        return v;
    }
    // rad/s, principal axes.
    [[nodiscard]] WorkVec3<N> spin_at(const Stage& s, int b) const requires(rotation) {
        const Work per_second = rate();
        WorkVec3<N> w;
        for (int i = 0; i < 3; ++i)
            w[i] = N::half_turn(s.t_b[i], bodies.scale) * bodies.constants[b].units.rate(i, per_second);
        return w;
    }

    // --- in working numbers, SI units and the user's body axes ---------------------------------------------------

    // m, world.
    [[nodiscard]] Vector3<Work> position(int k) const {
        Vector3<Work> x;
        for (int i = 0; i < 3; ++i) x[i] = N::metres(stage[k].x_w[i]);
        return x;
    }
    // m/s, world.
    [[nodiscard]] Vector3<Work> velocity(int k) const {
        const WorkVec3<N> v = velocity_at(stage[k]);
        return {v[0], v[1], v[2]};
    }
    // From the body's axes to the world's.
    [[nodiscard]] Quaternion<Work> orientation(int k) const requires(rotation) {
        return plain(stage[k].q_wb) * plain(bodies.constants[id[k]].principal()).conjugate();
    }
    // rad/s.
    [[nodiscard]] Vector3<Work> angular_velocity(int k) const requires(rotation) {
        const WorkVec3<N> w = spin_at(stage[k], id[k]);
        return rotate(plain(bodies.constants[id[k]].principal()), Vector3<Work>{w[0], w[1], w[2]});
    }
    // A force, N, world.
    void push(int k, const Vector3<Work>& force) const { push(k, block(force), L::factor(seconds)); }
    // The same at a point of the body, m.
    void push(int k, const Vector3<Work>& force, const Vector3<Work>& point) const requires(rotation) {
        push(k, block(force), L::factor(seconds), bodies.in_principal_axes(id[k], block(point)));
    }
    // A torque, N m, in the body's axes.
    void turn(int k, const Vector3<Work>& torque) const requires(rotation) {
        turn(k, bodies.in_principal_axes(id[k], block(torque)), L::factor(seconds));
    }

private:
    [[nodiscard]] static Vector block(const Vector3<Work>& v) { return Vector::of(v.x, v.y, v.z); }
    [[nodiscard]] static Quaternion<Work> plain(const Quat<typename N::Unit>& q) {
        return {N::work(q.w), {N::work(q.v.x()), N::work(q.v.y()), N::work(q.v.z())}};
    }
};

}  // namespace tumble

// A spring with damping along its length, from a point of a body to a world point or to a point of another body.
// One square root and one division unless the rest length and the damping are zero.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/integrators/stability.hpp>
#include <tumble/loads/loaded_body.hpp>

namespace tumble {

template <class N>
struct Spring {
    using Work = typename N::Work;

    std::int16_t body = 0, to_body = -1;
    WorkVec3<N> point_b = zero_vector<N>();      // m, principal axes of `body`
    WorkVec3<N> to = zero_vector<N>();           // m, principal axes of `to_body`; unused for a world point
    typename N::PositionSum anchor_w[3]{};       // the world point
    Work stiffness{}, damping{}, rest_length{};  // N/m, N s/m, m

    // `other` is null for a world point.
    template <class Body>
    void apply(Body& a, Body* other) const {
        const WorkVec3<N> reach = reach_of(a, other);
        WorkVec3<N> force = scaled_by(reach, stiffness);
        if (rest_length > Work(0) || damping > Work(0)) {
            const Work length = sqrt(dot(reach, reach));
            if (!(length > Work(0))) return;  // no direction: no force
            const WorkVec3<N> along = scaled_by(reach, Work(1) / length);
            Work strength = stiffness * (length - rest_length);
            if (damping > Work(0)) { strength = mul_add(strength, damping, dot(rate_of(a, other), along)); }
            force = scaled_by(along, strength);
        }
        push(a, other, force);
    }

    // The vector from its point of `a` to its other end, m, world. Positions are subtracted in the state's format,
    // before they are rounded to working numbers.
    template <class Body>
    [[nodiscard]] WorkVec3<N> reach_of(const Body& a, const Body* other) const {
        WorkVec3<N> reach;
        for (int i = 0; i < 3; ++i)
            reach[i] = N::apart(other != nullptr ? other->stage->x_w[i] : anchor_w[i], a.stage->x_w[i]);
        if constexpr (Body::rotation) {
            if (a.rotates()) reach -= rotate(a.q_wb, point_b);
            if (other != nullptr && other->rotates()) reach += rotate(other->q_wb, to);
        }
        return reach;
    }
    // The rate of reach_of(), m/s.
    template <class Body>
    [[nodiscard]] WorkVec3<N> rate_of(const Body& a, const Body* other) const {
        WorkVec3<N> rate = -a.velocity_at(point_b);
        if (other != nullptr) rate += other->velocity_at(to);
        return rate;
    }
    template <class Body>
    void push(Body& a, Body* other, const WorkVec3<N>& force) const {
        a.push(force, point_b);
        if (other != nullptr) other->push(-force, to);
    }
};

// StepBounds of a method in working numbers: constants, which a firmware need not convert.
template <class N>
struct SpringBounds {
    typename N::Work of_spring[StepBounds::sums]{}, of_damper[StepBounds::sums]{};

    constexpr explicit SpringBounds(const StepBounds& bounds) {
        for (int i = 0; i < StepBounds::sums; ++i) {
            of_spring[i] = N::template constant<typename N::Work>(bounds.of_spring[i]);
            of_damper[i] = N::template constant<typename N::Work>(bounds.of_damper[i]);
        }
    }
};

// The springs of a world.
template <class N, int capacity>
class Springs {
public:
    using Work = typename N::Work;

    Springs(Real, const WorldSpec&) {}
    // Adds a spring; false when there is no room. Misuse: a point other than zero of a point mass, and a point outside
    // the range.
    [[gnu::noinline, gnu::cold]] bool add(const SpringSpec& spec, const auto& bodies) {
        TUMBLE_ASSERT(spec.to_body >= -1 && spec.to_body < bodies.count);
        TUMBLE_ASSERT(is_in_range(spec.point) && is_in_range(spec.to));
        TUMBLE_ASSERT(bodies.rotates(bodies.index_of(spec.body)) || spec.point.is_zero());
        TUMBLE_ASSERT(spec.to_body < 0 || bodies.rotates(spec.to_body) || spec.to.is_zero());
        if (count_ >= capacity) return false;
        Spring<N>& spring = spring_[count_++];
        spring.body = static_cast<std::int16_t>(bodies.index_of(spec.body));
        spring.to_body = static_cast<std::int16_t>(spec.to_body);
        spring.point_b = bodies.principal_vector(spec.body, spec.point);
        if (spec.to_body >= 0) spring.to = bodies.principal_vector(spec.to_body, spec.to);
        else
            for (int i = 0; i < 3; ++i) spring.anchor_w[i] = position_sum(spec.to[i]);
        spring.stiffness = N::template constant<Work>(spec.stiffness);
        spring.damping = N::template constant<Work>(spec.damping);
        spring.rest_length = N::template constant<Work>(spec.rest_length);
        return true;
    }

    // Removes the springs that are tied to body b. The others keep their order.
    void remove_from(int b) {
        int kept = 0;
        for (int s = 0; s < count_; ++s)
            if (spring_[s].body != b && spring_[s].to_body != b) spring_[kept++] = spring_[s];
        count_ = kept;
    }

    // Returns a body that the newest spring moves, if the step is surely too long for that spring; else -1. `body`
    // holds all bodies as they stand, without velocity; `step` is in s.
    //
    // A pull at both ends of the spring brings about a motion u: h/m times the force and h/I times the torque at each
    // end. The pull is along a world axis (0 to 2) or along the spring (3). In this motion all springs, dampers and
    // drag together amount to
    //   K = h^2 u.(k u) / u.(m u),  C = h u.(c u) / u.(m u)
    // with the matrices k of stiffness, c of damping and m of mass. A quotient of this kind (Rayleigh) never exceeds
    // the largest eigenvalue of m^-1 k or m^-1 c, which a bound is for. So a step with K and C beyond a bound is surely
    // too long: there is no false alarm.
    //
    // Of one spring, K = h^2 k (1/m + a^2/I) summed over its ends, with the lever a of the force, and that is the
    // largest eigenvalue. The K of springs beside each other add up, as their eigenvalue does. A long chain of equal
    // springs that is built from one end has 8/5 of K: its step may be 26 % too long without a report. The sum of K
    // over all springs of a body (Gershgorin) never falls below the eigenvalue, but it is three times too large where
    // springs hold a body along three axes, and would be a false alarm there.
    //
    // A spring counts with its stiffness at its rest length, which is along itself alone; without a rest length it is
    // as stiff in all directions.
    template <class Body>
    [[nodiscard, gnu::cold, gnu::noinline]] int body_beyond(const SpringBounds<N>& bounds, const auto& bodies,
                                                            Body* body, const auto& drag, Work step, int axis) const {
        const auto other = [&](const Spring<N>& spring) {
            return spring.to_body < 0 ? nullptr : body + spring.to_body;
        };
        const Spring<N>& newest = spring_[count_ - 1];
        Body& a = body[newest.body];
        Body* const b = other(newest);
        WorkVec3<N> pull = newest.reach_of(a, b);
        if (axis < 3) {
            pull = zero_vector<N>();
            pull[axis] = step;  // of any size
        }
        newest.push(a, b, pull);
        Work stiffness{}, damping = respond(a, newest.body, bodies, drag);
        if (b != nullptr) damping += respond(*b, newest.to_body, bodies, drag);
        for (int s = 0; s < count_; ++s) {
            const Spring<N>& spring = spring_[s];
            const WorkVec3<N> reach = spring.reach_of(body[spring.body], other(spring)),
                              rate = spring.rate_of(body[spring.body], other(spring));
            const Work squares = product(reach, reach), along = product(reach, rate);
            const Work square = squares > Work{} ? along * along / squares : squares;
            stiffness += spring.stiffness * (spring.rest_length > Work{} ? square : product(rate, rate));
            damping += spring.damping * square;
        }
        stiffness *= step;
        const Work inertia = -product(newest.rate_of(a, b), pull);  // u.(m u) / h
        for (int i = 0; i < StepBounds::sums; ++i)
            if (inertia < bounds.of_spring[i] * stiffness + bounds.of_damper[i] * damping)
                return bodies.constants[newest.body].fixed ? newest.to_body : newest.body;
        return -1;
    }
    [[nodiscard]] int count() const { return count_; }
    [[nodiscard]] const Spring<N>& operator[](int s) const { return spring_[s]; }

    [[nodiscard]] bool acts_on(const auto&, int b) const {
        for (int s = 0; s < count_; ++s)
            if (spring_[s].body == b || spring_[s].to_body == b) return true;
        return false;
    }
    [[nodiscard]] bool couples(const auto&, int b) const {
        for (int s = 0; s < count_; ++s)
            if (spring_[s].to_body >= 0 && (spring_[s].body == b || spring_[s].to_body == b)) return true;
        return false;
    }
    template <class F>
    void for_each_coupled(const auto&, int b, F&& f) const {
        for (int s = 0; s < count_; ++s) {
            if (spring_[s].to_body < 0) continue;
            if (spring_[s].body == b) f(spring_[s].to_body);
            if (spring_[s].to_body == b) f(spring_[s].body);
        }
    }
    [[nodiscard]] bool depends_on_velocity() const {
        for (int s = 0; s < count_; ++s)
            if (spring_[s].damping > Work(0)) return true;
        return false;
    }
    TUMBLE_INLINE void apply_to(const auto& group) const {
        for (int s = 0; s < count_; ++s) {
            const Spring<N>& spring = spring_[s];
            auto* a = group.find(spring.body);
            if (a != nullptr) {
                spring.apply(*a, spring.to_body < 0 ? nullptr : group.other_end(spring.to_body));
            } else if (spring.to_body >= 0 && group.find(spring.to_body) != nullptr) {
                spring.apply(*group.other_end(spring.body), group.find(spring.to_body));
            }
        }
    }

private:
    // Gives a body that is not fixed the velocity that its forces cause in a step. Returns what drag takes of it, u.(c
    // u).
    template <class Body>
    [[gnu::cold, gnu::noinline]] static Work respond(Body& body, int b, const auto& bodies,
                                                     [[maybe_unused]] const auto& drag) {
        Work damping{};
        if (bodies.constants[b].fixed) return damping;
        body.v_w = scaled_by(body.force_w, bodies.step_per_mass(b));
        if constexpr (requires { drag.linear; }) damping += drag.linear * product(body.v_w, body.v_w);
        if constexpr (Body::rotation) {
            if (!body.rotates()) return damping;
            for (int i = 0; i < 3; ++i) body.w_b[i] = body.torque_b[i] * bodies.step_per_moment(b, i);
            if constexpr (requires { drag.angular; }) damping += drag.angular * product(body.w_b, body.w_b);
        }
        return damping;
    }
    [[gnu::cold, gnu::noinline]] static Work product(const WorkVec3<N>& a, const WorkVec3<N>& b) { return dot(a, b); }
    [[nodiscard, gnu::cold]] static bool is_in_range(const RealVec3& point) {
        if constexpr (N::fixed_point)
            for (int i = 0; i < 3; ++i)
                if (abs(point[i]) > Real{N::Range::position}) return false;
        return true;
    }
    [[nodiscard]] static typename N::PositionSum position_sum(Real metres) {
        if constexpr (N::fixed_point) return {metres.to_fixed(N::PositionSum::fraction_bits, 64)};
        else return N::template constant<typename N::PositionSum>(metres);
    }

    Spring<N> spring_[capacity];
    int count_ = 0;
};

}  // namespace tumble

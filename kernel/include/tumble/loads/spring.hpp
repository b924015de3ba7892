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

    // From its point of `a` to its other end, m, world. Positions are subtracted as the state holds them, before
    // rounding to working numbers.
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
    // How that changes, m/s.
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

// Finds the motion of bodies that springs stiffen most, as they stand: the largest eigenvalue of M^-1 W by power
// iteration from a pull of all springs, where W is their stiffness and damping, and drag, in shares of what the step
// bears. What it finds is a Rayleigh quotient, that of a motion: never above the largest.
template <class N, class Bodies>
class StiffestMotion {
public:
    using Work = typename N::Work;

    explicit StiffestMotion(const Bodies& bodies) : bodies_{bodies} {
        for (int b = 0; b < bodies.count; ++b) {
            stage_[b] = stage_of(bodies.state[b]);
            Body& body = body_[b];
            body.stage = &stage_[b];
            if constexpr (Bodies::has_points) body.is_point = !bodies.rotates(b);
            if constexpr (Bodies::rotation)
                if (body.rotates()) body.q_wb = work_quaternion<N>(stage_[b].q_wb);
        }
    }

    // True if some motion has more than 1: shares of stiffness and damping are K = share k h / m. `drag` may be
    // nothing.
    [[nodiscard]] bool exceeds(const auto& springs, const auto& drag, Work of_stiffness, Work of_damping) {
        constexpr int iterations = 12;
        const Work margin = Work(1) + N::template constant<Work>(Real::scaled(1, -10));
        rest();
        for (int s = 0; s < springs.count(); ++s) (void)add(springs[s], of_stiffness, of_damping, s % 3);
        for (int iteration = 0; iteration < iterations; ++iteration) {
            const Work size = respond();
            Work stiffened = slow(drag, of_damping);
            for (int s = 0; s < springs.count(); ++s) stiffened += add(springs[s], of_stiffness, of_damping);
            if (size * margin < stiffened) return true;
        }
        return false;
    }
    // The body with the largest part of the motion, by energy.
    [[nodiscard]] int body() const { return most_moved_; }

private:
    using Body = LoadedBody<N, Bodies::rotation, Bodies::has_points>;

    void rest() {
        for (int b = 0; b < bodies_.count; ++b) {
            body_[b].force_w = zero_vector<N>();
            if constexpr (Bodies::rotation) body_[b].torque_b = zero_vector<N>();
        }
    }
    // Velocities from the forces, which end with it: h F / m. Returns their product with the forces.
    Work respond() {
        Work size(0), most(0);
        for (int b = 0; b < bodies_.count; ++b) {
            Body& body = body_[b];
            const Work movable(bodies_.constants[b].fixed ? 0 : 1);
            body.v_w = scaled_by(body.force_w, bodies_.step_per_mass(b) * movable);
            Work part = dot(body.v_w, body.force_w);
            if constexpr (Bodies::rotation) {
                if (body.rotates()) {
                    for (int i = 0; i < 3; ++i)
                        body.w_b[i] = body.torque_b[i] * (bodies_.step_per_moment(b, i) * movable);
                    part += dot(body.w_b, body.torque_b);
                }
            }
            size += part;
            if (most < part) {
                most = part;
                most_moved_ = b;
            }
        }
        rest();
        return size;
    }
    // Drag's force W u on all bodies, with u their velocities, where it is against them. Returns u W u.
    Work slow([[maybe_unused]] const auto& drag, [[maybe_unused]] Work of_damping) {
        Work slowed(0);
        if constexpr (requires { drag.linear; }) {
            const Work linear = of_damping * drag.linear;
            for (int b = 0; b < bodies_.count; ++b) {
                Body& body = body_[b];
                slowed += linear * dot(body.v_w, body.v_w);
                if (linear > Work(0)) body.force_w += scaled_by(body.v_w, linear);
                if constexpr (Bodies::rotation) {
                    if (!body.rotates()) continue;
                    const Work angular = of_damping * drag.angular;
                    slowed += angular * dot(body.w_b, body.w_b);
                    if (angular > Work(0)) body.torque_b += scaled_by(body.w_b, angular);
                }
            }
        }
        return slowed;
    }
    // The spring's force W u, with u the rate between its ends at the velocities, or for a first pull along the spring
    // and, most of all, a world axis; without what is negative of W, whose size would be the largest that the iteration
    // finds. Returns u W u, with it.
    Work add(const Spring<N>& spring, Work of_stiffness, Work of_damping, int pull = -1) {
        Body& a = body_[spring.body];
        Body* other = spring.to_body < 0 ? nullptr : &body_[spring.to_body];
        const WorkVec3<N> reach = spring.reach_of(a, other);
        const Work length = sqrt(dot(reach, reach)), none(0), share = of_stiffness * spring.stiffness;
        if (!(length > none) && spring.rest_length > none) return none;  // no direction: no force
        const WorkVec3<N> along = length > none ? scaled_by(reach, Work(1) / length) : zero_vector<N>();
        WorkVec3<N> rate = along;
        if (pull >= 0)
            for (int i = 0; i < 3; ++i) rate[(i + pull) % 3] += N::template constant<Work>(Real::scaled(1, -1 - i));
        else rate = spring.rate_of(a, other);
        const Work rate_along = dot(rate, along);
        const bool is_stretched = spring.rest_length < length || !(length > none);
        const Work across = !is_stretched               ? none
                            : spring.rest_length > none ? share * (Work(1) - spring.rest_length / length)
                                                        : share;
        const Work along_it = share + of_damping * spring.damping;
        const auto force = [&](Work w_across, Work w_along) -> WorkVec3<N> {
            return scaled_by(rate, w_across) + scaled_by(along, (w_along - w_across) * rate_along);
        };
        spring.push(a, other, -force(across < none ? none : across, along_it < none ? none : along_it));
        return dot(force(across, along_it), rate);
    }

    const Bodies& bodies_;
    StageState<N, Bodies::rotation> stage_[Bodies::room];
    Body body_[Bodies::room];
    int most_moved_ = 0;
};

// The springs of a world.
template <class N, int capacity>
class Springs {
public:
    using Work = typename N::Work;

    Springs(Real, const WorldSpec&) {}
    // False when there is no room. A point of a point mass other than itself is misuse, and so are a world point and
    // points of bodies that lie beyond the range.
    [[gnu::noinline]] bool add(const SpringSpec& spec, const auto& bodies) {
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

    // Reports a step that is too long for the springs as they stand, and for drag; from the newest on.
    [[gnu::noinline]] void check_step(auto& bodies, const auto& drag, const StepBounds& bounds) {
        is_watched_ = false;
        for (int i = 0; i < StepBounds::sums; ++i)
            is_watched_ |= check_sum(bodies, drag, Real{bounds.of_spring[i]}, Real{bounds.of_damper[i]});
    }
    // The same every sixteenth step, of springs that turn with bodies and may become too stiff that way; and where a
    // method adds to every oscillation, after 2^12, 2^13 and so on steps, whether one grows e-fold in so many.
    TUMBLE_INLINE void watch(auto& bodies, const auto& drag, const StepBounds& bounds) {
        const std::uint32_t steps = bodies.steps_taken;
        if (bodies.status.has(Issue::step_too_long)) return;
        if (is_watched_ && steps % 16 == 0) check_step(bodies, drag, bounds);
        if (bounds.slowing > 0 && steps >= first_growth_check && (steps & (steps - 1)) == 0)
            check_growth(bodies, drag, bounds, steps);
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
    static constexpr std::uint32_t first_growth_check = 4096;
    // In which the most growth that step_bounds bears is e-fold.
    static constexpr std::uint32_t e_fold_steps = 512;

    [[gnu::noinline]] void check_growth(auto& bodies, const auto& drag, const StepBounds& bounds, std::uint32_t steps) {
        Real spring{bounds.of_spring[0]}, damper{bounds.of_damper[0]};
        for (; steps > e_fold_steps; steps /= 2) {
            spring *= Real{bounds.slowing};
            damper *= Real{2};
        }
        report_beyond(bodies, drag, N::template constant<Work>(spring * bodies.step_length),
                      N::template constant<Work>(damper));
    }
    // Reports a motion that is beyond a bound; true if another pose of the bodies may have one.
    [[nodiscard]] bool check_sum(auto& bodies, const auto& drag, Real of_spring, Real of_damper) const {
        const Work of_stiffness = N::template constant<Work>(of_spring * bodies.step_length),
                   of_damping = N::template constant<Work>(of_damper);
        if (of_stiffness == Work(0) && of_damping == Work(0)) return false;
        report_beyond(bodies, drag, of_stiffness, of_damping);
        return may_exceed(bodies, drag, of_stiffness, of_damping);
    }
    template <class Bodies>
    void report_beyond(Bodies& bodies, const auto& drag, Work of_stiffness, Work of_damping) const {
        StiffestMotion<N, Bodies> motion{bodies};
        if (motion.exceeds(*this, drag, of_stiffness, of_damping)) bodies.report(Issue::step_too_long, motion.body());
    }

    [[nodiscard]] static bool is_in_range(const RealVec3& point) {
        if constexpr (N::fixed_point)
            for (int i = 0; i < 3; ++i)
                if (abs(point[i]) > Real{N::Range::position}) return false;
        return true;
    }
    [[nodiscard]] static typename N::PositionSum position_sum(Real metres) {
        if constexpr (N::fixed_point) return {metres.to_fixed(N::PositionSum::fraction_bits, 64)};
        else return N::template constant<typename N::PositionSum>(metres);
    }

    // False if no pose of the bodies makes the springs too stiff: Gershgorin's bound, with arms across the forces, and
    // the most of drag.
    template <class Bodies>
    [[nodiscard]] bool may_exceed(const Bodies& bodies, [[maybe_unused]] const auto& drag, Work of_stiffness,
                                  Work of_damping) const {
        // The root of the spring's share times what it moves body b by at the most.
        const auto part = [&](const Spring<N>& s, int b, const WorkVec3<N>& arm) {
            if (b < 0 || bodies.constants[b].fixed) return Work(0);
            Work share = of_stiffness * s.stiffness, moved = bodies.step_per_mass(b);
            if (Work(0) < of_damping) share += of_damping * s.damping;
            if constexpr (Bodies::rotation)
                if (bodies.rotates(b)) moved += dot(arm, arm) * bodies.step_per_moment(b, 2);
            return sqrt(share * moved);
        };
        Work of_body[Bodies::room], of_drag(0);
        for (int b = 0; b < bodies.count; ++b) {
            of_body[b] = Work(0);
            if constexpr (requires { drag.linear; }) {
                const auto see = [&](Work slowed) {
                    if (of_drag < slowed) of_drag = slowed;
                };
                see(of_damping * drag.linear * bodies.step_per_mass(b));
                if constexpr (Bodies::rotation)
                    if (bodies.rotates(b)) see(of_damping * drag.angular * bodies.step_per_moment(b, 2));
            }
        }
        for (int s = 0; s < count_; ++s) {
            of_body[spring_[s].body] += part(spring_[s], spring_[s].body, spring_[s].point_b);
            if (spring_[s].to_body >= 0)
                of_body[spring_[s].to_body] += part(spring_[s], spring_[s].to_body, spring_[s].to);
        }
        for (int s = 0; s < count_; ++s) {
            Work sum = part(spring_[s], spring_[s].body, spring_[s].point_b) * of_body[spring_[s].body];
            if (spring_[s].to_body >= 0)
                sum += part(spring_[s], spring_[s].to_body, spring_[s].to) * of_body[spring_[s].to_body];
            if (Work(1) < sum + of_drag) return true;
        }
        return false;
    }

    Spring<N> spring_[capacity];
    int count_ = 0;
    bool is_watched_ = false;
};

}  // namespace tumble

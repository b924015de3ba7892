// A spring with damping along its length, from a point of a body to a world point or to a point of another body.
// One inverse square root unless the rest length and the damping are zero.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/integrators/stability.hpp>
#include <tumble/loads/loaded_group.hpp>

namespace tumble {

template <class N>
struct Spring {
    using Work = typename N::Work;
    using Vector = VectorBlock<N>;

    std::int16_t body = 0, to_body = -1;
    Vector point_b{};                            // m, principal axes of `body`
    Vector to{};                                 // m, principal axes of `to_body`; unused for a world point
    typename N::PositionSum anchor_w[3]{};       // the world point
    Work stiffness{}, damping{}, rest_length{};  // h k (N s/m), N s/m, m
    Work stiffness_at_end{}, damping_at_end{};   // h k and c, both / (1 + h c / 2m) with the mass of `body`
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
template <class N, int capacity, int bodies>
class Springs {
public:
    using Work = typename N::Work;
    using L = LoadNumbers<N>;
    using Vector = typename L::Vector;
    using Factor = typename L::Factor;

    constexpr Springs(Real, const WorldSpec&) {
        for (std::uint16_t& first : first_) first = none;
    }
    // Adds a spring; false when there is no room. Misuse: a point other than zero of a point mass, a point outside the
    // range, and a negative damping or rest length.
    [[gnu::noinline, gnu::cold]] constexpr bool add(const SpringSpec& spec, const auto& all) {
        TUMBLE_ASSERT(spec.to_body >= -1 && spec.to_body < all.count);
        TUMBLE_ASSERT(is_in_range(spec.point) && is_in_range(spec.to));
        TUMBLE_ASSERT(all.rotates(all.index_of(spec.body)) || spec.point.is_zero());
        TUMBLE_ASSERT(spec.to_body < 0 || all.rotates(spec.to_body) || spec.to.is_zero());
        TUMBLE_ASSERT(!spec.damping.is_negative() && !spec.rest_length.is_negative());
        if (count_ >= capacity) return false;
        Spring<N>& spring = spring_[count_];
        spring.body = static_cast<std::int16_t>(all.index_of(spec.body));
        spring.to_body = static_cast<std::int16_t>(spec.to_body);
        spring.point_b = principal_point(all, spec.body, spec.point);
        enlist(spec.body, 2 * count_);
        if (spec.to_body >= 0) enlist(spec.to_body, 2 * count_ + 1);
        ++count_;
        if (spec.to_body >= 0) spring.to = principal_point(all, spec.to_body, spec.to);
        else
            for (int i = 0; i < 3; ++i) spring.anchor_w[i] = position_sum(spec.to[i]);
        spring.stiffness = N::template constant<Work>(spec.stiffness * all.step_length);
        spring.damping = N::template constant<Work>(spec.damping);
        spring.rest_length = N::template constant<Work>(spec.rest_length);
        spring.stiffness_at_end = spring.stiffness;
        if (spec.damping > Real{}) {
            const Work share = spring.damping * all.constants[spec.body].drift_per_impulse();
            const Work divisor = Work(1) + N::half_of(share);
            spring.stiffness_at_end = spring.stiffness / divisor;
            spring.damping_at_end = spring.damping / divisor;
            is_damped_ = true;
        }
        return true;
    }

    // Removes the springs that are tied to body b. The others keep their order.
    void remove_from(int b) {
        const int before = count_;
        count_ = 0;
        for (std::uint16_t& first : first_) first = none;
        for (int s = 0; s < before; ++s) {
            if (spring_[s].body == b || spring_[s].to_body == b) continue;
            spring_[count_] = spring_[s];
            enlist(spring_[s].body, 2 * count_);
            if (spring_[s].to_body >= 0) enlist(spring_[s].to_body, 2 * count_ + 1);
            ++count_;
        }
    }

    // Returns a body that the newest spring moves, where the step is surely too long for this spring in the present
    // poses. Else -1; so too where a motion along the axis does not show this spring's stiffness or damping.
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
    // as stiff in all directions. A spring whose ends coincide has no direction yet: it and its damper count along the
    // motion, which gives it one.
    TUMBLE_COLD [[nodiscard]] constexpr int body_beyond(const SpringBounds<N>& bounds, const auto& all,
                                                        const auto& drag, int axis) const {
        const Spring<N>& newest = spring_[count_ - 1];
        const bool is_apart = !ends_coincide(newest, reach_of(newest, all)), has_length = newest.rest_length > Work{};
        if (axis < 3 ? is_apart && has_length : !is_apart || !(has_length || newest.damping > Work{})) return -1;
        const Vector pull =
            axis < 3 ? Vector::of(Work(axis == 0), Work(axis == 1), Work(axis == 2)) : reach_of(newest, all);
        const Motion moved[2]{response(all, newest.body, newest.point_b, pull),
                              response(all, newest.to_body, newest.to, pull.times(Work(-1)))};
        Work stiffness{}, damping{}, of_coinciding{};
        for (const Motion& motion : moved) {
            if constexpr (requires { drag.linear; }) damping += drag.linear * product(motion.v_w, motion.v_w);
            if constexpr (requires { drag.angular; }) damping += drag.angular * product(motion.w_b, motion.w_b);
        }
        for_each_at(moved, [&](const Spring<N>& spring) {
            const Vector reach = reach_of(spring, all), rate = rate_of(spring, all, moved);
            const Work along = product(reach, rate), whole = product(rate, rate);
            const bool coincide = ends_coincide(spring, reach);
            const Work square = coincide ? whole : along * along / product(reach, reach);
            stiffness += spring.stiffness * (spring.rest_length > Work{} ? square : whole);
            (coincide ? of_coinciding : damping) += spring.damping * square;
        });
        const Work inertia = -product(rate_of(newest, all, moved), pull);  // u.(m u) / h
        // Across the motion, dampers whose ends coincide do nothing.
        for (const Work& damped : {damping, damping + of_coinciding})
            for (int i = 0; i < StepBounds::sums; ++i)
                if (inertia < bounds.of_spring[i] * stiffness + bounds.of_damper[i] * damped)
                    return all.constants[newest.body].fixed() ? newest.to_body : newest.body;
        return -1;
    }
    [[nodiscard]] constexpr int count() const { return count_; }
    [[nodiscard]] const Spring<N>& operator[](int s) const { return spring_[s]; }

    [[nodiscard]] bool acts_on(const auto&, int b) const { return first_[b] != none; }
    [[nodiscard]] bool couples(const auto&, int b) const {
        bool coupled = false;
        for_each_coupled(0, b, [&](int) { coupled = true; });
        return coupled;
    }
    // True if a spring pulls at a point of the body off its centre.
    [[nodiscard]] bool turns(const auto&, int b) const {
        for (int end = first_[b]; end != none; end = next_[end])
            if (!(end % 2 == 0 ? spring_[end / 2].point_b : spring_[end / 2].to).is_zero()) return true;
        return false;
    }
    template <class F>
    void for_each_coupled(const auto&, int b, F&& f) const {
        for (int end = first_[b]; end != none; end = next_[end]) {
            const Spring<N>& spring = spring_[end / 2];
            if (spring.to_body >= 0) f(end % 2 == 0 ? spring.to_body : spring.body);
        }
    }
    [[nodiscard]] bool depends_on_velocity() const { return is_damped_; }
    [[nodiscard]] int dampers_at(int b) const {
        int dampers = 0;
        for (int end = first_[b]; is_damped_ && end != none; end = next_[end])
            dampers += spring_[end / 2].damping > Work{} ? 1 : 0;
        return dampers;
    }
    // A body alone has springs to world points only.
    template <class Group>
    TUMBLE_INLINE void apply_to(const Group& group) const {
        if constexpr (Group::alone) {
            // At the end of a step a damper comes last.
            const int first = first_[group.id[0]];
            for (int pass = group.at_end() ? 0 : 1; pass < 2; ++pass)
                for (int end = first; end != none; end = next_[end]) {
                    const Spring<N>& spring = spring_[end / 2];
                    if (group.at_end() && (spring.damping > Work{}) != (pass == 1)) continue;
                    pull(group, spring, 0, spring.point_b, -1, -1, spring.to);
                }
        } else {
            for (int s = 0; s < count_; ++s) {
                const Spring<N>& spring = spring_[s];
                const int a = group.place_of(spring.body), b = spring.to_body < 0 ? -1 : group.place_of(spring.to_body);
                if (a >= 0) pull(group, spring, a, spring.point_b, b, spring.to_body, spring.to);
                else if (b >= 0) pull(group, spring, b, spring.to, -1, spring.body, spring.point_b);
            }
        }
    }

private:
    // Adds an end to the list of its body.
    constexpr void enlist(int b, int end) {
        next_[end] = first_[b];
        first_[b] = static_cast<std::uint16_t>(end);
    }

    // Sets sums to the place of a spring's other end as it stands: the world point, or a point of a body.
    TUMBLE_INLINE static void set_other_end(typename L::Place (&sums)[3], const auto& all, int b, const Vector& point_b,
                                            const Spring<N>& spring) {
        if (b >= 0) return set_place(sums, all, b, stage_of(all.state[b]), point_b);
        detail::for_axes<N>([&](int i) { sums[i] = L::place(spring.anchor_w[i]); });
    }
    TUMBLE_INLINE static void set_place(typename L::Place (&sums)[3], const auto& all, int b, const auto& stage,
                                        const Vector& point_b) {
        detail::for_axes<N>([&](int i) { sums[i] = L::place(stage.x_w[i]); });
        if constexpr (requires { stage.q_wb; }) {
            if (point_b.is_zero() || !all.rotates(b)) return;
            const Vector arm = L::rotated(stage.q_wb, point_b);
            for (int i = 0; i < 3; ++i) sums[i] = sums[i] + L::place(arm, i);
        }
    }
    // Takes the place of a point of a body from sums. Below: the velocity of a point, added or taken.
    TUMBLE_INLINE static void take_place(typename L::Place (&sums)[3], const auto& all, int b, const auto& stage,
                                         const Vector& point_b) {
        detail::for_axes<N>([&](int i) { sums[i] = sums[i] - L::place(stage.x_w[i]); });
        if constexpr (requires { stage.q_wb; }) {
            if (point_b.is_zero() || !all.rotates(b)) return;
            const Vector arm = L::rotated(stage.q_wb, point_b);
            for (int i = 0; i < 3; ++i) sums[i] = sums[i] - L::place(arm, i);
        }
    }
    template <bool adds, class Group>
    TUMBLE_INLINE static void add_rate(typename L::Span (&to)[3], const Group& group, int b, int k,
                                       const Vector& point_b) {
        const auto put = [&](int i, typename L::Span d) { to[i] = adds ? to[i] + d : to[i] - d; };
        detail::for_axes<N>([&](int i) { put(i, L::span(group.velocity(k, i))); });
        if constexpr (Group::rotation) {
            if (point_b.is_zero() || !group.bodies.rotates(b)) return;
            const Vector v = rate_of_point(group.bodies, b, group.stage[k], point_b);
            for (int i = 0; i < 3; ++i) put(i, L::span_of_velocity(v, i, group.bodies.scale));
        }
    }
    // Of a body outside of the group: fixed, or asleep.
    static void add_rate_outside(typename L::Span (&to)[3], const auto& all, int b, const Vector& point_b) {
        const auto stage = stage_of(all.state[b]);
        for (int i = 0; i < 3; ++i) to[i] += L::span(stage.d_w[i]);
        if constexpr (requires { stage.q_wb; }) {
            if (point_b.is_zero() || !all.rotates(b)) return;
            const Vector v = rate_of_point(all, b, stage, point_b);
            for (int i = 0; i < 3; ++i) to[i] += L::span_of_velocity(v, i, all.scale);
        }
    }
    // The velocity of a point against the centre of mass, m in a step, world.
    [[nodiscard]] static Vector rate_of_point(const auto& all, int b, const auto& stage, const Vector& point_b) {
        const auto& units = all.constants[b].units;
        const Vector turn = L::half_turns(stage.t_b, all.scale)
                                .times({units.per_half_turn(0), units.per_half_turn(1), units.per_half_turn(2)});
        return L::rotated(stage.q_wb, cross(turn, point_b));
    }

    // The pull of a spring on `own`, a body of the group, at own_point, and on the body at its other end if that is in
    // the group too: at `other` >= 0. Else it is the body `other_body`, or the world point if that is below 0.
    // The strength is h (k (1 - l u) + c (r . r') u^2) with u = 1/|r|.
    template <class Group>
    TUMBLE_INLINE static void pull(const Group& group, const Spring<N>& spring, int own, const Vector& own_point,
                                   int other, int other_body, const Vector& other_point) {
        auto& all = group.bodies;
        typename L::Place apart[3];
        if (other >= 0) set_place(apart, all, other_body, group.stage[other], other_point);
        else set_other_end(apart, all, other_body, other_point, spring);
        take_place(apart, all, group.id[own], group.stage[own], own_point);
        const Vector r = L::between(apart);
        Factor strength = L::factor(group.at_end() ? spring.stiffness_at_end : spring.stiffness), u{};
        const bool is_damped = spring.damping > Work{};
        if (spring.rest_length > Work{} || is_damped) {
            if (L::is_zero(r)) return;  // no direction: no force
            u = L::inverse_length(r);
            if (spring.rest_length > Work{})
                strength = L::product(strength, L::one_less(L::product(L::factor(spring.rest_length), u)));
        }
        if (is_damped) {
            typename L::Span rate[3]{};
            if (other >= 0) add_rate<true>(rate, group, other_body, other, other_point);
            else if (other_body >= 0) add_rate_outside(rate, all, other_body, other_point);
            add_rate<false>(rate, group, group.id[own], own, own_point);
            const Factor along = L::product(L::product(L::dot(r, L::velocity(rate, all.scale)), u), u);
            const Factor damping =
                group.at_end() ? L::factor(spring.damping_at_end) : group.of_velocity(L::factor(spring.damping));
            strength = L::sum(strength, L::product(along, damping));
        }
        if (L::is_zero(strength)) return;
        group.push(own, r, strength, own_point);
        if (other >= 0) group.push(other, r, L::negative(strength), other_point);
    }

    // For body_beyond(): the velocity that a force causes in a step, m/s and rad/s for newtons. No body: none.
    struct Motion {
        int body = -1;
        Vector v_w{}, w_b{};
    };
    TUMBLE_COLD [[nodiscard]] static constexpr Motion response(const auto& all, int b, const Vector& point_b,
                                                               const Vector& force_w) {
        Motion motion;
        if (b < 0 || all.constants[b].fixed()) return motion;
        motion.body = b;
        motion.v_w = force_w.times(all.step_per_mass(b));
        if constexpr (std::remove_cvref_t<decltype(all)>::rotation)
            if (all.rotates(b) && !point_b.is_zero())
                motion.w_b =
                    cross(point_b, with_orientation(all, b, [&](const auto& q) { return L::rotated_back(q, force_w); }))
                        .times({all.step_per_moment(b, 0), all.step_per_moment(b, 1), all.step_per_moment(b, 2)});
        return motion;
    }
    // f(the orientation of body b), with plain vectors where the compiler sets up the world, in fixed point.
    [[nodiscard]] static constexpr Vector with_orientation(const auto& all, int b, auto&& f) {
        const auto& q = all.state[b].q_wb;
        if constexpr (N::fixed_point)
            if (std::is_constant_evaluated()) return f(q.template value<StoredVec3<typename N::Unit>>());
        return f(q.value());
    }
    // A vector of a body in the world's axes, as the body stands. Of a body that does not rotate: zero.
    [[nodiscard]] static constexpr Vector turned(const auto& all, int b, const Vector& v_b) {
        if constexpr (std::remove_cvref_t<decltype(all)>::rotation)
            if (all.rotates(b) && !v_b.is_zero())
                return with_orientation(all, b, [&](const auto& q) { return L::rotated(q, v_b); });
        return {};
    }
    // Calls f(spring), once each, for those that are tied to a body that moves.
    template <class F>
    TUMBLE_COLD constexpr void for_each_at(const Motion (&moved)[2], F&& f) const {
        const int first = moved[0].body;
        for (const int body : {first, moved[1].body == first ? -1 : moved[1].body})
            for (int end = body < 0 ? none : first_[body]; end != none; end = next_[end]) {
                const Spring<N>& spring = spring_[end / 2];
                const int other = end % 2 == 0 ? spring.to_body : spring.body;
                const bool is_at_first_too = body != first && other == first && first >= 0,
                           is_second_end = other == body && end % 2 != 0;
                if (!is_at_first_too && !is_second_end) f(spring);
            }
    }
    // From a spring's point of `body` to its other end as the bodies stand, m, world. Below: the rate of it in motions.
    TUMBLE_COLD [[nodiscard]] static constexpr Vector reach_of(const Spring<N>& spring, const auto& all) {
        const int b = spring.body, other = spring.to_body;
        const Vector arm = turned(all, b, spring.point_b), to = other < 0 ? Vector{} : turned(all, other, spring.to);
        const auto apart = [&](int i) {
            const auto end =
                other < 0 ? L::place(spring.anchor_w[i]) : L::place(N::sum(all.state[other].x_w[i])) + L::place(to, i);
            return end - L::place(N::sum(all.state[b].x_w[i])) - L::place(arm, i);
        };
        return L::between({apart(0), apart(1), apart(2)});
    }
    // True where nothing but rounding keeps the ends apart: 2^-20 of their levers, which is eight units of a float.
    TUMBLE_COLD [[nodiscard]] static constexpr bool ends_coincide(const Spring<N>& spring, const Vector& reach) {
        const Work levers = product(spring.point_b, spring.point_b) + product(spring.to, spring.to);
        return !(product(reach, reach) > levers * N::template constant<Work>(Real::scaled(1, -40)));
    }
    TUMBLE_COLD [[nodiscard]] static constexpr Vector rate_of(const Spring<N>& spring, const auto& all,
                                                              const Motion (&moved)[2]) {
        Vector rate{};
        for (const Motion& motion : moved)
            for (int end = 0; end < 2 && motion.body >= 0; ++end) {
                if (motion.body != (end == 0 ? spring.body : spring.to_body)) continue;
                const Vector& point_b = end == 0 ? spring.point_b : spring.to;
                const Vector v = motion.v_w + turned(all, motion.body, cross(motion.w_b, point_b));
                rate = rate + (end == 0 ? v.times(Work(-1)) : v);
            }
        return rate;
    }
    [[nodiscard, gnu::noinline]] static constexpr Work product(const Vector& a, const Vector& b) {
        return L::work(L::dot(a, b));
    }
    // A point of a body from the user's axes to principal axes. In fixed point, set-up numbers make less code.
    TUMBLE_COLD [[nodiscard]] static constexpr Vector principal_point(const auto& all, int b, const RealVec3& at) {
        using Bodies = std::remove_cvref_t<decltype(all)>;
        if constexpr (Bodies::rotation && N::fixed_point) {
            const auto q = all.constants[b].template principal<StoredVec3<typename N::Unit>>();
            const auto real = [](auto unit) { return Real::scaled(unit.raw, -unit.fraction_bits); };
            const RealVec3 p = detail::rotated_back({real(q.w), {real(q.v.x()), real(q.v.y()), real(q.v.z())}}, at);
            return Vector::of(Work(p.x), Work(p.y), Work(p.z));
        } else {
            const WorkVec3<N> p = all.principal_vector(b, at);
            return Vector::of(p.x(), p.y(), p.z());
        }
    }
    [[nodiscard, gnu::cold]] static constexpr bool is_in_range(const RealVec3& point) {
        if constexpr (N::fixed_point)
            for (int i = 0; i < 3; ++i)
                if (abs(point[i]) > Real{N::Range::position}) return false;
        return true;
    }
    [[nodiscard]] static constexpr typename N::PositionSum position_sum(Real metres) {
        if constexpr (N::fixed_point) return {metres.to_fixed(N::PositionSum::fraction_bits, 64)};
        else return N::template constant<typename N::PositionSum>(metres);
    }

    static constexpr std::uint16_t none = 0xffff;

    Spring<N> spring_[capacity];
    int count_ = 0;
    bool is_damped_ = false;  // one of them
    // Ends of springs: 2 s is that of `body`, 2 s + 1 that of `to_body`. Each body has a list of the ends at it.
    std::uint16_t first_[bodies], next_[2 * capacity]{};
};

}  // namespace tumble

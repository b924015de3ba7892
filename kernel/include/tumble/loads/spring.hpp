// A spring with damping along its length, from a point of a body to a world point or to a point of another body.
// One square root and one division unless the rest length and the damping are zero.
#pragma once

#include <tumble/body/setup.hpp>
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
        // Positions are subtracted as the state holds them, before rounding to working numbers.
        WorkVec3<N> reach;
        for (int i = 0; i < 3; ++i)
            reach[i] = N::metres((other != nullptr ? other->stage->x_w[i] : anchor_w[i]) - a.stage->x_w[i]);
        if constexpr (Body::rotation) {
            if (a.rotates()) reach -= rotate(a.q_wb, point_b);
            if (other != nullptr && other->rotates()) reach += rotate(other->q_wb, to);
        }
        WorkVec3<N> force = scaled_by(reach, stiffness);
        if (rest_length > Work(0) || damping > Work(0)) {
            const Work length = sqrt(dot(reach, reach));
            if (!(length > Work(0))) return;  // no direction: no force
            const WorkVec3<N> along = scaled_by(reach, Work(1) / length);
            Work strength = stiffness * (length - rest_length);
            if (damping > Work(0)) {
                WorkVec3<N> rate = -a.velocity_at(point_b);
                if (other != nullptr) rate += other->velocity_at(to);
                strength = mul_add(strength, damping, dot(rate, along));
            }
            force = scaled_by(along, strength);
        }
        a.push(force, point_b);
        if (other != nullptr) other->push(-force, to);
    }
};

// The springs of a world.
template <class N, int capacity>
class Springs {
public:
    using Work = typename N::Work;

    Springs(Real, const WorldSpec&) {}
    // False when there is no room. A point of a point mass other than itself is misuse.
    [[gnu::noinline]] bool add(const SpringSpec& spec, const auto& bodies) {
        TUMBLE_ASSERT(spec.to_body >= -1 && spec.to_body < bodies.count);
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
    [[nodiscard]] static typename N::PositionSum position_sum(Real metres) {
        if constexpr (N::fixed_point) return {metres.to_fixed(N::PositionSum::fraction_bits, 64)};
        else return N::template constant<typename N::PositionSum>(metres);
    }

    Spring<N> spring_[capacity];
    int count_ = 0;
};

}  // namespace tumble

// Newton's gravitation between two bodies as point masses: F = G m1 m2 / r^2. One inverse square root a pair. With a
// softening e it is Plummer's, F = G m1 m2 r / (r^2 + e^2)^(3/2), with a square root and a division more: H. C.
// Plummer, Monthly Notices of the Royal Astronomical Society 71, 460, 1911.
#pragma once

#include <tumble/body/setup.hpp>
#include <tumble/loads/loaded_group.hpp>
#include <tumble/numbers/functions.hpp>
#include <tumble/scene.hpp>
#include <tumble/status.hpp>

namespace tumble {

template <class N, int bodies, bool may_soften = false>
class Gravitation {
public:
    using Work = typename N::Work;
    using L = LoadNumbers<N>;
    using Factor = typename L::Factor;

    constexpr Gravitation(Real step, const WorldSpec& spec)
        : per_mass_{N::template constant<Work>(spec.gravitation * step * step)} {}
    // Softening, m; 0: none.
    constexpr void set_softening(Real length) requires(may_soften) {
        softening_.length = N::template constant<Work>(length);
    }
    [[nodiscard]] Work softening() const requires(may_soften) { return softening_.length; }
    constexpr void set_body(int b, const BodySpec& spec, const auto&, const auto&) {
        pull_[b] = L::factor(per_mass_ * N::template constant<Work>(spec.mass));
    }
    // The place of a removed body does not attract.
    void remove(int b) { pull_[b] = {}; }

    [[nodiscard]] bool acts_on(const auto& all, int) const { return per_mass_ > Work{} && all.count > 1; }
    [[nodiscard]] bool couples(const auto& all, int b) const {
        for (int other = 0; other < all.count; ++other)
            if (other != b && !all.constants[other].fixed() && !L::is_zero(pull_[other])) return true;
        return false;
    }
    template <class F>
    void for_each_coupled(const auto& all, int b, F&& f) const {
        for (int other = 0; other < all.count; ++other)
            if (other != b && !L::is_zero(pull_[other])) f(other);
    }
    template <class Group>
    TUMBLE_INLINE void apply_to(const Group& group) const {
        const int count = group.bodies.count;
        for (int k = 0; k < group.count; ++k) {
            const int a = group.id[k];
            for (int b = 0; b < count; ++b) {
                const int other = Group::alone ? -1 : group.place_of(b);
                if (b == a || (b < a && other >= 0)) continue;  // a pair of the group once
                if (L::is_zero(pull_[b])) continue;             // no gravitation, or the place of a removed body
                if (!apply(group, k, a, other, b)) group.bodies.report(Issue::step_too_long, a);
            }
        }
    }

private:
    // Least number of steps in the time sqrt(r^3 / G (m1 + m2)), in which two bodies at the distance r turn about each
    // other by a radian or fall into each other. With fewer, the energy drifts.
    static constexpr int log2_least_steps = 1;

    // 1 / sqrt(r^2 + e^2) from u = 1 / r: u / sqrt(1 + (e u)^2).
    [[nodiscard]] Factor softened(Factor u) const requires(may_soften) {
        if (!(softening_.length > Work{})) return u;
        const Work ratio = softening_.length * L::work(u);
        return L::product(u, L::factor(Work(1) / sqrt(Work(1) + ratio * ratio)));
    }

    // False where the step is too long for two bodies so near each other. Where b is fixed, only its own mass counts.
    // Bodies at the same place exert no force, since there is no direction; it is that of their softened attraction.
    template <class Group>
    TUMBLE_INLINE bool apply(const Group& group, int k, int a, int other, int b) const {
        const auto component = [&](int i) {
            return L::place(other >= 0 ? group.stage[other].x_w[i] : N::sum(group.bodies.state[b].x_w[i])) -
                   L::place(group.stage[k].x_w[i]);
        };
        const auto r = L::between({component(0), component(1), component(2)});
        if (!L::has_inverse_cube(r)) {
            if constexpr (may_soften) return softening_.length > Work{};
            return false;
        }
        Factor u = L::inverse_length(r);
        if constexpr (may_soften) u = softened(u);
        const Factor u3 = L::product(L::product(u, u), u);
        Factor pull = L::product(u3, pull_[b]);
        L::add(group.kick[k].linear, r, pull, group.bodies.scale);
        if (other >= 0) {
            const Factor back = L::product(u3, pull_[a]);
            L::add(group.kick[other].linear, r, L::negative(back), group.bodies.scale);
            pull = L::sum(pull, back);
        } else if (!group.bodies.constants[b].fixed()) {
            pull = L::sum(pull, L::product(u3, pull_[a]));
        }
        return !L::template exceeds_power_of_two<-2 * log2_least_steps>(pull);
    }

    struct Softening {
        Work length{};  // m
    };
    [[no_unique_address]] If<may_soften, Softening, 0> softening_{};
    Work per_mass_;          // G h^2, m^3/kg
    Factor pull_[bodies]{};  // G h^2 m of each body, m^3
};

}  // namespace tumble

// The loads of a world: drag, springs, gravitation, timed forces and contacts by springs, and their sum at a stage of a
// step. Gravity is not one of them: it is constant, and needs no stages.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/loads/contact_spring.hpp>
#include <tumble/loads/drag.hpp>
#include <tumble/loads/gravitation.hpp>
#include <tumble/loads/spring.hpp>
#include <tumble/loads/timed_force.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class LoadSet {
public:
    using Work = typename N::Work;
    using DriftSum = typename N::DriftSum;
    using Bodies = tumble::Bodies<N, spin, features.bodies>;
    using BodyGroup = tumble::BodyGroup<features.bodies>;

    LoadSet(Real step, const WorldSpec& spec)
        : seconds_{N::template constant<Work>(step)},
          steps_per_second_{N::template constant<Work>(Real{1} / step)}, contacts_{step, spec.contact} {
        if constexpr (features.drag)
            drag_ = {N::template constant<Work>(spec.linear_drag), N::template constant<Work>(spec.angular_drag)};
        if constexpr (features.gravitation) gravitation_ = {N::template constant<Work>(spec.gravitation)};
    }

    // A body has been added.
    void set_body([[maybe_unused]] int b, [[maybe_unused]] const BodySpec& spec,
                  [[maybe_unused]] const PrincipalInertia& inertia, [[maybe_unused]] Bodies& bodies) {
        if constexpr (features.gravitation) mass_[b] = N::template constant<Work>(spec.mass);
        if constexpr (features.springs_touch()) contacts_.set_body(b, spec, inertia, bodies);
    }
    // False when there is no room.
    bool add(const PlaneSpec& spec, Bodies& bodies) requires(features.springs_touch()) {
        return contacts_.add(spec, bodies);
    }
    [[nodiscard]] Real largest_safe_step() const requires(features.springs_touch()) {
        return contacts_.largest_safe_step();
    }
    // False when there is no room.
    [[gnu::noinline]] bool add(const SpringSpec& spec, const Bodies& bodies) requires(features.springs > 0) {
        TUMBLE_ASSERT(spec.to_body >= -1 && spec.to_body < bodies.count);
        if (spring_count_ >= features.springs) return false;
        Spring<N>& spring = spring_[spring_count_++];
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
    void set_forces(Span<TimedForce<N>> forces) requires(features.forces) { forces_ = forces; }

    // True of a body that feels anything but gravity in this step.
    [[nodiscard]] bool is_loaded(const Bodies& bodies, int b) const {
        if constexpr (features.drag)
            if (drag_.acts()) return true;
        if constexpr (features.gravitation)
            if (gravitation_.constant > Work(0) && bodies.count > 1) return true;
        if constexpr (features.springs > 0) {
            for (int s = 0; s < spring_count_; ++s)
                if (spring_[s].body == b || spring_[s].to_body == b) return true;
        }
        if constexpr (features.forces) {
            for (const TimedForce<N>& force : forces_)
                if (force.body == b && force.is_on(bodies.steps_taken)) return true;
        }
        if constexpr (features.springs_touch())
            if (contacts_.concerns(b)) return true;
        return false;
    }
    // True of a body that feels another moving body.
    [[nodiscard]] bool is_coupled([[maybe_unused]] const Bodies& bodies, int b) const {
        if constexpr (features.gravitation)
            if (gravitation_.constant > Work(0) && bodies.count > 1) return true;
        if constexpr (features.springs > 0) {
            for (int s = 0; s < spring_count_; ++s) {
                if (spring_[s].to_body >= 0 && (spring_[s].body == b || spring_[s].to_body == b)) return true;
            }
        }
        if constexpr (features.springs_touch())
            if (contacts_.couples(b)) return true;
        return false;
    }
    // Calls f(other) for every body that a spring or gravitation ties to b.
    template <class F>
    void for_each_coupled([[maybe_unused]] const Bodies& bodies, [[maybe_unused]] int b, [[maybe_unused]] F&& f) const {
        if constexpr (features.springs > 0) {
            for (int s = 0; s < spring_count_; ++s) {
                if (spring_[s].to_body < 0) continue;
                if (spring_[s].body == b) f(spring_[s].to_body);
                if (spring_[s].to_body == b) f(spring_[s].body);
            }
        }
        if constexpr (features.gravitation) {
            for (int other = 0; gravitation_.constant > Work(0) && other < bodies.count; ++other)
                if (other != b) f(other);
        }
    }
    // Calls f(body) for every timed force that begins or ends at the step.
    template <class F>
    void for_each_change(std::uint32_t step, F&& f) const requires(features.forces) {
        for (const TimedForce<N>& force : forces_)
            if (force.from == step || force.until == step) f(force.body);
    }

    // The loads of one group of bodies, as the methods call them.
    struct Evaluate {
        static constexpr bool may_depend_on_velocity = features.drag || features.springs > 0 ||
                                                       features.springs_touch();

        Bodies& bodies;
        const LoadSet& loads;
        const BodyGroup& group;
        Work seconds, steps_per_second;  // of this portion of a step
        DriftSum fall[3];                // gravity's change of drift in it

        void operator()(const StageState<N>* stages, Kick<N>* kicks) const {
            loads.evaluate(*this, stages, [&](int k, const WorkVec3<N>& linear, const WorkVec3<N>& angular) {
                bool within = true;
                for (int i = 0; i < 3; ++i) {
                    kicks[k].linear[i] = N::limited(fall[i] + N::drift_sum(linear[i], bodies.scale), within);
                    kicks[k].angular[i] = N::limited(N::turn_sum(angular[i], bodies.scale), within);
                }
                if (!within) bodies.report(Issue::range_left, group.id[k]);
            });
        }
        // The same in working numbers, whose range has no end: m and rad.
        void operator()(const StageState<N>* stages, WorkKick<N>* kicks) const {
            loads.evaluate(*this, stages, [&](int k, const WorkVec3<N>& linear, const WorkVec3<N>& angular) {
                for (int i = 0; i < 3; ++i) kicks[k].linear[i] = linear[i] + N::metres(fall[i], bodies.scale);
                kicks[k].angular = angular;
            });
        }
        [[nodiscard]] bool depends_on_velocity() const {
            if constexpr (features.drag)
                if (loads.drag_.acts()) return true;
            if constexpr (features.springs > 0) {
                for (int s = 0; s < loads.spring_count_; ++s)
                    if (loads.spring_[s].damping > Work(0)) return true;
            }
            if constexpr (features.springs_touch())
                if (loads.contacts_.depends_on_velocity()) return true;
            return false;
        }
    };
    // `length` is the portion's, of a step; `fall` gravity's change of drift in it.
    [[nodiscard]] Evaluate evaluation(Bodies& bodies, const BodyGroup& group, Work length,
                                      const DriftSum (&fall)[3]) const {
        return {bodies,
                *this,
                group,
                seconds_ * length,
                length == Work(1) ? steps_per_second_ : steps_per_second_ / length,
                {fall[0], fall[1], fall[2]}};
    }

private:
    template <class T, int n>
    using Array = T[n > 0 ? n : 1];

    [[nodiscard]] static typename N::PositionSum position_sum(Real metres) {
        if constexpr (N::fixed_point) return {metres.to_fixed(N::PositionSum::fraction_bits, 64)};
        else return N::template constant<typename N::PositionSum>(metres);
    }

    // Calls kick(place in the group, change of drift in m, change of half turn in rad) for each body.
    template <class F>
    void evaluate(const Evaluate& e, const StageState<N>* stages, F&& kick) const {
        LoadedBody<N> loaded[features.bodies];
        for (int k = 0; k < e.group.count; ++k) load(loaded[k], e.group.id[k], stages[k], e);
        const auto find = [&](int b) -> LoadedBody<N>* {
            for (int k = 0; k < e.group.count; ++k)
                if (e.group.id[k] == b) return &loaded[k];
            return nullptr;
        };
        StageState<N> still_stage;  // a fixed body at the other end of a load
        LoadedBody<N> still;
        const auto other_end = [&](int b) -> LoadedBody<N>* {
            if (LoadedBody<N>* found = find(b)) return found;
            still_stage = stage_of(e.bodies.state[b]);
            load(still, b, still_stage, e);
            return &still;
        };
        if constexpr (features.drag)
            for (int k = 0; k < e.group.count; ++k) drag_.apply(loaded[k]);
        if constexpr (features.springs > 0) {
            for (int s = 0; s < spring_count_; ++s) {
                const Spring<N>& spring = spring_[s];
                LoadedBody<N>* a = find(spring.body);
                if (a != nullptr) {
                    spring.apply(*a, spring.to_body < 0 ? nullptr : other_end(spring.to_body));
                } else if (spring.to_body >= 0 && find(spring.to_body) != nullptr) {
                    spring.apply(*other_end(spring.body), find(spring.to_body));
                }
            }
        }
        if constexpr (features.gravitation) {
            for (int k = 0; k < e.group.count && gravitation_.constant > Work(0); ++k) {
                const int a = e.group.id[k];
                for (int b = 0; b < e.bodies.count; ++b) {
                    if (b == a || (b < a && find(b) != nullptr)) continue;  // a pair of the group once
                    gravitation_.apply(loaded[k], mass_[a], *other_end(b), mass_[b]);
                }
            }
        }
        if constexpr (features.forces) {
            for (const TimedForce<N>& force : forces_) {
                if (!force.is_on(e.bodies.steps_taken)) continue;
                if (LoadedBody<N>* b = find(force.body)) apply(force, *b);
            }
        }
        if constexpr (features.springs_touch()) {
            for (int k = 0; k < e.group.count; ++k) {
                const int a = e.group.id[k];
                contacts_.apply(loaded[k], a, e.bodies);
                for (int b = 0; features.pairs && b < e.bodies.count; ++b) {
                    if (b == a || (b < a && find(b) != nullptr)) continue;
                    contacts_.apply(loaded[k], a, *other_end(b), b, e.bodies);
                }
            }
        }
        // Force to change of drift: F h^2 / m. The portion's own length enters squared.
        const Work part = e.seconds * e.seconds * steps_per_second_;
        for (int k = 0; k < e.group.count; ++k) {
            const auto& body = e.bodies.constants[e.group.id[k]];
            WorkVec3<N> angular;
            for (int i = 0; i < 3; ++i) angular[i] = loaded[k].torque_b[i] * (body.units.per_impulse(i) * part);
            kick(k, scaled_by(loaded[k].force_w, body.drift_per_impulse * part), angular);
        }
    }

    static void load(LoadedBody<N>& loaded, int b, const StageState<N>& stage, const Evaluate& e) {
        loaded.stage = &stage;
        loaded.q_wb = work_quaternion<N>(stage.q_wb);
        loaded.force_w = loaded.torque_b = zero_vector<N>();
        if constexpr (Evaluate::may_depend_on_velocity) {
            for (int i = 0; i < 3; ++i) {
                loaded.v_w[i] = N::metres(stage.d_w[i], e.bodies.scale) * e.steps_per_second;
                loaded.w_b[i] = N::half_turn(stage.t_b[i], e.bodies.scale) *
                                e.bodies.constants[b].units.rate(i, e.steps_per_second);
            }
        }
    }

    Work seconds_, steps_per_second_;
    [[no_unique_address]] If<features.drag, Drag<N>, 0> drag_{};
    [[no_unique_address]] If<features.gravitation, Gravitation<N>, 1> gravitation_{};
    [[no_unique_address]] If<features.gravitation, Array<Work, features.bodies>, 2> mass_{};
    [[no_unique_address]] If<(features.springs > 0), Array<Spring<N>, features.springs>, 3> spring_{};
    [[no_unique_address]] If<(features.springs > 0), int, 4> spring_count_{};
    [[no_unique_address]] If<features.forces, Span<TimedForce<N>>, 5> forces_{};
    [[no_unique_address]] If<features.springs_touch(), ContactSprings<N, spin, features>, 6> contacts_;
};

}  // namespace tumble

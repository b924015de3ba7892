// The loads of a world: drag, springs, gravitation, timed forces and contacts by springs, and their sum at a stage of a
// step. Gravity is no load: it is constant and needs no stages.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/loads/air.hpp>
#include <tumble/loads/contact_spring.hpp>
#include <tumble/loads/drag.hpp>
#include <tumble/loads/gravitation.hpp>
#include <tumble/loads/gravity_gradient.hpp>
#include <tumble/loads/joint_spring.hpp>
#include <tumble/loads/spring.hpp>
#include <tumble/loads/timed_force.hpp>
#include <tumble/loads/wheels.hpp>

namespace tumble {

namespace detail {

// The functions that a load may lack. Has...<Load>: it has a function of this name, whatever its arguments.
struct OptionalFunctions {
    void turns();
    void couples();
    void for_each_coupled();
    void depends_on_velocity();
    void set_body();
};
// A name of both bases is ambiguous.
template <class Load>
struct LoadWithAll : Load, OptionalFunctions {};
template <class Load>
concept HasTurns = !requires {
    &LoadWithAll<Load>::turns;
};
template <class Load>
concept HasCouples = !requires {
    &LoadWithAll<Load>::couples;
};
template <class Load>
concept HasForEachCoupled = !requires {
    &LoadWithAll<Load>::for_each_coupled;
};
template <class Load>
concept HasDependsOnVelocity = !requires {
    &LoadWithAll<Load>::depends_on_velocity;
};
template <class Load>
concept HasSetBody = !requires {
    &LoadWithAll<Load>::set_body;
};

// The loads of a list as one value.
template <class List>
struct ListedLoads;
template <class... Loads>
struct ListedLoads<LoadList<Loads...>> : Loads... {
    static constexpr bool may_turn = (HasTurns<Loads> || ...), may_couple = (HasCouples<Loads> || ...),
                          may_depend_on_velocity = (HasDependsOnVelocity<Loads> || ...);
    template <class Load>
    static constexpr bool has = times_in<Load, Loads...> == 1;

    // Calls ask(load) for each load, until it is true.
    template <class Self, class F>
    TUMBLE_INLINE static constexpr bool any([[maybe_unused]] Self& loads, [[maybe_unused]] F&& ask) {
        return (ask(static_cast<std::conditional_t<std::is_const_v<Self>, const Loads, Loads>&>(loads)) || ...);
    }
};

// The loads of several lists as one list.
template <class... Lists>
struct JoinedLists {
    using List = LoadList<>;
};
template <class... Loads, class... More, class... Lists>
struct JoinedLists<LoadList<Loads...>, LoadList<More...>, Lists...>
    : JoinedLists<LoadList<Loads..., More...>, Lists...> {};
template <class... Loads>
struct JoinedLists<LoadList<Loads...>> {
    using List = LoadList<Loads...>;
};
// The loads of a program, and those of the kernel that are written as such and that features ask for.
template <class N, Features features, class Own>
using WithListed = typename JoinedLists<
    Own, std::conditional_t<features.air, LoadList<Air<N, features.bodies>>, LoadList<>>,
    std::conditional_t<features.gravity_gradient, LoadList<GravityGradient<N, features.bodies>>, LoadList<>>,
    std::conditional_t<features.wheels, LoadList<Wheels<N, features.bodies>>, LoadList<>>>::List;

}  // namespace detail

// A load of the kernel has its header, its set-up here, a line in any() and a member. A load of a program stands in the
// scene's list. What each has, loaded_group.hpp says. Contacts by springs are the exception: their points are found in
// working numbers, and so are their forces.
template <class N, Spin spin, Features features, class Own = LoadList<>>
class LoadSet {
public:
    using Work = typename N::Work;
    using DriftSum = typename N::DriftSum;
    static constexpr bool rotation = features.rotation;
    using Bodies = tumble::Bodies<N, spin, features.bodies, features.mixed()>;
    using BodyGroup = tumble::BodyGroup<features.bodies>;
    using L = LoadNumbers<N>;
    using Stage = StageState<N, rotation>;
    using Loaded = LoadedBody<N, rotation, features.mixed()>;
    using OwnLoads = detail::ListedLoads<detail::WithListed<N, features, Own>>;
    using JointSpringsOfWorld =
        JointSprings<N, (features.joints > 0 ? features.joints : 1), (features.bodies > 0 ? features.bodies : 1)>;
    // Those of the program, which may begin and end to act in any step. The kernel's change by change_load() alone.
    using ProgramLoads = detail::ListedLoads<Own>;
    static constexpr bool may_depend_on_velocity =
        features.drag || features.springs > 0 ||
        features.springs_touch() || features.has_joint_springs() || OwnLoads::may_depend_on_velocity;
    // Whether a load may couple two bodies that move.
    static constexpr bool may_couple = features.bodies > 1 &&
                                       (features.springs > 0 || features.gravitation || features.has_joint_springs() ||
                                        features.springs_touch() || OwnLoads::may_couple);
    // Contacts by springs, which wake no body and have their own sum.
    template <class Load>
    static constexpr bool is_contacts = std::is_same_v<Load, ContactSprings<N, spin, features>>;

    constexpr LoadSet(Real step, const WorldSpec& spec)
        : seconds_{N::template constant<Work>(step)},
          steps_per_second_{N::template constant<Work>(Real{1} / step)}, drag_{step, spec}, springs_{step, spec},
          joint_springs_{step, spec}, gravitation_{step, spec}, forces_{step, spec}, contacts_{step, spec} {}

    template <class Load>
    [[nodiscard]] constexpr Load& own() {
        static_assert(OwnLoads::template has<Load>, "the scene's Loads do not name this load");
        return own_;
    }
    template <class Load>
    [[nodiscard]] const Load& own() const {
        static_assert(OwnLoads::template has<Load>, "the scene's Loads do not name this load");
        return own_;
    }
    // Writes or reads the values of the listed loads that have each().
    template <class Self, class Archive>
    static void archive(Self& self, Archive& to) {
        (void)OwnLoads::any(self.own_, [&](auto& load) {
            using Load = std::remove_cvref_t<decltype(load)>;
            if constexpr (requires { Load::each(load, to); }) Load::each(load, to);
            return false;
        });
    }
    // Adds the bytes that snapshots hold of each listed load to a digest, and what the load does.
    void add_own_to(auto& digest) const {
        (void)OwnLoads::any(own_, [&](const auto& load) {
            using Load = std::remove_cvref_t<decltype(load)>;
            typename std::remove_cvref_t<decltype(digest)>::Words words{nullptr};
            if constexpr (requires { Load::each(load, words); }) Load::each(load, words);
            digest.add(words.size());
            digest.add(detail::HasTurns<Load> + 2 * detail::HasCouples<Load> + 4 * detail::HasDependsOnVelocity<Load>);
            return false;
        });
    }
    // Call when a body has been added.
    constexpr void set_body([[maybe_unused]] int b, [[maybe_unused]] const BodySpec& spec,
                            [[maybe_unused]] const PrincipalInertia& inertia, [[maybe_unused]] Bodies& bodies) {
        (void)any(*this, [&](auto& load) {
            if constexpr (requires { load.set_body(b, spec, inertia, bodies); }) {
                if constexpr (features.layers && is_contacts<std::remove_cvref_t<decltype(load)>>)
                    load.set_body(b, as_it_touches(spec), inertia, bodies);
                else load.set_body(b, spec, inertia, bodies);
            } else
                static_assert(!detail::HasSetBody<std::remove_reference_t<decltype(load)>>,
                              "a load's set_body is void set_body(int b, const BodySpec&, const PrincipalInertia&, "
                              "const auto& bodies)");
            return false;
        });
    }
    // Call when a body has been removed: its place loads nothing, and its springs go.
    void remove(int b, Bodies& bodies) {
        BodySpec nobody;
        nobody.fixed = true;
        set_body(b, nobody, {}, bodies);
        if constexpr (features.gravitation) gravitation_.remove(b);
        if constexpr (features.springs > 0) springs_.remove_from(b);
    }
    constexpr void set_softening(Real length) requires(features.gravitation&& features.softening) {
        gravitation_.set_softening(length);
    }
    [[nodiscard]] Work softening() const requires(features.gravitation&& features.softening) {
        return gravitation_.softening();
    }
    // True of a body that planes and bodies touch by springs, if there are any.
    [[nodiscard]] constexpr bool touches(int b) const requires(features.springs_touch()) {
        return contacts_.touches(b);
    }
    // False when there is no room.
    constexpr bool add(const PlaneSpec& spec, Bodies& bodies) requires(features.springs_touch()) {
        return contacts_.add(spec, bodies);
    }
    [[nodiscard]] constexpr int plane_count() const requires(features.springs_touch()) {
        return contacts_.plane_count();
    }
    // Those of the joints.
    [[nodiscard]] auto& joint_springs() requires(features.has_joint_springs()) { return joint_springs_; }
    [[nodiscard]] const auto& joint_springs() const requires(features.has_joint_springs()) { return joint_springs_; }
    [[nodiscard]] constexpr int spring_count() const requires(features.springs > 0) { return springs_.count(); }
    [[nodiscard]] Real largest_safe_step() const requires(features.springs_touch()) {
        return contacts_.largest_safe_step();
    }
    // Adds a spring; false when there is no room. Reports a step that is surely too long for the spring, together with
    // the springs, dampers and drag beside it.
    [[gnu::noinline, gnu::cold]] constexpr bool add(const SpringSpec& spec, Bodies& bodies,
                                                    const SpringBounds<N>& bounds) requires(features.springs > 0) {
        if (!springs_.add(spec, bodies)) return false;
        for (int axis = 0; axis < 4; ++axis) {
            const int b = springs_.body_beyond(bounds, bodies, drag_, axis);
            if (b < 0) continue;
            bodies.report(Issue::step_too_long, b);
            break;
        }
        return true;
    }
    // Reports a step that is too long for the drag of a body that has been added.
    constexpr void check_drag(int b, const BodySpec& spec, const PrincipalInertia& inertia, Bodies& bodies,
                              const StepBounds& bounds) const requires(features.drag) {
        if (!spec.is_fixed() && drag_.is_too_strong(spec, inertia, bodies.rotates(b), bounds.of_damper[1]))
            bodies.report(Issue::step_too_long, b);
    }
    // Calls changed(body) for every force that acts in step `now`.
    template <class F>
    constexpr void set_forces(Span<TimedForce<N>> forces, std::uint64_t now, F&& changed) requires(features.forces) {
        forces_.set(forces, now, changed);
    }

    // Call when the world has gone to step `now`.
    void seek(std::uint64_t now) requires(features.forces) { forces_.seek(now); }

    // True of a body that feels anything but gravity in this step.
    [[nodiscard]] bool is_loaded([[maybe_unused]] const Bodies& bodies, [[maybe_unused]] int b) const {
        return any(*this, [&](const auto& load) { return load.acts_on(bodies, b); });
    }
    // The motion of a body under linear drag, where there is a closed form.
    [[nodiscard]] const auto& closed_form(int b) const requires(features.drag) { return drag_.closed_form(b); }
    // True of a body on which no other load acts than linear drag.
    [[nodiscard]] bool is_only_dragged(const Bodies& bodies, int b) const requires(features.drag) {
        return !any(*this, [&](const auto& load) {
            if constexpr (requires { load.closed_form(b); }) return load.turns(bodies, b);
            else return load.acts_on(bodies, b);
        });
    }
    // True of a body that feels another moving body.
    [[nodiscard]] bool is_coupled([[maybe_unused]] const Bodies& bodies, [[maybe_unused]] int b) const {
        return any(*this, [&](const auto& load) {
            using Load = std::remove_cvref_t<decltype(load)>;
            if constexpr (requires { load.couples(bodies, b); }) {
                static_assert(detail::HasForEachCoupled<Load> || is_contacts<Load>,
                              "a load with couples has for_each_coupled too");
                return load.couples(bodies, b);
            } else {
                static_assert(!detail::HasCouples<Load>,
                              "a load's couples is bool couples(const auto& bodies, int b) const");
                return false;
            }
        });
    }
    // True of a body whose orientation or spin a load changes or asks for. The others move as point masses do.
    [[nodiscard]] bool is_turned([[maybe_unused]] const Bodies& bodies, [[maybe_unused]] int b) const {
        return any(*this, [&](const auto& load) {
            if constexpr (requires { load.turns(bodies, b); }) {
                return load.turns(bodies, b);
            } else {
                static_assert(!detail::HasTurns<std::remove_cvref_t<decltype(load)>>,
                              "a load's turns is bool turns(const auto& bodies, int b) const");
                return false;
            }
        });
    }
    // Calls f(other) for every body that a spring or gravitation ties to b.
    template <class F>
    void for_each_coupled([[maybe_unused]] const Bodies& bodies, [[maybe_unused]] int b, [[maybe_unused]] F&& f) const {
        (void)any(*this, [&](const auto& load) {
            if constexpr (requires { load.for_each_coupled(bodies, b, f); }) load.for_each_coupled(bodies, b, f);
            else
                static_assert(!detail::HasForEachCoupled<std::remove_cvref_t<decltype(load)>>,
                              "a load's for_each_coupled is void for_each_coupled(const auto& bodies, int b, auto&& f) "
                              "const");
            return false;
        });
    }
    // Call before step `now` is taken; calls changed(body) for every timed force that begins or ends at it.
    template <class F>
    void start_step(std::uint64_t now, F&& changed) requires(features.forces) {
        forces_.start_step(now, changed);
    }

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push  // GCC does not see that the stages of a group are set in loops over its bodies
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
    // The loads of one group of bodies, as the methods call them. `alone`: of a body that loads do not couple.
    template <bool alone>
    struct Evaluate {
        static constexpr bool may_depend_on_velocity = LoadSet::may_depend_on_velocity;

        Bodies& bodies;
        const LoadSet& loads;
        const BodyGroup& group;
        Work length;                            // of this portion, in steps
        DriftSum fall[3];                       // gravity's change of drift in it
        bool turned;                            // the loads change or ask for the rotation of the group
        const std::int16_t* place;              // BodyPlaces::of the group; null of a body alone
        bool is_whole;                          // the portion is a whole step
        typename L::Factor per_length;          // portions in a step
        KeptKick<N, rotation>* kept = nullptr;  // of a body alone; null where none may be kept
        std::uint32_t age = 0;                  // the world's count of disturbances

        [[nodiscard]] TUMBLE_INLINE int count() const { return alone ? 1 : group.count; }

        template <class StageState, bool rotates>
        void operator()(const StageState* stages, Kick<N, rotates>* kicks) const {
            evaluate(stages, kicks, nullptr);
        }
        // The kick of whose half a step ends, with the loads at the velocity after that half. Only where
        // ends_in_closed_form().
        template <class StageState, bool rotates>
        void at_end(const StageState* stages, Kick<N, rotates>* kicks) const {
            evaluate(stages, kicks, fall);
        }
        // True of a body alone that loads do not turn, on which only one load depends on the velocity, and linearly.
        [[nodiscard]] bool ends_in_closed_form() const {
            if (!alone || turned || OwnLoads::any(loads.own_, [](const auto& load) { return needs_velocity(load); }))
                return false;
            int loads_of_velocity = 0;
            if constexpr (features.drag) loads_of_velocity += loads.drag_.linear > Work{} ? 1 : 0;
            if constexpr (features.springs > 0) loads_of_velocity += loads.springs_.dampers_at(group.id[0]);
            return is_whole && loads_of_velocity == 1;
        }
        template <class StageState, bool rotates>
        TUMBLE_INLINE void evaluate(const StageState* stages, Kick<N, rotates>* kicks,
                                    const DriftSum* ends_with_half_of) const {
            loads.sum_up(*this, stages, kicks, ends_with_half_of);
            bool within = true;
            for (int k = 0; k < count(); ++k) {
                detail::for_axes<N>([&](int i) __attribute__((always_inline)) {
                    kicks[k].linear[i] = L::settled(kicks[k].linear[i], fall[i], within);
                    if constexpr (rotates)
                        if (turned)
                            kicks[k].angular[i] = L::settled(kicks[k].angular[i], typename N::TurnSum{}, within);
                });
                if (within) [[likely]]
                    continue;
                bodies.report(Issue::range_left, group.id[k]);
                within = true;
            }
        }
        // The same in working numbers, whose range is not limited: m and rad.
        template <class StageState, bool rotates>
        void operator()(const StageState* stages, WorkKick<N, rotates>* kicks) const {
            loads.sum_up(*this, stages, kicks, nullptr);
            for (int k = 0; k < count(); ++k)
                for (int i = 0; i < 3; ++i) kicks[k].linear[i] += N::metres(fall[i], bodies.scale);
        }
        // Whether the kick at the end of the step is kept, its place, and whether it holds that of the last step.
        [[nodiscard]] bool keeps() const requires(alone) { return kept != nullptr; }
        [[nodiscard]] auto* kept_kick() const requires(alone) { return &kept->kick; }
        [[nodiscard]] bool is_known() const requires(alone) { return kept->age == age; }
        // `solved`: it is the loads at the body's place and velocity after the step.
        void keep(bool solved) const requires(alone) {
            if (kept == nullptr) return;
            // A load of the program may turn the body from the next step on.
            const bool stays = solved && (turned || !ProgramLoads::may_turn);
            kept->age = stays ? age : 0;
        }
        [[nodiscard]] bool depends_on_velocity() const {
            return any(loads, [](const auto& load) { return needs_velocity(load); });
        }
        template <class Load>
        [[nodiscard]] static bool needs_velocity(const Load& load) {
            if constexpr (requires { load.depends_on_velocity(); }) {
                return load.depends_on_velocity();
            } else {
                static_assert(!detail::HasDependsOnVelocity<Load>,
                              "a load's depends_on_velocity is bool depends_on_velocity() const");
                return false;
            }
        }
    };
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif
    // `length` is the portion's, of a step; `fall` gravity's change of drift in it.
    template <bool alone>
    [[nodiscard]] Evaluate<alone> evaluation(Bodies& bodies, const BodyGroup& group, Work length,
                                             const DriftSum (&fall)[3], bool turned,
                                             const std::int16_t* place = nullptr) const {
        const bool is_whole = length == Work(1);
        return {bodies,
                *this,
                group,
                length,
                {fall[0], fall[1], fall[2]},
                turned,
                place,
                is_whole,
                is_whole ? L::one() : L::factor(Work(1) / length)};
    }

private:
    // Calls ask(load) for each load of the scene, in the order of the sum, until it is true. Loads that depend on the
    // velocity come last.
    template <class Self, class F>
    TUMBLE_INLINE static constexpr bool any([[maybe_unused]] Self& loads, [[maybe_unused]] F&& ask) {
        if constexpr (features.gravitation)
            if (ask(loads.gravitation_)) return true;
        if constexpr (features.forces)
            if (ask(loads.forces_)) return true;
        if (OwnLoads::any(loads.own_, ask)) return true;
        if constexpr (features.springs > 0)
            if (ask(loads.springs_)) return true;
        if constexpr (features.has_joint_springs())
            if (ask(loads.joint_springs_)) return true;
        if constexpr (features.drag)
            if (ask(loads.drag_)) return true;
        if constexpr (features.springs_touch())
            if (ask(loads.contacts_)) return true;
        return false;
    }

    // Adds up the changes that the loads make in the portion, with the portion as the unit of time.
    template <bool alone, class StageState, class Kick>
    void sum_up(const Evaluate<alone>& e, const StageState* stages, Kick* kicks,
                const DriftSum* ends_with_half_of) const {
        for (int k = 0; k < e.count(); ++k) clear(kicks[k], e.turned);
        using Group = LoadedGroup<N, Bodies, StageState, Kick, alone>;
        Group group{{},         e.bodies,          stages,       kicks,
                    e.group.id, e.place,           e.per_length, e.is_whole,
                    e.turned,   ends_with_half_of, seconds_,     steps_per_second_};
        group.set_count(e.count());
        (void)any(
            *this, [&](const auto& load) __attribute__((always_inline)) {
                if constexpr (requires { load.apply_to(group); }) load.apply_to(group);
                else
                    static_assert(is_contacts<std::remove_cvref_t<decltype(load)>>,
                                  "a load has void apply_to(const auto& group) const");
                return false;
            });
        if constexpr (features.springs_touch() && Group::rotation)
            if (contacts_.is_on()) add_contacts(e, stages, kicks);
        // The step is the unit of time of all constants: a change in a portion is a share with its square.
        if (!e.is_whole) shrink(kicks, e.count(), e.length, e.turned);
    }
    template <class Kick>
    TUMBLE_INLINE static void clear(Kick& kick, [[maybe_unused]] bool turned) {
        detail::for_axes<N>([&](int i) __attribute__((always_inline)) {
            kick.linear[i] = std::remove_reference_t<decltype(kick.linear[i])>{};
            if constexpr (N::fixed_point) detail::keep_apart();
        });
        if constexpr (requires { kick.angular; })
            for (int i = 0; i < 3 && turned; ++i)
                kick.angular[i] = std::remove_reference_t<decltype(kick.angular[i])>{};
    }
    template <class Kick>
    static void shrink(Kick* kicks, int count, Work length, [[maybe_unused]] bool turned) {
        for (int k = 0; k < count; ++k) {
            if constexpr (requires { kicks[k].linear.x(); }) {
                kicks[k].linear = scaled_by(kicks[k].linear, length * length);
                if constexpr (requires { kicks[k].angular; })
                    if (turned) kicks[k].angular = scaled_by(kicks[k].angular, length * length);
            } else {
                const auto part = N::fraction(length);
                for (int i = 0; i < 3; ++i) {
                    kicks[k].linear[i] = N::part(N::part(kicks[k].linear[i], part), part);
                    if constexpr (requires { kicks[k].angular; })
                        if (turned) kicks[k].angular[i] = N::part(N::part(kicks[k].angular[i], part), part);
                }
            }
        }
    }

    // Adds what contacts by springs change in a step.
    template <bool alone, class Kick>
    [[gnu::noinline]] void add_contacts(const Evaluate<alone>& e, const Stage* stages, Kick* kicks) const
        requires(features.springs_touch()) {
        Loaded loaded[features.bodies];
        const Work steps_per_second = e.is_whole ? steps_per_second_ : steps_per_second_ / e.length;
        for (int k = 0; k < e.group.count; ++k) load(loaded[k], e.group.id[k], stages[k], e.bodies, steps_per_second);
        const auto find = [&](int b) -> Loaded* {
            if constexpr (features.bodies == 1) return loaded;
            for (int k = 0; k < e.group.count; ++k)
                if (e.group.id[k] == b) return &loaded[k];
            return nullptr;
        };
        Stage still_stage;  // a fixed body at the other end of a load
        Loaded still;
        const auto other_end = [&](int b) -> Loaded* {
            if constexpr (features.bodies == 1) return find(b);
            if (Loaded* found = find(b)) return found;
            still_stage = stage_of(e.bodies.state[b]);
            load(still, b, still_stage, e.bodies, steps_per_second);
            return &still;
        };
        contacts_.apply_to(e.group, loaded, e.bodies, find, other_end);
        for (int k = 0; k < e.group.count; ++k) {
            const auto& body = e.bodies.constants[e.group.id[k]];
            const Work linear = body.drift_per_impulse() * seconds_;
            for (int i = 0; i < 3; ++i) L::add(kicks[k].linear, i, loaded[k].force_w[i] * linear, e.bodies.scale);
            for (int i = 0; i < 3 && loaded[k].rotates(); ++i)
                L::add(kicks[k].angular, i, loaded[k].torque_b[i] * (body.units.per_impulse(i) * seconds_),
                       e.bodies.scale);
        }
    }

    static void load(Loaded& loaded, [[maybe_unused]] int b, const Stage& stage, const Bodies& bodies,
                     Work steps_per_second) {
        loaded.stage = &stage;
        loaded.force_w = zero_vector<N>();
        for (int i = 0; i < 3; ++i) loaded.v_w[i] = N::metres(stage.d_w[i], bodies.scale) * steps_per_second;
        if constexpr (features.mixed()) {
            loaded.is_point = !bodies.rotates(b);
            if (loaded.is_point) return;
        }
        if constexpr (rotation) {
            loaded.q_wb = work_quaternion<N>(stage.q_wb);
            loaded.torque_b = zero_vector<N>();
            for (int i = 0; i < 3; ++i)
                loaded.w_b[i] =
                    N::half_turn(stage.t_b[i], bodies.scale) * bodies.constants[b].units.rate(i, steps_per_second);
        }
    }

    Work seconds_, steps_per_second_;
    [[no_unique_address]] If<features.drag, Drag<N, features.bodies>, 0> drag_;
    [[no_unique_address]] If<(features.springs > 0), Springs<N, features.springs, features.bodies>, 1> springs_;
    [[no_unique_address]] If<features.has_joint_springs(), JointSpringsOfWorld, 5> joint_springs_;
    [[no_unique_address]] If<features.gravitation, Gravitation<N, features.bodies, features.softening>, 2> gravitation_;
    [[no_unique_address]] If<features.forces, TimedForces<N>, 3> forces_;
    [[no_unique_address]] If<features.springs_touch(), ContactSprings<N, spin, features>, 4> contacts_;
    [[no_unique_address]] OwnLoads own_{};
};

}  // namespace tumble

// The loads of a world and their sum at a stage of a step. Gravity is no load: it is constant and needs no stages.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/loads/air.hpp>
#include <tumble/loads/begun_force.hpp>
#include <tumble/loads/contact_spring.hpp>
#include <tumble/loads/drag.hpp>
#include <tumble/loads/gravitation.hpp>
#include <tumble/loads/gravity_gradient.hpp>
#include <tumble/loads/joint_spring.hpp>
#include <tumble/loads/load.hpp>
#include <tumble/loads/spring.hpp>
#include <tumble/loads/wheels.hpp>

namespace tumble {

// A load of the kernel has its header and its line in Loads, a load of a program stands in the scene's list. What each
// has, load.hpp says.
template <class N, Spin spin, Features features, class Own = LoadList<>>
class LoadSet {
public:
    using Work = typename N::Work;
    using DriftSum = typename N::DriftSum;
    static constexpr bool rotation = features.rotation;
    using Bodies = tumble::Bodies<N, spin, features.bodies, features.mixed()>;
    using BodyGroup = tumble::BodyGroup<features.bodies>;
    using L = LoadNumbers<N>;
    using Gravitation = tumble::Gravitation<N, features.bodies, features.softening>;
    using Springs = tumble::Springs<N, features.springs, features.bodies>;
    using JointSprings = tumble::JointSprings<N, features.joints, features.bodies>;
    using Drag = tumble::Drag<N, features.bodies>;
    using Begun = BegunForces<N, features.rotation, features.bodies>;
    using Contacts = ContactSprings<N, spin, features>;
    template <bool present, class Load>
    using Only = std::conditional_t<present, LoadList<Load>, LoadList<>>;
    // Those that change_load() changes: of the program, which may begin and end to act in any step, and of the kernel.
    using Changed = decltype(Own{} + Only<features.air, Air<N, features.bodies>>{} +
                             Only<features.gravity_gradient, GravityGradient<N, features.bodies>>{} +
                             Only<features.wheels, Wheels<N, features.bodies>>{});
    // All, in the order of the sum: those of the kernel that depend on the velocity come last.
    using Loads =
        detail::HeldLoads<decltype(Only<features.gravitation, Gravitation>{} + Only<features.forces, Begun>{} +
                                   Changed{} + Only<(features.springs > 0), Springs>{} +
                                   Only<features.has_joint_springs(), JointSprings>{} + Only<features.drag, Drag>{} +
                                   Only<features.springs_touch(), Contacts>{}),
                          Bodies>;
    static constexpr bool may_depend_on_velocity = Loads::may_depend_on_velocity;
    // Whether a load may couple two bodies that move.
    static constexpr bool may_couple = features.bodies > 1 && Loads::may_couple;

    constexpr LoadSet(Real step, const WorldSpec& spec)
        : seconds_{N::template constant<Work>(step)},
          steps_per_second_{N::template constant<Work>(Real{1} / step)}, loads_{step, spec} {}

    template <class Load>
    [[nodiscard]] constexpr Load& own() {
        static_assert(Changed::template has<Load>, "the scene's Loads do not name this load");
        return get<Load>();
    }
    template <class Load>
    [[nodiscard]] const Load& own() const {
        static_assert(Changed::template has<Load>, "the scene's Loads do not name this load");
        return get<Load>();
    }
    // Writes or reads the values of the loads that have each().
    template <class Self, class Archive>
    static void archive(Self& self, Archive& to) {
        (void)Loads::any(self.loads_, [&](auto& load) {
            using Load = std::remove_cvref_t<decltype(load)>;
            if constexpr (requires { Load::each(load, to); }) Load::each(load, to);
            return false;
        });
    }
    // Adds the bytes that snapshots hold of each load that may be changed to a digest, and what the load does.
    void add_own_to(auto& digest) const {
        (void)Loads::any(loads_, [&](const auto& load) {
            using Load = std::remove_cvref_t<decltype(load)>;
            if constexpr (Changed::template has<Load>) {
                typename std::remove_cvref_t<decltype(digest)>::Words words{nullptr};
                if constexpr (requires { Load::each(load, words); }) Load::each(load, words);
                digest.add(words.size());
                digest.add(detail::Turns<Load, Bodies> + 2 * detail::Couples<Load, Bodies> +
                           4 * detail::DependsOnVelocity<Load>);
            }
            return false;
        });
    }
    // Call when a body has been added.
    constexpr void set_body(int b, const BodySpec& spec, const PrincipalInertia& inertia, Bodies& bodies) {
        (void)Loads::any(loads_, [&]<class Load>(Load& load) {
            if constexpr (detail::SetsBody<Load, Bodies>) load.set_body(b, spec, inertia, bodies);
            return false;
        });
    }
    // Call when a body has been removed: its place loads nothing, and its springs go.
    void remove(int b, Bodies& bodies) {
        BodySpec nobody;
        nobody.fixed = true;
        set_body(b, nobody, {}, bodies);
        if constexpr (features.gravitation) get<Gravitation>().remove(b);
        if constexpr (features.springs > 0) get<Springs>().remove_from(b);
    }
    // Those of the kernel, where there are any.
    [[nodiscard]] constexpr auto& gravitation() { return get<Gravitation>(); }
    [[nodiscard]] constexpr const auto& gravitation() const { return get<Gravitation>(); }
    [[nodiscard]] constexpr auto& contacts() { return get<Contacts>(); }
    [[nodiscard]] constexpr const auto& contacts() const { return get<Contacts>(); }
    [[nodiscard]] auto& begun_forces() { return get<Begun>(); }
    [[nodiscard]] constexpr auto& joint_springs() { return get<JointSprings>(); }
    [[nodiscard]] constexpr const auto& joint_springs() const { return get<JointSprings>(); }
    [[nodiscard]] constexpr const auto& springs() const { return get<Springs>(); }
    // Without drag: something without coefficients.
    [[nodiscard]] constexpr const auto& drag() const {
        if constexpr (features.drag) return get<Drag>();
        else return loads_;
    }

    // Adds a spring; false when there is no room. Reports a step that is surely too long for the spring, together with
    // the springs, dampers and drag beside it.
    [[gnu::noinline, gnu::cold]] constexpr bool add(const SpringSpec& spec, Bodies& bodies,
                                                    const SpringBounds<N>& bounds) requires(features.springs > 0) {
        if (!get<Springs>().add(spec, bodies)) return false;
        for (int axis = 0; axis < 4; ++axis) {
            const int b = get<Springs>().body_beyond(bounds, bodies, drag(), axis);
            if (b < 0) continue;
            bodies.report(Issue::step_too_long, b);
            break;
        }
        return true;
    }
    // True of a body that feels anything but gravity in this step.
    [[nodiscard]] bool is_loaded(const Bodies& bodies, int b) const {
        return any([&](const auto& load) { return load.acts_on(bodies, b); });
    }
    // True of a body on which no other load acts than linear drag.
    [[nodiscard]] bool is_only_dragged(const Bodies& bodies, int b) const requires(features.drag) {
        return !any([&]<class Load>(const Load& load) {
            if constexpr (std::is_same_v<Load, Drag>) return load.turns(bodies, b);
            else return load.acts_on(bodies, b);
        });
    }
    // True of a body that feels another moving body.
    [[nodiscard]] bool is_coupled(const Bodies& bodies, int b) const {
        return any([&]<class Load>(const Load& load) {
            if constexpr (detail::Couples<Load, Bodies>) return load.couples(bodies, b);
            else return false;
        });
    }
    // True of a body whose orientation or spin a load changes or asks for. The others move as point masses do.
    [[nodiscard]] bool is_turned(const Bodies& bodies, int b) const {
        return any([&]<class Load>(const Load& load) {
            if constexpr (detail::Turns<Load, Bodies>) return load.turns(bodies, b);
            else return false;
        });
    }
    // Calls f(other) for every body that a load ties to b. Contacts tie none.
    template <class F>
    void for_each_coupled(const Bodies& bodies, int b, F&& f) const {
        (void)any([&]<class Load>(const Load& load) {
            if constexpr (detail::ForEachCoupled<Load, Bodies>) load.for_each_coupled(bodies, b, f);
            return false;
        });
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
            if (!alone || turned) return false;
            int linear = 0;  // loads that depend on the velocity and can end a step
            const bool is_other = loads.any([&]<class Load>(const Load& load) {
                if constexpr (Changed::template has<Load>) return needs_velocity(load);
                else if constexpr (requires { load.dampers_at(0); }) linear += load.dampers_at(group.id[0]);
                return false;
            });
            return !is_other && is_whole && linear == 1;
        }
        template <class StageState, bool rotates>
        TUMBLE_INLINE void evaluate(const StageState* stages, Kick<N, rotates>* kicks,
                                    const DriftSum* ends_with_half_of) const {
            loads.sum_up(*this, stages, kicks, ends_with_half_of);
            bool within = true;
            for (int k = 0; k < count(); ++k) {
                detail::for_axes<N>([&](int i) __attribute__((always_inline)) {
                    kicks[k].linear[i] = L::clamped(kicks[k].linear[i], fall[i], within);
                    if constexpr (rotates)
                        if (turned)
                            kicks[k].angular[i] = L::clamped(kicks[k].angular[i], typename N::TurnSum{}, within);
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
            const bool stays = solved && (turned || !detail::HeldLoads<Own, Bodies>::may_turn);
            kept->age = stays ? age : 0;
        }
        [[nodiscard]] bool depends_on_velocity() const {
            return loads.any([](const auto& load) { return needs_velocity(load); });
        }
        template <class Load>
        [[nodiscard]] static bool needs_velocity([[maybe_unused]] const Load& load) {
            if constexpr (detail::DependsOnVelocity<Load>) return load.depends_on_velocity();
            else return false;
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
    template <class Load>
    [[nodiscard]] TUMBLE_INLINE constexpr Load& get() {
        return Loads::template get<Load>(loads_);
    }
    template <class Load>
    [[nodiscard]] TUMBLE_INLINE constexpr const Load& get() const {
        return Loads::template get<Load>(loads_);
    }
    // Calls ask(load) for each load, in the order of the sum, until it is true.
    template <class F>
    TUMBLE_INLINE bool any(F&& ask) const {
        return Loads::any(loads_, ask);
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
        (void)any([&](const auto& load) __attribute__((always_inline)) {
            static_assert(
                requires { load.apply_to(group); }, "a load has void apply_to(const auto& group) const");
            load.apply_to(group);
            return false;
        });
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

    Work seconds_, steps_per_second_;
    [[no_unique_address]] Loads loads_;
};

}  // namespace tumble

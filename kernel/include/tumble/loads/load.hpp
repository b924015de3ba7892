// What a load is, and the loads of a world as one list.
//
// A load is a struct, of the kernel or of a program. Its functions, all const but set_body:
//   acts_on(bodies, b)                 true of a body that feels it in this step
//   turns(bodies, b)                   only where it changes or asks for an orientation or a spin: true of such a body
//   apply_to(group)                    pushes and turns the bodies of a LoadedGroup, also those on which only other
//                                      loads act. Where Group::rotation is false, there is no orientation, and nothing
//                                      turns
//   couples(bodies, b), for_each_coupled(bodies, b, f)   only where a body feels another that moves
//   depends_on_velocity()              only where it may depend on a velocity or a spin
//   set_body(b, spec, inertia, bodies) only where it keeps something of each body; called when a body is added, and
//                                      with a fixed body when one is removed; constexpr where the compiler sets up the
//                                      world
//   each(load, archive)                only where snapshots hold values of it; static: archive(load.a, ...)
// acts_on, turns and couples may change from step to step. The forces depend on the stage and on the load's own members
// alone, which World::change_load() changes: methods keep the last forces of a step for the next one.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/scene.hpp>

namespace tumble {

// The loads of two lists as one list.
template <class... Loads, class... More>
LoadList<Loads..., More...> operator+(LoadList<Loads...>, LoadList<More...>);

namespace detail {

// The functions that a load may lack, as they are called.
template <class Load, class Bodies>
concept Turns = requires(const Load& load, const Bodies& bodies) {
    { load.turns(bodies, 0) } -> std::convertible_to<bool>;
};
template <class Load, class Bodies>
concept Couples = requires(const Load& load, const Bodies& bodies) {
    { load.couples(bodies, 0) } -> std::convertible_to<bool>;
};
template <class Load, class Bodies>
concept ForEachCoupled = requires(const Load& load, const Bodies& bodies, void (&f)(int)) {
    load.for_each_coupled(bodies, 0, f);
};
template <class Load>
concept DependsOnVelocity = requires(const Load& load) {
    { load.depends_on_velocity() } -> std::convertible_to<bool>;
};
template <class Load, class Bodies>
concept SetsBody = requires(Load& load, const BodySpec& spec, const PrincipalInertia& inertia, Bodies& bodies) {
    load.set_body(0, spec, inertia, bodies);
};
struct AnyArchive {
    void operator()(auto&...) {}
};
template <class Load>
concept HasEach = requires(Load& load, AnyArchive& archive) {
    Load::each(load, archive);
};
// Their names. A name of both bases is ambiguous: that of a function of the load, whatever its arguments.
struct OptionalNames {
    void turns(), couples(), for_each_coupled(), depends_on_velocity(), set_body(), each();
};
template <class Load>
struct WithNames : Load, OptionalNames {};

// A load in the list of a world.
template <class Load, class Bodies>
struct HeldLoad {
    using Names = WithNames<Load>;
    static_assert(
        Turns<Load, Bodies> || requires { &Names::turns; },
        "a load's turns is bool turns(const auto& bodies, int b) const");
    static_assert(
        Couples<Load, Bodies> || requires { &Names::couples; },
        "a load's couples is bool couples(const auto& bodies, int b) const");
    static_assert(
        ForEachCoupled<Load, Bodies> || requires { &Names::for_each_coupled; },
        "a load's for_each_coupled is void for_each_coupled(const auto& bodies, int b, auto&& f) const");
    static_assert(ForEachCoupled<Load, Bodies> || !Couples<Load, Bodies>,
                  "a load with couples has for_each_coupled too");
    static_assert(
        DependsOnVelocity<Load> || requires { &Names::depends_on_velocity; },
        "a load's depends_on_velocity is bool depends_on_velocity() const");
    static_assert(
        SetsBody<Load, Bodies> || requires { &Names::set_body; },
        "a load's set_body is void set_body(int b, const BodySpec&, const PrincipalInertia&, const auto& "
        "bodies)");
    static_assert(
        HasEach<Load> || requires { &Names::each; }, "a load's each is static void each(auto& load, auto& archive)");

    // Loads of the kernel are set up with the step, s, and the world's values.
    constexpr HeldLoad(Real step, const WorldSpec& spec) requires std::is_constructible_v<Load, Real, const WorldSpec&>
        : load(step, spec) {}
    constexpr HeldLoad(Real, const WorldSpec&) {}

    [[no_unique_address]] Load load{};
};

// The loads of a list as one value.
template <class List, class Bodies>
struct HeldLoads;
template <class... Loads, class Bodies>
struct HeldLoads<LoadList<Loads...>, Bodies> : HeldLoad<Loads, Bodies>... {
    static constexpr bool may_turn = (Turns<Loads, Bodies> || ...), may_couple = (Couples<Loads, Bodies> || ...),
                          may_depend_on_velocity = (DependsOnVelocity<Loads> || ...);

    constexpr HeldLoads([[maybe_unused]] Real step, [[maybe_unused]] const WorldSpec& spec)
        : HeldLoad<Loads, Bodies>{step, spec}... {}
    template <class Load, class Self>
    [[nodiscard]] TUMBLE_INLINE static constexpr auto& get(Self& loads) {
        using Held = HeldLoad<Load, Bodies>;
        return static_cast<std::conditional_t<std::is_const_v<Self>, const Held, Held>&>(loads).load;
    }
    // Calls ask(load) for each load, until it is true.
    template <class Self, class F>
    TUMBLE_INLINE static constexpr bool any([[maybe_unused]] Self& loads, [[maybe_unused]] F&& ask) {
        return (ask(get<Loads>(loads)) || ...);
    }
};

}  // namespace detail
}  // namespace tumble

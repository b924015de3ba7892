// Replay<Config, Data>: a world that is set up from a scene's data. A firmware (constant data) and the host (data read
// at run time) both set up their worlds here, so both do the same arithmetic in the same order.
//
// Data has the members name, step (Seconds), steps, world (WorldSpec), and the lists bodies, planes and springs of
// their *Spec types. There may be a list events of EventSpec, and for loads that Config has: wind, m/s, and a list
// drags of DragSpec; a list wheels of WheelsSpec; orbit, an OrbitSpec; softening, m, of gravitation. Joints differ in
// type by kind: joints is a std::tuple of their specs, or a list of which each element calls f(spec) in visit(f). In
// the output of `tumble compile` all of them are static constexpr. A list is a std::array, or any type with size() that
// resize() can grow. Config is a Scene with room for all data and the features that it needs.
//
// Events are prepared when the scene is set up, in RAM. In fixed point, events that are static
// constexpr are prepared by the compiler: an event takes sizeof(Event<Numbers>) = 80 bytes of flash, and no RAM.
#pragma once

#include <tumble/world.hpp>

namespace tumble {

namespace detail {

// A list of T of the same kind as List: as long, or as growable.
template <class List, class T>
struct ListOf;
template <template <class, std::size_t> class Array, class Spec, std::size_t size, class T>
struct ListOf<Array<Spec, size>, T> {
    using type = Array<T, size>;
};
template <template <class...> class List, class Spec, class... Rest, class T>
struct ListOf<List<Spec, Rest...>, T> {
    using type = List<T>;
};

// Calls f(spec) for each joint of a scene's data, in their order.
constexpr void for_each_joint(const auto& joints, auto&& f) {
    if constexpr (requires { std::tuple_size<std::remove_cvref_t<decltype(joints)>>::value; })
        std::apply([&](const auto&... specs) { (f(specs), ...); }, joints);
    else
        for (const auto& joint : joints) joint.visit(f);
}

// The latest step of events. It reads all that preparing an event reads, so it is a constant only where they are.
[[nodiscard]] constexpr std::uint64_t latest_step(const auto& events, Seconds step) {
    std::uint64_t latest = 0;
    for (const EventSpec& event : events) {
        const std::uint64_t at = nearest_step(event.time, step.value);
        if (at > latest) latest = at;
    }
    return latest;
}

}  // namespace detail

// A world with a scene's bodies and everything that acts on them.
template <class Config, class Data>
class Replay {
    using N = typename Config::Numbers;
    static_assert(
        !requires(const Data& data) { data.impulses; } && !requires(const Data& data) { data.forces; },
        "the data lists impulses and forces among its events");
    template <class List, class T>
    using Prepared = typename detail::ListOf<std::remove_cvref_t<List>, T>::type;
    static constexpr bool has_joints = Config::features.has_joints() && requires(const Data& data) { data.joints; };
    static constexpr bool has_events = Config::features.has_script() && requires(const Data& data) { data.events; };
    // Whether events and step are constants. A pointer to a member that is not static is no pointer to an object.
    template <class From>
    static constexpr bool has_static_events = requires {
        requires std::is_pointer_v<decltype(&From::events)>;
    };
    template <class From>
    static constexpr bool is_constant = requires {
        typename std::integral_constant<std::uint64_t, detail::latest_step(From::events, From::step)>;
    };
    static constexpr bool has_constant_events = [] {
        if constexpr (has_events && N::fixed_point && has_static_events<Data>) return is_constant<Data>;
        else return false;
    }();
    template <bool in_memory = has_events && !has_constant_events, class From = Data>
    struct Events {
        using type = detail::Nothing<0>;
    };
    template <class From>
    struct Events<true, From> {
        using type = Prepared<decltype(From::events), Event<N>>;
    };

public:
    // Sets up the scene. Without room for all bodies in Config, Issue::world_full is set, and so it is with joints
    // that close a loop. Misuse: planes, springs and joints without room, and data without the feature that obeys them.
    constexpr explicit Replay(const Data& data = Data{}) : world_{empty_world(data)} {
        require_features(data);
        if constexpr (Config::features.bodies > 0)
            for (const BodySpec& body : data.bodies) (void)world_.add(body);
        if constexpr (Config::features.planes > 0)
            for (const PlaneSpec& plane : data.planes) (void)world_.add(plane);
        if constexpr (Config::features.springs > 0)
            for (const SpringSpec& spring : data.springs) (void)world_.add(spring);
        if constexpr (has_joints)
            detail::for_each_joint(data.joints, [&](const auto& spec) { (void)world_.add(spec); });
        set_up_loads(data);
        if constexpr (has_constant_events)
            world_.set_script({constant_events<>.data(), static_cast<int>(constant_events<>.size())});
        else if constexpr (has_events) world_.set_script(prepare_sorted(events_, data.events, world_.bodies()));
    }
    // The world points to the prepared arrays.
    Replay(const Replay&) = delete;
    Replay& operator=(const Replay&) = delete;

    // Takes one step. Returns the sticky status.
    Status step() { return world_.step(); }
    // The world.
    [[nodiscard]] World<Config>& world() { return world_; }
    // The world.
    [[nodiscard]] const World<Config>& world() const { return world_; }

private:
    static constexpr Features features = Config::features;

    // Ends the program where data would be ignored, and names the feature. Point masses touch no plane.
    static constexpr void require_features(const Data& data) {
        const auto count = [](const auto& list) { return static_cast<int>(list.size()); };
        constexpr bool moves = features.bodies > 0, rotates = moves && features.rotation;
        TUMBLE_ASSERT(features.planes >= count(data.planes) || !rotates);
        TUMBLE_ASSERT(features.springs >= count(data.springs));
        if constexpr (requires { data.joints; }) {
            int joints = 0;
            detail::for_each_joint(data.joints, [&](const auto&) { ++joints; });
            TUMBLE_ASSERT(features.joints >= joints);
        }
        if constexpr (requires { data.events; }) TUMBLE_ASSERT(features.has_script() || count(data.events) == 0);
        if constexpr (requires { data.softening; })
            TUMBLE_ASSERT((features.gravitation && features.softening) || features.bodies < 2 ||
                          data.softening.is_zero());
        if constexpr (requires { data.drags; }) TUMBLE_ASSERT(features.air || count(data.drags) == 0);
        if constexpr (requires { data.wheels; }) TUMBLE_ASSERT(features.wheels || count(data.wheels) == 0);
        if constexpr (requires { data.orbit; })
            TUMBLE_ASSERT(features.gravity_gradient || !rotates || data.orbit.rate.is_zero());
    }
    // Softening, air, wheels and orbit, where both Config and the data have them.
    constexpr void set_up_loads([[maybe_unused]] const Data& data) {
        constexpr int bodies = Config::features.bodies;
        if constexpr (Config::features.gravitation && Config::features.softening && requires { data.softening; })
            world_.set_softening(data.softening);
        if constexpr (Config::features.air && requires { data.drags; }) {
            auto& air = world_.template change_load<Air<N, bodies>>();
            air.set_wind(data.wind);
            for (const DragSpec& drag : data.drags) air.set_drag(drag.body, drag.linear, drag.quadratic);
        }
        if constexpr (Config::features.wheels && requires { data.wheels; }) {
            auto& wheels = world_.template change_load<Wheels<N, bodies>>();
            for (const WheelsSpec& spec : data.wheels) wheels.set_momentum(spec.body, spec.momentum);
        }
        if constexpr (Config::features.gravity_gradient && requires { data.orbit; })
            if (!data.orbit.rate.is_zero())
                world_.template change_load<GravityGradient<N, bodies>>().set_orbit(data.orbit.rate,
                                                                                    data.orbit.to_centre);
    }
    template <class From = Data>
    static constexpr auto constant_events = [] {
        Prepared<decltype(From::events), Event<N>> events{};
        detail::prepare_each(events, From::events, [](const EventSpec& spec) {
            if constexpr (World<Config>::has_step) return detail::event_of<N>(spec, Config::step.value);
            else return detail::event_of<N>(spec, From::step.value);
        });
        return events;
    }();
    static constexpr World<Config> empty_world(const Data& data) {
        if constexpr (World<Config>::has_step) return World<Config>{data.world};
        else return World<Config>{data.step, data.world};
    }

    World<Config> world_;
    [[no_unique_address]] typename Events<>::type events_{};
};

}  // namespace tumble

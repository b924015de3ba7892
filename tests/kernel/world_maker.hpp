// make_world<N>: an AnyWorld for every integrator of the list in one number system, with every feature.
// make_world_with: the same for one set of features.
#pragma once

#include <tumble/tumble.hpp>

#include "number_systems.hpp"
#include "simulation/motion_of.hpp"
#include "worlds.hpp"

#include <limits>

namespace tumble::test {

template <class N, class Method, Features f>
class WorldOf final : public AnyWorld {
public:
    WorldOf(Seconds step, const WorldSpec& spec) : world_{step, spec} {}

    bool add(const BodySpec& body) override {
        const BodyId id = world_.add(body);
        if (id) axes_.emplace_back(principal_inertia(body.inertia));
        return static_cast<bool>(id);
    }
    bool add([[maybe_unused]] const PlaneSpec& plane) override {
        if constexpr (f.planes > 0) return static_cast<bool>(world_.add(plane));
        else return false;
    }
    bool add([[maybe_unused]] const SpringSpec& spring) override {
        if constexpr (f.springs > 0) return static_cast<bool>(world_.add(spring));
        else return false;
    }
    void set_events([[maybe_unused]] const std::vector<EventSpec>& events) override {
        if constexpr (f.has_script()) world_.set_script(prepare_sorted(events_, events, world_.bodies()));
    }
    void apply(const EventSpec& event) override { world_.apply(world_.prepare(event)); }
    void apply_impulse(int body, Vector impulse, Vector point) override {
        world_.apply_impulse(BodyId{body}, real(impulse), real(point));
    }
    void set_gravity(Vector gravity) override { world_.set_gravity(real(gravity)); }
    Status step() override { return world_.step(); }
    void clear_status() override { world_.clear_status(); }
    void start_at(std::uint32_t step) override {
        const_cast<typename World<SceneOf<N, Method, f>>::Bodies&>(world_.bodies()).steps_taken = step;
    }

    Motion motion(int body) const override {
        return host::motion_of(world_.bodies(), axes_.at(static_cast<std::size_t>(body)), body);
    }
    Motion reported(int body) const override {
        const BodyId id{body};
        const auto q = world_.orientation(id);
        return {plain(world_.position(id)),
                plain(world_.velocity(id)),
                {static_cast<double>(q.w), plain(q.v)},
                plain(world_.angular_velocity(id))};
    }
    Status status() const override { return world_.status(); }
    std::uint64_t hash() const override { return world_.hash(); }
    int body_count() const override { return world_.body_count(); }
    int contact_count(int body) const override { return world_.contact_count(BodyId{body}); }
    std::vector<ReadContact> contacts([[maybe_unused]] int body) const override {
        std::vector<ReadContact> all;
        if constexpr (f.contacts() && f.contact_readout) {
            const auto number_of = [](auto x) { return static_cast<Number>(static_cast<double>(x)); };
            for (const auto& c : world_.contacts(BodyId{body})) {
                ReadContact read{c.body.index(), c.plane.index(), c.touches, c.began, c.ended, c.hit};
                read.hit_speed = number_of(c.hit_speed);
                read.depth = number_of(c.depth);
                read.normal_impulse = number_of(c.normal_impulse);
                read.normal = plain(c.normal);
                read.point = plain(c.point);
                read.impulse = plain(c.impulse);
                read.friction_impulse = plain(c.friction_impulse);
                for (int i = 0; i < c.point_count; ++i) read.points.push_back(plain(c.points[i]));
                all.push_back(read);
            }
        }
        return all;
    }
    bool asleep([[maybe_unused]] int body) const override {
        if constexpr (f.sleep) return world_.asleep(BodyId{body});
        else return false;
    }
    Number largest_safe_step() const override {
        if constexpr (f.contact_springs) return number(world_.largest_safe_step());
        else return std::numeric_limits<Number>::infinity();
    }

private:
    static Vector plain(const tumble::Vector3<typename N::Work>& v) {
        return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
    }

    World<SceneOf<N, Method, f>> world_;
    std::vector<host::PrincipalAxes> axes_;
    std::vector<Event<N>> events_;
};

template <class N, Features f, class Methods>
std::unique_ptr<AnyWorld> make_world_of(std::string_view method, Seconds step, const WorldSpec& spec) {
    std::unique_ptr<AnyWorld> world;
    Methods::template for_each_in<N>([&]<class Method>() {
        if (method == Method::name) world = std::make_unique<WorldOf<N, Method, f>>(step, spec);
    });
    return world;
}
// The systems that differ most, or in the quick set double alone. The others do not have every method; with sanitizers,
// which slow a step down by more than ten times, none has.
#ifdef TUMBLE_SANITIZED
constexpr bool is_sanitized = true;
#else
constexpr bool is_sanitized = false;
#endif
template <class N>
#ifdef TUMBLE_EVERY_KIND
constexpr bool has_every_method =
    !is_sanitized && (std::is_same_v<N, systems::q32_near> || std::is_same_v<N, systems::f64>);
#else
constexpr bool has_every_method = !is_sanitized && std::is_same_v<N, systems::f64>;
#endif
#ifdef TUMBLE_EVERY_KIND
// For tests of features: one method of each kind.
using FeatureIntegrators = IntegratorList<integrators::ImplicitEuler, integrators::Rk4, integrators::Verlet>;
// Those that differ from others by more than a table of coefficients.
template <class N>
using OtherIntegrators =
    IntegratorList<integrators::ExplicitEuler, integrators::SemiImplicitEuler, integrators::ImplicitEuler,
                   integrators::Midpoint, integrators::Heun, integrators::Rk4, integrators::Verlet,
                   integrators::Suzuki4, integrators::Pdmv6, integrators::Exact>;
#else
using FeatureIntegrators = IntegratorList<integrators::Verlet>;
// In the quick set one that keeps the angular velocity and one that keeps the angular momentum; in fixed point those
// too whose error is held against that in double.
template <class N>
using OtherIntegrators = std::conditional_t<N::fixed_point && !is_sanitized,
                                            IntegratorList<integrators::Rk4, integrators::Verlet, integrators::Pdmv4,
                                                           integrators::Pdmv6, integrators::Pdmv8, integrators::Pdmv10>,
                                            IntegratorList<integrators::Rk4, integrators::Verlet, integrators::Exact>>;
#endif
template <class N>
using IntegratorsOf = std::conditional_t<has_every_method<N>, Integrators, OtherIntegrators<N>>;
template <class N>
std::unique_ptr<AnyWorld> make_world(std::string_view method, Seconds step, const WorldSpec& spec) {
    return make_world_of<N, everything, IntegratorsOf<N>>(method, step, spec);
}
template <class N>
bool has_world(std::string_view method) {
    bool found = false;
    IntegratorsOf<N>::template for_each_in<N>([&]<class Method>() { found |= method == Method::name; });
    return found;
}
// Null for other methods.
template <class N, Features f>
std::unique_ptr<AnyWorld> make_minimal_world(std::string_view method, Seconds step, const WorldSpec& spec) {
    return make_world_of<N, f, FeatureIntegrators>(method, step, spec);
}

}  // namespace tumble::test

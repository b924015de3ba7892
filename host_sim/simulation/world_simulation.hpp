// A Simulation of one integrator and number system, with every feature of the kernel compiled in. Included only by the
// translation units that the build makes from number_system.cpp.in.
#pragma once

#include <tumble/replay.hpp>
#include <tumble/tumble.hpp>

#include <cmath>
#include <utility>

#include "simulation/number_systems.hpp"

namespace tumble::host {

using LongVec3 = std::array<long double, 3>;
using LongQuat = std::array<long double, 4>;

[[nodiscard]] inline LongVec3 operator+(const LongVec3& a, const LongVec3& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
[[nodiscard]] inline LongVec3 operator-(const LongVec3& a, const LongVec3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
[[nodiscard]] inline LongVec3 operator*(const LongVec3& a, long double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
[[nodiscard]] inline long double dot(const LongVec3& a, const LongVec3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
[[nodiscard]] inline LongVec3 cross(const LongVec3& a, const LongVec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
[[nodiscard]] inline LongQuat product(const LongQuat& a, const LongQuat& b) {
    const LongVec3 u{a[1], a[2], a[3]}, v{b[1], b[2], b[3]}, r = v * a[0] + u * b[0] + cross(u, v);
    return {a[0] * b[0] - dot(u, v), r[0], r[1], r[2]};
}
[[nodiscard]] inline LongVec3 rotate(const LongQuat& q, const LongVec3& r) {
    const LongVec3 v{q[1], q[2], q[3]}, t = cross(v, r) * 2.0L;
    return r + t * q[0] + cross(v, t);
}

// All 64 bits of a Real, where long double has that many.
[[nodiscard]] inline long double wide(Real value) {
    const double upper = value.to_double();
    return static_cast<long double>(upper) + static_cast<long double>((value - Real{upper}).to_double());
}
[[nodiscard]] inline LongVec3 wide(const RealVec3& v) { return {wide(v.x), wide(v.y), wide(v.z)}; }

// Value and residual of a carried number; floating point may be infinite or not a number.
template <class Number>
requires requires { typename Number::Value; }
[[nodiscard]] long double wide(const Number& number) {
    if constexpr (std::floating_point<typename Number::Value>)
        return static_cast<long double>(number.value()) + static_cast<long double>(number.residual());
    else return wide(number.to_real());
}

// Every feature of the kernel, with the host's room.
inline constexpr Features host_features =
    Features{.bodies = max_bodies, .planes = max_planes, .springs = max_springs, .near_pairs = 512}.with_everything();

// What a Simulation tells of its bodies, whatever the method.
template <class N, Spin spin_is>
class BodiesSimulation : public Simulation {
protected:
    using Bodies = tumble::Bodies<N, spin_is, max_bodies>;
    using State = typename Bodies::State;

    // Both must outlive this.
    BodiesSimulation(const SceneData& data, const Bodies& bodies)
        : Simulation(data.steps, wide(data.step.value)), data_(data), needs_(needs(data)), now_(bodies),
          drift_unit_(wide(bodies.scale.metres(Real{1}))), turn_unit_(wide(bodies.scale.angle(Real{1}))) {
        for (const BodySpec& spec : data_.bodies) {
            const PrincipalInertia inertia = principal_inertia(spec.inertia);
            bodies_.push_back({wide(spec.mass),
                               wide(inertia.moments),
                               {wide(inertia.principal.w), wide(inertia.principal.v.x), wide(inertia.principal.v.y),
                                wide(inertia.principal.v.z)}});
        }
        for (const PlaneSpec& plane : data_.planes)
            planes_.push_back({wide(normalized(plane.normal)), wide(plane.offset)});
        note(bodies.status);
    }

    // Keeps the first occurrence of every issue; the kernel's own sticky bits remember the first of all only.
    void note(Status status) {
        if (status.ok()) return;
        for (const Issue issue : all_issues) {
            if (status.has(issue) && !has_trouble(name_of(issue)))
                troubles_.push_back({name_of(issue), status.first_body, status.first_step});
        }
    }

public:
    [[nodiscard]] std::int64_t steps_taken() const override { return now_.steps_taken; }
    [[nodiscard]] std::uint64_t hash() const override { return now_.hash(); }
    [[nodiscard]] int body_count() const override { return now_.count; }
    [[nodiscard]] const std::vector<Trouble>& troubles() const override { return troubles_; }

    [[nodiscard]] BodySnapshot body(int index_of_body) const override {
        const State& state = now_.state[index_of_body];
        const Body& body = bodies_[static_cast<std::size_t>(index_of_body)];
        BodySnapshot snapshot;
        const LongQuat to_principal{body.principal[0], -body.principal[1], -body.principal[2], -body.principal[3]};
        for (int i = 0; i < 3; ++i) {
            const auto k = static_cast<std::size_t>(i);
            snapshot.position[k] = wide(state.x_w[i]);
            snapshot.velocity[k] = wide(state.d_w[i]) * drift_unit_ / step_length();
        }
        const LongQuat q{wide(state.q_wb.w), wide(state.q_wb.x), wide(state.q_wb.y), wide(state.q_wb.z)};
        snapshot.orientation = product(q, to_principal);
        snapshot.angular_velocity = rotate(body.principal, spin(index_of_body));
        snapshot.asleep = is_asleep(index_of_body);
        snapshot.contacts = contact_count(index_of_body);
        return snapshot;
    }

    [[nodiscard]] Energy energy() const override {
        Energy energy;
        std::vector<BodySnapshot> now;
        for (int b = 0; b < body_count(); ++b) {
            now.push_back(body(b));
            if (data_.bodies[static_cast<std::size_t>(b)].fixed) continue;
            const Body& body = bodies_[static_cast<std::size_t>(b)];
            const BodySnapshot& snapshot = now.back();
            const LongVec3 w = spin(b);
            energy.kinetic += body.mass * dot(snapshot.velocity, snapshot.velocity) / 2;
            for (std::size_t i = 0; i < 3; ++i) energy.kinetic += body.moments[i] * w[i] * w[i] / 2;
            energy.potential -= body.mass * dot(wide(data_.world.gravity), snapshot.position);
        }
        const auto point = [&](int b, const RealVec3& p) {
            const BodySnapshot& snapshot = now[static_cast<std::size_t>(b)];
            return snapshot.position + rotate(snapshot.orientation, wide(p));
        };
        for (const SpringSpec& spring : data_.springs) {
            const LongVec3 reach = (spring.to_body < 0 ? wide(spring.to) : point(spring.to_body, spring.to)) -
                                   point(spring.body, spring.point);
            const long double stretch = std::sqrt(dot(reach, reach)) - wide(spring.rest_length);
            energy.potential += wide(spring.stiffness) * stretch * stretch / 2;
        }
        if (needs_.gravitation) {
            for (std::size_t a = 0; a < now.size(); ++a) {
                for (std::size_t b = a + 1; b < now.size(); ++b) {
                    const LongVec3 r = now[b].position - now[a].position;
                    if (data_.bodies[a].fixed && data_.bodies[b].fixed) continue;
                    energy.potential -=
                        wide(data_.world.gravitation) * bodies_[a].mass * bodies_[b].mass / std::sqrt(dot(r, r));
                }
            }
        }
        if (needs_.contact_springs) energy.potential += contact_potential(now);
        return energy;
    }

    void append_words(std::vector<std::uint32_t>& words) const override {
        for (int b = 0; b < body_count(); ++b) {
            for_each_number(now_.state[b], [&](const char*, const auto& number) {
                for_each_word(number, [&](std::uint32_t word) { words.push_back(word); });
            });
        }
    }
    [[nodiscard]] Place place_of_word(std::size_t word) const override {
        Place place{};
        std::size_t first = 0;
        for (int b = 0; b < body_count(); ++b) {
            for_each_number(now_.state[b], [&](const char* name, const auto& number) {
                std::size_t count = 0;
                for_each_word(number, [&](std::uint32_t) { ++count; });
                if (first <= word && word < first + count) place = {b, name, first, count};
                first += count;
            });
        }
        return place;
    }

private:
    struct Body {
        long double mass;    // kg
        LongVec3 moments;    // kg m^2, principal
        LongQuat principal;  // principal axes to the user's
    };

    struct Plane {
        LongVec3 normal;     // unit
        long double offset;  // m
    };

    [[nodiscard]] virtual int contact_count(int b) const = 0;
    [[nodiscard]] virtual bool is_asleep(int b) const = 0;

    // Of contacts by springs: of spheres and boxes, by their vertices, with planes, and of spheres with each other.
    // Left out are pairs with a box, and cylinders, capsules and hoops.
    [[nodiscard]] long double contact_potential(const std::vector<BodySnapshot>& now) const {
        const long double stiffness = wide(data_.world.contact.stiffness), barrier = wide(data_.world.contact.barrier);
        long double sum = 0;
        const auto add_point = [&](long double gap) {
            if (gap < 0) sum += stiffness * gap * gap / 2;
            else if (gap > 0) sum += barrier / gap;
        };
        for (std::size_t b = 0; b < now.size(); ++b) {
            const BodySpec& spec = data_.bodies[b];
            const LongVec3 size = wide(spec.shape.size);
            for (const Plane& plane : planes_) {
                if (spec.fixed) continue;
                const long double height = dot(plane.normal, now[b].position) + plane.offset;
                if (spec.shape.kind == ShapeKind::sphere) add_point(height - size[0]);
                if (spec.shape.kind != ShapeKind::box) continue;
                for (unsigned corner = 0; corner < 8; ++corner) {
                    LongVec3 arm;
                    for (unsigned i = 0; i < 3; ++i) arm[i] = ((corner >> i) & 1) != 0 ? size[i] / 2 : -size[i] / 2;
                    add_point(height + dot(plane.normal, rotate(now[b].orientation, arm)));
                }
            }
            for (std::size_t a = 0; a < b; ++a) {
                const BodySpec& other = data_.bodies[a];
                if (spec.shape.kind != ShapeKind::sphere || other.shape.kind != ShapeKind::sphere ||
                    (spec.fixed && other.fixed))
                    continue;
                const LongVec3 r = now[b].position - now[a].position;
                add_point(std::sqrt(dot(r, r)) - size[0] - wide(other.shape.size.x));
            }
        }
        return sum;
    }

    // rad/s, principal axes.
    [[nodiscard]] LongVec3 spin(int b) const {
        const auto& turn = now_.state[b].t_b;
        const LongVec3& moments = bodies_[static_cast<std::size_t>(b)].moments;
        LongVec3 w;
        for (int i = 0; i < 3; ++i) {
            const auto k = static_cast<std::size_t>(i);
            w[k] = wide(turn[i]) * turn_unit_ * 2 / step_length();
            if constexpr (spin_is == Spin::angular_momentum) w[k] *= moments[1] / moments[k];
        }
        return w;
    }

    const SceneData& data_;
    Features needs_;
    const Bodies& now_;
    std::vector<Body> bodies_;
    std::vector<Plane> planes_;
    std::vector<Trouble> troubles_;
    long double drift_unit_, turn_unit_;  // m and rad that a state's units stand for
};

// What must be there before BodiesSimulation is.
template <class Config>
struct OwnedReplay {
    explicit OwnedReplay(SceneData scene) : data(std::move(scene)), replay(data) {}

    SceneData data;
    Replay<Config, SceneData> replay;
};

template <std::size_t index, class Method>
class WorldSimulation final
    : OwnedReplay<
          SceneOf<typename std::tuple_element_t<index, decltype(number_system_list)>::Numbers, Method, host_features>>,
      public BodiesSimulation<typename std::tuple_element_t<index, decltype(number_system_list)>::Numbers,
                              Method::spin> {
    static constexpr auto system = std::get<index>(number_system_list);
    using N = typename decltype(system)::Numbers;
    using Owned = OwnedReplay<SceneOf<N, Method, host_features>>;
    using Told = BodiesSimulation<N, Method::spin>;

public:
    explicit WorldSimulation(SceneData data) : Owned(std::move(data)), Told(Owned::data, world().bodies()) {
        world().clear_status();
    }

    void step() override {
        const Status status = world().step();
        if (status.ok()) return;
        Told::note(status);
        world().clear_status();
    }

    [[nodiscard]] long double largest_safe_step() const override {
        return wide(Owned::replay.world().largest_safe_step());
    }

    [[nodiscard]] std::string_view integrator() const override { return Method::name; }
    [[nodiscard]] std::string_view numbers() const override { return N::name; }
    [[nodiscard]] std::string_view range() const override { return system.range; }
    [[nodiscard]] bool carry() const override { return N::carry; }

private:
    [[nodiscard]] auto& world() { return Owned::replay.world(); }
    [[nodiscard]] int contact_count(int b) const override { return Owned::replay.world().contact_count(BodyId{b}); }
    [[nodiscard]] bool is_asleep(int b) const override { return Owned::replay.world().asleep(BodyId{b}); }
};

template <std::size_t index>
std::unique_ptr<Simulation> make_in(SceneData data, std::string_view integrator) {
    std::unique_ptr<Simulation> made;
    Integrators::for_each_in<typename std::tuple_element_t<index, decltype(number_system_list)>::Numbers>(
        [&]<class Method>() {
            if (integrator == Method::name) made = std::make_unique<WorldSimulation<index, Method>>(std::move(data));
        });
    return made;
}

}  // namespace tumble::host

// A Simulation of one integrator and number system, with every feature of the kernel compiled in. Included only by the
// translation units that the build makes from number_system.cpp.in.
#pragma once

#include <tumble/replay.hpp>
#include <tumble/tumble.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "simulation/held_numbers.hpp"
#include "simulation/host_features.hpp"
#include "simulation/motion_of.hpp"
#include "simulation/number_systems.hpp"

namespace tumble::host {

using reference::Vector;

// The part of a Simulation that reports its bodies, for any method.
template <class N, Spin spin_is>
class BodiesSimulation : public Simulation {
protected:
    using Bodies = tumble::Bodies<N, spin_is, max_bodies, host_features.mixed()>;

    // Both must outlive this.
    BodiesSimulation(const SceneData& data, const Bodies& bodies)
        : Simulation(data.steps, number(data.step.value)), data_(data), needs_(needs(data)), now_(bodies) {
        for (const BodySpec& spec : data_.bodies)
            bodies_.push_back({number(spec.mass), PrincipalAxes(principal_inertia(spec.inertia))});
        for (const PlaneSpec& plane : data_.planes)
            planes_.push_back({vector(normalized(plane.normal)), number(plane.offset)});
        note(bodies.status);
    }

    // Keeps the first occurrence of every issue; the kernel's own sticky bits remember the first of all only.
    void note(Status status) {
        if (status.ok()) return;
        for (const Issue issue : all_issues) {
            if (status.has(issue) && !has_trouble(name_of(issue)))
                troubles_.push_back({name_of(issue), status.first_body, status.first_step, left_by(issue, status)});
        }
    }

public:
    [[nodiscard]] std::int64_t steps_taken() const override { return now_.steps_taken; }
    [[nodiscard]] std::uint64_t hash() const override { return now_.hash(); }
    [[nodiscard]] int body_count() const override { return now_.count; }
    [[nodiscard]] const std::vector<Trouble>& troubles() const override { return troubles_; }

    [[nodiscard]] BodySnapshot body(int index_of_body) const override {
        const reference::Motion motion = motion_of(index_of_body);
        const auto array_of = [](const Vector& v) { return std::array{v.x, v.y, v.z}; };
        BodySnapshot snapshot;
        snapshot.position = array_of(motion.x);
        snapshot.velocity = array_of(motion.v);
        snapshot.orientation = {motion.q.w, motion.q.v.x, motion.q.v.y, motion.q.v.z};
        snapshot.angular_velocity = array_of(motion.w);
        snapshot.asleep = is_asleep(index_of_body);
        snapshot.contacts = contact_count(index_of_body);
        return snapshot;
    }

    [[nodiscard]] Energy energy() const override {
        Energy energy;
        std::vector<reference::Motion> now;
        for (int b = 0; b < body_count(); ++b) {
            now.push_back(motion_of(b));
            if (data_.bodies[static_cast<std::size_t>(b)].fixed) continue;
            const Body& body = bodies_[static_cast<std::size_t>(b)];
            const reference::Motion& motion = now.back();
            const Vector w = spin_of(now_, body.axes, b);
            energy.kinetic += body.mass * dot(motion.v, motion.v) / 2;
            energy.kinetic += dot(times(body.axes.moments, w), w) / 2;
            energy.potential -= body.mass * dot(vector(data_.world.gravity), motion.x);
        }
        const auto point = [&](int b, const RealVec3& p) {
            const reference::Motion& motion = now[static_cast<std::size_t>(b)];
            return motion.x + motion.q.normalized().rotate(vector(p));
        };
        for (const SpringSpec& spring : data_.springs) {
            const Vector reach = (spring.to_body < 0 ? vector(spring.to) : point(spring.to_body, spring.to)) -
                                 point(spring.body, spring.point);
            const long double stretch = norm(reach) - number(spring.rest_length);
            energy.potential += number(spring.stiffness) * stretch * stretch / 2;
        }
        if (needs_.gravitation) {
            for (std::size_t a = 0; a < now.size(); ++a) {
                for (std::size_t b = a + 1; b < now.size(); ++b) {
                    if (data_.bodies[a].fixed && data_.bodies[b].fixed) continue;
                    energy.potential -=
                        number(data_.world.gravitation) * bodies_[a].mass * bodies_[b].mass / norm(now[b].x - now[a].x);
                }
            }
        }
        if (needs_.contact_springs) energy.potential += contact_potential(now);
        return energy;
    }

    [[nodiscard]] double held_spin(int b) const override {
        const PrincipalAxes& axes = bodies_[static_cast<std::size_t>(b)].axes;
        double least = std::numeric_limits<double>::infinity();
        for (int i = 0; i < 3; ++i) least = std::min(least, host::held_spin(now_, axes, b, i));
        return least;
    }

    void append_words(std::vector<std::uint32_t>& words) const override {
        for (int b = 0; b < body_count(); ++b)
            for_each_word(
                now_.state[b], [&](std::uint32_t word) { words.push_back(word); }, now_.rotates(b));
    }
    [[nodiscard]] Place place_of_word(std::size_t word) const override {
        Place place{};
        std::size_t first = 0;
        for (int b = 0; b < body_count(); ++b) {
            for_each_number(
                now_.state[b],
                [&](const char* name, const auto& number) {
                    std::size_t count = 0;
                    for_each_word(number, [&](std::uint32_t) { ++count; });
                    if (first <= word && word < first + count) place = {b, name, first, count};
                    first += count;
                },
                now_.rotates(b));
        }
        return place;
    }

private:
    struct Body {
        long double mass;  // kg
        PrincipalAxes axes;
    };

    struct Plane {
        Vector normal;       // unit
        long double offset;  // m
    };

    [[nodiscard]] std::optional<HeldNumber> left_by(Issue issue, Status status) const {
        if (issue != Issue::range_left || status.first_body >= now_.count) return {};
        return number_at_limit(now_, bodies_[status.first_body].axes, status.first_body);
    }
    [[nodiscard]] virtual int contact_count(int b) const = 0;
    [[nodiscard]] virtual bool is_asleep(int b) const = 0;

    // Of contacts by springs: of spheres and boxes, by their lowest vertices, with planes, and of spheres with each
    // other. Left out are pairs with a box, and cylinders, capsules and hoops.
    [[nodiscard]] long double contact_potential(const std::vector<reference::Motion>& now) const {
        const long double stiffness = number(data_.world.contact.stiffness),
                          barrier = number(data_.world.contact.barrier);
        long double sum = 0;
        const auto add_point = [&](long double gap) {
            if (gap < 0) sum += stiffness * gap * gap / 2;
            else if (gap > 0) sum += barrier / gap;
        };
        for (std::size_t b = 0; b < now.size(); ++b) {
            const BodySpec& spec = data_.bodies[b];
            const Vector size = vector(spec.shape.size);
            for (const Plane& plane : planes_) {
                if (spec.fixed) continue;
                const long double height = dot(plane.normal, now[b].x) + plane.offset;
                if (spec.shape.kind == ShapeKind::sphere) add_point(height - size.x);
                if (spec.shape.kind != ShapeKind::box) continue;
                std::array<long double, 8> gaps;
                for (unsigned corner = 0; corner < gaps.size(); ++corner) {
                    Vector arm;
                    for (int i = 0; i < 3; ++i) arm[i] = ((corner >> i) & 1) != 0 ? size[i] / 2 : -size[i] / 2;
                    gaps[corner] = height + dot(plane.normal, now[b].q.normalized().rotate(arm));
                }
                // As many of the lowest as the kernel keeps.
                std::sort(gaps.begin(), gaps.end());
                std::for_each(gaps.begin(), gaps.begin() + contact::max_points, add_point);
            }
            for (std::size_t a = 0; a < b; ++a) {
                const BodySpec& other = data_.bodies[a];
                if (spec.shape.kind != ShapeKind::sphere || other.shape.kind != ShapeKind::sphere ||
                    (spec.fixed && other.fixed))
                    continue;
                add_point(norm(now[b].x - now[a].x) - size.x - number(other.shape.size.x));
            }
        }
        return sum;
    }

    [[nodiscard]] reference::Motion motion_of(int b) const {
        return host::motion_of(now_, bodies_[static_cast<std::size_t>(b)].axes, b);
    }

    const SceneData& data_;
    Features needs_;
    const Bodies& now_;
    std::vector<Body> bodies_;
    std::vector<Plane> planes_;
    std::vector<Trouble> troubles_;
};

// Base class that is constructed before BodiesSimulation.
template <class Config>
struct OwnedReplay {
    explicit OwnedReplay(SceneData scene) : data(with_events_in_order(std::move(scene))), replay(data) {}

    SceneData data;
    Replay<Config, SceneData> replay;
};

template <std::size_t index, class Method>
class WorldSimulation final : OwnedReplay<SceneOf<NumbersAt<index>, Method, host_features>>,
                              public BodiesSimulation<NumbersAt<index>, Method::spin> {
    static constexpr auto system = std::get<index>(number_system_list);
    using N = NumbersAt<index>;
    using Owned = OwnedReplay<SceneOf<N, Method, host_features>>;
    using Told = BodiesSimulation<N, Method::spin>;

public:
    explicit WorldSimulation(SceneData data)
        : Owned(std::move(data)), Told(Owned::data, Owned::replay.world().bodies()) {
        world().clear_status();
    }

    void step() override {
        const Status status = world().step();
        if (status.ok()) return;
        Told::note(status);
        world().clear_status();
    }

    [[nodiscard]] long double largest_safe_step() const override {
        return number(Owned::replay.world().largest_safe_step());
    }
    [[nodiscard]] long double contact_tolerance() const override {
        return static_cast<double>(Owned::replay.world().contact_tolerance());
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

template <std::size_t index, Part part>
std::unique_ptr<Simulation> make_in(SceneData data, std::string_view integrator) {
    std::unique_ptr<Simulation> made;
    Integrators::for_each_in<NumbersAt<index>>([&]<class Method>() {
        if constexpr (part_of<NumbersAt<index>, Method>() == part)
            if (integrator == Method::name) made = std::make_unique<WorldSimulation<index, Method>>(std::move(data));
    });
    return made;
}

}  // namespace tumble::host

// A Simulation of one integrator and number system, with every feature of the kernel compiled in. Included only by the
// translation units that the build makes from number_system.cpp.in.
#pragma once

#include <tumble/replay.hpp>
#include <tumble/tumble.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "simulation/energy.hpp"
#include "simulation/held_numbers.hpp"
#include "simulation/host_features.hpp"
#include "simulation/joint_gaps.hpp"
#include "simulation/motion_of.hpp"
#include "simulation/number_systems.hpp"

namespace tumble::host {

using reference::Vector;

// The part of a Simulation that reports its bodies, for any method.
template <class N, Spin spin_is>
class BodiesSimulation : public Simulation {
protected:
    using Bodies = tumble::Bodies<N, spin_is, max_bodies, host_features.mixed()>;

    std::vector<Trouble> troubles_;
    long double given_ = 0;  // Energy::given

    // Both must outlive this. z_rooms: of HeldBody, of each body.
    BodiesSimulation(const SceneData& data, const Bodies& bodies, std::vector<int> z_rooms)
        : Simulation(data.steps, number(data.step.value)), data_(data), now_(bodies), energy_(data),
          z_rooms_(std::move(z_rooms)) {
        for (const BodySpec& spec : data_.bodies) axes_.emplace_back(principal_inertia(spec.inertia));
        if (!data_.joints.empty()) gaps_.emplace(data_.joints, [&](int b) { return motion_of(b); });
        note(bodies.status);
    }

    // Keeps the first occurrence of every issue; the kernel's own sticky bits remember the first of all only.
    void note(Status status) {
        if (status.ok()) return;
        for (const Issue issue : all_issues) {
            if (status.has(issue) && !has_trouble(name_of(issue)))
                troubles_.push_back({name_of(issue), status.first_body < now_.count ? status.first_body : -1,
                                     status.first_step, left_by(issue, status)});
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
        snapshot.parts = 1 << now_.halvings_of(index_of_body);
        return snapshot;
    }

    [[nodiscard]] Energy energy() const override {
        std::vector<reference::Motion> motions;
        std::vector<Vector> spins;
        for (int b = 0; b < body_count(); ++b) {
            motions.push_back(motion_of(b));
            spins.push_back(spin_of(now_, axes_of(b), b));
        }
        Energy now = energy_.of(motions, spins, gravity());
        for (int j = 0; gaps_ && j < static_cast<int>(data_.joints.size()); ++j)
            if (gaps_->has_spring(j) && holds(j))
                now.potential += gaps_->stored_in(j, [&](int b) { return motions[static_cast<std::size_t>(b)]; });
        now.given = given_;
        return now;
    }

    [[nodiscard]] double held_spin(int b) const override {
        double least = std::numeric_limits<double>::infinity();
        for (int i = 0; i < 3; ++i) least = std::min(least, host::held_spin(now_, held_body(b), i));
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

protected:
    // m and rad, of joint j.
    [[nodiscard]] JointGaps::Gap gap_of(int j) const {
        return gaps_->of(j, [&](int b) { return motion_of(b); });
    }

    // kg m, of the bodies on which gravity acts.
    [[nodiscard]] Vector mass_moment() const {
        Vector moment;
        for (int b = 0; b < body_count(); ++b) {
            const BodySpec& spec = data_.bodies[static_cast<std::size_t>(b)];
            if (!spec.is_fixed()) moment = moment + number(spec.mass) * motion_of(b).x;
        }
        return moment;
    }

private:
    [[nodiscard]] std::optional<HeldNumber> left_by(Issue issue, Status status) const {
        if (issue != Issue::range_left || status.first_body >= now_.count) return {};
        return number_at_limit(now_, held_body(status.first_body));
    }
    [[nodiscard]] HeldBody held_body(int b) const { return {b, axes_of(b), z_rooms_[static_cast<std::size_t>(b)]}; }
    [[nodiscard]] const PrincipalAxes& axes_of(int b) const { return axes_[static_cast<std::size_t>(b)]; }
    [[nodiscard]] virtual int contact_count(int b) const = 0;
    [[nodiscard]] virtual Vector gravity() const = 0;  // m/s^2, of the next step
    [[nodiscard]] virtual bool is_asleep(int b) const = 0;
    [[nodiscard]] virtual bool holds(int j) const = 0;  // false of a joint that broke or was removed

    [[nodiscard]] reference::Motion motion_of(int b) const { return host::motion_of(now_, axes_of(b), b); }

    const SceneData& data_;
    const Bodies& now_;
    SceneEnergy energy_;
    std::vector<int> z_rooms_;
    std::vector<PrincipalAxes> axes_;
    std::optional<JointGaps> gaps_;
};

constexpr bool has_joints(Part part) { return part == Part::joints || part == Part::joints_contacts; }
constexpr Features features_of(Part part) {
    return part == Part::joints            ? joint_features_without_contacts
           : part == Part::joints_contacts ? joint_features
                                           : host_features;
}

// Base class that is constructed before BodiesSimulation.
template <class Config>
struct OwnedReplay {
    explicit OwnedReplay(SceneData scene) : data(with_events_in_order(std::move(scene))), replay(data) {}

    SceneData data;
    Replay<Config, SceneData> replay;
};

template <std::size_t index, class Method, Part part>
class WorldSimulation final : OwnedReplay<SceneOf<NumbersAt<index>, Method, features_of(part)>>,
                              public BodiesSimulation<NumbersAt<index>, Method::spin> {
    static constexpr auto system = std::get<index>(number_system_list);
    using N = NumbersAt<index>;
    using Owned = OwnedReplay<SceneOf<N, Method, features_of(part)>>;
    using Told = BodiesSimulation<N, Method::spin>;

public:
    explicit WorldSimulation(SceneData data)
        : Owned(std::move(data)),
          Told(Owned::data, Owned::replay.world().bodies(), z_rooms_of(Owned::data, Owned::replay.world().bodies())),
          at_start_(world().gravity()), changes_gravity_{std::any_of(
                                            Owned::data.events.begin(), Owned::data.events.end(),
                                            [](const EventSpec& event) { return event.kind == EventKind::gravity; })} {
        world().clear_status();
    }

    void step() override {
        const Vector before = gravity(), moment = changes_gravity_ ? Told::mass_moment() : Vector{};
        const Status status = world().step();
        if (changes_gravity_) Told::given_ += dot(before - gravity(), moment);
        if (status.ok()) return;
        Told::note(status);
        world().clear_status();
    }

    void apply(const EventDescription& event) override {
        // As in a script: an event of a joint that is gone has no effect.
        if constexpr (has_joints(part))
            if (has_joint(event.kind) && !world().contains(JointId{event.joint})) return;
        const Vector before = gravity();
        world().apply(world().prepare(event_of(event)));
        if (event.kind == EventKind::gravity) Told::given_ += dot(before - gravity(), Told::mass_moment());
    }

    [[nodiscard]] std::unique_ptr<Snapshot> snapshot() const override {
        return std::make_unique<Kept>(Owned::replay.world(), Told::troubles_, Told::given_);
    }
    void restore(const Snapshot& snapshot) override {
        const Kept& kept = static_cast<const Kept&>(snapshot);
        world() = kept.world;
        Told::troubles_ = kept.troubles;
        Told::given_ = kept.given;
    }

    [[nodiscard]] ImuSnapshot imu(int b) const override {
        const Imu<double> imu = Owned::replay.world().template imu<double>(BodyId{b});
        return {array_of(imu.specific_force), array_of(imu.angular_velocity)};
    }
    [[nodiscard]] std::vector<ContactSnapshot> contacts() const override {
        std::vector<ContactSnapshot> all;
        if constexpr (features_of(part).contacts()) {
            const auto plain = [](auto number) { return static_cast<double>(number); };
            const auto& bodies = Owned::replay.world().bodies();
            for (int b = 0; b < bodies.count; ++b) {
                if (bodies.constants[b].fixed()) continue;
                for (const auto& c : Owned::replay.world().contacts(BodyId{b})) {
                    const int other = c.body.index();
                    if (other >= 0 && other < b && !bodies.constants[other].fixed()) continue;  // it is there
                    all.push_back({b, other, c.plane.index(), c.touches, c.began, c.ended, plain(c.hit_speed),
                                   array_of(c.normal), plain(c.depth), array_of(c.point), plain(c.normal_impulse),
                                   array_of(c.friction_impulse)});
                }
            }
        }
        return all;
    }
    [[nodiscard]] JointSnapshot joint([[maybe_unused]] int j) const override {
        JointSnapshot snapshot;
        if constexpr (has_joints(part)) {
            snapshot.broken = !holds(j);
            if (snapshot.broken) return snapshot;
            const auto now = Owned::replay.world().template joint<double>(JointId{j});
            Owned::data.joints[static_cast<std::size_t>(j)].visit([&]<class Spec>(const Spec& spec) {
                using Kind = JointKinds::Of<Spec>;
                if constexpr (Kind::turns == 1 || Kind::turns == 2) {
                    snapshot.angle = now.angle;
                    snapshot.speed = now.speed;
                }
                if constexpr (Kind::turns == 2) {
                    snapshot.to_angle = now.to_angle;
                    snapshot.to_speed = now.to_speed;
                }
                if constexpr (Kind::slides > 0) {
                    snapshot.travel = now.travel;
                    snapshot.travel_speed = now.speed;
                }
                if (JointGaps::range_of(spec).has_ends()) snapshot.at_limit = now.at_limit;
            });
            snapshot.force = array_of(now.force);
            snapshot.torque = array_of(now.torque);
            snapshot.corrections = now.corrections;
            std::tie(snapshot.gap, snapshot.lean) = Told::gap_of(j);
        }
        return snapshot;
    }
    [[nodiscard]] long double largest_safe_step() const override {
        return number(Owned::replay.world().largest_safe_step());
    }
    [[nodiscard]] long double contact_tolerance() const override {
        return static_cast<double>(Owned::replay.world().contact_tolerance());
    }
    [[nodiscard]] bool stepped_bounded(int body) const override {
        return Owned::replay.world().stepped_bounded(BodyId{body});
    }
    [[nodiscard]] double deepest_overlap() const override {
        return static_cast<double>(Owned::replay.world().deepest_overlap());
    }
    [[nodiscard]] int most_near_pairs() const override { return Owned::replay.world().most_near_pairs(); }

    [[nodiscard]] std::string_view integrator() const override { return Method::name; }
    [[nodiscard]] std::string_view numbers() const override { return N::name; }
    [[nodiscard]] std::string_view range() const override { return system.range; }
    [[nodiscard]] bool carry() const override { return N::carry; }

private:
    using World = tumble::World<SceneOf<N, Method, features_of(part)>>;
    struct Kept : Snapshot {
        Kept(const World& now, const std::vector<Trouble>& until_now, long double given_until_now)
            : world(now), troubles(until_now), given(given_until_now) {}
        World world;
        std::vector<Trouble> troubles;
        long double given;
    };

    template <class T>
    [[nodiscard]] static std::array<double, 3> array_of(const Vector3<T>& v) {
        return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
    }
    [[nodiscard]] static std::vector<int> z_rooms_of(const SceneData& data, const typename World::Bodies& bodies) {
        using Inertia = typename Method::template Inertia<N>;
        std::vector<int> rooms(data.bodies.size(), 0);
        if constexpr (N::fixed_point && requires(const Inertia& inertia) { inertia.z_room(); })
            for (std::size_t b = 0; b < rooms.size(); ++b)
                if (bodies.rotates(static_cast<int>(b)))
                    rooms[b] = Inertia::of(principal_inertia(data.bodies[b].inertia).moments, bodies.scale).z_room();
        return rooms;
    }
    [[nodiscard]] auto& world() { return Owned::replay.world(); }
    [[nodiscard]] bool holds([[maybe_unused]] int j) const override {
        const auto& now = Owned::replay.world();
        if constexpr (has_joints(part))
            return now.contains(JointId{j}) && !now.template joint<double>(JointId{j}).broken;
        else return false;
    }
    [[nodiscard]] int contact_count(int b) const override { return Owned::replay.world().contact_count(BodyId{b}); }
    [[nodiscard]] bool is_asleep(int b) const override { return Owned::replay.world().asleep(BodyId{b}); }
    // The world rounds it. Until an event changes it, it is that of the scene.
    [[nodiscard]] Vector gravity() const override {
        const auto now = Owned::replay.world().gravity();
        if (now == at_start_) return vector(Owned::data.world.gravity);
        const auto [x, y, z] = array_of(now);
        return {x, y, z};
    }

    Vector3<typename N::Work> at_start_;  // gravity, as the world keeps it
    bool changes_gravity_;                // by events of the scene
};

template <std::size_t index, Part part>
std::unique_ptr<Simulation> make_in(SceneData data, std::string_view integrator) {
    std::unique_ptr<Simulation> made;
    Integrators::for_each_in<NumbersAt<index>>([&]<class Method>() {
        if constexpr (has_joints(part) || part_of<NumbersAt<index>, Method>() == part)
            if (integrator == Method::name)
                made = std::make_unique<WorldSimulation<index, Method, part>>(std::move(data));
    });
    return made;
}

}  // namespace tumble::host

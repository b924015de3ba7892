// WorldSnapshots<Scene>: a world as bytes.
#pragma once

#include <tumble/world/world_events.hpp>

namespace tumble {

template <class S>
class WorldSnapshots : protected WorldEvents<S> {
    using Base = WorldEvents<S>;

protected:
    using Base::begin_forces_again, Base::remember, Base::now, Base::replaced, Base::disturb;
    using Base::features, Base::has_contacts, Base::has_events, Base::has_imu, Base::advance_, Base::contacts_,
        Base::script_, Base::digest_;
    using typename Base::N, typename Base::Integrator, typename Base::Work, typename Base::Advance,
        typename Base::Bodies, typename Base::Contacts;
    constexpr WorldSnapshots(const WorldSpec& spec, Seconds step) : Base{spec, step} {}

    [[nodiscard]] int snapshot_size(SnapshotPart part) const {
        detail::SnapshotWriter count;
        write(count, part, 0);
        return count.size() + 4;
    }
    [[nodiscard]] int save(std::uint8_t* to, int room, SnapshotPart part) const {
        const int size = snapshot_size(part);
        if (size > room) return 0;
        detail::SnapshotWriter bytes{to};
        write(bytes, part, static_cast<std::uint32_t>(size));
        const std::uint32_t check = bytes.check();
        bytes.word(check);
        return size;
    }
    [[nodiscard]] SnapshotFault restore(const std::uint8_t* from, int count) {
        const SnapshotFault fault = detail::SnapshotHeader::fault_of(from, count, detail::digest_of_numbers<N>());
        if (fault != SnapshotFault::none) return fault;
        const auto header = detail::SnapshotHeader::read(from);
        if (header.scene != scene_digest(header.part) ||
            (header.part == SnapshotPart::world && header.spin != Advance::spin))
            return SnapshotFault::other_scene;
        const std::uint8_t* const state = from + detail::SnapshotHeader::bytes;
        const int size = static_cast<int>(header.size) - detail::SnapshotHeader::bytes - 4;
        detail::SnapshotWriter held{state, size};
        archive(std::as_const(*this), held, header.part, header.spin);
        if (held.fault() != SnapshotFault::none) return held.fault();
        detail::SnapshotReader reader{state, size};
        archive(*this, reader, header.part, header.spin);
        if constexpr (has_events) select();
        if (header.part == SnapshotPart::world) return SnapshotFault::none;
        begin_forces_again();
        for (int b = 0; b < advance_.bodies.count; ++b) {
            if (header.spin != Advance::spin) advance_.check_range(b);
            advance_.spin_changed(b);
            if constexpr (has_imu) remember(b);
            replaced(b);
            disturb(b);
        }
        if constexpr (has_contacts) contacts_.forget_last_step(advance_.bodies);
        return SnapshotFault::none;
    }

private:
    [[nodiscard]] std::uint64_t scene_digest(SnapshotPart part) const requires(features.snapshots) {
        detail::Digest digest = digest_;
        if constexpr (features.gravitation && features.softening)
            if (const Work e = advance_.loads.gravitation().softening(); e > Work(0)) digest.add_number(e);
        if (part == SnapshotPart::bodies) return digest.value();
        digest.add(Integrator::name);
        Features::for_each([&](const char*, auto member) { digest.add(static_cast<int>(features.*member)); });
        if constexpr (Advance::has_own_loads) {
            digest.add(tumble::detail::OwnLoads<S>::List::count);
            advance_.loads.add_own_to(digest);
        }
        advance_.add_to(digest);
        return digest.value();
    }
    void write(detail::SnapshotWriter& to, SnapshotPart part, std::uint32_t size) const requires(features.snapshots) {
        detail::SnapshotHeader{part, Advance::spin, detail::digest_of_numbers<N>(), scene_digest(part), size}.write(to);
        archive(*this, to, part, Advance::spin);
    }
    template <class Self, class Archive>
    static void archive(Self& self, Archive& to, SnapshotPart part, Spin spin) requires(features.snapshots) {
        auto& bodies = self.advance_.bodies;
        to(bodies.steps_taken);
        for (int b = 0; b < bodies.count; ++b) {
            if constexpr (features.removal)
                if (!self.places_.is_taken(b)) continue;
            Bodies::archive(bodies, b, to, spin);
        }
        if (part == SnapshotPart::bodies) return;
        Advance::archive(self.advance_, to);
        if constexpr (Archive::reads && has_contacts && Advance::has_wrenches) self.tell_gravity();
        auto& status = bodies.status;
        to(status.first_step, status.count, status.first_body, status.bits);
        if constexpr (has_contacts) { Contacts::archive(self.contacts_, bodies, to); }
        if constexpr (has_imu)
            for (int b = 0; b < bodies.count; ++b) {
                to(self.before_[b]);
                int most_halvings = 0;
                if constexpr (Bodies::has_parts) most_halvings = bodies.scale.most_halvings;
                if constexpr (features.rotation) (void)to.within(self.before_[b].halvings, 0, most_halvings);
            }
        if constexpr (has_events) to(self.wraps_);
    }
    // Call when the world has gone to another step.
    void select() requires has_events {
        if constexpr (features.has_script()) script_.seek(now());
    }
};

}  // namespace tumble

// What contacts have done in the last step, for World::contacts(). It stands beside the list of pairs, because a pair
// that has bounced may be far apart by the end of the step, and out of the list.
#pragma once

#include <tumble/contact/contact.hpp>
#include <tumble/contact/narrow_phase.hpp>
#include <tumble/contact/pair_list.hpp>

namespace tumble {

// Two bodies, or a body and a plane, that touch, or did in the last step. Impulses act on body a.
template <class N, Features features>
struct LoggedContact {
    using Work = typename N::Work;

    std::int16_t a, b;                       // as of Pair
    bool touched = false, touches = false;   // at the end of the step before, and of the last
    Work hit_speed{};                        // m a step, of the fastest approach that an impact has ended
    Work gap{};                              // m
    Work normal_impulse{};                   // kg m a step
    WorkVec3<N> impulse = zero_vector<N>();  // with friction; kg m a step, world. The normal may turn within a step
    WorkVec3<N> moment = zero_vector<N>();   // of it about the origin: the sum of its parts times their places
    Vec3<typename N::Unit> normal = Vec3<typename N::Unit>::Constant(typename N::Unit{});
    [[no_unique_address]] If<features.friction, WorkVec3<N>, 0> friction_impulse{};  // kg m a step, world

    [[nodiscard]] std::uint32_t key() const { return Pair<N, features>::key_of(a, b); }
    [[nodiscard]] bool has(int body) const { return a == body || b == body; }
    // Calls visit with the members that a snapshot holds.
    template <class Self, class Visit>
    static void each(Self& self, Visit& visit) {
        visit(self.touched, self.touches, self.hit_speed, self.gap, self.normal_impulse, self.impulse, self.moment,
              self.normal);
        if constexpr (features.friction) visit(self.friction_impulse);
    }
    void clear_impulses() {
        normal_impulse = Work(0);
        impulse = moment = zero_vector<N>();
        if constexpr (features.friction) friction_impulse = zero_vector<N>();
    }
};

template <class N, Spin spin, Features features>
class ContactLog {
public:
    using Work = typename N::Work;
    using Entry = LoggedContact<N, features>;
    using NarrowPhase = tumble::NarrowPhase<N, spin, features>;
    using Bodies = typename NarrowPhase::Bodies;
    using Pair = typename NarrowPhase::Pair;
    using PairList = tumble::PairList<N, features>;
    using Island = tumble::Island<features>;

    [[nodiscard]] int count() const { return count_; }
    [[nodiscard]] const Entry& operator[](int i) const { return entry_[i]; }

    // Keeps what touches. Impulses of pairs that stand or sleep stay as they are.
    void start_step() {
        keep([](Entry& entry) {
            entry.touched = true;
            entry.hit_speed = Work(0);
            return entry.touches;
        });
    }
    // Forgets the impulses of pairs that are no longer in the list. Call when pairs have left it, before the islands.
    void start_islands(PairList& pairs) {
        int k = 0;
        for (int i = 0; i < count_; ++i) {
            while (k < pairs.count() && pairs[k].key() < entry_[i].key()) ++k;
            if (k == pairs.count() || pairs[k].key() != entry_[i].key()) entry_[i].clear_impulses();
        }
    }
    // The pairs of the island are solved anew.
    void start_island(const PairList& pairs, const Island& island) {
        pairs.for_each(island, [&](const Pair& pair) {
            if (Entry* entry = find(pair.key())) entry->clear_impulses();
        });
    }
    // The step of the island is taken anew: what it has logged so far is no part of it.
    void restart_island(const PairList& pairs, const Island& island) {
        pairs.for_each(island, [&](const Pair& pair) {
            Entry* const entry = find(pair.key());
            if (entry == nullptr) return;
            if (entry->touched) {
                entry->clear_impulses();
                entry->hit_speed = Work(0);
            } else {
                --count_;
                for (int i = static_cast<int>(entry - entry_.begin()); i < count_; ++i) entry_[i] = entry_[i + 1];
            }
        });
    }
    // Adds `share` of the impulses of the points that take part in the present solution. The bodies must be where it
    // was found. Returns the entry; null where there is no impulse.
    Entry* add(const Pair& pair, const NarrowPhase& shapes, Bodies& bodies, Work share) {
        // A unit of impulse along a row changes sqrt(m) v of body a by the row.
        const Work root_mass = shapes.weights()[pair.a].root_mass;
        Work normal_impulse(0);
        WorkVec3<N> moment = zero_vector<N>(), sum[2] = {moment, moment};  // along normals, and across
        bool any = false;
        for (int i = 0; i < pair.count; ++i) {
            const auto& point = pair.point[i];
            for (int k = 0; point.active && k < pair.rows(); ++k) {
                const auto& row = point.row[k];
                const Work impulse = pair.scale.work(row.impulse) * share;
                if (impulse == Work(0)) continue;
                any = true;
                sum[k > 0] += scaled_by(work_unit<N>(row.linear), impulse * root_mass);
                if (k > 0) continue;
                const Work along = impulse * N::work(row.inverse) * pair.weight;
                normal_impulse += along;
                moment += scaled_by(shapes.place_of(bodies, pair, point), along);
            }
        }
        if (!any) return nullptr;
        Entry* const entry = entry_of(pair, bodies);
        if (entry == nullptr) return nullptr;
        entry->normal_impulse += normal_impulse;
        entry->moment += moment;
        entry->impulse += sum[0] + sum[1];
        if constexpr (features.friction) entry->friction_impulse += sum[1];
        entry->normal = pair.normal;
        return entry;
    }
    // Adds `share` of the forces of an island.
    void add_forces(const PairList& pairs, const Island& island, const NarrowPhase& shapes, Bodies& bodies,
                    Work share) {
        pairs.for_each(island, [&](const Pair& pair) { (void)add(pair, shapes, bodies, share); });
    }
    // Notes which pairs touch now.
    void end_step(PairList& pairs, const NarrowPhase& shapes, Bodies& bodies) {
        int i = 0;
        for (int k = 0; k < pairs.count(); ++k) {
            const Pair& pair = pairs[k];
            for (; i < count_ && entry_[i].key() < pair.key(); ++i) entry_[i].touches = false;
            const bool is_there = i < count_ && entry_[i].key() == pair.key(), touches = pair.count > 0;
            if (!is_there && (!touches || entry_of(pair, bodies) == nullptr)) continue;
            Entry& entry = entry_[i++];
            entry.touches = touches;
            entry.gap = shapes.scale().metres(pair.gap);
            entry.normal = pair.normal;
        }
        for (; i < count_; ++i) entry_[i].touches = false;
    }
    // Call where body b is elsewhere now.
    void clear_impulses_of(int b) {
        for (int i = 0; i < count_; ++i)
            if (entry_[i].has(b)) entry_[i].clear_impulses();
    }
    void clear() { count_ = 0; }
    // Removes what body b has touched.
    void remove(int b) {
        keep([&](const Entry& entry) { return !entry.has(b); });
    }

    // Entry i as body b has it. `rate`: steps per second. id_of(place of a body): its id.
    template <class IdOf>
    [[nodiscard]] Contact<Work> contact(int i, int b, const PairList& pairs, const NarrowPhase& shapes,
                                        const Bodies& bodies, Work rate, IdOf&& id_of) const {
        const Entry& entry = entry_[i];
        const bool is_a = b == entry.a;
        const auto plain = [](const WorkVec3<N>& v) { return Vector3<Work>{v[0], v[1], v[2]}; };
        Contact<Work> contact;
        if (entry.b < 0) contact.plane = PlaneId{-1 - entry.b};
        else contact.body = id_of(is_a ? entry.b : entry.a);
        contact.touches = entry.touches;
        contact.began = entry.touches && !entry.touched;
        contact.ended = !entry.touches && entry.touched;
        contact.hit = entry.hit_speed > Work(0);
        contact.hit_speed = entry.hit_speed * rate;
        contact.normal = plain(work_unit<N>(is_a ? entry.normal : Vec3<typename N::Unit>(-entry.normal)));
        contact.depth = -entry.gap;
        contact.impulse = plain(scaled_by(entry.impulse, is_a ? rate : -rate));
        contact.normal_impulse = entry.normal_impulse * rate;
        if constexpr (features.friction)
            contact.friction_impulse = plain(scaled_by(entry.friction_impulse, is_a ? rate : -rate));
        const int at = pairs.place_of(entry.key());
        if (entry.touches && pairs.has(at, entry.key())) {
            const Pair& pair = pairs[at];
            for (int k = 0; k < pair.count; ++k) {
                if (pair.point[k].is_apart(shapes.tolerance())) continue;
                auto& place = contact.points[contact.point_count++] =
                    plain(shapes.place_of(bodies, pair, pair.point[k]));
                contact.point = contact.point + place;
            }
            if (contact.point_count > 0) contact.point = contact.point * (Work(1) / Work(contact.point_count));
        }
        if (N::is_divisor(entry.normal_impulse))
            contact.point = plain(scaled_by(entry.moment, Work(1) / entry.normal_impulse));
        return contact;
    }
    // Writes or reads what a snapshot holds.
    template <class Self, class Archive>
    static void archive(Self& self, Archive& to, int bodies, int planes) {
        const int count = to.within(self.count_, 0, room);
        for (int i = 0; i < count; ++i) {
            to.within(self.entry_[i].a, 0, bodies - 1);
            to.within(self.entry_[i].b, -planes, bodies - 1);
            to(self.entry_[i]);
        }
    }

private:
    // Keeps the entries for which is_kept(entry).
    template <class F>
    void keep(F&& is_kept) {
        int kept = 0;
        for (int i = 0; i < count_; ++i)
            if (is_kept(entry_[i])) entry_[kept++] = entry_[i];
        count_ = kept;
    }
    // The place of the first entry whose key is not smaller. Entries are sorted by it, as pairs are.
    [[nodiscard]] int place_of(std::uint32_t key) const {
        int low = 0, high = count_;
        while (low < high) {
            const int middle = (low + high) / 2;
            if (entry_[middle].key() < key) low = middle + 1;
            else high = middle;
        }
        return low;
    }
    [[nodiscard]] Entry* find(std::uint32_t key) {
        const int at = place_of(key);
        return at < count_ && entry_[at].key() == key ? &entry_[at] : nullptr;
    }
    // The entry of the pair, which is added where it is new. Null, and reported, when there is no room.
    Entry* entry_of(const Pair& pair, Bodies& bodies) {
        const int at = place_of(pair.key());
        if (at < count_ && entry_[at].key() == pair.key()) return &entry_[at];
        if (count_ == room) {
            bodies.report(Issue::contacts_full, pair.a);
            return nullptr;
        }
        for (int i = count_++; i > at; --i) entry_[i] = entry_[i - 1];
        entry_[at] = {pair.a, pair.b};
        entry_[at].clear_impulses();
        return &entry_[at];
    }

    // Twice that of pairs: those that touched before, and those that have come since.
    static constexpr int room = 2 * PairList::room;
    ZeroedArray<Entry, (room > 0 ? room : 1)> entry_{};
    int count_ = 0;
};

}  // namespace tumble

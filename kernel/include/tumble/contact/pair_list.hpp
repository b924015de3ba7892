// The near pairs of a world, kept from step to step, and how many contact points each body has.
#pragma once

#include <tumble/contact/pair.hpp>
#include <tumble/contact/schedule.hpp>

namespace tumble {

// The bodies of one island's step, and its pairs.
template <Features features>
struct Island {
    const SomeBodies<features.bodies>& group;
    int root;                                                     // its first body
    [[no_unique_address]] If<features.pairs, int, 0> first_pair;  // in the list; -1: none is near
};

// Pairs are sorted by their keys, so that the solution does not depend on which came near first. A pair keeps its slot
// in memory while it is near. The pairs of an island are linked; where no two bodies touch, those of a body stand side
// by side, and an island needs no links.
template <class N, Features features>
class PairList {
public:
    using Pair = tumble::Pair<N, features>;
    using Island = tumble::Island<features>;
    static constexpr int room = features.room_for_pairs();
    static constexpr bool has_links = features.pairs;
    // There is no other pair than that of one body and one plane.
    static constexpr bool is_single = features.all_pairs() == 1;

    [[nodiscard]] int count() const { return count_; }
    [[nodiscard]] bool is_full() const { return count_ == room; }
    // In the order of their keys.
    [[nodiscard]] Pair& operator[](int i) { return in_slot(slot_at(i)); }
    [[nodiscard]] const Pair& operator[](int i) const { return in_slot(slot_at(i)); }
    // By their slots, as of Pair::next.
    [[nodiscard]] Pair& in_slot(int slot) { return pair_.begin()[slot]; }
    [[nodiscard]] const Pair& in_slot(int slot) const { return pair_.begin()[slot]; }
    // The pair of a body with a plane or another body has a place in the list.
    [[nodiscard]] TUMBLE_INLINE constexpr bool is_near(int b) const { return pairs_of_[b] != 0; }
    // Near pairs of the body.
    [[nodiscard]] int pairs_of(int b) const { return pairs_of_[b]; }
    // Those with other bodies.
    [[nodiscard]] int pairs_with_bodies_of(int b) const requires(features.grid()) { return with_bodies_of_[b]; }
    // Contact points of the body in the last step.
    [[nodiscard]] int points_of(int b) const { return touching_[b]; }

    // The most pairs that there have been at one time.
    [[nodiscard]] int most() const { return slots_; }

    // The place of the first pair whose key is not smaller.
    [[nodiscard]] int place_of(std::uint32_t key) const {
        if constexpr (is_single) return 0;
        int low = 0, high = count_;
        while (low < high) {
            const int middle = (low + high) / 2;
            if ((*this)[middle].key() < key) low = middle + 1;
            else high = middle;
        }
        return low;
    }
    // True if the pair with the key has this place.
    [[nodiscard]] bool has(int place, std::uint32_t key) const {
        return place < count_ && (is_single || (*this)[place].key() == key);
    }
    // True of two bodies that move and have a pair.
    [[nodiscard]] bool are_near(int a, int b) const {
        const std::uint32_t key = a < b ? Pair::key_of(a, b) : Pair::key_of(b, a);
        return has(place_of(key), key);
    }
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push  // GCC takes the number of a plane for that of a body
#pragma GCC diagnostic ignored "-Wstringop-overflow"
#endif
    // Makes room for a pair at its place. There must be room.
    Pair& insert(int at, int a, int b) {
        const auto slot = count_ < slots_ ? slot_at(count_) : static_cast<std::int16_t>(slots_++);
        if constexpr (room > 1) {
            for (int i = count_; i > at; --i) order_[i] = order_[i - 1];
            order_[at] = slot;
        }
        ++count_;
        in_slot(slot).begin(a, b);
        ++pairs_of_[a];
        if (features.pairs && b >= 0) ++pairs_of_[b];
        if constexpr (features.grid())
            if (b >= 0) ++with_bodies_of_[a], ++with_bodies_of_[b];
        is_linked_ = false;
        unbalance(a, b);
        return in_slot(slot);
    }
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif
    // Removes a pair, if it is there.
    void forget(int a, int b) {
        if (is_near(a)) forget_near(a, b);
    }
    constexpr void forget_all() {
        count_ = 0;
        for (auto& count : pairs_of_) count = 0;
        for (auto& balanced : balanced_) balanced = false;
        if constexpr (features.grid())
            for (auto& count : with_bodies_of_) count = 0;
        is_linked_ = false;
    }
    // Removes the pairs of body b. The next look finds them anew.
    [[gnu::noinline]] void forget_pairs_of(int b) {
        for (int i = count_ - 1; i >= 0 && is_near(b); --i)
            if ((*this)[i].a == b || (*this)[i].b == b) forget_at(i);
    }

    constexpr void forget_points_of(int b) { touching_[b] = 0; }
    // Counts the points of the island that touch and take part in the present solution.
    void count_points(const Island& island, typename Pair::Length tolerance) {
        for (int k = 0; k < island.group.count; ++k) touching_[island.group.id[k]] = 0;
        for_each_active(island, [&](Pair& pair, const auto& point) {
            if (point.is_apart(tolerance)) return;
            ++touching_[pair.a];
            if (pair.moves_b()) ++touching_[pair.b];
        });
    }

    // Notes where the pairs of each body begin, where pairs have come or gone since.
    void link() requires(!has_links) {
        if constexpr (features.bodies > 1)
            for (int i = is_linked_ ? -1 : count_ - 1; i >= 0; --i)
                first_of_[(*this)[i].a] = static_cast<std::int16_t>(i);
        is_linked_ = true;
    }
    // Chains the pairs of each island that steps, where pairs have come or gone since. A pair of two islands, which has
    // come near only in this step, is left out until the next.
    void link(Schedule<features.bodies>& schedule) requires has_links {
        if (is_linked_) return;
        has_left_out_ = false;
        for (int b = 0; b < features.bodies; ++b) schedule.first_pair[b] = -1;
        for (int i = count_ - 1; i >= 0; --i) {
            Pair& pair = (*this)[i];
            const bool joins = schedule.joins[pair.a];
            const int root = schedule.islands.root(pair.a),
                      root_b = pair.moves_b() ? schedule.islands.root(pair.b) : root;
            if (root_b != root) {
                if (!joins && !schedule.joins[pair.b]) continue;
                pair.left_out = has_left_out_ = true;
                unbalance(pair);
            } else if (joins) {
                pair.next = schedule.first_pair[root];
                schedule.first_pair[root] = order_[i];
            }
        }
        is_linked_ = true;
    }
    // False where a pair has come or gone since link().
    [[nodiscard]] bool is_linked() const { return is_linked_; }
    // Call where there is no room for a pair that is near.
    void refuse() { refusals_ = contact::most_clear_steps_near; }
    // Asked once in a step. False where link() has left a pair out, and where a pair was refused that is not yet
    // examined again.
    [[nodiscard]] bool are_complete() {
        const bool refuses = refusals_ > 0;
        if (refuses) --refusals_;
        return !refuses && !has_left_out_;
    }
    // Call before link() where islands have changed.
    void unlink() { is_linked_ = false; }
    template <class F>
    void for_each(const Island& island, F&& f) {
        each(*this, island, f);
    }
    template <class F>
    void for_each(const Island& island, F&& f) const {
        each(*this, island, f);
    }
    // Whether is_such(gap) is true of a point of the island.
    template <class F>
    [[nodiscard]] bool any_gap(const Island& island, F&& is_such) const {
        bool any = false;
        for_each(island, [&](const Pair& pair) { any = any || pair.any_gap(is_such); });
        return any;
    }
    // Calls f for all pairs.
    template <class F>
    void for_each_pair(F&& f) const {
        for (int i = 0; i < count_; ++i) f((*this)[i]);
    }
    // Calls f for the pairs of body b.
    template <class F>
    void for_each_of(int b, F&& f) requires(!has_links) {
        each_of(*this, b, f);
    }
    // True of an island with pairs.
    [[nodiscard]] bool has_pairs(const Island& island) const {
        if constexpr (has_links) {
            return island.first_pair >= 0;
        } else {
            bool any = false;
            for (int k = 0; k < island.group.count; ++k) any = any || is_near(island.group.id[k]);
            return any;
        }
    }
    // Whether statics have stopped every body of the island, and nothing has changed since: neither its pairs nor what
    // follows from where they are.
    [[nodiscard]] bool are_balanced(const Island& island) const {
        bool all = true;
        for (int k = 0; k < island.group.count; ++k) all = all && balanced_[island.group.id[k]];
        return all;
    }
    [[nodiscard]] bool is_balanced(int b) const { return balanced_[b]; }
    void set_balanced(int b, bool balanced) { balanced_[b] = balanced; }
    void set_balanced(const Island& island, bool balanced) {
        for (int k = 0; k < island.group.count; ++k) balanced_[island.group.id[k]] = balanced;
    }
    // Call where something about a pair changes.
    void unbalance(const Pair& pair) { unbalance(pair.a, pair.b); }
    // Calls f(pair, point) for the points that take part in the present solution.
    template <class F>
    void for_each_active(const Island& island, F&& f) {
        for_each(island, [&](Pair& pair) {
            for (int i = 0; i < pair.count; ++i)
                if (pair.point[i].active) f(pair, pair.point[i]);
        });
    }
    // Calls f(other) for every body with which body b has a pair. f may remove it.
    template <class F>
    void for_each_near(int b, F&& f) const {
        for (int i = count_ - 1; i >= 0; --i) {
            const int first = (*this)[i].a, second = (*this)[i].b;
            if (second >= 0 && (first == b || second == b)) f(first == b ? second : first);
        }
    }
    // Calls f(a, b) for every two bodies that were within the tolerance.
    template <class F>
    constexpr void for_each_touching(F&& f) const {
        for (int i = 0; i < count_; ++i)
            if (const Pair& pair = (*this)[i]; pair.b >= 0 && pair.count > 0) f(pair.a, pair.b);
    }

    // Writes or reads what a snapshot holds. may_touch(a, b): such a pair may be in the list. set_up(pair) sets the
    // constants of a pair that is read, finish(pair) is called after it.
    template <class Self, class Archive, class MayTouch, class SetUp, class Finish>
    static void archive(Self& self, Archive& to, MayTouch&& may_touch, SetUp&& set_up, Finish&& finish) {
        to(self.touching_, self.refusals_);
        const int count = to.within(self.count_, 0, room);
        (void)to.within(self.slots_, count, room);
        if constexpr (Archive::reads) {
            const int slots = self.slots_;
            self.forget_all();
            self.slots_ = slots;
            for (int i = 0; i < slots; ++i) self.order_[i] = static_cast<std::int16_t>(i);
        }
        for (int i = 0, last = -1; i < count; ++i) {
            auto& pair = self[i];
            int a = pair.a, b = pair.b;
            a = to.within(a, 0, features.bodies - 1);
            b = to.within(b, -features.planes, features.bodies - 1);
            const int key = static_cast<int>(Pair::key_of(a, b));
            to.require(last < key && may_touch(a, b));
            last = key;
            if constexpr (Archive::reads) set_up(self.insert(i, a, b));
            Pair::archive(pair, to, b < 0);
            finish(pair);
        }
        if constexpr (Archive::reads && !has_links) self.link();
        to(self.is_linked_);
    }

private:
    // A body has a pair with each plane and each other body at most.
    static constexpr int most_pairs_of_a_body = features.planes + (features.pairs ? features.bodies - 1 : 0);

    [[nodiscard]] std::int16_t slot_at(int i) const { return room > 1 ? order_[i] : std::int16_t{0}; }
    template <class Self, class F>
    TUMBLE_INLINE static void each(Self& self, const Island& island, F&& f) {
        if constexpr (has_links) {
            for (int i = island.first_pair; i >= 0; i = self.in_slot(i).next) f(self.in_slot(i));
        } else {
            for (int k = 0; k < island.group.count; ++k) each_of(self, island.group.id[k], f);
        }
    }
    template <class Self, class F>
    TUMBLE_INLINE static void each_of(Self& self, [[maybe_unused]] int b, F&& f) {
        if constexpr (is_single) {
            if (self.count_ > 0) f(self.in_slot(0));
        } else if constexpr (features.bodies == 1) {
            for (int i = 0; i < self.count_; ++i) f(self[i]);
        } else {
            for (int i = self.first_of_[b]; i < self.count_ && self[i].a == b; ++i) f(self[i]);
        }
    }
    [[gnu::noinline]] void forget_near(int a, int b) {
        const std::uint32_t key = Pair::key_of(a, b);
        const int at = place_of(key);
        if (has(at, key)) forget_at(at);
    }
    void forget_at(int at) {
        const std::int16_t slot = slot_at(at);
        const int a = in_slot(slot).a, b = in_slot(slot).b;
        --pairs_of_[a];
        if (features.pairs && b >= 0) --pairs_of_[b];
        if constexpr (features.grid())
            if (b >= 0) --with_bodies_of_[a], --with_bodies_of_[b];
        --count_;
        if constexpr (room > 1) {
            for (int i = at; i < count_; ++i) order_[i] = order_[i + 1];
            order_[count_] = slot;
        }
        is_linked_ = false;
        unbalance(a, b);
    }
    void unbalance(int a, int b) {
        balanced_[a] = false;
        if (features.pairs && b >= 0) balanced_[b] = false;
    }

    ZeroedArray<Pair, (room > 0 ? room : 1)> pair_{};
    std::int16_t order_[room > 0 ? room : 1]{};  // slots by key, then those that are free again
    int count_ = 0;
    int slots_ = 0;           // that have been used: the most pairs at one time
    bool is_linked_ = false;  // link()
    bool has_left_out_ = false;
    std::uint8_t refusals_ = 0;  // steps until a pair that was refused is examined again
    bool balanced_[features.bodies]{};
    // The place of the first pair of each body that has pairs.
    [[no_unique_address]] If<(!has_links && features.bodies > 1), std::int16_t[features.bodies], 2> first_of_{};
    CountTo<most_pairs_of_a_body * Pair::max_points> touching_[features.bodies]{};
    CountTo<most_pairs_of_a_body> pairs_of_[features.bodies]{};
    [[no_unique_address]] If<features.grid(), CountTo<most_pairs_of_a_body>[features.bodies], 0> with_bodies_of_ {};
};

}  // namespace tumble

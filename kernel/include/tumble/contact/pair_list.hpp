// The near pairs of a world, kept from step to step, and how many contact points each body has.
#pragma once

#include <tumble/contact/islands.hpp>
#include <tumble/contact/pair.hpp>

namespace tumble {

// The bodies of one island's step, and its pairs.
template <int bodies>
struct Island {
    const BodyGroup<bodies>& group;
    int root;        // its first body
    int first_pair;  // in the list; -1: none is near
};

// Pairs are sorted by their keys, so that the solution does not depend on which came near first.
template <class N, Features features>
class PairList {
public:
    using Pair = tumble::Pair<N, features>;
    using Island = tumble::Island<features.bodies>;
    static constexpr int room = features.room_for_pairs();

    [[nodiscard]] int count() const { return count_; }
    [[nodiscard]] bool is_full() const { return count_ == room; }
    [[nodiscard]] Pair& operator[](int i) { return pair_[i]; }
    [[nodiscard]] const Pair& operator[](int i) const { return pair_[i]; }
    // The pair of a body with a plane or another body has a place in the list.
    [[nodiscard]] TUMBLE_INLINE bool is_near(int b) const { return pairs_of_[b] != 0; }
    // Near pairs of the body.
    [[nodiscard]] int pairs_of(int b) const { return pairs_of_[b]; }
    // Contact points of the body in the last step.
    [[nodiscard]] int points_of(int b) const { return touching_[b]; }

    // The place of the first pair whose key is not smaller.
    [[nodiscard]] int place_of(std::uint32_t key) const {
        int at = 0;
        while (at < count_ && pair_[at].key() < key) ++at;
        return at;
    }
    // Makes room for a pair at its place. There must be room.
    Pair& insert(int at, int a, int b) {
        for (int i = room - 1; i > at; --i)
            if (0 < i && i <= count_) pair_[i] = pair_[i - 1];
        ++count_;
        pair_[at].begin(a, b);
        ++pairs_of_[a];
        if (b >= 0) ++pairs_of_[b];
        return pair_[at];
    }
    // Removes a pair, if it is there.
    [[gnu::noinline]] void forget(int a, int b) {
        for (int i = 0; i < count_; ++i) {
            if (pair_[i].a != a || pair_[i].b != b) continue;
            --pairs_of_[a];
            if (b >= 0) --pairs_of_[b];
            --count_;
            for (int k = i + 1; k < room && k <= count_; ++k) pair_[k - 1] = pair_[k];
            // Without it, others may not stand.
            for (Pair& pair : pair_) pair.still = 0;
            return;
        }
    }
    void forget_all() {
        count_ = 0;
        for (auto& count : pairs_of_) count = 0;
    }
    // Removes the pairs of body b. The next look finds them anew.
    [[gnu::noinline]] void forget_pairs_of(int b) {
        for (int i = count_ - 1; i >= 0; --i)
            if (pair_[i].a == b || pair_[i].b == b) forget(pair_[i].a, pair_[i].b);
    }

    void forget_points_of(int b) { touching_[b] = 0; }
    // Counts the points of the island that take part in the present solution.
    void count_points(const Island& island) {
        for (int k = 0; k < island.group.count; ++k) touching_[island.group.id[k]] = 0;
        for_each_active(island, [&](Pair& pair, auto&) {
            ++touching_[pair.a];
            if (pair.moves_b()) ++touching_[pair.b];
        });
    }

    // Links the pairs of the island with this root, and returns the first. A pair of two islands, which has come near
    // only in this step, is left out until the next.
    [[nodiscard]] int link(Islands<features.bodies>& islands, int root) {
        int first = -1;
        for (int i = count_ - 1; i >= 0; --i) {
            Pair& pair = pair_[i];
            const bool has_a = islands.root(pair.a) == root, has_b = pair.moves_b() && islands.root(pair.b) == root;
            if (pair.moves_b() && has_a != has_b) {
                pair.left_out = true;
                pair.still = 0;
            }
            if (!has_a || (pair.moves_b() && !has_b)) continue;
            pair.next = static_cast<std::int16_t>(first);
            first = i;
        }
        return first;
    }
    template <class F>
    void for_each(const Island& island, F&& f) {
        for (int i = island.first_pair; i >= 0; i = pair_[i].next) f(pair_[i]);
    }
    template <class F>
    void for_each(const Island& island, F&& f) const {
        for (int i = island.first_pair; i >= 0; i = pair_[i].next) f(pair_[i]);
    }
    // Whether statics hold every body of the island, and nothing has changed since.
    [[nodiscard]] bool hold_all(const Island& island) const {
        bool all = true;
        for_each(island, [&](const Pair& pair) { all = all && pair.still == island.group.count; });
        return all;
    }
    // Calls f(pair, point) for the points that take part in the present solution.
    template <class F>
    void for_each_active(const Island& island, F&& f) {
        for_each(island, [&](Pair& pair) {
            for (int i = 0; i < pair.count; ++i)
                if (pair.point[i].active) f(pair, pair.point[i]);
        });
    }
    // Calls f(a, b) for every two bodies that were within the tolerance.
    template <class F>
    void for_each_touching(F&& f) const {
        for (int i = 0; i < count_; ++i)
            if (pair_[i].b >= 0 && pair_[i].count > 0) f(pair_[i].a, pair_[i].b);
    }

    // Writes or reads what a snapshot holds. set_up(pair) sets the constants of a pair that is read.
    template <class Self, class Archive, class SetUp>
    static void archive(Self& self, Archive& to, SetUp&& set_up) {
        to(self.touching_, self.pairs_of_, self.count_);
        for (int i = 0; i < self.count_; ++i) {
            auto& pair = self.pair_[i];
            std::int16_t a = pair.a, b = pair.b;
            to(a, b);
            if constexpr (Archive::reads) {
                pair.begin(a, b);
                set_up(pair);
            }
            to(pair);
        }
    }

private:
    // A body has a pair with each plane and each other body at most.
    static constexpr int most_pairs_of_a_body = features.planes + (features.pairs ? features.bodies - 1 : 0);

    Pair pair_[room > 0 ? room : 1]{};
    int count_ = 0;
    CountTo<most_pairs_of_a_body * Pair::max_points> touching_[features.bodies]{};
    CountTo<most_pairs_of_a_body> pairs_of_[features.bodies]{};
};

}  // namespace tumble

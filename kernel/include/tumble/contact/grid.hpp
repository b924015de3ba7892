// Where many bodies are: which of them may come near a body before one of the two is examined again.
//
// A body stays in its ball until it is examined again: about its place of the last time, with a radius that is a power
// of two, its level. A level is a grid of cells as wide as its balls, so a ball meets those of its own and of each
// larger level in 27 cells at most. Cells are hashed (Teschner et al. 2003, "Optimized spatial hashing").
#pragma once

#include <tumble/scene.hpp>
#include <tumble/shapes/manifold.hpp>

namespace tumble {

// Some bodies, in the order of their index. Words in which no body is are not read, so nothing is cleared from set to
// set.
template <int bodies>
class BodySet {
public:
    void add(int b) {
        const int word = b / bits;
        std::uint32_t& used = used_[word / bits];
        const std::uint32_t bit = bit_of(word), before = (used & bit) != 0 ? word_[word] : 0;
        word_[word] = before | bit_of(b);
        used |= bit;
    }
    // Calls f(b) for each of them.
    template <class F>
    void for_each(F&& f) const {
        for (int i = 0; i < groups; ++i)
            for_each_bit(used_[i], bits * i, [&](int word) { for_each_bit(word_[word], bits * word, f); });
    }

private:
    static constexpr int bits = 32, words = (bodies + bits - 1) / bits, groups = (words + bits - 1) / bits;

    [[nodiscard]] static std::uint32_t bit_of(int i) { return std::uint32_t{1} << (i % bits); }
    template <class F>
    static void for_each_bit(std::uint32_t left, int first, F&& f) {
        for (; left != 0; left &= left - 1) f(first + std::countr_zero(left));
    }

    std::uint32_t used_[groups]{};  // words with bodies
    std::uint32_t word_[words];
};

template <class N, int bodies>
class Grid {
public:
    using C = ContactNumbers<N>;
    using Length = typename C::Length;
    using LengthScale = typename C::LengthScale;
    using Place = typename N::PositionSum[3];  // m, world

    // Puts the body at this place, into the least ball whose radius is enough. A body without such a ball may be
    // anywhere. Returns the radius.
    template <class IsEnough>
    Length put(int b, const Place& place, const LengthScale& scale, IsEnough&& is_enough) {
        const auto is_large = [&](int level) {
            const Length radius = radius_of(level, scale);
            return radius < C::longest() && is_enough(radius);
        };
        int level = level_[b] == nowhere || level_[b] == everywhere ? middle : level_[b];
        while (level < everywhere && !is_large(level)) ++level;
        while (level > lowest && is_large(level - 1)) --level;
        remove(b);
        for (int i = 0; i < 3; ++i) place_[b][i] = place[i];
        level_[b] = static_cast<std::uint8_t>(level);
        enter(b);
        return radius_of(level, scale);
    }
    [[nodiscard]] bool has(int b) const { return level_[b] != nowhere; }
    void remove(int b) {
        if (level_[b] == nowhere) return;
        if (--count_[level_[b]] == 0) in_use_ &= ~bit_of(level_[b]);
        std::int16_t* link = &first_[chain_of(b)];
        while (*link != b + 1) link = &next_[*link - 1];
        *link = next_[b];
        level_[b] = nowhere;
    }

    // Calls f(other) for the bodies whose balls meet that of body b, if it has one, in no order of theirs.
    template <class F>
    void for_each_near(int b, const LengthScale& scale, F&& f) const {
        const int own = level_[b];
        if (own == nowhere) return;
        for (int other = first_[buckets]; other != 0; other = next_[other - 1])
            if (other - 1 != b) f(other - 1);
        for (std::uint64_t left = in_use_; left != 0; left &= left - 1) {
            const int level = std::countr_zero(left);
            const auto look = [&](int other) {
                if (other != b && level_[other] == level && (own == everywhere || meet(b, other, scale))) f(other);
            };
            // Centres are at most the radii apart: so many cells, rounded up.
            const int higher = own - level, reach = higher > 0 ? (1 << (higher < 8 ? higher - 1 : 7)) + 1 : 1,
                      wide = 2 * reach + 1;
            if (own == everywhere || wide * wide * wide >= bodies) {
                for (int other = 0; other < bodies; ++other) look(other);
                continue;
            }
            const Cell centre = cell_of(place_[b], level);
            Cell cell;
            for (cell[0] = centre[0] - reach; cell[0] <= centre[0] + reach; ++cell[0])
                for (cell[1] = centre[1] - reach; cell[1] <= centre[1] + reach; ++cell[1])
                    for (cell[2] = centre[2] - reach; cell[2] <= centre[2] + reach; ++cell[2])
                        for (int other = first_[bucket_of(cell, level)]; other != 0; other = next_[other - 1])
                            // Other cells have the same bucket.
                            if (level_[other - 1] == level && cell_of(place_[other - 1], level) == cell)
                                look(other - 1);
        }
    }

    // Writes or reads what a snapshot holds.
    template <class Self, class Archive>
    static void archive(Self& self, Archive& to) {
        for (auto& level : self.level_) to.within(level, nowhere, everywhere);
        to(self.place_);
        if constexpr (Archive::reads) {
            for (auto& first : self.first_) first = 0;
            for (auto& count : self.count_) count = 0;
            self.in_use_ = 0;
            for (int b = 0; b < bodies; ++b)
                if (self.level_[b] != nowhere) self.enter(b);
        }
    }

private:
    // Levels. The radius is 2^(level - middle) m, and cells are twice as wide.
    static constexpr int nowhere = 0, lowest = 1, middle = 34, everywhere = 62;
    // Most of the cells that are asked are empty, and so should their buckets be.
    static constexpr int buckets = 4 * static_cast<int>(std::bit_ceil(static_cast<unsigned>(bodies)));

    struct Cell {
        std::int32_t i[3];
        std::int32_t& operator[](int k) { return i[k]; }
        std::int32_t operator[](int k) const { return i[k]; }
        friend bool operator==(const Cell&, const Cell&) = default;
    };
    void enter(int b) {
        ++count_[level_[b]];
        in_use_ |= bit_of(level_[b]);
        std::int16_t& first = first_[chain_of(b)];
        next_[b] = first;
        first = static_cast<std::int16_t>(b + 1);
    }
    // Bodies everywhere have no cells.
    [[nodiscard]] static std::uint64_t bit_of(int level) { return level == everywhere ? 0 : std::uint64_t{1} << level; }
    [[nodiscard]] static Length radius_of(int level, const LengthScale& scale) {
        return level == everywhere ? C::longest() : C::power_of_two(scale, level - middle);
    }
    [[nodiscard]] static Cell cell_of(const Place& place, int level) {
        Cell cell;
        for (int i = 0; i < 3; ++i) cell[i] = C::cell(place[i], level - middle + 1);
        return cell;
    }
    [[nodiscard]] static int bucket_of(const Cell& cell, int level) {
        std::uint32_t hash = static_cast<std::uint32_t>(level);
        constexpr std::uint32_t primes[] = {73856093, 19349663, 83492791};
        for (int i = 0; i < 3; ++i) hash ^= static_cast<std::uint32_t>(cell[i]) * primes[i];
        return static_cast<int>(hash % buckets);
    }
    [[nodiscard]] int chain_of(int b) const {
        return level_[b] == everywhere ? buckets : bucket_of(cell_of(place_[b], level_[b]), level_[b]);
    }
    [[nodiscard]] bool meet(int a, int b, const LengthScale& scale) const {
        Vec3<Length> reach;
        for (int i = 0; i < 3; ++i) reach[i] = scale.between(place_[a][i], place_[b][i]);
        return C::meet(radius_of(level_[a], scale), radius_of(level_[b], scale), dot(reach, reach));
    }

    Place place_[bodies]{};
    std::uint8_t level_[bodies]{};
    int count_[everywhere + 1]{};  // of bodies, by level
    std::uint64_t in_use_ = 0;     // levels with bodies
    // Chains of one more than the body, of each bucket and of bodies everywhere; 0 ends them.
    std::int16_t first_[buckets + 1]{}, next_[bodies]{};
};

}  // namespace tumble

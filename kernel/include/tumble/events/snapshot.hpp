// Snapshots as bytes: the state of a world for a wire or a flash. Numbers are written in words of 32 bits, the lowest
// byte first, so every machine reads what another has written. World::save() and World::restore() use this.
//
// A snapshot is: "tmbl"; version, 16 bits, part and kind of spin, 8 bits each; TUMBLE_BITS; digest of the number
// system; digest of the scene, 64 bits; the size in bytes; the state; CRC-32 of all bytes before it.
#pragma once

#include <tumble/body/words.hpp>
#include <tumble/events/event.hpp>
#include <tumble/version.hpp>

namespace tumble {

// What a snapshot holds.
enum class SnapshotPart : std::uint16_t {
    bodies,  // the states of all bodies and the number of steps; contacts are found anew
    world,   // all that the next step depends on: it goes on with the same bits
};

// Why bytes were not restored.
enum class SnapshotFault : std::uint8_t {
    none,           // they were restored
    truncated,      // there are fewer bytes than the snapshot has
    no_snapshot,    // they do not begin as a snapshot does
    other_version,  // of the format
    corrupted,      // the check word is wrong, or a number is beyond its room or its range
    other_bits,     // of a kernel with another TUMBLE_BITS
    other_numbers,  // of another number system
    other_scene,    // of other bodies, planes, springs or step; of a whole world: or of other joints or features
};

// The name of a fault: other_scene.
[[nodiscard]] constexpr const char* name_of(SnapshotFault fault) {
    switch (fault) {
    case SnapshotFault::none: return "none";
    case SnapshotFault::truncated: return "truncated";
    case SnapshotFault::no_snapshot: return "no_snapshot";
    case SnapshotFault::other_version: return "other_version";
    case SnapshotFault::corrupted: return "corrupted";
    case SnapshotFault::other_bits: return "other_bits";
    case SnapshotFault::other_numbers: return "other_numbers";
    default: return "other_scene";
    }
}

namespace detail {

// CRC-32 of ITU-T V.42 (polynomial 0x04c11db7, reflected), four bits at a time.
class Crc32 {
public:
    constexpr void add(std::uint8_t byte) {
        value_ ^= byte;
        shift_byte();
    }
    // Four bytes, the lowest first.
    TUMBLE_INLINE constexpr void add_word(std::uint32_t word) {
        value_ ^= word;
        shift_byte();
        shift_byte();
        shift_byte();
        shift_byte();
    }
    [[nodiscard]] constexpr std::uint32_t value() const { return ~value_; }

private:
    TUMBLE_INLINE constexpr void shift_byte() {
        value_ = value_ >> 4 ^ table[value_ & 15u];
        value_ = value_ >> 4 ^ table[value_ & 15u];
    }

    static constexpr std::uint32_t table[16] = {
        0x00000000u, 0x1db71064u, 0x3b6e20c8u, 0x26d930acu, 0x76dc4190u, 0x6b6b51f4u, 0x4db26158u, 0x5005713cu,
        0xedb88320u, 0xf00f9344u, 0xd6d6a3e8u, 0xcb61b38cu, 0x9b64c2b0u, 0x86d3d2d4u, 0xa00ae278u, 0xbdbdf21cu};
    std::uint32_t value_ = 0xffffffffu;
};

[[nodiscard]] inline std::uint32_t word_at(const std::uint8_t* bytes) {
    return std::uint32_t{bytes[0]} | std::uint32_t{bytes[1]} << 8 | std::uint32_t{bytes[2]} << 16 |
           std::uint32_t{bytes[3]} << 24;
}

// Numbers that are made of words of one size. Their objects hold nothing else.
template <class T>
struct WordsOf;
template <class T, bool carry, bool biased>
struct WordsOf<Carried<T, carry, biased>> {
    using Word =
        std::conditional_t<std::floating_point<T>, std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>,
                           std::conditional_t<carry, std::uint64_t, std::uint32_t>>;
};
template <class T, bool carry>
struct WordsOf<Shaped<T, carry>> : WordsOf<Carried<T, carry, false>> {};
template <int F>
struct WordsOf<Shaped<Fixed<F>, true>> {
    using Word = std::uint32_t;
};

// Transfers `count` values of `width` bits, as many in a word as it holds. Calls take(i, value) for each.
template <int width, class A>
void transfer_bits(A& archive, int count, auto&& value_of, auto&& take) {
    constexpr int in_word = 32 / width;
    for (int first = 0; first < count; first += in_word) {
        const int many = count - first < in_word ? count - first : in_word;
        std::uint32_t bits = 0;
        for (int k = 0; !A::reads && k < many; ++k)
            bits |= static_cast<std::uint32_t>(value_of(first + k)) << (width * k);
        bits = archive.bits(bits);
        for (int k = 0; k < many; ++k) take(first + k, bits >> (width * k) & (0xffffffffu >> (32 - width)));
    }
}
// Unsigned integers below 32 bits, and bool.
template <class T>
inline constexpr int bits_of_element = 0;
template <class T>
requires(std::is_unsigned_v<T> &&
         sizeof(T) <
             4) inline constexpr int bits_of_element<T> = std::is_same_v<T, bool> ? 1 : 8 * static_cast<int>(sizeof(T));

// No exponent of a number comes near it, and the sum of many does not wrap.
inline constexpr int most_exponent = 1 << 20;

// Transfers a value to or from an archive, word by word.
template <class A, class T>
void transfer(A& archive, T& value) {
    using V = std::remove_const_t<T>;
    if constexpr (std::is_array_v<V> && bits_of_element<std::remove_extent_t<V>> != 0) {
        using Element = std::remove_extent_t<V>;
        transfer_bits<bits_of_element<Element>>(
            archive, static_cast<int>(std::extent_v<V>), [&](int i) { return value[i]; },
            [&]([[maybe_unused]] int i, [[maybe_unused]] std::uint32_t bits) {
                if constexpr (A::reads) value[i] = static_cast<Element>(bits);
            });
    } else if constexpr (std::is_array_v<V>) {
        for (auto& element : value) transfer(archive, element);
    } else if constexpr (std::is_same_v<V, bool> || std::is_enum_v<V> || (std::is_integral_v<V> && sizeof(V) <= 4)) {
        archive.number(value);
    } else if constexpr (sizeof(V) == 8 && (std::is_integral_v<V> || std::is_same_v<V, double>)) {
        archive.two_words(value);
    } else if constexpr (std::is_same_v<V, float>) {
        archive.one_word(value);
    } else if constexpr (requires { value.raw; }) {
        transfer(archive, value.raw);
    } else if constexpr (std::is_same_v<V, Scaled>) {
        auto mantissa = value.mantissa();
        auto exponent = value.exponent();
        transfer(archive, mantissa);
        archive.within(exponent, -most_exponent, most_exponent);
        if constexpr (A::reads) value = Scaled::of(mantissa, exponent);
    } else if constexpr (requires { typename WordsOf<V>::Word; }) {
        using Word = typename WordsOf<V>::Word;
        static_assert(std::is_trivially_copyable_v<V> && sizeof(V) % sizeof(Word) == 0);
        struct Words {
            Word word[sizeof(V) / sizeof(Word)];
        };
        auto words = std::bit_cast<Words>(value);
        for (Word& word : words.word) transfer(archive, word);
        if constexpr (A::reads) value = std::bit_cast<V>(words);
    } else if constexpr (requires { V::each(value, archive); }) {
        V::each(value, archive);
    } else if constexpr (requires { value.d_w; }) {  // of a state, or of a part of it
        if constexpr (requires { value.x_w; }) transfer(archive, value.x_w);
        transfer(archive, value.d_w);
        if constexpr (requires { value.q_wb; }) transfer(archive, value.q_wb);
        if constexpr (requires { value.t_b; }) transfer(archive, value.t_b);
    } else if constexpr (requires { value.linear; }) {
        transfer(archive, value.linear);
        if constexpr (requires { value.angular; }) transfer(archive, value.angular);
    } else if constexpr (requires { value.row; }) {
        transfer(archive, value.row);
    } else if constexpr (requires { value.w, value.v; }) {
        transfer(archive, value.w);
        transfer(archive, value.v);
    } else if constexpr (requires { value.w, value.x; }) {
        for (auto* part : {&value.w, &value.x, &value.y, &value.z}) transfer(archive, *part);
    } else if constexpr (requires { value.x, value.y, value.z; }) {
        for (auto* part : {&value.x, &value.y, &value.z}) transfer(archive, *part);
    } else {
        for (int i = 0; i < 3; ++i) transfer(archive, value[i]);
    }
}

// Reads a state that has been held against the world. Beyond its end it reads zeros.
class SnapshotReader {
public:
    static constexpr bool reads = true;

    SnapshotReader(const std::uint8_t* from, int count) : from_{from}, end_{from + count} {}
    void operator()(auto&... values) { (transfer(*this, values), ...); }
    [[nodiscard]] std::uint32_t word() {
        if (end_ - from_ < 4) return 0;
        const std::uint32_t w = word_at(from_);
        from_ += 4;
        return w;
    }
    template <class T>
    void number(T& value) {
        value = static_cast<T>(word());
    }
    template <class T>
    void one_word(T& value) {
        value = std::bit_cast<T>(word());
    }
    template <class T>
    void two_words(T& value) {
        const std::uint64_t low = word();
        value = std::bit_cast<T>(low | std::uint64_t{word()} << 32);
    }
    [[nodiscard]] std::uint32_t bits(std::uint32_t) { return word(); }
    template <class T>
    int within(T& value, int, int) {
        const auto found = static_cast<std::int32_t>(word());
        value = static_cast<T>(found);
        return found;
    }
    void require(bool) {}
    template <int width>
    void each_bits(int count, auto&& value_of, auto&& take) {
        transfer_bits<width>(*this, count, value_of, take);
    }

private:
    const std::uint8_t *from_, *end_;
};

// Writes a state, counts its bytes, or holds bytes against it: those of the same scene have as many, and what they
// count and name has room in this world. The three are one class, so that a program has the code of an archive once.
class SnapshotWriter {
public:
    static constexpr bool reads = false;

    // Null: adds up the check word alone.
    explicit SnapshotWriter(std::uint8_t* to) : to_{to} {}
    // Only counts.
    SnapshotWriter() : is_checked_{false} {}
    // Holds a state of `count` bytes against the world.
    SnapshotWriter(const std::uint8_t* given, int count) : given_{given}, count_{count}, is_checked_{false} {}
    void operator()(const auto&... values) { (transfer(*this, values), ...); }
    void word(std::uint32_t w) {
        if (is_checked_) write(w);
        size_ += 4;
    }
    template <class T>
    void number(T value) {
        word(static_cast<std::uint32_t>(value));
    }
    template <class T>
    void one_word(T value) {
        word(std::bit_cast<std::uint32_t>(value));
    }
    template <class T>
    void two_words(T value) {
        if (is_checked_) {
            const auto bits = std::bit_cast<std::uint64_t>(value);
            word(static_cast<std::uint32_t>(bits));
            word(static_cast<std::uint32_t>(bits >> 32));
        } else {
            size_ += 8;
        }
    }
    // A word of which every bit has a meaning. Returns that of the bytes.
    std::uint32_t bits(std::uint32_t w) {
        if (given_ != nullptr) w = size_ + 4 <= count_ ? word_at(given_ + size_) : 0;
        word(w);
        return w;
    }
    // Numbers of `width` bits: transfer_bits().
    template <int width>
    void each_bits(int count, auto&& value_of, auto&& take) {
        transfer_bits<width>(*this, count, value_of, take);
    }
    // A number that must be from `least` to `most`. Returns that of the bytes, or `least`.
    int within(int value, int least, int most) {
        const auto found = static_cast<std::int32_t>(bits(static_cast<std::uint32_t>(value)));
        const bool has_room = least <= found && found <= most;
        require(has_room);
        return has_room ? found : least;
    }
    // True where bytes are held against the world. Then values can be read that come next.
    [[nodiscard]] bool compares() const { return given_ != nullptr; }
    void look_ahead(auto&... values) const {
        const int at = size_ < count_ ? size_ : count_;
        SnapshotReader reader{given_ + at, count_ - at};
        reader(values...);
    }
    // Call for what must be true of the bytes.
    void require(bool is_right) { is_right_ = is_right_ && is_right; }
    // Of the bytes that were held against the state.
    [[nodiscard]] SnapshotFault fault() const {
        if (!is_right_) return SnapshotFault::corrupted;
        return size_ == count_ ? SnapshotFault::none : SnapshotFault::other_scene;
    }
    [[nodiscard]] int size() const { return size_; }
    [[nodiscard]] std::uint32_t check() const { return crc_.value(); }

private:
    [[gnu::noinline]] void write(std::uint32_t w) {
        crc_.add_word(w);
        if (to_ == nullptr) return;
        std::uint8_t* const at = to_ + size_;
        for (int i = 0; i < 4; ++i) at[i] = static_cast<std::uint8_t>(w >> (8 * i));
    }

    std::uint8_t* to_ = nullptr;
    const std::uint8_t* given_ = nullptr;
    int size_ = 0, count_ = 0;
    bool is_checked_ = true, is_right_ = true;
    Crc32 crc_{};
};

struct SnapshotHeader {
    static constexpr int words = 8, bytes = 4 * words;
    static constexpr std::uint32_t mark = 0x6c626d74u, version = 6;  // "tmbl"

    SnapshotPart part = SnapshotPart::world;
    Spin spin = Spin::none;     // in the states of bodies
    std::uint32_t numbers = 0;  // digest
    std::uint64_t scene = 0;    // digest
    std::uint32_t size = 0;     // of the whole snapshot

    void write(SnapshotWriter& to) const {
        to(mark, version | static_cast<std::uint32_t>(part) << 16 | static_cast<std::uint32_t>(spin) << 24,
           std::uint32_t{TUMBLE_BITS}, numbers, scene, size, std::uint32_t{0});
    }
    // Of bytes that are long enough for it.
    [[nodiscard]] static SnapshotHeader read(const std::uint8_t* from) {
        SnapshotHeader header;
        header.part = static_cast<SnapshotPart>(from[6]);
        header.spin = static_cast<Spin>(from[7]);
        header.numbers = word_at(from + 12);
        header.scene = word_at(from + 16) | std::uint64_t{word_at(from + 20)} << 32;
        header.size = word_at(from + 24);
        return header;
    }
    // What is wrong with bytes, for a world with this header.
    [[nodiscard]] static SnapshotFault fault_of(const std::uint8_t* from, int count, std::uint32_t numbers) {
        if (count < 4 || word_at(from) != mark)
            return count < 4 ? SnapshotFault::truncated : SnapshotFault::no_snapshot;
        if (count < bytes + 4) return SnapshotFault::truncated;
        if ((word_at(from + 4) & 0xffffu) != version) return SnapshotFault::other_version;
        const std::uint32_t size = word_at(from + 24);
        if (size > static_cast<std::uint32_t>(count)) return SnapshotFault::truncated;
        if (size < bytes + 4 || size % 4 != 0) return SnapshotFault::corrupted;
        Crc32 crc;
        for (std::uint32_t i = 0; i < size - 4; i += 4) crc.add_word(word_at(from + i));
        if (crc.value() != word_at(from + size - 4)) return SnapshotFault::corrupted;
        if (word_at(from + 8) != std::uint32_t{TUMBLE_BITS}) return SnapshotFault::other_bits;
        if (word_at(from + 12) != numbers) return SnapshotFault::other_numbers;
        return from[6] > static_cast<std::uint8_t>(SnapshotPart::world) ||
                       from[7] > static_cast<std::uint8_t>(Spin::none)
                   ? SnapshotFault::corrupted
                   : SnapshotFault::none;
    }
};

// A digest of the constants of a scene and of a number system.
class Digest {
public:
    using Words = SnapshotWriter;  // adds up the check word of numbers
    constexpr void add(std::uint32_t word) { hash_.add(word); }
    constexpr void add(int value) { hash_.add(static_cast<std::uint32_t>(value)); }
    TUMBLE_SET_UP constexpr void add(const Real& value) {
        const auto bits = std::bit_cast<std::uint64_t>(value.to_double());
        hash_.add(static_cast<std::uint32_t>(bits));
        hash_.add(static_cast<std::uint32_t>(bits >> 32));
    }
    constexpr void add(const RealVec3& v) {
        for (int i = 0; i < 3; ++i) add(v[i]);
    }
    constexpr void add(const RealQuat& q) {
        add(q.w);
        add(q.v);
    }
    constexpr void add(const Shape& shape) {
        add(static_cast<int>(shape.kind));
        add(shape.size);
    }
    constexpr void add(const InertiaTensor& i) {
        for (const Real* element : {&i.xx, &i.yy, &i.zz, &i.xy, &i.xz, &i.yz}) add(*element);
    }
    // A spec, but for its state; a choice; or the number of a body.
    template <class T>
    constexpr void add(const T& value) {
        if constexpr (requires { T::each(*this, value); }) T::each(*this, value);
        else add(static_cast<int>(value));
    }
    TUMBLE_INLINE constexpr void operator()(Field field, const auto& value) {
        if (field.kind != Field::state) add(value);
    }
    constexpr void add(const char* text) {
        for (; *text != 0; ++text) hash_.add(static_cast<std::uint32_t>(static_cast<unsigned char>(*text)));
    }
    // A number of a world.
    void add_number(const auto& value) {
        SnapshotWriter words{nullptr};
        words(value);
        add(words.check());
    }
    [[nodiscard]] constexpr std::uint64_t value() const { return hash_.value(); }

private:
    Hash hash_{};
};

// Of the formats of a number system.
template <class N>
[[nodiscard]] constexpr std::uint32_t digest_of_numbers() {
    Digest digest;
    digest.add(N::name);
    digest.add(static_cast<int>(N::carry));
    digest.add(static_cast<int>(sizeof(typename N::Position)));
    if constexpr (N::fixed_point) {
        digest.add(N::PositionSum::fraction_bits);
        digest.add(Real{N::Range::velocity});
        digest.add(Real{N::Range::spin});
    }
    return static_cast<std::uint32_t>(digest.value() ^ digest.value() >> 32);
}

}  // namespace detail

}  // namespace tumble

// The port's own memcpy, memmove, memset and memcmp against a byte at a time, over all small sizes and alignments.
#include <cstring>

#include "port.hpp"

namespace {

constexpr int room = 64;
using Bytes = unsigned char[room];

void fill(Bytes& bytes) {
    for (int i = 0; i < room; ++i) bytes[i] = static_cast<unsigned char>(i * 37 + 11);
}

bool same(const Bytes& a, const Bytes& b) {
    for (int i = 0; i < room; ++i)
        if (a[i] != b[i]) return false;
    return true;
}

}  // namespace

int main() {
    alignas(4) static Bytes got, expected, source;
    fill(source);
    for (int to = 0; to < 8; ++to)
        for (int from = 0; from < 8; ++from)
            for (int size = 0; size < 20; ++size) {
                const auto n = static_cast<std::size_t>(size);
                fill(got);
                fill(expected);
                for (int i = 0; i < size; ++i) expected[to + 32 + i] = source[from + i];
                if (std::memcpy(got + to + 32, source + from, n) != got + to + 32 || !same(got, expected)) return 1;

                fill(got);
                fill(expected);
                for (int i = 0; i < size; ++i) expected[to + i] = source[from + i];
                if (std::memmove(got + to, got + from, n) != got + to || !same(got, expected)) return 2;

                fill(got);
                fill(expected);
                for (int i = 0; i < size; ++i) expected[to + i] = 0xC3;
                if (std::memset(got + to, 0x1C3, n) != got + to || !same(got, expected)) return 3;

                fill(got);
                if (std::memcmp(got + to, source + to, n) != 0) return 4;
                if (size == 0) continue;
                got[to + size - 1] = 0;
                source[to + size - 1] = 200;
                if (std::memcmp(got + to, source + to, n) >= 0 || std::memcmp(source + to, got + to, n) <= 0) return 5;
                fill(source);
            }
    return 0;
}

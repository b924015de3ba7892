// One JSON object on one line, written through the port as it is built: no buffer, no formatting library. Not inlined,
// so that it is the least part of the programs that measure.
#pragma once

#include "port.hpp"

#include <cstdint>
#include <string_view>

namespace tumble::port {

class JsonRow {
public:
    // Quotes, backslashes and control characters of the text are escaped.
    [[gnu::noinline]] void add(std::string_view key, std::string_view text) {
        name(key);
        port::write("\"");
        for (const char& c : text) {
            if (c == '"' || c == '\\') port::write("\\");
            if (static_cast<unsigned char>(c) < 0x20) {
                const char escape[] = {'\\', 'u', '0', '0', hex_digits[c >> 4], hex_digits[c & 15]};
                port::write(escape, sizeof escape);
            } else {
                port::write(&c, 1);
            }
        }
        port::write("\"");
    }
    [[gnu::noinline]] void add(std::string_view key, bool value) {
        name(key);
        port::write(value ? "true" : "false");
    }
    [[gnu::noinline]] void add(std::string_view key, std::uint64_t value) {
        name(key);
        char digits[20];
        int first = 20;
        do {
            digits[--first] = static_cast<char>('0' + value % 10);
            value /= 10;
        } while (value != 0);
        port::write(digits + first, static_cast<std::size_t>(20 - first));
    }
    void add(std::string_view key, std::uint32_t value) { add(key, std::uint64_t{value}); }
    void add(std::string_view key, const char* text) { add(key, std::string_view{text}); }
    // 16 hexadecimal digits, as text.
    [[gnu::noinline]] void add_hex(std::string_view key, std::uint64_t value) {
        char digits[16];
        for (int i = 15; i >= 0; --i) {
            digits[i] = hex_digits[value & 15];
            value >>= 4;
        }
        add(key, std::string_view{digits, 16});
    }
    void write() { port::write("}\n"); }

private:
    static constexpr char hex_digits[] = "0123456789abcdef";
    [[gnu::noinline]] void name(std::string_view key) {
        port::write(first_ ? "{\"" : ", \"");
        first_ = false;
        port::write(key);
        port::write("\": ");
    }
    bool first_ = true;
};

}  // namespace tumble::port

// The number of a result in a program's text.
#pragma once

#include "port.hpp"

// In base 10 or 16, with zeros in front to make `width` digits.
inline void write_number(std::uint64_t value, unsigned base, int width) {
    char digits[20];
    int first = 20;
    do {
        digits[--first] = "0123456789abcdef"[value % base];
        value /= base;
    } while (value != 0 || 20 - first < width);
    tumble::port::write(digits + first, static_cast<std::size_t>(20 - first));
}

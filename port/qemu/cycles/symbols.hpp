// The functions of a firmware, from its ELF file: QEMU's own look-up needs sizes and knows no labels of assembly.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cycles {

struct Symbol {
    std::uint32_t address = 0, size = 0;  // without the Thumb bit; bytes, 0 for a label
    std::string name;                     // as linked, not demangled
    bool is_function = false;
};

class Symbols {
public:
    Symbols() = default;
    // Throws std::runtime_error, naming the file, when it is not a 32-bit little-endian ELF file with symbols.
    explicit Symbols(const std::string& path);

    [[nodiscard]] bool empty() const { return symbols_.empty(); }
    [[nodiscard]] int count() const { return static_cast<int>(symbols_.size()); }
    [[nodiscard]] const Symbol& operator[](int index) const { return symbols_[static_cast<std::size_t>(index)]; }
    // The symbol that covers the address, or the last before it; -1 where there is none.
    [[nodiscard]] int at(std::uint32_t address) const;

private:
    std::vector<Symbol> symbols_;  // by address, the longer first
};

}  // namespace cycles

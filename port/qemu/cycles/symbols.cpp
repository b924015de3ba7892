#include "symbols.hpp"

#include <elf.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>

namespace cycles {

namespace {

class Image {
public:
    explicit Image(const std::string& path) : path_{path} {
        std::ifstream file{path, std::ios::binary};
        if (!file) throw std::runtime_error{"cannot read " + path};
        bytes_.assign(std::istreambuf_iterator<char>{file}, {});
    }
    template <class T>
    [[nodiscard]] T read(std::size_t offset) const {
        if (offset > bytes_.size() || bytes_.size() - offset < sizeof(T)) fail("ends too early");
        T value;
        std::memcpy(&value, bytes_.data() + offset, sizeof value);
        return value;
    }
    [[nodiscard]] std::string_view text(std::size_t offset) const {
        if (offset >= bytes_.size()) fail("ends too early");
        const std::string_view rest{bytes_.data() + offset, bytes_.size() - offset};
        return rest.substr(0, rest.find('\0'));
    }
    [[noreturn]] void fail(const char* why) const { throw std::runtime_error{path_ + " " + why}; }

private:
    std::string path_;
    std::vector<char> bytes_;
};

// True of functions, and of labels of assembly, which have no type. False of mapping symbols ($t, $d) and the linker's
// names.
[[nodiscard]] bool is_code(const Elf32_Sym& entry, std::string_view name) {
    const int type = ELF32_ST_TYPE(entry.st_info);
    if (entry.st_shndx == SHN_UNDEF || entry.st_shndx >= SHN_LORESERVE || name.empty() || name[0] == '$') return false;
    return type == STT_FUNC || (type == STT_NOTYPE && name[0] != '.' && name.substr(0, 2) != "__");
}

}  // namespace

Symbols::Symbols(const std::string& path) {
    const Image image{path};
    const auto header = image.read<Elf32_Ehdr>(0);
    if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_ident[EI_CLASS] != ELFCLASS32 ||
        header.e_ident[EI_DATA] != ELFDATA2LSB)
        image.fail("is not a 32-bit little-endian ELF file");
    const auto section = [&](std::size_t index) {
        return image.read<Elf32_Shdr>(header.e_shoff + index * header.e_shentsize);
    };
    for (std::size_t i = 0; i < header.e_shnum; ++i) {
        const Elf32_Shdr table = section(i);
        if (table.sh_type != SHT_SYMTAB) continue;
        const std::size_t names = section(table.sh_link).sh_offset;
        for (std::size_t at = 0; at + sizeof(Elf32_Sym) <= table.sh_size; at += sizeof(Elf32_Sym)) {
            const auto entry = image.read<Elf32_Sym>(table.sh_offset + at);
            const std::string_view name = image.text(names + entry.st_name);
            if (!is_code(entry, name)) continue;
            symbols_.push_back(
                {entry.st_value & ~1u, entry.st_size, std::string{name}, ELF32_ST_TYPE(entry.st_info) == STT_FUNC});
        }
    }
    if (symbols_.empty()) image.fail("has no symbols");
    std::stable_sort(symbols_.begin(), symbols_.end(), [](const Symbol& a, const Symbol& b) {
        return a.address != b.address ? a.address < b.address : a.size > b.size;
    });
}

int Symbols::at(std::uint32_t address) const {
    const auto behind = std::upper_bound(symbols_.begin(), symbols_.end(), address,
                                         [](std::uint32_t a, const Symbol& s) { return a < s.address; });
    const auto last = static_cast<int>(behind - symbols_.begin()) - 1;
    // A function may have labels inside. The result is the nearest symbol that covers the address, among the last few.
    constexpr int labels_inside = 8;
    for (int i = last; i >= 0 && i > last - labels_inside; --i) {
        const Symbol& s = (*this)[i];
        if (s.size == 0 || address - s.address >= s.size) continue;
        while (i > 0 && (*this)[i - 1].address == s.address && (*this)[i - 1].size == s.size) --i;  // the first alias
        return i;
    }
    return last;
}

}  // namespace cycles

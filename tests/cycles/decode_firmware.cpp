// decode_firmware MODEL: reads what `objdump -d` says of firmware and looks each instruction up in the model's tables.
// Status 1, with the lines, when an instruction has another length there, or no timing.
#include <cstdint>
#include <iostream>
#include <map>
#include <sstream>
#include <string>

#include "timing.hpp"

int main(int argc, char** argv) {
    const auto model = argc == 2 ? cycles::model_named(argv[1]) : std::nullopt;
    if (!model) {
        std::cerr << "usage: decode_firmware m0|m0+|m3|m4f < DISASSEMBLY\n";
        return 2;
    }
    const cycles::Timing timing{*model};
    std::map<std::string, int> wrong;  // by what is wrong and the mnemonic
    long count = 0;
    for (std::string line; std::getline(std::cin, line);) {
        // "    2e68:\tfb03 2101 \tmla\tr1, r3, r1, r2"; of data the mnemonic is .word or .short.
        const std::size_t colon = line.find(":\t"), tab = line.find('\t', colon + 2);
        if (colon == line.npos || tab == line.npos || line.compare(tab + 1, 1, ".") == 0) continue;
        std::istringstream words{line.substr(colon + 2, tab - colon - 2)};
        std::string first, second;
        if (!(words >> first) || first.size() != 4) continue;
        words >> second;
        const auto halfword = [](const std::string& text) {
            return static_cast<std::uint16_t>(text.empty() ? 0 : std::stoul(text, nullptr, 16));
        };
        const auto address = static_cast<std::uint32_t>(std::stoul(line.substr(0, colon), nullptr, 16));
        const auto instruction = cycles::decode(address, halfword(first), halfword(second));
        ++count;
        const std::string mnemonic = line.substr(tab + 1, line.find_first_of("\t ", tab + 1) - tab - 1);
        if (instruction.size != (second.empty() ? 2 : 4)) ++wrong["length of " + mnemonic];
        if (!timing.knows(instruction) || instruction.cls == cycles::Class::unknown)
            ++wrong["no timing of " + mnemonic + " " + first + " " + second];
    }
    for (const auto& [what, times] : wrong) std::cout << what << ", " << times << " times\n";
    std::cout << count << " instructions, " << wrong.size() << " kinds of them are not in the tables of " << argv[1]
              << '\n';
    return wrong.empty() && count > 0 ? 0 : 1;
}

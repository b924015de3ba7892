// tumble_flame: where estimated cycles go, with a frame for every inlined function.
//
//   tumble_flame PLACES ELF                   a line each function, most expensive first: its own cycles, those with
//                                             what it calls and inlines, its name
//   tumble_flame PLACES ELF OUT.svg [TITLE]   a flame graph
//
// PLACES is what the plugin wrote with places=; ELF the same firmware with debug information (-g). A frame is as wide
// as its share of the cycles; callers below, what they call or inline above.
#include <cxxabi.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

struct Frame {
    std::uint64_t cycles = 0;  // with those of the frames above
    std::map<std::string, Frame> above;
};

// tumble::KickDriftKick<...>::advance(int) as KickDriftKick::advance.
std::string short_name(const std::string& name) {
    std::string text;
    int depth = 0;
    for (std::size_t i = 0; i < name.size(); ++i) {
        const char c = name[i];
        if (depth == 0 && text.ends_with("operator")) {
            // Its brackets are not those of a list: operator(), operator<=.
            const std::size_t end = name.compare(i, 2, "()") == 0 ? i + 2 : name.find_first_not_of("<>=-", i);
            if (end > i) {
                text += name.substr(i, end - i);
                i = std::min(end, name.size()) - 1;
                continue;
            }
        }
        if (c == '<' || c == '(' || c == '[' || c == '{') ++depth;
        else if (c == '>' || c == ')' || c == ']' || c == '}') --depth;
        else if (depth == 0) text += c;
    }
    std::string before_qualifiers = text.substr(0, text.find(" const"));
    while (before_qualifiers.ends_with(' ')) before_qualifiers.pop_back();  // before [clone .isra.0]
    const std::size_t space = before_qualifiers.rfind(' ');                 // the type of a template's result
    std::string result = space == std::string::npos ? before_qualifiers : before_qualifiers.substr(space + 1);
    for (const std::string drop : {"tumble::", "detail::", "integrators::"})
        for (std::size_t at; (at = result.find(drop)) != std::string::npos;) result.erase(at, drop.size());
    while (result.starts_with("::")) result.erase(0, 2);
    for (std::size_t at; (at = result.find("::::")) != std::string::npos;) result.erase(at, 2);  // around a lambda
    return result.empty() ? name : result;
}

// The name of a linked symbol in C++, without what GCC appends to the copies it makes (.constprop.0).
std::string demangled(const std::string& symbol) {
    const std::string linked = symbol.substr(0, symbol.find('.'));
    int status = 0;
    const std::unique_ptr<char, decltype(&std::free)> text{
        abi::__cxa_demangle(linked.c_str(), nullptr, nullptr, &status), &std::free};
    return status == 0 ? short_name(text.get()) : linked;
}

// The inlined functions at each address, the outermost first, by addr2line.
std::map<std::string, std::vector<std::string>> inlined_at(const std::set<std::string>& addresses,
                                                           const std::string& elf) {
    char list[] = "/tmp/tumble_flame_XXXXXX";
    const int descriptor = mkstemp(list);
    if (descriptor < 0) throw std::runtime_error{"cannot make a temporary file"};
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file{fdopen(descriptor, "w"), &std::fclose};
    for (const std::string& address : addresses) std::fprintf(file.get(), "0x%s\n", address.c_str());
    file.reset();
    const std::string command = "arm-none-eabi-addr2line -a -i -f -C -e '" + elf + "' < " + list;
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe{popen(command.c_str(), "r"), &pclose};
    if (!pipe) throw std::runtime_error{"cannot run arm-none-eabi-addr2line"};
    std::map<std::string, std::vector<std::string>> functions;
    std::vector<std::string>* now = nullptr;
    bool is_function = true;
    std::string line;
    for (int c; (c = std::fgetc(pipe.get())) != EOF;) {
        if (c != '\n') {
            line += static_cast<char>(c);
            continue;
        }
        if (line.starts_with("0x")) {
            now = &functions[line.substr(2)];
            is_function = true;
        } else if (now != nullptr) {
            if (is_function) now->insert(now->begin(), short_name(line));
            is_function = !is_function;
        }
        line.clear();
    }
    std::remove(list);
    if (pclose(pipe.release()) != 0) throw std::runtime_error{"arm-none-eabi-addr2line failed on " + elf};
    return functions;
}

Frame read(const std::string& places, const std::string& elf) {
    std::ifstream in{places};
    if (!in) throw std::runtime_error{"cannot read " + places};
    struct Place {
        std::string path, address;
        std::uint64_t cycles;
    };
    std::vector<Place> all;
    std::set<std::string> addresses;
    for (std::string line; std::getline(in, line);) {
        std::istringstream words{line};
        Place p{};
        if (!(words >> p.path >> p.address >> p.cycles)) throw std::runtime_error{places + ": bad line: " + line};
        addresses.insert(p.address);
        all.push_back(p);
    }
    if (all.empty()) throw std::runtime_error{places + " is empty"};
    const auto functions = inlined_at(addresses, elf);
    Frame root;
    for (const Place& p : all) {
        root.cycles += p.cycles;
        Frame* at = &root;
        const auto go = [&](const std::string& name) {
            at = &at->above[name];
            at->cycles += p.cycles;
        };
        // The last symbol of the path is the outermost of the address's own functions.
        std::istringstream symbols{p.path};
        std::vector<std::string> path;
        for (std::string symbol; std::getline(symbols, symbol, ';');) path.push_back(symbol);
        const auto found = functions.find(p.address);
        const bool known = found != functions.end() && !found->second.empty() && found->second.front() != "??";
        for (std::size_t i = 0; i + (known ? 1 : 0) < path.size(); ++i) go(demangled(path[i]));
        if (known)
            for (const std::string& name : found->second) go(name);
    }
    return root;
}

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) result += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
    return result;
}

int height_of(const Frame& frame) {
    int most = 0;
    for (const auto& [name, above] : frame.above) most = std::max(most, 1 + height_of(above));
    return most;
}

// Cycles of a function, wherever it is called or inlined. Of a function within itself only the outermost frame counts.
struct Sum {
    std::uint64_t own = 0, with_above = 0;
};
void add_functions(const Frame& frame, std::set<std::string>& below, std::map<std::string, Sum>& functions) {
    for (const auto& [name, child] : frame.above) {
        std::uint64_t own = child.cycles;
        for (const auto& [other, above] : child.above) own -= above.cycles;
        Sum& sum = functions[name];
        sum.own += own;
        const bool is_outermost = below.insert(name).second;
        if (is_outermost) sum.with_above += child.cycles;
        add_functions(child, below, functions);
        if (is_outermost) below.erase(name);
    }
}

void print_functions(std::ostream& out, const Frame& root) {
    std::map<std::string, Sum> functions;
    std::set<std::string> below;
    add_functions(root, below, functions);
    std::vector<std::pair<std::string, Sum>> order(functions.begin(), functions.end());
    std::stable_sort(order.begin(), order.end(),
                     [](const auto& a, const auto& b) { return a.second.own > b.second.own; });
    for (const auto& [name, sum] : order) out << sum.own << ' ' << sum.with_above << ' ' << name << '\n';
}

class Drawing {
public:
    Drawing(std::ostream& out, const Frame& root, const std::string& title)
        : out_{out}, total_{static_cast<double>(root.cycles)}, levels_{height_of(root)} {
        const double height = top + levels_ * row + 8;
        out_ << std::fixed << std::setprecision(1) << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << width
             << "\" height=\"" << height << "\" font-family=\"sans-serif\" font-size=\"11\">\n"
             << "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<text x=\"" << margin
             << "\" y=\"20\" font-size=\"14\">" << escaped(title) << "</text>\n";
        draw(root, margin, levels_ - 1);
        out_ << "</svg>\n";
    }

private:
    static constexpr double width = 1200, margin = 8, row = 17, top = 32, letter = 6.2, least = 0.4;

    void draw(const Frame& frame, double x, int level) {
        std::vector<const std::pair<const std::string, Frame>*> order;
        for (const auto& child : frame.above) order.push_back(&child);
        std::stable_sort(order.begin(), order.end(),
                         [](const auto* a, const auto* b) { return a->second.cycles > b->second.cycles; });
        for (const auto* child : order) {
            const double share = static_cast<double>(child->second.cycles) / total_;
            const double wide = share * (width - 2 * margin);
            if (wide >= least) box(child->first, child->second.cycles, share, x, wide, level);
            draw(child->second, x, level - 1);
            x += wide;
        }
    }
    void box(const std::string& name, std::uint64_t cycles, double share, double x, double wide, int level) {
        const double y = top + level * row;
        const auto shade = static_cast<unsigned>(std::hash<std::string>{}(name) % 60);
        out_ << "<g><title>" << escaped(name) << ": " << cycles << " cycles, " << 100 * share << " %</title><rect x=\""
             << x << "\" y=\"" << y << "\" width=\"" << wide << "\" height=\"" << row - 1 << "\" fill=\"rgb("
             << 205 + shade / 2 << ',' << 130 + shade << ",60)\" rx=\"1\"/>";
        const auto letters = static_cast<std::size_t>(std::max(0.0, (wide - 6) / letter));
        if (letters >= 3)
            out_ << "<text x=\"" << x + 3 << "\" y=\"" << y + 12 << "\">"
                 << escaped(name.size() <= letters ? name : name.substr(0, letters - 1) + "…") << "</text>";
        out_ << "</g>\n";
    }

    std::ostream& out_;
    double total_;
    int levels_;
};

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3 || argc > 5) {
        std::cerr << "usage: tumble_flame PLACES ELF [OUT.svg [TITLE]]\n";
        return 2;
    }
    try {
        const Frame root = read(argv[1], argv[2]);
        if (argc == 3) {
            print_functions(std::cout, root);
            if (!std::cout.flush()) throw std::runtime_error{"writing to standard output failed"};
            return 0;
        }
        std::ofstream out{argv[3]};
        Drawing{out, root, argc == 5 ? argv[4] : "estimated cycles, zero wait states"};
        out.close();
        if (!out) throw std::runtime_error{std::string{"cannot write "} + argv[3]};
    } catch (const std::exception& error) {
        std::cerr << "tumble_flame: " << error.what() << '\n';
        return 1;
    }
}

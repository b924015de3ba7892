// `tumble view`: the page with a scene in it, opened in the browser.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <stdexcept>

#include "command/command.hpp"
#include "scene/scene_file.hpp"
#include "tools/files.hpp"
#include "tools/process.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

namespace fs = std::filesystem;

struct ViewOptions {
    std::string scene, output;
};

// The page with one scene more, which it opens first.
std::string page_with(std::string page, const std::string& name, const std::string& toml) {
    constexpr std::string_view before = "<script type=\"text/plain\" class=\"scene\"";
    const std::size_t place = page.find(before);
    if (place == std::string::npos)
        throw std::runtime_error("the page has no place for a scene: `make page` builds it anew");
    std::string lower = toml;
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
    if (lower.find("</script") != std::string::npos)
        throw std::invalid_argument(name + ": has </script, which ends the text of a page, expected none");
    std::string attribute;
    for (const char c : name) attribute += c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
    page.insert(place, std::string(before) + " data-first data-name=\"" + attribute + "\">\n" + toml + "</script>\n");
    return page;
}

int view(const ViewOptions& options) {
    if (options.scene == "/dev/stdin")
        throw std::invalid_argument("scene: got standard input, which can be read only once, expected a file");
    (void)read_scene(options.scene);  // refuses a scene with an error before a browser opens
    const fs::path build = fs::path(TUMBLE_SOURCE_DIR) / "build/page", page = build / "tumble.html";
    if (!fs::exists(page)) throw std::runtime_error("there is no build/page/tumble.html, which `make page` builds");
    check_outputs({{"the scene", options.scene}}, {{"--output", options.output}});
    const fs::path made = options.output.empty() ? build / "view.html" : fs::path(options.output);
    OutputFile file(made, "--output");
    file.stream() << page_with(contents_of(page), fs::path(options.scene).filename(), contents_of(options.scene));
    file.commit();
    if (!options.output.empty()) return done;
    std::cout << made.string() << "\n";
    if (Process browser({"xdg-open", made.string()}); browser.wait() != 0)
        throw std::runtime_error("xdg-open shows no page; open " + made.string() + " in a browser");
    return done;
}

}  // namespace

void add_view(CommandLine& line) {
    const auto options = std::make_shared<ViewOptions>();
    Subcommand command =
        line.add("view", "open the page with a scene in it in the browser", [=] { return view(*options); });
    command.require(options->scene, "scene SCENE.toml", "scene file (TOML) or saved session", input_file());
    command.add(options->output, "-o,--output page.html", "write the page there and open nothing", output_file());
}

}  // namespace tumble::host

#include "pictures/drawing.hpp"

#include <regex>

#include "tools/gnuplot.hpp"
#include "tools/output.hpp"

namespace tumble::bench {
namespace {

// The same drawing in fewer characters: tenths of a pixel, and no groups of nothing.
std::string compact(std::string svg) {
    const auto replace = [&](const char* pattern, const char* by) {
        svg = std::regex_replace(svg, std::regex{pattern}, by);
    };
    replace(R"((\.\d)\d+)", "$1");
    replace(R"(([ ,ML]\d+)\.0\b)", "$1");
    replace(R"([ \t\n]+)", " ");
    replace(R"(rgb\( ?(\d+), ?(\d+), ?(\d+)\))", "rgb($1,$2,$3)");
    replace(R"( (/?>|'|"))", "$1");
    replace(R"(> <)", ">\n<");
    const std::string filters_end = "</filter>\n";
    if (const auto from = svg.find("<filter"), to = svg.rfind(filters_end); to != std::string::npos)
        svg.erase(from, to + filters_end.size() - from);
    replace(R"(<tspan font-size="13.0" dy="6.5"></tspan>)", "");
    // Attributes that most groups share stand once, around them.
    const std::string font = R"( font-family="sans-serif")",
                      usual = R"( fill="none" color="black" stroke="currentColor" stroke-width="1.0")"
                              R"( stroke-linecap="butt" stroke-linejoin="miter")";
    replace(font.c_str(), "");
    replace((usual + ">").c_str(), ">");
    replace(R"(<g id="gnuplot_canvas">)", ("<g" + font + usual + ">").c_str());
    replace(R"(<rect x=)", R"(<rect stroke="none" x=)");
    replace(R"(<g transform[^>]*>\n<text></text>\n</g>\n)", "");
    replace(R"(<g[^>]*>\n</g>\n)", "");
    replace(R"(<g>\n(<path [^>]*/>)\n?</g>)", "$1");
    replace(R"(<title>gnuplot_plot_\d+[a-z]?</title>\n)", "");
    replace(R"( id="gnuplot_plot_\d+[a-z]?")", "");
    replace(R"((\d) L(\d))", "$1 $2");  // what follows a move is a line
    return svg;
}

}  // namespace

void draw(const std::string& script, const std::filesystem::path& svg) {
    host::write_file(svg, compact(host::svg_by_gnuplot(script)));
}

}  // namespace tumble::bench

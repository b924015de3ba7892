#include "tools/gnuplot.hpp"

#include <stdexcept>

#include "tools/process.hpp"

namespace tumble::host {

std::string svg_by_gnuplot(const std::string& script) {
    Process gnuplot({"gnuplot"}, script, Process::Errors::keep);
    std::string svg;
    const int status = gnuplot.wait(&svg);
    if (status == 127) throw std::runtime_error("gnuplot not found; install it (Debian: apt install gnuplot-nox)");
    if (status != 0) throw std::runtime_error("gnuplot failed:\n" + gnuplot.errors());
    if (svg.empty()) throw std::runtime_error("gnuplot has drawn nothing:\n" + gnuplot.errors());
    return svg;
}

}  // namespace tumble::host

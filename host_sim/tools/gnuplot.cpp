#include "tools/gnuplot.hpp"

#include <stdexcept>

#include "tools/process.hpp"

namespace tumble::host {

namespace {

constexpr int not_found = 127;  // exit status of a program that is not there

[[noreturn]] void refuse_without_gnuplot() {
    throw std::runtime_error("gnuplot not found; install it (Debian: apt install gnuplot-nox)");
}

}  // namespace

void require_gnuplot() {
    Process gnuplot({"gnuplot", "--version"}, {}, Process::Errors::keep);
    std::string version;
    if (gnuplot.wait(&version) == not_found) refuse_without_gnuplot();
}

std::string svg_by_gnuplot(const std::string& script) {
    Process gnuplot({"gnuplot"}, script, Process::Errors::keep);
    std::string svg;
    const int status = gnuplot.wait(&svg);
    if (status == not_found) refuse_without_gnuplot();
    if (status != 0) throw std::runtime_error("gnuplot failed:\n" + gnuplot.errors());
    if (svg.empty()) throw std::runtime_error("gnuplot has drawn nothing:\n" + gnuplot.errors());
    return svg;
}

}  // namespace tumble::host

// Work against precision: how wrong each method is on a problem at each step, beside what a simulated second costs on a
// core. Errors are the largest over fixed sample times against an integration in long double that shares no code with
// the kernel, never against a method's own finest run; the host's bits are the cores'. Costs are instructions of a step
// in QEMU, from the committed rows of a scene that does the same work a step. A run that leaves its range, blows up or
// does not converge is a row too.
#include "peers/odeint_top.hpp"
#include "reference.hpp"
#include "rows.hpp"
#include "scene_reader.hpp"
#include "simulation.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <mutex>
#include <thread>

namespace {

using tumble::bench::Row;
namespace fs = std::filesystem;
namespace host = tumble::host;

constexpr int samples = 20;

struct Variant {
    std::string name, numbers;
    bool carry;
};
const std::vector<Variant> variants = {{"q32", "q32", true},
                                       {"q32_plain", "q32", false},
                                       {"f32", "f32", true},
                                       {"f32_plain", "f32", false},
                                       {"f64", "f64", false}};

struct Point {
    int exponent = 0;  // the step is 2^-exponent s
    double error = 0;  // rad
    std::string failure;
};

struct Curve {
    Variant variant;
    std::string method;
    std::vector<Point> points;
};

// The error of the orientation of the first body at a step of 2^-exponent s.
Point measure(host::SceneDescription scene, const std::vector<tumble::bench::Quaternion>& reference,
              const Variant& variant, const std::string& method, int exponent) {
    scene.step = {1, std::int64_t{1} << exponent, 0};
    Point point{exponent, 0, {}};
    const auto simulation = host::make_simulation(scene, method, variant.numbers, variant.carry);
    const std::int64_t total = simulation->steps();
    for (int sample = 1; sample <= samples; ++sample) {
        while (simulation->steps_taken() < total * sample / samples && simulation->troubles().empty())
            simulation->step();
        if (!simulation->troubles().empty()) {
            point.failure = simulation->troubles().front().issue;
            return point;
        }
        const double error = tumble::bench::angle_between_orientations(reference[static_cast<std::size_t>(sample)],
                                                                       simulation->body(0).orientation);
        if (!std::isfinite(error)) {
            point.failure = "not finite";
            return point;
        }
        point.error = std::max(point.error, error);
    }
    return point;
}

// The same of Boost.Odeint in T, on a free top.
template <template <class> class Stepper, class T>
Point measure_peer(const host::SceneDescription& scene, const std::vector<tumble::bench::Quaternion>& reference,
                   int exponent) {
    const auto& body = scene.bodies.at(0);
    const auto three = [](double a, double b, double c) {
        return std::array<T, 3>{static_cast<T>(a), static_cast<T>(b), static_cast<T>(c)};
    };
    tumble::bench::OdeintTop<Stepper, T> top{
        three((*body.inertia)[0], (*body.inertia)[1], (*body.inertia)[2]),
        three(body.angular_velocity[0], body.angular_velocity[1], body.angular_velocity[2]),
        std::ldexp(T(1), -exponent)};
    Point point{exponent, 0, {}};
    const std::int64_t total = std::llround(std::ldexp(scene.duration, exponent));
    std::int64_t step = 0;
    for (int sample = 1; sample <= samples; ++sample) {
        for (; step < total * sample / samples; ++step) top.step();
        const auto& q = top.state();
        const double error = tumble::bench::angle_between_orientations(reference[static_cast<std::size_t>(sample)],
                                                                       {q[0], q[1], q[2], q[3]});
        if (!std::isfinite(error)) {
            point.failure = "not finite";
            return point;
        }
        point.error = std::max(point.error, error);
    }
    return point;
}

const std::map<std::string,
               Point (*)(const host::SceneDescription&, const std::vector<tumble::bench::Quaternion>&, int)>
    peers = {
        {"odeint_euler f32", measure_peer<tumble::bench::OdeintEuler, float>},
        {"odeint_euler f64", measure_peer<tumble::bench::OdeintEuler, double>},
        {"odeint_midpoint f32", measure_peer<tumble::bench::OdeintMidpoint, float>},
        {"odeint_midpoint f64", measure_peer<tumble::bench::OdeintMidpoint, double>},
        {"odeint_rk4 f32", measure_peer<tumble::bench::OdeintRk4, float>},
        {"odeint_rk4 f64", measure_peer<tumble::bench::OdeintRk4, double>},
};

// From the coarsest step that the samples allow to the round-off floor: halving stops when it has not helped three
// times.
void fill(Curve& curve, const host::SceneDescription& scene, const std::vector<tumble::bench::Quaternion>& reference,
          int coarsest, int finest) {
    double best = 1e9;
    int since_best = 0;
    for (int exponent = coarsest; exponent <= finest; ++exponent) {
        const auto peer = peers.find(curve.method + " " + curve.variant.numbers);
        const Point point = peer != peers.end() ? peer->second(scene, reference, exponent)
                                                : measure(scene, reference, curve.variant, curve.method, exponent);
        curve.points.push_back(point);
        if (!point.failure.empty()) continue;
        if (point.error < best * 0.9) {
            best = point.error;
            since_best = 0;
        } else if (++since_best >= 3 && curve.points.size() >= 6) {
            break;
        }
    }
}

void in_parallel(std::size_t count, const auto& work) {
    std::atomic<std::size_t> next{0};
    std::vector<std::thread> workers;
    for (unsigned t = 0; t < std::max(1u, std::thread::hardware_concurrency()); ++t) {
        workers.emplace_back([&] {
            for (std::size_t i; (i = next++) < count;) work(i);
        });
    }
    for (auto& worker : workers) worker.join();
}

// One picture a problem: error against instructions of a simulated second on `core`.
void plot(const fs::path& svg, const std::string& title, const std::string& core, const std::vector<Row>& rows) {
    std::map<std::string, std::string> series;
    for (const Row& row : rows) {
        if (row.at("core") != core || row.contains("failure")) continue;
        const std::string numbers = row.at("numbers").get<std::string>() + (row.at("numbers") == "f64"    ? ""
                                                                            : row.at("carry").get<bool>() ? " carry"
                                                                                                          : " plain");
        if (numbers == "q32 plain" || numbers == "f32 carry") continue;  // the picture stays readable
        char line[64];
        std::snprintf(line, sizeof line, "%.6g %.6g\n", row.at("orientation_error_rad").get<double>(),
                      row.at("insn_per_simulated_second").get<double>());
        series[row.at("integrator").get<std::string>() + ", " + numbers] += line;
    }
    FILE* gnuplot = popen("gnuplot", "w");
    if (gnuplot == nullptr) throw std::runtime_error{"cannot run gnuplot"};
    std::fprintf(gnuplot,
                 "set terminal svg size 1100,760 font 'sans,11'\nset output '%s'\nset title '%s, %s'\nset logscale "
                 "xy\nset format '10^{%%L}'\n"
                 "set xlabel 'orientation error, rad'\nset ylabel 'instructions per simulated second'\nset xrange "
                 "[10:1e-14] reverse\nset grid\nset key outside right\n",
                 svg.c_str(), title.c_str(), core.c_str());
    std::fputs("plot ", gnuplot);
    int index = 0;
    for (const auto& [name, data] : series) {
        const int dash = name.ends_with("q32 carry") ? 1 : name.ends_with("f32 plain") ? 2 : 3;
        std::fprintf(gnuplot, "%s'-' with linespoints dashtype %d pointsize 0.5 title '%s' noenhanced",
                     index++ == 0 ? "" : ", ", dash, name.c_str());
    }
    std::fputc('\n', gnuplot);
    for (const auto& [name, data] : series) std::fprintf(gnuplot, "%se\n", data.c_str());
    if (pclose(gnuplot) != 0) throw std::runtime_error{"gnuplot failed for " + svg.string()};
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"Error against cost of every method on problems of rotation, as rows and pictures."};
    std::vector<fs::path> problems;
    std::vector<fs::path> cost_rows;
    fs::path results = "build/results/work_precision.jsonl", pictures = "build/results";
    std::vector<std::string> cores = {"cortex-m0", "cortex-m3", "cortex-m4f"};
    int coarsest = 3, finest = 13;
    app.add_option("problems", problems, "Scene files of one body")->required();
    app.add_option("--cost", cost_rows, "Rows with insn_per_step of a scene that does the same work a step")
        ->required();
    app.add_option("--cores", cores, "Cores whose cost counts")->delimiter(',');
    app.add_option("--coarsest", coarsest, "Largest step, 2^-N s");
    app.add_option("--finest", finest, "Smallest step, 2^-N s");
    app.add_option("--results", results, "Where the rows go, as JSON lines");
    app.add_option("--pictures", pictures, "Directory of the pictures");
    CLI11_PARSE(app, argc, argv);

    std::map<std::string, double> cost;  // "core numbers carry integrator" to instructions a step
    for (const fs::path& path : cost_rows) {
        for (const Row& row : tumble::bench::read_rows(path)) {
            cost[row.at("core").get<std::string>() + " " + row.at("numbers").get<std::string>() +
                 (row.at("carry").get<bool>() ? " carry " : " ") + row.at("integrator").get<std::string>()] =
                row.at("insn_per_step").get<double>();
        }
    }
    std::vector<Row> rows;
    fs::create_directories(pictures);
    for (const fs::path& path : problems) {
        const host::SceneDescription scene = host::read_scene(path);
        const auto reference = tumble::bench::reference_orientations(scene, samples);
        std::vector<Curve> curves;
        for (const Variant& v : variants)
            for (const auto& integrator : host::integrators())
                if (host::runs_in(integrator, v.numbers)) curves.push_back({v, integrator.name, {}});
        if (scene.forces.empty()) {
            for (const char* name : {"odeint_euler", "odeint_midpoint", "odeint_rk4"}) {
                for (const Variant& v : {Variant{"f32_plain", "f32", false}, Variant{"f64", "f64", false}})
                    curves.push_back({v, name, {}});
            }
        }
        std::mutex mutex;
        std::size_t done = 0;
        in_parallel(curves.size(), [&](std::size_t i) {
            fill(curves[i], scene, reference, coarsest, finest);
            const std::lock_guard lock{mutex};
            std::fprintf(stderr, "\r%s: %zu/%zu ", path.stem().c_str(), ++done, curves.size());
        });
        std::fputc('\n', stderr);
        std::vector<Row> of_problem;
        for (const Curve& curve : curves) {
            for (std::size_t i = 0; i < curve.points.size(); ++i) {
                const Point& p = curve.points[i];
                for (const std::string& core : cores) {
                    const auto found = cost.find(core + " " + curve.variant.numbers +
                                                 (curve.variant.carry ? " carry " : " ") + curve.method);
                    if (found == cost.end()) continue;
                    Row row;
                    row["scene"] = scene.name;
                    row["core"] = core;
                    row["numbers"] = curve.variant.numbers;
                    row["carry"] = curve.variant.carry;
                    row["integrator"] = curve.method;
                    row["step_s"] = std::ldexp(1.0, -p.exponent);
                    row["insn_per_simulated_second"] = found->second * std::ldexp(1.0, p.exponent);
                    if (p.failure.empty()) {
                        row["orientation_error_rad"] = p.error;
                        if (i > 0 && curve.points[i - 1].failure.empty() && p.error > 0) {
                            row["observed_order"] =
                                std::round(std::log2(curve.points[i - 1].error / p.error) * 100) / 100;
                        }
                    } else {
                        row["failure"] = p.failure;
                    }
                    of_problem.push_back(row);
                }
            }
        }
        for (const std::string& core : cores)
            plot(pictures / ("work_precision_" + path.stem().string() + "_" + core + ".svg"), scene.name, core,
                 of_problem);
        rows.insert(rows.end(), of_problem.begin(), of_problem.end());
    }
    tumble::bench::write_rows(results, rows);
    std::printf("%zu rows in %s\n", rows.size(), results.c_str());
    return 0;
} catch (const host::SceneError& error) {
    std::cerr << error.what() << '\n';
    return 2;
} catch (const std::exception& error) {
    std::cerr << "tumble_work_precision: " << error.what() << '\n';
    return 1;
}

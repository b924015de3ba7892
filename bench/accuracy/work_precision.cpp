// Work against precision: the error of each method on a problem at each step, beside the cost of a simulated second on
// a core. An error is the largest at fixed sample times against a formula or an integration in long double. Neither
// shares code with the kernel, and no method is compared with its own finest run. The host's bits are the cores' bits.
// Costs are cycles and instructions of a step in QEMU, from rows of the problem or of a scene with the same work a
// step. A run that leaves its range, blows up or does not converge is a row too.
#include "accuracy/closed_form.hpp"
#include "accuracy/reference.hpp"
#include "peers/odeint.hpp"
#include "rows/rows.hpp"
#include "rows/variants.hpp"
#include "scene/data.hpp"
#include "tools/text.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

namespace {

using tumble::bench::Row;
using tumble::bench::Variant;
namespace fs = std::filesystem;
namespace host = tumble::host;

// The true motion at multiples of the interval. Every step of 2^-n s up to the interval divides them.
struct Truth {
    double interval = 0;  // s, a power of two
    int samples = 0;
    std::vector<tumble::bench::Quaternion> orientations;  // samples + 1; empty if positions are not
    std::vector<tumble::bench::Position> positions;
    double blown_up = 0;  // rad or m: a run with a larger error has blown up

    [[nodiscard]] const char* key() const { return positions.empty() ? "orientation_error_rad" : "position_error_m"; }
    [[nodiscard]] double error(int sample, const host::BodySnapshot& body) const {
        const auto i = static_cast<std::size_t>(sample);
        if (positions.empty()) return tumble::bench::angle_between_orientations(orientations[i], body.orientation);
        return static_cast<double>(std::hypot(body.position[0] - positions[i][0], body.position[1] - positions[i][1],
                                              body.position[2] - positions[i][2]));
    }
};

Truth truth_of(const host::SceneDescription& scene) {
    Truth truth;
    truth.interval = std::exp2(std::floor(std::log2(scene.duration / 16)));
    truth.samples = static_cast<int>(std::lround(scene.duration / truth.interval));
    if (truth.samples * truth.interval != scene.duration)
        throw std::invalid_argument{scene.path + ": the duration is not a multiple of " +
                                    std::to_string(truth.interval) + " s, the time between samples"};
    if (const auto positions = tumble::bench::closed_form(scene, truth.interval, truth.samples))
        truth.positions = *positions;
    else truth.orientations = tumble::bench::reference_orientations(scene, truth.samples);
    // Orientations are at most half a turn apart. Positions may differ by a hundred times the extent of the motion.
    truth.blown_up = 4;
    for (const auto& x : truth.positions)
        truth.blown_up = std::max(truth.blown_up, 100 * static_cast<double>(std::hypot(x[0], x[1], x[2])));
    return truth;
}

// The moving body: of Kepler's two, the second.
int moving_body(const host::SceneDescription& scene) {
    int index = 0;
    while (scene.bodies.at(static_cast<std::size_t>(index)).fixed) ++index;
    return index;
}

struct Point {
    int exponent = 0;  // the step is 2^-exponent s
    double error = 0;  // rad or m
    std::string failure;
};

struct Curve {
    Variant variant;
    std::string method;
    std::vector<Point> points;
};

// The largest error at the samples. advance(sample) runs to a sample and returns its failure, if any; snapshot()
// returns the moving body there.
template <class Advance, class Snapshot>
Point largest_error(const Truth& truth, int exponent, Advance&& advance, Snapshot&& snapshot) {
    Point point{exponent, 0, {}};
    for (int sample = 1; sample <= truth.samples; ++sample) {
        point.failure = advance(sample);
        if (!point.failure.empty()) return point;
        const double error = truth.error(sample, snapshot());
        if (!(error < truth.blown_up)) {
            point.failure = "blown up";
            return point;
        }
        point.error = std::max(point.error, error);
    }
    return point;
}

// The error at a step of 2^-exponent s.
Point measure(host::SceneDescription scene, const Truth& truth, const Variant& variant, const std::string& method,
              int exponent) {
    scene.step = {1, std::int64_t{1} << exponent, 0};
    const auto simulation = host::make_simulation(scene, method, variant.numbers, variant.carry);
    const int body = moving_body(scene);
    const std::int64_t total = simulation->steps();
    const auto advance = [&](int sample) -> std::string {
        while (simulation->steps_taken() < total * sample / truth.samples && simulation->troubles().empty())
            simulation->step();
        if (!simulation->troubles().empty()) return simulation->troubles().front().issue;
        // Such a step costs as much as its parts, and no row has its cost.
        return simulation->body(body).parts > 1 ? "steps in parts" : "";
    };
    return largest_error(truth, exponent, advance, [&] { return simulation->body(body); });
}

// The error of Boost.Odeint at that step.
template <template <class> class Stepper, class Equations>
Point measure_peer(const host::SceneDescription& scene, const Truth& truth, int exponent) {
    using T = typename Equations::T;
    tumble::bench::OdeintRun<Stepper, Equations> run{host::build_scene(scene), std::ldexp(T(1), -exponent)};
    const std::int64_t total = std::llround(std::ldexp(scene.duration, exponent));
    std::int64_t step = 0;
    const auto advance = [&](int sample) -> std::string {
        for (; step < total * sample / truth.samples; ++step) run.step();
        return {};
    };
    const auto snapshot = [&] {
        const auto& s = run.state();
        host::BodySnapshot body;
        if constexpr (Equations::has_orientation) body.orientation = {s[0], s[1], s[2], s[3]};
        else body.position = {s[0], s[1], s[2]};
        return body;
    };
    return largest_error(truth, exponent, advance, snapshot);
}
// Calls f with the equations that the scene asks for, in T.
template <class T>
auto with_equations(const host::SceneDescription& scene, const Truth& truth, auto&& f) {
    using namespace tumble::bench;
    if (!truth.positions.empty()) return f.template operator()<PointEquations<T>>();
    if (!scene.forces.empty()) return f.template operator()<TopEquations<T, true>>();
    return f.template operator()<TopEquations<T, false>>();
}

struct Peer {
    Point (*measure)(const host::SceneDescription&, const Truth&, int exponent);
    // The hash of the state after some steps of the scene's own length.
    std::uint64_t (*hash)(const host::SceneDescription&, const Truth&, std::int64_t steps);
};
template <template <class> class Stepper, class T>
Peer peer_of() {
    return {[](const host::SceneDescription& scene, const Truth& truth, int exponent) {
                return with_equations<T>(scene, truth, [&]<class Equations>() {
                    return measure_peer<Stepper, Equations>(scene, truth, exponent);
                });
            },
            [](const host::SceneDescription& scene, const Truth& truth, std::int64_t steps) {
                return with_equations<T>(scene, truth, [&]<class Equations>() {
                    tumble::bench::OdeintRun<Stepper, Equations> run{host::build_scene(scene),
                                                                     static_cast<T>(scene.step.seconds())};
                    for (std::int64_t i = 0; i < steps; ++i) run.step();
                    return run.hash();
                });
            }};
}

const std::map<std::string, Peer> peers = {
    {"odeint_euler f32", peer_of<tumble::bench::OdeintEuler, float>()},
    {"odeint_euler f64", peer_of<tumble::bench::OdeintEuler, double>()},
    {"odeint_midpoint f32", peer_of<tumble::bench::OdeintMidpoint, float>()},
    {"odeint_midpoint f64", peer_of<tumble::bench::OdeintMidpoint, double>()},
    {"odeint_rk4 f32", peer_of<tumble::bench::OdeintRk4, float>()},
    {"odeint_rk4 f64", peer_of<tumble::bench::OdeintRk4, double>()},
};

// Throws std::runtime_error if a peer's bits on a core differ from the host's: its cost would be that of another
// answer.
void check_answer(const host::SceneDescription& scene, const Truth& truth, const Row& row) {
    const std::string name = row.at("integrator").get<std::string>() + " " + row.at("numbers").get<std::string>();
    const auto peer = peers.find(name);
    if (peer == peers.end() || row.at("scene") != scene.name) return;
    const std::string expected = host::hex(peer->second.hash(scene, truth, row.at("steps")));
    if (row.at("state_hash") != expected)
        throw std::runtime_error{name + " on " + row.at("core").get<std::string>() + ", " + scene.name +
                                 ": its state hash is " + row.at("state_hash").get<std::string>() + ", the host's " +
                                 expected};
}

// From the coarsest step that the samples allow down to the rounding floor. Halving stops after three steps without
// gain.
void fill(Curve& curve, const host::SceneDescription& scene, const Truth& truth, int coarsest, int finest) {
    double best = 1e9;
    int since_best = 0;
    for (int exponent = coarsest; exponent <= finest; ++exponent) {
        const auto peer = peers.find(curve.method + " " + curve.variant.numbers);
        const Point point = peer != peers.end() ? peer->second.measure(scene, truth, exponent)
                                                : measure(scene, truth, curve.variant, curve.method, exponent);
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

// The rows of the cost of a step, by problem, core, number system and method.
class Costs {
public:
    void read(const fs::path& path, bool of_problem) {
        for (const Row& row : tumble::bench::read_rows(path)) {
            measured_.push_back(row);
            rows_[key(of_problem ? row.at("scene").get<std::string>() : "", row.at("core"), row.at("numbers"),
                      row.at("carry"), row.at("integrator"))] = row;
        }
    }
    [[nodiscard]] const std::vector<Row>& measured() const { return measured_; }
    // Of the problem, or else of the scene with the same work a step; null if there is none.
    [[nodiscard]] const Row* find(const std::string& problem, const Curve& curve, const std::string& core) const {
        for (const std::string& name : {problem, std::string{}}) {
            const auto found = rows_.find(key(name, core, curve.variant.numbers, curve.variant.carry, curve.method));
            if (found != rows_.end()) return &found->second;
        }
        return nullptr;
    }

private:
    [[nodiscard]] static std::string key(const std::string& problem, const std::string& core,
                                         const std::string& numbers, bool carry, const std::string& method) {
        return problem + " " + core + " " + numbers + (carry ? " carry " : " ") + method;
    }

    std::vector<Row> measured_;
    std::map<std::string, Row> rows_;
};

// The methods of this kernel and of the peer in their number systems, of which a core has a cost.
std::vector<Curve> curves_of(const host::SceneDescription& scene, const std::vector<std::string>& cores,
                             const Costs& costs) {
    std::vector<Curve> curves;
    for (const Variant& v : tumble::bench::variants)
        for (const auto& integrator : host::integrators())
            if (host::runs_in(integrator, v.numbers)) curves.push_back({v, integrator.name, {}});
    if (scene.planes.empty())
        for (const char* name : {"odeint_euler", "odeint_midpoint", "odeint_rk4"})
            for (const Variant& v : {Variant{"f32_plain", "f32", false}, Variant{"f64", "f64", false}})
                curves.push_back({v, name, {}});
    std::erase_if(curves, [&](const Curve& curve) {
        return std::none_of(cores.begin(), cores.end(),
                            [&](const auto& core) { return costs.find(scene.name, curve, core); });
    });
    if (curves.empty()) throw std::runtime_error{"no cost of any method on " + scene.name};
    return curves;
}

// The row of a point of a curve on a core whose step costs `step`.
Row row_of(const std::string& scene, const Truth& truth, const Curve& curve, std::size_t point, const std::string& core,
           const Row& step) {
    const Point& p = curve.points[point];
    Row row = tumble::bench::row_of(scene, core, curve.variant.numbers, curve.variant.carry, curve.method,
                                    std::ldexp(1.0, -p.exponent));
    for (const auto& [of_second, of_step] : {std::pair{"insn_per_simulated_second", "insn_per_step"},
                                             {"cycles_per_simulated_second_min", "cycles_per_step_min"},
                                             {"cycles_per_simulated_second_est", "cycles_per_step_est"},
                                             {"cycles_per_simulated_second_max", "cycles_per_step_max"}})
        if (step.contains(of_step)) row[of_second] = step.at(of_step).get<double>() * std::ldexp(1.0, p.exponent);
    if (step.contains("cycles_worst_step_max")) row["cycles_worst_step_max"] = step.at("cycles_worst_step_max");
    if (!p.failure.empty()) {
        row["failure"] = p.failure;
        return row;
    }
    row[truth.key()] = p.error;
    if (point > 0 && curve.points[point - 1].failure.empty() && p.error > 0)
        row["observed_order"] = tumble::bench::observed_order(curve.points[point - 1].error, p.error);
    return row;
}

}  // namespace

int main(int argc, char** argv) try {
    tumble::host::tell_lost_output();
    CLI::App app{"Error against cost of every method on problems with a known solution, as rows."};
    std::vector<fs::path> problems;
    std::vector<fs::path> alike, own;
    fs::path results = "build/results/work_precision.jsonl";
    std::vector<std::string> cores;
    for (const host::Core& core : host::cores())
        if (core.has_cycles() && core.set == "quick") cores.push_back(core.name);
    cores.emplace_back(host::StepFirmware::host);
    int coarsest = 3, finest = 13;
    app.add_option("problems", problems, "Scene files")->required();
    app.add_option("--cost", alike, "Rows of a scene with the same work a step as all problems");
    app.add_option("--cost-of-problem", own, "Rows of the problems themselves, found by their names");
    app.add_option("--cores", cores, "Cores of the rows")->delimiter(',');
    app.add_option("--coarsest", coarsest, "Largest step, 2^-N s; at most the time between samples")
        ->check(CLI::Range(0, 30));
    app.add_option("--finest", finest, "Smallest step, 2^-N s")->check(CLI::Range(0, 30));
    app.add_option("--results", results, "Where the rows go, as JSON lines");
    CLI11_PARSE(app, argc, argv);
    for (const auto& [argument, files] :
         {std::pair{"problems", &problems}, {"--cost", &alike}, {"--cost-of-problem", &own}})
        host::check_outputs(tumble::bench::files_of(argument, *files), {{"--results", results}});
    host::OutputFile rows_file = tumble::bench::rows_file(results);

    Costs costs;
    for (const fs::path& path : alike) costs.read(path, false);
    for (const fs::path& path : own) costs.read(path, true);

    std::vector<Row> rows;
    for (const fs::path& path : problems) {
        const host::SceneDescription scene = host::read_scene(path);
        const Truth truth = truth_of(scene);
        for (const Row& row : costs.measured()) check_answer(scene, truth, row);
        std::vector<Curve> curves = curves_of(scene, cores, costs);
        const int first = std::max(coarsest, static_cast<int>(std::ceil(-std::log2(truth.interval))));
        tumble::bench::in_parallel_counted(path.stem().string(), curves.size(),
                                           [&](std::size_t i) { fill(curves[i], scene, truth, first, finest); });
        for (const Curve& curve : curves)
            for (std::size_t i = 0; i < curve.points.size(); ++i)
                for (const std::string& core : cores)
                    if (const Row* step = costs.find(scene.name, curve, core))
                        rows.push_back(row_of(scene.name, truth, curve, i, core, *step));
    }
    tumble::bench::write_rows(rows_file, rows);
    std::printf("%zu rows in %s\n", rows.size(), results.c_str());
    return 0;
} catch (...) { return tumble::bench::report_failure("tumble_work_precision"); }

// What a method does to the constants of a motion in a long run: the largest drift of energy, momentum and the
// quaternion's norm within a million steps, for every method and number system. On the host alone, whose bits are the
// cores'. A run that leaves its range, blows up or does not converge is a row too, with the step at which it did.
#include "rows.hpp"
#include "variants.hpp"

#include "truth/accuracy.hpp"

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdio>

namespace {

using tumble::bench::Row;
using tumble::bench::Variant;
namespace fs = std::filesystem;
namespace host = tumble::host;

using namespace tumble::reference;

// SI units; angular momentum about the centre of mass.
struct Constants {
    Number energy, body_momentum_norm, quaternion_norm;
    Vector world_momentum;
};

// Of the scene's one body under forces that are constant in the world's frame and have a potential for that reason.
Constants constants_of(const host::SceneDescription& scene, const host::Simulation& simulation) {
    const Motion body = host::motion_of(simulation.body(0));
    const auto& inertia = *scene.bodies.at(0).inertia;
    const Number norm_of_q = std::sqrt(body.q.norm2());
    const Rotation unit = body.q * (1 / norm_of_q);
    const Vector momentum = times(vector_of(inertia), body.w);
    Constants c{simulation.energy().total(), norm(momentum), norm_of_q, unit.rotate(momentum)};
    for (const auto& force : scene.forces)
        c.energy -= dot(vector_of(force.force), body.x + unit.rotate(vector_of(force.point)));
    return c;
}

// Throws std::invalid_argument for scenes whose constants this program does not know; the forces of the rest last.
host::SceneDescription checked(host::SceneDescription scene) {
    const auto& body = scene.bodies.at(0);
    if (scene.bodies.size() != 1 || !body.inertia || !body.inertia_is_diagonal || !scene.springs.empty() ||
        !scene.impulses.empty() || !scene.planes.empty() || scene.linear_drag > 0 || scene.angular_drag > 0)
        throw std::invalid_argument{scene.path + ": long runs are of one body with a diagonal inertia under forces"};
    for (auto& force : scene.forces) {
        if (force.from > 0 || force.until < scene.duration || force.frame != tumble::Frame::world ||
            force.torque != host::Triple{})
            throw std::invalid_argument{scene.path + ": forces are of the world's frame and last for the whole run"};
    }
    return scene;
}

struct Drift {
    Number energy = 0, energy_early = 0, body_momentum = 0, world_momentum = 0, vertical_momentum = 0, quaternion = 0;
};

// A row without its names.
Row measure(const host::SceneDescription& scene, const Variant& variant, const std::string& method, std::int64_t steps,
            std::int64_t every) {
    const auto simulation = host::make_simulation(scene, method, variant.numbers, variant.carry);
    const Constants start = constants_of(scene, *simulation);
    const Number size = norm(start.world_momentum);
    Drift drift;
    std::string failure;
    while (simulation->steps_taken() < steps && failure.empty()) {
        for (std::int64_t i = 0; i < every && simulation->troubles().empty(); ++i) simulation->step();
        if (!simulation->troubles().empty()) {
            failure = simulation->troubles().front().issue;
            break;
        }
        const Constants now = constants_of(scene, *simulation);
        // NaN is the largest of all.
        const auto note = [](Number& largest, Number error) {
            if (!(std::abs(error) <= largest)) largest = std::abs(error);
        };
        note(drift.energy, now.energy / start.energy - 1);
        if (simulation->steps_taken() <= steps / 10) drift.energy_early = drift.energy;
        note(drift.body_momentum, now.body_momentum_norm / start.body_momentum_norm - 1);
        note(drift.world_momentum, norm(now.world_momentum - start.world_momentum) / size);
        note(drift.vertical_momentum, (now.world_momentum.z - start.world_momentum.z) / size);
        note(drift.quaternion, now.quaternion_norm - 1);
        if (!std::isfinite(now.energy) || !std::isfinite(now.quaternion_norm) ||
            now.energy > 1e6L * std::abs(start.energy))
            failure = "energy grows without end";
    }
    Row row;
    if (!failure.empty()) {
        row["failure"] = failure;
        row["failure_step"] = simulation->steps_taken();
        return row;
    }
    const auto put = [&](const char* key, Number value) { row[key] = static_cast<double>(value); };
    put("energy_max_relative_drift", drift.energy);
    put("energy_max_relative_drift_first_tenth", drift.energy_early);
    if (scene.forces.empty()) {
        put("body_momentum_max_relative_drift", drift.body_momentum);
        put("world_momentum_max_relative_drift", drift.world_momentum);
    } else {
        put("vertical_momentum_max_relative_drift", drift.vertical_momentum);
    }
    put("quaternion_norm_max_drift", drift.quaternion);
    return row;
}

}  // namespace

int main(int argc, char** argv) try {
    tumble::host::tell_lost_output();
    CLI::App app{"Drift of what a motion conserves within many steps, for every method and number system, as rows."};
    std::vector<fs::path> problems;
    fs::path results = "build/results/long_run.jsonl";
    std::int64_t steps = 1000000, every = 50;
    app.add_option("problems", problems, "Scene files of one body; their step is used, their duration is not")
        ->required();
    app.add_option("--steps", steps, "Steps of each run");
    app.add_option("--every", every, "Steps between two looks");
    app.add_option("--results", results, "Where the rows go, as JSON lines");
    CLI11_PARSE(app, argc, argv);
    host::check_outputs(tumble::bench::files_of("problems", problems), {{"--results", results}});
    host::OutputFile rows_file = tumble::bench::rows_file(results);

    std::vector<Row> rows;
    for (const fs::path& path : problems) {
        host::SceneDescription scene = checked(host::read_scene(path));
        scene.duration = static_cast<double>(steps) * scene.step.seconds();
        for (auto& force : scene.forces) force.until = 2 * scene.duration;
        struct Job {
            Variant variant;
            std::string method;
            Row row;
        };
        std::vector<Job> jobs;
        for (const auto& integrator : host::integrators())
            for (const auto& v : tumble::bench::variants)
                if (host::runs_in(integrator, v.numbers)) jobs.push_back({v, integrator.name, {}});
        tumble::bench::in_parallel_counted(path.stem().string(), jobs.size(), [&](std::size_t i) {
            jobs[i].row = measure(scene, jobs[i].variant, jobs[i].method, steps, every);
        });
        for (const Job& job : jobs) {
            Row row;
            row["scene"] = scene.name;
            row["core"] = "host";
            row["numbers"] = job.variant.numbers;
            row["carry"] = job.variant.carry;
            row["integrator"] = job.method;
            row["step_s"] = scene.step.seconds();
            row["steps"] = steps;
            row.update(job.row);
            rows.push_back(row);
        }
    }
    tumble::bench::write_rows(rows_file, rows);
    std::printf("%zu rows in %s\n", rows.size(), results.c_str());
    return 0;
} catch (...) { return tumble::bench::report_failure("tumble_long_run"); }

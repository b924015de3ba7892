// Drift of conserved quantities in long runs. With problems as arguments: the largest drift of energy, momentum and the
// quaternion's norm within a million steps, for every method and number system. Without: the long runs of the list
// below, each with its errors over time, which are checked against the bounds of long_run_rows.hpp. All runs are on the
// host, whose bits are the cores' bits. A run that leaves its range, blows up or does not converge is a row too, with
// the step of its failure.
#include "pictures/drawing.hpp"
#include "pictures/long_run_rows.hpp"
#include "rows/variants.hpp"

#include "truth/smooth_motion.hpp"
#include "verdict/accuracy.hpp"

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdio>
#include <mutex>
#include <set>

namespace {

using tumble::bench::Row;
using tumble::bench::Variant;
namespace fs = std::filesystem;
namespace host = tumble::host;

using namespace tumble::reference;

// The long runs: splittings, whose errors are bounded over many steps, and others to compare. The cost of a step limits
// the methods and number systems, and the number of steps of bodies in contact.
struct LongRuns {
    const char* scene;
    std::int64_t steps;
    std::set<std::string> integrators, variants;
};
const std::set<std::string> usual{"q32", "f32_plain", "f64"}, with_plain{"q32", "q32_plain", "f32_plain", "f64"},
    of_a_free_top{"rk4", "verlet", "strang", "suzuki4", "pdmv4", "pdmv6", "pdmv8", "pdmv10"};
constexpr std::int64_t ten_million = 10000000, between_looks = 53;  // steps of a run, and between two measurements
const std::vector<LongRuns> long_runs{
    {"bench/problems/generic_top.toml", ten_million, of_a_free_top, usual},
    {"bench/problems/heavy_top.toml", ten_million, {"rk4", "verlet", "suzuki4", "pdmv6"}, usual},
    {"bench/problems/kepler.toml", ten_million, {"verlet", "suzuki4"}, usual},
    {"bench/long_runs/elastic_box.toml", ten_million, {"verlet"}, with_plain},
    {"bench/long_runs/elastic_box.toml", ten_million, {"semi_implicit_euler", "rk4"}, {"q32"}},
    {"bench/long_runs/ten_boxes_asleep.toml", ten_million, {"verlet"}, with_plain},
    {"bench/long_runs/ten_boxes_asleep.toml", ten_million, {"semi_implicit_euler", "rk4"}, {"q32"}},
    {"host_sim/scenes/contacts/stack.toml", 50000, {"semi_implicit_euler", "rk4"}, {"q32", "f64"}},
    {"host_sim/scenes/contacts/stack.toml", 50000, {"verlet"}, {"q32_plain", "f32_plain"}},
    {"host_sim/scenes/contacts/stack.toml", 1000000, {"verlet"}, {"q32", "f64"}},
};

// SI units; angular momentum about the origin, of the bodies that are not fixed.
struct Constants {
    Number energy, body_momentum_norm, quaternion_norm;
    Vector world_momentum;
};

// Under forces that are constant in the world frame and thus have a potential. Norms are of the first body.
Constants constants_of(const host::SceneDescription& scene, const host::Simulation& simulation) {
    Constants c{simulation.energy().total(), 0, 0, {}};
    for (int b = 0; b < simulation.body_count(); ++b) {
        const host::BodyDescription& description = scene.body(b);
        const Motion body = host::motion_of(simulation.body(b));
        const Number norm_of_q = std::sqrt(body.q.norm2());
        const Rotation unit = body.q * (1 / norm_of_q);
        const Vector momentum = description.inertia ? times(vector_of(*description.inertia), body.w) : Vector{};
        if (b == 0) {
            c.body_momentum_norm = norm(momentum);
            c.quaternion_norm = norm_of_q;
        }
        if (!description.fixed)
            c.world_momentum = c.world_momentum + unit.rotate(momentum) +
                               cross(body.x, body.v * static_cast<Number>(description.mass.value_or(0)));
        for (const auto& force : scene.forces)
            if (force.body == b) c.energy -= dot(vector_of(force.force), body.x + unit.rotate(vector_of(force.point)));
    }
    return c;
}

// The largest penetration of a body into a plane or another body, m, at least 0. The penetration of two boxes is the
// least along the normals of their faces: for boxes that stand on each other that is the depth.
Number penetration_of(const host::SceneDescription& scene, const host::Simulation& simulation) {
    Number deepest = 0;
    std::vector<Motion> now;
    for (int b = 0; b < simulation.body_count(); ++b) {
        const host::BodyDescription& body = scene.body(b);
        now.push_back(host::motion_of(simulation.body(b)));
        now.back().q = now.back().q.normalized();
        const Motion& motion = now.back();
        for (const auto& plane : scene.planes) {
            const Vector normal = vector_of(plane.normal);
            const Vector n = normal * (1 / norm(normal));
            const Number height = dot(n, motion.x) + static_cast<Number>(plane.offset);
            deepest = std::max(deepest, host::half_extent(body, motion.q, n) - height);
        }
        for (int a = 0; a < b; ++a) {
            const Motion& other = now[static_cast<std::size_t>(a)];
            const Vector apart = motion.x - other.x;
            const auto depth_along = [&](const Vector& n) {
                return host::half_extent(body, motion.q, n) + host::half_extent(scene.body(a), other.q, n) -
                       std::abs(dot(apart, n));
            };
            Number depth = depth_along(apart * (1 / norm(apart)));
            if (body.shape.kind == tumble::ShapeKind::box) {
                depth = std::numeric_limits<Number>::infinity();
                for (const Rotation& q : {motion.q, other.q})
                    for (const Vector axis : {Vector{1, 0, 0}, Vector{0, 1, 0}, Vector{0, 0, 1}})
                        depth = std::min(depth, depth_along(q.rotate(axis)));
            }
            deepest = std::max(deepest, depth);
        }
    }
    return deepest;
}

// Throws std::invalid_argument for scenes whose conserved quantities this program does not know. Forces of other scenes
// last for `steps`.
host::SceneDescription checked(host::SceneDescription scene, std::int64_t steps) {
    const auto refuse = [&](const char* expected) {
        throw std::invalid_argument{scene.path + ": a long run needs " + expected};
    };
    if (!scene.springs.empty() || !scene.impulses.empty() || scene.linear_drag > 0 || scene.angular_drag > 0)
        refuse("bodies without springs, impulses and drag");
    std::set<tumble::ShapeKind> shapes;
    for (const auto& body : scene.bodies) {
        shapes.insert(body.shape.kind);
        if (scene.planes.empty() && !body.is_point_mass() && !(body.inertia && body.inertia_is_diagonal))
            refuse("bodies with a diagonal inertia where no plane pushes them");
    }
    const auto& shape = scene.bodies.at(0).shape.kind;
    if (!scene.planes.empty() &&
        (shapes.size() != 1 || (shape != tumble::ShapeKind::sphere && shape != tumble::ShapeKind::box)))
        refuse("spheres or boxes where there are planes");
    for (auto& force : scene.forces) {
        if (force.from > 0 || force.until < scene.duration || force.frame != tumble::Frame::world ||
            force.torque != host::Triple{})
            refuse("forces of the world's frame that last for the whole run");
    }
    scene.duration = static_cast<double>(steps) * scene.step.seconds();
    for (auto& force : scene.forces) force.until = 2 * scene.duration;
    return scene;
}

// Three significant digits.
double rounded(Number value) { return std::strtod(tumble::bench::text("%.2Le", value).c_str(), nullptr); }

// Why a run has failed; "" where it has not.
std::string failure_of(const host::Simulation& simulation, const Constants& now, const Constants& start) {
    if (!simulation.troubles().empty()) return simulation.troubles().front().issue;
    const bool has_grown =
        !std::isfinite(now.energy) || !std::isfinite(now.quaternion_norm) || now.energy > 1e6L * std::abs(start.energy);
    return has_grown ? "energy grows without end" : "";
}
Row failed(const host::Simulation& simulation, const std::string& failure) {
    return {{"failure", failure}, {"failure_step", simulation.steps_taken()}};
}

// The errors of one run over time, with the keys of long_run_rows.hpp. Calls `counted(steps)` from time to time.
Row errors_over_time(const host::SceneDescription& scene, const Variant& variant, const std::string& method,
                     std::int64_t steps, const auto& counted) {
    const auto simulation = host::make_simulation(scene, method, variant.numbers, variant.carry);
    const Constants start = constants_of(scene, *simulation);
    const bool in_contact = !scene.planes.empty(),
               may_move = !in_contact || norm(host::motion_of(simulation->body(0)).v) > 0;
    std::vector<Vector> places;
    for (int b = 0; b < simulation->body_count(); ++b) places.push_back(host::motion_of(simulation->body(b)).x);
    struct Largest {
        Number energy = 0, momentum = 0, penetration = 0;
    } span;
    Number first_tenth = 0, last_tenth = 0, shift = 0;
    Row row, at = Row::array(), energy = Row::array(), momentum = Row::array(), penetration = Row::array();
    double end = between_looks;
    while (simulation->steps_taken() < steps) {
        const std::int64_t before = simulation->steps_taken(), next = std::min(before + between_looks, steps);
        while (simulation->steps_taken() < next && simulation->troubles().empty()) simulation->step();
        counted(simulation->steps_taken() - before);
        const Constants now = constants_of(scene, *simulation);
        if (const std::string failure = failure_of(*simulation, now, start); !failure.empty())
            return failed(*simulation, failure);
        const Number energy_error = std::abs(now.energy / start.energy - 1);
        span.energy = std::max(span.energy, energy_error);
        if (next <= steps / 10) first_tenth = std::max(first_tenth, energy_error);
        if (next > steps - steps / 10) last_tenth = std::max(last_tenth, energy_error);
        const Vector change = now.world_momentum - start.world_momentum;
        span.momentum = std::max(span.momentum, (scene.forces.empty() ? norm(change) : std::abs(change.z)) /
                                                    norm(start.world_momentum));
        if (in_contact) span.penetration = std::max(span.penetration, penetration_of(scene, *simulation));
        if (!may_move)
            for (std::size_t b = 0; b < places.size(); ++b)
                shift = std::max(shift, norm(host::motion_of(simulation->body(static_cast<int>(b))).x - places[b]));
        if (static_cast<double>(next) < end && next < steps) continue;
        end = std::max(end, static_cast<double>(next)) * std::sqrt(2.0);
        at.push_back(next);
        energy.push_back(rounded(span.energy));
        if (!in_contact) momentum.push_back(rounded(span.momentum));
        if (in_contact) penetration.push_back(rounded(span.penetration));
        span = {};
    }
    row["energy_first_tenth"] = rounded(first_tenth);
    row["energy_last_tenth"] = rounded(last_tenth);
    if (!may_move) row["shift_m"] = rounded(shift);
    row["at"] = at;
    row["energy"] = energy;
    if (!in_contact) row["momentum"] = momentum;
    if (in_contact) row["penetration_m"] = penetration;
    return row;
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
    while (simulation->steps_taken() < steps) {
        for (std::int64_t i = 0; i < every && simulation->troubles().empty(); ++i) simulation->step();
        const Constants now = constants_of(scene, *simulation);
        if (const std::string failure = failure_of(*simulation, now, start); !failure.empty())
            return failed(*simulation, failure);
        // NaN counts as the largest.
        const auto note = [](Number& largest, Number error) {
            if (!(std::abs(error) <= largest)) largest = std::abs(error);
        };
        note(drift.energy, now.energy / start.energy - 1);
        if (simulation->steps_taken() <= steps / 10) drift.energy_early = drift.energy;
        note(drift.body_momentum, now.body_momentum_norm / start.body_momentum_norm - 1);
        note(drift.world_momentum, norm(now.world_momentum - start.world_momentum) / size);
        note(drift.vertical_momentum, (now.world_momentum.z - start.world_momentum.z) / size);
        note(drift.quaternion, now.quaternion_norm - 1);
    }
    Row row;
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

Row names_of(const host::SceneDescription& scene, const Variant& variant, const std::string& method,
             std::int64_t steps) {
    Row row = tumble::bench::row_of(scene.name, "host", variant.numbers, variant.carry, method, scene.step.seconds());
    row["steps"] = steps;
    return row;
}

// Rows of problems with one body, for every method and number system.
std::vector<Row> summaries(const std::vector<fs::path>& problems, std::int64_t steps, std::int64_t every) {
    std::vector<Row> rows;
    for (const fs::path& path : problems) {
        const host::SceneDescription scene = checked(host::read_scene(path), steps);
        if (scene.bodies.size() != 1 || !scene.planes.empty() || scene.bodies[0].is_point_mass())
            throw std::invalid_argument{scene.path + ": expected one body with a diagonal inertia and no plane"};
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
            rows.push_back(names_of(scene, job.variant, job.method, steps));
            rows.back().update(job.row);
        }
    }
    return rows;
}

// A long run of the list. Its row starts without results.
struct Job {
    host::SceneDescription scene;
    Variant variant;
    std::string method;
    std::int64_t steps, cost;
    Row row;
};
std::vector<Job> jobs_of_the_list(std::int64_t most_steps, const std::string& only) {
    std::vector<Job> jobs;
    for (const LongRuns& runs : long_runs) {
        if (!only.empty() && fs::path{runs.scene}.stem() != only) continue;
        const std::int64_t steps = std::min(runs.steps, most_steps);
        const auto scene = checked(host::read_scene(fs::path{TUMBLE_SOURCE_DIR} / runs.scene), steps);
        // Rough cost of a step in steps of a free body: loads cost about ten, and each box of a stack fifty.
        const bool rests = !scene.planes.empty() && scene.gravity != host::Triple{} && !scene.contact.sleep;
        const bool is_loaded = !scene.forces.empty() || scene.gravitation > 0;
        const std::int64_t cost = rests ? 50 * static_cast<std::int64_t>(scene.bodies.size()) : is_loaded ? 10 : 3;
        for (const auto& integrator : host::integrators())
            for (const Variant& v : tumble::bench::variants_named({runs.variants.begin(), runs.variants.end()}))
                if (runs.integrators.contains(integrator.name) && host::runs_in(integrator, v.numbers))
                    jobs.push_back({scene, v, integrator.name, steps, cost, {}});
    }
    return jobs;
}

// The long runs of the list, each of at most `most_steps`, for all scenes or for the named one. Finished rows are
// appended to `part`; rows there from an interrupted run of the same bits are not run again.
std::vector<Row> runs_of_the_list(std::int64_t most_steps, const std::string& only, const fs::path& part) {
    std::vector<Job> jobs = jobs_of_the_list(most_steps, only);
    std::vector<Row> known;
    if (fs::exists(part)) known = tumble::bench::read_rows(part);
    std::vector<Job*> to_run;
    std::int64_t total = 0;
    for (Job& job : jobs) {
        job.row = names_of(job.scene, job.variant, job.method, job.steps);
        job.row["every"] = between_looks;
        const auto is_known = [&](const Row& row) {
            return row.at("tumble_bits") == TUMBLE_BITS &&
                   std::all_of(job.row.items().begin(), job.row.items().end(), [&](const auto& name) {
                       return row.contains(name.key()) && row.at(name.key()) == name.value();
                   });
        };
        const auto found = std::find_if(known.begin(), known.end(), is_known);
        if (found != known.end()) {
            job.row = *found;
            continue;
        }
        to_run.push_back(&job);
        total += job.steps * job.cost;
    }
    std::stable_sort(to_run.begin(), to_run.end(),
                     [](const Job* a, const Job* b) { return a->steps * a->cost > b->steps * b->cost; });
    if (part.has_parent_path()) fs::create_directories(part.parent_path());
    std::mutex mutex;
    std::ofstream file{part, std::ios::app};
    host::Progress progress(total, host::Progress::Piped::tenths);
    std::int64_t done = 0;
    tumble::bench::in_parallel(to_run.size(), [&](std::size_t i) {
        Job& job = *to_run[i];
        const std::string name = job.scene.name + ", " + job.method + " " + tumble::bench::numbers_of(job.row);
        std::int64_t steps = 0;
        const auto tell = [&] {
            const std::lock_guard lock{mutex};
            done += steps * job.cost;
            steps = 0;
            progress.show(done, name);
        };
        const Row errors = errors_over_time(job.scene, job.variant, job.method, job.steps, [&](std::int64_t more) {
            steps += more;
            if (steps * job.cost > total / 1000) tell();
        });
        steps +=
            job.steps - (errors.contains("failure_step") ? errors.at("failure_step").get<std::int64_t>() : job.steps);
        tell();
        job.row.update(errors);
        job.row["tumble_bits"] = TUMBLE_BITS;
        const std::lock_guard lock{mutex};
        file << job.row.dump() << std::endl;
        if (!file) throw std::runtime_error{part.string() + ": cannot be written"};
    });
    std::vector<Row> rows;
    for (const Job& job : jobs) rows.push_back(job.row);
    return rows;
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"Drift of conserved quantities in long runs, as rows. With problems: the drift for every method and "
                 "number system. "
                 "Without: the errors over time of the long runs, checked against their bounds."};
    std::vector<fs::path> problems;
    fs::path results = "build/results/long_run.jsonl";
    std::string only;
    std::int64_t steps = 1000000, every = 50, most_steps = std::numeric_limits<std::int64_t>::max();
    app.add_option("problems", problems, "Scene files of one body; their step is used, their duration is not");
    app.add_option("--steps", steps, "Steps of each run of a problem");
    app.add_option("--every", every, "Steps between two measurements of a problem");
    app.add_option("--most-steps", most_steps, "The most steps of a long run")->check(CLI::PositiveNumber);
    app.add_option("--only", only, "Run the long runs of this scene only, named as its file");
    app.add_option("--results", results, "Where the rows go, as JSON lines");
    CLI11_PARSE(app, argc, argv);

    if (!problems.empty()) {
        const std::vector<Row> rows = summaries(problems, steps, every);
        tumble::bench::write_rows(results, rows);
        std::printf("%zu rows in %s\n", rows.size(), results.c_str());
        return 0;
    }
    const fs::path part = results.string() + ".part";
    const std::vector<Row> rows = runs_of_the_list(most_steps, only, part);
    if (rows.empty()) throw std::invalid_argument{"--only " + only + ": no long run has that scene"};
    tumble::bench::write_rows(results, rows);
    fs::remove(part);
    std::printf("%zu rows in %s\n", rows.size(), results.c_str());
    const std::vector<std::string> broken = tumble::bench::broken_promises(rows);
    for (const std::string& promise : broken) std::cerr << "broken: " << promise << '\n';
    return broken.empty() ? 0 : 1;
} catch (...) { return tumble::bench::report_failure("tumble_long_run"); }

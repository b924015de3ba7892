// Scenes with contacts whose motion is known: how far the kernel is off, by the step. usage: tumble_contact_laws ROWS
#include "accuracy/known_places.hpp"
#include "rows/rows.hpp"
#include "scene/scene_file.hpp"
#include "simulation/simulation.hpp"

#include <cmath>
#include <cstdio>

namespace {

using namespace tumble::bench;
using tumble::host::SceneDescription, tumble::host::Simulation;
using Number = long double;

Number distance_to(const Simulation& run, int body, const KnownPlace& place) {
    const auto now = run.body(body).position;
    return std::hypot(now[0] - place.x, now[2] - place.z);
}

// The centre of the hoop at the end.
Number off_the_circle(Simulation& run) {
    const auto start = run.body(0);
    finish(run);
    return distance_to(run, 0, on_the_circle(start.position[2], start.velocity[0], run.time()));
}
// The same of the ball.
Number off_the_circle_on_a_table(Simulation& run) {
    const auto start = run.body(1);
    const Number table_rate = run.body(0).angular_velocity[1];
    finish(run);
    return distance_to(run, 1, on_the_circle_on_a_table(start.position[0], start.velocity[2], table_rate, run.time()));
}
Number change_of_energy(Simulation& run) {
    while (run.time() < 1 && run.troubles().empty()) run.step();
    const Number before = run.energy().total();
    finish(run);
    return std::abs(run.energy().total() / before - 1);
}
Number gain_of_energy(Simulation& run) {
    const Number before = run.energy().total();
    Number most = 0;
    while (run.steps_taken() < run.steps() && run.troubles().empty()) {
        run.step();
        most = std::max(most, run.energy().total() / before - 1);
    }
    return most;
}
// From the mirror image: the cue ball, and the balls of a triangle.
Number off_the_mirror_image(Simulation& run) {
    finish(run);
    Number most = 0;
    for (const auto& [ball, image] : mirrored) {
        const auto at = run.body(image).position;
        most = std::max(most, distance_to(run, ball, {at[0], -at[2]}));
    }
    return most;
}
// After three periods and half of one the left ball is at its wall, the others where they began.
Number off_the_cradle(Simulation& run) {
    finish(run);
    Number most = distance_to(run, 0, {-1, 0});
    for (int ball = 1; ball < 5; ++ball) most = std::max(most, distance_to(run, ball, {(ball - 2) / 4.0L, 0}));
    return most;
}
Number off_the_middle(Simulation& run) {
    finish(run);
    return std::abs(run.body(0).position[0]);
}

struct Law {
    const char *scene, *error, *path;
    Number (*measure)(Simulation& run);
};
constexpr Law laws[] = {
    {"hoop that leans", "place after 4 s, m", "bench/laws/hoop.toml", off_the_circle},
    {"ball on a turntable", "place after 4 s, m", "bench/laws/turntable.toml", off_the_circle_on_a_table},
    {"coin on its rim", "energy, from 1 s to 4 s, of itself", "bench/laws/coin.toml", change_of_energy},
    {"rough rod on its end", "gain of energy, of itself", "bench/laws/rod.toml", gain_of_energy},
    {"break of six balls", "distance from its mirror image after 1 s, m", "bench/laws/break.toml",
     off_the_mirror_image},
    {"cradle", "places after 6 s, m", "host_sim/scenes/contacts/cradle.toml", off_the_cradle},
    {"ball in a V", "distance from the middle after 1 s, m", "bench/laws/v.toml", off_the_middle},
};

}  // namespace

int main(int argc, char** argv) try {
    tumble::host::tell_lost_output();
    const char* results = argc > 1 ? argv[1] : "build/results/contact_laws.jsonl";
    tumble::host::OutputFile file = rows_file(results);
    std::vector<Row> rows;
    for (const Law& law : laws) {
        for (const char* numbers : {"f64", "q32"}) {
            double before = 0;
            for (const int steps : {128, 256, 512, 1024}) {
                SceneDescription scene = tumble::host::read_scene(law.path);
                scene.step = {1, steps, 0};
                const auto run = make_simulation(scene, "verlet", numbers);
                const auto error = static_cast<double>(law.measure(*run));
                Row row = row_of(law.scene, "host", numbers, run->carry(), "verlet", 1.0 / steps);
                if (!run->troubles().empty()) {
                    row["failure"] = run->troubles().front().issue;
                } else {
                    row["law"] = law.error;
                    row["error"] = error;
                    if (before > 0 && error > 0) row["observed_order"] = observed_order(before, error);
                }
                before = error;
                rows.push_back(row);
            }
        }
    }
    write_rows(file, rows);
    std::printf("%zu rows in %s\n", rows.size(), results);
    return 0;
} catch (...) { return report_failure("tumble_contact_laws"); }

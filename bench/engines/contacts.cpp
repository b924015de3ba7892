// Contacts whose motion is known, at 1/256 s and at 1/60 s. One row for each scene, step, law and contender: how far
// the motion is off the law, and the instructions of a step, the mean of the first second. Engines have their default
// settings; Box2D takes planar scenes.
#include "contest.hpp"

#include "accuracy/known_places.hpp"
#include "scene/scene_file.hpp"

#include <algorithm>
#include <cmath>

namespace tumble::bench {

namespace {

using reference::Motion, reference::Number, reference::Vector;

// The motion of all bodies: at the start, and after each step.
struct Run {
    const Problem& problem;
    int rate;
    std::vector<std::vector<Motion>> at;

    [[nodiscard]] const Motion& start(std::size_t body) const { return at.front()[body]; }
    [[nodiscard]] const Motion& end(std::size_t body) const { return at.back()[body]; }
    [[nodiscard]] Number seconds() const { return static_cast<Number>(at.size() - 1) / rate; }
    [[nodiscard]] std::size_t bodies() const { return at.front().size(); }
};

Number distance(const Vector& a, const Vector& b) { return norm(a - b); }

// Scenes at rest; the last body is the top.
Number sink_of_the_top(const Run& run) {
    const std::size_t top = run.bodies() - 1;
    return std::abs(run.end(top).x.y - run.start(top).x.y);
}
Number largest_shift_sideways(const Run& run) {
    Number most = 0;
    for (std::size_t body = 0; body < run.bodies(); ++body) {
        const Vector shift = run.end(body).x - run.start(body).x;
        most = std::max(most, std::hypot(shift.x, shift.z));
    }
    return most;
}

// Each box begins this far above the one below it. The top falls ten times as far.
constexpr double drop = 0.002;  // m
void set_down(SceneData& scene) {
    double height = 0;
    for (BodySpec& box : scene.bodies) box.position.y = box.position.y + Real{height += drop};
}
Number off_its_height(const Run& run) {
    const std::size_t top = run.bodies() - 1;
    return std::abs(run.end(top).x.y - (static_cast<Number>(run.bodies()) - 0.5L));
}

// The cradle begins with the strike, at 1 m/s. The last ball is half a metre from its wall.
void strike_at_the_start(SceneData& scene) {
    BodySpec& struck = scene.bodies.front();
    struck.velocity.x = scene.events.front().value.x / struck.mass;
    scene.events.clear();
}
Number speed_of_the_last(const Run& run) {
    return std::abs(run.at[static_cast<std::size_t>(run.rate) / 4].back().v.x - run.start(0).v.x);
}
Number inner_balls_moved(const Run& run) {
    Number most = 0;
    for (const auto& now : run.at)
        for (std::size_t body = 1; body + 1 < now.size(); ++body)
            most = std::max(most, distance(now[body].x, run.start(body).x));
    return most;
}

// Without friction and with restitution 1 a break keeps its energy.
void break_without_losses(SceneData& scene) {
    scene.world.contact.restitution = 1;
    scene.world.contact.friction = 0;
}
// From the mirror image: the cue ball, and the balls of a triangle.
Number off_the_mirror_image(const Run& run) {
    Number most = 0;
    for (const auto& [ball, image] : mirrored) {
        Vector at = run.end(static_cast<std::size_t>(image)).x;
        at.z = -at.z;
        most = std::max(most, distance(run.end(static_cast<std::size_t>(ball)).x, at));
    }
    return most;
}
// Of balls of one mass.
Number gain_of_energy(const Run& run) {
    const BodySpec& spec = run.problem.scene.bodies.front();
    const Number moment = principal_moments(spec)[0] / spec.mass.to_double();
    const auto energy = [&](const std::vector<Motion>& now) {
        Number sum = 0;
        for (const Motion& ball : now) sum += dot(ball.v, ball.v) + moment * dot(ball.w, ball.w);
        return sum;
    };
    return energy(run.at.back()) / energy(run.at.front()) - 1;
}

// At the height of its start.
Number off(const Run& run, std::size_t body, const KnownPlace& place) {
    return distance(run.end(body).x, {place.x, run.start(body).x.y, place.z});
}
Number off_the_circle_on_a_table(const Run& run) {
    const Motion& start = run.start(1);
    const Number table_rate = run.problem.scene.bodies[0].angular_velocity.y.to_double();
    return off(run, 1, on_the_circle_on_a_table(start.x.x, start.v.z, table_rate, run.seconds()));
}
Number off_the_circle(const Run& run) {
    const Motion& start = run.start(0);
    return off(run, 0, on_the_circle(start.x.z, start.v.x, run.seconds()));
}

void slide(SceneData& scene) { scene.world.contact.friction = 0.7425; }  // 1 % below the sticking angle
Number moved(const Run& run) { return distance(run.end(0).x, run.start(0).x); }
Number off_the_slide(const Run& run) {
    const SceneData& scene = run.problem.scene;
    const auto normal = array_of<double>(normalized(scene.planes.front().normal));
    const Number cosine = normal[1], tangent = -normal[0] / cosine,
                 g = -static_cast<Number>(scene.world.gravity.y.to_double()),
                 mu = scene.world.contact.friction.to_double(), t = run.seconds(),
                 length = g * (tangent - mu) * cosine * t * t / 2;
    const Vector downhill{-cosine, -tangent * cosine, 0};
    return distance(run.end(0).x, run.start(0).x + length * downhill);
}

struct Law {
    const char* error;
    Number (*measure)(const Run& run);
};
struct Scene {
    const char *name, *path;
    int seconds;
    std::vector<Law> laws;
    void (*change)(SceneData& scene) = nullptr;
};
const std::vector<Scene> scenes{
    {"stack of ten boxes",
     "host_sim/scenes/contacts/stack.toml",
     10,
     {{"sink of the top after 10 s, m", sink_of_the_top},
      {"largest shift sideways after 10 s, m", largest_shift_sideways}}},
    {"stack, set down",
     "host_sim/scenes/contacts/stack.toml",
     10,
     {{"height of the top after 10 s, m", off_its_height},
      {"largest shift sideways after 10 s, m", largest_shift_sideways}},
     set_down},
    {"pyramid of ten boxes",
     "host_sim/scenes/contacts/pyramid.toml",
     10,
     {{"sink of the top after 10 s, m", sink_of_the_top},
      {"largest shift sideways after 10 s, m", largest_shift_sideways}}},
    {"cradle",
     "host_sim/scenes/contacts/cradle.toml",
     6,
     {{"speed of the last ball 1/4 s after the strike, m/s", speed_of_the_last},
      {"largest distance of an inner ball from its place within 6 s, m", inner_balls_moved}},
     strike_at_the_start},
    {"break",
     "bench/laws/break.toml",
     1,
     {{"distance from the mirror image after 1 s, m", off_the_mirror_image},
      {"gain of energy, of itself", gain_of_energy}},
     break_without_losses},
    {"turntable", "bench/laws/turntable.toml", 4, {{"place after 4 s, m", off_the_circle_on_a_table}}},
    {"leaning wheel", "bench/laws/hoop.toml", 4, {{"place after 4 s, m", off_the_circle}}},
    {"incline, sticks", "bench/engines/incline.toml", 4, {{"place after 4 s, m", moved}}},
    {"incline, slides", "bench/engines/incline.toml", 4, {{"place after 4 s, m", off_the_slide}}, slide},
};

Problem problem(std::size_t scene, int rate) {
    host::SceneDescription description = host::read_scene(scenes.at(scene).path);
    description.step = {1, rate, 0};
    description.name = scenes[scene].name;
    Problem problem = problem_of(description);
    if (scenes[scene].change != nullptr) scenes[scene].change(problem.scene);
    problem.features = host::needs(problem.scene);
    problem.counted_steps = rate;
    return problem;
}

Run run_of(const Problem& problem, int rate, Runner& runner, int seconds) {
    Run run{problem, rate, {runner.motions()}};
    for (int step = 0; step < seconds * rate; ++step) {
        runner.step();
        run.at.push_back(runner.motions());
    }
    return run;
}

// One row a step and law.
std::vector<Row> rows(std::size_t number, const Contender& contender, const Contest::Count& count) {
    const Scene& scene = scenes[number];
    std::vector<Row> rows;
    // The steps of accurate simulation and of games, 1/s.
    for (const int rate : {256, 60}) {
        const Problem made = problem(number, rate);
        const auto runner = contender.make(made);
        if (!runner) break;
        Row row = row_of_engine(scene.name, contender, 1.0 / rate, scene.seconds * rate);
        const auto add = [&](const Law& law, const char* key, const auto& value) -> Row& {
            Row& of_law = rows.emplace_back(row);
            of_law["law"] = law.error;
            of_law[key] = value;
            return of_law;
        };
        try {
            const Run run = run_of(made, rate, *runner, scene.seconds);
            row["insn_per_step"] = count(rate);
            for (const Law& law : scene.laws) {
                const auto error = static_cast<double>(law.measure(run));
                Row& of_law = std::isfinite(error) ? add(law, "error", error) : add(law, "failure", "not a number");
                if (const std::string trouble = runner->trouble(); !trouble.empty()) of_law["trouble"] = trouble;
            }
        } catch (const std::runtime_error& error) {
            for (const Law& law : scene.laws) add(law, "failure", error.what());
        }
    }
    return rows;
}

}  // namespace

Contest contact_contest() { return {scenes.size(), problem, rows}; }

}  // namespace tumble::bench

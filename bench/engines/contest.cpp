#include "contest.hpp"

#include "firmware/callgrind.hpp"
#include "truth/smooth_motion.hpp"

#include <iostream>

// Callgrind counts this function, which it finds by name: a step with its call.
extern "C" [[gnu::noinline]] void counted_step(tumble::bench::Runner& runner) { runner.step(); }

namespace tumble::bench {

Problem problem_of(const host::SceneDescription& scene) {
    Problem problem;
    problem.name = scene.name;
    problem.scene = host::build_scene(scene);
    problem.features = host::needs(problem.scene);
    return problem;
}

std::vector<Motions> truth_of(const host::SceneDescription& scene, int samples) {
    host::SmoothMotion smooth{scene, host::shapes_meet};
    std::vector<Motions> truth;
    for (int sample = 1; sample <= samples; ++sample) {
        smooth.advance_to(scene.steps() * sample / samples);
        truth.push_back(smooth.bodies());
    }
    return truth;
}

int run_contest(int argc, char** argv, void (*add)(Contenders&), Contest (*contest)()) try {
    host::tell_lost_output();
    Contenders contenders;
    add(contenders);
    const auto [scenes, problem_at, rows_of] = contest();
    if (argc == 5 && std::string{argv[1]} == "--count") {
        const Problem problem = problem_at(std::stoul(argv[2]), std::stoi(argv[3]));
        const auto runner = contenders.at(std::stoul(argv[4])).make(problem);
        runner->run(problem.steps_before);
        for (int i = 0; i < problem.counted_steps; ++i) counted_step(*runner);
        return 0;
    }
    for (std::size_t c = 0; c < contenders.size(); ++c) {
        for (std::size_t scene = 0; scene < scenes; ++scene) {
            const auto count = [&](int rate) {
                const std::string command = argv[0] + (" --count " + std::to_string(scene)) + " " +
                                            std::to_string(rate) + " " + std::to_string(c);
                const auto steps = static_cast<std::uint64_t>(problem_at(scene, rate).counted_steps);
                return (host::instructions_in("counted_step", command).count + steps / 2) / steps;
            };
            for (Row& row : rows_of(scene, contenders[c], count)) {
                row["tumble_bits"] = TUMBLE_BITS;
                std::cout << row.dump() << std::endl;
            }
        }
    }
    return 0;
} catch (...) { return report_failure(argv[0]); }

}  // namespace tumble::bench

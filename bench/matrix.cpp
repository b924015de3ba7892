// The main job: one scene, replayed on the host and on every core with every integrator and number system; the bits
// compared; what a step costs printed and written as JSON lines. A row whose hash differs from the host's is marked and
// makes the whole run fail; so does a firmware that faults or does not end.
#include "callgrind.hpp"
#include "command.hpp"
#include "rows.hpp"
#include "scene_reader.hpp"
#include "variants.hpp"

#include "reference.hpp"

#include <CLI/CLI.hpp>

#include <array>
#include <cstdio>
#include <iostream>
#include <mutex>
#include <optional>
#include <unistd.h>

namespace {

using tumble::bench::in_parallel;
using tumble::bench::Row;
using tumble::bench::Variant;
namespace fs = std::filesystem;

const fs::path source_dir = TUMBLE_SOURCE_DIR;

struct Result {
    int status = 0;
    std::string text;
};

Result run(const std::string& command) {
    Result result;
    FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    if (pipe == nullptr) throw std::runtime_error{"cannot run: " + command};
    std::array<char, 4096> part{};
    while (const std::size_t n = std::fread(part.data(), 1, part.size(), pipe)) result.text.append(part.data(), n);
    const int status = pclose(pipe);
    result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    return result;
}

std::string quoted(const std::string& text) { return "'" + text + "'"; }

// The core whose programs run natively, under valgrind when their instructions are counted.
const std::string host_core = "host";

// tumble::integrators::Rk4 -> Rk4.
std::string type_name(const std::string& method) {
    const std::string& type = tumble::host::find_integrator(method).type;
    return type.substr(type.rfind(':') + 1);
}

std::vector<std::string> all_cores() {
    std::ifstream boards{source_dir / "port/cortex_m/boards.txt"};
    std::vector<std::string> cores;
    for (std::string line; std::getline(boards, line);) {
        if (!line.empty() && line[0] != '#') cores.push_back(line.substr(0, line.find(' ')));
    }
    return cores;
}

// One line that is rewritten on a terminal; plain lines elsewhere, one for each tenth.
class Progress {
public:
    explicit Progress(std::size_t total) : total_{total} {}
    void step(const std::string& what) {
        const std::lock_guard lock{mutex_};
        ++done_;
        if (isatty(2) != 0) {
            std::fprintf(stderr, "\r[%zu/%zu] %-60.60s", done_, total_, what.c_str());
            if (done_ == total_) std::fputc('\n', stderr);
        } else if (done_ * 10 / total_ != (done_ - 1) * 10 / total_) {
            std::fprintf(stderr, "[%zu/%zu] %s\n", done_, total_, what.c_str());
        }
    }

private:
    std::size_t total_, done_ = 0;
    std::mutex mutex_;
};

struct Job {
    std::string core;
    Variant variant;
    std::string method;
    Row row;
    std::string error;  // empty: the row is good
    bool does_not_fit = false;
};

// Runs a program for the emulator, or one for the host with its row's cost replaced by what valgrind has counted.
Result on_target(const std::string& core, const fs::path& elf) {
    return run(quoted((source_dir / "port/qemu/run").string()) + " --timeout 900 " + core + " " + quoted(elf.string()));
}
Result counted(const fs::path& program) try {
    const auto counted = tumble::bench::instructions_in("*step_world*", quoted(program.string()));
    Row row = Row::parse(counted.text);
    const std::uint64_t steps = row.at("steps");
    Row with_count;
    for (const auto& [key, value] : row.items()) {
        if (key == "ns_per_step") with_count["insn_per_step"] = steps == 0 ? 0 : (counted.count + steps / 2) / steps;
        else if (key != "ns_per_step_max" && key != "stack_bytes") with_count[key] = value;
    }
    return {0, with_count.dump()};
} catch (const std::exception& error) { return {1, error.what()}; }

std::string hex(std::uint64_t hash) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

void add_sizes(Row& row, const fs::path& elf) {
    const Result size = run((row.at("core") == host_core ? "size " : "arm-none-eabi-size ") + quoted(elf.string()));
    unsigned long text = 0, data = 0, bss = 0;
    if (size.status != 0 || std::sscanf(size.text.c_str(), "%*[^\n]\n%lu %lu %lu", &text, &data, &bss) != 3) {
        throw std::runtime_error{"size: " + size.text};
    }
    row["text_bytes"] = text + data;  // what lies in flash
    row["ram_bytes"] = data + bss;
}

void print_table(const std::vector<Job>& jobs) {
    std::printf("\n%-11s %-10s %-20s %10s %10s %8s %7s %7s  %-16s %s\n", "core", "numbers", "integrator", "insn/step",
                "worst", "text", "RAM", "stack", "state hash", "agrees");
    for (const Job& job : jobs) {
        const std::string numbers = job.variant.numbers + (job.variant.numbers == "f64" ? ""
                                                           : job.variant.carry          ? " carry"
                                                                                        : " plain");
        if (job.does_not_fit) {
            std::printf("%-11s %-10s %-20s does not fit this core's memory\n", job.core.c_str(), numbers.c_str(),
                        job.method.c_str());
        } else if (!job.error.empty() && job.row.is_null()) {
            std::printf("%-11s %-10s %-20s FAILED: %s\n", job.core.c_str(), numbers.c_str(), job.method.c_str(),
                        job.error.c_str());
        } else {
            const auto number = [&](const char* key) {
                return job.row.contains(key) ? std::to_string(job.row.at(key).get<unsigned long long>()) : "-";
            };
            std::printf("%-11s %-10s %-20s %10s %10s %8s %7s %7s  %-16s %s\n", job.core.c_str(), numbers.c_str(),
                        job.method.c_str(), number("insn_per_step").c_str(), number("insn_per_step_max").c_str(),
                        number("text_bytes").c_str(), number("ram_bytes").c_str(), number("stack_bytes").c_str(),
                        job.row.at("state_hash").get<std::string>().c_str(),
                        job.error.empty() ? "yes" : job.error.c_str());
        }
    }
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"Replays a scene on the host and on every core, compares the bits, and prints what a step costs."};
    fs::path scene_path, results = "build/results/run.jsonl", baseline;
    std::vector<std::string> cores = all_cores(), methods = tumble::bench::integrator_names(),
                             numbers = tumble::bench::variant_names();
    bool accuracy = false;
    app.add_option("scene", scene_path, "Scene file")->required();
    app.add_option("--cores", cores, "Cores to run on, or " + host_core + ", which needs valgrind")->delimiter(',');
    app.add_option("--integrators", methods, "Integrators to run")->delimiter(',');
    app.add_option("--numbers", numbers, "Number systems to run, as q32, q32_plain, ...")->delimiter(',');
    app.add_option("--results", results, "Where the rows go, as JSON lines");
    app.add_option("--baseline", baseline, "Rows to compare size and cost with");
    app.add_flag("--accuracy", accuracy,
                 "Add errors against the long-double reference, up to the scene's first contact");
    CLI11_PARSE(app, argc, argv);

    const tumble::host::SceneDescription scene = tumble::host::read_scene(scene_path);
    const std::vector<Variant> variants = tumble::bench::variants_named(numbers);
    const std::string name = scene_path.stem().string();
    const fs::path work = fs::path{"build/matrix"} / name;
    fs::create_directories(work);

    std::vector<Job> jobs;
    for (const auto& core : cores)
        for (const auto& v : variants)
            for (const auto& m : methods) jobs.push_back({core, v, m, {}, {}, false});

    // The host's answer for each integrator and number system.
    struct Answer {
        std::string hash;
        double position_error = 0, orientation_error = 0;
    };
    std::map<std::pair<std::string, std::string>, Answer> answers;
    std::mutex answers_mutex;
    std::vector<std::pair<Variant, std::string>> hosts;
    for (const auto& v : variants)
        for (const auto& m : methods) hosts.emplace_back(v, m);
    std::optional<tumble::bench::Flight> flight;
    if (accuracy) flight.emplace(scene);
    Progress progress{hosts.size() + cores.size() + jobs.size()};
    in_parallel(hosts.size(), [&](std::size_t i) {
        const auto& [variant, method] = hosts[i];
        const auto simulation = tumble::host::make_simulation(scene, method, variant.numbers, variant.carry);
        while (simulation->steps_taken() < simulation->steps() && simulation->troubles().empty()) simulation->step();
        Answer answer{hex(simulation->hash())};
        if (flight) {
            const auto error = flight->error_of(method, variant.numbers, variant.carry);
            answer.position_error = error.position_m;
            answer.orientation_error = error.orientation_rad;
        }
        const std::lock_guard lock{answers_mutex};
        answers[{variant.name, method}] = answer;
        progress.step("host " + variant.name + " " + method);
    });

    // The firmware of each core; ninja uses both processors itself.
    const fs::path header = fs::absolute(work / (name + ".hpp"));
    if (const Result r = run(quoted((source_dir / "build/host/tumble").string()) + " compile " +
                             quoted(scene_path.string()) + " -o " + quoted(header.string()));
        r.status != 0) {
        throw std::runtime_error{"tumble compile: " + r.text};
    }
    std::string targets;
    for (const auto& v : variants)
        for (const auto& m : methods) targets += " " + v.name + "-" + type_name(m);
    std::map<std::string, std::string> build_text;
    for (const auto& core : cores) {
        const std::string dir = quoted((work / core).string());
        const Result configured =
            run("cmake -G Ninja -S " + quoted((source_dir / "bench/firmware").string()) + " -B " + dir +
                (core == host_core
                     ? ""
                     : " -DCMAKE_TOOLCHAIN_FILE=" + quoted((source_dir / "port/cortex_m/toolchain.cmake").string())) +
                " -DTUMBLE_CORE=" + core + " -DTUMBLE_SCENE=" + tumble::host::struct_name(scene_path.string()) +
                " -DTUMBLE_SCENE_HEADER=" + quoted(header.string()));
        if (configured.status != 0) throw std::runtime_error{"cmake for " + core + ": " + configured.text};
        build_text[core] = run("cmake --build " + dir + " --target" + targets + " -- -k 0").text;
        progress.step("built for " + core);
    }

    in_parallel(jobs.size(), [&](std::size_t i) {
        Job& job = jobs[i];
        const std::string target = job.variant.name + "-" + type_name(job.method);
        const fs::path elf = work / job.core / (target + ".elf");
        if (!fs::exists(elf)) {
            const std::string& text = build_text[job.core];
            const std::size_t at = text.find(target + ".elf");
            job.does_not_fit = at != std::string::npos && text.find("overflowed", at) != std::string::npos;
            if (!job.does_not_fit) job.error = "not built: see cmake --build " + (work / job.core).string();
        } else if (const Result r = job.core == host_core ? counted(elf) : on_target(job.core, elf); r.status != 0) {
            job.error = "exit status " + std::to_string(r.status) + ": " + r.text;
        } else {
            job.row = Row::parse(r.text);
            const Answer& answer = answers.at({job.variant.name, job.method});
            job.row["step_s"] = scene.step.seconds();
            job.row["compiler"] = job.core == host_core ? TUMBLE_HOST_COMPILER : TUMBLE_ARM_COMPILER;
            job.row["flags"] = job.core != host_core && job.variant.numbers == "q32"
                                   ? "-O2 -fno-schedule-insns -frename-registers -fno-tree-pre"
                                   : "-O2";
            add_sizes(job.row, elf);
            if (accuracy) {
                job.row["position_error_m"] = answer.position_error;
                job.row["orientation_error_rad"] = answer.orientation_error;
            }
            const bool agrees = job.row.at("state_hash") == answer.hash;
            job.row["state_hash_agrees"] = agrees;
            if (!agrees) job.error = "NO: host has " + answer.hash;
        }
        progress.step(job.core + " " + job.variant.name + " " + job.method);
    });

    std::vector<Row> rows;
    int failed = 0;
    for (const Job& job : jobs) {
        if (!job.row.is_null() && job.error.empty()) rows.push_back(job.row);
        if (!job.error.empty()) ++failed;
    }
    print_table(jobs);
    tumble::bench::write_rows(results, rows);
    std::printf("\n%zu rows in %s", rows.size(), results.c_str());
    if (failed > 0) std::printf("; %d FAILED", failed);
    std::printf("\n");

    if (!baseline.empty()) {
        const auto old_rows = tumble::bench::read_rows(baseline);
        for (const Row& row : rows) {
            for (const Row& old : old_rows) {
                if (old.at("core") != row.at("core") || old.at("numbers") != row.at("numbers") ||
                    old.at("carry") != row.at("carry") || old.at("integrator") != row.at("integrator"))
                    continue;
                for (const char* key : {"insn_per_step", "text_bytes", "ram_bytes", "stack_bytes"}) {
                    if (!row.contains(key) || !old.contains(key)) continue;
                    const long change = row.at(key).get<long>() - old.at(key).get<long>();
                    if (change != 0)
                        std::printf("%s %s %s: %s %+ld\n", row.at("core").get<std::string>().c_str(),
                                    row.at("numbers").get<std::string>().c_str(),
                                    row.at("integrator").get<std::string>().c_str(), key, change);
                }
            }
        }
    }
    return failed == 0 ? 0 : 1;
} catch (const tumble::host::SceneError& error) {
    std::cerr << error.what() << '\n';
    return 2;
} catch (const std::exception& error) {
    std::cerr << "tumble_matrix: " << error.what() << '\n';
    return 1;
}

#include "stress/runner.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include "pictures/drawing.hpp"
#include "tools/files.hpp"

namespace tumble::bench::stress {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// Digest of this program and of the files that it reads, except its modules of worlds, which have the same sources.
std::string digest_of_program() {
    std::string all = host::contents_of("/proc/self/exe");
    std::vector<fs::path> scenes;
    for (const auto& entry : fs::directory_iterator{scene_directory()}) scenes.push_back(entry.path());
    std::sort(scenes.begin(), scenes.end());
    for (const auto& scene : scenes) all += host::contents_of(scene);
    return host::hex(std::hash<std::string>{}(all));
}

struct Cell {
    double x = 0, y = 0;
    std::int64_t steps = 0;  // approximate cost
};

// Cells row by row: y ascends, and x ascends in each row.
std::vector<Cell> cells_of(const Map& map, bool coarse) {
    std::vector<Cell> cells;
    for (const double y : map.y().values(coarse))
        for (const double x : map.x().values(coarse)) {
            const host::SceneDescription scene = map.scene(x, y);
            cells.push_back({x, y, scene.steps() * static_cast<std::int64_t>(scene.bodies.size())});
        }
    return cells;
}

std::int64_t cost_of(const std::vector<Cell>& cells) {
    std::int64_t steps = 0;
    for (const Cell& cell : cells) steps += cell.steps;
    return steps;
}

// The message about a cell from a child process.
std::string line_of(const Judgement& judgement) {
    std::string cause = judgement.cause.substr(0, 200);
    std::replace(cause.begin(), cause.end(), '\n', ' ');
    return static_cast<char>(judgement.outcome) + cause + '\n';
}
Judgement judgement_of(const std::string& line) { return {static_cast<Outcome>(line.at(0)), line.substr(1)}; }

// An unfinished row, and the process that judges its cells from a given one on.
class RunningRow {
public:
    RunningRow(const Job& job, const std::vector<Cell>& cells, bool with_limits)
        : job_{&job}, cells_{&cells}, with_limits_{with_limits} {
        start();
    }

    [[nodiscard]] int descriptor() const { return pipe_; }
    [[nodiscard]] bool is_done() const { return pipe_ < 0; }
    [[nodiscard]] const Job& job() const { return *job_; }
    [[nodiscard]] const std::vector<Judgement>& judgements() const { return judgements_; }
    // For each y; null if there is none.
    [[nodiscard]] const Row& limits() const { return limits_; }

    // Reads the messages that have arrived. Returns the steps done since the last call.
    std::int64_t read_on() {
        char buffer[4096];
        const ssize_t count = ::read(pipe_, buffer, sizeof buffer);
        const std::size_t before = judgements_.size();
        if (count > 0) {
            text_.append(buffer, static_cast<std::size_t>(count));
            for (std::size_t end; (end = text_.find('\n')) != std::string::npos; text_.erase(0, end + 1)) {
                const std::string line = text_.substr(0, end);
                if (judgements_.size() < cells_->size()) judgements_.push_back(judgement_of(line));
                else limits_ = Row::parse(line);
            }
            last_ = Clock::now();
        } else {
            finish("");
        }
        return steps_since(before);
    }
    // Ends a cell that exceeds its time.
    std::int64_t watch(double seconds) {
        if (std::chrono::duration<double>(Clock::now() - last_).count() < seconds) return 0;
        const std::size_t before = judgements_.size();
        kill(child_, SIGKILL);
        finish("no end within " + host::few_digits(seconds) + " s");
        return steps_since(before);
    }

private:
    [[nodiscard]] std::int64_t steps_since(std::size_t before) const {
        std::int64_t steps = 0;
        for (std::size_t i = before; i < judgements_.size(); ++i) steps += (*cells_)[i].steps;
        return steps;
    }

    void start() {
        int ends[2];
        if (pipe(ends) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
        child_ = fork();
        if (child_ < 0) throw std::system_error(errno, std::generic_category(), "fork");
        if (child_ == 0) {
            prctl(PR_SET_PDEATHSIG, SIGKILL);
            close(ends[0]);
            judge_cells(ends[1]);
            _exit(0);
        }
        close(ends[1]);
        pipe_ = ends[0];
        last_ = Clock::now();
    }

    // In the child.
    void judge_cells(int out) const {
        for (std::size_t i = judgements_.size(); i < cells_->size(); ++i) {
            const Cell& cell = (*cells_)[i];
            write_line(out, line_of(job_->map->judge(cell.x, cell.y, job_->method())));
        }
        Row limits = Row::array();
        double y = std::nan("");
        for (const Cell& cell : *cells_) {
            if (cell.y == std::exchange(y, cell.y)) continue;
            const auto limit = with_limits_ ? job_->map->limit(y, job_->method()) : std::nullopt;
            limits.push_back(limit ? Row(std::stod(text("%.3g", *limit))) : Row{});
        }
        write_line(out, limits.dump() + '\n');
    }
    static void write_line(int out, const std::string& line) {
        if (::write(out, line.data(), line.size()) != static_cast<ssize_t>(line.size())) _exit(1);
    }

    // The child has ended, or was ended for a cause. Another child continues after the cell of the failure.
    void finish(const std::string& cause) {
        close(pipe_);
        pipe_ = -1;
        text_.clear();
        int status = 0;
        waitpid(child_, &status, 0);
        if (!limits_.is_null()) return;
        const std::string end = WIFSIGNALED(status) ? std::string{"ended by "} + strsignal(WTERMSIG(status))
                                                    : "ended with status " + std::to_string(WEXITSTATUS(status));
        if (judgements_.size() == cells_->size())
            throw std::runtime_error{job_->map->name() + ", " + job_->integrator + ", limits: " + end};
        judgements_.push_back({Outcome::silent, cause.empty() ? end : cause});
        start();
    }

    const Job* job_;
    const std::vector<Cell>* cells_;
    bool with_limits_;  // they cost as much as the runs of a coarse map
    std::vector<Judgement> judgements_;
    Row limits_;
    std::string text_;
    int pipe_ = -1;
    pid_t child_ = -1;
    Clock::time_point last_;
};

Row row_of(const RunningRow& running, const std::vector<Cell>& cells) {
    const Job& job = running.job();
    const std::vector<Judgement>& judgements = running.judgements();
    Row row;
    row["map"] = job.map->name();
    row["integrator"] = job.integrator;
    row["numbers"] = job.variant.numbers;
    row["carry"] = job.variant.carry;
    std::string letters;
    Row causes = Row::array();
    for (std::size_t i = 0; i < cells.size(); ++i) {
        letters += static_cast<char>(judgements[i].outcome);
        if (judgements[i].outcome == Outcome::silent)
            causes.push_back({{"x", cells[i].x}, {"y", cells[i].y}, {"cause", judgements[i].cause}});
    }
    row["cells"] = letters;
    row["silent"] = causes.size();
    const Row& limits = running.limits();
    if (std::any_of(limits.begin(), limits.end(), [](const Row& limit) { return !limit.is_null(); }))
        row["limit_x"] = limits;
    row["silent_cells"] = causes;
    return row;
}

template <class T>
bool is_chosen(const std::vector<T>& chosen, const T& name) {
    return chosen.empty() || std::find(chosen.begin(), chosen.end(), name) != chosen.end();
}

}  // namespace

std::vector<Job> jobs_of(const Choice& choice) {
    for (const auto& name : choice.maps) (void)map_named(name);
    for (const auto& name : choice.integrators) (void)host::find_integrator(name);
    (void)variants_named(choice.numbers);
    std::vector<Job> jobs;
    for (const auto& map : maps()) {
        if (!is_chosen(choice.maps, map->name())) continue;
        for (const auto& integrator : host::integrators()) {
            if (!is_chosen(choice.integrators, integrator.name)) continue;
            for (const Variant& variant : variants)
                if (is_chosen(choice.numbers, variant.name) && host::runs_in(integrator, variant.numbers) &&
                    map->takes(integrator))
                    jobs.push_back({map.get(), integrator.name, variant});
        }
    }
    return jobs;
}

namespace {

fs::path file_of(const Job& job, const RunOptions& options) {
    return options.kept / (options.coarse ? "coarse" : "fine") /
           (job.map->name() + "." + job.integrator + "." + job.variant.name + ".json");
}

// A row that an earlier run of this program kept in a file; none if there is none.
std::optional<Row> kept_row(const fs::path& file, const std::string& digest) {
    const std::string text = host::contents_of(file);
    Row row = text.empty() ? Row{} : Row::parse(text, nullptr, false);
    if (!row.is_object() || row.value("program", "") != digest) return std::nullopt;
    row.erase("program");
    return row;
}

void keep(Row row, const fs::path& file, const std::string& digest) {
    row["program"] = digest;
    fs::create_directories(file.parent_path());
    const fs::path unfinished = file.string() + ".new";
    host::write_if_changed(unfinished, row.dump() + "\n");
    fs::rename(unfinished, file);
}

// The jobs that have no kept row.
struct Rest {
    std::vector<std::size_t> jobs;  // the most expensive first, so that none runs alone at the end
    std::map<const Map*, std::vector<Cell>> cells;
    std::int64_t cost = 0;
};
// The others have their rows afterwards.
Rest rest_of(const std::vector<Job>& jobs, const RunOptions& options, const std::string& digest,
             std::vector<Row>& rows) {
    Rest rest;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        if (auto kept = options.anew ? std::nullopt : kept_row(file_of(jobs[i], options), digest)) {
            rows[i] = *kept;
            continue;
        }
        const Map* map = jobs[i].map;
        if (!rest.cells.contains(map)) rest.cells[map] = cells_of(*map, options.coarse);
        rest.jobs.push_back(i);
        rest.cost += cost_of(rest.cells[map]);
    }
    std::stable_sort(rest.jobs.begin(), rest.jobs.end(), [&](std::size_t a, std::size_t b) {
        return cost_of(rest.cells[jobs[a].map]) > cost_of(rest.cells[jobs[b].map]);
    });
    return rest;
}

}  // namespace

std::vector<Row> run(const std::vector<Job>& jobs, const RunOptions& options) {
    const std::string digest = digest_of_program();
    std::vector<Row> rows(jobs.size());
    Rest rest = rest_of(jobs, options, digest, rows);
    host::Progress progress(rest.cost, host::Progress::Piped::tenths);
    std::int64_t done = 0;
    std::set<const Map*> prepared;
    std::map<std::size_t, RunningRow> running;
    std::size_t next = 0;
    const std::size_t processors = std::max(1u, std::thread::hardware_concurrency());
    while (next < rest.jobs.size() || !running.empty()) {
        while (next < rest.jobs.size() && running.size() < processors) {
            const std::size_t i = rest.jobs[next++];
            Map* map = jobs[i].map;
            // The shared data of rows, before the processes are forked.
            if (prepared.insert(map).second) map->prepare(map->y().values(options.coarse));
            running.emplace(i, RunningRow{jobs[i], rest.cells[map], !options.coarse});
        }
        std::vector<pollfd> waiting;
        for (const auto& [i, row] : running) waiting.push_back({row.descriptor(), POLLIN, 0});
        poll(waiting.data(), waiting.size(), 200);
        auto at = waiting.begin();
        for (auto it = running.begin(); it != running.end(); ++at) {
            auto& [i, row] = *it;
            done += at->revents != 0 ? row.read_on() : row.watch(options.seconds_a_cell);
            const Job& job = row.job();
            progress.show(done, job.map->name() + " " + job.integrator + " " + job.variant.name);
            if (!row.is_done()) {
                ++it;
                continue;
            }
            rows[i] = row_of(row, rest.cells[job.map]);
            keep(rows[i], file_of(job, options), digest);
            it = running.erase(it);
        }
    }
    return rows;
}

Row axes_row(const Map& map, bool coarse) {
    Row row;
    row["map"] = map.name();
    const auto add = [&](const std::string& name, const Axis& axis) {
        row[name] = axis.key;
        if (!axis.unit.empty()) row[name + "_unit"] = axis.unit;
        row[name + "_values"] = axis.values(coarse);
        if (axis.names.empty()) return;
        Row names = Row::array();
        for (const double value : axis.values(coarse)) names.push_back(axis.names.at(static_cast<std::size_t>(value)));
        row[name + "_names"] = names;
    };
    add("x", map.x());
    add("y", map.y());
    return row;
}

std::vector<Row> with_axes(const std::vector<Row>& rows, bool coarse) {
    std::vector<Row> all;
    std::string map;
    for (const Row& row : rows) {
        if (row.at("map") != map) {
            map = row.at("map");
            all.push_back(axes_row(map_named(map), coarse));
        }
        all.push_back(without_causes(row));
    }
    return all;
}
Row without_causes(Row row) {
    row.erase("silent_cells");
    return row;
}

}  // namespace tumble::bench::stress

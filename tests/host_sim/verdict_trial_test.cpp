// Verdicts on many runs, held against references that share no code with the verdict: an integration in long double up
// to the first contact; where bodies touch, two runs in double precision at a sixteenth and a thirty-second of the
// step.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <map>
#include <sstream>

#include "command/check.hpp"
#include "command/messages.hpp"
#include "command_runner.hpp"
#include "scene/data.hpp"
#include "scene/reader.hpp"
#include "simulation/simulation.hpp"
#include "truth/smooth_motion.hpp"
#include "verdict/record.hpp"
#include "verdict/verdict.hpp"

namespace tumble::host {
namespace {

using Kind = Verdict::Kind;
using States = std::vector<reference::Motion>;
constexpr double infinite = std::numeric_limits<double>::infinity();

// A scene of a file of sections, and its exceptions: a step and numbers, and the word that the command says there.
struct Section {
    std::string text;
    std::map<std::string, std::string> exceptions;
};
std::map<std::string, Section> sections_of(const char* file) {
    std::map<std::string, Section> sections;
    Section* section = nullptr;
    for (const std::string& line : lines_of(contents((source_directory / "tests/host_sim" / file).string()))) {
        if (line.starts_with("== ")) section = &sections[line.substr(3)];
        else if (line.starts_with("! ")) {
            std::istringstream words(line.substr(2));
            std::string step, numbers, word;
            words >> step >> numbers >> word;
            section->exceptions[step + " " + numbers] = word.substr(0, word.find(':'));
        } else if (section) section->text += (line.starts_with("$") ? sections.at(line).text : line) + "\n";
    }
    std::erase_if(sections, [](const auto& each) { return each.first.starts_with("$"); });
    return sections;
}

// What a run does and what the command says of it.
struct Judged {
    Record run;
    Verdict verdict;
    std::string facts, said;  // on standard error: before the run and after it
    int status = 0;
};
Judged judged(const SceneDescription& scene, const Method& method, const VerdictOptions& options) {
    Judged judged;
    std::ostringstream said;
    auto* const before = std::cerr.rdbuf(said.rdbuf());
    for (const std::string& limitation : limitations(scene)) judged.facts += limitation + "\n";
    const auto simulation = make_simulation(scene, method.integrator, method.numbers, method.carry);
    judged.facts += unheld_spin(scene, *simulation);
    judged.run = record_of(scene, method, 0, moments_of(scene));
    judged.verdict = verdict_of(scene, method, judged.run, options);
    judged.status = report(judged.verdict, scene, *simulation);
    std::cerr.rdbuf(before);
    judged.said = said.str();
    return judged;
}

// The states of all bodies at the moments of a run, as one or two references have them, and how far each body has
// moved.
struct Known {
    std::vector<States> one, other;  // other: only where bodies may touch
    std::vector<std::vector<double>> way_m;
    bool is_smooth = false, can_touch = false;
};

void add_way(const States& start, const States& now, std::vector<double>& way_m) {
    way_m.resize(start.size());
    for (std::size_t b = 0; b < way_m.size(); ++b)
        way_m[b] = std::max(way_m[b], static_cast<double>(norm(now[b].x - start[b].x)));
}

// As far as nothing touches.
Known smooth_motion(const SceneDescription& scene) {
    Known known;
    SmoothMotion motion(scene, shapes_meet);
    const States start = motion.bodies();
    const long double length = long_seconds(scene.step), band = scene.contact.tolerance;
    known.can_touch = motion.can_touch() && scene.contact.response != ContactResponse::none;
    if (known.can_touch && scene.contact.response == ContactResponse::spring && scene.contact.barrier > 0) return known;
    std::vector<double> way_m;
    std::int64_t now = 0;
    for (const std::int64_t moment : moments_of(scene)) {
        for (; now <= moment; ++now) {
            motion.advance_to(now);
            add_way(start, motion.bodies(), way_m);
            if (known.can_touch && motion.clearance() < band + motion.closing_speed() * length) return known;
        }
        known.one.push_back(motion.bodies());
        known.way_m.push_back(way_m);
    }
    known.is_smooth = true;
    return known;
}

// A run in double precision, up to where it leaves the range.
std::vector<States> fine_run(SceneDescription scene, const char* integrator, int halvings,
                             std::vector<std::vector<double>>& ways_m) {
    const std::vector<std::int64_t> moments = moments_of(scene);
    scene.step = scaled(scene.step, -halvings);
    const auto simulation = make_simulation(scene, integrator, "f64", false);
    const auto now = [&] {
        States states;
        for (int b = 0; b < simulation->body_count(); ++b) states.push_back(motion_of(simulation->body(b)));
        return states;
    };
    const States start = now();
    std::vector<States> run;
    std::vector<double> way_m;
    for (const std::int64_t moment : moments) {
        while (simulation->steps_taken() < moment << halvings && !simulation->has_trouble("range_left")) {
            simulation->step();
            if (simulation->steps_taken() % (std::int64_t{1} << halvings) == 0) add_way(start, now(), way_m);
        }
        if (simulation->has_trouble("range_left")) break;
        run.push_back(now());
        ways_m.push_back(way_m);
    }
    return run;
}

Known known_of(const SceneDescription& scene) {
    Known known = smooth_motion(scene);
    if (known.is_smooth) return known;
    known.way_m.clear();
    std::vector<std::vector<double>> unused;
    known.one = fine_run(scene, "rk4", 4, known.way_m);
    known.other = fine_run(scene, "suzuki4", 5, unused);
    return known;
}

// The distance of two states in parts of what counts as wrong: 0.1 rad, and a tenth of the way, but at least `least_m`.
double parts_of_wrong(const States& a, const States& b, const std::vector<double>& way_m, double least_m) {
    const double floor_m = *std::max_element(way_m.begin(), way_m.end()) / 100;
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!is_finite(a[i]) || !is_finite(b[i])) return infinite;
        Errors errors;
        errors.see(a[i], b[i]);
        const double limit_m = std::max(0.1 * std::max(way_m[i], floor_m), least_m);
        worst =
            std::max({worst, errors.orientation_rad / 0.1, errors.position_m > 0 ? errors.position_m / limit_m : 0});
    }
    return worst;
}

// Errors between half and twice the limit may be judged either way. Where the references part by more than a fifth of
// the limit, the run may be warned of; where they part by more than four times the limit, one of them is more than
// twice the limit from the run.
void expect_right_judgement(const SceneDescription& scene, const Known& known, const Judged& judged) {
    const Record& run = judged.run;
    const Verdict& verdict = judged.verdict;
    const bool has_band = known.can_touch && scene.contact.response == ContactResponse::impulse;
    const double least_m =
        std::max(has_band ? std::max(run.contact_tolerance, scene.contact.tolerance) : 0, run.rounding);
    const bool is_wrong = verdict.kind == Kind::wrong || verdict.kind == Kind::told;
    const auto is_called_right = [&](double time) {
        const double margin = 1e-6 * scene.duration;
        return verdict.kind == Kind::right || (verdict.kind == Kind::no_reference && time < verdict.time_s + margin) ||
               (is_wrong && time < verdict.time_s - margin);
    };
    const std::vector<std::int64_t> moments = moments_of(scene);
    double worst = 0;
    bool is_known = true;
    for (std::size_t m = 0; m < moments.size(); ++m) {
        const double time = static_cast<double>(moments[m]) * scene.step.seconds();
        const bool has_both = m < known.one.size() && (known.is_smooth || m < known.other.size());
        const auto error_to = [&](const std::vector<States>& reference) {
            return !has_both || m >= run.moments.size()
                       ? infinite
                       : parts_of_wrong(run.moments[m].bodies, reference[m], known.way_m[m], least_m);
        };
        const double doubt = !has_both         ? infinite
                             : known.is_smooth ? 0
                                               : parts_of_wrong(known.one[m], known.other[m], known.way_m[m], least_m);
        const double error = std::min(error_to(known.one), known.is_smooth ? infinite : error_to(known.other));
        if (is_called_right(time)) {
            EXPECT_LE(error, 2) << "silent at " << time << " s";
            EXPECT_LE(doubt, 4) << "silent at " << time << " s, where nothing is known";
        }
        is_known = is_known && doubt < 0.2;
        if (is_known) worst = std::max(worst, error);
    }
    EXPECT_NE(verdict.kind, Kind::unchecked) << verdict.obstacle;
    if (!is_known || worst >= 0.5) return;
    // A tolerance below the spacing of positions keeps flights from ending within it: a step meets its bound, and is
    // told.
    if (has_band && scene.contact.tolerance < run.spacing) return;
    EXPECT_FALSE(is_wrong || judged.status != 0 || !judged.said.empty())
        << "warned of at " << worst << " of the limit: " << judged.said;
    EXPECT_TRUE(!known.is_smooth || verdict.kind == Kind::right) << "not called right at " << worst << " of the limit";
}

// The cure is a run without trouble that is right at least at the first moment after what it cures.
void expect_cure(SceneDescription scene, const Known& known, const Verdict& verdict) {
    const Way& cure = *verdict.cure;
    const std::vector<std::int64_t> moments = moments_of(scene);
    const auto time_of = [&, seconds = scene.step.seconds()](std::size_t m) {
        return static_cast<double>(moments[m]) * seconds;
    };
    if (cure.restitution_threshold) scene.contact.restitution_threshold = *cure.restitution_threshold;
    const int halvings = static_cast<int>(std::lround(std::log2(scene.step.seconds() / cure.step.seconds())));
    const Record run = record_of(scene, cure.method, halvings, moments);
    EXPECT_TRUE(run.troubles.empty());
    const double least_m = known.can_touch ? std::max(run.contact_tolerance, scene.contact.tolerance) : run.rounding;
    for (std::size_t m = 0; m < std::min(known.one.size(), run.moments.size()); ++m) {
        double error = parts_of_wrong(run.moments[m].bodies, known.one[m], known.way_m[m], least_m);
        if (!known.is_smooth && m < known.other.size())
            error = std::min(error, parts_of_wrong(run.moments[m].bodies, known.other[m], known.way_m[m], least_m));
        EXPECT_LE(error, 2) << "cure at " << time_of(m) << " s";
        if (time_of(m) > verdict.time_s) break;
    }
}

// Files in the repository, and the sections of verdict_trial.txt.
std::map<std::string, std::string> trial_scenes() {
    std::map<std::string, std::string> scenes;
    for (const char* folder :
         {"host_sim/scenes", "host_sim/scenes/contacts", "bench/problems", "bench/contacts", "tests/property/scenes"})
        for (const auto& entry : std::filesystem::directory_iterator(source_directory / folder))
            if (entry.path().extension() == ".toml") {
                std::string name = std::string(folder) + "/" + entry.path().stem().string();
                std::replace(name.begin(), name.end(), '/', '_');
                scenes[name] = contents(entry.path().string());
            }
    for (const auto& [name, section] : sections_of("verdict_trial.txt")) scenes["own_" + name] = section.text;
    // The first falls into itself, which an integration in long double takes minutes to find; the reader refuses the
    // others.
    for (const char* left_out :
         {"falling_together", "absurd_plane", "anchor_across_the_range", "anchor_beyond_the_range",
          "far_plane_in_a_room", "far_tilted_plane", "plane_within_twice_the_range"})
        scenes.erase("tests_property_scenes_" + std::string(left_out));
    return scenes;
}
const std::map<std::string, std::string>& all_trial_scenes() {
    static const auto scenes = trial_scenes();
    return scenes;
}

// Of every kind one that takes little time.
bool is_quick(const std::string& name) {
    static const std::vector<std::string> quick{"host_sim_scenes_ball",
                                                "host_sim_scenes_pendulum",
                                                "host_sim_scenes_projectile",
                                                "own_damper",
                                                "own_masses_of_1_to_1e6",
                                                "own_slow_body_30_km_away",
                                                "own_star_with_a_light_planet",
                                                "own_tumbling_body",
                                                "own_two_oscillators_of_unlike_size",
                                                "tests_property_scenes_ball_in_a_rough_groove",
                                                "tests_property_scenes_small_die",
                                                "ball_dropped",
                                                "box_dropped_on_an_edge",
                                                "flat_box_on_ice_against_a_band",
                                                "small_ball_that_rolls",
                                                "mass_on_a_spring",
                                                "stack_of_three_boxes"};
    return std::find(quick.begin(), quick.end(), name) != quick.end();
}
template <class Scenes>
std::vector<std::string> names_of(const Scenes& scenes, bool quick) {
    std::vector<std::string> names;
    for (const auto& each : scenes)
        if (is_quick(each.first) == quick) names.push_back(each.first);
    return names;
}
const auto name_of_parameter = [](const auto& info) { return info.param; };

class VerdictTrial : public testing::TestWithParam<std::string> {};

TEST_P(VerdictTrial, neither_calls_a_wrong_run_right_nor_warns_of_a_right_one) {
    const SceneDescription scene =
        with_events_at_steps(read_scene_text(all_trial_scenes().at(GetParam()), "trial.toml"));
    const Known known = known_of(scene);
    for (const Method& method : {Method{"verlet", "q32", true}, Method{"semi_implicit_euler", "f64", false},
                                 Method{"explicit_euler", "f32", true}, Method{"rk4", "q32", true}}) {
        if (!has_range_for(scene, method.numbers)) continue;
        const Judged run = judged(scene, method, {});
        SCOPED_TRACE(method.integrator + " " + method.numbers + ": " + sentence_of(run.verdict, scene, method));
        expect_right_judgement(scene, known, run);
        if (run.verdict.cure) expect_cure(scene, known, run.verdict);
    }
}

class OrdinaryScene : public testing::TestWithParam<std::string> {};

SceneDescription ordinary_scene(const Section& section, const std::string& step) {
    std::string text = section.text;
    text.replace(text.find("STEP"), 4, "\"" + step + "\"");
    return read_scene_text(text, "ordinary.toml");
}

TEST_P(OrdinaryScene, ends_in_silence) {
    const Section section = sections_of("ordinary_scenes.txt").at(GetParam());
    for (const char* step : {"1/60", "1/256", "1/1000"})
        for (const Method& method :
             {Method{"verlet", "q32", true}, Method{"verlet", "f32", true}, Method{"verlet", "f64", false}}) {
            const SceneDescription scene = ordinary_scene(section, step);
            const Judged run = judged(scene, method, {});
            const std::string way = std::string(step) + " " + method.numbers;
            SCOPED_TRACE(way + ": " + sentence_of(run.verdict, scene, method));
            expect_right_judgement(scene, known_of(scene), run);
            if (const auto exception = section.exceptions.find(way); exception != section.exceptions.end()) {
                EXPECT_TRUE(has(run.said + name_of(run.verdict.kind), exception->second));
                continue;
            }
            EXPECT_EQ(run.status, 0);
            EXPECT_EQ(run.facts + run.said, "");
            EXPECT_NE(run.verdict.kind, Kind::wrong);
        }
}

TEST(OrdinaryCommand, ends_in_silence) {
    for (const auto& [name, section] : sections_of("ordinary_scenes.txt")) {
        if (!is_quick(name)) continue;
        std::string text = section.text;
        text.replace(text.find("STEP"), 4, "\"1/256\"");
        Process process({TUMBLE_COMMAND, "run", written(name + ".toml", text)}, {}, Process::Errors::keep);
        std::string table;
        EXPECT_EQ(process.wait(&table), 0) << name << table;
        EXPECT_EQ(process.errors(), "") << name;
        EXPECT_FALSE(has(table, "verdict: wrong")) << name << table;
    }
}

INSTANTIATE_TEST_SUITE_P(Deep, VerdictTrial, testing::ValuesIn(names_of(all_trial_scenes(), false)), name_of_parameter);
INSTANTIATE_TEST_SUITE_P(Quick, VerdictTrial, testing::ValuesIn(names_of(all_trial_scenes(), true)), name_of_parameter);
INSTANTIATE_TEST_SUITE_P(Deep, OrdinaryScene, testing::ValuesIn(names_of(sections_of("ordinary_scenes.txt"), false)),
                         name_of_parameter);
INSTANTIATE_TEST_SUITE_P(Quick, OrdinaryScene, testing::ValuesIn(names_of(sections_of("ordinary_scenes.txt"), true)),
                         name_of_parameter);

}  // namespace
}  // namespace tumble::host

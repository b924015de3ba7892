#include "verdict/verdict.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "scene/data.hpp"
#include "tools/text.hpp"
#include "truth/smooth_motion.hpp"

namespace tumble::host {
namespace {

// The references may part by this share of what counts as wrong: a right run is then not taken for a wrong one.
constexpr double share_of_doubt = 0.2;

// Pairs of references, the next where the one before parts: rk4 with the step halved so often, and suzuki4 with one
// halving more.
constexpr std::array<int, 3> halvings_of_references{2, 4, 6};
constexpr int most_halvings_of_cure = 5;

// Where joints tie bodies and nothing touches, the references are the equations of motion in other coordinates, and
// these again with a larger error of each step of the integration, as large as that of fine runs of free bodies.
constexpr double error_of_solution = 1e-14, error_of_other_solution = 1e-11;
// An integration of order 8 takes so much longer.
const double cost_of_solution = std::pow(error_of_other_solution / error_of_solution, 1.0 / 8);

// A body that symmetry holds still moves by rounding alone, which grows with the steps. Each body is judged as if it
// had moved by at least this share of the most that a body of the scene has: a tenth of that, a thousandth, is a pixel
// of a picture of the scene.
constexpr double share_of_scene = 0.01;

// Of the references, the coarser first.
const std::array<Method, 2> fine_methods{{{"rk4", "f64", false}, {"suzuki4", "f64", false}}};

// Two references and the moments up to which they agree.
struct Reference {
    Record fine, other;
    std::size_t moments = 0;    // that both have and at which they agree
    bool gains_energy = false;  // why they do not reach further

    [[nodiscard]] bool lasts(std::size_t all) const { return moments == all; }
    // The references know the bodies' states at a moment, though they may not agree.
    [[nodiscard]] bool has(std::size_t moment) const {
        return moment < std::min(fine.moments.size(), other.moments.size()) && !gains_energy;
    }
};

Errors distance(const reference::Motion& a, const reference::Motion& b) {
    Errors errors;
    errors.see(a, b);
    return errors;
}

// Processor time that runs may take, by the estimate of each.
class Budget {
public:
    explicit Budget(std::optional<double> seconds) : seconds_(seconds) {}
    [[nodiscard]] const std::optional<double>& left() const { return seconds_; }
    [[nodiscard]] bool takes(double seconds) {
        if (!seconds_) return true;
        if (seconds > *seconds_) return false;
        *seconds_ -= seconds;
        return true;
    }

private:
    std::optional<double> seconds_;
};

class Judge {
public:
    Judge(const SceneDescription& scene, const VerdictOptions& options, const Load& load)
        : scene_(with_events_at_steps(scene)), options_(options), load_(load), moments_(moments_of(scene_)),
          can_touch_(SmoothMotion(scene, shapes_meet).can_touch()),
          touches_(can_touch_ && scene.contact.response == ContactResponse::impulse) {
        require_no_events(scene);
        cost_s_ = seconds_of(halvings_of_references[0]) + seconds_of(halvings_of_references[0] + 1);
    }

    // False where the first pair exceeds the budget: it costs cost_s(), about.
    [[nodiscard]] bool run_references(Budget& budget) {
        if (is_solved()) return solve(budget);
        for (int pair = 0; pair < std::min<int>(options_.most_references, std::size(halvings_of_references)); ++pair) {
            const int halvings = halvings_of_references[static_cast<std::size_t>(pair)];
            if (reference_) {
                const bool has_failed = reference_->fine.moments.empty() || reference_->other.moments.empty();
                if (reference_->lasts(moments_.size()) || (halvings == halvings_of_references.back() && !has_failed))
                    break;
                if (reference_->gains_energy) break;
            }
            if (!budget.takes(seconds_of(halvings) + seconds_of(halvings + 1))) break;
            Reference next = references(halvings);
            if (!reference_ || next.moments > reference_->moments) reference_ = std::move(next);
        }
        return reference_.has_value();
    }
    [[nodiscard]] double cost_s() const { return cost_s_; }
    // The references are the equations of motion, and no runs.
    [[nodiscard]] bool is_solved() const {
        return !scene_.joints.empty() && !can_touch_ && without_equations(scene_.joints) == nullptr;
    }
    // Of a run with the scene's step halved so often.
    [[nodiscard]] double seconds_of(int halvings) const { return estimated_seconds(scene_, halvings, load_); }

    // How far from its place a body may begin without another motion: no numbers hold it nearer than their spacing, and
    // a contact lets it rest at any depth up to a quarter of the tolerance.
    [[nodiscard]] double doubt_of_places(const Record& run) const {
        const bool has_touched = touches_ && reference_->fine.load.pairs > 0;
        return has_touched ? std::max(run.spacing, scene_.contact.tolerance / 4) : run.spacing;
    }
    [[nodiscard]] int halvings_of(const Way& way) const {
        return static_cast<int>(std::lround(std::log2(scene_.step.seconds() / way.step.seconds())));
    }

    // Right, wrong or without a reference; what the status tells is left to the caller.
    [[nodiscard]] Verdict hold(const Record& run) const {
        Verdict verdict;
        verdict.kind = Verdict::Kind::right;
        for (std::size_t m = 0; m < run.moments.size(); ++m) {
            const bool has_parted = m >= reference_->moments;
            for (std::size_t b = 0; b < run.moments[m].bodies.size() && reference_->has(m); ++b)
                if (is_wrong(run, m, b, has_parted)) return wrong(run, m, b);
            if (has_parted) return without_reference(std::move(verdict), m);
            for (std::size_t b = 0; b < run.moments[m].bodies.size(); ++b) {
                verdict.error.see(run.moments[m].bodies[b], reference_->fine.moments[m].bodies[b]);
                verdict.doubt.see(reference_->other.moments[m].bodies[b], reference_->fine.moments[m].bodies[b]);
            }
        }
        // Where the status ended the run, the status tells why.
        if (run.moments.size() == moments_.size() || !run.troubles.empty()) return verdict;
        if (!reference_->lasts(moments_.size()) && run.moments.size() >= reference_->moments)
            return without_reference(std::move(verdict), run.moments.size());
        // The references go on where the run has no finite state.
        constexpr double infinite = std::numeric_limits<double>::infinity();
        verdict.kind = Verdict::Kind::wrong;
        verdict.time_s = time_of(run.moments.size());
        verdict.body = run.not_finite;
        verdict.error = {infinite, infinite};
        verdict.is_as_large_as_motion = true;
        return verdict;
    }

    // Right to the end, or as far as the references know and at least to the time of the verdict, without a word of the
    // status. `shift`: the most that a body begins beside its place along each axis, m. A fixed body stays, and so does
    // a coordinate of 0, which all numbers hold: a motion in a plane or on a line remains one.
    [[nodiscard]] bool is_good(const Way& way, const Verdict& verdict, double shift = 0) const {
        SceneDescription scene = scene_;
        if (way.restitution_threshold) scene.contact.restitution_threshold = *way.restitution_threshold;
        int axis = 0;
        for (BodyDescription& body : scene.bodies)
            for (double& x : body.position) x += body.fixed || x == 0 ? 0 : shift * part_of_shift(axis++);
        try {
            Record record = record_of(scene, way.method, halvings_of(way), moments_);
            record.rounding += 2 * std::abs(shift);  // it is no error
            if (!record.troubles.empty()) return false;
            const Verdict own = hold(record);
            return own.kind == Verdict::Kind::right ||
                   (own.kind == Verdict::Kind::no_reference && own.time_s > 0 && own.time_s >= verdict.time_s);
        } catch (const std::exception&) {
            return false;  // it does not take the scene
        }
    }
    [[nodiscard]] const SceneDescription& scene() const { return scene_; }
    [[nodiscard]] bool is_compiled(const Method& method) const {
        return host::is_compiled(scene_, method.integrator, method.numbers, method.carry);
    }

private:
    // From -1 to 1: multiples of the golden ratio, which have no pattern.
    [[nodiscard]] static double part_of_shift(int axis) {
        const double turns = 0.6180339887498949 * axis;
        return 2 * (turns - std::floor(turns)) - 1;
    }
    [[nodiscard]] double time_of(std::size_t moment) const {
        return static_cast<double>(static_cast<long double>(moments_[moment]) * long_seconds(scene_.step));
    }

    // How far a body has moved and turned, with a floor.
    [[nodiscard]] static Errors motion_at(const Moment& truth, std::size_t b) {
        const auto floored = [&](const std::vector<double>& all) {
            return std::max(all[b], share_of_scene * *std::max_element(all.begin(), all.end()));
        };
        return {floored(truth.way_m), floored(truth.turn_rad)};
    }
    // What an error must exceed to be wrong, m and rad.
    [[nodiscard]] Errors limits(const Record& run, const Moment& truth, std::size_t b) const {
        const double band = touches_ ? std::max(run.contact_tolerance, scene_.contact.tolerance) : 0;
        Errors limits;
        limits.position_m = std::max({options_.tolerance * motion_at(truth, b).position_m, band, run.rounding});
        limits.orientation_rad = options_.tolerance;
        return limits;
    }
    [[nodiscard]] static double in_parts_of(const Errors& limits, const Errors& errors) {
        const double position = limits.position_m > 0   ? errors.position_m / limits.position_m
                                : errors.position_m > 0 ? std::numeric_limits<double>::infinity()
                                                        : 0;
        return std::max(position, errors.orientation_rad / limits.orientation_rad);
    }
    [[nodiscard]] Errors doubt_at(std::size_t m, std::size_t b) const {
        return distance(reference_->other.moments[m].bodies[b], reference_->fine.moments[m].bodies[b]);
    }
    // Where the references have parted, only an error far beyond their doubt is wrong.
    [[nodiscard]] bool is_wrong(const Record& run, std::size_t m, std::size_t b, bool has_parted) const {
        const Errors limit = limits(run, reference_->fine.moments[m], b);
        const double error =
            in_parts_of(limit, distance(run.moments[m].bodies[b], reference_->fine.moments[m].bodies[b]));
        return error > 1 && (!has_parted || in_parts_of(limit, doubt_at(m, b)) <= share_of_doubt * error);
    }

    [[nodiscard]] Verdict wrong(const Record& run, std::size_t m, std::size_t first) const {
        Verdict verdict;
        verdict.kind = Verdict::Kind::wrong;
        verdict.time_s = time_of(m);
        double worst = 0;
        for (std::size_t b = first; b < run.moments[m].bodies.size(); ++b) {
            const Errors error = distance(run.moments[m].bodies[b], reference_->fine.moments[m].bodies[b]);
            const double parts = in_parts_of(limits(run, reference_->fine.moments[m], b), error);
            if (parts <= worst) continue;
            worst = parts;
            verdict.body = static_cast<int>(b);
            verdict.error = error;
            verdict.doubt = doubt_at(m, b);
        }
        for (std::size_t later = m; later < std::min(run.moments.size(), reference_->moments); ++later)
            for (std::size_t b = 0; b < run.moments[later].bodies.size(); ++b)
                verdict.is_as_large_as_motion = verdict.is_as_large_as_motion || is_as_large_as_motion(run, later, b);
        return verdict;
    }
    [[nodiscard]] bool is_as_large_as_motion(const Record& run, std::size_t m, std::size_t b) const {
        const Moment& truth = reference_->fine.moments[m];
        const Errors error = distance(run.moments[m].bodies[b], truth.bodies[b]), limit = limits(run, truth, b),
                     motion = motion_at(truth, b);
        return (error.position_m > limit.position_m && error.position_m >= motion.position_m) ||
               (error.orientation_rad > limit.orientation_rad && error.orientation_rad >= motion.orientation_rad);
    }
    [[nodiscard]] Verdict without_reference(Verdict verdict, std::size_t m) const {
        verdict.kind = Verdict::Kind::no_reference;
        verdict.time_s = m == 0 ? 0 : time_of(m - 1);
        verdict.parted_s = time_of(m);
        verdict.gains_energy = reference_->gains_energy;
        if (!reference_->has(m)) return verdict;
        verdict.doubt = {};
        for (std::size_t b = 0; b < reference_->fine.moments[m].bodies.size(); ++b) {
            const Errors doubt = doubt_at(m, b);
            if (doubt.largest() > verdict.doubt.largest()) verdict.body = static_cast<int>(b), verdict.doubt = doubt;
        }
        return verdict;
    }

    [[nodiscard]] bool solve(Budget& budget) {
        Reference pair;
        SolvedRecord other = solved_record_of(scene_, error_of_other_solution, moments_, budget.left());
        cost_s_ = other.seconds * (1 + cost_of_solution);
        if (!budget.takes(cost_s_)) return false;
        pair.other = std::move(other.record);
        pair.fine = solved_record_of(scene_, error_of_solution, moments_).record;
        while (pair.moments < moments_.size() && agree(pair, pair.moments)) ++pair.moments;
        reference_ = std::move(pair);
        return true;
    }
    [[nodiscard]] Reference references(int halvings) const {
        // Energy that grows by a share of the motion's changes speeds, and so distances, by half of that share.
        const double most_gain = 2 * share_of_doubt * options_.tolerance;
        Reference pair;
        // A bounded step is held against the exact one.
        SceneDescription exact = scene_;
        exact.contact.exact_bodies = ContactSpec::any;
        pair.fine = record_of(exact, fine_methods[0], halvings, moments_, most_gain);
        pair.other = record_of(exact, fine_methods[1], halvings + 1, moments_, most_gain);
        std::size_t last = std::min(pair.fine.moments.size(), pair.other.moments.size());
        for (const Record* record : {&pair.fine, &pair.other}) {
            if (!record->gained || *record->gained >= last) continue;
            last = *record->gained;
            pair.gains_energy = true;
        }
        while (pair.moments < last && agree(pair, pair.moments)) ++pair.moments;
        if (pair.moments < last) pair.gains_energy = false;
        return pair;
    }
    [[nodiscard]] bool agree(const Reference& pair, std::size_t m) const {
        for (std::size_t b = 0; b < pair.fine.moments[m].bodies.size(); ++b) {
            const Errors doubt = distance(pair.fine.moments[m].bodies[b], pair.other.moments[m].bodies[b]),
                         limit = limits(pair.fine, pair.fine.moments[m], b);
            if (doubt.position_m > std::max(share_of_doubt * limit.position_m, pair.fine.rounding)) return false;
            if (doubt.orientation_rad > share_of_doubt * limit.orientation_rad) return false;
        }
        return true;
    }

    SceneDescription scene_;
    VerdictOptions options_;
    Load load_;
    std::vector<std::int64_t> moments_;
    bool can_touch_, touches_;
    double cost_s_ = 0;
    std::optional<Reference> reference_;
};

bool is_cured_by_search(const Verdict& verdict) {
    if (verdict.kind == Verdict::Kind::wrong) return true;
    if (verdict.kind != Verdict::Kind::told) return false;
    const std::string& issue = verdict.troubles.front().issue;
    return issue == "range_left" || issue == "step_too_long" || issue == "step_bound_hit";
}

// Ways that change one thing, the cheapest first.
std::vector<Way> finer_steps(const Way& way) {
    std::vector<Way> ways;
    for (int halvings = 1; halvings <= most_halvings_of_cure; ++halvings)
        ways.push_back({way.method, scaled(way.step, -halvings)});
    return ways;
}
std::vector<Way> other_methods(const Way& way) {
    std::vector<Way> ways;
    for (const char* integrator : {"verlet", "rk4", "suzuki4"})
        if (integrator != way.method.integrator)
            ways.push_back({{integrator, way.method.numbers, way.method.carry}, way.step});
    return ways;
}
std::vector<Way> better_numbers(const Way& way) {
    std::vector<Way> ways;
    if (!way.method.carry) ways.push_back({{way.method.integrator, way.method.numbers, true}, way.step});
    for (const char* numbers : {"f32", "f64"})
        if (way.method.numbers != "f64" && way.method.numbers != numbers)
            ways.push_back({{way.method.integrator, numbers, carries_by_default(numbers)}, way.step});
    return ways;
}

// Thresholds above the bounces of what gravity presses, whose number in a step has no end.
std::vector<Way> thresholds(const Way& way, const SceneDescription& scene) {
    std::vector<Way> ways;
    for (const double steps : {4, 16, 64}) {
        const double speed = steps * scene.most_gravity() * way.step.seconds();
        if (speed > scene.contact.restitution_threshold)
            ways.push_back({way.method, way.step, std::stod(two_digits(speed))});
    }
    return ways;
}

// Looks for a way that is right, and that is so for another reason than luck. It compiles nothing.
class Search {
public:
    // `doubt`: how far a body may begin from its place, m, without another motion.
    Search(const Judge& judge, const Verdict& verdict, double doubt, const Budget& budget)
        : judge_(judge), verdict_(verdict), doubt_(doubt), budget_(budget) {}

    [[nodiscard]] std::optional<Way> first_good(const std::vector<Way>& ways) {
        const auto found = std::find_if(ways.begin(), ways.end(), [&](const Way& way) { return is_confirmed(way); });
        return found == ways.end() ? std::nullopt : std::optional{*found};
    }
    // It is right, at half its step too, and where the bodies begin a little beside their places: neither the step nor
    // a rounding decides what comes out.
    [[nodiscard]] bool is_confirmed(const Way& way) {
        if (!judge_.is_compiled(way.method)) {
            is_complete_ = false;
            return false;
        }
        if (!runs_well(way)) return false;
        Way finer = way;
        finer.step = scaled(way.step, -1);
        const bool is_sure = runs_well(way, doubt_) && runs_well(way, -doubt_) && runs_well(finer) &&
                             runs_well(way, doubt_ / 2) && runs_well(way, -doubt_ / 2) && runs_well(finer, -doubt_);
        is_complete_ = is_complete_ && is_sure;
        return is_sure;
    }
    // A way has been run: before that, none was found because none was looked for.
    [[nodiscard]] bool has_tried() const { return has_tried_; }
    // No way was left out, and none was right by luck: what has not helped is not the cause.
    [[nodiscard]] bool is_complete() const { return is_complete_; }

private:
    [[nodiscard]] bool runs_well(const Way& way, double shift = 0) {
        if (!budget_.takes(judge_.seconds_of(judge_.halvings_of(way)))) {
            is_complete_ = false;
            return false;
        }
        has_tried_ = true;
        return judge_.is_good(way, verdict_, shift);
    }

    const Judge& judge_;
    const Verdict& verdict_;
    double doubt_;
    Budget budget_;
    bool is_complete_ = true, has_tried_ = false;
};

// Exchanges numbers, then the method, then the step. Where the search is not complete, a finer step that helps does not
// prove that the step was the cause.
void exchange(Verdict& verdict, Search& search, const Way& way) {
    using enum Verdict::Cause;
    const Way in_f64{{way.method.integrator, "f64", carries_by_default("f64")}, way.step};
    if (way.method.numbers != "f64" && search.is_confirmed(in_f64)) {
        verdict.cause = numbers;
        // A finer step may fit the same numbers, which are cheaper on the core than others.
        std::vector<Way> ways = verdict.troubles.empty() ? std::vector<Way>{} : finer_steps(way);
        for (const Way& each : better_numbers(way)) ways.push_back(each);
        verdict.cure = search.first_good(ways);
    } else if ((verdict.cure = search.first_good(other_methods(way)))) {
        verdict.cause = method;
    } else {
        verdict.cure = search.first_good(finer_steps(way));
        verdict.cause = search.is_complete() ? step : none;
    }
}

// Looks for cause and cure. Of a bound of impacts, a threshold may be the cure; it has no cause.
void explain(Verdict& verdict, const Judge& judge, const Way& way, double doubt, const Budget& budget) {
    const Verdict held = verdict;
    Search search(judge, held, doubt, budget);
    const bool is_told = !verdict.troubles.empty();
    if (is_told && verdict.troubles.front().issue == "step_bound_hit")
        verdict.cure = search.first_good(thresholds(way, judge.scene()));
    if (!verdict.cure) exchange(verdict, search, way);
    verdict.is_searched = search.has_tried();
}

}  // namespace

Verdict told_by(const Record& run, const SceneDescription& scene) {
    Verdict verdict;
    if (run.troubles.empty()) return verdict;
    verdict.kind = Verdict::Kind::told;
    verdict.troubles = run.troubles;
    verdict.body = run.troubles.front().body;
    verdict.time_s = static_cast<double>(run.troubles.front().step) * scene.step.seconds();
    return verdict;
}

Verdict verdict_of(const SceneDescription& scene, const Method& method, const VerdictOptions& options) {
    const std::vector<std::int64_t> moments = moments_of(scene);
    return verdict_of(scene, method, moments.empty() ? Record{} : record_of(scene, method, 0, moments), options);
}

Verdict verdict_of(const SceneDescription& scene, const Method& method, const Record& run,
                   const VerdictOptions& options) {
    Verdict verdict = told_by(run, scene);
    if (scene.steps() == 0) {
        if (run.troubles.empty()) verdict.kind = Verdict::Kind::right;
        return verdict;
    }
    try {
        Judge judge(scene, options, run.load);
        Budget budget(options.most_seconds);
        if (!judge.run_references(budget)) {
            verdict.cost_s = judge.cost_s();
            return verdict;
        }
        Verdict held = judge.hold(run);
        held.troubles = run.troubles;
        held.rules = run.rules;
        held.is_solved = judge.is_solved();
        if (!scene.joints.empty() && !held.is_solved) held.rules.push_back(SharedRule::joints);
        if (run.troubles.empty() || held.kind == Verdict::Kind::wrong) verdict = std::move(held);
        else verdict.error = held.error;
        if (options.explains && is_cured_by_search(verdict))
            explain(verdict, judge, {method, scene.step}, judge.doubt_of_places(run), Budget(options.most_seconds));
    } catch (const std::exception& error) {
        const std::string what = error.what();
        verdict.obstacle = what.substr(0, what.find('\n'));
    }
    return verdict;
}

}  // namespace tumble::host

#include "verdict/verdict.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "scene/data.hpp"
#include "scene/reader.hpp"
#include "tools/text.hpp"
#include "truth/smooth_motion.hpp"
#include "verdict/record.hpp"

namespace tumble::host {
namespace {

// The references may part by this share of what counts as wrong: a right run is then not taken for a wrong one.
constexpr double share_of_doubt = 0.2;

// Pairs of references, the next where the one before parts: rk4 with the step halved so often, and suzuki4 with one
// halving more.
constexpr std::array<int, 3> halvings_of_references{2, 4, 6};
constexpr int most_halvings_of_cure = 5;

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

class Judge {
public:
    Judge(const SceneDescription& scene, const VerdictOptions& options)
        : scene_(with_events_at_steps(scene)), options_(options), moments_(moments_of(scene_)),
          touches_(scene.contact.response == ContactResponse::impulse && SmoothMotion(scene, shapes_meet).can_touch()) {
    }

    // Throws ProcessorTime::TooDear.
    void run_references(const ProcessorTime& time) {
        for (int pair = 0; pair < std::min<int>(options_.most_references, std::size(halvings_of_references)); ++pair) {
            const int halvings = halvings_of_references[static_cast<std::size_t>(pair)];
            if (reference_) {
                const bool has_failed = reference_->fine.moments.empty() || reference_->other.moments.empty();
                if (reference_->lasts(moments_.size()) || (halvings == halvings_of_references.back() && !has_failed))
                    return;
                if (reference_->gains_energy) return;
            }
            try {
                Reference next = references(halvings, time);
                if (!reference_ || next.moments > reference_->moments) reference_ = std::move(next);
            } catch (const ProcessorTime::TooDear&) {
                if (!reference_) throw;
                return;
            }
        }
    }

    [[nodiscard]] Record run(const Way& way, const ProcessorTime& time) const {
        return record_of(scene_, way.method, halvings_of(way), moments_, time);
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
        if (run.moments.size() < moments_.size() && !reference_->lasts(moments_.size()))
            return without_reference(std::move(verdict), run.moments.size());
        return verdict;
    }

    // Right as far as a reference knows, without a word of the status.
    [[nodiscard]] bool is_good(const Way& way, const ProcessorTime& time) const {
        const Record record = run(way, time);
        return record.troubles.empty() && hold(record).kind != Verdict::Kind::wrong;
    }
    [[nodiscard]] const SceneDescription& scene() const { return scene_; }

private:
    [[nodiscard]] int halvings_of(const Way& way) const {
        return static_cast<int>(std::lround(std::log2(scene_.step.seconds() / way.step.seconds())));
    }
    [[nodiscard]] double time_of(std::size_t moment) const {
        return static_cast<double>(static_cast<long double>(moments_[moment]) * long_seconds(scene_.step));
    }

    // What an error must exceed to be wrong, in parts of the limits that this returns: m and rad.
    [[nodiscard]] Errors limits(const Record& run, const Moment& truth, std::size_t b) const {
        const double band = touches_ ? std::max(run.contact_tolerance, scene_.contact.tolerance) : 0;
        Errors limits;
        limits.position_m = std::max({options_.tolerance * truth.way_m[b], band, run.resolution});
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
        const Errors error = distance(run.moments[m].bodies[b], truth.bodies[b]), limit = limits(run, truth, b);
        return (error.position_m > limit.position_m && error.position_m >= truth.way_m[b]) ||
               (error.orientation_rad > limit.orientation_rad && error.orientation_rad >= truth.turn_rad[b]);
    }
    [[nodiscard]] Verdict without_reference(Verdict verdict, std::size_t m) const {
        verdict.kind = Verdict::Kind::no_reference;
        verdict.time_s = time_of(m);
        verdict.gains_energy = reference_->gains_energy;
        if (!reference_->has(m)) return verdict;
        verdict.doubt = {};
        for (std::size_t b = 0; b < reference_->fine.moments[m].bodies.size(); ++b) {
            const Errors doubt = doubt_at(m, b);
            if (doubt.largest() > verdict.doubt.largest()) verdict.body = static_cast<int>(b), verdict.doubt = doubt;
        }
        return verdict;
    }

    [[nodiscard]] Reference references(int halvings, const ProcessorTime& time) const {
        // Energy that grows by a share of the motion's changes speeds, and so distances, by half of that share.
        const double most_gain = 2 * share_of_doubt * options_.tolerance;
        Reference pair;
        pair.fine = record_of(scene_, {"rk4", "f64", true}, halvings, moments_, time, most_gain);
        pair.other = record_of(scene_, {"suzuki4", "f64", true}, halvings + 1, moments_, time, most_gain);
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
            if (doubt.position_m > std::max(share_of_doubt * limit.position_m, pair.fine.resolution)) return false;
            if (doubt.orientation_rad > share_of_doubt * limit.orientation_rad) return false;
        }
        return true;
    }

    SceneDescription scene_;
    VerdictOptions options_;
    std::vector<std::int64_t> moments_;
    bool touches_;
    std::optional<Reference> reference_;
};

bool is_cured_by_search(const Verdict& verdict) {
    if (verdict.kind == Verdict::Kind::wrong) return true;
    if (verdict.kind != Verdict::Kind::told) return false;
    const std::string& issue = verdict.troubles.front().issue;
    return issue == "range_left" || issue == "step_too_long";
}

// The default of a number system.
bool carries(const std::string& numbers) { return numbers != "f64"; }

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
            ways.push_back({{way.method.integrator, numbers, carries(numbers)}, way.step});
    return ways;
}

// Exchanges numbers, then the method, then the step, and looks for a way that is right.
void explain(Verdict& verdict, const Judge& judge, const Way& way, const ProcessorTime& time) {
    const auto first_good = [&](const std::vector<Way>& ways) -> std::optional<Way> {
        for (const Way& each : ways)
            if (judge.is_good(each, time)) return each;
        return {};
    };
    using enum Verdict::Cause;
    try {
        const Way in_f64{{way.method.integrator, "f64", carries("f64")}, way.step};
        if (way.method.numbers != "f64" && judge.is_good(in_f64, time)) {
            verdict.cause = numbers;
            // A finer step may fit the same numbers, which are cheaper on the core than others.
            std::vector<Way> ways = verdict.kind == Verdict::Kind::told ? finer_steps(way) : std::vector<Way>{};
            for (const Way& each : better_numbers(way)) ways.push_back(each);
            verdict.cure = first_good(ways);
        } else if ((verdict.cure = first_good(other_methods(way)))) {
            verdict.cause = method;
        } else {
            verdict.cause = step;
            verdict.cure = first_good(finer_steps(way));
        }
    } catch (const ProcessorTime::TooDear&) { verdict.cause = verdict.cure ? verdict.cause : none; }
}

std::string errors_text(const Errors& errors) {
    return two_digits(errors.position_m) + " m and " + two_digits(errors.orientation_rad) + " rad";
}

}  // namespace

Verdict verdict_of(const SceneDescription& scene, const Method& method, const VerdictOptions& options) {
    Verdict verdict;
    verdict.kind = Verdict::Kind::right;
    if (scene.steps() == 0) return verdict;
    Judge judge(scene, options);
    const ProcessorTime time(options.most_seconds);
    const Way way{method, judge.scene().step};
    try {
        const Record run = judge.run(way, time);
        judge.run_references(time);
        verdict = judge.hold(run);
        if (!run.troubles.empty()) {
            const Trouble& first = run.troubles.front();
            verdict.kind = Verdict::Kind::told;
            verdict.troubles = run.troubles;
            verdict.body = first.body;
            verdict.time_s = static_cast<double>(first.step) * judge.scene().step.seconds();
        }
    } catch (const ProcessorTime::TooDear& dear) {
        verdict.kind = Verdict::Kind::unchecked;
        verdict.cost_s = dear.seconds;
        return verdict;
    }
    if (options.explains && is_cured_by_search(verdict)) {
        const ProcessorTime more(options.most_seconds);
        explain(verdict, judge, way, more);
    }
    return verdict;
}

const char* name_of(Verdict::Kind kind) {
    switch (kind) {
    case Verdict::Kind::right: return "right";
    case Verdict::Kind::wrong: return "wrong";
    case Verdict::Kind::told: return "told";
    case Verdict::Kind::no_reference: return "no_reference";
    default: return "unchecked";
    }
}

const char* name_of(Verdict::Cause cause) {
    switch (cause) {
    case Verdict::Cause::numbers: return "numbers";
    case Verdict::Cause::method: return "method";
    case Verdict::Cause::step: return "step";
    default: return "";
    }
}

std::string options_of(const Way& cure, const Way& run) {
    std::string text;
    const auto add = [&](const std::string& option) { text += (text.empty() ? "" : " ") + option; };
    if (cure.method.integrator != run.method.integrator) add("--integrator " + cure.method.integrator);
    if (cure.method.numbers != run.method.numbers) add("--numbers " + cure.method.numbers);
    if (cure.method.carry !=
        (cure.method.numbers == run.method.numbers ? run.method.carry : carries(cure.method.numbers)))
        add(cure.method.carry ? "--carry on" : "--carry off");
    if (cure.step.seconds() != run.step.seconds()) add("--step " + step_text(cure.step));
    return text;
}

std::string sentence_of(const Verdict& verdict, const SceneDescription& scene, const Method& method) {
    const auto body = [&] {
        return verdict.body < 0 ? std::string() : "body \"" + scene.body(verdict.body).name + "\" ";
    };
    const std::string time = few_digits(verdict.time_s) + " s",
                      cure = verdict.cure ? "; right with " + options_of(*verdict.cure, {method, scene.step}) : "";
    switch (verdict.kind) {
    case Verdict::Kind::right: return "right: the error is at most " + errors_text(verdict.error);
    case Verdict::Kind::wrong:
        return "wrong from " + time + " on: " + body() + "is off by " + errors_text(verdict.error) +
               (verdict.cause == Verdict::Cause::none ? "" : std::string("; cause: the ") + name_of(verdict.cause)) +
               cure;
    case Verdict::Kind::told:
        return "reported by the status: " + verdict.troubles.front().issue + " of " + body() + "at " + time + cure;
    case Verdict::Kind::no_reference:
        return "right until " + time + ", with an error of at most " + errors_text(verdict.error) +
               "; no reference from there on: two finer runs " +
               (verdict.gains_energy ? "gain energy that no load gave" : "differ by " + errors_text(verdict.doubt));
    default: return "not checked: the check takes about " + few_digits(std::ceil(verdict.cost_s)) + " s (--check on)";
    }
}

}  // namespace tumble::host

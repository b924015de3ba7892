// What a verdict says, in words.
#include <cmath>

#include "scene/reader.hpp"
#include "tools/text.hpp"
#include "verdict/verdict.hpp"

namespace tumble::host {
namespace {

std::string errors_text(const Errors& errors) {
    return two_digits(errors.position_m) + " m and " + two_digits(errors.orientation_rad) + " rad";
}

// ", as far as runs with the same rules of friction and sleep can tell"; empty where none is shared.
std::string shared_text(const std::vector<SharedRule>& rules) {
    std::string list;
    for (std::size_t i = 0; i < rules.size(); ++i)
        list += std::string(i == 0 ? "" : i + 1 == rules.size() ? " and " : ", ") + name_of(rules[i]);
    return list.empty() ? ""
                        : ", as far as runs with the same rule" + std::string(rules.size() > 1 ? "s" : "") + " of " +
                              list + " can tell";
}

}  // namespace

bool carries_by_default(const std::string& numbers) { return numbers != "f64"; }

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
        (cure.method.numbers == run.method.numbers ? run.method.carry : carries_by_default(cure.method.numbers)))
        add(cure.method.carry ? "--carry on" : "--carry off");
    if (cure.step.seconds() != run.step.seconds()) add("--step " + step_text(cure.step));
    if (cure.restitution_threshold) add("contact.restitution_threshold = " + few_digits(*cure.restitution_threshold));
    return text;
}

std::string sentence_of(const Verdict& verdict, const SceneDescription& scene, const Method& method) {
    const auto body = [&] {
        return verdict.body < 0 ? std::string() : "body \"" + scene.body(verdict.body).name + "\" ";
    };
    const std::string time = few_digits(verdict.time_s) + " s",
                      cure = verdict.cure          ? "; right with " + options_of(*verdict.cure, {method, scene.step})
                             : verdict.is_searched ? "; no way was found that is known to be right"
                                                   : "";
    switch (verdict.kind) {
    case Verdict::Kind::right:
        return "right" + shared_text(verdict.rules) + ": the error is at most " + errors_text(verdict.error);
    case Verdict::Kind::wrong:
        return "wrong from " + time + " on: " + body() +
               (std::isfinite(verdict.error.position_m) ? "is off by " + errors_text(verdict.error) : "is not finite") +
               (verdict.troubles.empty() ? "" : "; the status reports " + verdict.troubles.front().issue) +
               (verdict.cause == Verdict::Cause::none ? "" : std::string("; cause: the ") + name_of(verdict.cause)) +
               cure;
    case Verdict::Kind::told:
        return "reported by the status: " + verdict.troubles.front().issue + (verdict.body < 0 ? " " : " of ") +
               body() + "at " + time + cure;
    case Verdict::Kind::no_reference:
        return (verdict.time_s > 0 ? "right until " + time + shared_text(verdict.rules) +
                                         ", with an error of at most " + errors_text(verdict.error) + "; "
                                   : "") +
               "no reference" + (verdict.time_s > 0 ? " from there on" : "") + ": two " +
               (verdict.is_solved ? "solutions of the equations of motion " : "finer runs ") +
               (verdict.gains_energy
                    ? "gain energy that no load gave"
                    : "differ by " + errors_text(verdict.doubt) + " at " + few_digits(verdict.parted_s) + " s");
    default:
        if (!verdict.obstacle.empty()) return "not checked: " + verdict.obstacle;
        return "not checked: the check takes about " + few_digits(std::ceil(verdict.cost_s)) + " s (--check on)";
    }
}

}  // namespace tumble::host

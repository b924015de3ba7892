#include "command/advice.hpp"

#include <tumble/version.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "scene/reader.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Attempt& attempt) {
    const bool has_errors = attempt.failure.empty();
    Json json;
    json["integrator"] = attempt.method.integrator;
    json["numbers"] = attempt.method.numbers;
    json["carry"] = attempt.method.carry;
    json["step_s"] = attempt.length.seconds();
    json["position_error_m"] = has_errors ? Json(attempt.errors.position_m) : Json();
    json["orientation_error_rad"] = has_errors ? Json(attempt.errors.orientation_rad) : Json();
    if (!has_errors) json["failure"] = attempt.failure;
    return json;
}

// The shares of a step's time that the mean and the worst step take.
struct Shares {
    double cycles, mean, worst;  // cycles: of the core, in the time of a step
};
Shares shares_of(double clock, const Candidate& candidate) {
    const StepCost cost = cycles_of(candidate.row);
    const double cycles = clock * candidate.attempt.length.seconds();
    return {cycles, cost.mean / cycles, cost.worst / cycles};
}

Json json_of(const AdviseOptions& options, const Candidate& candidate) {
    Json json = json_of(candidate.attempt);
    const Json& row = candidate.row;
    if (row.is_null()) {
        json["reason"] = candidate.not_measured;
        return json;
    }
    const double step = candidate.attempt.length.seconds();
    json["insn_per_simulated_second"] = row.at("insn_per_step").get<double>() / step;
    json["measured_steps"] = row.at("steps");
    for (const char* key :
         {"insn_per_step", "insn_per_step_max", "text_bytes", "ram_bytes", "stack_bytes", "state_hash"})
        json[key] = row.at(key);
    if (!has_cycles(row)) return json;
    for (const std::string bound : {"min", "est", "max"})
        json["cycles_per_simulated_second_" + bound] = row.at("cycles_per_step_" + bound).get<double>() / step;
    for (const char* key :
         {"cycles_per_step_min", "cycles_per_step_est", "cycles_per_step_max", "cycles_worst_step_min",
          "cycles_worst_step_est", "cycles_worst_step_max", "timing", "memory"})
        json[key] = row.at(key);
    if (options.clock) {
        const Shares shares = shares_of(*options.clock, candidate);
        json["mean_share_of_step"] = shares.mean;
        json["worst_share_of_step"] = shares.worst;
    }
    return json;
}

std::string percent(double share) { return few_digits(std::round(share * 10000) / 100) + " %"; }

// A title and, under it, names in lines of a terminal's width.
void print_list(const std::string& title, const std::vector<std::string>& names) {
    if (names.empty()) return;
    std::cout << "\n" << title << "\n";
    std::string line;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::string name = names[i] + (i + 1 < names.size() ? "," : "");
        if (line.size() + name.size() > 110) {
            std::cout << " " << line << "\n";
            line.clear();
        }
        line += " " + name;
    }
    std::cout << " " << line << "\n";
}

void print_best(const AdviseOptions& options, const SceneDescription& scene, const Advice& advice) {
    const Candidate& best = advice.ranking.front();
    const Method& method = best.attempt.method;
    const std::string limit = few_digits(options.tolerance), step = step_text(best.attempt.length);
    std::cout << options.core << ": " << method.integrator << " in " << method.numbers
              << (method.carry ? " with carry" : " without carry") << " at a step of " << step << " s keeps \""
              << scene.name << "\" within " << limit << " m and " << limit << " rad for " << std::llround(best.cost)
              << " " << advice.unit() << " a simulated second" << (advice.in_cycles ? ", at zero wait states" : "")
              << ".\n";
    if (!options.clock) return;
    const Shares shares = shares_of(*options.clock, best);
    std::cout << "At " << few_digits(*options.clock / 1e6) << " MHz a step of " << step << " s has "
              << std::llround(shares.cycles) << " cycles: the mean step takes " << percent(shares.mean)
              << " of them, the worst one at most " << percent(shares.worst)
              << (shares.worst > 1 ? ", more than there are" : "") << ".\n";
}

void print_ranking(const AdviseOptions& options, const Advice& advice) {
    const std::string unit = advice.in_cycles ? "cycles" : "insn";
    std::printf("\n%-20s %-9s %9s %10s %10s %24s %9s %12s %7s %7s", "integrator", "numbers", "step s", "error m",
                "error rad", (unit + "/step").c_str(), "worst", (unit + "/s").c_str(), "text", "RAM");
    if (options.clock) std::printf(" %9s %9s", "mean", "worst");
    std::printf("\n");
    for (const Candidate& c : advice.ranking) {
        const auto number = [&](const char* key) { return c.row.at(key).get<unsigned long long>(); };
        const StepCost cost = advice.cost_of(c.row);
        std::printf("%-20s %-9s %9s %10.2g %10.2g %24s %9.0f %12.0f %7llu %7llu", c.attempt.method.integrator.c_str(),
                    numbers_text(c.attempt.method.numbers, c.attempt.method.carry).c_str(),
                    step_text(c.attempt.length).c_str(), c.attempt.errors.position_m, c.attempt.errors.orientation_rad,
                    range_text(cost.mean, cost.least, cost.most).c_str(), cost.worst, c.cost, number("text_bytes"),
                    number("ram_bytes"));
        if (options.clock) {
            const Shares shares = shares_of(*options.clock, c);
            std::printf(" %9s %9s", percent(shares.mean).c_str(), percent(shares.worst).c_str());
        }
        std::printf("\n");
    }
    std::fflush(stdout);
}

}  // namespace

std::string name_of(const Attempt& attempt) {
    return attempt.method.integrator + " " + numbers_text(attempt.method.numbers, attempt.method.carry);
}

std::string closest_text(const Attempt& attempt) {
    if (!attempt.failure.empty()) return attempt.failure;
    return two_digits(attempt.error()) + (" at " + step_text(attempt.length)) + " s";
}

void print_json(const AdviseOptions& options, const SceneDescription& scene, const Advice& advice) {
    Json json;
    json["tumble_bits"] = TUMBLE_BITS;
    json["scene"] = scene.name;
    json["core"] = options.core;
    json["cost"] = advice.in_cycles ? "cycles" : "insn";
    if (options.clock) json["clock_hz"] = *options.clock;
    json["tolerance_m"] = options.tolerance;
    json["tolerance_rad"] = options.tolerance;
    json["samples"] = sample_count;
    json["duration_s"] = scene.duration;
    json["reference"] = advice.truth.has_contacts ? "two fine runs" : "long double";
    json["reference_doubt_m"] = advice.truth.doubt.position_m;
    json["reference_doubt_rad"] = advice.truth.doubt.orientation_rad;
    json["recommendation"] = advice.ranking.empty() ? Json() : json_of(options, advice.ranking.front());
    if (!advice.message.empty()) json["message"] = advice.message;
    for (const char* key : {"ranking", "not_measured", "unreached"}) json[key] = Json::array();
    for (const Candidate& candidate : advice.ranking) json["ranking"].push_back(json_of(options, candidate));
    for (const Candidate& candidate : advice.not_measured) json["not_measured"].push_back(json_of(options, candidate));
    for (const Attempt& attempt : advice.unreached) json["unreached"].push_back(json_of(attempt));
    std::cout << json.dump(2) << "\n";
}

void print_table(const AdviseOptions& options, const SceneDescription& scene, const Advice& advice) {
    if (!advice.ranking.empty()) {
        print_best(options, scene, advice);
        print_ranking(options, advice);
    }
    std::vector<std::pair<std::string, std::vector<std::string>>> reasons;  // and the candidates of each
    for (const Candidate& c : advice.not_measured) {
        auto reason = std::find_if(reasons.begin(), reasons.end(),
                                   [&](const auto& other) { return other.first == c.not_measured; });
        if (reason == reasons.end()) reason = reasons.insert(reason, {c.not_measured, {}});
        reason->second.push_back(name_of(c.attempt) + " at " + step_text(c.attempt.length) + " s");
    }
    for (const auto& [reason, names] : reasons) print_list("not measured: " + reason, names);
    std::vector<std::string> names;
    for (const Attempt& attempt : advice.unreached) names.push_back(name_of(attempt) + " " + closest_text(attempt));
    print_list("not within the tolerance, with the smallest error", names);
}

}  // namespace tumble::host

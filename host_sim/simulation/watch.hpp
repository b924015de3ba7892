// What a run is wrong by though the kernel does not tell: floating point holds what is beyond the scene's [range], and
// a step knows neither the energy nor how long it has been gaining some.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "scene/description.hpp"
#include "simulation/simulation.hpp"

namespace tumble::host {

[[nodiscard]] int fastest_body(const Simulation& simulation);

// With what was found, unless the same issue is there.
[[nodiscard]] std::vector<Trouble> with(std::vector<Trouble> troubles, const std::optional<Trouble>& found);

// The first body of a run in floating point that leaves the range which the file declares, by more than rounding.
class RangeWatch {
public:
    RangeWatch(const SceneDescription& scene, const Simulation& simulation);

    // To be called after every step.
    void see(const Simulation& simulation);
    [[nodiscard]] const std::optional<Trouble>& trouble() const { return trouble_; }

private:
    struct Bound {
        std::string of;  // position, velocity, angular velocity
        std::array<long double, 3> BodySnapshot::*what;
        double most;  // of each component
        const char* unit;
    };

    std::array<Bound, 3> bounds_;
    bool is_on_;
    std::optional<Trouble> trouble_;
};

// Energy that nothing but the method can have added: of a scene without events, contacts and fixed bodies that turn, a
// hundred times what its motion had at the most while energy was kept.
class EnergyGrowthWatch {
public:
    EnergyGrowthWatch(const SceneDescription& scene, const Energy& start);

    // To be called after every step with the energy then.
    void see(const Simulation& simulation, const Energy& now);
    [[nodiscard]] const std::optional<Trouble>& trouble() const { return trouble_; }

private:
    bool is_on_;
    long double start_, most_kept_, rounding_;  // J
    std::optional<Trouble> trouble_;
};

}  // namespace tumble::host

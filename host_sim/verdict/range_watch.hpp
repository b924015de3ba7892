// A declared [range] is a contract of the scene's file: it says what q32 must hold. Floating point holds more, so the
// host watches there.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "scene/description.hpp"
#include "simulation/simulation.hpp"

namespace tumble::host {

// Finds the first body of a run in floating point that leaves what q32 holds of the declared [range], by more than
// rounding: its smallest range that is as large, with velocities and spins up to the next power of two a step.
class RangeWatch {
public:
    RangeWatch(const SceneDescription& scene, const Simulation& simulation);

    // To be called after every step.
    void see(const Simulation& simulation);
    [[nodiscard]] const std::optional<Trouble>& trouble() const { return trouble_; }

private:
    struct Bound {
        std::string of;  // position, velocity, angular velocity
        std::array<long double, 3> BodySnapshot::*number;
        double most;  // of each component
        const char* unit;
    };

    std::array<Bound, 3> bounds_;
    bool is_on_;
    std::optional<Trouble> trouble_;
};

}  // namespace tumble::host

// What a run is wrong by though the kernel does not tell: floating point holds what is beyond the scene's [range], and
// a step knows neither the energy nor how long it has been gaining some.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/description.hpp"
#include "simulation/simulation.hpp"

namespace tumble::host {

[[nodiscard]] int fastest_body(const Simulation& simulation);

// With what was found, unless the same issue is there.
[[nodiscard]] std::vector<Trouble> with(std::vector<Trouble> troubles, const std::optional<Trouble>& found);

// The first body of a run in floating point that leaves, by more than rounding, what q32 holds of the range that the
// file declares: its smallest range that is as large, with velocities and spins up to the next power of two a step.
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

// Energy that nothing but the method can have added: what springs, gravity, gravitation, drag and impacts neither have
// nor give. It is held against the largest kinetic energy that the motion has while its energy is kept; against a
// quarter of it where only contacts by impulses and uniform gravity act, of which methods of order 2 and more add
// nothing, and where only contacts by springs and uniform gravity have added it for a while, all of it if boxes may
// meet. What changes in steps with impulses or forces is theirs. Fixed bodies that turn feed the motion, and so may
// contacts by springs whose energy is not known, by what the start, a barrier or events have charged them with: then
// there is no watch.
class EnergyGrowthWatch {
public:
    // At the start of the run.
    EnergyGrowthWatch(const SceneDescription& scene, const Simulation& simulation);

    // To be called after every step with the energy then.
    void see(const Simulation& simulation, const Energy& now);
    [[nodiscard]] const std::optional<Trouble>& trouble() const { return trouble_; }

private:
    // A method swings about the energy that it keeps, and from rest its first steps add more than the motion has.
    static constexpr std::int64_t first_steps = 8, lasting_steps = 64;

    struct Steps {
        std::int64_t first, end;
    };

    void tell(const Simulation& simulation, long double gained, const std::string& had);
    // To be asked of ascending steps.
    [[nodiscard]] bool is_fed(std::int64_t step);

    bool is_on_;
    bool only_loses_;                                 // impacts and gravity alone, by a method that is exact in it
    long double most_lasting_;                        // growth of all of the last steps
    bool is_gravitation_alone_;                       // the energy is negative where the bodies are bound to each other
    std::vector<Steps> fed_;                          // by impulses and forces, in the order of their first steps
    std::size_t begun_ = 0;                           // of these
    std::int64_t fed_until_ = 0;                      // the last end of those that have begun
    long double start_, before_;                      // J, in all: with what fed it since; after the step before
    long double motion_at_start_;                     // J
    long double most_kept_;                           // J: largest kinetic energy, as far as energy was kept
    long double swing_;                               // J: of the first steps
    long double push_;                                // J: of bodies pushed out of each other
    long double rounding_;                            // J a step: its square root is added at random
    std::array<long double, lasting_steps> gains_{};  // J, of the last steps
    std::optional<Trouble> trouble_;
};

}  // namespace tumble::host

// Energy that nothing but the method or the law of impacts can have added to a run.
#pragma once

#include "scene/description.hpp"
#include "simulation/simulation.hpp"
#include "verdict/energy_rounding.hpp"

namespace tumble::host {

// Springs, gravity, gravitation, drag and impacts keep or lose energy. Impulses and forces may add some, and what
// changes while they act is theirs. A contact spring stores energy of at least 0, so where its amount is not known the
// energy is held against that of the start. There is no budget where a fixed body turns, since it drives what touches
// it, or where bodies overlap at the start.
class EnergyBudget {
public:
    // At the start of a run. `most_gain`: allowed growth, in parts of the largest kinetic energy so far.
    EnergyBudget(const SceneDescription& scene, const Simulation& simulation, double most_gain);

    // To be called now and then. `is_driven`: an impulse or a force acted since the last call.
    void see(const Simulation& simulation, bool is_driven);
    [[nodiscard]] bool is_exceeded() const { return is_exceeded_; }

private:
    bool is_on_, is_known_;

    EnergyRounding energy_rounding_;
    double most_gain_;
    long double level_, before_;    // J: what the energy may be; at the last call
    long double largest_kinetic_;   // J
    long double tolerance_energy_;  // J: work of gravity over the contact tolerance
    long double rounding_ = 0;      // J: the most that rounding has changed the energy by
    bool is_exceeded_ = false;
};

}  // namespace tumble::host

// The energy of a scene, from the motions of its bodies.
#pragma once

#include <vector>

#include "scene/data.hpp"
#include "simulation/simulation.hpp"
#include "truth/motion.hpp"

namespace tumble::host {

// `data` must outlive it.
class SceneEnergy {
public:
    explicit SceneEnergy(const SceneData& data);

    // In the user's axes; `spins` of all bodies about their principal axes, rad/s; gravity of now, m/s^2.
    [[nodiscard]] Energy of(const std::vector<reference::Motion>& now, const std::vector<reference::Vector>& spins,
                            const reference::Vector& gravity) const;

private:
    struct Body {
        reference::Number mass;     // kg
        reference::Vector moments;  // kg m^2
    };
    struct Plane {
        reference::Vector normal;  // unit
        reference::Number offset;  // m
    };

    [[nodiscard]] reference::Number of_gravity_gradient(std::size_t b, const reference::Motion& now) const;
    [[nodiscard]] reference::Number of_contacts(const std::vector<reference::Motion>& now) const;

    const SceneData& data_;
    bool attracts_, has_contact_springs_;
    std::vector<Body> bodies_;
    std::vector<Plane> planes_;
};

// Does SceneEnergy hold all that contact springs of the scene store? It does for spheres and boxes on planes and for
// pairs of spheres.
[[nodiscard]] bool stored_energy_is_known(const SceneDescription& scene);

}  // namespace tumble::host

// Rules of contacts that a run has used. Its references use the same rules, so no comparison with them can find a fault
// of one.
#pragma once

#include <set>
#include <vector>

#include "scene/description.hpp"
#include "simulation/simulation.hpp"
#include "truth/motion.hpp"

namespace tumble::host {

enum class SharedRule {
    overlap,   // bodies that begin in each other are pushed out slowly
    seams,     // a body slides over boxes whose faces are one plane
    edges,     // a body leaves a box over its edge
    friction,  // Coulomb's law for the contact points of a pair
    sleep,     // a body is held where it is at rest and its loads cancel to a thousandth
    joints,  // joints, where the references are runs: beside bodies that touch, with limits or distances, and breaking
};
// "friction"
[[nodiscard]] const char* name_of(SharedRule rule);

// Finds the rules that a run uses, in contacts by impulses.
class RuleWatch {
public:
    explicit RuleWatch(const SceneDescription& scene);

    // To be called now and then.
    void see(const Simulation& simulation);
    [[nodiscard]] std::vector<SharedRule> rules() const;

private:
    // A body on a box, or beside or below it.
    struct Touch {
        int body, box;
        reference::Vector normal;  // from the box, world
    };
    using States = std::vector<reference::Motion>;
    [[nodiscard]] bool is_box(int body) const;
    [[nodiscard]] bool is_rough(const ContactSnapshot& contact) const;
    [[nodiscard]] bool has_left_over_an_edge(const Touch& touch, const States& now) const;
    [[nodiscard]] bool are_flush(const Touch& one, const Touch& other, const States& now) const;

    SceneDescription scene_;
    std::vector<Touch> now_, ever_;
    std::set<SharedRule> rules_;
};

}  // namespace tumble::host

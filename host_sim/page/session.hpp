// A scene that is played with: runs of it side by side, which can go back, and the hits of the player. It is saved as a
// scene file that `tumble run` replays to the same bits.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scene/description.hpp"
#include "simulation/simulation.hpp"

namespace tumble::host {

// An impulse that acts at the start of a step, from 0, of the scene.
struct Hit {
    std::int64_t step = 0;
    ImpulseDescription impulse;
};

// A simulation that can go back, because it keeps snapshots.
class Run {
public:
    // A step of the scene is 2^halvings of its steps; with negative halvings, 2^-halvings of the scene's are one.
    Run(std::unique_ptr<Simulation> simulation, int halvings);

    // Takes at most `most` steps towards the state at the start of a step of the scene, and hits on the way. True where
    // it is there. A run whose steps are longer stops at the last one that has ended by then.
    bool go_to(std::int64_t step, const std::vector<Hit>& hits, int most);
    // The future of a step of the scene is another from now on.
    void forget_after(std::int64_t step);

    [[nodiscard]] const Simulation& simulation() const { return *simulation_; }

private:
    [[nodiscard]] std::int64_t own_step(std::int64_t step) const;     // the last that begins by then
    [[nodiscard]] std::int64_t acting_step(std::int64_t step) const;  // the first that begins then or later
    void keep();

    struct Kept {
        std::int64_t step;  // of its own
        std::unique_ptr<Snapshot> snapshot;
    };
    std::unique_ptr<Simulation> simulation_;
    int halvings_;
    std::vector<Kept> kept_;     // the first is the start
    std::int64_t spacing_ = 64;  // own steps between those kept; doubled where they become too many
};

// A method, in numbers that carry residuals or do not, and the halvings of the scene's step.
struct RunWay {
    std::string integrator, numbers;
    bool carry = true;
    int halvings = 0;
};

class Session {
public:
    // The text of a scene file, or of a saved session. Raises the reader's SceneError with `name` as the file's, and
    // UnsupportedScene.
    Session(std::string text, std::string_view name);

    [[nodiscard]] const SceneDescription& scene() const { return scene_; }
    [[nodiscard]] const std::vector<Hit>& hits() const { return hits_; }
    // Where a saved session ends, else 0.
    [[nodiscard]] std::int64_t saved_steps() const { return saved_steps_; }
    // That of a saved session, else verlet in q32.
    [[nodiscard]] RunWay saved_way() const;

    // Why the scene cannot be run so; empty where it can.
    [[nodiscard]] std::string obstacle(const RunWay& way) const;
    // A run at the start. The first is the one that is played and saved: it has the scene's step.
    std::size_t add(const RunWay& way);
    void remove_all() { runs_.clear(); }
    [[nodiscard]] const Simulation& run(std::size_t index) const { return runs_.at(index).simulation(); }
    bool go_to(std::size_t run, std::int64_t step, int most);

    // Hits where the played run is. Hits and states after it are another future, and forgotten. Where an impulse or an
    // event of the scene itself acts in this step, the hit acts in the next: in a replay it comes after them too.
    // Returns the step in which it acts.
    std::int64_t hit(const ImpulseDescription& impulse);

    // The session up to where the played run is: the scene's text, the hits, and [expect]. The duration is that of the
    // session, unless something of the scene acts later: then [expect] alone says where it ends.
    [[nodiscard]] std::string text() const;

private:
    [[nodiscard]] bool acts(std::int64_t step) const;  // something of the scene itself

    std::string text_;  // of the scene without hits
    SceneDescription scene_;
    std::vector<Hit> hits_;  // in the order of their steps
    std::int64_t saved_steps_ = 0, furthest_ = 0;
    std::vector<Run> runs_;
};

}  // namespace tumble::host

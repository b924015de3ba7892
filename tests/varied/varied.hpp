// Scenes of a kind in which results have been wrong, each with a right value that does not come from the kernel: a
// closed form, conservation, a symmetry or an independent integration. A scene follows from a seed and its number
// alone.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "../kernel/random.hpp"
#include "scene/description.hpp"
#include "simulation/simulation.hpp"
#include "tools/text.hpp"

namespace tumble::test {

using host::BodyDescription, host::few_digits, host::SceneDescription, host::Simulation, host::Triple;

class Draw : public Random {
public:
    explicit Draw(std::uint64_t seed, std::uint64_t scene)
        : Random{Random(Random(seed).bits() ^ (scene << 20)).bits()} {}

    bool one_in(int n) { return between(1, n) == 1; }
    template <class T>
    T of(const std::vector<T>& choices) {
        return choices[static_cast<std::size_t>(between(0, static_cast<int>(choices.size()) - 1))];
    }
    // Any power of two between the ends is as likely as another.
    double magnitude(double low, double high);
};

// A scene with the run in which it is judged. A kind of scene fills `scene`; the choices are drawn before.
struct Case {
    SceneDescription scene;
    std::string integrator,
        numbers;      // verlet three times as often as semi_implicit_euler, rk4 or suzuki4; q32, f32, f64
    double step = 0;  // s: 1/60, 1/120, 1/256 or 1/1000; `scene` has it
};

// A body, fixed or of this mass, kg, with this shape. Its name is `b` and its number.
BodyDescription& add_box(SceneDescription& scene, double mass, const Triple& edges, const Triple& position);
BodyDescription& add_sphere(SceneDescription& scene, double mass, double radius, const Triple& position);

// Moves the whole scene, with gravity, planes, world points and events in the world's frame: turns it by the unit
// quaternion (w, x, y, z) about the origin.
void turn(SceneDescription& scene, const host::Quadruple& by);
// Replaces the scene by its mirror image in the plane through the origin that is normal to this axis, 0 to 2. Shapes
// and tensors must be symmetrical about the planes of their axes.
void mirror(SceneDescription& scene, int axis);
// A random quaternion of unit length; one in three leaves the scene as it is, one in three turns it about y.
host::Quadruple any_turn(Draw& draw);
// How a scene lies in the world after it was made.
struct Placement {
    int mirrored = -1;  // axis of the mirror, 0 to 2; -1: none
    host::Quadruple turned{1, 0, 0, 0};

    // A vector of the world in the frame in which the scene was made.
    [[nodiscard]] Triple back(const Triple& v) const;
};
// Mirrors one scene in two, and turns it.
Placement place_anywhere(Draw& draw, SceneDescription& scene);
// The turn by q and then by p, which are unit quaternions (w, x, y, z).
host::Quadruple product(const host::Quadruple& p, const host::Quadruple& q);
// The vector in the turned scene, and back in the scene as it was made.
Triple rotated(const host::Quadruple& by, const Triple& v);
Triple rotated_back(const host::Quadruple& by, const Triple& v);

Triple position_of(const Simulation& simulation, int body);
Triple velocity_of(const Simulation& simulation, int body);
Triple spin_of(const Simulation& simulation, int body);  // rad/s, body axes
host::Quadruple orientation_of(const Simulation& simulation, int body);
double distance(const Triple& a, const Triple& b);
double length_of(const Triple& v);

// The simulation of the case; its step is that of the case.
[[nodiscard]] std::unique_ptr<Simulation> start(const Case& scene);

// Draws what is left of the scene, runs it, and says what is wrong with the result, with the value, the limit and the
// unit; empty where nothing is.
using Judge = std::string(Draw& draw, Case& scene);

struct Kind {
    const char* name;  // a sentence: what is right of every scene
    Judge* judge;
};
// One line each, in kinds.cpp.
extern const std::vector<Kind> kinds;

}  // namespace tumble::test

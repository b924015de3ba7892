// What a user would write: replays a few recorded scenes in the number system STRANGER_NUMBERS, and prints a line for
// each: scene, number system, integrator, steps, state hash. Neither this nor what compiles it speaks of bits.
#include "ball.hpp"
#include "brick.hpp"
#include "incline.hpp"
#include "pendulum.hpp"

#include "port.hpp"

#include "../write_number.hpp"

#define STRANGER_TEXT_OF(name) #name
#define STRANGER_TEXT(name) STRANGER_TEXT_OF(name)

namespace {

template <class Scene, class Method>
struct Config : Scene::Config {
    using Numbers = tumble::NumbersOf<STRANGER_TEXT(STRANGER_NUMBERS), typename Scene::Config::Numbers::Range>;
    using Integrator = Method;
};

// As many steps as the golden files have: at most 4096 of a body.
template <class Scene, class Method>
void replay() {
    using Scenario = Config<Scene, Method>;
    if constexpr (tumble::runs_in<Method, typename Scenario::Numbers>) {
        static tumble::Replay<Scenario, Scene> replay;
        constexpr std::uint32_t most = 4096u / static_cast<std::uint32_t>(Scene::Config::features.bodies);
        constexpr std::uint32_t steps = most < Scene::steps ? most : Scene::steps;
        while (replay.world().steps_taken() < steps && replay.step().ok()) {}
        for (const char* text : {Scene::name, " ", STRANGER_TEXT(STRANGER_NUMBERS), " ", Method::name, " "})
            tumble::port::write(text);
        write_number(replay.world().steps_taken(), 10, 1);
        tumble::port::write(" ");
        write_number(replay.world().hash(), 16, 16);
        tumble::port::write("\n");
    }
}

}  // namespace

int main() {
    using namespace tumble;
    port::init();
    replay<scenes::scene_ball, integrators::Verlet>();     // falls, bounces and comes to rest
    replay<scenes::scene_incline, integrators::Verlet>();  // boxes that slide, with friction
    replay<scenes::scene_pendulum, integrators::Rk4>();    // a box on a spring
    replay<scenes::scene_brick, integrators::Exact>();     // turns freely
    replay<scenes::scene_brick, integrators::Pdmv6>();
}

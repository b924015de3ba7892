// This kernel in the number system of TUMBLE_NUMBERS: a world with as many bodies and joints as the mechanism has.
#include "contest.hpp"
#include "world.hpp"

#include <stdexcept>

namespace {

using namespace tumble;
using namespace tumble::bench;

template <class N, int links>
class TumbleRunner final : public Runner {
public:
    TumbleRunner(const Mechanism& mechanism, int rate) : world_{mechanism, rate} {}

    void step() override { world_.step(); }
    [[nodiscard]] std::vector<reference::Motion> motions() override { return world_.motions(); }
    [[nodiscard]] std::string trouble() const override { return world_.trouble(); }

private:
    MechanismWorld<N, links> world_;
};

template <class N>
std::unique_ptr<Runner> make(const Mechanism& mechanism, int rate) {
    std::unique_ptr<Runner> made;
    const auto consider = [&]<int... links>(std::integer_sequence<int, links...>) {
        ((mechanism.links.size() == links ? (void)(made = std::make_unique<TumbleRunner<N, links>>(mechanism, rate))
                                          : (void)0),
         ...);
    };
    consider(std::integer_sequence<int, 1, 2, 6, 10>{});
    if (!made) throw std::runtime_error{"no world of this kernel has the links of the " + mechanism.name};
    return made;
}

}  // namespace

int main(int argc, char** argv) {
    using N = NumbersOf<TUMBLE_NUMBERS, RoomRange>;
    return joint_contest(argc, argv, {{"tumble", "", integrators::Verlet::name, N::name, N::carry, make<N>}});
}

// The worlds of the tests of snapshots.
#pragma once

#include "kinds.hpp"
#include "snapshots.hpp"

namespace tumble::test {

using SavedWays = Tested<testing::Types<Kind<Q32<NearRange>, integrators::Verlet>>,
                         testing::Types<Kind<F64, integrators::Exact>, Kind<Q32<NearRange, false>, integrators::Rk4>,
                                        Kind<Q32<NearRange>, integrators::Pdmv6>, Kind<F32, integrators::Verlet>,
                                        Kind<F32Plain, integrators::Rk4>, Kind<F64Carried, integrators::Pdmv8>>>;

template <class W>
class SavedWorlds : public testing::Test {
protected:
    using N = typename W::Numbers;
    template <Features features>
    using WorldOf = World<SceneOf<N, typename W::Integrator, features>>;
    using Full = WorldOf<little_of_everything>;
};

}  // namespace tumble::test

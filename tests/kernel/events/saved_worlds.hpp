// The worlds of the tests of snapshots, and how these are taken and restored.
#pragma once

#include "kinds.hpp"

#include <cstdint>
#include <vector>

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
    using Bytes = std::vector<std::uint8_t>;

    template <class World>
    [[nodiscard]] static Bytes saved(const World& world, SnapshotPart part = SnapshotPart::world) {
        Bytes bytes(static_cast<std::size_t>(world.snapshot_size(part)));
        EXPECT_EQ(world.save(bytes.data(), static_cast<int>(bytes.size()), part), static_cast<int>(bytes.size()));
        return bytes;
    }
    template <class World>
    static SnapshotFault restored(World& world, const Bytes& bytes) {
        return world.restore(bytes.data(), static_cast<int>(bytes.size()));
    }
};

}  // namespace tumble::test

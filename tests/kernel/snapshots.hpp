// The snapshot of a world in a vector of exactly its size, so that a sanitizer sees what is read or written beyond it.
#pragma once

#include <tumble/events/snapshot.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace tumble::test {

using SavedBytes = std::vector<std::uint8_t>;

[[nodiscard]] SavedBytes save(const auto& world, SnapshotPart part = SnapshotPart::world) {
    SavedBytes bytes(static_cast<std::size_t>(world.snapshot_size(part)));
    EXPECT_GT(bytes.size(), 0u);
    EXPECT_EQ(world.save(bytes.data(), static_cast<int>(bytes.size()), part), static_cast<int>(bytes.size()));
    return bytes;
}
[[nodiscard]] SnapshotFault restore(auto& world, const SavedBytes& bytes) {
    return world.restore(bytes.data(), static_cast<int>(bytes.size()));
}

}  // namespace tumble::test

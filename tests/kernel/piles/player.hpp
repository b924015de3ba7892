// A world in which a test plays a story, and its hash after each step.
#pragma once

#include <tumble/tumble.hpp>

#include "snapshots.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace tumble::test {

using Hashes = std::vector<std::uint64_t>;

template <class S>
class Player {
public:
    explicit Player(const WorldSpec& spec) : world_{std::make_unique<World<S>>(Seconds{1, 256}, spec)} {}

    BodyId add(BodySpec body, const RealVec3& position, const RealVec3& velocity = {}) {
        body.position = position;
        body.velocity = velocity;
        const BodyId id = world_->add(body);
        EXPECT_TRUE(id);
        added_.push_back(id);
        return id;
    }
    // The next step looks at everything: impulses of nothing end what is known of the bodies.
    void look_at_everything() {
        for (const BodyId id : added_)
            if (world_->contains(id)) world_->apply_impulse(id, {});
    }
    void run(int steps) {
        for (int step = 0; step < steps; ++step) {
            (void)world_->step();
            hashes_.push_back(world_->hash());
        }
    }
    // In between the world goes elsewhere for so many steps.
    void save_and_restore(int steps) {
        const auto bytes = save(*world_);
        for (int step = 0; step < steps; ++step) (void)world_->step();
        EXPECT_EQ(restore(*world_, bytes), SnapshotFault::none);
    }
    [[nodiscard]] World<S>& world() { return *world_; }
    [[nodiscard]] const Hashes& hashes() const { return hashes_; }

private:
    std::unique_ptr<World<S>> world_;
    Hashes hashes_;
    std::vector<BodyId> added_;
};

}  // namespace tumble::test

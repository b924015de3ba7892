// Worlds with more bodies than fit into a byte.
#include <tumble/tumble.hpp>

#include "tolerances.hpp"

#include <cmath>
#include <memory>

namespace tumble::test {
namespace {

struct Tray : Scene {
    using Numbers = F64;
    static constexpr Features features{.bodies = 301, .planes = 1, .pairs = true, .boxes = true};
};

// 255 balls and the floor are 256 pairs, which is 0 modulo 256.
TEST(ManyBodies, a_tray_carries_as_many_balls_as_are_put_on_it) {
    for (const int balls : {200, 255, 256, 300}) {
        WorldSpec spec;
        spec.gravity = {0, -9.8125, 0};  // m/s^2
        spec.contact.restitution = 0;
        const auto world = std::make_unique<World<Tray>>(Seconds{1, 256}, spec);
        ASSERT_TRUE(world->add(PlaneSpec{}));
        BodySpec tray = box(100, {20, 1, 20}), ball = sphere(1, Real{0.125});
        tray.position = {0, Real{0.5}, 0};
        const BodyId carrier = world->add(tray);
        for (int i = 0; i < balls; ++i) {
            ball.position = {Real{(i % 20) * 0.5 - 5}, Real{1.125}, Real{(i / 20) * 0.5 - 5}};
            ASSERT_TRUE(world->add(ball));
        }
        for (int step = 0; step < 8; ++step) ASSERT_TRUE(world->step().ok());
        EXPECT_EQ(world->contact_count(carrier), 4 + balls);
        for (int b = 0; b <= balls; ++b)
            EXPECT_LE(std::abs(static_cast<Number>(world->position(BodyId{b}).y) - (b == 0 ? 0.5L : 1.125L)),
                      tolerance::place)
                << "body " << b << " of " << balls;
    }
}

}  // namespace
}  // namespace tumble::test

// The kernel's lists. kernel/lists.cmake reads the same lists from the text of the headers as a compiler does. The
// table of pairs of shapes gives the same answer in either order.
#include <tumble/integrators/list.hpp>
#include <tumble/shapes/pairs.hpp>

#include "gtest/gtest.h"

#include <string>
#include <string_view>

namespace tumble::test {
namespace {

void append(std::string& list, std::string_view name) {
    if (!list.empty()) list += " ";
    list += name;
}

// The name of the struct without its namespace, as the compiler spells it in the name of this function.
template <class Method>
std::string_view type_of() {
    constexpr std::string_view space = "tumble::integrators::";
    std::string_view name = __PRETTY_FUNCTION__;
    name.remove_prefix(name.find(space) + space.size());
    return name.substr(0, name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_"));
}

using OfAnyRange = RoomRange;

TEST(Lists, builds_read_every_integrator) {
    std::string all, in_floating_point;
    Integrators::for_each([&]<class Method>() {
        append(all, type_of<Method>());
        if (!runs_in<Method, Q32<OfAnyRange>>) append(in_floating_point, type_of<Method>());
    });
    EXPECT_EQ(all, TUMBLE_INTEGRATORS);
    EXPECT_EQ(in_floating_point, TUMBLE_FLOATING_POINT_INTEGRATORS);
}

TEST(Lists, builds_read_every_number_system) {
    std::string all, fixed_point, everywhere;
    NumberSystems::for_each([&]<class System>() {
        append(all, System::name);
        if (System::template Numbers<OfAnyRange>::fixed_point) append(fixed_point, System::name);
        if (System::runs == Runs::everywhere) append(everywhere, System::name);
    });
    EXPECT_EQ(all, TUMBLE_NUMBER_SYSTEMS);
    EXPECT_EQ(fixed_point, TUMBLE_FIXED_POINT_SYSTEMS);
    EXPECT_EQ(everywhere, TUMBLE_NUMBER_VARIANTS);
}

TEST(Lists, builds_read_every_range_and_each_holds_the_one_before_it) {
    std::string all;
    int position = 0, velocity = 0, spin = 0;
    Ranges::for_each([&]<class Named>() {
        using R = typename Named::Range;
        append(all, Named::name);
        EXPECT_TRUE(R::position >= position && R::velocity >= velocity && R::spin >= spin) << Named::name;
        position = R::position, velocity = R::velocity, spin = R::spin;
    });
    EXPECT_EQ(all, TUMBLE_RANGES);
}

TEST(Lists, shapes_meet_in_either_order_and_touch_bodies_if_they_meet_any) {
    const auto kind = [](int k) { return static_cast<ShapeKind>(k); };
    constexpr int count = static_cast<int>(ShapeKind::points) + 1;
    for (int a = 0; a < count; ++a) {
        bool meets_any = false;
        for (int b = 0; b < count; ++b) {
            EXPECT_EQ(meets(kind(a), kind(b)), meets(kind(b), kind(a))) << a << " " << b;
            if (touches_bodies(kind(a)) && touches_bodies(kind(b))) {
                EXPECT_EQ(touching_meet(kind(a), kind(b)), meets(kind(a), kind(b))) << a << " " << b;
            }
            meets_any = meets_any || meets(kind(a), kind(b));
        }
        EXPECT_EQ(touches_bodies(kind(a)), meets_any) << a;
    }
    EXPECT_FALSE(touches_bodies(ShapeKind::none));
}

}  // namespace
}  // namespace tumble::test

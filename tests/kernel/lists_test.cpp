// The kernel's lists as kernel/lists.cmake reads them from the text of the headers are what a compiler makes of them.
#include <tumble/integrators/list.hpp>

#include "gtest/gtest.h"

#include <string>
#include <string_view>

namespace tumble::test {
namespace {

void append(std::string& list, std::string_view name) {
    if (!list.empty()) list += " ";
    list += name;
}

// The structure's name without its namespace, as the compiler spells it in this function's own name.
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

}  // namespace
}  // namespace tumble::test

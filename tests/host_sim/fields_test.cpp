// A field that a spec lists is read, written, handed to the kernel and compiled, without a line elsewhere.
#include <gtest/gtest.h>

#include "scene/fields.hpp"
#include "scene/reading.hpp"

namespace tumble::host::fields {
namespace {

// A plane with a field more.
struct SoftPlaneSpec {
    RealVec3 normal{0, 1, 0};
    Real softness = 0;  // m/N

    static constexpr void each(auto&& f, auto&... of) {
        f(Field{"normal"}, of.normal...);
        f(Field{"softness", "m/N", Field::not_negative}, of.softness...);
    }
};
struct SoftPlaneDescription {
    Triple normal{0, 1, 0};
    double softness = 0;
};

SoftPlaneDescription read(const std::string& text) {
    const Document document(text, "soft.toml");
    Table table = document.root();
    SoftPlaneDescription plane;
    read_fields<SoftPlaneSpec>(table, plane);
    table.finish();
    return plane;
}

TEST(AFieldMore, is_read_written_handed_on_and_compiled) {
    const SoftPlaneDescription plane = read("softness = 0.5\n");
    EXPECT_EQ(plane.softness, 0.5);
    EXPECT_EQ(toml_fields<SoftPlaneSpec>(plane), "normal = [0.0, 1.0, 0.0]\nsoftness = 0.5\n");
    const auto spec = spec_of<SoftPlaneSpec>(plane);
    EXPECT_EQ(spec.softness.to_double(), 0.5);
    EXPECT_EQ(cpp_fields(spec, "  "), "  .softness = 0.5,   // m/N\n");
}

TEST(AFieldMore, is_refused_outside_its_bound) {
    try {
        (void)read("softness = -1.0\n");
        ADD_FAILURE();
    } catch (const SceneError& error) {
        EXPECT_STREQ(error.what(), "soft.toml:1: softness: got -1, expected a finite number >= 0 (m/N)");
    }
}

}  // namespace
}  // namespace tumble::host::fields

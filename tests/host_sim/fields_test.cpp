// A field that a spec lists is read, written, handed to the kernel and compiled, without a line elsewhere.
#include <gtest/gtest.h>

#include "scene/fields.hpp"
#include "scene/reader.hpp"
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

// The message about an unknown key names those that there are.
template <class... Specs>
void expect_keys(const std::string& table) {
    std::string message;
    try {
        (void)read_scene_text(
            "[world]\nstep = 1\nduration = 1\n[[body]]\nname = \"a\"\nshape = \"none\"\nmass = 1\n[[" + table +
                "]]\nno_key = 1\n",
            "keys.toml");
    } catch (const SceneError& error) { message = error.what(); }
    EXPECT_NE(message.find(table + "[0].no_key: unknown key"), std::string::npos) << message;
    const auto expect = [&](Field field, const auto&) {
        EXPECT_NE(message.find('"' + std::string(field.name) + '"'), std::string::npos)
            << field.name << ": " << message;
    };
    (Specs::each(expect, static_cast<const Specs&>(Specs{})), ...);
}

TEST(EveryField, of_a_spring_a_joint_and_an_event_is_a_key_of_its_table) {
    expect_keys<SpringSpec>("spring");
    expect_keys<HingeSpec, BallSpec, FixedSpec, SliderSpec, UniversalSpec, DistanceSpec>("joint");
    expect_keys<EventSpec>("event");
}

}  // namespace
}  // namespace tumble::host::fields

// Every field of a spec is in the list of its spec, and in the digest by which a snapshot knows its scene.
#include <tumble/tumble.hpp>

#include "members.hpp"
#include "gtest/gtest.h"

#include <cstring>
#include <string>

namespace tumble::test {
namespace fields {
namespace {

using tumble::Field;

// A plane with a field more: one member and one line.
struct SoftPlane {
    RealVec3 normal{0, 1, 0};
    Real softness = 0;

    static constexpr void each(auto&& f, auto&... of) {
        f(Field{"normal"}, of.normal...);
        f(Field{"softness", "m/N", Field::not_negative}, of.softness...);
    }
};

void change(Real& value) { value = value + Real{0.25}; }
void change(RealVec3& value) { change(value.z); }
void change(RealQuat& value) { change(value.v); }
void change(Shape& shape) { change(shape.size); }
void change(InertiaTensor& inertia) { change(inertia.yz); }
void change(BodyIndex& value) { value = value + 1; }
template <class T>
void change(T& value) {  // of its first field, of an enumerator, or of a number
    int i = 0;
    const auto first = [&](Field, auto& field) {
        if (i++ == 0) change(field);
    };
    if constexpr (requires { T::each(first, value); }) T::each(first, value);
    else value = static_cast<T>(static_cast<int>(value) == 0);
}

template <class Spec>
class Fields : public testing::Test {
protected:
    static constexpr Features features{.bodies = 4,
                                       .joints = 1,
                                       .distances = true,
                                       .joint_springs = true,
                                       .joint_limits = true,
                                       .joint_breaks = true,
                                       .snapshots = true};

    // A spec that a world takes, also with one field changed.
    [[nodiscard]] static Spec usual() {
        Spec spec;
        if constexpr (requires { spec.break_force; }) spec.to_body = 2;
        if constexpr (requires { spec.break_force, spec.axis; }) spec.axis = {1, 0, 0};
        if constexpr (requires { spec.limits; }) spec.limits = {-1, 1};
        if constexpr (requires { spec.to_point; }) {
            spec.to_point = {0, 2, 0};
            spec.least = 1;
            spec.most = 3;
        }
        return spec;
    }
    [[nodiscard]] static std::uint64_t digest_of(const Spec& spec) {
        detail::Digest digest;
        digest.add(spec);
        if constexpr (!requires { spec.break_force; }) return digest.value();
        // A world notes its joints as it holds them.
        World<SceneOf<F64, integrators::Verlet, features>> world{Seconds{1, 256}};
        for (int b = 0; b < features.bodies; ++b) (void)world.add(box(1, {1, 0.5, 0.25}));
        if constexpr (requires { world.fault_of(spec); }) {
            EXPECT_EQ(name_of(world.fault_of(spec)), std::string{"none"});
            (void)world.add(spec);
        }
        std::uint8_t bytes[4096];
        EXPECT_GT(world.save(bytes, sizeof bytes), 0);
        std::uint64_t value = 0;
        std::memcpy(&value, bytes + 16, sizeof value);
        return value;
    }
};
using Specs = testing::Types<WorldSpec, ContactSpec, SleepSpec, BodySpec, PlaneSpec, SpringSpec, JointSpring,
                             JointLimits, HingeSpec, BallSpec, FixedSpec, SliderSpec, UniversalSpec, DistanceSpec,
                             EventSpec, DragSpec, WheelsSpec, OrbitSpec, SoftPlane>;
TYPED_TEST_SUITE(Fields, Specs);

TYPED_TEST(Fields, are_listed_each_and_change_the_digest_unless_they_are_state) {
    const TypeParam usual = this->usual();
    const std::uint64_t digest = this->digest_of(usual);
    std::size_t count = 0;
    TypeParam::each(
        [&](Field field, const auto&) {
            TypeParam other = usual;
            std::size_t i = 0;
            TypeParam::each(
                [&](Field, auto& value) {
                    if (i++ == count) change(value);
                },
                other);
            EXPECT_EQ(this->digest_of(other) != digest, field.kind != Field::state) << field.name;
            ++count;
        },
        usual);
    EXPECT_EQ(count, count_of_members<TypeParam>());
}

}  // namespace
}  // namespace fields
}  // namespace tumble::test

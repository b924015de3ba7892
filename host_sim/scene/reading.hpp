// Quantities and checks that several readers of a scene's tables share.
#pragma once

#include "scene/description.hpp"
#include "scene/toml.hpp"

namespace tumble::host {

inline constexpr Quantity metres{Quantity::any, "m", "x, y, z"};
inline constexpr Quantity stiffness{Quantity::not_negative, "N/m"};
inline constexpr Quantity seconds{Quantity::not_negative, "s"};

// A bound of a number of bodies or of rounds; and layers, a bit for each.
inline void convert(const Value& value, int& out, const Quantity&) { out = static_cast<int>(value.whole(0, 1000)); }
inline void convert(const Value& value, std::optional<int>& out, const Quantity&) {
    out = static_cast<int>(value.whole(0, BodySpec::all_layers));
}

// The values that a field of type T takes.
template <class T>
[[nodiscard]] decltype(auto) values_of(const Field& field) {
    const bool is_turn = std::is_same_v<T, Quadruple>, is_vector = std::is_same_v<T, Triple>;
    if constexpr (std::is_enum_v<T>) return (words<T>);
    else
        return Quantity{field.kind == Field::state ? Field::any : field.kind, field.unit,
                        is_turn     ? "w, x, y, z"
                        : is_vector ? "x, y, z"
                                    : ""};
}

// Reads all keys of a table that are fields of a spec, with their units and bounds, into what has these fields. A body,
// and what takes a table, has a reader of its own.
template <class Spec>
void read_fields(Table& table, auto& into) {
    Spec::each(
        [&]<class T>(Field field, T& value) {
            if (field.kind == Field::body) return;
            if constexpr (requires(const Value& text) { convert(text, value, values_of<T>(field)); })
                table.optional(field.name, value, values_of<T>(field));
        },
        into);
}

// One table each, checked. Springs, joints, impulses, forces and events name bodies, which the scene has by then.
[[nodiscard]] BodyDescription read_body(Table table, const SceneDescription& scene, RangeDescription& range);
[[nodiscard]] SpringDescription read_spring(Table table, const SceneDescription& scene, RangeDescription& range);
// Joints name bodies, and are read one after the other: a joint that closes a loop with those of the scene is refused.
[[nodiscard]] JointDescription read_joint(Table table, const SceneDescription& scene, RangeDescription& range);
// Throws where a jointed body, or one that loads tie to it, would touch something, and where it would pass through
// something and does not say so. The tables of the scene's bodies and joints.
void check_layers_of_joints(const std::vector<Table>& bodies, const std::vector<Table>& joints,
                            const SceneDescription& scene);
[[nodiscard]] ImpulseDescription read_impulse(Table table, const SceneDescription& scene);
[[nodiscard]] ForceDescription read_force(Table table, const SceneDescription& scene);
// `live`: an event that a program sends, which has no time.
[[nodiscard]] EventDescription read_event(Table table, const SceneDescription& scene, RangeDescription& range,
                                          bool live = false);

[[nodiscard]] Expectation read_expectation(Table table);

// The body that a key names. Throws where there is none.
[[nodiscard]] int resolve(Table& table, const std::string& key, const std::string& name, const SceneDescription& scene);
// Throws where a time is after the end of the run.
void check_time(Table& table, const std::string& key, double when, const SceneDescription& scene);

// Throws where the length of a vector or a quaternion is 0.
void check_not_zero(const Value& value, const double* numbers, std::size_t count, const std::string& wanted);

// Throws where a number exceeds `most`, and the file declares a range. Where it declares none, `range` keeps the error
// of the first such number: fixed point refuses the scene with it, floating point takes the scene. `what` names the
// limit.
void check_range(const Value& value, double number, double most, const std::string& unit, const std::string& what,
                 RangeDescription& range);
// The same of a vector, if the table has it; `what` is a key of [range].
void check_range(Table& table, const std::string& key, const Triple& numbers, const std::string& what,
                 RangeDescription& range);

// Throws if a number would make a point mass rotate.
void refuse_to_turn(Table& table, const std::string& key, const Triple& numbers, const BodyDescription& body);

}  // namespace tumble::host

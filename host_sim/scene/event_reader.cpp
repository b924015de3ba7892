// Tables of events, in scene files and on the standard input of a live run.
#include "scene/reading.hpp"

namespace tumble::host {
namespace {

bool turns(EventKind kind) {
    return kind == EventKind::angular_impulse || kind == EventKind::torque || kind == EventKind::step_torque ||
           kind == EventKind::angular_velocity;
}
// What a point mass does not have.
void refuse_rotation(Table& table, const EventDescription& event, const BodyDescription& body) {
    if (!body.is_point_mass()) return;
    const std::string what = "body " + in_quotes(body.name) + " is a point mass, which does not rotate";
    if (turns(event.kind)) table.at("kind").fail(what, "a kind of event that does not rotate it");
    if (event.frame == Frame::body) table.at("frame").fail(what, "\"world\" or no frame");
    if (table.has("orientation")) table.at("orientation").fail(what, "no orientation");
    refuse_to_turn(table, "point", event.point, body);
}
void check_ranges(Table& table, const EventDescription& event, RangeDescription& range) {
    switch (event.kind) {
    case EventKind::velocity: return check_range(table, "value", event.value, "velocity", range);
    case EventKind::angular_velocity: return check_range(table, "value", event.value, "angular_velocity", range);
    case EventKind::pose: return check_range(table, "value", event.value, "position", range);
    default: return;
    }
}

// Body and joint by their names. A live event has no time.
void read_fields(Table& table, EventDescription& event, std::string& body, std::string& joint, bool live) {
    Field frame{};
    EventSpec::each(
        [&]<class T>(Field field, T& value) {
            const std::string_view name = field.name;
            const bool is_time = name == "time", is_value = name == "value";
            if constexpr (std::is_same_v<T, int>) {
                table.read(field.name, body, text_in_quotes, has_body(event.kind));
                table.read("joint", joint, text_in_quotes, has_joint(event.kind));
            } else if constexpr (std::is_same_v<T, Frame>) {
                frame = field;  // of the value, after which it is read
            } else if (!is_time || !live) {
                const bool is_required = is_time || name == "kind" || (is_value && !has_joint(event.kind));
                table.read(field.name, value, values_of<T>(field), is_required);
            }
            if (is_value) table.optional(frame.name, event.frame, words<Frame>);
        },
        event);
}

// The joint that a key names.
int resolve_joint(Table& table, const std::string& name, const SceneDescription& scene) {
    std::vector<std::string> names;
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
        if (scene.joints[j].name == name) return static_cast<int>(j);
        names.push_back(scene.joints[j].name);
    }
    if (names.empty()) table.at("joint").fail("the scene has no joints", "an event of a body, or a [[joint]]");
    table.at("joint").fail("got " + in_quotes(name) + suggestion(name, names), "the name of a joint: " + listed(names));
}

// An event of a joint has nothing beside its time and its joint.
void check_joint_event(Table& table, EventDescription& event, const std::string& joint, const SceneDescription& scene) {
    const std::string kind = name_of(event.kind);
    for (const char* key : {"body", "value", "frame", "point", "orientation"})
        if (table.has(key))
            table.at(key).fail("given for " + in_quotes(kind), "joint = the name of a joint, and no more");
    event.joint = resolve_joint(table, joint, scene);
}

// Forces that begin and end have a table of their own.
void refuse_timed(Table& table, bool live) {
    if (!table.has("kind")) return;
    const auto* const kind = table.at("kind").node().as_string();
    if (kind == nullptr) return;
    for (const auto& [word, of] : words_of_events(true))
        if (kind->get() == word)
            table.at("kind").fail("got " + in_quotes(kind->get()) + ", which is for programs alone",
                                  live ? "\"force\" or \"torque\", which act until the next one of the body"
                                       : "a table [[force]] with from and until (s)");
}

}  // namespace

EventDescription read_event(Table table, const SceneDescription& scene, RangeDescription& range, bool live) {
    EventDescription event;
    std::string body, joint;
    refuse_timed(table, live);
    read_fields(table, event, body, joint, live);
    table.finish();

    const bool acts_on_a_body = has_body(event.kind), acts_on_a_joint = has_joint(event.kind),
               has_orientation = table.has("orientation");
    if (acts_on_a_body) event.body = resolve(table, "body", body, scene);
    if (!live) check_time(table, "time", event.time, scene);
    const std::string kind = name_of(event.kind);
    if (acts_on_a_joint) {
        check_joint_event(table, event, joint, scene);
        return event;
    }
    if (table.has("joint")) table.at("joint").fail("given for " + in_quotes(kind), "it for an event of a joint alone");
    if (!acts_on_a_body && table.has("body"))
        table.at("body").fail("given for gravity", "no body: gravity acts on all of them");
    if (has_orientation && event.kind != EventKind::pose)
        table.at("orientation").fail("given for " + in_quotes(kind), "it for a pose alone");
    if (table.has("frame") && event.kind == EventKind::pose)
        table.at("frame").fail("given for a pose", "no frame: a pose is in the world's");
    if (table.has("frame") && !acts_on_a_body)
        table.at("frame").fail("given for gravity", "no frame: gravity is in the world's");
    if (table.has("point") && !has_point(event.kind))
        table.at("point").fail("given for " + in_quotes(kind), "it for an impulse or a force alone");
    if (has_orientation)
        check_not_zero(table.at("orientation"), event.orientation.data(), event.orientation.size(),
                       "a quaternion [w, x, y, z] whose length is not 0");
    if (acts_on_a_body) refuse_rotation(table, event, scene.body(event.body));
    if (event.kind == EventKind::angular_velocity && scene.body(event.body).fixed && scene.is_jointed(event.body))
        table.at("kind").fail("it makes a turntable of body " + in_quotes(body) + ", which is fixed and in a joint",
                              "a body that moves, or one in no joint: joints tie to what does not move by itself");
    check_ranges(table, event, range);
    return event;
}

}  // namespace tumble::host

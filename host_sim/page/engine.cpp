// What the page calls: a session (session.hpp) behind functions of WebAssembly. A text is an address and a size; what a
// function answers as text or numbers lies in the memory until the next call. An error goes to the page as a message,
// and the instance is then of no more use: the page makes another.
#include <cstdlib>
#include <optional>

#include "page/session.hpp"
#include "scene/data.hpp"
#include "tools/raise.hpp"
#include "tools/text.hpp"

// A function that the page calls by this name.
#define TUMBLE_EXPORT(name) __attribute__((export_name(#name)))

extern "C" __attribute__((import_module("page"), import_name("raise"))) void page_raise(const char* text,
                                                                                        std::size_t size);

namespace tumble::host {

void end_with(const char* message) {
    page_raise(message, std::string_view(message).size());
    std::abort();
}

namespace {

std::optional<Session> session;
SceneData data;
std::string text;
std::vector<double> numbers;

template <class Items, class ToText>
std::string json_list(const Items& items, const ToText& to_text) {
    std::string list;
    for (const auto& item : items) list += (list.empty() ? "" : ", ") + to_text(item);
    return "[" + list + "]";
}

std::string json_of(const BodyDescription& body) {
    const auto index = static_cast<std::size_t>(&body - session->scene().bodies.data());
    return "{\"name\": " + json_text(body.name) + ", \"shape\": " + json_text(word_of(body.shape.kind)) +
           ", \"size\": " + json_array(body.shape.size) +
           ", \"points\": " + json_list(body.shape.points, [](const auto& p) { return json_array(p.position); }) +
           ", \"mass\": " + json_number(static_cast<double>(data.bodies[index].mass)) +
           ", \"fixed\": " + (body.fixed ? "true" : "false") +
           ", \"point_mass\": " + (body.is_point_mass() ? "true" : "false") + "}";
}
std::string json_of(const PlaneDescription& plane) {
    return "{\"name\": " + json_text(plane.name) + ", \"normal\": " + json_array(plane.normal) +
           ", \"offset\": " + json_number(plane.offset) + "}";
}
std::string json_of(const SpringDescription& spring) {
    return "{\"body\": " + std::to_string(spring.body) + ", \"point\": " + json_array(spring.point) +
           ", \"to_body\": " + std::to_string(spring.to_body) + ", \"to\": " + json_array(spring.to) + "}";
}
// Points and axes in the world, at the start.
std::string json_of(const JointDescription& joint) {
    return "{\"kind\": " + json_text(word_of(joint.kind)) + ", \"body\": " + std::to_string(joint.body) +
           ", \"point\": " + json_array(joint.anchor) + ", \"axis\": " + json_array(joint.axis) +
           ", \"to_body\": " + std::to_string(joint.to_body) +
           ", \"to\": " + json_array(joint.anchor_on(joint.to_body)) + ", \"to_axis\": " + json_array(joint.to_axis) +
           "}";
}
std::string json_of(const ForceDescription& force) {
    return "{\"body\": " + std::to_string(force.body) + ", \"from\": " + json_number(force.from) +
           ", \"until\": " + json_number(force.until) +
           ", \"in_body\": " + (force.frame == Frame::body ? "true" : "false") +
           ", \"force\": " + json_array(force.force) + ", \"point\": " + json_array(force.point) +
           ", \"torque\": " + json_array(force.torque) + "}";
}
std::string json_of_impulse(std::int64_t step, const ImpulseDescription& impulse) {
    return "{\"step\": " + std::to_string(step) + ", \"body\": " + std::to_string(impulse.body) +
           ", \"in_body\": " + (impulse.frame == Frame::body ? "true" : "false") +
           ", \"impulse\": " + json_array(impulse.impulse) + ", \"point\": " + json_array(impulse.point) + "}";
}
std::string json_of_hits() {
    std::string list;
    const SceneDescription& scene = session->scene();
    const auto add = [&](std::int64_t step, const ImpulseDescription& impulse) {
        list += (list.empty() ? "" : ", ") + json_of_impulse(step, impulse);
    };
    for (const ImpulseDescription& impulse : scene.impulses) add(nearest_step(impulse.time, scene.step), impulse);
    for (const Hit& hit : session->hits()) add(hit.step, hit.impulse);
    return "[" + list + "]";
}
std::string json_of(const RunWay& way) {
    return "{\"integrator\": " + json_text(way.integrator) + ", \"numbers\": " + json_text(way.numbers) +
           ", \"carry\": " + (way.carry ? "true" : "false") + ", \"halvings\": " + std::to_string(way.halvings) + "}";
}

std::string json_of_scene() {
    const SceneDescription& scene = session->scene();
    const auto json = [](const auto& item) { return json_of(item); };
    return "{\"name\": " + json_text(scene.name) + ", \"step_s\": " + seventeen_digits(scene.step.seconds()) +
           ", \"step\": " + json_text(step_text(scene.step)) + ", \"steps\": " + std::to_string(scene.steps()) +
           ", \"gravity\": " + json_array(scene.gravity) + ", \"bodies\": " + json_list(scene.bodies, json) +
           ", \"planes\": " + json_list(scene.planes, json) + ", \"springs\": " + json_list(scene.springs, json) +
           ", \"joints\": " + json_list(scene.joints, json) + ", \"forces\": " + json_list(scene.forces, json) +
           ", \"touches\": " + (scene.contact.response == ContactResponse::none ? "false" : "true") +
           ", \"tolerance\": " + json_number(scene.contact.tolerance) +
           ", \"has_events\": " + (scene.events.empty() ? "false" : "true") +
           ", \"warnings\": " + json_list(limitations(scene), [](const std::string& w) { return json_text(w); }) +
           ", \"saved_way\": " + json_of(session->saved_way()) +
           ", \"saved_steps\": " + std::to_string(session->saved_steps()) + "}";
}

std::string_view view(const char* bytes, std::size_t size) { return {bytes, size}; }
const char* answer(std::string of) {
    text = std::move(of);
    return text.c_str();
}
RunWay way_of(const char* integrator, std::size_t integrator_size, const char* number_system, std::size_t numbers_size,
              int carry, int halvings) {
    return {std::string(view(integrator, integrator_size)), std::string(view(number_system, numbers_size)), carry != 0,
            halvings};
}

// What happened, to which body and when.
std::string json_of_troubles(const Simulation& run) {
    return json_list(run.troubles(), [&](const Trouble& trouble) {
        std::string what;
        if (trouble.number)
            what = trouble.number->name + " exceeds " + few_digits(trouble.number->most) + " " + trouble.number->unit;
        return "{\"issue\": " + json_text(trouble.issue) + ", \"step\": " + std::to_string(trouble.step) +
               ", \"body\": " + json_text(trouble.body < 0 ? "" : session->scene().body(trouble.body).name) +
               ", \"what\": " + json_text(what) + "}";
    });
}

// About the world's origin, kg m^2/s, of all bodies that move.
Triple angular_momentum(const Simulation& run) {
    Triple sum{};
    const auto add_cross = [&](const Triple& a, const Triple& b) {
        for (std::size_t i = 0; i < 3; ++i) sum[i] += a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
    };
    for (int b = 0; b < run.body_count(); ++b) {
        const BodySpec& spec = data.bodies[static_cast<std::size_t>(b)];
        if (spec.is_fixed()) continue;
        const BodySnapshot body = run.body(b);
        const auto mass = static_cast<double>(spec.mass);
        Triple position, momentum, spin, turned{};
        for (std::size_t i = 0; i < 3; ++i) {
            position[i] = static_cast<double>(body.position[i]);
            momentum[i] = mass * static_cast<double>(body.velocity[i]);
            spin[i] = static_cast<double>(body.angular_velocity[i]);
        }
        add_cross(position, momentum);
        const InertiaTensor& tensor = spec.inertia;
        const auto of = [](Real number) { return static_cast<double>(number); };
        const Triple own{of(tensor.xx) * spin[0] + of(tensor.xy) * spin[1] + of(tensor.xz) * spin[2],
                         of(tensor.xy) * spin[0] + of(tensor.yy) * spin[1] + of(tensor.yz) * spin[2],
                         of(tensor.xz) * spin[0] + of(tensor.yz) * spin[1] + of(tensor.zz) * spin[2]};
        // q own q*: own + 2 w (u x own) + 2 u x (u x own)
        const auto w = static_cast<double>(body.orientation[0]);
        const Triple u{static_cast<double>(body.orientation[1]), static_cast<double>(body.orientation[2]),
                       static_cast<double>(body.orientation[3])};
        for (std::size_t i = 0; i < 3; ++i)
            turned[i] = u[(i + 1) % 3] * own[(i + 2) % 3] - u[(i + 2) % 3] * own[(i + 1) % 3];
        for (std::size_t i = 0; i < 3; ++i) sum[i] += own[i] + 2 * w * turned[i];
        add_cross({2 * u[0], 2 * u[1], 2 * u[2]}, turned);
    }
    return sum;
}

}  // namespace

TUMBLE_EXPORT(allocate) void* allocate(std::size_t size) { return std::malloc(size); }
TUMBLE_EXPORT(release) void release(void* bytes) { std::free(bytes); }

// The session of a scene's text: the scene as JSON.
TUMBLE_EXPORT(open) const char* open(const char* toml, std::size_t size, const char* name, std::size_t name_size) {
    session.emplace(std::string(view(toml, size)), view(name, name_size));
    data = build_scene(session->scene());
    return answer(json_of_scene());
}
TUMBLE_EXPORT(integrator_names) const char* integrator_names() {
    return answer(json_list(integrators(), [](const IntegratorInfo& info) { return json_text(info.name); }));
}
TUMBLE_EXPORT(obstacle)
const char* obstacle(const char* integrator, std::size_t integrator_size, const char* number_system,
                     std::size_t numbers_size, int carry, int halvings) {
    return answer(session->obstacle(way_of(integrator, integrator_size, number_system, numbers_size, carry, halvings)));
}
TUMBLE_EXPORT(add_run)
std::size_t add_run(const char* integrator, std::size_t integrator_size, const char* number_system,
                    std::size_t numbers_size, int carry, int halvings) {
    return session->add(way_of(integrator, integrator_size, number_system, numbers_size, carry, halvings));
}
TUMBLE_EXPORT(remove_runs) void remove_runs() { session->remove_all(); }

// Session::go_to(): 1 where the run is there.
TUMBLE_EXPORT(go_to) int go_to(std::size_t run, double step, int most) {
    return session->go_to(run, static_cast<std::int64_t>(step), most) ? 1 : 0;
}
// Session::hit(), in the body's axes or the world's.
TUMBLE_EXPORT(hit)
double hit(int body, int in_body, double x, double y, double z, double at_x, double at_y, double at_z) {
    return static_cast<double>(
        session->hit({0, body, in_body != 0 ? Frame::body : Frame::world, {x, y, z}, {at_x, at_y, at_z}, {}}));
}
TUMBLE_EXPORT(hits) const char* hits() { return answer(json_of_hits()); }
TUMBLE_EXPORT(saved) const char* saved() { return answer(session->text()); }
TUMBLE_EXPORT(hash) const char* hash(std::size_t run) { return answer(hex(session->run(run).hash())); }
TUMBLE_EXPORT(troubles) const char* troubles(std::size_t run) { return answer(json_of_troubles(session->run(run))); }

// Of each body position, velocity, orientation (w, x, y, z), angular velocity in the body's axes, asleep, contact
// points: 15 numbers; then kinetic and potential energy, J, and the angular momentum of all, kg m^2/s.
TUMBLE_EXPORT(state) const double* state(std::size_t run) {
    numbers.clear();
    const Simulation& simulation = session->run(run);
    const auto add = [](const auto& list) {
        for (const auto number : list) numbers.push_back(static_cast<double>(number));
    };
    for (int b = 0; b < simulation.body_count(); ++b) {
        const BodySnapshot body = simulation.body(b);
        add(body.position);
        add(body.velocity);
        add(body.orientation);
        add(body.angular_velocity);
        numbers.push_back(body.asleep ? 1 : 0);
        numbers.push_back(body.contacts);
    }
    const Energy energy = simulation.energy();
    numbers.push_back(static_cast<double>(energy.kinetic));
    numbers.push_back(static_cast<double>(energy.potential));
    add(angular_momentum(simulation));
    return numbers.data();
}
// The count of contacts that touch, and of each: normal, point, normal impulse, friction impulse: 10 numbers.
TUMBLE_EXPORT(contacts) const double* contacts(std::size_t run) {
    numbers.assign(1, 0);
    const auto add = [](const Triple& list) { numbers.insert(numbers.end(), list.begin(), list.end()); };
    for (const ContactSnapshot& c : session->run(run).contacts()) {
        if (!c.touches) continue;
        ++numbers[0];
        add(c.normal);
        add(c.point);
        numbers.push_back(c.normal_impulse);
        add(c.friction_impulse);
    }
    return numbers.data();
}
// What each joint of the scene does: 2, it holds; 1, it is a rope that is slack; 0, it is broken or removed.
TUMBLE_EXPORT(joints) const double* joints(std::size_t run) {
    numbers.clear();
    for (const JointDescription& joint : session->scene().joints) {
        const JointSnapshot now = session->run(run).joint(static_cast<int>(numbers.size()));
        const bool is_rope = joint.kind == JointKind::distance && !joint.spring.acts();
        numbers.push_back(now.broken ? 0 : is_rope && now.at_limit == 0 ? 1 : 2);
    }
    return numbers.data();
}

}  // namespace tumble::host

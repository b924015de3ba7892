#include "scene/data.hpp"

#include <tumble/shapes/pairs.hpp>

#include <algorithm>

#include "scene/fields.hpp"
#include "tools/raise.hpp"

namespace tumble::host {
namespace {

// The nearest double: what a header can say.
Real rounded(Real value) { return value.to_double(); }
InertiaTensor rounded(const InertiaTensor& i) {
    return {rounded(i.xx), rounded(i.yy), rounded(i.zz), rounded(i.xy), rounded(i.xz), rounded(i.yz)};
}

// The centre of mass is at `position` whatever the shape, a cloud of points included.
BodySpec body_of(const BodyDescription& body) {
    auto spec = spec_of<BodySpec>(body);
    if (body.shape.kind == ShapeKind::points) {
        const PointCloud cloud = cloud_of(body.shape.points);
        spec.mass = rounded(cloud.mass);
        if (!body.inertia) spec.inertia = rounded(cloud.inertia);
    } else {
        if (!body.mass) spec.mass = rounded(Real{body.density.value()} * volume_of(spec.shape));
        if (!body.inertia) spec.inertia = inertia_of(spec.shape, spec.mass);
    }
    spec.fixed = body.fixed && !body.kinematic;
    return spec;
}

Seconds step_of(const StepSize& step) {
    if (step.denominator == 0) return Seconds{Real{step.decimal}};
    return Seconds{Real::scaled(step.numerator, 0) / Real::scaled(step.denominator, 0)};
}

void check(const SceneDescription& scene) {
    const auto fits = [&](const char* key, std::size_t count, int room) {
        if (count > static_cast<std::size_t>(room))
            raise(UnsupportedScene(scene.path + ": " + key + ": got " + std::to_string(count) + ", expected at most " +
                                   std::to_string(room)));
    };
    fits("body", scene.bodies.size(), max_bodies);
    fits("plane", scene.planes.size(), max_planes);
    fits("spring", scene.springs.size(), max_springs);
    fits("joint", scene.joints.size(), max_joints);
}

// True if two bodies, of which at least one moves, may touch.
bool any_pair_meets(const std::vector<BodySpec>& bodies) {
    for (const BodySpec& a : bodies) {
        if (std::any_of(bodies.begin(), bodies.end(), [&](const BodySpec& b) {
                return &a != &b && meets(a.shape.kind, b.shape.kind) && (a.layers & b.layers) != 0 &&
                       !(a.is_fixed() && b.is_fixed());
            }))
            return true;
    }
    return false;
}

// Air and wheels. A fixed body feels neither.
void add_loads_of_bodies(const SceneDescription& scene, SceneData& data) {
    data.wind = in_kernel(scene.wind);
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyDescription& body = scene.bodies[i];
        const int index = static_cast<int>(i);
        if (body.fixed) continue;
        if (body.linear_drag > 0 || body.quadratic_drag > 0)
            data.drags.push_back({index, body.linear_drag, body.quadratic_drag});
        if (body.wheel_momentum != Triple{}) data.wheels.push_back({index, in_kernel(body.wheel_momentum)});
    }
}

// The events of impulses and forces. In a step they come after the scene's own events, impulses first.
void add_pushes(const SceneDescription& scene, std::vector<EventSpec>& events) {
    const auto add = [&](double time, EventKind kind, const auto& push, const Triple& value, const Triple& point) {
        if (value != Triple{})
            events.push_back({time, kind, push.body, push.frame, in_kernel(value), in_kernel(point)});
    };
    for (const ImpulseDescription& i : scene.impulses) {
        add(i.time, EventKind::impulse, i, i.impulse, i.point);
        add(i.time, EventKind::angular_impulse, i, i.angular_impulse, {});
    }
    for (const ForceDescription& f : scene.forces) {
        add(f.from, EventKind::begin_force, f, f.force, f.point);
        add(f.until, EventKind::end_force, f, f.force, f.point);
        add(f.from, EventKind::begin_torque, f, f.torque, {});
        add(f.until, EventKind::end_torque, f, f.torque, {});
    }
}

}  // namespace

SceneData with_events_in_order(SceneData scene) {
    std::vector<std::pair<std::int64_t, EventSpec>> keyed;
    keyed.reserve(scene.events.size());
    for (const EventSpec& event : scene.events)
        keyed.emplace_back((event.time / scene.step.value).to_fixed(0, 64), event);
    std::stable_sort(keyed.begin(), keyed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 0; i < keyed.size(); ++i) scene.events[i] = keyed[i].second;
    return scene;
}

ContactSpec in_kernel(const ContactDescription& description) {
    const auto spec = spec_of<ContactSpec>(description);
    const ContactSpec usual{.response = spec.response};
    ContactSpec own = spec.response == ContactResponse::impulse ? spec : usual;
    if (spec.response != ContactResponse::none) own.tolerance = spec.tolerance;
    const ContactSpec& springs = spec.response == ContactResponse::spring ? spec : usual;
    own.stiffness = springs.stiffness;
    own.damping = springs.damping;
    own.barrier = springs.barrier;
    return own;
}

AnyJointSpec joint_of(const JointDescription& joint) {
    static const AnyJointSpec of_kind[] = {HingeSpec{},  BallSpec{},      FixedSpec{},
                                           SliderSpec{}, UniversalSpec{}, DistanceSpec{}};
    AnyJointSpec made = of_kind[static_cast<std::size_t>(joint.kind)];
    made.visit([&](auto& spec) { set_fields(spec, NamedJoint{joint}); });
    return made;
}

EventSpec event_of(const EventDescription& event) {
    auto spec = spec_of<EventSpec>(event);
    if (has_joint(event.kind)) spec.body = event.joint;
    return spec;
}

bool shapes_meet(ShapeKind a, ShapeKind b) { return meets(a, b); }

Shape shape_of(const ShapeDescription& shape) {
    return {shape.kind == ShapeKind::points ? ShapeKind::none : shape.kind, in_kernel(shape.size)};
}

InertiaTensor tensor_of(const std::array<double, 6>& i) { return {i[0], i[1], i[2], i[3], i[4], i[5]}; }

PointCloud cloud_of(const std::vector<PointDescription>& points) {
    std::vector<PointMass> masses;
    for (const PointDescription& point : points) masses.push_back({in_kernel(point.position), point.mass});
    return point_cloud(masses.data(), static_cast<int>(masses.size()));
}

SceneData build_scene(const SceneDescription& scene) {
    check(scene);
    SceneData data;
    data.name = scene.name;
    data.step = step_of(scene.step);
    data.steps = static_cast<std::uint32_t>(scene.steps());
    data.world = spec_of<WorldSpec>(scene);
    data.softening = scene.softening;
    for (const BodyDescription& body : scene.bodies) {
        data.bodies.push_back(body_of(body));
        data.bodies.back().layers =
            static_cast<std::uint16_t>(scene.layers_of(static_cast<int>(data.bodies.size()) - 1));
    }
    add_loads_of_bodies(scene, data);
    if (const auto& gradient = scene.gravity_gradient)
        data.orbit = {gradient->orbit_rate, in_kernel(gradient->to_centre)};
    const bool any_in_a_layer =
        std::any_of(data.bodies.begin(), data.bodies.end(), [](const BodySpec& body) { return body.layers != 0; });
    for (const PlaneDescription& plane : scene.planes) {
        if (scene.contact.response != ContactResponse::none && (any_in_a_layer || data.bodies.empty()))
            data.planes.push_back(spec_of<PlaneSpec>(plane));
    }
    for (const SpringDescription& spring : scene.springs) data.springs.push_back(spec_of<SpringSpec>(spring));
    for (const JointDescription& joint : scene.joints) data.joints.push_back(joint_of(joint));
    for (const EventDescription& event : scene.events) data.events.push_back(event_of(event));
    add_pushes(scene, data.events);
    return data;
}

Features needs(const SceneData& scene) {
    const auto any = [](const auto& list, auto&& is_one) { return std::any_of(list.begin(), list.end(), is_one); };
    const auto is_rough = [](const auto& side) { return side.friction > Real{}; };
    const auto resists = [](const auto& side) {
        return side.rolling_resistance > Real{} || side.spinning_resistance > Real{};
    };
    const auto is_box = [](const BodySpec& body) { return body.shape.kind == ShapeKind::box; };
    const auto is_moving_round = [](const BodySpec& body) {
        const ShapeKind kind = body.shape.kind;
        return !body.is_fixed() &&
               (kind == ShapeKind::cylinder || kind == ShapeKind::capsule || kind == ShapeKind::hoop);
    };
    const auto is_moving_other = [](const BodySpec& body) {
        return !body.is_fixed() && body.shape.kind != ShapeKind::sphere;
    };
    const auto is_layered = [](const BodySpec& body) { return body.layers != BodySpec::all_layers; };
    const auto any_joint = [&](auto&& is_one) {
        bool any_is = false;
        for (const AnyJointSpec& joint : scene.joints)
            joint.visit([&](const auto& spec) { any_is = any_is || is_one(spec); });
        return any_is;
    };
    // Without joints all kinds are as a world without joints has them.
    const auto has_kind = [&]<class Spec>(const Spec&) {
        return scene.joints.empty() ||
               any_joint([](const auto& spec) { return std::is_same_v<decltype(spec), const Spec&>; });
    };
    const auto moving = static_cast<int>(
        std::count_if(scene.bodies.begin(), scene.bodies.end(), [](const BodySpec& body) { return !body.is_fixed(); }));
    const auto is_turntable = [](const BodySpec& body) { return body.fixed && !body.angular_velocity.is_zero(); };
    const auto is_timed_force = [](const EventSpec& event) { return is_timed(event.kind); };
    const auto is_impulse = [](const EventSpec& event) {
        return event.kind == EventKind::impulse || event.kind == EventKind::angular_impulse;
    };
    const auto is_control = [](const EventSpec& event) {
        return (is_wrench(event.kind) && !is_timed(event.kind)) || event.kind == EventKind::gravity;
    };
    const auto turns_fixed = [&](const EventSpec& event) {
        return event.kind == EventKind::angular_velocity && scene.bodies[static_cast<std::size_t>(event.body)].fixed;
    };
    const bool rotation =
        scene.bodies.empty() || any(scene.bodies, [](const BodySpec& body) { return !is_point_mass(body); });
    const WorldSpec& world = scene.world;
    const ContactResponse response = world.contact.response;
    const bool pairs = response != ContactResponse::none && any_pair_meets(scene.bodies);
    // Planes need a response and a body that may touch them.
    const std::size_t planes = rotation ? scene.planes.size() : 0;
    const bool touches = planes > 0 || pairs, by_impulses = touches && response == ContactResponse::impulse,
               by_springs = touches && response == ContactResponse::spring;
    const bool rolls_hard =
        by_impulses && (resists(world.contact) || any(scene.bodies, resists) || any(scene.planes, resists));
    return {
        .bodies = static_cast<int>(scene.bodies.size()),
        .planes = static_cast<int>(planes),
        .springs = static_cast<int>(scene.springs.size()),
        .joints = static_cast<int>(scene.joints.size()),
        .hinges = has_kind(HingeSpec{}),
        .balls = has_kind(BallSpec{}),
        .fixed_joints = has_kind(FixedSpec{}),
        .sliders = has_kind(SliderSpec{}),
        .universals = has_kind(UniversalSpec{}),
        .distances = !scene.joints.empty() && has_kind(DistanceSpec{}),
        .joint_springs = any_joint(
            [](const auto& spec) { return detail::spring_of(spec, 0).acts() || detail::spring_of(spec, 1).acts(); }),
        .joint_limits = any_joint([](const auto& spec) { return detail::limits_of(spec).acts(); }),
        .joint_breaks = any_joint([](const auto& spec) {
                            return !detail::break_force_of(spec).is_zero() || !detail::break_torque_of(spec).is_zero();
                        }) ||
                        any(scene.events, [](const EventSpec& event) { return event.kind == EventKind::break_joint; }),
        .rotation = rotation,
        .point_masses = any(scene.bodies, is_point_mass),
        .drag = world.linear_drag > Real{} || world.angular_drag > Real{},
        .gravitation = world.gravitation > Real{} && scene.bodies.size() > 1,
        .softening = scene.softening > Real{} && scene.bodies.size() > 1,
        .air = !scene.drags.empty(),
        .gravity_gradient = !scene.orbit.rate.is_zero() && rotation,
        .wheels = !scene.wheels.empty(),
        .forces = any(scene.events, is_timed_force),
        .impulses = any(scene.events, is_impulse),
        .control = any(scene.events, is_control),
        .script = !std::all_of(scene.events.begin(), scene.events.end(),
                               [&](const EventSpec& event) { return is_timed_force(event) || is_impulse(event); }),
        .removal = any(scene.events, [](const EventSpec& event) { return event.kind == EventKind::remove_joint; }),
        .pairs = pairs,
        .boxes = (by_impulses || by_springs) && any(scene.bodies, is_box),
        .round_shapes = planes > 0 && any(scene.bodies, is_moving_round),
        .layers = touches && any(scene.bodies, is_layered),
        .friction = rolls_hard || (by_impulses && (is_rough(world.contact) || any(scene.bodies, is_rough) ||
                                                   any(scene.planes, is_rough))),
        .rolling_resistance = rolls_hard,
        .mixing = by_impulses && !world.contact.mixes_as_usual(),
        .sleep = world.contact.sleep.on && response == ContactResponse::impulse,
        .turntables = any(scene.bodies, is_turntable) || any(scene.events, turns_fixed),
        .kinematic = any(scene.bodies, [](const BodySpec& body) { return body.kinematic; }),
        .impact_bounds = by_impulses && world.contact.has_bounds(),
        .bounded_steps = by_impulses && !ContactSpec::steps_exactly(world.contact.exact_bodies, moving,
                                                                    !any(scene.bodies, is_moving_other)),
        .exact_steps = world.contact.exact_bodies != 0,
        .contact_impulses = !by_springs,
        .contact_springs = by_springs,
    };
}

}  // namespace tumble::host

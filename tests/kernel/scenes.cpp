#include "scenes.hpp"

#include "references.hpp"

namespace tumble::test {

namespace {

constexpr RealVec3 earth_gravity{0, -9.81, 0};

// With axes of its own.
BodySpec thrown_body() {
    return {.mass = 1.5,
            .inertia = {2, 1.5, 1.75, 0.25, -0.125, 0.375},
            .position = {0.5, 4, -1},
            .velocity = {1, 2, -0.5},
            .orientation = {0.9, {0.1, -0.3, 0.2}},
            .angular_velocity = {0.5, -2, 1}};
}

void add_loads(std::vector<SceneSetup>& s) {
    const BodySpec body = thrown_body();

    s.push_back({.name = "free_top", .needs = nothing});
    s.back().world.gravity = {0, -1, 0};
    s.back().bodies = {body};

    s.push_back({.name = "dragged_projectile", .step = Seconds{Real{0.005}}, .needs = with_drag});
    s.back().world = {.gravity = earth_gravity, .linear_drag = 0.1, .angular_drag = 0.05};
    s.back().bodies = {body};

    s.push_back({.name = "body_on_a_spring", .needs = with_spring});
    s.back().world.gravity = earth_gravity;
    s.back().bodies = {body};
    s.back().springs = {
        {.point = {0.25, 0.5, 0}, .to = {0, 5, 0}, .stiffness = 40, .damping = 0.5, .rest_length = 0.75}};

    s.push_back({.name = "bodies_on_a_spring", .needs = with_coupling});
    s.back().bodies = {body, placed(sphere(2, 0.25), {}, {-0.5, 0.25, 1})};
    s.back().springs = {{.body = 0,
                         .point = {0.25, 0.5, 0},
                         .to_body = 1,
                         .to = {0, 0.25, 0},
                         .stiffness = 20,
                         .damping = 0.25,
                         .rest_length = 1}};

    s.push_back({.name = "two_body_orbit", .step = Seconds{1, 128}, .needs = with_gravitation});
    s.back().world.gravitation = 1;
    s.back().bodies = {sphere(8, 0.5), body};
    s.back().bodies[1].position = {4, 0, 0};
    s.back().bodies[1].velocity = {0, 1.5, 0};

    s.push_back({.name = "timed_forces", .needs = with_forces});
    s.back().world.gravity = {0, -1, 0};
    s.back().bodies = {body};
    s.back().forces = {{.from = 0.0,
                        .until = 0.5,
                        .frame = Frame::body,
                        .force = {1, 2, -1},
                        .point = {0.1, 0, 0.2},
                        .torque = {0, 0.5, 0}},
                       {.from = 0.25, .until = 2.0, .force = {0, 3, 0}, .point = {-0.1, 0.1, 0}}};

    s.push_back({.name = "timed_impulses", .step = Seconds{1, 60}, .needs = with_impulses});
    s.back().world.gravity = {0, -0.5, 0};
    s.back().bodies = {body};
    s.back().impulses = {{.time = 0.0, .impulse = {1, 0, 0}, .point = {0, 0.25, 0}},
                         {.time = 0.5, .frame = Frame::body, .impulse = {0, 1, 0}, .angular_impulse = {0.25, 0, -0.5}},
                         {.time = 0.5, .impulse = {-1, 0.5, 0.25}, .point = {0.125, 0, 0}}};
}

void add_contacts_of_one_body(std::vector<SceneSetup>& s) {
    s.push_back({.name = "bouncing_ball", .needs = with_plane});
    s.back().world = {.gravity = earth_gravity, .contact = {.restitution = 0.8}};
    s.back().bodies = {placed(sphere(1, 0.5), {0, 2, 0}, {1, 0, 0}, {0, 1, 2})};
    s.back().planes = {{}};

    s.push_back({.name = "tumbling_box", .needs = with_box});
    s.back().world = {.gravity = earth_gravity, .contact = {.restitution = 0.4}};
    s.back().bodies = {oriented(placed(box(2, {1, 0.5, 0.75}), {0, 2, 0}, {}, {1, 0.5, -2}), {0.9, {0.1, -0.3, 0.2}})};
    s.back().planes = {{}};

    s.push_back({.name = "sliding_box", .needs = with_friction});
    s.back().world = {.gravity = earth_gravity, .contact = {.restitution = 0.3, .friction = 0.4}};
    s.back().bodies = {oriented(placed(box(2, {1, 0.5, 0.75}), {0, 1, 0}, {3, 0, 1}), {0.9, {0, 0.1, 0.2}})};
    s.back().planes = {{.normal = {0.1, 1, 0}}};

    s.push_back({.name = "rolling_cylinder", .needs = with_round_shapes});
    s.back().world = {.gravity = earth_gravity, .contact = {.restitution = 0.3, .friction = 0.4}};
    s.back().bodies = {oriented(placed(cylinder(2, 0.25, 1), {0, 1.25, 0}, {1, 0, 0.5}), {0.9, {0.1, -0.3, 0.2}})};
    s.back().planes = {{}};
}

void add_pairs_sleep_and_contact_springs(std::vector<SceneSetup>& s) {
    s.push_back({.name = "spheres_that_meet", .needs = with_pairs});
    s.back().world = {.contact = {.restitution = 0.9}};
    s.back().bodies = {placed(sphere(1, 0.5), {-1, 0.25, 0}, {1.5, 0, 0.25}, {1, 2, 3}),
                       placed(sphere(3, 0.25), {1, 0, 0.5}, {-1, 0, 0})};

    s.push_back({.name = "box_falls_on_a_box", .needs = with_box_pairs});
    s.back().world = {.gravity = earth_gravity, .contact = {.restitution = 0.3, .friction = 0.4}};
    s.back().bodies = {fixed(placed(box(100, {8, 1, 8}), {0, -0.5, 0})),
                       oriented(placed(box(2, {1, 0.5, 0.75}), {0, 1.25, 0}, {1, 0, 0.5}), {0.9, {0.1, -0.3, 0.2}})};

    s.push_back({.name = "ball_on_a_turntable", .needs = with_turntable});
    s.back().world = {.gravity = earth_gravity, .contact = {.restitution = 0.25, .friction = 0.5}};
    s.back().bodies = {fixed(placed(box(100, {8, 0.5, 8}), {0, -0.25, 0}, {}, {0, 2, 0})),
                       placed(sphere(1, 0.25), {1, 0.5, 0}, {0.5, 0, 0})};

    s.push_back({.name = "box_falls_asleep", .needs = with_sleep});
    s.back().world = {.gravity = earth_gravity,
                      .contact = {.restitution = 0.2, .friction = 0.5, .sleep = {.on = true, .time = 0.25}}};
    s.back().bodies = {oriented(placed(box(2, {1, 0.25, 0.75}), {0, 0.75, 0}), {0.99, {0.1, 0, 0.05}})};
    s.back().planes = {{}};

    s.push_back({.name = "balls_on_contact_springs", .needs = with_contact_springs});
    s.back().world = {.gravity = earth_gravity,
                      .contact = {.response = ContactResponse::spring, .stiffness = 2000, .damping = 4}};
    s.back().bodies = {placed(sphere(1, 0.5), {0, 0.75, 0}), placed(sphere(0.5, 0.25), {0.0625, 2, 0})};
    s.back().planes = {{}};

    s.push_back({.name = "balls_behind_barriers", .needs = with_contact_springs});
    s.back().world = {.gravity = earth_gravity,
                      .contact = {.response = ContactResponse::spring, .stiffness = 2000, .barrier = 0.5}};
    s.back().bodies = {placed(sphere(1, 0.5), {0, 1.25, 0}), placed(sphere(0.5, 0.25), {0.0625, 3, 0})};
    s.back().planes = {{}};
}

void add_points(std::vector<SceneSetup>& s) {
    const BodySpec body = thrown_body();
    // Alone, in loads that do not couple it, and with all that may act on it.
    BodySpec point = placed(point_mass(1.5), {0.5, 4, -1}, {1, 2, -0.5});
    s.push_back({.name = "thrown_point", .needs = with_point});
    s.back().world = {.gravity = earth_gravity, .linear_drag = 0.1};
    s.back().bodies = {point};
    s.back().impulses = {{.time = 0.25, .impulse = {1, 0, -0.5}}, {.time = 0.5, .impulse = {-1, 2, 0}}};

    s.push_back({.name = "points_that_attract", .step = Seconds{1, 128}, .needs = with_points});
    s.back().world = {.gravity = {0, -1, 0}, .gravitation = 1, .linear_drag = 0.05};
    s.back().bodies = {fixed(placed(point_mass(8), {0, 2, 0})), point,
                       placed(point_mass(0.5), {-2, 3, 1}, {0, -1, 0.5})};
    s.back().springs = {{.body = 1, .to_body = 2, .stiffness = 10, .damping = 0.25, .rest_length = 1},
                        {.body = 2, .to = {0, 5, 0}, .stiffness = 4}};
    s.back().forces = {{.body = 1, .from = 0.25, .until = 2.0, .force = {0, 1, 0.5}}};
    s.back().impulses = {{.time = 0.5, .body = 2, .impulse = {0.5, 0, 0}}};

    // Two tied to a body off its centre, and to each other; one flies alone.
    s.push_back({.name = "points_among_bodies", .needs = with_points_among_bodies});
    s.back().world = {.gravity = earth_gravity, .linear_drag = 0.1, .angular_drag = 0.05};
    s.back().bodies = {placed(point_mass(1.5), {1.5, 5, -1}, {1, 2, -0.5}), body, placed(point_mass(0.5), {-1, 4, 0}),
                       placed(point_mass(2), {6, 2, 3}, {0, 5, 0})};
    s.back().springs = {{.body = 0, .to_body = 1, .to = {0.25, 0.5, 0}, .stiffness = 30, .damping = 0.5},
                        {.body = 1, .point = {-0.25, 0, 0.5}, .to_body = 2, .stiffness = 20, .rest_length = 1},
                        {.body = 2, .to_body = 0, .stiffness = 5, .rest_length = 2}};
    s.back().forces = {{.body = 2, .from = 0.0, .until = 0.5, .force = {0, 8, 0}}};
    s.back().impulses = {{.time = 0.25, .body = 0, .impulse = {1, 0, 0}},
                         {.time = 0.5, .body = 1, .impulse = {0, 1, 0}, .point = {0.25, 0, 0}}};

    // The point passes through the plane that its ball bounces on.
    s.push_back({.name = "point_below_a_ball", .needs = with_point_and_plane});
    s.back().world = {.gravity = earth_gravity, .contact = {.restitution = 0.8}};
    s.back().bodies = {placed(sphere(1, 0.25), {0, 1, 0}), placed(point_mass(0.5), {0.5, 0.5, 0})};
    s.back().springs = {{.body = 0, .point = {0.25, 0, 0}, .to_body = 1, .stiffness = 40, .rest_length = 0.5}};
    s.back().planes = {{}};
}

}  // namespace

const std::vector<SceneSetup>& scenes() {
    static const std::vector<SceneSetup> all = [] {
        std::vector<SceneSetup> s;
        add_loads(s);
        add_contacts_of_one_body(s);
        add_pairs_sleep_and_contact_springs(s);
        add_points(s);
        return s;
    }();
    return all;
}

}  // namespace tumble::test

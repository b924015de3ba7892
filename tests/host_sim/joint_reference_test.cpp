// The reference of jointed bodies against motions that are known in closed form or by other equations.
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "simulation/simulation.hpp"
#include "truth/smooth_motion.hpp"
#include "truth/trajectory.hpp"
#include "verdict/accuracy.hpp"

namespace tumble::host {
namespace {

using reference::exponential, reference::Motion, reference::Number, reference::Rotation, reference::Vector,
    reference::vector_of, reference::rotation_of;

constexpr Number pi = std::numbers::pi_v<Number>;
// Of motions of a few metres and radians over seconds. Scenes are in double precision, so they are rounded at 1e-16.
constexpr Number tolerance = 2e-14L;

Triple triple(const Vector& v) { return {double(v.x), double(v.y), double(v.z)}; }
Quadruple quadruple(const Rotation& q) { return {double(q.w), double(q.v.x), double(q.v.y), double(q.v.z)}; }

// A scene that is turned, mirrored and moved as a whole: every vector goes through it. A mirror takes x to -x.
struct Frame3 {
    Rotation turn{};
    Vector origin{};
    bool is_mirrored = false;

    [[nodiscard]] Vector direction(Vector v) const {
        if (is_mirrored) v.x = -v.x;
        return turn.rotate(v);
    }
    // Of a rotation or an angular velocity.
    [[nodiscard]] Vector axial(const Vector& v) const { return is_mirrored ? -direction(v) : direction(v); }
    [[nodiscard]] Vector point(const Vector& v) const { return origin + direction(v); }
};
const Frame3 frames[] = {
    {},
    {exponential<Number>({0.3L, -1.1L, 0.7L}), {2, -1, 3}},
    {exponential<Number>({-2.0L, 0.4L, 0.9L}), {-4, 0.5L, 1}, true},
};

struct Built {
    SceneDescription scene;

    Built() {
        scene.step = StepSize{1, 64};
        scene.duration = 100;
        scene.contact.response = ContactResponse::none;
    }
    // `angular_velocity` in the world.
    int add(const Triple& box, double mass, const Vector& position, const Rotation& orientation = {},
            const Vector& velocity = {}, const Vector& angular_velocity = {}) {
        BodyDescription body;
        body.name = "body " + std::to_string(scene.bodies.size());
        body.shape.kind = ShapeKind::box;
        body.shape.size = box;
        body.mass = mass;
        body.position = triple(position);
        body.orientation = quadruple(orientation);
        body.velocity = triple(velocity);
        body.angular_velocity = triple(orientation.rotate_back(angular_velocity));
        scene.bodies.push_back(body);
        return static_cast<int>(scene.bodies.size()) - 1;
    }
    void join(JointKind kind, int body, int to_body, const Vector& anchor, const Vector& axis = {0, 0, 1},
              const Vector& to_axis = {}) {
        JointDescription joint;
        joint.name = "joint " + std::to_string(scene.joints.size());
        joint.kind = kind;
        joint.body = body;
        joint.to_body = to_body;
        joint.anchor = triple(anchor);
        joint.axis = triple(axis);
        joint.to_axis = triple(to_axis);
        scene.joints.push_back(joint);
    }
    void join_by_rod(int body, int to_body, const Vector& point, const Vector& to_point) {
        join(JointKind::distance, body, to_body, point);
        JointDescription& joint = scene.joints.back();
        joint.to_point = triple(to_point);
        joint.least = joint.most = static_cast<double>(norm(point - to_point));
    }
    // At rising times, s.
    [[nodiscard]] std::vector<std::vector<Motion>> at(std::initializer_list<double> times) const {
        SmoothMotion motion(scene, [](ShapeKind, ShapeKind) { return true; });
        std::vector<std::vector<Motion>> states;
        for (const double time : times) {
            motion.advance_to(nearest_step(time, scene.step));
            states.push_back(motion.bodies());
        }
        return states;
    }
    [[nodiscard]] std::vector<Motion> at(double time) const { return at({time})[0]; }
};

void expect_near(const Vector& got, const Vector& expected, Number most = tolerance) {
    EXPECT_LE(static_cast<double>(norm(got - expected)), static_cast<double>(most * (1 + norm(expected))))
        << "got " << static_cast<double>(got.x) << " " << static_cast<double>(got.y) << " "
        << static_cast<double>(got.z) << ", expected " << static_cast<double>(expected.x) << " "
        << static_cast<double>(expected.y) << " " << static_cast<double>(expected.z);
}
void expect_near(const Rotation& got, const Rotation& expected, Number most = tolerance) {
    EXPECT_LE(static_cast<double>(angle_between(got, expected)), static_cast<double>(most));
}

// J, of boxes.
Number kinetic_energy_of(const SceneDescription& scene, const std::vector<Motion>& now) {
    Number sum = 0;
    for (std::size_t i = 0; i < now.size(); ++i) {
        const auto& [x, y, z] = scene.bodies[i].shape.size;
        const Number mass = *scene.bodies[i].mass;
        const Vector &v = now[i].v, &w = now[i].w;
        sum += mass * dot(v, v) / 2 +
               mass / 24 * ((y * y + z * z) * w.x * w.x + (x * x + z * z) * w.y * w.y + (x * x + y * y) * w.z * w.z);
    }
    return sum;
}

Number moment_about(const Triple& box, Number mass) { return mass * (box[0] * box[0] + box[1] * box[1]) / 12; }

// A rod of `length` that hangs from the origin by one end, turned by `angle` about z.
constexpr double width = 0.125;
Triple rod(double length) { return {width, length, width}; }
Vector hanging(Number length, Number angle) { return {length * std::sin(angle), -length * std::cos(angle), 0}; }

Number arithmetic_geometric_mean(Number a, Number b) {
    while (std::abs(a - b) > 1e-18L * a) {
        const Number mean = (a + b) / 2;
        b = std::sqrt(a * b);
        a = mean;
    }
    return a;
}

TEST(JointReference, pendulum_returns_after_the_period_by_the_arithmetic_geometric_mean) {
    const struct {
        JointKind kind;
        double length, mass, amplitude;
        StepSize step;
    } cases[] = {
        {JointKind::hinge, 1, 1, 2.5, {1, 64}},
        {JointKind::hinge, 0.25, 7, -3.1, {1, 100}},
        {JointKind::ball, 2, 0.5, 1.0, {1, 128}},
        {JointKind::universal, 1.5, 3, -1.5, {1, 50}},
    };
    for (const auto& c : cases) {
        for (const Frame3& frame : frames) {
            // Gravity that makes the period 2 s.
            const Number centre = Number(c.length) / 2,
                         moment = moment_about(rod(c.length), c.mass) + c.mass * centre * centre,
                         rate = pi / arithmetic_geometric_mean(1, std::cos(Number(c.amplitude) / 2)),
                         gravity = rate * rate * moment / (c.mass * centre);
            Built built;
            built.scene.step = c.step;
            built.scene.gravity = triple(frame.direction({0, -gravity, 0}));
            const Rotation start = exponential(frame.axial({0, 0, c.amplitude})) * frame.turn;
            const Vector at_start = frame.point(hanging(centre, c.amplitude));
            const int body = built.add(rod(c.length), c.mass, at_start, start);
            built.join(c.kind, body, -1, frame.origin, frame.axial({0, 0, 1}), frame.direction({1, 0, 0}));
            const std::vector<Motion> half = built.at(1), whole = built.at(2);
            expect_near(half[0].x, frame.point(hanging(centre, -c.amplitude)), 1e-12L);
            expect_near(whole[0].x, at_start, 1e-12L);
            expect_near(whole[0].q, start, 1e-12L);
            expect_near(whole[0].v, {}, 1e-11L);
        }
    }
}

// Two rods in the plane, by Lagrange's equations in their angles from hanging.
struct DoublePendulum {
    Number gravity, mass[2], length[2];
    using State = std::array<Number, 4>;  // angles, rates

    void operator()(const State& s, State& rate, Number) const {
        const Number d1 = length[0] / 2, d2 = length[1] / 2,
                     m11 = mass[0] * (length[0] * length[0] + Number(width) * width) / 12 + mass[0] * d1 * d1 +
                           mass[1] * length[0] * length[0],
                     m22 = mass[1] * (length[1] * length[1] + Number(width) * width) / 12 + mass[1] * d2 * d2,
                     coupling = mass[1] * length[0] * d2, m12 = coupling * std::cos(s[0] - s[1]),
                     turn = coupling * std::sin(s[0] - s[1]),
                     f1 = -turn * s[3] * s[3] - (mass[0] * d1 + mass[1] * length[0]) * gravity * std::sin(s[0]),
                     f2 = turn * s[2] * s[2] - mass[1] * d2 * gravity * std::sin(s[1]),
                     determinant = m11 * m22 - m12 * m12;
        rate = {s[2], s[3], (m22 * f1 - m12 * f2) / determinant, (m11 * f2 - m12 * f1) / determinant};
    }
};

TEST(JointReference, double_pendulum_follows_the_equations_of_lagrange) {
    const struct {
        double mass[2], length[2], angle[2], rate[2];
        JointKind kind;
    } cases[] = {
        {{1, 1}, {1, 1}, {2.0, 2.4}, {0, 0}, JointKind::hinge},
        {{5, 0.25}, {0.5, 1.5}, {-1.0, 0.5}, {3, -2}, JointKind::hinge},
        {{0.5, 4}, {1.25, 0.75}, {1.5, -2.9}, {0, 4}, JointKind::ball},
    };
    for (const auto& c : cases) {
        for (const Frame3& frame : frames) {
            Built built;
            built.scene.gravity = triple(frame.direction({0, -9.75L, 0}));
            const Vector knee = hanging(c.length[0], c.angle[0]);
            const auto turned = [&](Number angle) { return exponential(frame.axial({0, 0, angle})) * frame.turn; };
            const auto velocity = [&](Number rate, const Vector& arm) { return cross(Vector{0, 0, rate}, arm); };
            const Vector to_upper = hanging(Number(c.length[0]) / 2, c.angle[0]),
                         to_lower = hanging(Number(c.length[1]) / 2, c.angle[1]);
            const int upper = built.add(rod(c.length[0]), c.mass[0], frame.point(to_upper), turned(c.angle[0]),
                                        frame.direction(velocity(c.rate[0], to_upper)), frame.axial({0, 0, c.rate[0]}));
            const int lower = built.add(rod(c.length[1]), c.mass[1], frame.point(knee + to_lower), turned(c.angle[1]),
                                        frame.direction(velocity(c.rate[0], knee) + velocity(c.rate[1], to_lower)),
                                        frame.axial({0, 0, c.rate[1]}));
            // The knee's sides are in either order.
            if (frame.is_mirrored) built.join(c.kind, upper, lower, frame.point(knee), frame.axial({0, 0, 1}));
            else built.join(c.kind, lower, upper, frame.point(knee), frame.axial({0, 0, 1}));
            built.join(c.kind, upper, -1, frame.origin, frame.axial({0, 0, 1}));
            DoublePendulum::State state{c.angle[0], c.angle[1], c.rate[0], c.rate[1]};
            reference::integrate(DoublePendulum{9.75L, {c.mass[0], c.mass[1]}, {c.length[0], c.length[1]}}, state,
                                 Number(0), Number(2));
            const std::vector<Motion> end = built.at(2);
            expect_near(end[0].x, frame.point(hanging(Number(c.length[0]) / 2, state[0])), 1e-12L);
            expect_near(end[1].x,
                        frame.point(hanging(c.length[0], state[0]) + hanging(Number(c.length[1]) / 2, state[1])),
                        1e-12L);
            expect_near(end[1].q, turned(state[1]), 1e-12L);
        }
    }
}

struct Sums {
    Vector momentum, angular_momentum;  // about the origin
    Number energy = 0;
};
Sums sums_of(const SceneDescription& scene, const std::vector<Motion>& motions) {
    Sums sums;
    const Vector gravity = vector_of(scene.gravity);
    for (std::size_t i = 0; i < motions.size(); ++i) {
        const BodyDescription& body = scene.bodies[i];
        if (body.fixed) continue;
        const Triple& size = body.shape.size;
        const Number mass = *body.mass;
        const Vector square{Number(size[0]) * size[0], Number(size[1]) * size[1], Number(size[2]) * size[2]},
            moments = Vector{square.y + square.z, square.x + square.z, square.x + square.y} * (mass / 12);
        const Motion& m = motions[i];
        const Vector spin = times(moments, m.w);
        sums.momentum = sums.momentum + m.v * mass;
        sums.angular_momentum = sums.angular_momentum + cross(m.x, m.v) * mass + m.q.rotate(spin);
        sums.energy += (mass * dot(m.v, m.v) + dot(m.w, spin)) / 2 - mass * dot(gravity, m.x);
    }
    return sums;
}

// Bodies of random size, place and motion that hang on each other by all kinds of joints.
Built random_tree(unsigned seed, bool is_tied) {
    std::mt19937 random(seed);
    const auto next = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
    const auto vector = [&](double most) { return Vector{next(-most, most), next(-most, most), next(-most, most)}; };
    Built built;
    constexpr int bodies = 7;
    for (int i = 0; i < bodies; ++i)
        built.add({next(0.2, 1), next(0.2, 1), next(0.2, 1)}, next(0.5, 4), vector(2), exponential(vector(2)),
                  vector(1), vector(2));
    constexpr JointKind kinds[] = {JointKind::hinge, JointKind::ball, JointKind::fixed, JointKind::slider,
                                   JointKind::universal};
    for (int i = is_tied ? 0 : 1; i < bodies; ++i) {
        const Vector axis = vector(1), to_axis = cross(axis, vector(1));
        const int other = i == 0 ? -1 : static_cast<int>(next(0, i));
        const Vector anchor = vector_of(built.scene.body(i).position) + vector(0.5);
        const JointKind kind = kinds[(static_cast<unsigned>(i) + seed) % 5];
        if (i % 2 == 0 || other < 0) built.join(kind, i, other, anchor, axis, to_axis);
        else built.join(kind, other, i, anchor, axis, to_axis);
    }
    return built;
}

TEST(JointReference, free_trees_keep_momentum_and_energy) {
    for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
        const Built built = random_tree(seed, false);
        // What the joints do not allow has ended after the first moment.
        const Sums given = sums_of(built.scene, built.at(0)), start = sums_of(built.scene, built.at(1.0 / 64)),
                   end = sums_of(built.scene, built.at(1));
        expect_near(start.momentum, given.momentum);
        expect_near(start.angular_momentum, given.angular_momentum);
        EXPECT_LT(static_cast<double>(start.energy), static_cast<double>(given.energy));
        expect_near(end.momentum, given.momentum);
        expect_near(end.angular_momentum, given.angular_momentum);
        EXPECT_NEAR(static_cast<double>(end.energy / start.energy), 1, 1e-14);
    }
}

TEST(JointReference, tied_trees_keep_energy_under_gravity_and_joints_stay_closed) {
    for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
        Built built = random_tree(seed, true);
        built.scene.gravity = {1, -9.5, 2};
        const std::vector<Motion> first = built.at(0), early = built.at(1.0 / 64), late = built.at(1);
        EXPECT_NEAR(static_cast<double>(sums_of(built.scene, late).energy / sums_of(built.scene, early).energy), 1,
                    1e-13);
        for (const JointDescription& joint : built.scene.joints) {
            const auto side = [&](int body, const std::vector<Motion>& at) {
                return body < 0 ? Motion{} : at[static_cast<std::size_t>(body)];
            };
            const auto arm = [&](int body) {
                const Motion m = side(body, first);
                return m.q.rotate_back(vector_of(joint.anchor) - m.x);
            };
            const Motion one = side(joint.body, late), other = side(joint.to_body, late);
            const auto carried = [&](const Motion& now, int body, const Vector& v) {
                return now.q.rotate(side(body, first).q.rotate_back(v * (1 / norm(v))));
            };
            const Vector gap = one.x + one.q.rotate(arm(joint.body)) - other.x - other.q.rotate(arm(joint.to_body)),
                         axis = carried(one, joint.body, vector_of(joint.axis)),
                         same = carried(other, joint.to_body, vector_of(joint.axis)),
                         to_axis = carried(other, joint.to_body, vector_of(joint.to_axis));
            if (joint.kind == JointKind::slider) expect_near(cross(gap, axis), {});
            else expect_near(gap, {});
            if (joint.kind == JointKind::hinge || joint.kind == JointKind::slider) expect_near(axis, same);
            if (joint.kind == JointKind::universal) { EXPECT_NEAR(static_cast<double>(dot(axis, to_axis)), 0, 1e-14); }
            if (joint.kind == JointKind::slider || joint.kind == JointKind::fixed)
                expect_near(one.q * side(joint.body, first).q.conjugate(),
                            other.q * side(joint.to_body, first).q.conjugate());
        }
    }
}

// Of a top of moments I1 about its tip and I3 about its axis, at the angle from upright: I1 W^2 cos - I3 w3 W + m g l =
// 0, where W is the rate of the precession and w3 the spin about the axis.
TEST(JointReference, top_on_a_ball_precesses_steadily) {
    for (const Number angle : {0.5L, 1.25L, 2.5L}) {
        for (const Frame3& frame : frames) {
            const Number mass = 2, radius = 0.25L, gravity = 10, spin = 80;
            const Triple box{0.5, 0.5, 0.25};
            const Number across = mass * (0.25L + 0.0625L) / 12 + mass * radius * radius, along = mass * 0.5L / 12;
            const Number b = along * spin,
                         root = std::sqrt(b * b - 4 * across * std::cos(angle) * mass * gravity * radius),
                         rate = 2 * mass * gravity * radius / (b + root);
            // The axis leans from y towards x; the precession is about y.
            const Vector axis{std::sin(angle), std::cos(angle), 0};
            const Vector w = axis * (spin - rate * std::cos(angle)) + Vector{0, rate, 0};
            const Rotation start =
                exponential(frame.axial({0, 0, -angle})) * exponential(frame.axial({-pi / 2, 0, 0})) * frame.turn;
            Built built;
            built.scene.gravity = triple(frame.direction({0, -gravity, 0}));
            const int top = built.add(box, double(mass), frame.point(axis * radius), start,
                                      frame.direction(cross(w, axis * radius)), frame.axial(w));
            built.join(JointKind::ball, top, -1, frame.origin);
            const Vector end = exponential<Number>({0, rate * 2, 0}).rotate(axis * radius);
            expect_near(built.at(2)[0].x, frame.point(end), 1e-12L);
        }
    }
}

// The angular momentum of a rotor in two rings turns the outer ring: against a body with the rotor as stored momentum.
TEST(JointReference, rotor_on_a_hinge_acts_as_stored_momentum) {
    // The rotor is round about its axle, so the rest of the motion does not show its angle.
    const auto housing_at_end = [](bool has_rotor) {
        Built built;
        const Vector axle{0, 0, 1};
        const Number spin = 40;
        const Vector w{0.5L, -0.25L, 0};
        const int housing = built.add({1, 0.5, 0.75}, 3, {1, 2, 3}, {}, {}, w);
        const Triple disc{0.5, 0.5, 0.125};
        const int rotor = built.add(disc, 1, {1, 2, 3}, {}, {}, w + axle * (has_rotor ? spin : 0));
        if (has_rotor) {
            built.join(JointKind::hinge, rotor, housing, {1, 2, 3}, axle);
        } else {
            // The rotor's momentum is that of the wheel along the axle; the body turns with it about other axes. A
            // rotor that is free about the axle adds no moment there: the housing's moment about z is its own alone.
            const Number along = moment_about(disc, 1), across = (0.25L + 0.015625L) / 12;
            const Number x = 3 * (0.25L + 0.5625L) / 12 + across, y = 3 * (1 + 0.5625L) / 12 + across,
                         z = 3 * (1 + 0.25L) / 12;
            built.scene.bodies.pop_back();
            built.scene.bodies[0].inertia = {double(x), double(y), double(z), 0, 0, 0};
            built.scene.bodies[0].wheel_momentum = triple(axle * (along * spin));
        }
        return built.at(2)[0].q;
    };
    expect_near(housing_at_end(true), housing_at_end(false), 1e-12L);
}

TEST(JointReference, body_slides_down_a_slope) {
    for (const Frame3& frame : frames) {
        Built built;
        built.scene.gravity = triple(frame.direction({0, -10, 0}));
        const Vector down{0.8L, -0.6L, 0};
        const int block = built.add({1, 2, 3}, 2, frame.point({1, 1, 1}), frame.turn, frame.direction({0, -5, 3}),
                                    frame.axial({1, 2, 3}));
        built.join(JointKind::slider, block, -1, frame.point({2, 5, 0}), frame.direction(down * -4));
        // The start keeps the part of the velocity along the slope, 3 m/s; gravity has 6 m/s^2 there.
        const Motion end = built.at(2)[0];
        expect_near(end.x, frame.point(Vector{1, 1, 1} + down * (3 * 2 + 6 * 2)));
        expect_near(end.v, frame.direction(down * (3 + 12)));
        expect_near(end.w, {});
        expect_near(end.q, frame.turn);
    }
}

// A bead that slides along an arm on a hinge, both without weight: with L = (I + m r^2) w, r'' = r w^2.
TEST(JointReference, bead_slides_out_along_a_turning_arm) {
    for (const bool is_reversed : {false, true}) {
        for (const Frame3& frame : frames) {
            const Number rate = 2, out = 0.5L;
            const Triple arm_box{2, 0.25, 0.25}, bead_box{0.25, 0.25, 0.25};
            const Number arm_moment = moment_about(arm_box, 3), bead_moment = moment_about(bead_box, 1.5);
            Built built;
            const Vector w = frame.axial({0, 0, rate});
            const int arm = built.add(arm_box, 3, frame.origin, frame.turn, {}, w),
                      bead = built.add(bead_box, 1.5, frame.point({out, 0, 0}), frame.turn,
                                       frame.direction({0.25L, rate * out, 0}), w);
            built.join(JointKind::hinge, arm, -1, frame.origin, frame.axial({0, 0, 1}));
            const Vector axis = frame.direction({1, 0, 0}), anchor = frame.point({out, 0, 0});
            if (is_reversed) built.join(JointKind::slider, arm, bead, anchor, axis);
            else built.join(JointKind::slider, bead, arm, anchor, axis);
            using State = std::array<Number, 3>;  // r, r', angle
            const Number momentum = (arm_moment + bead_moment + 1.5L * out * out) * rate;
            State state{out, 0.25L, 0};
            const auto equations = [&](const State& s, State& r, Number) {
                const Number turning = momentum / (arm_moment + bead_moment + 1.5L * s[0] * s[0]);
                r = {s[1], s[0] * turning * turning, turning};
            };
            reference::integrate(equations, state, Number(0), Number(2));
            const std::vector<Motion> end = built.at(2);
            expect_near(end[1].x, frame.point({state[0] * std::cos(state[2]), state[0] * std::sin(state[2]), 0}),
                        1e-13L);
            expect_near(end[0].x, frame.origin);
        }
    }
}

TEST(JointReference, welded_bodies_tumble_as_one) {
    // Two halves of a box, welded at a corner, against the whole.
    const Vector w{0.5L, 2, -0.25L}, velocity{1, 0, 2};
    const Rotation turn = exponential<Number>({0.5L, 0.25L, -1});
    const auto point = [&](Number x) { return turn.rotate({x, 0, 0}); };
    Built halves, whole;
    for (const Number x : {-0.5L, 0.5L}) halves.add({1, 0.5, 2}, 3, point(x), turn, velocity + cross(w, point(x)), w);
    halves.join(JointKind::fixed, 1, 0, turn.rotate({0, 0.25L, 1}));
    whole.add({2, 0.5, 2}, 6, {}, turn, velocity, w);
    for (Built* built : {&halves, &whole}) built->scene.gravity = {0, -10, 0};
    const std::vector<Motion> parts = halves.at(2);
    const Motion one = whole.at(2)[0];
    expect_near((parts[0].x + parts[1].x) * 0.5L, one.x);
    expect_near(parts[0].q, one.q);
    expect_near(parts[1].q, one.q);
    expect_near(parts[1].w, one.w);
}

TEST(JointReference, velocities_across_joints_end_at_the_start_as_in_a_blow) {
    // A rod that flies sideways is caught at one end: its angular momentum about the end stays.
    Built built;
    const int body = built.add(rod(1), 2, {0, -0.5L, 0}, {}, {3, 1, 2}, {4, 0, 1});
    built.join(JointKind::hinge, body, -1, {});
    const Number own = moment_about(rod(1), 2), about_end = own + 0.5L;
    expect_near(built.at(1.0 / 64)[0].w, {0, 0, (own * 1 + 2 * 0.5L * 3) / about_end});
    // Before the first step they are those of the scene.
    expect_near(built.at(0)[0].v, {3, 1, 2});
}

TEST(JointReference, impulse_moves_the_whole_tree) {
    // A blow of 4 N s on the tip of the lower of two rods in line, which are on a ball and a hinge and at rest.
    Built built;
    const int upper = built.add(rod(1), 1, {0, -0.5L, 0}), lower = built.add(rod(1), 1, {0, -1.5L, 0});
    built.join(JointKind::ball, upper, -1, {});
    built.join(JointKind::hinge, lower, upper, {0, -1, 0});
    ImpulseDescription blow;
    blow.body = lower;
    blow.time = 1.0 / 64;
    blow.impulse = {4, 0, 0};
    blow.point = {0, -0.5, 0};
    built.scene.impulses.push_back(blow);
    expect_near(built.at(1.0 / 64)[1].v, {});
    // Both rates from the momenta about the upper end and, of the lower rod, about the knee.
    const Number end = moment_about(rod(1), 1) + 0.25L, m11 = end + 1, m12 = 0.5L, m22 = end,
                 determinant = m11 * m22 - m12 * m12, j1 = 4, j2 = 4;
    const Number w1 = (m22 * j1 - m12 * j2) / determinant, w2 = (m11 * j2 - m12 * j1) / determinant;
    Built late = built;
    late.scene.step = StepSize{1, std::int64_t{1} << 20};  // so that the next step is 1e-6 s later
    late.scene.impulses[0].time = 0;
    const std::vector<Motion> after = late.at(0x1p-20);
    expect_near(after[0].w, {0, 0, w1}, 1e-9L);
    expect_near(after[1].w, {0, 0, w2}, 1e-9L);
    // Energy: what the blow gives at the speed of its point, halfway from rest.
    const Number work = 4 * (w1 + w2) / 2;
    EXPECT_NEAR(static_cast<double>(sums_of(built.scene, built.at(1)).energy), static_cast<double>(work), 1e-13);
}

TEST(JointReference, loads_on_bodies_move_their_joints) {
    // About a hinge: drag slows by exp(-c t / I); a force of the body's frame turns evenly.
    const Number moment = moment_about(rod(1), 2) + 0.5L;
    Built slowed;
    slowed.add(rod(1), 2, {0, -0.5L, 0}, {}, {1, 0, 0}, {0, 0, 2});
    slowed.join(JointKind::hinge, 0, -1, {});
    slowed.scene.angular_drag = 0.25;
    slowed.scene.linear_drag = 0.5;  // at the centre, at 1/2 m
    expect_near(slowed.at(2)[0].w, {0, 0, 2 * std::exp(-(0.25L + 0.125L) * 2 / moment)});
    Built pushed;
    pushed.add(rod(1), 2, {0, -0.5L, 0});
    pushed.join(JointKind::hinge, 0, -1, {});
    ForceDescription force;
    force.until = 2;
    force.frame = Frame::body;
    force.force = {1, 5, 0};
    force.point = {0, -0.5, 0};
    force.torque = {3, 0, 0.5};
    pushed.scene.forces.push_back(force);
    expect_near(pushed.at(2)[0].w, {0, 0, 1.5L * 2 / moment});
    // A spring from the tip of a slider's body to the world.
    Built sprung;
    sprung.add({1, 1, 1}, 2, {1, 0, 0});
    sprung.join(JointKind::slider, 0, -1, {}, {1, 0, 0});
    SpringDescription spring;
    spring.point = {0, 0.5, 0};
    spring.to = {0, 0.5, 0};
    spring.stiffness = 8;
    sprung.scene.springs.push_back(spring);
    sprung.scene.gravity = {0, -10, 0};  // across
    expect_near(sprung.at(2)[0].x, {std::cos(Number(4)), 0, 0});
}

TEST(JointReference, fixed_body_carries_a_tree_as_the_world_does) {
    const Rotation turn = exponential<Number>({1, -0.5L, 0.25L});
    const auto end = [&](bool on_body, bool is_reversed) {
        Built built;
        built.scene.gravity = {0, -9, 1};
        const int swing = built.add({1, 0.5, 0.25}, 2, {3, 0, 0});
        const int base = built.add({1, 1, 1}, 1, {1, 1, 1}, turn);
        built.scene.bodies.back().fixed = true;
        const int to = on_body ? base : -1;
        const Vector axis{1, 2, 0}, to_axis{2, -1, 0}, anchor{2, 0.5L, 0};
        if (is_reversed) built.join(JointKind::universal, base, swing, anchor, to_axis, axis);
        else built.join(JointKind::universal, swing, to, anchor, axis, to_axis);
        return built.at(2)[0];
    };
    const Motion on_world = end(false, false);
    expect_near(end(true, false).x, on_world.x);
    expect_near(end(true, false).q, on_world.q);
    expect_near(end(true, true).x, on_world.x);
}

TEST(JointReference, order_of_joints_does_not_matter) {
    for (const unsigned seed : {1U, 2U}) {
        Built built = random_tree(seed, seed == 1);
        built.scene.gravity = {0, -9.5, 0};
        const std::vector<Motion> one = built.at(1);
        std::reverse(built.scene.joints.begin(), built.scene.joints.end());
        const std::vector<Motion> other = built.at(1);
        for (std::size_t i = 0; i < one.size(); ++i) {
            expect_near(other[i].x, one[i].x);
            expect_near(other[i].q, one[i].q);
        }
    }
}

// RATTLE is of order 2, so twice the steps leave a quarter of the error, and the extrapolation of both far less. With a
// method of order 4 it is a sixteenth.
TEST(JointReference, kernel_converges_to_trees_of_every_kind_of_joint) {
    for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
        Built built = random_tree(seed, seed % 2 == 1);
        SceneDescription& scene = built.scene;
        scene.duration = 0.5;
        scene.gravity = {1, -9.5, 2};
        scene.linear_drag = 0.125;
        ImpulseDescription blow;
        blow.time = 0.25;
        blow.body = 4;
        blow.impulse = {2, -1, 1};
        blow.point = {0.25, 0.25, -0.5};
        scene.impulses.push_back(blow);
        SpringDescription spring;
        spring.body = 2;
        spring.point = {0, 0.25, 0};
        spring.to = {1, 1, 1};
        spring.stiffness = 20;
        spring.damping = 0.5;
        spring.rest_length = 0.5;
        scene.springs.push_back(spring);
        const std::vector<Motion> truth = built.at(scene.duration);
        const auto run = [&](const char* method, std::int64_t steps_a_second) {
            SceneDescription with_step = scene;
            with_step.step = StepSize{1, steps_a_second};
            const auto simulation = make_simulation(with_step, method, "f64", false);
            while (simulation->steps_taken() < simulation->steps()) simulation->step();
            EXPECT_TRUE(simulation->troubles().empty());
            std::vector<Motion> end;
            for (int b = 0; b < simulation->body_count(); ++b) end.push_back(motion_of(simulation->body(b)));
            return end;
        };
        const struct {
            const char* name;
            int ratio, steps_a_second;
            double error, late;  // m; by what share the ratio is not that of the limit yet
        } methods[] = {
            {"verlet", 4, 1024, 1e-3, 0.025}, {"suzuki4", 16, 256, 1e-4, 0.125}, {"rk4", 16, 256, 1e-4, 0.125}};
        for (const auto& method : methods) {
            const std::vector<Motion> coarse = run(method.name, method.steps_a_second),
                                      fine = run(method.name, 2 * method.steps_a_second);
            Number error = 0, finer_error = 0, extrapolated = 0;
            for (std::size_t b = 0; b < truth.size(); ++b) {
                const Vector better = fine[b].x + (fine[b].x - coarse[b].x) * (1 / Number(method.ratio - 1));
                error = std::max(error, norm(coarse[b].x - truth[b].x));
                finer_error = std::max(finer_error, norm(fine[b].x - truth[b].x));
                extrapolated = std::max(extrapolated, norm(better - truth[b].x));
            }
            EXPECT_LT(static_cast<double>(error), method.error) << method.name << seed;
            EXPECT_NEAR(static_cast<double>(error / finer_error), method.ratio, method.late * method.ratio)
                << method.name << seed;
            EXPECT_LT(static_cast<double>(extrapolated / error), 0.01) << method.name << seed;
        }
    }
}

// I a'' = -k (a - rest) - c a' in closed form, where it swings: from a = 0 at the speed a'.
Number swung(Number inertia, const JointSpringDescription& spring, Number speed, Number t) {
    const Number decay = spring.damping / (2 * inertia), rate = std::sqrt(spring.stiffness / inertia - decay * decay),
                 rest = spring.rest;
    return rest +
           std::exp(-decay * t) * ((speed - decay * rest) / rate * std::sin(rate * t) - rest * std::cos(rate * t));
}

// A cube on its centre, so that it turns about one axis alone, on a base that lies askew. Reversed, the joint's `body`
// is the one that stays.
TEST(JointReference, spring_and_damper_of_a_joint_swing_in_closed_form) {
    constexpr double mass = 2.5, edge = 1.25, speed = 0.75, time = 1.75;
    const struct {
        JointKind kind;
        bool is_second;  // about to_axis
        JointSpringDescription spring;
    } cases[] = {
        {JointKind::hinge, false, {3, 0.25, 0.5}},     {JointKind::hinge, false, {1.5, 0, -1.25}},
        {JointKind::slider, false, {40, 3, 0.75}},     {JointKind::slider, false, {12, 0, -2}},
        {JointKind::ball, false, {2, 0.375, 0}},       {JointKind::ball, false, {5, 0, 0}},
        {JointKind::universal, false, {4, 0.5, -0.5}}, {JointKind::universal, true, {2.5, 0.125, 1}},
    };
    for (const auto& c : cases)
        for (const bool is_reversed : {false, true})
            for (const Frame3& frame : frames) {
                SCOPED_TRACE(static_cast<int>(c.kind));
                const Vector at = frame.point({1, 2, 3}), axis = frame.direction({0, 0.6L, 0.8L}),
                             to_axis = frame.direction({0, -0.8L, 0.6L}), about = c.is_second ? to_axis : axis;
                const bool slides = c.kind == JointKind::slider;
                const Number sign = is_reversed ? -1 : 1;
                Built built;
                const int base = built.add({1, 1, 1}, 1, {}, exponential(Vector{0.5L, -0.75L, 1.25L}));
                built.scene.bodies.back().fixed = true;
                const int body =
                    built.add({edge, edge, edge}, mass, at, frame.turn, slides ? about * (sign * speed) : Vector{},
                              slides ? Vector{} : about * (sign * speed));
                built.join(c.kind, is_reversed ? base : body, is_reversed ? body : base, at, axis, to_axis);
                (c.is_second ? built.scene.joints[0].to_spring : built.scene.joints[0].spring) = c.spring;
                const Motion got = built.at(time)[static_cast<std::size_t>(body)];
                const Number inertia = slides ? mass : mass * edge * edge / 6;
                const Vector moved = about * (sign * swung(inertia, c.spring, speed, time));
                constexpr Number rounded = 1e-13L;  // of axes in double precision
                expect_near(got.x, slides ? at + moved : at, rounded);
                expect_near(got.q, slides ? frame.turn : exponential(moved) * frame.turn, rounded);
            }
}

// Both axes of a universal joint at once, a ball that turns about a moving axis, and a slider between them.
TEST(JointReference, springs_of_joints_keep_momentum_and_lose_no_energy) {
    Built built;
    const int a = built.add({1, 0.5, 0.25}, 2, {}), b = built.add({0.5, 0.25, 1}, 1, {1, 0, 0}),
              c = built.add({0.25, 1, 0.5}, 3, {2, 0, 0}, {}, {0, 0.5, 0.25}),
              d = built.add({1, 1, 0.5}, 1.5, {2, 1, 0}, {}, {}, {1, 0, -1});
    built.join(JointKind::universal, b, a, {0.5L, 0, 0}, {0, 1, 0}, {0, 0, 1});
    built.join(JointKind::ball, b, c, {1.5L, 0, 0});
    built.join(JointKind::slider, c, d, {2, 0.5L, 0}, {0, 0.6L, 0.8L});
    auto& joints = built.scene.joints;
    joints[0].spring = {3, 0, 0.25};
    joints[0].to_spring = {2, 0, -0.5};
    joints[1].spring = {4, 0, 0};
    joints[2].spring = {30, 0, 0.125};
    const auto energy = [&](const std::vector<Motion>& now) {
        const Number sum = kinetic_energy_of(built.scene, now);
        const auto between = [&](int one, int other) {
            return now[static_cast<std::size_t>(other)].q.conjugate() * now[static_cast<std::size_t>(one)].q;
        };
        const auto stored = [](const JointSpringDescription& spring, Number at) {
            return spring.stiffness * (at - spring.rest) * (at - spring.rest) / 2;
        };
        // R = turn about z by t, then about the body's own y by s: its second column is (-sin t, cos t, 0), its third
        // row (-sin s, 0, cos s).
        const Rotation turned = between(b, a);
        const Vector y = turned.rotate({0, 1, 0}), z = turned.rotate_back({0, 0, 1});
        const Motion &of_c = now[static_cast<std::size_t>(c)], &of_d = now[static_cast<std::size_t>(d)];
        const Vector reach = of_c.x + of_c.q.rotate({0, 0.5L, 0}) - of_d.x - of_d.q.rotate({0, -0.5L, 0});
        return sum + stored(joints[0].spring, std::atan2(-z.x, z.z)) +
               stored(joints[0].to_spring, std::atan2(-y.x, y.y)) +
               stored(joints[1].spring, angle_between(between(b, c), Rotation{})) +
               stored(joints[2].spring, dot(reach, of_d.q.rotate({0, 0.6L, 0.8L})));
    };
    const auto momentum = [&](const std::vector<Motion>& now) {
        Vector sum;
        for (std::size_t i = 0; i < now.size(); ++i) sum = sum + now[i].v * *built.scene.bodies[i].mass;
        return sum;
    };
    // What the joints do not allow ends at the start.
    const auto start = built.at(1.0 / 64);
    for (const double time : {0.5, 1.25, 3.0}) {
        const auto now = built.at(time);
        EXPECT_NEAR(static_cast<double>(energy(now)), static_cast<double>(energy(start)), 1e-12) << time;
        expect_near(momentum(now), momentum(start), 1e-13L);
    }
}

// Its centre is on a sphere, and nothing turns it. The gravity makes the period 1 s.
TEST(JointReference, weight_that_hangs_on_a_rod_by_its_centre_is_a_simple_pendulum) {
    for (const Number amplitude : {0.25L, 2.5L})
        for (const Frame3& frame : frames) {
            SCOPED_TRACE(static_cast<double>(amplitude));
            const bool is_reversed = frame.is_mirrored;
            const Number length = 1.75L, rate = 2 * pi / arithmetic_geometric_mean(1, std::cos(amplitude / 2));
            Built built;
            built.scene.gravity = triple(frame.direction({0, -length * rate * rate, 0}));
            const Vector hook = frame.point({}), start = frame.point(hanging(length, amplitude));
            const int base = built.add({1, 1, 1}, 1, hook), body = built.add({0.5, 0.25, 1}, 3, start);
            built.scene.bodies[0].fixed = true;
            if (is_reversed) built.join_by_rod(base, body, hook, start);
            else built.join_by_rod(body, base, start, hook);
            const auto states = built.at({0.5, 0.71875, 1});
            const auto at = [&](std::size_t i) { return states[i][static_cast<std::size_t>(body)]; };
            expect_near(at(0).x, frame.point(hanging(length, -amplitude)), 1e-12L);
            EXPECT_NEAR(static_cast<double>(norm(at(1).x - hook)), static_cast<double>(length), 1e-14);
            expect_near(at(2).x, start, 1e-12L);
            expect_near(at(2).q, Rotation{});
        }
}

TEST(JointReference, two_bodies_on_a_rod_between_their_centres_go_round_their_common_centre) {
    for (const Frame3& frame : frames) {
        const Number length = 1.5L, spin = 2.25L, of_first = 0.75L;  // of 3 kg and 1 kg
        const Vector drift{0.5L, -0.25L, 1}, axis = unit(Vector{0.5L, 0.25L, 0}),
                                             across = unit(Vector{-0.25L, 0.5L, 1});
        const auto rod_at = [&](Number time) { return exponential(axis * (spin * time)).rotate(across * length); };
        const auto place = [&](bool second, Number time) {
            return frame.point(drift * time + rod_at(time) * (second ? of_first : of_first - 1));
        };
        const auto velocity = [&](bool second) {
            return frame.direction(drift + cross(axis * spin, rod_at(0)) * (second ? of_first : of_first - 1));
        };
        Built built;
        built.add({1, 0.5, 0.25}, 3, place(false, 0), {}, velocity(false));
        built.add({0.25, 0.5, 1}, 1, place(true, 0), {}, velocity(true));
        built.join_by_rod(0, 1, place(false, 0), place(true, 0));
        for (const double time : {0.5, 2.0}) {
            const auto now = built.at(time);
            for (const bool second : {false, true}) {
                expect_near(now[second].x, place(second, time));
                expect_near(now[second].q, Rotation{});
            }
        }
    }
}

TEST(JointReference, rods_keep_their_lengths_and_the_energy) {
    Built built;
    built.scene.gravity = {0, -9.81, 0};
    const int a = built.add({1, 0.5, 0.25}, 2, {0.5L, 0, 0}),
              b = built.add({0.5, 1, 0.75}, 1, {2, 0, 0.5L}, exponential<Number>({0.3L, 0.2L, -0.5L}), {0, 1, 2},
                            {1, -3, 2}),
              c = built.add({0.5, 0.25, 0.5}, 3, {2, -2, 0}, {}, {1, 0, 0}, {0, 4, 1});
    const struct {
        int body, other;
        Vector point, of_other;
    } rods[] = {{b, a, {1.75L, 0.25L, 0.5L}, {1, 0.25L, 0}}, {b, c, {2, -0.5L, 0.75L}, {1.75L, -2, 0.25L}}};
    built.join(JointKind::hinge, a, -1, {});
    for (const auto& rod : rods) built.join_by_rod(rod.body, rod.other, rod.point, rod.of_other);
    const auto place = [&](const std::vector<Motion>& now, int body, const Vector& point) {
        const auto& start = built.scene.bodies[static_cast<std::size_t>(body)];
        const Motion& of = now[static_cast<std::size_t>(body)];
        return of.x + of.q.rotate(rotation_of(start.orientation).rotate_back(point - vector_of(start.position)));
    };
    const auto energy = [&](const std::vector<Motion>& now) {
        Number sum = kinetic_energy_of(built.scene, now);
        for (std::size_t i = 0; i < now.size(); ++i) sum += *built.scene.bodies[i].mass * 9.81 * now[i].x.y;
        return sum;
    };
    // What the rods do not allow ends at the start.
    const auto states = built.at({1.0 / 64, 0.5, 1.5});
    for (const auto& now : states) {
        EXPECT_NEAR(static_cast<double>(energy(now)), static_cast<double>(energy(states[0])), 1e-12);
        for (const auto& rod : rods)
            EXPECT_NEAR(
                static_cast<double>(norm(place(now, rod.body, rod.point) - place(now, rod.other, rod.of_other))),
                static_cast<double>(norm(rod.point - rod.of_other)), 1e-13);
    }
    EXPECT_GT(norm(states.back()[static_cast<std::size_t>(b)].x - vector_of(built.scene.bodies[1].position)), 0.5L);
}

TEST(JointReference, ropes_limits_and_joints_that_may_break_have_no_equations) {
    for (int which = 0; which < 3; ++which) {
        Built built;
        built.add({1, 1, 1}, 1, {});
        built.join(which == 0 ? JointKind::distance : JointKind::hinge, 0, -1, {});
        JointDescription& joint = built.scene.joints[0];
        if (which < 2) joint.most = 1;
        else joint.break_torque = 5;
        EXPECT_EQ(without_equations(built.scene.joints), &joint);
        EXPECT_EQ(built.at(0).size(), 1u);
        EXPECT_THROW((void)built.at(1), std::invalid_argument);
    }
}

TEST(JointReference, bodies_without_a_common_layer_do_not_touch) {
    const auto touches = [](const SceneDescription& scene) {
        const SmoothMotion motion(scene, [](ShapeKind, ShapeKind) { return true; });
        EXPECT_EQ(motion.can_touch(), !motion.overlaps().empty());  // everything overlaps, where it can
        return motion.can_touch();
    };
    Built built;
    SceneDescription& scene = built.scene;
    scene.contact.response = ContactResponse::impulse;
    built.add({1, 1, 1}, 1, {});
    built.add({1, 1, 1}, 1, {});
    EXPECT_TRUE(touches(scene));
    built.join(JointKind::ball, 0, 1, {});  // jointed bodies are in no layer
    EXPECT_FALSE(touches(scene));
    scene.planes.push_back({"floor"});
    EXPECT_FALSE(touches(scene));
    scene.joints.clear();
    EXPECT_TRUE(touches(scene));
    scene.planes.clear();
    scene.bodies[0].layers = 1;
    scene.bodies[1].layers = 6;
    EXPECT_FALSE(touches(scene));
    scene.bodies[1].layers = 5;
    EXPECT_TRUE(touches(scene));
}

TEST(JointReference, loop_is_refused) {
    Built built;
    built.add({1, 1, 1}, 1, {});
    built.add({1, 1, 1}, 1, {1, 0, 0});
    built.join(JointKind::hinge, 0, -1, {});
    built.join(JointKind::hinge, 1, 0, {});
    built.join(JointKind::hinge, 1, -1, {});
    EXPECT_THROW((void)built.at(0), std::invalid_argument);
}

}  // namespace
}  // namespace tumble::host

// Every integrator against its textbook formula on position, velocity, quaternion and body rates: a few lines each, in
// long double, without code of the kernel. The comparison is with the method's own result, not with the true motion.
#include "references.hpp"
#include "tolerances.hpp"

#include <cmath>
#include <functional>
#include <map>

namespace tumble::test {
namespace {

using Load = std::function<reference::Wrench(const Motion&, Number)>;

struct Problem {
    reference::Body body;
    Load load;
    Number h;

    [[nodiscard]] Vector acceleration(const Motion& m) const { return load(m, 0).force_w * (1 / body.mass); }
    [[nodiscard]] Vector spin_rate(const Motion& m) const {
        return over(load(m, 0).torque_b - cross(m.w, times(body.moments, m.w)), body.moments);
    }
    // The derivative of a motion, as a motion.
    [[nodiscard]] Motion rate(const Motion& m) const {
        return {m.v, acceleration(m), m.q * Rotation{0, m.w * Number(0.5)}, spin_rate(m)};
    }
};
Motion plus(const Motion& m, Number h, const Motion& rate) {
    return {m.x + h * rate.x, m.v + h * rate.v, m.q + rate.q * h, m.w + h * rate.w};
}
// The kernel's renormalisation: one Newton step towards unit length, from the length before the step.
Motion finished(Motion end, const Motion& start) {
    end.q = end.q + start.q * ((1 - start.q.norm2()) / 2);
    return end;
}

// Euler's delta of an orientation, 1 + u with u half the angle, renormalised to its second order.
Rotation delta(Vector w, Number h) {
    const Vector u = w * (h / 2);
    return {-dot(u, u) / 2, u};
}

Motion explicit_euler(const Problem& p, const Motion& m) {
    Motion end = plus(m, p.h, p.rate(m));
    end.q = m.q + m.q * delta(m.w, p.h);
    return finished(end, m);
}

Motion semi_implicit_euler(const Problem& p, Motion m) {
    const Motion start = m;
    m.v = start.v + p.h * p.acceleration(start);
    m.w = start.w + p.h * p.spin_rate(start);
    m.x = start.x + p.h * m.v;
    m.q = start.q + start.q * delta(m.w, p.h);
    return finished(m, start);
}

Motion implicit_euler(const Problem& p, const Motion& start) {
    Motion end = start;
    for (int i = 0; i < 60; ++i) {
        const Vector v = start.v + p.h * p.acceleration(end), w = start.w + p.h * p.spin_rate(end);
        end = {start.x + p.h * v, v, start.q + start.q * delta(w, p.h), w};
    }
    return finished(end, start);
}

Motion midpoint(const Problem& p, const Motion& m) {
    return finished(plus(m, p.h, p.rate(plus(m, p.h / 2, p.rate(m)))), m);
}

Motion heun(const Problem& p, const Motion& m) {
    const Motion k1 = p.rate(m), k2 = p.rate(plus(m, p.h, k1));
    return finished(plus(plus(m, p.h / 2, k1), p.h / 2, k2), m);
}

// The classical method; the orientation turns by the exponential of the Magnus series of the stages' spins.
Motion rk4(const Problem& p, const Motion& m) {
    const Motion k1 = p.rate(m), m2 = plus(m, p.h / 2, k1), k2 = p.rate(m2), m3 = plus(m, p.h / 2, k2), k3 = p.rate(m3),
                 m4 = plus(m, p.h, k3), k4 = p.rate(m4);
    Motion end = plus(plus(plus(plus(m, p.h / 6, k1), p.h / 3, k2), p.h / 3, k3), p.h / 6, k4);
    const Vector angle = p.h / 6 * (m.w + 2 * m2.w + 2 * m3.w + m4.w) + p.h * p.h / 12 * cross(m.w, m4.w);
    end.q = m.q * exponential(angle);
    return finished(end, m);
}

// Half the impulse of the loads, a free flight with the rotation rotate(q, l, h), and the other half at its end, which
// may depend on the velocities there.
template <class Rotate>
Motion kick_drift_kick(const Problem& p, Motion m, const Rotate& rotate) {
    const Vector i = p.body.moments;
    Vector l = times(i, m.w) + (p.h / 2) * p.load(m, 0).torque_b;
    m.v = m.v + (p.h / 2) * p.acceleration(m);
    m.x = m.x + p.h * m.v;
    rotate(m.q, l, p.h);
    Motion end = m;
    end.w = over(l, i);
    for (int n = 0; n < 60; ++n) {
        const reference::Wrench wrench = p.load(end, 0);
        end.v = m.v + wrench.force_w * (p.h / 2 / p.body.mass);
        end.w = over(l + (p.h / 2) * wrench.torque_b, i);
    }
    return end;
}

// Rotates the body. l is constant in the world, so in the body's axes it rotates back.
void turn(Rotation& q, Vector& l, Vector angle) {
    q = q * exponential(angle);
    l = exponential(angle).rotate_back(l);
}

// Elementary flows about the body's axes; x has the largest moment and z the smallest.
Motion verlet(const Problem& p, Motion m) {
    const Vector i = p.body.moments;
    return kick_drift_kick(p, m, [&](Rotation& q, Vector& l, Number h) {
        turn(q, l, {h / 2 * (1 / i.x - 1 / i.y) * l.x, 0, 0});
        q = q * exponential(l * (h / i.y));
        turn(q, l, {0, 0, h * (1 / i.z - 1 / i.y) * l.z});
        turn(q, l, {h / 2 * (1 / i.x - 1 / i.y) * l.x, 0, 0});
    });
}

// The rotation of Euler's equations themselves. It is the limit of discrete Moser-Veselov, whose steps are off by a
// power of the angle; expect_agreement() allows for that.
Motion exact(const Problem& p, Motion m) {
    return kick_drift_kick(p, m, [&](Rotation& q, Vector& l, Number h) {
        const Motion end = reference::free_trajectory(p.body, {{}, {}, q, over(l, p.body.moments)}, {h}).back();
        q = end.q;
        l = times(p.body.moments, end.w);
    });
}

Motion implicit_midpoint(const Problem& p, const Motion& start) {
    Motion end = start;
    Vector u{};
    for (int i = 0; i < 80; ++i) {
        Motion middle{start.x, (start.v + end.v) * 0.5L, start.q, (start.w + end.w) * 0.5L};
        middle.x = start.x + (p.h / 2) * middle.v;
        u = middle.w * (p.h / 2);
        middle.q = start.q + start.q * delta(middle.w, p.h / 2);
        end.v = start.v + p.h * p.acceleration(middle);
        end.w = start.w + p.h * p.spin_rate(middle);
        end.x = start.x + (p.h / 2) * (start.v + end.v);
    }
    end.q = start.q * Rotation{1, u} * (1 / std::sqrt(1 + dot(u, u)));  // Cayley's map
    return end;
}

Motion strang(const Problem& p, Motion m) {
    return kick_drift_kick(p, m, [&](Rotation& q, Vector& l, Number h) {
        const auto turn_about = [&](int axis, Number time) {
            Vector angle{};
            angle[axis] = time * l[axis] / p.body.moments[axis];
            turn(q, l, angle);
        };
        turn_about(0, h / 2);
        turn_about(1, h / 2);
        turn_about(2, h);
        turn_about(1, h / 2);
        turn_about(0, h / 2);
    });
}

// Five of verlet's steps.
Motion suzuki4(const Problem& p, Motion m) {
    const Number g = 1 / (4 - std::cbrt(Number(4)));
    for (const Number part : {g, g, 1 - 4 * g, g, g}) m = verlet({p.body, p.load, part * p.h}, m);
    return m;
}

const std::map<std::string, Motion (*)(const Problem&, Motion)>& oracles() {
    static const std::map<std::string, Motion (*)(const Problem&, Motion)> all{
        {"explicit_euler", [](const Problem& p, Motion m) { return explicit_euler(p, m); }},
        {"semi_implicit_euler", semi_implicit_euler},
        {"implicit_euler", [](const Problem& p, Motion m) { return implicit_euler(p, m); }},
        {"midpoint", [](const Problem& p, Motion m) { return midpoint(p, m); }},
        {"heun", [](const Problem& p, Motion m) { return heun(p, m); }},
        {"rk4", [](const Problem& p, Motion m) { return rk4(p, m); }},
        {"implicit_midpoint", [](const Problem& p, Motion m) { return implicit_midpoint(p, m); }},
        {"verlet", verlet},
        {"strang", strang},
        {"suzuki4", suzuki4},
        {"exact", exact},
        {"pdmv4", exact},
        {"pdmv6", exact},
        {"pdmv8", exact},
        {"pdmv10", exact},
    };
    return all;
}

class Oracle : public testing::TestWithParam<Case> {
protected:
    static void expect_agreement(const SceneSetup& setup, const Bound& rounding) {
        const auto oracle = oracles().find(GetParam().method.name);
        ASSERT_NE(oracle, oracles().end()) << "no oracle of " << GetParam().method.name;
        const BodySpec& body = setup.bodies[0];
        const Problem problem{reference_body(body), reference_load(setup), number(setup.step.value)};
        const auto world = build(setup, GetParam());
        Motion expected = start_of(body);
        const Bound worst = rounding + steps * truncation(setup);
        Number greatest = 0;
        for (int step = 0; step < steps; ++step) {
            world->step();
            expected = oracle->second(problem, expected);
            const Motion got = world->motion(0);
            greatest = std::max(greatest, distance(got, expected));
            ASSERT_LE(distance(got, expected), worst) << "step " << step;
            // Compares lengths too, because the renormalisation is part of the method.
            ASSERT_LE(std::abs(got.q.norm2() - expected.q.norm2()), worst) << "step " << step;
        }
        ASSERT_TRUE(world->status().ok());
        RecordProperty("greatest_difference", std::to_string(greatest * 1e12L) + "e-12");
    }
    // The error of a step, rad, if the oracle is the motion that the method approximates: a rotation of order n is off
    // by the angle of the step to the power n + 1.
    static Bound truncation(const SceneSetup& setup) {
        const Method& method = GetParam().method;
        if (oracles().at(method.name) != exact) return {};
        const Number angle = norm(vector(setup.bodies[0].angular_velocity)) * number(setup.step.value);
        return tolerance::truncation_error(method.free_order, angle);
    }
    static constexpr int steps = 300;
    // Moments sorted downwards, so that the body's axes are the principal axes.
    static SceneSetup sorted_top(Real mass, Vector position, Vector velocity) {
        return {.name = "top", .bodies = {top({3, 2, 1}, {0.5, 2, -0.25}, mass, position, velocity)}};
    }
};
INSTANTIATE_TEST_SUITE_P(every, Oracle, testing::ValuesIn(every_case()), NameOf{});

TEST_P(Oracle, a_free_top_moves_as_the_textbook_formula_says) {
    expect_agreement(sorted_top(1, {}, {}), tolerance::oracle.of(GetParam().system));
}

TEST_P(Oracle, a_free_top_in_gravity_moves_as_the_textbook_formula_says) {
    SceneSetup setup = sorted_top(1, {}, {1, 2, 3});
    setup.world.gravity = {0.5, -10, 0.25};
    setup.step = Seconds{Real{0.005}};
    expect_agreement(setup, tolerance::oracle.of(GetParam().system));
}

TEST_P(Oracle, a_body_on_a_spring_moves_as_the_textbook_formula_says) {
    SceneSetup setup = sorted_top(2, {0.5, -0.25, 0}, {0.25, 1, -0.5});
    setup.world.gravity = {0, -1, 0};
    setup.springs = {{.point = {0.5, 0.25, -0.5}, .to = {0, 1, 0.5}, .stiffness = 8, .rest_length = 0.25}};
    expect_agreement(setup, tolerance::oracle.of(GetParam().system));
}

TEST_P(Oracle, a_body_with_damping_and_drag_moves_as_the_textbook_formula_says) {
    SceneSetup setup = sorted_top(2, {0.5, -0.25, 0}, {});
    setup.world.linear_drag = 0.5;
    setup.world.angular_drag = 0.25;
    setup.springs = {
        {.point = {0.5, 0.25, -0.5}, .to = {0, 1, 0.5}, .stiffness = 8, .damping = 0.5, .rest_length = 0.25}};
    expect_agreement(setup, tolerance::oracle.of(GetParam().system));
}

}  // namespace
}  // namespace tumble::test

// Gravity that turns by events, as when a tray is tilted: boxes stay where friction holds them, and slide as Coulomb's
// law says where it does not; balls roll.
#include "kinds.hpp"

#include <cmath>
#include <sstream>

namespace tumble::test::tilts {
namespace {

using host::EventDescription;

// A tray in the plane y = 0, which is tilted, and then placed anywhere as a whole.
class Tray {
public:
    Tray(Draw& draw, Case& drawn) : draw_{draw}, case_{drawn}, size_{draw.magnitude(1.0, 16.0)} {
        drawn.scene.gravity = {0, -size_, 0};
        auto& floor = drawn.scene.planes.emplace_back();
        floor.name = "floor";
        floor.normal = {0, 1, 0};
    }
    // From this step on, a slope along a direction of the floor.
    void tilt(std::int64_t step, double slope, double angle) {
        const double down = size_ / std::sqrt(1 + slope * slope);
        EventDescription event;
        event.kind = EventKind::gravity;
        event.time = static_cast<double>(step) * case_.step;
        event.value = {down * slope * std::cos(angle), -down, down * slope * std::sin(angle)};
        case_.scene.events.push_back(event);
    }
    // Call when the scene is complete, which lasts so many steps.
    void end(std::int64_t steps) {
        case_.scene.duration = static_cast<double>(steps) * case_.step;
        placement_ = place_anywhere(draw_, case_.scene);
    }
    // A vector of the scene that runs, as it is in the scene that was made.
    [[nodiscard]] Triple back(const Triple& v) const { return placement_.back(v); }
    [[nodiscard]] double gravity() const { return size_; }

private:
    Draw& draw_;
    Case& case_;
    double size_;  // m/s^2
    Placement placement_;
};

Triple between(const Triple& from, const Triple& to) { return {to[0] - from[0], to[1] - from[1], to[2] - from[2]}; }

std::string differs(const char* what, int body, const Triple& is, const Triple& right, double limit) {
    if (distance(is, right) <= limit) return {};
    std::ostringstream text;
    text << what << " of body " << body << " is " << is[0] << ", " << is[1] << ", " << is[2] << " instead of "
         << right[0] << ", " << right[1] << ", " << right[2] << ", which is more than " << limit << " from it";
    return text.str();
}

// A program that sets the same gravity at the same steps.
std::string differs_live(const Case& drawn, std::int64_t steps, std::uint64_t hash) {
    Case live = drawn;
    live.scene.events.clear();
    const auto simulation = start(live);
    for (std::int64_t step = 0; step < steps; ++step) {
        for (const EventDescription& event : drawn.scene.events)
            if (std::llround(event.time / drawn.step) == step) simulation->apply(event);
        simulation->step();
    }
    return simulation->hash() == hash ? "" : "events of a live run lead to another state than those of the scene";
}

}  // namespace

// Flat boxes, alone or two on each other, of which none tips before it slides.
std::string boxes(Draw& draw, Case& drawn) {
    Tray tray(draw, drawn);
    auto& scene = drawn.scene;
    const double mu = draw.uniform(0.1, 0.8);
    scene.contact.friction = 1;
    scene.planes[0].friction = mu * mu;  // and 1 of the boxes: mu
    const int count = draw.between(1, 3);
    for (int i = 0; i < count; ++i) {
        const double edge = draw.magnitude(0.125, 1), height = edge * draw.uniform(0.1, 0.3);
        const double mass = draw.magnitude(0.1, 10);
        add_box(scene, mass, {edge, height, edge}, {4.0 * i, height / 2, 0});
        // Under a box of 40 times their mass and more, sweeps leave a hundredth of the speed of what slides.
        if (draw.one_in(3))
            add_box(scene, mass * draw.magnitude(0.1, 10), {edge, height, edge}, {4.0 * i, 1.5 * height, 0});
    }
    // Friction holds the boxes for a while, and then it does not.
    std::int64_t step = draw.between(0, 4);
    for (int k = draw.between(1, 12); k > 0; --k, step += draw.between(1, 6))
        tray.tilt(step, mu * draw.uniform(0, 0.95), draw.uniform(0, 6.28));
    const double slope = mu * draw.uniform(1.05, 2), angle = draw.uniform(0, 6.28);
    const std::int64_t begin = step, end = begin + draw.between(10, 40);
    tray.tilt(begin, slope, angle);
    tray.end(end);

    const auto simulation = start(drawn);
    std::vector<Triple> from;
    for (int b = 0; b < simulation->body_count(); ++b) from.push_back(position_of(*simulation, b));
    for (step = 0; step < begin; ++step) {
        simulation->step();
        for (int b = 0; b < simulation->body_count(); ++b)
            if (const auto what =
                    differs("the position", b, position_of(*simulation, b), from[static_cast<std::size_t>(b)], 0);
                !what.empty())
                return what + " at step " + std::to_string(step) + ", though friction holds it";
    }
    for (; step < end; ++step) simulation->step();
    const double size = tray.gravity() * (slope - mu) / std::sqrt(1 + slope * slope),
                 t = static_cast<double>(end - begin) * drawn.step;
    const Triple along{std::cos(angle), 0, std::sin(angle)};
    const auto times = [&](double x) { return Triple{x * along[0], 0, x * along[2]}; };
    // Float has 24 bits of positions of some metres, and forces of a step act at its ends in methods of order 1.
    for (int b = 0; b < simulation->body_count(); ++b) {
        auto what = differs("the velocity", b, tray.back(velocity_of(*simulation, b)), times(size * t),
                            1e-4 * tray.gravity() * t);
        if (what.empty())
            what = differs("the way", b,
                           tray.back(between(from[static_cast<std::size_t>(b)], position_of(*simulation, b))),
                           times(size * t * t / 2), 1e-4 * tray.gravity() * t * t + size * t * drawn.step + 4e-6);
        if (!what.empty()) return what;
    }
    return differs_live(drawn, end, simulation->hash());
}

std::string balls(Draw& draw, Case& drawn) {
    Tray tray(draw, drawn);
    auto& scene = drawn.scene;
    scene.contact.friction = draw.uniform(0.5, 1);
    const int count = draw.between(1, 4);
    // Slow ones, whose spin the range holds.
    for (int i = 0; i < count; ++i) {
        const double radius = draw.magnitude(0.125, 0.5);
        add_sphere(scene, draw.magnitude(0.1, 10), radius, {4.0 * i, radius, 0});
    }
    // Friction of a ball that rolls is 2/7 of the slope's part of its weight: it grips up to slopes of 7/2 mu.
    Triple velocity{}, way{};
    std::int64_t step = draw.between(0, 4);
    for (int k = draw.between(1, 6); k > 0; --k) {
        const double slope = draw.uniform(0, 0.5), angle = draw.uniform(0, 6.28);
        const int steps = draw.between(1, 10);
        tray.tilt(step, slope, angle);
        const double a = tray.gravity() * slope / std::sqrt(1 + slope * slope) * 5 / 7, t = steps * drawn.step;
        const Triple change{a * t * std::cos(angle), 0, a * t * std::sin(angle)};
        for (std::size_t i = 0; i < 3; ++i) {
            way[i] += velocity[i] * t + change[i] * t / 2;
            velocity[i] += change[i];
        }
        step += steps;
    }
    tray.end(step);
    const auto simulation = start(drawn);
    std::vector<Triple> from;
    for (int b = 0; b < simulation->body_count(); ++b) from.push_back(position_of(*simulation, b));
    for (std::int64_t i = 0; i < step; ++i) simulation->step();
    const double t = static_cast<double>(step) * drawn.step;
    // Float has 24 bits of positions up to 16 m, and a step takes up what is left of a gap.
    const double rounding = drawn.numbers == "f32" ? 0x1p-20 / drawn.step : 0;
    for (int b = 0; b < simulation->body_count(); ++b) {
        auto what = differs("the velocity", b, tray.back(velocity_of(*simulation, b)), velocity,
                            1e-4 * tray.gravity() * t + rounding);
        if (what.empty())
            what = differs("the way", b,
                           tray.back(between(from[static_cast<std::size_t>(b)], position_of(*simulation, b))), way,
                           1e-4 * tray.gravity() * t * t + tray.gravity() * t * drawn.step / 2 + 4e-6);
        if (!what.empty()) return what;
    }
    return differs_live(drawn, step, simulation->hash());
}

}  // namespace tumble::test::tilts

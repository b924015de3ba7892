#include "verdict/energy_rounding.hpp"

#include <algorithm>
#include <cmath>

#include "scene/data.hpp"
#include "simulation/long_double.hpp"
#include "verdict/accuracy.hpp"

namespace tumble::host {
namespace {

// m, of places in fixed point.
long double spacing_of(const Simulation& simulation) {
    return simulation.range().empty() ? 0 : held_by(simulation.range()).position * 0x1p-30L;
}

}  // namespace

EnergyRounding::EnergyRounding(const SceneDescription& scene) : scene_(scene) {
    for (const BodySpec& body : build_scene(scene).bodies) mass_.push_back(body.is_fixed() ? 0 : number(body.mass));
}

long double EnergyRounding::of(const Simulation& simulation) const {
    const long double held = spacing_of(simulation), unit = simulation.numbers() == "f32"   ? 0x1p-23L
                                                            : simulation.numbers() == "f64" ? 0x1p-52L
                                                                                            : 0;
    std::vector<reference::Motion> now;
    for (int b = 0; b < simulation.body_count(); ++b) now.push_back(motion_of(simulation.body(b)));
    const auto at = [&](int b) -> const reference::Motion& { return now[static_cast<std::size_t>(b)]; };
    long double sum = 0, weight = 0;
    const auto add = [&](long double force, long double place) { sum += force * (unit * place + held); };
    for (std::size_t b = 0; b < now.size(); ++b) {
        const long double own = mass_[b] * scene_.most_gravity();
        weight += own;
        add(own, norm(now[b].x));
    }
    for (const SpringDescription& spring : scene_.springs) {
        const auto end = [&](int b, const Triple& p) {
            return at(b).x + at(b).q.normalized().rotate(reference::vector_of(p));
        };
        const reference::Vector one = end(spring.body, spring.point), other = spring.to_body < 0
                                                                                  ? reference::vector_of(spring.to)
                                                                                  : end(spring.to_body, spring.to);
        // An end is placed by a centre of mass and an arm, and the stretch is what is left of the distance.
        const long double places = norm(one) + norm(other) + norm(one - at(spring.body).x) + spring.rest_length;
        add(spring.stiffness * std::abs(norm(one - other) - spring.rest_length), places);
    }
    // Contact springs hold about the weight of all bodies, at their distance from the origin. Where surfaces just
    // touch, the rounding of two bodies makes them overlap by up to two spacings s, which stores k (2 s)^2 / 2 at up to
    // four points of each pair.
    if (scene_.contact.response == ContactResponse::spring) {
        const auto pairs = static_cast<long double>(scene_.planes.size() + now.size() - 1);
        for (const reference::Motion& body : now) {
            const long double spacing = unit * norm(body.x) + held;
            sum += weight * spacing + 4 * pairs * 2 * scene_.contact.stiffness * spacing * spacing;
        }
    }
    return sum + of_joints(simulation, weight);
}

// Bodies that hang on a joint are lower by its gap. Where the joint leans by an angle, they are lower by that angle
// times their arm.
long double EnergyRounding::of_joints(const Simulation& simulation, long double weight) const {
    // Of a gap in m at a size of 1 m, and of a lean in rad: the bound of each component in the kernel, times sqrt(3).
    const long double open = simulation.numbers() == "f32" ? 6e-7L : simulation.numbers() == "f64" ? 2e-12L : 5e-9L;
    long double sum = 0;
    for (const JointDescription& joint : scene_.joints) {
        long double size = 1;  // m: the largest place or arm; in fixed point places do not count
        for (const int side : {joint.body, joint.to_body}) {
            const reference::Vector anchor = reference::vector_of(joint.anchor_on(side));
            if (side < 0) {
                if (simulation.range().empty()) size = std::max(size, norm(anchor));
                continue;
            }
            size = std::max(size, norm(anchor - reference::vector_of(scene_.body(side).position)));
            if (simulation.range().empty()) size = std::max(size, norm(motion_of(simulation.body(side)).x));
        }
        sum += 2 * weight * open * size;
    }
    return sum;
}

}  // namespace tumble::host

#include "verdict/shared_rules.hpp"

#include <algorithm>
#include <cmath>

#include "scene/data.hpp"
#include "truth/smooth_motion.hpp"
#include "verdict/accuracy.hpp"

namespace tumble::host {
namespace {

using reference::Motion;
using reference::Number;
using reference::Vector;

// The cosine of the largest angle between directions that count as one, 0.045 rad.
constexpr Number aligned = 0.999L;

Vector half_edges(const BodyDescription& box) { return reference::vector_of(box.shape.size) * Number{0.5}; }

// The axis of a box, 0 to 2, that is nearest to a direction in its frame.
int axis_of(const Vector& v) {
    int axis = 0;
    for (const int other : {1, 2})
        if (std::abs(v[other]) > std::abs(v[axis])) axis = other;
    return axis;
}

double mixed(Mixing mixing, double a, double b) {
    switch (mixing) {
    case Mixing::larger: return std::max(a, b);
    case Mixing::mean: return (a + b) / 2;
    default: return std::min(a, b);  // 0 where the others are
    }
}

}  // namespace

const char* name_of(SharedRule rule) {
    switch (rule) {
    case SharedRule::overlap: return "overlap";
    case SharedRule::seams: return "seams";
    case SharedRule::edges: return "edges";
    case SharedRule::friction: return "friction";
    case SharedRule::sleep: return "sleep";
    default: return "joints";
    }
}

RuleWatch::RuleWatch(const SceneDescription& scene) : scene_(scene) {
    if (scene.contact.response != ContactResponse::impulse) return;
    for (const SmoothMotion::Overlap& overlap : SmoothMotion(scene, shapes_meet).overlaps())
        if (overlap.depth > scene.contact.tolerance) rules_.insert(SharedRule::overlap);
}

std::vector<SharedRule> RuleWatch::rules() const { return {rules_.begin(), rules_.end()}; }

void RuleWatch::see(const Simulation& simulation) {
    if (scene_.contact.response != ContactResponse::impulse) return;
    States now;
    for (int b = 0; b < simulation.body_count(); ++b) {
        const BodySnapshot body = simulation.body(b);
        if (body.asleep) rules_.insert(SharedRule::sleep);
        now.push_back(motion_of(body));
    }
    std::vector<Touch> touches;
    for (const ContactSnapshot& contact : simulation.contacts()) {
        if (!contact.touches) continue;
        if (is_rough(contact)) rules_.insert(SharedRule::friction);
        if (contact.other < 0) continue;
        const Vector normal = reference::vector_of(contact.normal);
        if (is_box(contact.other)) touches.push_back({contact.body, contact.other, normal});
        if (is_box(contact.body)) touches.push_back({contact.other, contact.body, -normal});
    }
    const auto is_of = [](const Touch& one) {
        return [&one](const Touch& other) { return one.body == other.body && one.box == other.box; };
    };
    const auto goes_on = [&](const Touch& before) {  // on this box, or on one beside it
        return std::any_of(touches.begin(), touches.end(), [&](const Touch& touch) {
            return touch.body == before.body && dot(touch.normal, before.normal) > aligned;
        });
    };
    for (const Touch& touch : now_)
        if (!goes_on(touch) && has_left_over_an_edge(touch, now)) rules_.insert(SharedRule::edges);
    for (const Touch& touch : touches) {
        if (std::any_of(ever_.begin(), ever_.end(), is_of(touch))) continue;
        for (const Touch& other : ever_)
            if (other.body == touch.body && are_flush(touch, other, now)) rules_.insert(SharedRule::seams);
        ever_.push_back(touch);
    }
    now_ = std::move(touches);
}

bool RuleWatch::is_box(int body) const { return scene_.body(body).shape.kind == ShapeKind::box; }

bool RuleWatch::is_rough(const ContactSnapshot& contact) const {
    const double one = scene_.body(contact.body).friction.value_or(scene_.contact.friction),
                 other = (contact.other < 0 ? scene_.planes[static_cast<std::size_t>(contact.plane)].friction
                                            : scene_.body(contact.other).friction)
                             .value_or(scene_.contact.friction);
    return mixed(scene_.contact.friction_mixing, one, other) > 0;
}

// Its centre is no longer over the face that it touched.
bool RuleWatch::has_left_over_an_edge(const Touch& touch, const States& now) const {
    const Motion &box = now[static_cast<std::size_t>(touch.box)], &body = now[static_cast<std::size_t>(touch.body)];
    const Vector place = box.q.rotate_back(body.x - box.x), half = half_edges(scene_.body(touch.box));
    const int normal = axis_of(box.q.rotate_back(touch.normal));
    for (int axis = 0; axis < 3; ++axis)
        if (axis != normal && std::abs(place[axis]) > half[axis]) return true;
    return false;
}

// The faces that the body touches lie in one plane, and the boxes meet there.
bool RuleWatch::are_flush(const Touch& one, const Touch& other, const States& now) const {
    if (dot(one.normal, other.normal) < aligned) return false;
    const Motion &box = now[static_cast<std::size_t>(one.box)], &next = now[static_cast<std::size_t>(other.box)];
    const Vector half = half_edges(scene_.body(one.box)), half_of_next = half_edges(scene_.body(other.box));
    Vector reach;  // of the other box along the axes of this one
    for (int axis = 0; axis < 3; ++axis) {
        Vector unit;
        unit[axis] = 1;
        const Vector turned = box.q.rotate_back(next.q.rotate(unit));
        const int along = axis_of(turned);
        if (std::abs(turned[along]) < aligned) return false;
        reach[along] += half_of_next[axis];
    }
    const Vector place = box.q.rotate_back(next.x - box.x), normal = box.q.rotate_back(one.normal);
    const int up = axis_of(normal);
    const Number tolerance = scene_.contact.tolerance, side = normal[up] < 0 ? -1 : 1;
    for (int axis = 0; axis < 3; ++axis) {
        const Number gap = axis == up ? std::abs(side * place[axis] + reach[axis] - half[axis])
                                      : std::abs(place[axis]) - reach[axis] - half[axis];
        if (gap > tolerance) return false;
    }
    return true;
}

}  // namespace tumble::host

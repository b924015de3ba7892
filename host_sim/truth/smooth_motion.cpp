#include "truth/smooth_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tools/raise.hpp"
#include "truth/trajectory.hpp"

namespace tumble::host {
namespace {

using namespace tumble::reference;

constexpr Number pi = std::numbers::pi_v<Number>;

Number volume_of(const ShapeDescription& shape) {
    const Number a = shape.size[0], b = shape.size[1], c = shape.size[2];
    switch (shape.kind) {
    case ShapeKind::sphere: return 4 * pi * a * a * a / 3;
    case ShapeKind::box: return a * b * c;
    case ShapeKind::cylinder: return pi * a * a * b;
    case ShapeKind::capsule: return pi * a * a * b + 4 * pi * a * a * a / 3;
    default: return 0;
    }
}

Number mass_of(const BodyDescription& body) {
    if (body.shape.kind == ShapeKind::points) {
        Number sum = 0;
        for (const PointDescription& point : body.shape.points) sum += point.mass;
        return sum;
    }
    return body.mass ? Number(*body.mass) : Number(body.density.value()) * volume_of(body.shape);
}

// Principal moments of a solid of uniform density about its centre of mass. A hoop's mass lies on its rim.
Vector moments_of(const ShapeDescription& shape, Number mass) {
    const Number a = shape.size[0], b = shape.size[1], c = shape.size[2];
    switch (shape.kind) {
    case ShapeKind::sphere: {
        const Number moment = 2 * mass * a * a / 5;
        return {moment, moment, moment};
    }
    case ShapeKind::box: return Vector{b * b + c * c, a * a + c * c, a * a + b * b} * (mass / 12);
    case ShapeKind::cylinder: {
        const Number across = mass * (3 * a * a + b * b) / 12;
        return {across, across, mass * a * a / 2};
    }
    case ShapeKind::hoop: return {mass * a * a / 2, mass * a * a / 2, mass * a * a};
    case ShapeKind::capsule: {
        // A cylinder and two half balls. Their centres of mass lie 3/8 of the radius outside the cylinder's ends.
        const Number balls = mass * (4 * a / 3) / (b + 4 * a / 3), middle = mass - balls;
        const Number across = middle * (3 * a * a + b * b) / 12 + balls * (2 * a * a / 5 + b * b / 4 + 3 * a * b / 8);
        return {across, across, middle * a * a / 2 + 2 * balls * a * a / 5};
    }
    default: return {};
    }
}

// Along a unit vector in the user's axes.
Number half_extent_of(ShapeKind kind, const Vector& size, const Vector& n) {
    const Number across = std::sqrt(std::max(Number(0), 1 - n.z * n.z));
    switch (kind) {
    case ShapeKind::sphere: return size.x;
    case ShapeKind::box: return (std::abs(n.x) * size.x + std::abs(n.y) * size.y + std::abs(n.z) * size.z) / 2;
    case ShapeKind::cylinder: return size.x * across + std::abs(n.z) * size.y / 2;
    case ShapeKind::hoop: return size.x * across;
    case ShapeKind::capsule: return size.x + std::abs(n.z) * size.y / 2;
    default: return 0;
    }
}

}  // namespace

SmoothMotion::Tensor SmoothMotion::tensor_of(const BodyDescription& body, Number mass) {
    if (body.inertia) {
        const auto& i = *body.inertia;
        return {{i[0], i[3], i[4]}, {i[3], i[1], i[5]}, {i[4], i[5], i[2]}};
    }
    if (body.shape.kind != ShapeKind::points) {
        const Vector m = moments_of(body.shape, mass);
        return {{m.x, 0, 0}, {0, m.y, 0}, {0, 0, m.z}};
    }
    Vector centre;
    for (const PointDescription& point : body.shape.points)
        centre = centre + vector_of(point.position) * (point.mass / mass);
    Tensor sum;
    for (const PointDescription& point : body.shape.points) {
        const Vector r = vector_of(point.position) - centre;
        const Number r2 = dot(r, r);
        sum.x = sum.x + (Vector{r2, 0, 0} - r * r.x) * point.mass;
        sum.y = sum.y + (Vector{0, r2, 0} - r * r.y) * point.mass;
        sum.z = sum.z + (Vector{0, 0, r2} - r * r.z) * point.mass;
    }
    return sum;
}

SmoothMotion::Body SmoothMotion::body_of(const BodyDescription& description) {
    Body body;
    body.mass = mass_of(description);
    body.inertia = tensor_of(description, body.mass);
    if (!description.is_point_mass()) body.inverse = body.inertia.inverse();
    body.fixed = description.fixed;
    body.moves_by_itself = body.fixed && (norm(vector_of(description.angular_velocity)) > 0 ||
                                          (description.kinematic && norm(vector_of(description.velocity)) > 0));
    body.kind = description.shape.kind;
    body.size = vector_of(description.shape.size);
    return body;
}

SmoothMotion::SmoothMotion(const SceneDescription& scene, ShapesMeet shapes_meet, const Effort& effort)
    : scene_{scene}, shapes_meet_{shapes_meet}, step_length_{long_seconds(scene.step)}, effort_{effort} {
    for (const BodyDescription& description : scene.bodies) {
        bodies_.push_back(body_of(description));
        Motion start{vector_of(description.position), {}, rotation_of(description.orientation).normalized(), {}};
        if (!description.fixed || description.kinematic) start.v = vector_of(description.velocity);
        start.w = vector_of(description.angular_velocity);
        now_.push_back(start);
    }
    std::vector<JointTrees::Body> jointed;
    for (const Body& body : bodies_) jointed.push_back({body.mass, body.inertia, body.fixed});
    trees_ = JointTrees(std::move(jointed), scene.joints, now_);
    joints_ = trees_.start();
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        bodies_[i].is_jointed = trees_.has(i);
        bodies_[i].layers = scene.layers_of(static_cast<int>(i));
    }
    if (scene.contact.response != ContactResponse::none) {
        if (std::any_of(bodies_.begin(), bodies_.end(), [](const Body& body) { return body.touches_planes(); })) {
            for (const PlaneDescription& plane : scene.planes) {
                const Vector normal = vector_of(plane.normal);
                planes_.push_back({unit(normal), plane.offset});
            }
        }
        for (std::size_t i = 0; i < bodies_.size(); ++i)
            for (std::size_t j = 0; j < i; ++j) has_pairs_ = has_pairs_ || may_touch(i, j);
    }
    for (const ImpulseDescription& impulse : scene.impulses)
        kicks_.push_back({nearest_step(impulse.time, scene.step), impulse});
    std::stable_sort(kicks_.begin(), kicks_.end(), [](const Kick& a, const Kick& b) { return a.step < b.step; });
    gravity_ = vector_of(scene.gravity);
    for (const EventDescription& event : scene.events)
        if (event.kind == EventKind::gravity)
            gravities_.push_back({nearest_step(event.time, scene.step), vector_of(event.value)});
    std::stable_sort(gravities_.begin(), gravities_.end(),
                     [](const NewGravity& a, const NewGravity& b) { return a.step < b.step; });
    for (const ForceDescription& force : scene.forces)
        forces_.push_back({nearest_step(force.from, scene.step), nearest_step(force.until, scene.step), force});
    for_each_time(scene, [&](double time) { breaks_.push_back(nearest_step(time, scene.step)); });
    std::sort(breaks_.begin(), breaks_.end());
}

void SmoothMotion::advance_to(std::int64_t step) {
    while (step_ < step) {
        for (; next_kick_ < kicks_.size() && kicks_[next_kick_].step <= step_; ++next_kick_)
            kick(kicks_[next_kick_].impulse);
        for (; next_gravity_ < gravities_.size() && gravities_[next_gravity_].step <= step_; ++next_gravity_)
            gravity_ = gravities_[next_gravity_].gravity;
        const auto next = std::upper_bound(breaks_.begin(), breaks_.end(), step_);
        const std::int64_t until = next == breaks_.end() ? step : std::min(step, *next);
        flow(step_, until);
        step_ = until;
    }
}

void SmoothMotion::kick(const ImpulseDescription& impulse) {
    const auto index = static_cast<std::size_t>(impulse.body);
    const Body& body = bodies_[index];
    if (body.fixed) return;
    Motion& now = now_[index];
    const bool in_body = impulse.frame == Frame::body;
    const Vector j = vector_of(impulse.impulse), l = vector_of(impulse.angular_impulse);
    const Vector j_b = in_body ? j : now.q.rotate_back(j), l_b = in_body ? l : now.q.rotate_back(l);
    now.v = now.v + (in_body ? now.q.rotate(j) : j) * (1 / body.mass);
    now.w = now.w + body.inverse * (cross(vector_of(impulse.point), j_b) + l_b);
}

void SmoothMotion::add_spring(const SpringDescription& spring, const std::vector<Motion>& motions,
                              Wrenches& sums) const {
    const auto one = static_cast<std::size_t>(spring.body);
    const Motion& a = motions[one];
    const Motion* b = spring.to_body < 0 ? nullptr : &motions[static_cast<std::size_t>(spring.to_body)];
    const Vector point = vector_of(spring.point), to = vector_of(spring.to);
    const auto place = [](const Motion& m, const Vector& r) { return m.x + m.q.rotate(r); };
    const auto velocity = [](const Motion& m, const Vector& r) { return m.v + m.q.rotate(cross(m.w, r)); };
    const Vector reach = (b == nullptr ? to : place(*b, to)) - place(a, point);
    const Number length = norm(reach), stiffness = spring.stiffness;
    Vector force = reach * stiffness;
    if (spring.rest_length > 0 || spring.damping > 0) {
        if (!(length > 0)) return;  // no direction: no force
        const Vector along = reach * (1 / length);
        const Vector rate = (b == nullptr ? Vector{} : velocity(*b, to)) - velocity(a, point);
        force = along * (stiffness * (length - spring.rest_length) + spring.damping * dot(rate, along));
    }
    const auto push = [&](std::size_t index, const Vector& f_w, const Vector& r) {
        sums[index].force_w = sums[index].force_w + f_w;
        sums[index].torque_b = sums[index].torque_b + cross(r, motions[index].q.rotate_back(f_w));
    };
    push(one, force, point);
    if (b != nullptr) push(static_cast<std::size_t>(spring.to_body), -force, to);
}

// Drag -(a + b |u|) u of a body with the velocity u through the air; the torque h x w of stored angular momentum h; and
// the gravity gradient 3 w0^2 r x J r, with r the unit vector to the centre.
void SmoothMotion::add_air_wheels_and_gradient(const std::vector<Motion>& motions, Wrenches& sums) const {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const BodyDescription& body = scene_.bodies[i];
        const Vector u = motions[i].v - vector_of(scene_.wind);
        sums[i].force_w = sums[i].force_w - u * (body.linear_drag + body.quadratic_drag * norm(u));
        Vector torque = cross(vector_of(body.wheel_momentum), motions[i].w);
        if (scene_.gravity_gradient) {
            const Vector to_centre = vector_of(scene_.gravity_gradient->to_centre);
            const Vector r = motions[i].q.rotate_back(unit(to_centre));
            const Number rate = scene_.gravity_gradient->orbit_rate;
            torque = torque + cross(r, bodies_[i].inertia * r) * (3 * rate * rate);
        }
        sums[i].torque_b = sums[i].torque_b + torque;
    }
}

void SmoothMotion::add_loads(const std::vector<Motion>& motions, std::int64_t step, Wrenches& sums) const {
    const Number linear = scene_.linear_drag, angular = scene_.angular_drag, constant = scene_.gravitation;
    for (std::size_t i = 0; i < bodies_.size(); ++i)
        sums[i] = {gravity_ * bodies_[i].mass - motions[i].v * linear, motions[i].w * -angular};
    add_air_wheels_and_gradient(motions, sums);
    for (const SpringDescription& spring : scene_.springs) add_spring(spring, motions, sums);
    for (std::size_t i = 0; constant > 0 && i < bodies_.size(); ++i) {
        for (std::size_t j = i + 1; j < bodies_.size(); ++j) {
            const Vector r = motions[j].x - motions[i].x;
            const Number distance = std::hypot(norm(r), Number(scene_.softening));
            if (!(distance > 0)) continue;
            const Vector force = r * (constant * bodies_[i].mass * bodies_[j].mass / (distance * distance * distance));
            sums[i].force_w = sums[i].force_w + force;
            sums[j].force_w = sums[j].force_w - force;
        }
    }
    for (const TimedForce& timed : forces_) {
        if (step < timed.from || step >= timed.until) continue;
        const ForceDescription& force = timed.force;
        const auto index = static_cast<std::size_t>(force.body);
        const Rotation& q = motions[index].q;
        const Vector f = vector_of(force.force), t = vector_of(force.torque);
        const bool in_body = force.frame == Frame::body;
        const Vector f_b = in_body ? f : q.rotate_back(f), t_b = in_body ? t : q.rotate_back(t);
        sums[index].force_w = sums[index].force_w + (in_body ? q.rotate(f) : f);
        sums[index].torque_b = sums[index].torque_b + cross(vector_of(force.point), f_b) + t_b;
    }
}

// Newton's and Euler's equations of all bodies between two changes of the timed loads. The state has the bodies that
// move by themselves, then the joints.
void SmoothMotion::flow(std::int64_t from, std::int64_t to) {
    if (const JointDescription* const joint = without_equations(scene_.joints); joint != nullptr)
        raise(std::invalid_argument(
            "joint \"" + joint->name +
            "\" keeps a distance in a range, has limits or may break: its equations are not known"));
    std::vector<Number> state;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        if (!bodies_[i].moves()) continue;
        const auto part = reference::detail::pack(now_[i]);
        state.insert(state.end(), part.begin(), part.end());
    }
    const std::size_t own = state.size();
    trees_.end_velocities_across(joints_, now_);
    state.insert(state.end(), joints_.begin(), joints_.end());
    std::vector<Motion> motions = now_;
    const auto unpack = [&](const std::vector<Number>& packed) {
        auto next = packed.begin();
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            if (!bodies_[i].moves()) continue;
            reference::detail::Packed part;
            std::copy_n(next, part.size(), part.begin());
            next += static_cast<std::ptrdiff_t>(part.size());
            motions[i] = reference::detail::unpack(part);
        }
        return trees_.place(std::span(packed).subspan(own), motions);
    };
    Wrenches sums(bodies_.size());
    const auto equations = [&](const std::vector<Number>& packed, std::vector<Number>& rates, Number time) {
        if (++evaluations_ > effort_.most_evaluations) raise(EffortSpent("the motion takes too many evaluations"));
        reached_ = Number(from) * step_length_ + time;
        const JointTrees::Links links = unpack(packed);
        add_loads(motions, from, sums);
        auto next = rates.begin();
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            const Body& body = bodies_[i];
            if (!body.moves()) continue;
            const Motion& m = motions[i];
            Motion rate{m.v, {}, m.q * Rotation{0, m.w} * Number(0.5), {}};
            if (!body.fixed) {
                rate.v = sums[i].force_w * (1 / body.mass);
                rate.w = body.inverse * (sums[i].torque_b - cross(m.w, body.inertia * m.w));
            }
            const auto part = reference::detail::pack(rate);
            next = std::copy(part.begin(), part.end(), next);
        }
        trees_.rate(std::span(packed).subspan(own), links, motions, sums, std::span(rates).subspan(own));
    };
    if (!state.empty()) integrate(equations, state, 0, Number(to - from) * step_length_, effort_.most_error);
    joints_.assign(state.begin() + static_cast<std::ptrdiff_t>(own), state.end());
    trees_.normalize(joints_);
    std::copy(joints_.begin(), joints_.end(), state.begin() + static_cast<std::ptrdiff_t>(own));
    (void)unpack(state);
    for (Motion& motion : motions) motion.q = motion.q.normalized();
    now_ = motions;
}

Number SmoothMotion::Body::swept() const {
    switch (kind) {
    case ShapeKind::box: return norm(size) / 2;
    case ShapeKind::cylinder: return std::hypot(size.x, size.y / 2);
    case ShapeKind::hoop: return size.x;
    case ShapeKind::capsule: return size.y / 2;
    default: return 0;
    }
}

Number SmoothMotion::extent_of(std::size_t i, const Vector& along) const {
    return half_extent_of(bodies_[i].kind, bodies_[i].size, now_[i].q.rotate_back(along));
}

bool SmoothMotion::may_touch(std::size_t i, std::size_t j) const {
    const Body &a = bodies_[i], &b = bodies_[j];
    return i != j && shapes_meet_(a.kind, b.kind) && !(a.fixed && b.fixed) && (a.layers & b.layers) != 0;
}

// The widest gap between two bodies along a set of axes: the line of centres, the faces' normals, and the normals to an
// edge of each. It is negative only where spheres and boxes overlap: then it is the least distance that separates them.
Number SmoothMotion::distance_bound(std::size_t i, std::size_t j) const {
    const Motion &a = now_[i], &b = now_[j];
    const Vector line = b.x - a.x;
    const auto gap_along = [&](const Vector& n) { return std::abs(dot(line, n)) - extent_of(i, n) - extent_of(j, n); };
    const Number length = norm(line);
    const Vector axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    Number widest = gap_along(length > 0 ? line * (1 / length) : axes[0]);
    for (const Vector& axis : axes)
        widest = std::max({widest, gap_along(a.q.rotate(axis)), gap_along(b.q.rotate(axis))});
    if (widest >= 0) return widest;
    // Without a gap along these axes, two boxes may have one along a normal to an edge of each, and a sphere and a box
    // along the line from the box's nearest point.
    const auto try_along = [&](const Vector& n) {
        if (const Number size = norm(n); size > 1e-9L) widest = std::max(widest, gap_along(n * (1 / size)));
    };
    const auto is = [&](std::size_t body, ShapeKind kind) { return bodies_[body].kind == kind; };
    for (const Vector& of_a : axes)
        for (const Vector& of_b : axes)
            if (is(i, ShapeKind::box) && is(j, ShapeKind::box)) try_along(cross(a.q.rotate(of_a), b.q.rotate(of_b)));
    for (const auto& [box, sphere] : {std::pair{i, j}, {j, i}}) {
        if (!is(box, ShapeKind::box) || !is(sphere, ShapeKind::sphere)) continue;
        Vector centre = now_[box].q.rotate_back(now_[sphere].x - now_[box].x), nearest = centre;
        for (int k = 0; k < 3; ++k)
            nearest[k] = std::clamp(centre[k], -bodies_[box].size[k] / 2, bodies_[box].size[k] / 2);
        try_along(now_[box].q.rotate(centre - nearest));
    }
    return widest;
}

std::vector<SmoothMotion::Overlap> SmoothMotion::overlaps() const {
    std::vector<Overlap> list;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        for (std::size_t p = 0; p < planes_.size() && bodies_[i].touches_planes(); ++p)
            if (const Number height = height_over(planes_[p], i); height < 0) list.push_back({i, p, true, -height});
        for (std::size_t j = 0; j < i && has_pairs_; ++j) {
            if (!may_touch(i, j)) continue;
            if (const Number distance = distance_bound(i, j); distance < 0) list.push_back({i, j, false, -distance});
        }
    }
    return list;
}

Number SmoothMotion::height_over(const Plane& plane, std::size_t i) const {
    return dot(plane.normal, now_[i].x) + plane.offset - extent_of(i, plane.normal);
}

Number SmoothMotion::clearance() const {
    Number least = 1e30L;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        for (const Plane& plane : planes_) {
            if (!bodies_[i].touches_planes()) continue;
            least = std::min(least, height_over(plane, i));
        }
        for (std::size_t j = 0; j < i && has_pairs_; ++j)
            if (may_touch(i, j)) least = std::min(least, distance_bound(i, j));
    }
    return least;
}

Number SmoothMotion::closing_speed() const {
    Number most = 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        bool touches = bodies_[i].touches_planes();
        for (std::size_t j = 0; j < bodies_.size(); ++j) touches = touches || may_touch(i, j);
        if (touches) most = std::max(most, norm(now_[i].v) + norm(now_[i].w) * bodies_[i].swept());
    }
    return has_pairs_ ? 2 * most : most;
}

Number half_extent(const BodyDescription& body, const Rotation& q, const Vector& along) {
    return half_extent_of(body.shape.kind, vector_of(body.shape.size), q.rotate_back(along));
}

}  // namespace tumble::host

#include "simulation/energy.hpp"

#include <tumble/body/mass.hpp>
#include <tumble/shapes/manifold.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include "simulation/long_double.hpp"

namespace tumble::host {

using reference::Motion, reference::Number, reference::Rotation, reference::Vector;

SceneEnergy::SceneEnergy(const SceneData& data) : data_(data) {
    const Features needed = needs(data);
    attracts_ = needed.gravitation;
    has_contact_springs_ = needed.contact_springs;
    for (const BodySpec& spec : data_.bodies)
        bodies_.push_back({number(spec.mass), vector(principal_inertia(spec.inertia).moments)});
    for (const PlaneSpec& plane : data_.planes)
        planes_.push_back({vector(normalized(plane.normal)), number(plane.offset)});
}

Energy SceneEnergy::of(const std::vector<Motion>& now, const std::vector<Vector>& spins, const Vector& gravity) const {
    Energy energy;
    for (std::size_t b = 0; b < now.size(); ++b) {
        if (data_.bodies[b].is_fixed()) continue;
        const Body& body = bodies_[b];
        energy.kinetic += body.mass * dot(now[b].v, now[b].v) / 2;
        energy.kinetic += dot(times(body.moments, spins[b]), spins[b]) / 2;
        energy.potential -= body.mass * dot(gravity, now[b].x);
        energy.potential += of_gravity_gradient(b, now[b]);
    }
    const auto point = [&](int b, const RealVec3& p) {
        const Motion& motion = now[static_cast<std::size_t>(b)];
        return motion.x + motion.q.normalized().rotate(vector(p));
    };
    for (const SpringSpec& spring : data_.springs) {
        const Vector reach = (spring.to_body < 0 ? vector(spring.to) : point(spring.to_body, spring.to)) -
                             point(spring.body, spring.point);
        const Number stretch = norm(reach) - number(spring.rest_length);
        energy.potential += number(spring.stiffness) * stretch * stretch / 2;
    }
    for (std::size_t a = 0; attracts_ && a < now.size(); ++a) {
        for (std::size_t b = a + 1; b < now.size(); ++b) {
            if (data_.bodies[a].is_fixed() && data_.bodies[b].is_fixed()) continue;
            const Number distance = std::hypot(norm(now[b].x - now[a].x), number(data_.softening));
            energy.potential -= number(data_.world.gravitation) * bodies_[a].mass * bodies_[b].mass / distance;
        }
    }
    if (has_contact_springs_) energy.potential += of_contacts(now);
    return energy;
}

// 3/2 w^2 r . J r of a body of moments J, whose torque is 3 w^2 r x J r.
Number SceneEnergy::of_gravity_gradient(std::size_t b, const Motion& now) const {
    const BodySpec& spec = data_.bodies[b];
    if (data_.orbit.rate.is_zero() || is_point_mass(spec)) return 0;
    const Rotation to_principal = rotation(principal_inertia(spec.inertia).principal).conjugate();
    const Vector r = to_principal.rotate(now.q.normalized().rotate_back(vector(normalized(data_.orbit.to_centre))));
    const Number rate = number(data_.orbit.rate);
    return rate * rate * dot(times(bodies_[b].moments, r), r) * 3 / 2;
}

// Of contacts by springs: of spheres and boxes, by their lowest vertices, with planes, and of spheres with each other.
// Left out are pairs with a box, and cylinders, capsules and hoops.
Number SceneEnergy::of_contacts(const std::vector<Motion>& now) const {
    const Number stiffness = number(data_.world.contact.stiffness), barrier = number(data_.world.contact.barrier);
    Number sum = 0;
    const auto add_point = [&](Number gap) {
        if (gap < 0) sum += stiffness * gap * gap / 2;
        else if (gap > 0) sum += barrier / gap;
    };
    for (std::size_t b = 0; b < now.size(); ++b) {
        const BodySpec& spec = data_.bodies[b];
        const Vector size = vector(spec.shape.size);
        for (const Plane& plane : planes_) {
            if (spec.is_fixed()) continue;
            const Number height = dot(plane.normal, now[b].x) + plane.offset;
            if (spec.shape.kind == ShapeKind::sphere) add_point(height - size.x);
            if (spec.shape.kind != ShapeKind::box) continue;
            std::array<Number, 8> gaps;
            for (unsigned corner = 0; corner < gaps.size(); ++corner) {
                Vector arm;
                for (int i = 0; i < 3; ++i) arm[i] = ((corner >> i) & 1) != 0 ? size[i] / 2 : -size[i] / 2;
                gaps[corner] = height + dot(plane.normal, now[b].q.normalized().rotate(arm));
            }
            // As many of the lowest as the kernel keeps.
            std::sort(gaps.begin(), gaps.end());
            std::for_each(gaps.begin(), gaps.begin() + contact::max_points, add_point);
        }
        for (std::size_t a = 0; a < b; ++a) {
            const BodySpec& other = data_.bodies[a];
            if (spec.shape.kind != ShapeKind::sphere || other.shape.kind != ShapeKind::sphere ||
                (spec.is_fixed() && other.is_fixed()))
                continue;
            add_point(norm(now[b].x - now[a].x) - size.x - number(other.shape.size.x));
        }
    }
    return sum;
}

bool stored_energy_is_known(const SceneDescription& scene) {
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        const ShapeKind kind = scene.bodies[b].shape.kind;
        const bool is_known = kind == ShapeKind::sphere || kind == ShapeKind::box;
        if (!scene.planes.empty() && !is_known && kind != ShapeKind::none && kind != ShapeKind::points) return false;
        for (std::size_t a = 0; a < b; ++a) {
            const ShapeKind other = scene.bodies[a].shape.kind;
            if (shapes_meet(kind, other) && (kind != ShapeKind::sphere || other != ShapeKind::sphere)) return false;
        }
    }
    return true;
}

}  // namespace tumble::host

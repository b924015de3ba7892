#include "truth/joint_trees.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/raise.hpp"

namespace tumble::host {
namespace {

using namespace reference;

using Six = std::array<Number, 6>;
using Matrix = std::array<Six, 6>;

constexpr Vector axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

Six six(const Vector& linear, const Vector& angular) {
    return {linear.x, linear.y, linear.z, angular.x, angular.y, angular.z};
}
Vector linear(const Six& a) { return {a[0], a[1], a[2]}; }
Vector angular(const Six& a) { return {a[3], a[4], a[5]}; }

Number dot(const Six& a, const Six& b) {
    Number sum = 0;
    for (std::size_t i = 0; i < 6; ++i) sum += a[i] * b[i];
    return sum;
}
void add_to(Six& sum, const Six& a, Number factor = 1) {
    for (std::size_t i = 0; i < 6; ++i) sum[i] += a[i] * factor;
}
Six times(const Matrix& m, const Six& a) {
    Six product;
    for (std::size_t i = 0; i < 6; ++i) product[i] = dot(m[i], a);
    return product;
}

// The velocity or acceleration of a point of a rigid body at `reach` from another point of it, and its transpose: the
// force about the other point.
Six carried(const Six& a, const Vector& reach) { return six(linear(a) + cross(angular(a), reach), angular(a)); }
Six carried_back(const Six& f, const Vector& reach) { return six(linear(f), angular(f) + cross(reach, linear(f))); }

// The inertia about the other point. It is symmetric, so its rows are its columns.
Matrix carried_back(const Matrix& inertia, const Vector& reach) {
    Matrix about;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vector swing = cross(axes[i], reach);
        Six of_turn = inertia[i + 3];
        for (std::size_t j = 0; j < 3; ++j) add_to(of_turn, inertia[j], swing[static_cast<int>(j)]);
        about[i] = carried_back(inertia[i], reach);
        about[i + 3] = carried_back(of_turn, reach);
    }
    return about;
}

Six velocity_of(const Motion& m) { return six(m.v, m.q.rotate(m.w)); }

std::vector<Vector> perpendicular_to(const Vector& axis) {
    const auto size = [&](const Vector& v) { return std::abs(reference::dot(v, axis)); };
    const Vector& least = *std::min_element(std::begin(axes), std::end(axes),
                                            [&](const Vector& a, const Vector& b) { return size(a) < size(b); });
    const Vector one = unit(cross(axis, least));
    return {one, cross(axis, one)};
}

}  // namespace

const JointDescription* without_equations(const std::vector<JointDescription>& joints) {
    const auto found = std::find_if(joints.begin(), joints.end(), [](const JointDescription& joint) {
        return (joint.kind == JointKind::distance && !joint.is_rod()) || joint.has_ends() || joint.may_break();
    });
    return found == joints.end() ? nullptr : &*found;
}

FreeAxes free_axes(const JointDescription& joint) {
    const std::vector<Vector> all(std::begin(axes), std::end(axes));
    const auto axis = [&] { return unit(vector_of(joint.axis)); };
    switch (joint.kind) {
    case JointKind::hinge: return {{axis()}, {}};
    case JointKind::slider: return {{}, {axis()}};
    case JointKind::universal: {
        // The axis of `to_body` is made perpendicular to that of `body`.
        const Vector to_axis = vector_of(joint.to_axis);
        return {{axis(), unit(to_axis - axis() * reference::dot(to_axis, axis()))}, {}};
    }
    case JointKind::fixed: return {};
    case JointKind::ball: return {all, {}};
    case JointKind::distance:
        if (!joint.is_rod()) return {all, all};
        return {all, perpendicular_to(unit(vector_of(joint.anchor) - vector_of(joint.to_point)))};
    }
    return {};
}

// Each joint hangs a body on one that hangs already. Where none can, a tree ties to nothing of the world: its root is
// the body of the first joint that is left.
JointTrees::JointTrees(std::vector<Body> bodies, const std::vector<JointDescription>& joints, const Motions& start)
    : bodies_(std::move(bodies)), node_of_(bodies_.size(), -1) {
    const auto hangs = [&](int body) {
        return body < 0 || bodies_[static_cast<std::size_t>(body)].fixed || has(static_cast<std::size_t>(body));
    };
    std::vector<const JointDescription*> left;
    for (const JointDescription& joint : joints) left.push_back(&joint);
    while (!left.empty()) {
        const auto next = std::find_if(left.begin(), left.end(),
                                       [&](const auto* joint) { return hangs(joint->body) || hangs(joint->to_body); });
        if (next == left.end()) {
            add(static_cast<std::size_t>(left.front()->body), -1, nullptr, start);
            continue;
        }
        const JointDescription& joint = **next;
        if (hangs(joint.body) && hangs(joint.to_body))
            raise(std::invalid_argument("joint \"" + joint.name + "\" closes a loop, expected trees"));
        const bool is_reversed = hangs(joint.body);
        add(static_cast<std::size_t>(is_reversed ? joint.to_body : joint.body),
            is_reversed ? joint.body : joint.to_body, &joint, start);
        left.erase(next);
    }
}

// `joint`: none of a root that flies.
void JointTrees::add(std::size_t body, int parent, const JointDescription* joint, const Motions& start) {
    const Motion own = start[body], other = motion_of(parent, start);
    const auto anchor_on = [&](int side) { return joint == nullptr ? own.x : vector_of(joint->anchor_on(side)); };
    const Vector anchor = anchor_on(static_cast<int>(body)), anchor_of_parent = anchor_on(parent);
    Node node;
    node.body = body;
    node.parent = parent;
    node.arm_of_parent = other.q.rotate_back(anchor_of_parent - other.x);
    node.arm = own.q.rotate_back(anchor - own.x);
    node.rest = other.q.conjugate() * own.q;
    node.first_travel = other.q.rotate_back(anchor - anchor_of_parent);
    node.is_rod = joint != nullptr && joint->is_rod();
    node.first_speed = speeds_;
    const std::vector<Vector> all(std::begin(axes), std::end(axes));
    const FreeAxes free = joint == nullptr ? FreeAxes{all, all} : free_axes(*joint);
    for (const Vector& axis : node.is_rod ? all : free.slides) node.free.push_back({false, other.q.rotate_back(axis)});
    for (const Vector& axis : free.turns) node.free.push_back({true, other.q.rotate_back(axis)});
    // Each body of a universal joint keeps one of its axes.
    if (joint != nullptr && joint->kind == JointKind::universal)
        node.free[static_cast<int>(body) == joint->body ? 0 : 1].is_kept_by_own = true;
    if (joint != nullptr) {
        node.is_reversed = static_cast<int>(body) != joint->body;
        if (joint->kind != JointKind::distance && (joint->spring.acts() || joint->to_spring.acts())) {
            node.springs.assign(node.free.size(), joint->spring);
            if (joint->kind == JointKind::universal) node.springs[1] = joint->to_spring;
        }
    }
    speeds_ += node.free.size();
    node_of_[body] = static_cast<int>(nodes_.size());
    nodes_.push_back(std::move(node));
}

Motion JointTrees::motion_of(int body, const Motions& motions) {
    return body < 0 ? Motion{} : motions[static_cast<std::size_t>(body)];
}

JointTrees::Place JointTrees::place_of(std::size_t node, std::span<const Number> state) const {
    const auto at = state.subspan(node * numbers_of_place);
    return {Rotation{at[0], {at[1], at[2], at[3]}}.normalized(), {at[4], at[5], at[6]}};
}

std::span<const Number> JointTrees::speeds_of(std::span<const Number> state) const {
    return state.subspan(nodes_.size() * numbers_of_place);
}

std::vector<Number> JointTrees::start() const {
    std::vector<Number> state(nodes_.size() * numbers_of_place + speeds_);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        const auto& [x, y, z] = nodes_[i].first_travel;
        const Number place[] = {1, 0, 0, 0, x, y, z};
        std::copy(std::begin(place), std::end(place),
                  state.begin() + static_cast<std::ptrdiff_t>(i * numbers_of_place));
    }
    return state;
}

void JointTrees::normalize(std::span<Number> state) const {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        auto [turned, travel] = place_of(i, state);
        if (nodes_[i].is_rod) {
            travel = unit(travel) * norm(nodes_[i].first_travel);
            const Vector sliding = sliding_of(nodes_[i], state);
            add_slide(nodes_[i], -unit(travel) * reference::dot(unit(travel), sliding),
                      state.subspan(nodes_.size() * numbers_of_place));
        }
        const Number numbers[] = {turned.w, turned.v.x, turned.v.y, turned.v.z, travel.x, travel.y, travel.z};
        std::copy(std::begin(numbers), std::end(numbers), state.subspan(i * numbers_of_place).begin());
    }
}

JointTrees::Links JointTrees::place(std::span<const Number> state, Motions& motions) const {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        const Node& node = nodes_[i];
        const Motion parent = motion_of(node.parent, motions);
        const auto [turned, travel] = place_of(i, state);
        Motion& own = motions[node.body];
        own.q = parent.q * turned * node.rest;
        own.x = parent.x + parent.q.rotate(node.arm_of_parent + travel) - own.q.rotate(node.arm);
    }
    const auto speeds = speeds_of(state);
    Links links = links_of(state, motions);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        const Node& node = nodes_[i];
        Six velocity = carried(velocity_of(motion_of(node.parent, motions)), links[i].reach);
        for (std::size_t k = 0; k < node.free.size(); ++k)
            add_to(velocity, links[i].free[k], speeds[node.first_speed + k]);
        Motion& own = motions[node.body];
        own.v = linear(velocity);
        own.w = own.q.rotate_back(angular(velocity));
    }
    return links;
}

// In the parent's axes, of unit length.
Vector JointTrees::axis_of(const Direction& direction, const Place& at) {
    return direction.is_kept_by_own ? at.turned.rotate(direction.axis) : direction.axis;
}

std::vector<Six> JointTrees::ways_of(const Link& link) {
    if (link.rod == Vector{}) return link.free;
    std::vector<Six> ways(link.free.begin() + 3, link.free.end());
    for (const Vector& axis : perpendicular_to(link.rod)) ways.push_back(six(axis, {}));
    return ways;
}

JointTrees::Links JointTrees::links_of(std::span<const Number> state, const Motions& motions) const {
    Links links(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        const Node& node = nodes_[i];
        const Motion &own = motions[node.body], parent = motion_of(node.parent, motions);
        const Place at = place_of(i, state);
        links[i].reach = own.x - parent.x;
        if (node.is_rod) links[i].rod = parent.q.rotate(unit(at.travel));
        links[i].free.reserve(node.free.size());
        for (const Direction& direction : node.free) {
            const Vector axis = parent.q.rotate(axis_of(direction, at));
            links[i].free.push_back(direction.turns ? six(cross(own.q.rotate(node.arm), axis), axis) : six(axis, {}));
        }
    }
    return links;
}

// The acceleration of a body at constant speeds, where its parent's is zero. That of a rod keeps its length.
Six JointTrees::bias_of(std::size_t i, std::span<const Number> state, const Link& link, const Motions& motions) const {
    const Node& node = nodes_[i];
    const Motion &own = motions[node.body], parent = motion_of(node.parent, motions);
    const Vector w = own.q.rotate(own.w), w_parent = parent.q.rotate(parent.w), arm = own.q.rotate(node.arm);
    const auto speeds = speeds_of(state);
    const Vector sliding = parent.q.rotate(sliding_of(node, state));
    Vector turning;  // change of the angular velocity as the axes turn, rad/s^2
    for (std::size_t k = 0; k < node.free.size(); ++k)
        if (const Direction& direction = node.free[k]; direction.turns)
            turning = turning + cross(direction.is_kept_by_own ? w : w_parent, angular(link.free[k])) *
                                    speeds[node.first_speed + k];
    Vector of_anchor = cross(w_parent, cross(w_parent, link.reach + arm)) + cross(w_parent, sliding) * 2;
    if (node.is_rod) of_anchor = of_anchor - link.rod * inward(node, sliding);
    return six(of_anchor - cross(turning, arm) - cross(w, cross(w, arm)), turning);
}

Number JointTrees::inward(const Node& node, const Vector& sliding) {
    return reference::dot(sliding, sliding) / norm(node.first_travel);
}

Vector JointTrees::sliding_of(const Node& node, std::span<const Number> state) const {
    Vector sliding;
    for (std::size_t k = 0; k < node.free.size(); ++k)
        if (!node.free[k].turns) sliding = sliding + node.free[k].axis * speeds_of(state)[node.first_speed + k];
    return sliding;
}

void JointTrees::add_slide(const Node& node, const Vector& slide, std::span<Number> speeds) {
    for (std::size_t k = 0; k < node.free.size(); ++k)
        if (!node.free[k].turns) speeds[node.first_speed + k] += reference::dot(node.free[k].axis, slide);
}

Matrix JointTrees::inertia_of(std::size_t body, const Motions& motions) const {
    const Rotation& q = motions[body].q;
    Matrix inertia;
    for (std::size_t i = 0; i < 3; ++i) {
        inertia[i] = six(axes[i] * bodies_[body].mass, {});
        inertia[i + 3] = six({}, q.rotate(bodies_[body].inertia * q.rotate_back(axes[i])));
    }
    return inertia;
}

// From the leaves to the roots each free direction is eliminated from the inertia that its parent feels; from the roots
// to the leaves the rates follow.
void JointTrees::solve(const Motions& motions, const Links& links, const std::vector<Six>& forces,
                       const std::vector<Six>& bias, const std::vector<Six>& base, const std::vector<Number>& pushes,
                       std::span<Number> along) const {
    struct Eliminated {
        Six felt;               // the inertia times the direction
        Number force, inertia;  // along the direction
    };
    std::vector<Eliminated> eliminated(speeds_);
    std::vector<Matrix> inertias;
    std::vector<Six> needed;  // force for no acceleration
    for (const Node& node : nodes_) inertias.push_back(inertia_of(node.body, motions));
    for (const Six& force : forces) add_to(needed.emplace_back(), force, -1);
    const auto node_at = [&](int body) { return body < 0 ? -1 : node_of_[static_cast<std::size_t>(body)]; };
    for (std::size_t i = nodes_.size(); i-- > 0;) {
        Matrix& inertia = inertias[i];
        add_to(needed[i], times(inertia, bias[i]));
        const std::vector<Six> ways = ways_of(links[i]);
        for (std::size_t k = 0; k < ways.size(); ++k) {
            const Six felt = times(inertia, ways[k]);
            const Number push = nodes_[i].is_rod ? 0 : pushes[nodes_[i].first_speed + k];
            const Eliminated now{felt, push - dot(ways[k], needed[i]), dot(ways[k], felt)};
            for (std::size_t r = 0; r < 6; ++r) add_to(inertia[r], felt, -felt[r] / now.inertia);
            add_to(needed[i], felt, now.force / now.inertia);
            eliminated[nodes_[i].first_speed + k] = now;
        }
        const int parent = node_at(nodes_[i].parent);
        if (parent < 0) continue;
        const auto p = static_cast<std::size_t>(parent);
        add_to(needed[p], carried_back(needed[i], links[i].reach));
        const Matrix added = carried_back(inertia, links[i].reach);
        for (std::size_t r = 0; r < 6; ++r) add_to(inertias[p][r], added[r]);
    }
    std::vector<Six> rates(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        const int parent = node_at(nodes_[i].parent);
        rates[i] = carried(parent < 0 ? base[i] : rates[static_cast<std::size_t>(parent)], links[i].reach);
        const std::vector<Six> ways = ways_of(links[i]);
        std::vector<Number> by_way(ways.size());
        for (std::size_t k = ways.size(); k-- > 0;) {
            const Eliminated& of = eliminated[nodes_[i].first_speed + k];
            by_way[k] = (of.force - dot(of.felt, rates[i])) / of.inertia;
            add_to(rates[i], ways[k], by_way[k]);
        }
        const auto to = along.subspan(nodes_[i].first_speed);
        if (nodes_[i].is_rod) {
            const Vector slide = linear(ways[3]) * by_way[3] + linear(ways[4]) * by_way[4];
            for (std::size_t k = 0; k < 3; ++k) to[k] = reference::dot(linear(links[i].free[k]), slide);
            std::copy_n(by_way.begin(), 3, to.begin() + 3);
        } else {
            std::copy(by_way.begin(), by_way.end(), to.begin());
        }
        add_to(rates[i], bias[i]);
    }
}

// The momentum of the bodies takes the place of forces, and the speeds that of their rates.
void JointTrees::end_velocities_across(std::span<Number> state, const Motions& motions) const {
    std::vector<Six> momenta, bases;
    for (const Node& node : nodes_) {
        momenta.push_back(times(inertia_of(node.body, motions), velocity_of(motions[node.body])));
        bases.push_back(velocity_of(motion_of(node.parent, motions)));
    }
    solve(motions, links_of(state, motions), momenta, std::vector<Six>(nodes_.size()), bases,
          std::vector<Number>(speeds_), state.subspan(nodes_.size() * numbers_of_place));
}

// What ends and what stays are perpendicular to each other, measured by the masses.
Number JointTrees::energy_across(const Motions& motions) const {
    std::vector<Number> state = start();
    Motions after = motions;
    end_velocities_across(state, motions);
    (void)place(state, after);
    Number sum = 0;
    for (const Node& node : nodes_) {
        Six ended = velocity_of(motions[node.body]);
        add_to(ended, velocity_of(after[node.body]), -1);
        sum += dot(ended, times(inertia_of(node.body, motions), ended)) / 2;
    }
    return sum;
}

std::array<Number, 3> JointTrees::coordinates_of(const Node& node, const Place& at) {
    const Number pi = std::acos(Number(-1));
    if (node.free.size() == 1 && !node.free[0].turns) return {reference::dot(at.travel, node.free[0].axis)};
    if (node.free.size() == 1) {
        const Number turn = 2 * std::atan2(reference::dot(at.turned.v, node.free[0].axis), at.turned.w);
        return {turn > pi ? turn - 2 * pi : turn <= -pi ? turn + 2 * pi : turn};
    }
    if (node.free.size() == 3) {
        const Rotation q = at.turned.w < 0 ? at.turned * Number(-1) : at.turned;
        const Number half_sine = norm(q.v);
        const Vector turn = q.v * (half_sine > 0 ? 2 * std::atan2(half_sine, q.w) / half_sine : 2);
        return {reference::dot(turn, node.free[0].axis), reference::dot(turn, node.free[1].axis),
                reference::dot(turn, node.free[2].axis)};
    }
    // It turns about the axis that the parent keeps, and then about the one that turns with the body.
    const std::size_t kept = node.free[0].is_kept_by_own ? 1 : 0;
    const Vector &parents = node.free[kept].axis, &own = node.free[1 - kept].axis, across = cross(own, parents);
    const Vector own_now = at.turned.rotate(own), parents_back = at.turned.rotate_back(parents);
    std::array<Number, 3> angles{};
    angles[kept] = std::atan2(-reference::dot(own_now, across), reference::dot(own_now, own));
    angles[1 - kept] = std::atan2(-reference::dot(parents_back, across), reference::dot(parents_back, parents));
    return angles;
}

std::vector<Number> JointTrees::spring_forces(std::span<const Number> state) const {
    const auto speeds = speeds_of(state);
    std::vector<Number> forces(speeds_);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        const Node& node = nodes_[i];
        if (node.springs.empty()) continue;
        const auto at = coordinates_of(node, place_of(i, state));
        for (std::size_t k = 0; k < node.free.size(); ++k) {
            const JointSpringDescription& spring = node.springs[k];
            const Number rest = node.is_reversed ? -spring.rest : spring.rest;
            forces[node.first_speed + k] =
                -spring.stiffness * (at[k] - rest) - spring.damping * speeds[node.first_speed + k];
        }
    }
    return forces;
}

void JointTrees::rate(std::span<const Number> state, const Links& links, const Motions& motions,
                      const std::vector<Wrench>& loads, std::span<Number> rates) const {
    const auto speeds = speeds_of(state);
    std::vector<Six> forces, bias;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        const Node& node = nodes_[i];
        const Motion& own = motions[node.body];
        const Wrench& load = loads[node.body];
        forces.push_back(
            six(load.force_w, own.q.rotate(load.torque_b - cross(own.w, bodies_[node.body].inertia * own.w))));
        bias.push_back(bias_of(i, state, links[i], motions));

        const auto numbers = state.subspan(i * numbers_of_place);
        const Place at = place_of(i, state);
        const Vector sliding = sliding_of(node, state);
        Vector turning;  // in the parent's axes
        for (std::size_t k = 0; k < node.free.size(); ++k)
            if (node.free[k].turns) turning = turning + axis_of(node.free[k], at) * speeds[node.first_speed + k];
        const Rotation rate =
            Rotation{0, turning} * Rotation{numbers[0], {numbers[1], numbers[2], numbers[3]}} * Number(0.5);
        const Number place[] = {rate.w, rate.v.x, rate.v.y, rate.v.z, sliding.x, sliding.y, sliding.z};
        std::copy(std::begin(place), std::end(place), rates.subspan(i * numbers_of_place).begin());
    }
    const auto rates_of_speeds = rates.subspan(nodes_.size() * numbers_of_place);
    solve(motions, links, forces, bias, std::vector<Six>(nodes_.size()), spring_forces(state), rates_of_speeds);
    for (std::size_t i = 0; i < nodes_.size(); ++i)
        if (const Node& node = nodes_[i]; node.is_rod)
            add_slide(node, -unit(place_of(i, state).travel) * inward(node, sliding_of(node, state)), rates_of_speeds);
}

}  // namespace tumble::host

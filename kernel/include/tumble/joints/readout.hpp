// How a joint stands and moves, in SI units: its angle or travel, its speed, and the force and torque that it carries.
#pragma once

#include <tumble/joints/forest.hpp>
#include <tumble/numbers/functions.hpp>

namespace tumble {

// A joint in a program's own numbers: World::joint().
template <class T>
struct JointReadout {
    // rad, of a hinge, and of a universal joint about the axis of `body`: the turn of `body` from where the joint was
    // added, in (-pi, pi].
    T angle{};
    T to_angle{};  // rad, of a universal joint about the axis of `to_body`, likewise
    // m, of a slider: the way of `body` along the axis from where the joint was added; of a distance: itself.
    T travel{};
    T speed{};            // rad/s or m/s, of `angle` or `travel`
    T to_speed{};         // rad/s, of `to_angle`
    Vector3<T> force{};   // N, world axes: on `body` by the joint, at the end of the last step
    Vector3<T> torque{};  // N m, world axes, about the anchor: likewise; about free axes it is zero
    bool broken = false;  // it holds nothing, and all of the above is zero
    int at_limit = 0;     // of a joint with a range: 1 where it is held at its most, -1 at its least, 0 between
    int corrections = 0;  // of its tree in the last step, in all parts of it; not kept in a snapshot
};

namespace detail {

// Joint j of the forest, from the states of the bodies. `Pieces`: see JointHold.
template <class N, Features features, class Bodies, class Pieces>
class JointReader {
public:
    using Work = typename N::Work;
    using Vector = WorkVec3<N>;
    using Forest = JointForest<N, features>;

    JointReader(const Forest& forest, const Bodies& bodies, int j, Work steps_per_second)
        : forest_{forest}, bodies_{bodies}, joint_{forest.record(j)}, node_{forest.node_of(j)}, rate_{
                                                                                                    steps_per_second} {}

    template <class T>
    [[nodiscard]] JointReadout<T> read() const {
        JointReadout<T> to;
        [[maybe_unused]] const int turns = JointKinds::turns[joint_.kind];
        if constexpr (JointKinds::any_turns(features, 1) || JointKinds::any_turns(features, 2))
            if (turns == 1 || turns == 2) {
                to.angle = static_cast<T>(angle(0, turns == 2));
                to.speed = static_cast<T>(dot(axis(0, 0), relative_spin()));
            }
        if constexpr (JointKinds::any_turns(features, 2))
            if (turns == 2) {
                to.to_angle = -static_cast<T>(angle(1, true));
                to.to_speed = static_cast<T>(dot(axis(1, 0), relative_spin()));
            }
        if constexpr (JointKinds::any_slides(features, 1))
            if (JointKinds::slides[joint_.kind] == 1) {
                to.travel = static_cast<T>(dot(axis(1, 0), Vector(anchor(0) - anchor(1))));
                to.speed = static_cast<T>(slide_rate());
            }
        if constexpr (features.distances)
            if (JointKinds::slides[joint_.kind] == 2) {
                const Vector line = anchor(0) - anchor(1), rate = point_velocity(0) - point_velocity(1);
                const Work length = sqrt(dot(line, line));
                to.travel = static_cast<T>(length);
                if (length > Work(0)) to.speed = static_cast<T>(Work(dot(line, rate)) / length);
            }
        if constexpr (features.has_joint_ranges()) to.at_limit = forest_.range_of(forest_.nodes()[node_].joint).end;
        Vector force, torque;
        load(force, torque);
        to.force = {static_cast<T>(force[0]), static_cast<T>(force[1]), static_cast<T>(force[2])};
        to.torque = {static_cast<T>(torque[0]), static_cast<T>(torque[1]), static_cast<T>(torque[2])};
        to.corrections = forest_.tree_at(node_).corrections;
        return to;
    }
    // N and N m, on `body` at the anchor, world: at the end of the last step. The balance of the subtree that hangs on
    // the joint: its half kicks are by this joint alone, since what joints do within it cancels.
    void load(Vector& force, Vector& torque) const {
        force = torque = zero_vector<N>();
        const JointNode<N>* nodes = forest_.nodes();
        const Vector at = anchor(nodes[node_].side);
        const int last = forest_.tree_at(node_).last;
        for (int i = node_; i < last; ++i) {
            if (!hangs_on(i)) continue;
            const int b = nodes[i].body;
            const Kick<N>& kick = forest_.kicks()[i];
            Vector push, turn;
            for (int k = 0; k < 3; ++k) {
                push[k] = N::metres(kick.linear[k], bodies_.scale) / bodies_.step_per_mass(b);
                turn[k] = N::half_turn(kick.angular[k], bodies_.finest_scale()) *
                          bodies_.constants[b].units.rate(k, Work(1)) / bodies_.step_per_moment(b, k);
            }
            force += push;
            torque += cross<Work>(Vector(bodies_.position(b) - at), push) +
                      rotate(work_quaternion<N>(bodies_.state[b].q_wb.value()), turn);
        }
        // Twice a half kick, of a part of 2^-halvings of a step, or of the last piece of a part.
        Work per_kick = rate_ * static_cast<Work>(2 << forest_.tree_at(node_).halvings);
        if constexpr (Pieces::count > 1)
            per_kick = per_kick * N::template constant<Work>(Real{1} / Pieces::of(Pieces::count - 1));
        const Work scale = nodes[node_].side == 0 ? per_kick : -per_kick;
        force = scaled_by(force, scale);
        torque = scaled_by(torque, scale);
    }
    // True where the end of the last step has loaded the joint beyond this strength.
    [[nodiscard]] bool exceeds(const JointStrength<N>& strength) const {
        Vector force, torque;
        load(force, torque);
        const auto is_beyond = [](const Vector& load, Work limit) {
            return limit > Work(0) && Work(dot(load, load)) > limit * limit;
        };
        return is_beyond(force, strength.force) || is_beyond(torque, strength.torque);
    }

private:
    const Forest& forest_;
    const Bodies& bodies_;
    const JointRecord<N>& joint_;
    int node_;
    Work rate_;  // steps per second

    [[nodiscard]] Vector in_world(int b, const StoredVec3<typename N::Unit>& v) const {
        const Vector work = work_unit<N>(v);
        return b < 0 ? work : rotate(work_quaternion<N>(bodies_.state[b].q_wb.value()), work);
    }
    // Of a side of the joint, in the world.
    [[nodiscard]] Vector axis(int side, int k) const {
        return in_world(joint_.side[side].body, joint_.side[side].axis[k]);
    }
    [[nodiscard]] Vector arm(int side) const {
        const auto& s = joint_.side[side];
        const Vector unit = in_world(s.body, s.arm);
        return {N::times_power_of_two(unit[0], s.arm_log2), N::times_power_of_two(unit[1], s.arm_log2),
                N::times_power_of_two(unit[2], s.arm_log2)};
    }
    [[nodiscard]] Vector anchor(int side) const {
        const int b = joint_.side[side].body;
        if (b >= 0) return bodies_.position(b) + arm(side);
        const auto metres = [&](int i) { return N::metres(N::sum(joint_.anchor[i])); };
        return {metres(0), metres(1), metres(2)};
    }
    // rad/s, world; zero of the world and of a fixed body.
    [[nodiscard]] Vector spin(int side) const {
        const int b = joint_.side[side].body;
        if (b < 0 || bodies_.constants[b].fixed()) return zero_vector<N>();
        const Vector w{bodies_.turn(b, 0) * rate_, bodies_.turn(b, 1) * rate_, bodies_.turn(b, 2) * rate_};
        return rotate(work_quaternion<N>(bodies_.state[b].q_wb.value()), w);
    }
    [[nodiscard]] Vector velocity(int side) const {
        const int b = joint_.side[side].body;
        if (b < 0 || bodies_.constants[b].fixed()) return zero_vector<N>();
        return {bodies_.drift(b, 0) * rate_, bodies_.drift(b, 1) * rate_, bodies_.drift(b, 2) * rate_};
    }
    [[nodiscard]] Vector point_velocity(int side) const { return velocity(side) + cross<Work>(spin(side), arm(side)); }
    [[nodiscard]] Vector relative_spin() const { return spin(0) - spin(1); }
    // About the axis of a side, from the second axis of the other side to that of this one; between axes of which one
    // shows its own angle alone, the other side's first axis is the second one.
    [[nodiscard]] Work angle(int side, bool crosses) const {
        const Vector from = axis(1 - side, crosses ? 0 : 1), to = axis(side, 1), about = axis(side, 0);
        return arc_tangent(dot(cross<Work>(from, to), about), dot(from, to));
    }
    // Of the body's anchor against the point of the other side at which it is.
    [[nodiscard]] Work slide_rate() const {
        const Vector at = anchor(0);
        const Vector own = point_velocity(0);
        const int b = joint_.side[1].body;
        if (b < 0) return dot(axis(1, 0), own);
        const Vector other = velocity(1) + cross<Work>(spin(1), Vector(at - bodies_.position(b)));
        return dot(axis(1, 0), Vector(own - other));
    }
    [[nodiscard]] bool hangs_on(int i) const {
        while (i > node_) i = forest_.nodes()[i].parent;
        return i == node_;
    }
};

}  // namespace detail

}  // namespace tumble

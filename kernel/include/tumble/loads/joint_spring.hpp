// Springs and dampers along the free directions of joints: a torque -k (angle - rest) - c (rate of the angle) about an
// axis, and likewise a force along an axis or a line. It acts on both bodies at one point, so momentum and angular
// momentum are kept. Of a ball joint the angle is that of the whole turn, about its axis: -k times the vector of the
// turn, which is the gradient of k angle^2 / 2, and -c times the relative spin.
#pragma once

#include <tumble/loads/loaded_group.hpp>
#include <tumble/shapes/axes.hpp>

namespace tumble {

// Of the joints of a world, by their places.
template <class N, int joints, int bodies>
class JointSprings {
public:
    using Work = typename N::Work;
    using Unit = typename N::Unit;
    using Vector = WorkVec3<N>;
    using Direction = Vec3<Unit>;
    // What a spring is along.
    enum class Along : std::uint8_t { nothing, turn, turns, whole_turn, slide, line };
    // As the world knows a side of the joint: the arm, m, and the axes in principal axes.
    struct Side {
        int body = -1;  // -1: the world
        StoredVec3<Work> arm{};
        StoredVec3<Unit> axis[2]{};
    };

    constexpr JointSprings(Real, const WorldSpec&) {}

    // Sets the springs of a joint. `along` of a universal joint is `turns`: about an axis of each body.
    TUMBLE_COLD constexpr void set(int joint, Along along, const Side (&side)[2],
                                   const typename N::PositionSum (&anchor)[3], const JointSpring (&spring)[2],
                                   const auto& all) {
        Entry entry{};
        if (spring[0].acts() || spring[1].acts()) {
            entry.along = along;
            entry.is_on = true;
            for (int i = 0; i < 2; ++i) {
                entry.side[i] = side[i];
                entry.stiffness[i] = N::template constant<Work>(spring[i].stiffness);
                entry.damping[i] = N::template constant<Work>(spring[i].damping);
                entry.rest[i] = N::template constant<Work>(spring[i].rest);
            }
            for (int i = 0; i < 3; ++i) entry.anchor[i] = anchor[i];
        }
        entry_[joint] = entry;
        note(all);
    }
    // Forgets the springs of joints that are not known any more. Those of joints that hold nothing do nothing.
    TUMBLE_COLD void keep(auto&& is_known, auto&& acts, const auto& all) {
        const Entry none{};
        for (int j = 0; j < joints; ++j) {
            if (!is_known(j)) entry_[j] = none;
            entry_[j].is_on = entry_[j].along != Along::nothing && acts(j);
        }
        note(all);
    }
    // N m/rad or N/m, and with the time in seconds: of spring i of a joint.
    [[nodiscard]] Work stiffness(int joint, int i) const { return entry_[joint].stiffness[i]; }
    [[nodiscard]] Work damping(int joint, int i) const { return entry_[joint].damping[i]; }
    void add_to(auto& digest) const {
        for (const Entry& entry : entry_)
            for (int i = 0; entry.along != Along::nothing && i < 2; ++i) {
                digest.add_number(entry.stiffness[i]);
                digest.add_number(entry.damping[i]);
                digest.add_number(entry.rest[i]);
            }
    }

    // As each load has it: loads/load.hpp.
    [[nodiscard]] bool acts_on(const auto&, int b) const { return acts_[b]; }
    // Likewise.
    [[nodiscard]] bool turns(const auto&, int b) const { return acts_[b]; }
    // Likewise.
    [[nodiscard]] bool couples(const auto&, int b) const { return couples_[b]; }
    // Likewise.
    template <class F>
    void for_each_coupled(const auto& all, int b, F&& f) const {
        for (const Entry& entry : entry_) {
            if (!entry.is_on) continue;
            for (int side = 0; side < 2; ++side) {
                const int other = entry.side[1 - side].body;
                if (entry.side[side].body == b && other >= 0 && !all.constants[other].fixed()) f(other);
            }
        }
    }
    // Likewise.
    [[nodiscard]] bool depends_on_velocity() const { return is_damped_; }
    // Likewise.
    template <class Group>
    void apply_to(const Group& group) const {
        if constexpr (Group::rotation)
            for (const Entry& entry : entry_) {
                if (!entry.is_on) continue;
                const End<Group> own{group, entry.side[0]}, other{group, entry.side[1]};
                if (own.place < 0 && other.place < 0) continue;
                if (entry.along == Along::slide || entry.along == Along::line) pull(group, entry, own, other);
                else turn(group, entry, own, other);
            }
    }

private:
    struct Entry {
        Along along = Along::nothing;
        bool is_on = false;
        Side side[2]{};
        typename N::PositionSum anchor[3]{};  // in the world, where it is the other side
        Work stiffness[2]{}, damping[2]{}, rest[2]{};
    };
    // A side of a joint at a stage.
    template <class Group>
    struct End {
        const Side& side;
        int place = -1;  // in the group; -1: the world, or a body that stands still
        Axes<N> axes{};  // of a body
        Vector spin_b = zero_vector<N>(), velocity = zero_vector<N>();  // rad/s, principal axes; m/s, world

        End(const Group& group, const Side& of) : side{of} {
            if (of.body < 0) return;
            place = group.place_of(of.body);
            if (place < 0) {
                axes = Axes<N>::of(group.bodies.state[of.body].q_wb.value());
                return;
            }
            const auto& stage = group.stage[place];
            axes = Axes<N>::of(stage.q_wb);
            spin_b = group.spin_at(stage, of.body);
            velocity = group.velocity_at(stage);
        }
        [[nodiscard]] Direction axis(int k) const {
            const Direction own{side.axis[k]};
            return side.body < 0 ? own : axes.to_world(own);
        }
        [[nodiscard]] Vector to_world(const Vector& v) const {
            return {dot(work_unit<N>(axes.row[0]), v), dot(work_unit<N>(axes.row[1]), v),
                    dot(work_unit<N>(axes.row[2]), v)};
        }
        [[nodiscard]] Vector to_body(const Vector& v) const {
            Vector own = zero_vector<N>();
            for (int i = 0; i < 3; ++i) own += scaled_by(work_unit<N>(axes.row[i]), v[i]);
            return own;
        }
        [[nodiscard]] Vector arm() const { return to_world(side.arm); }
        [[nodiscard]] Vector spin() const { return place < 0 ? zero_vector<N>() : to_world(spin_b); }
        // About the first axis of this side.
        [[nodiscard]] Work rate() const { return place < 0 ? Work(0) : Work(dot(work_unit<N>(side.axis[0]), spin_b)); }
        // N m, in principal axes.
        void add_own_torque(const Group& group, const Vector& torque) const {
            if (place >= 0)
                group.turn(place, Group::L::Vector::of(torque[0], torque[1], torque[2]),
                           Group::L::factor(group.seconds));
        }
        void add_torque(const Group& group, const Vector& torque) const {
            if (place >= 0) add_own_torque(group, to_body(torque));
        }
        // At an arm from the centre of mass, world.
        void add_force(const Group& group, const Vector& force, const Vector& arm) const {
            if (place < 0) return;
            const Vector own = to_body(arm);
            group.push(place, Group::L::Vector::of(force[0], force[1], force[2]), Group::L::factor(group.seconds),
                       Group::L::Vector::of(own[0], own[1], own[2]));
        }
    };

    // Notes which bodies feel them.
    TUMBLE_COLD constexpr void note(const auto& all) {
        for (int b = 0; b < bodies; ++b) acts_[b] = couples_[b] = false;
        is_damped_ = false;
        for (const Entry& entry : entry_) {
            if (!entry.is_on) continue;
            is_damped_ = is_damped_ || entry.damping[0] > Work(0) || entry.damping[1] > Work(0);
            const auto moves = [&](int side) {
                const int b = entry.side[side].body;
                return b >= 0 && !all.constants[b].fixed();
            };
            for (int side = 0; side < 2; ++side) {
                if (!moves(side)) continue;
                acts_[entry.side[side].body] = true;
                if (moves(1 - side)) couples_[entry.side[side].body] = true;
            }
        }
    }
    [[nodiscard]] static Work strength(const Entry& entry, int i, Work at, Work rate) {
        return -(entry.stiffness[i] * (at - entry.rest[i]) + entry.damping[i] * rate);
    }
    // The angle of the direction (x, y), in (-pi, pi]; 0 of no direction. Of the quotient t of the smaller and the
    // larger, or of (t - 1) / (t + 1), which is below tan(pi / 8), by the series t - t^3 / 3 + t^5 / 5 .., to rounding.
    [[nodiscard]] static Work angle_of(Work y, Work x) {
        static constexpr int terms = std::is_same_v<Work, double> ? 20 : 11;
        static constexpr Stored<Work, terms> coefficient = [] {
            Stored<Work, terms> of{};
            for (int i = 0; i < terms; ++i)
                of.set(i, N::template constant<Work>(Real{1} / Real{i % 2 == 0 ? 2 * i + 1 : -2 * i - 1}));
            return of;
        }();
        static constexpr Work half = N::template constant<Work>(Real::scaled(0x3243f6a8885a308d, -60)),
                              eighth_tangent = N::template constant<Work>(0.41421356);
        const Work width = magnitude_of(x), height = magnitude_of(y);
        const bool is_steep = width < height;
        const Work larger = is_steep ? height : width;
        if (!(larger > Work(0))) return Work(0);
        Work t = (is_steep ? width : height) / larger;
        const bool is_far = t > eighth_tangent;
        if (is_far) t = (t - Work(1)) / (t + Work(1));
        const Work square = t * t;
        Work sum = coefficient[terms - 1];
        for (int i = terms - 2; i >= 0; --i) sum = sum * square + coefficient[i];
        const Work quarter = N::half_of(half);
        Work angle = t * sum;
        if (is_far) angle += N::half_of(quarter);
        if (is_steep) angle = quarter - angle;
        if (x < Work(0)) angle = half - angle;
        return y < Work(0) ? -angle : angle;
    }
    // From one direction to another about an axis.
    [[nodiscard]] static Work angle(const Direction& from, const Direction& to, const Direction& about) {
        return angle_of(N::work(narrow<Unit>(dot(cross<Unit>(from, to), about))), N::work(narrow<Unit>(dot(from, to))));
    }
    template <class Group>
    static void turn(const Group& group, const Entry& entry, const End<Group>& own, const End<Group>& other) {
        if (entry.along == Along::turn) {
            // Both bodies have the axis: nothing is turned into the world.
            const Work torque =
                strength(entry, 0, angle(other.axis(1), own.axis(1), own.axis(0)), own.rate() - other.rate());
            own.add_own_torque(group, scaled_by(work_unit<N>(own.side.axis[0]), torque));
            other.add_own_torque(group, scaled_by(work_unit<N>(other.side.axis[0]), -torque));
            return;
        }
        const Vector rate = own.spin() - other.spin();
        Vector torque = zero_vector<N>();
        if (entry.along == Along::whole_turn) {
            // Of the turn R by the angle a about n: sum of axes e x (R e) = 2 sin(a) n, and 1 + 2 cos(a) is its trace.
            Vector twice_sine = zero_vector<N>();
            Work trace(0);
            const Direction of_own[3] = {own.axis(0), own.axis(1), cross<Unit>(own.axis(0), own.axis(1))},
                            of_other[3] = {other.axis(0), other.axis(1), cross<Unit>(other.axis(0), other.axis(1))};
            for (int i = 0; i < 3; ++i) {
                twice_sine += work_unit<N>(cross<Unit>(of_other[i], of_own[i]));
                trace += N::work(narrow<Unit>(dot(of_other[i], of_own[i])));
            }
            const Work sine = N::half_of(Work(sqrt(Work(dot(twice_sine, twice_sine)))));
            const Work whole = angle_of(sine, N::half_of(Work(trace - Work(1))));
            torque = scaled_by(rate, -entry.damping[0]);
            if (sine > Work(0)) torque += scaled_by(twice_sine, -N::half_of(Work(entry.stiffness[0] * whole / sine)));
        } else {
            const Direction axis = own.axis(0), other_axis = other.axis(0);
            const Vector about = work_unit<N>(axis), about_other = work_unit<N>(other_axis);
            torque = scaled_by(about, strength(entry, 0, angle(other_axis, own.axis(1), axis), dot(about, rate))) +
                     scaled_by(about_other,
                               strength(entry, 1, -angle(axis, other.axis(1), other_axis), dot(about_other, rate)));
        }
        own.add_torque(group, torque);
        other.add_torque(group, -torque);
    }
    template <class Group>
    static void pull(const Group& group, const Entry& entry, const End<Group>& own, const End<Group>& other) {
        const Vector arm = own.arm();
        Vector between;  // the centres of mass, or the world's anchor
        for (int i = 0; i < 3; ++i) {
            const auto x = own.place >= 0 ? group.stage[own.place].x_w[i] : place_of(group, entry, 0, i);
            const auto y = other.place >= 0 ? group.stage[other.place].x_w[i] : place_of(group, entry, 1, i);
            between[i] = N::apart(x, y);
        }
        const Vector other_arm = entry.side[1].body < 0 ? zero_vector<N>() : other.arm();
        const Vector reach = between + arm - other_arm;  // from the other's anchor to the body's
        Vector along = entry.along == Along::slide ? work_unit<N>(other.axis(0)) : reach;
        Work length(0);
        if (entry.along == Along::line) {
            length = sqrt(Work(dot(reach, reach)));
            if (!(length > Work(0))) return;  // no direction: no force
            along = scaled_by(reach, Work(1) / length);
        } else {
            length = dot(along, reach);
        }
        // The other side's point at the place of the body's anchor.
        const Vector at_own = other_arm + reach;
        const Vector rate =
            own.velocity + cross<Work>(own.spin(), arm) - other.velocity - cross<Work>(other.spin(), at_own);
        const Vector force = scaled_by(along, strength(entry, 0, length, dot(along, rate)));
        own.add_force(group, force, arm);
        other.add_force(group, -force, at_own);
    }
    [[nodiscard]] static typename N::PositionSum place_of(const auto& group, const Entry& entry, int side, int i) {
        const int b = entry.side[side].body;
        return b < 0 ? entry.anchor[i] : N::sum(group.bodies.state[b].x_w[i]);
    }

    Entry entry_[joints]{};
    bool acts_[bodies]{}, couples_[bodies]{};
    bool is_damped_ = false;
};

}  // namespace tumble

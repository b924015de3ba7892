// BegunForces: forces and torques that events have begun and not ended, constant in the world's frame or the body's.
// For Features::forces.
#pragma once

#include <tumble/events/event.hpp>
#include <tumble/loads/loaded_group.hpp>
#include <tumble/scene.hpp>

namespace tumble {

// Those of each body of a world with so many bodies. They add up, and the last end leaves nothing.
template <class N, bool rotation, int bodies>
class BegunForces {
    using L = LoadNumbers<N>;
    using Block = VectorBlock<N>;
    using Work = typename N::Work;

public:
    // Adds a force or torque, or takes it away again; the end of one that has not begun is misuse: it is taken
    // from the others, and does nothing where there are none. `seconds`: of a step.
    template <bool angular>
    void begin_or_end(const auto& all, int b, Frame frame, const Block& value, const Block& point, Work seconds,
                      bool ends) {
        Sums& sums = of_[b];
        detail::Push<N> push;
        detail::take_push<N, angular>(push, all, b, frame, value, point);
        push.value.multiply_by(seconds);
        if (ends && sums.count <= 1) sums = {};
        else sums.template add<angular>(all, b, push, ends);
    }

    // Ends all.
    void clear() {
        for (Sums& sums : of_) sums = {};
    }

    // As each load has it: loads/load.hpp.
    constexpr void set_body(int b, const BodySpec&, const auto&, const auto&) { of_[b] = {}; }
    // Likewise.
    [[nodiscard]] bool acts_on(const auto&, int b) const { return of_[b].count > 0; }
    // Likewise.
    [[nodiscard]] bool turns(const auto&, [[maybe_unused]] int b) const {
        if constexpr (rotation) return of_[b].turning.acts();
        else return false;
    }
    // Likewise.
    template <class Group>
    void apply_to(const Group& group) const {
        for (int k = 0; k < group.count; ++k) {
            const Sums& sums = of_[group.id[k]];
            if (sums.count == 0) continue;
            L::add(group.kick[k].linear, sums.change, group.bodies.scale);
            if constexpr (Group::rotation)
                if (group.rotates(k)) sums.turning.apply_to(group, k);
        }
    }
    // Likewise.
    static void each(auto& forces, auto& archive) { archive(forces.of_); }

private:
    [[gnu::noinline]] static void add_to(Block& sum, const Block& v) { sum = sum + v; }
    // The sums of torques, of forces in the body's frame and of forces at a point, N s and N m s in a step. They are in
    // principal axes, or in the world's frame where that is said. A force in the world's frame at a point turns the
    // body by the cross products of the axes with its moments.
    struct Turning {
        Block force{};   // at the centre of mass
        Block torque{};  // with that of the forces in the body's frame
        Block torque_in_world{};
        Block moment[3]{};  // in the world's frame: a component of the point times the force

        static void each(auto& turning, auto& archive) {
            archive(turning.force, turning.torque, turning.torque_in_world, turning.moment);
        }
        [[nodiscard]] bool acts() const {
            bool any = !(force.is_zero() && torque.is_zero() && torque_in_world.is_zero());
            for (const Block& m : moment) any = any || !m.is_zero();
            return any;
        }
        template <class Group>
        void apply_to(const Group& group, int k) const {
            const auto& q = group.stage[k].q_wb;
            if (!force.is_zero()) group.push(k, L::rotated(q, force), L::one());
            Block all = torque;
            if (!torque_in_world.is_zero()) add_to(all, L::rotated_back(q, torque_in_world));
            for (int i = 0; i < 3; ++i)
                if (!moment[i].is_zero())
                    add_to(all, L::cross(Block::of(i == 0, i == 1, i == 2), L::rotated_back(q, moment[i])));
            if (!all.is_zero()) group.turn(k, all);
        }
    };
    struct Sums {
        int count = 0;                     // of those that have begun
        typename N::DriftSum change[3]{};  // of drift in a step by forces in the world's frame, in the units of L::add
        [[no_unique_address]] If<rotation, Turning, 0> turning{};

        static void each(auto& sums, auto& archive) {
            archive(sums.count, sums.change);
            if constexpr (requires { archive.require(true); }) archive.require(sums.count >= 0 && sums.count < 1 << 30);
            if constexpr (rotation) archive(sums.turning);
        }
        template <bool angular>
        void add(const auto& all, int b, const detail::Push<N>& push, bool ends) {
            const bool in_body = push.frame == Frame::body;
            count += ends ? -1 : 1;
            if (!angular && !in_body) {
                typename N::DriftSum by[3]{};
                L::add(by, push.value, L::factor(all.constants[b].drift_per_impulse()), all.scale);
                for (int i = 0; i < 3; ++i) change[i] = ends ? change[i] - by[i] : change[i] + by[i];
            }
            if constexpr (rotation) {
                const Block value = ends ? -push.value : push.value;
                if (angular) return add_to(in_body ? turning.torque : turning.torque_in_world, value);
                if (in_body) add_to(turning.force, value);
                if (push.at_centre) return;
                if (in_body) return add_to(turning.torque, cross(push.point, value));
                const auto point = push.point.template as<Work>();
                for (int i = 0; i < 3; ++i) add_to(turning.moment[i], value.times(point[i]));
            }
        }
    };

    Sums of_[bodies]{};
};

}  // namespace tumble

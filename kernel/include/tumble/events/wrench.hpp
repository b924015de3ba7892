// Wrenches: forces and torques that events set. Each body has a force and a torque that hold, a sum of those that have
// begun and not ended, and a sum of those for the next step alone. A step takes them as one change of drift and turn,
// which is constant in the step: exact for a force in the world's frame at the centre of mass, like gravity, and of
// order 2 for all others.
#pragma once

#include <tumble/events/event.hpp>
#include <tumble/scene.hpp>

namespace tumble {

// `begins`: forces and torques may begin and end beside those that hold.
template <class N, bool rotation, int capacity, bool begins>
class Wrenches {
public:
    using Work = typename N::Work;
    using Kick = tumble::Kick<N, rotation>;
    using Block = VectorBlock<N>;

    constexpr explicit Wrenches(Real step)
        : seconds{N::template constant<Work>(step)}, steps_per_second{N::template constant<Work>(Real{1} / step)} {}

    // Takes over a force or torque of a body that is not fixed, for the next step alone. `point`: in the user's axes.
    template <bool angular, class Bodies>
    void add(Bodies& bodies, int b, Frame frame, const Block& value, const Block& point) {
        if constexpr (capacity == 1) b = 0;  // every address is known
        Body& body = body_[b];
        detail::Push<N> push;
        detail::take_push<N, angular>(push, bodies, b, frame, value, point);
        push.value.multiply_by(seconds);
        body.acts = body.has_next = true;
        add_in_the_middle<angular>(body.next, bodies, b, push);
    }
    // The same for all steps from the next one on.
    template <bool angular, class Bodies>
    void set(Bodies& bodies, int b, Frame frame, const Block& value, const Block& point) {
        if constexpr (capacity == 1) b = 0;
        Body& body = body_[b];
        Lasting& lasting = angular ? body.torque : body.force;
        const bool at_centre = angular || point.is_zero();
        detail::require_rotation<angular>(bodies, b, frame, at_centre);
        lasting.is_set = !value.is_zero();
        body.acts = body.has_next | body.is_set();
        // The change of drift or turn depends on the orientation.
        if (angular ? frame == Frame::world : frame == Frame::body || !at_centre) {
            if (lasting.is_set) return turn_with_the_body<angular>(bodies, b, frame, value, point);
        }
        if (lasting.turns) forget(lasting);
        bool within = true;
        const auto set = [&](auto& to) {
            return [&](int i, auto change, auto is_small) __attribute__((always_inline)) {
                if constexpr (is_small) to[i] = change;
                else to[i] = N::limited(change, within);
            };
        };
        const auto& constants = bodies.constants[b];
        if constexpr (!angular) {
            value.times(seconds).each_drift(constants.drift_per_impulse(), bodies.scale, false,
                                            set(body.steady.linear));
        } else if constexpr (rotation) {
            bodies.in_principal_axes(b, value).times(seconds).each_turn(constants.units, bodies.scale, false,
                                                                        set(body.steady.angular));
        }
        if (!within) bodies.report(Issue::range_left, b);
    }
    // Adds a force or torque to those that have begun, or takes it away again. The last end leaves nothing; one without
    // a beginning does nothing.
    template <bool angular, class Bodies>
    [[gnu::noinline]] void begin_or_end(const Bodies& bodies, int b, Frame frame, const Block& value,
                                        const Block& point, bool ends) requires begins {
        if constexpr (capacity == 1) b = 0;
        Body& body = body_[b];
        detail::Push<N> push;
        detail::take_push<N, angular>(push, bodies, b, frame, value, point);
        push.value.multiply_by(seconds);
        if (ends && body.begun.count <= 1) body.begun = {};
        else body.begun.template add<angular>(bodies, b, push, ends);
        body.acts = body.has_next || body.is_set();
    }
    // Call when a body has been removed.
    void forget(int b) { body_[b] = {}; }
    // Calls visit with the members that a snapshot holds.
    template <class Self, class Visit>
    static void each(Self& self, Visit& visit) {
        for (auto& body : self.body_) visit(body);
    }
    // Call when the step begins.
    template <class Bodies>
    TUMBLE_INLINE void start_step(Bodies& bodies) {
        for (int b = 0; b < bodies.count; ++b)
            if (body_[b].varies()) add_up(bodies, b);
    }
    // Call when the step ends.
    TUMBLE_INLINE void end_step(int count) {
        for (int b = 0; b < count; ++b)
            if (body_[b].varies()) forget_next(body_[b]);
    }
    // True of a body on which a force or torque acts in this step.
    [[nodiscard]] TUMBLE_INLINE bool act_on(int b) const { return body_[b].acts; }
    // The change of drift in this step.
    [[nodiscard]] TUMBLE_INLINE const auto& drift(int b) const { return kick(b).linear; }
    // The change of turn in a step, at the present orientation; `room` may hold it.
    [[nodiscard]] TUMBLE_INLINE const auto& turn([[maybe_unused]] const auto& bodies, int b,
                                                 [[maybe_unused]]
                                                 typename N::TurnSum (&room)[3]) const requires rotation {
        if constexpr (begins)
            if (body_[b].begun.turning.has_torque()) {
                for (int i = 0; i < 3; ++i) room[i] = kick(b).angular[i];
                body_[b].begun.add_turn(room, bodies, b);
                return std::as_const(room);
            }
        return kick(b).angular;
    }

    Work seconds, steps_per_second;  // of a step

private:
    // What is constant in this step.
    [[nodiscard]] TUMBLE_INLINE const Kick& kick(int b) const {
        return body_[b].varies() ? body_[b].next : body_[b].steady;
    }
    struct Lasting {
        bool is_set = false, turns = false;  // not zero; its change of the motion depends on the orientation
        detail::Push<N> push{};              // of a step: N s or N m s; kept where it turns

        // Calls visit with the members that a snapshot holds.
        template <class Self, class Visit>
        static void each(Self& self, Visit& visit) {
            visit(self.is_set, self.turns, self.push);
        }
    };
    // Sums of those that depend on the orientation, N s or N m s in a step. A force in the world's frame at a point
    // turns the body by the cross products of the principal axes with its moments.
    struct Turning {
        Block force{};      // in the body's frame, at the centre of mass
        Block torque{};     // in the world's frame
        Block moment[3]{};  // in the world's frame: a principal component of the point times the force

        // Calls visit with the members that a snapshot holds.
        template <class Self, class Visit>
        static void each(Self& self, Visit& visit) {
            visit(self.force, self.torque, self.moment);
        }

        [[nodiscard]] bool has_torque() const {
            return !(torque.is_zero() && moment[0].is_zero() && moment[1].is_zero() && moment[2].is_zero());
        }
    };
    // Forces and torques that have begun and not ended.
    struct Begun {
        int count = 0;
        Kick kick{};  // by those that do not depend on the orientation
        [[no_unique_address]] If<rotation, Turning, 0> turning{};

        // Calls visit with the members that a snapshot holds.
        template <class Self, class Visit>
        static void each(Self& self, Visit& visit) {
            visit(self.count, self.kick);
            if constexpr (rotation) visit(self.turning);
        }

        template <bool angular>
        void add(const auto& bodies, int b, const detail::Push<N>& push, bool ends) {
            const auto& constants = bodies.constants[b];
            const auto change = [&](auto& sum) {
                return [&](int i, auto by, auto) { sum[i] = N::held_sum(sum[i], ends ? decltype(by){} - by : by); };
            };
            count += ends ? -1 : 1;
            if constexpr (!angular)
                if (push.frame == Frame::world)
                    push.value.each_drift(constants.drift_per_impulse(), bodies.scale, false, change(kick.linear));
            if constexpr (rotation) {
                const auto add_to = [&](Block& sum, const Block& v) { sum = sum + (ends ? -v : v); };
                const auto turn = [&](const Block& v) {
                    v.each_turn(constants.units, bodies.scale, false, change(kick.angular));
                };
                if constexpr (angular) {
                    if (push.frame == Frame::world) add_to(turning.torque, push.value);
                    else turn(push.value);
                } else {
                    if (push.frame == Frame::body) add_to(turning.force, push.value);
                    if (push.at_centre) return;
                    if (push.frame == Frame::body) return turn(cross(push.point, push.value));
                    const auto point = push.point.template as<Work>();
                    for (int i = 0; i < 3; ++i) add_to(turning.moment[i], push.value.times(point[i]));
                }
            }
        }
        // Adds the change of drift and turn in this step but for add_turn(). A force in the body's frame acts in the
        // orientation of the middle, the angle u ahead to second order: half of 1 + (1 + u x)^2.
        void add_to(Kick& sum, [[maybe_unused]] const auto& bodies, [[maybe_unused]] int b) const {
            for (int i = 0; i < 3; ++i) {
                sum.linear[i] = N::held_sum(sum.linear[i], kick.linear[i]);
                if constexpr (rotation) sum.angular[i] = N::held_sum(sum.angular[i], kick.angular[i]);
            }
            if constexpr (rotation) {
                if (turning.force.is_zero()) return;
                const auto u = detail::half_turn<N>(bodies, b);
                (turning.force + turning.force.turned(u).turned(u))
                    .times(N::half_of(Work(1)))
                    .rotated(bodies.state[b].q_wb.value())
                    .each_drift(bodies.constants[b].drift_per_impulse(), bodies.scale, false, add_in(sum.linear));
            }
        }
        // Adds the change of turn in a step, at the present orientation.
        [[gnu::noinline]] void add_turn(typename N::TurnSum (&sum)[3], const auto& bodies, int b) const {
            const auto q = bodies.state[b].q_wb.value();
            Block torque_b = turning.torque.rotated_back(q);
            for (int i = 0; i < 3; ++i)
                if (!turning.moment[i].is_zero())
                    torque_b = torque_b + cross(Block::of(i == 0, i == 1, i == 2), turning.moment[i].rotated_back(q));
            torque_b.each_turn(bodies.constants[b].units, bodies.scale, false, add_in(sum));
            [[maybe_unused]] bool within = true;  // else the spin leaves its range, too
            for (int i = 0; i < 3; ++i) sum[i] = N::limited(sum[i], within);
        }
        [[nodiscard]] static auto add_in(auto& sum) {
            return [&](int i, auto change, auto) { sum[i] = N::held_sum(sum[i], change); };
        }
    };
    struct Body {
        bool acts = false, has_next = false;
        Lasting force{}, torque{};
        [[no_unique_address]] If<begins, Begun, 0> begun{};
        Kick steady{};  // by what does not turn with the body
        Kick next{};    // in the next step, where it varies

        // Calls visit with the members that a snapshot holds.
        template <class Self, class Visit>
        static void each(Self& self, Visit& visit) {
            visit(self.acts, self.has_next, self.force, self.torque, self.steady, self.next);
            if constexpr (begins) visit(self.begun);
        }

        [[nodiscard]] TUMBLE_INLINE bool has_begun() const {
            if constexpr (begins) return begun.count > 0;
            else return false;
        }
        [[nodiscard]] TUMBLE_INLINE bool is_set() const { return force.is_set || torque.is_set || has_begun(); }
        [[nodiscard]] TUMBLE_INLINE bool varies() const {
            return has_next || force.turns || torque.turns || has_begun();
        }
    };

    template <bool angular, class Bodies>
    [[gnu::noinline]] void turn_with_the_body(const Bodies& bodies, int b, Frame frame, const Block& value,
                                              const Block& point) {
        if constexpr (capacity == 1) b = 0;
        Body& body = body_[b];
        Lasting& lasting = angular ? body.torque : body.force;
        detail::take_push<N, angular>(lasting.push, bodies, b, frame, value, point);
        lasting.push.value.multiply_by(seconds);
        lasting.turns = true;
        for (int i = 0; i < 3; ++i) {
            if constexpr (!angular) body.steady.linear[i] = {};
            else if constexpr (rotation) body.steady.angular[i] = {};
        }
    }
    [[gnu::noinline]] static void forget(Lasting& lasting) {
        lasting.push = {};
        lasting.turns = false;
    }
    // True of a push whose change of drift or turn depends on the orientation.
    template <bool angular>
    [[nodiscard]] TUMBLE_INLINE static bool turns_with_the_body(const detail::Push<N>& push) {
        const bool turns = angular ? push.frame == Frame::world : push.frame == Frame::body || !push.at_centre;
        return turns && !push.value.is_zero();
    }
    template <bool angular, class Bodies>
    [[gnu::noinline]] static void add_in_the_middle(Kick& kick, const Bodies& bodies, int b,
                                                    const detail::Push<N>& push) {
        Vec3<typename N::Unit> u;
        const Vec3<typename N::Unit>* ahead = nullptr;
        if constexpr (rotation) {
            if (turns_with_the_body<angular>(push)) {
                u = detail::half_turn<N>(bodies, b);
                ahead = &u;
            }
        }
        const auto add = [](auto& to) { return [&](int i, auto change, auto) { to[i] = N::held_sum(to[i], change); }; };
        const auto& constants = bodies.constants[b];
        detail::resolve<N, angular>(
            bodies, b, push, ahead,
            [&](const Block& p_w) {
                p_w.each_drift(constants.drift_per_impulse(), bodies.scale, false, add(kick.linear));
            },
            [&]([[maybe_unused]] const Block& p_b) {
                if constexpr (rotation) p_b.each_turn(constants.units, bodies.scale, false, add(kick.angular));
            });
    }
    template <class Bodies>
    [[gnu::noinline]] void add_up(Bodies& bodies, int b) {
        Body& body = body_[b];
        if (body.force.turns) add_in_the_middle<false>(body.next, bodies, b, body.force.push);
        if (body.torque.turns) add_in_the_middle<true>(body.next, bodies, b, body.torque.push);
        if (body.has_begun())
            if constexpr (begins) body.begun.add_to(body.next, bodies, b);
        bool within = true;
        for (int i = 0; i < 3; ++i) {
            body.next.linear[i] = N::limited(N::held_sum(body.next.linear[i], body.steady.linear[i]), within);
            if constexpr (rotation)
                body.next.angular[i] = N::limited(N::held_sum(body.next.angular[i], body.steady.angular[i]), within);
        }
        if (!within) bodies.report(Issue::range_left, b);
    }
    static void forget_next(Body& body) {
        body.next = {};
        body.has_next = false;
        body.acts = body.is_set();
    }

    Body body_[capacity]{};
};

}  // namespace tumble

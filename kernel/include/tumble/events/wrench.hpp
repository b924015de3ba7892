// Wrenches: forces and torques that a program sets while a world runs. Each body has a force and a torque that last,
// and a sum of those for the next step alone. A step takes them as one change of drift and turn, which is constant in
// the step: exact for a force in the world's frame at the centre of mass, like gravity, and of order 2 for all others.
#pragma once

#include <tumble/events/event.hpp>

namespace tumble {

template <class N, bool rotation, int capacity>
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
    // The change of drift and turn in this step.
    [[nodiscard]] TUMBLE_INLINE const Kick& kick(int b) const {
        return body_[b].varies() ? body_[b].next : body_[b].steady;
    }

    Work seconds, steps_per_second;  // of a step

private:
    struct Lasting {
        bool is_set = false, turns = false;  // not zero; its change of the motion depends on the orientation
        detail::Push<N> push{};              // of a step: N s or N m s; kept where it turns

        // Calls visit with the members that a snapshot holds.
        template <class Self, class Visit>
        static void each(Self& self, Visit& visit) {
            visit(self.is_set, self.turns, self.push);
        }
    };
    struct Body {
        bool acts = false, has_next = false;
        Lasting force{}, torque{};
        Kick steady{};  // by what does not turn with the body
        Kick next{};    // in the next step, where it varies

        // Calls visit with the members that a snapshot holds.
        template <class Self, class Visit>
        static void each(Self& self, Visit& visit) {
            visit(self.acts, self.has_next, self.force, self.torque, self.steady, self.next);
        }

        [[nodiscard]] TUMBLE_INLINE bool is_set() const { return force.is_set || torque.is_set; }
        [[nodiscard]] TUMBLE_INLINE bool varies() const { return has_next || force.turns || torque.turns; }
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

// Wrenches: forces and torques that a program sets while a world runs. Each body has a force and a torque that hold,
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

    constexpr explicit Wrenches(Real step)
        : seconds{N::template constant<Work>(step)}, steps_per_second{N::template constant<Work>(Real{1} / step)} {}

    // Takes over a force or torque of a body that is not fixed.
    template <class Bodies>
    void set(Bodies& bodies, int b, detail::Push<N> push, bool holds) {
        Body& body = body_[b];
        push.value = push.value.times(seconds);
        if (!holds) {
            body.acts = body.has_next = true;
            add_in_the_middle(body.next, bodies, b, push);
            return;
        }
        (push.angular ? body.torque_turns : body.force_turns) = turns_with_the_body(push);
        (push.angular ? body.torque : body.force) = push;
        body.acts = body.has_next || body.holds();
        // A steady force changes the drift alone, a steady torque the turn alone.
        const bool is_steady = !turns_with_the_body(push);
        bool within = true;
        for (int i = 0; i < 3; ++i) {
            if (!push.angular) body.steady.linear[i] = {};
            if constexpr (rotation)
                if (push.angular) body.steady.angular[i] = {};
        }
        if (is_steady && !push.value.is_zero())
            detail::resolve(
                bodies, b, push, nullptr,
                [&](int i, auto change) { body.steady.linear[i] = N::limited(change, within); },
                [&]([[maybe_unused]] auto&& change) {
                    if constexpr (rotation)
                        for (int i = 0; i < 3; ++i)
                            body.steady.angular[i] = N::limited(change(i, bodies.scale), within);
                });
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
    struct Body {
        bool acts = false, has_next = false, force_turns = false, torque_turns = false;
        detail::Push<N> force{}, torque{true, Frame::body, {}, true, {}};  // of a step: N s, N m s
        Kick steady{};                                                     // by what does not turn with the body
        Kick next{};                                                       // in the next step, where it varies

        // Calls visit with the members that a snapshot holds.
        template <class Self, class Visit>
        static void each(Self& self, Visit& visit) {
            visit(self.acts, self.has_next, self.force_turns, self.torque_turns, self.force, self.torque, self.steady,
                  self.next);
        }

        [[nodiscard]] bool holds() const { return !force.value.is_zero() || !torque.value.is_zero(); }
        [[nodiscard]] TUMBLE_INLINE bool varies() const { return has_next || force_turns || torque_turns; }
    };

    // True of a push whose change of drift or turn depends on the orientation.
    [[nodiscard]] static bool turns_with_the_body(const detail::Push<N>& push) {
        if (push.value.is_zero()) return false;
        return push.angular ? push.frame == Frame::world : push.frame == Frame::body || !push.at_centre;
    }
    template <class Bodies>
    [[gnu::noinline]] static void add_in_the_middle(Kick& kick, const Bodies& bodies, int b,
                                                    const detail::Push<N>& push) {
        Vec3<typename N::Unit> u;
        const Vec3<typename N::Unit>* ahead = nullptr;
        if constexpr (rotation) {
            if (turns_with_the_body(push)) {
                u = detail::half_turn<N>(bodies, b);
                ahead = &u;
            }
        }
        detail::resolve(
            bodies, b, push, ahead, [&](int i, auto change) { kick.linear[i] = N::held_sum(kick.linear[i], change); },
            [&]([[maybe_unused]] auto&& change) {
                if constexpr (rotation)
                    for (int i = 0; i < 3; ++i) kick.angular[i] = N::held_sum(kick.angular[i], change(i, bodies.scale));
            });
    }
    template <class Bodies>
    [[gnu::noinline]] void add_up(Bodies& bodies, int b) {
        Body& body = body_[b];
        if (body.force_turns) add_in_the_middle(body.next, bodies, b, body.force);
        if (body.torque_turns) add_in_the_middle(body.next, bodies, b, body.torque);
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
        body.acts = body.holds();
    }

    Body body_[capacity]{};
};

}  // namespace tumble

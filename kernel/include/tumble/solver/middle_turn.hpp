// How far a body turns until the middle of a flight.
#pragma once

#include <tumble/numbers/systems.hpp>

namespace tumble {

// A rotation R in Cayley's form. With t half of its vector, R^T v = v - 2 / (1 + t^2) (t x v - t x (t x v)). It keeps
// lengths. Its angle is off by t^2 / 3 of itself.
template <class N>
class MiddleTurn {
public:
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;
    using Work = typename N::Work;

    MiddleTurn() = default;
    // Of a body that turns by `whole` in the flight: rad, principal axes. None where it turns so little that the square
    // of the turn is rounding, or by more than a radian, which no step resolves.
    explicit MiddleTurn(const WorkVec3<N>& whole) {
        bool turns = false;
        for (int i = 0; i < 3; ++i) {
            const Work size = magnitude_of(whole[i]);
            turns = turns || size > C::least_turn();
            if (size > Work(1)) return;
        }
        if (!turns) return;
        for (int i = 0; i < 3; ++i) quarter_[i] = C::unit(N::half_of(N::half_of(whole[i])));
        const Unit root = C::inverse_root_of_one_and(dot(quarter_, quarter_));
        scale_ = C::product(root, root);
    }
    // True where the body turns.
    [[nodiscard]] explicit operator bool() const { return !(scale_ == Unit{}); }
    // A quarter of the turn in the whole flight, rad.
    [[nodiscard]] const Vec3<Unit>& quarter() const { return quarter_; }
    // A vector that stands still in the world, in the axes of the body half a flight later.
    template <class T>
    [[nodiscard]] Vec3<T> later(const Vec3<T>& v) const {
        const Vec3<T> across = cross<T>(quarter_, v), change = cross<T>(quarter_, across) - across;
        Vec3<T> turned;
        for (int i = 0; i < 3; ++i) {
            const T half = narrow<T>(mul(change[i], scale_));
            turned[i] = v[i] + half + half;
        }
        return turned;
    }

private:
    Vec3<Unit> quarter_ = Vec3<Unit>::Constant(Unit{});
    Unit scale_{};  // 1 / (1 + t^2); zero: none
};

}  // namespace tumble

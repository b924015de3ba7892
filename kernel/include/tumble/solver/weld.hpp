// What a manifold transmits, as the six components of a wrench, and how its points share it.
//
// The frame of a manifold is its normal and its two tangents, with the mean of its points as the origin. Its points lie
// in a plane across the normal. So the pushes along the normal carry the normal force and the moments about the
// tangents, and friction carries the rest.
#pragma once

#include <tumble/numbers/moment_numbers.hpp>

namespace tumble {

// Of at most so many points; `grips`: some have friction.
template <class N, int most, bool grips>
class Weld {
public:
    using C = ContactNumbers<N>;
    using W = MomentNumbers<N>;
    using Unit = typename C::Unit;
    using Length = typename C::Length;
    using Lever = typename C::Lever;
    using Speed = typename C::Speed;
    using Moment = typename W::Moment;

    // A force along the normal and the tangents, and its moment about the origin.
    struct Wrench {
        Vec3<Speed> force;
        Moment moment[3];
    };
    // What each point gives along the normal and the tangents.
    using Shares = Speed[most][3];

    // Sets the places of the points along the tangents. False of three or four points that are nearly in a line.
    [[nodiscard]] bool set(const Length (&x)[most], const Length (&z)[most], int count, Length radius) {
        count_ = count;
        if constexpr (is_single) {
            extent_ = Extent::above(radius);
            return true;
        }
        Length farthest{};
        for (int i = 0; i < count; ++i) {
            if (magnitude_of(x[i]) > farthest) farthest = magnitude_of(x[i]);
            if (magnitude_of(z[i]) > farthest) farthest = magnitude_of(z[i]);
        }
        // The lever of a single point, or of points at one place.
        if (!W::is_apart(farthest, radius)) {
            if (count > 1) return false;
            farthest = radius;
        }
        // The sum of the squares of up to 16 parts needs a bit more than that of four.
        extent_ = Extent::above(count > 4 ? farthest + farthest : farthest);
        typename W::Square xx{}, xz{}, zz{};
        for (int i = 0; i < count; ++i) {
            x_[i] = extent_.part(x[i]);
            z_[i] = extent_.part(z[i]);
            xx += W::square(x_[i], x_[i]);
            xz += W::square(x_[i], z_[i]);
            zz += W::square(z_[i], z_[i]);
        }
        // The pushes of least squares are linear in the place: their matrix is that of the sums of squares. Two points
        // carry no moment about their line, and a single one carries none.
        Unit a = W::quarter(xx), b = W::quarter(xz), c = W::quarter(zz);
        auto determinant = mul_sub(mul(a, c), b, b);
        if (count == 1) {
            x_per_moment_[0] = z_per_moment_[0] = Lever{};
            return true;
        }
        if (count == 2) {
            determinant = mul(W::quarter(xx + zz), C::one());
            a = c = C::one();
            b = Unit{};
        } else if (!(determinant > W::hair(mul(a, c)))) {
            return false;
        }
        const typename W::Inverse inverse{determinant};
        for (int i = 0; i < count; ++i) {
            const Unit px = W::unit(x_[i]), pz = W::unit(z_[i]);
            x_per_moment_[i] = inverse.quarter(mul_sub(mul(c, px), b, pz));
            z_per_moment_[i] = inverse.quarter(mul_sub(mul(a, pz), b, px));
            if (!W::fits(x_per_moment_[i]) || !W::fits(z_per_moment_[i])) return false;
        }
        return true;
    }

    // Shares a wrench so that every point pushes and lies inside its cone of friction, but for `beyond`. False where it
    // is not found. `slack`: rounding of a speed.
    [[nodiscard]] bool share(const Wrench& wrench, bool rough, typename C::Friction friction, Speed slack, Speed beyond,
                             Shares& shares) const {
        const Speed normal = wrench.force[0], first = wrench.force[1], second = wrench.force[2];
        const Speed x = -extent_.speed(wrench.moment[2]), z = extent_.speed(wrench.moment[1]);
        const Speed turn = extent_.speed(wrench.moment[0]);
        const auto vanishes = [&](Speed s) { return !(magnitude_of(s) > slack); };
        const bool straight = vanishes(first) && vanishes(second) && vanishes(turn);
        for (int i = 0; i < count_; ++i) shares[i][1] = shares[i][2] = Speed{};
        if (!rough && !straight) return false;
        if (!push(normal, x, z, slack, shares)) return false;
        if (count_ < 3) {
            Speed x_left = x, z_left = z;
            for (int i = 0; !is_single && i < count_; ++i) {
                x_left -= W::speed(mul(x_[i], shares[i][0]));
                z_left -= W::speed(mul(z_[i], shares[i][0]));
            }
            if (!vanishes(x_left) || !vanishes(z_left)) return false;
        }
        for (int i = 0; i < count_; ++i) {
            if (shares[i][0] < -slack) return false;
            if (shares[i][0] < Speed{}) shares[i][0] = Speed{};
        }
        if constexpr (!grips) return straight;
        else return straight || grip(normal, first, second, x, z, turn, friction, slack, beyond, shares);
    }

private:
    using Extent = typename W::Extent;
    // A point at the origin, which carries no moment about the tangents.
    static constexpr bool is_single = most == 1;

    // The pushes: of least squares, or the nearest to them that pull nowhere.
    [[nodiscard]] bool push(Speed normal, Speed x, Speed z, Speed slack, Shares& shares) const {
        if constexpr (is_single) {
            shares[0][0] = normal;
            return true;
        }
        const Speed even = W::template mean<most>(normal, count_);
        bool pulls = false;
        for (int i = 0; i < count_; ++i) {
            const Speed by_moments = W::speed(mul_add(mul(x_per_moment_[i], x), z_per_moment_[i], z));
            shares[i][0] = even + by_moments;
            pulls = pulls || shares[i][0] < -slack;
        }
        if (!pulls) return true;
        if (count_ != 4) return false;
        // Four points push and pull without effect in proportion to the areas of the triangles of the other three.
        const Lever none[4] = {triangle(1, 2, 3), -triangle(0, 2, 3), triangle(0, 1, 3), -triangle(0, 1, 2)};
        for (int i = 0; i < 4; ++i) {
            if (!(shares[i][0] < -slack) || none[i] == Lever{}) continue;
            Speed other[4];
            bool all = true;
            for (int j = 0; j < 4; ++j) {
                other[j] = shares[j][0] - W::times_ratio(shares[i][0], none[j], none[i]);
                all = all && !(other[j] < -slack);
            }
            if (!all) continue;
            for (int j = 0; j < 4; ++j) shares[j][0] = other[j];
            return true;
        }
        return false;
    }
    // A quarter of twice the area of a triangle of points.
    [[nodiscard]] Lever triangle(int i, int j, int k) const {
        return C::half(
            C::half(narrow<Lever>(mul_sub(mul(x_[j] - x_[i], z_[k] - z_[i]), x_[k] - x_[i], z_[j] - z_[i]))));
    }
    // Friction of all points in proportion to their pushes: along the force, and about the centre of pressure. Each
    // point must stay in its cone. This suffices, but some loads that points can carry are not found.
    [[nodiscard]] bool grip(Speed normal, Speed first, Speed second, Speed x, Speed z, Speed turn,
                            typename C::Friction friction, Speed slack, Speed beyond, Shares& shares) const {
        const Speed limit = C::times_friction(friction, normal) + beyond;
        if (!(normal > slack) || mul_add(mul(first, first), second, second) > mul(limit, limit)) return false;
        const Lever along[2] = {W::ratio(first, normal), W::ratio(second, normal)};
        const Speed about = turn - W::speed(mul_sub(mul(along[1], x), along[0], z));
        if (!(magnitude_of(about) > slack)) {
            for (int i = 0; i < count_; ++i)
                for (int k = 0; k < 2; ++k) shares[i][1 + k] = W::speed(mul(along[k], shares[i][0]));
            return true;
        }
        if (is_single || count_ == 1) return false;
        const Lever middle[2] = {W::ratio(x, normal), W::ratio(z, normal)};
        Speed moment{};
        Lever at[most][2];
        for (int i = 0; i < count_; ++i) {
            at[i][0] = x_[i] - middle[0];
            at[i][1] = z_[i] - middle[1];
            for (const Lever l : at[i]) moment += W::speed(mul(l, W::speed(mul(l, shares[i][0]))));
        }
        if (!(moment > slack)) return false;
        const Lever spin = W::ratio(about, moment);
        if (!W::fits(spin)) return false;
        for (int i = 0; i < count_; ++i) {
            const Lever f[2] = {along[0] - narrow<Lever>(mul(spin, at[i][1])),
                                along[1] + narrow<Lever>(mul(spin, at[i][0]))};
            if (shares[i][0] > Speed{} && mul_add(mul(f[0], f[0]), f[1], f[1]) > mul(friction, friction)) return false;
            for (int k = 0; k < 2; ++k) shares[i][1 + k] = W::speed(mul(f[k], shares[i][0]));
        }
        return true;
    }

    Extent extent_;
    int count_ = 0;
    Lever x_[most], z_[most];                        // along the tangents from the origin, in extents
    Lever x_per_moment_[most], z_per_moment_[most];  // the push of a point for the moment that pushes make along x or z
};

}  // namespace tumble

// A body relative to a plane: the gap of its nearest point, and the points that may touch. These are the vertices of a
// box, the two round ends of a capsule, and points on the rims of a cylinder or hoop: the lowest point of each rim, and
// three more of the rim on which it stands.
#pragma once

#include <tumble/scene.hpp>
#include <tumble/shapes/manifold.hpp>
#include <tumble/shapes/shape.hpp>

namespace tumble {

template <class N, Features features>
class PlaneView {
public:
    using C = ContactNumbers<N>;
    using Length = typename C::Length;
    using Unit = typename C::Unit;

    // `height` is the height of the centre. `principal` are the body's principal axes.
    PlaneView(const CollisionShape<N>& shape, const Axes<N>& principal, const Vec3<Unit>& normal, Length height)
        : shape_{shape}, normal_{principal.to_body(normal)}, height_{height} {
        if (features.boxes && shape.is(ShapeKind::box)) {
            const Vec3<Unit> n = shape.turned ? shape.edges.to_body(normal_) : normal_;
            for (int i = 0; i < 3; ++i) reach_[i] = narrow<Length>(mul(n[i], shape.half[i]));
        } else if (features.round_shapes && !shape.is(ShapeKind::sphere)) {
            const Unit upright = narrow<Unit>(dot(normal_, shape.axis));
            reach_[1] = narrow<Length>(mul(upright, shape.half.y()));
            reach_[0] = shape.half.x();
            if (shape.is_round()) {
                // Down the slope of the end face, from its centre: the component of -n across the axis.
                for (int i = 0; i < 3; ++i) down_[i] = narrow<Unit>(mul(upright, shape.axis[i])) - normal_[i];
                const Unit slope = this->slope();
                flat_ = slope == Unit{};
                if (!flat_) down_ = C::direction(down_);
                reach_[0] = narrow<Length>(mul(shape.half.x(), slope));
            }
        } else {
            reach_[0] = shape.half.x();
        }
    }

    // The signed distance of the nearest point.
    [[nodiscard]] Length gap() const {
        Length g = height_;
        for (int i = 0; i < 3; ++i) g -= magnitude_of(reach_[i]);
        return g;
    }

    // The points that are not higher than `band`.
    void find(Manifold<N>& found, Length band) const {
        const auto add = [&](Length gap, const Vec3<Length>& arm) {
            if (!(gap > band)) found.add_lowest({arm, Vec3<Length>::Constant(Length{}), gap});
        };
        if constexpr (features.boxes) {
            if (shape_.is(ShapeKind::box)) {
                for (int corner = 0; corner < 8; ++corner) {
                    Length gap = height_;
                    for (int i = 0; i < 3; ++i) gap += ((corner >> i) & 1) != 0 ? reach_[i] : -reach_[i];
                    if (gap > band) continue;
                    Vec3<Length> arm;
                    for (int i = 0; i < 3; ++i) arm[i] = ((corner >> i) & 1) != 0 ? shape_.half[i] : -shape_.half[i];
                    add(gap, shape_.principal(arm));
                }
                return;
            }
        }
        if constexpr (features.round_shapes) {
            if (shape_.is(ShapeKind::capsule)) {
                for (int end = 0; end < 2; ++end) {
                    const Length up = end == 0 ? shape_.half.y() : -shape_.half.y();
                    const Length rise = end == 0 ? reach_[1] : -reach_[1];
                    add(height_ + rise - shape_.half.x(), along(shape_.axis, up) - along(normal_, shape_.half.x()));
                }
                return;
            }
            if (shape_.is_round()) {
                find_on_rims(add);
                return;
            }
        }
        add(gap(), -along(normal_, shape_.half.x()));
    }

private:
    // The sine of the angle between axis and normal. Zero if the direction down the slope would be only rounding.
    [[nodiscard]] Unit slope() const {
        const Unit slope = C::unit_norm(down_);
        return slope > C::flat() ? slope : Unit{};
    }
    template <class Add>
    void find_on_rims(Add&& add) const {
        // e and f span the end faces. e points down the slope.
        Vec3<Unit> e = down_;
        if (flat_) {
            StoredVec3<Unit> pair[2];
            set_tangents<N>(shape_.axis, pair);
            e = pair[0];
        }
        const Vec3<Unit> f = cross<Unit>(shape_.axis, e);
        const Vec3<Length> radius_e = along(e, shape_.half.x()), radius_f = along(f, shape_.half.x());
        const Length fall = flat_ ? Length{} : reach_[0];
        // A hoop has one rim.
        for (int end = shape_.is(ShapeKind::hoop) ? 1 : 0; end < 2; ++end) {
            const Vec3<Length> centre = along(shape_.axis, end == 0 ? shape_.half.y() : -shape_.half.y());
            const Length height = height_ + (end == 0 ? reach_[1] : -reach_[1]);
            add(height - fall, centre + radius_e);
            const bool stands_on = end == 0 ? reach_[1] < Length{} : !(reach_[1] < Length{});
            if (!stands_on) continue;
            add(height, centre + radius_f);
            add(height, centre - radius_f);
            add(height + fall, centre - radius_e);
        }
    }

    const CollisionShape<N>& shape_;
    Vec3<Unit> normal_;  // principal axes
    Length height_;
    Vec3<Length> reach_ = Vec3<Length>::Constant(Length{});
    Vec3<Unit> down_ = Vec3<Unit>::Constant(Unit{});
    bool flat_ = false;
};

// The points of a round shape on a surface that stands still, while the body turns. The shape rolls, so each stays the
// lowest of its end.
template <class N>
class RollingPoints {
public:
    using C = ContactNumbers<N>;
    using Length = typename C::Length;
    using Unit = typename C::Unit;

    // `normal` of the surface, in the body's principal axes.
    RollingPoints(const CollisionShape<N>& shape, const Vec3<Unit>& normal) : shape_{shape}, down_{-normal} {
        if (!shape.is_round()) return;
        const Unit upright = narrow<Unit>(dot(normal, shape.axis));
        for (int i = 0; i < 3; ++i) {
            down_[i] += narrow<Unit>(mul(upright, shape.axis[i]));
            flat_ = flat_ && !(magnitude_of(down_[i]) > C::flat());
        }
        if (flat_) return;
        down_ = C::direction(down_);
        across_ = cross<Unit>(shape.axis, down_);
    }
    // Down the slope of an end face; of a capsule, against the normal.
    [[nodiscard]] const Vec3<Unit>& down() const { return down_; }
    // `before`: an earlier down(), which has stood still in the world, in the axes of now. False where the lowest point
    // has run round a twelfth of the rim since (29 degrees), as on a coin that falls flat: nothing resolves its way.
    [[nodiscard]] bool rolls_from(const Vec3<Unit>& before) const {
        if (!shape_.is_round()) return true;
        return !flat_ && narrow<Unit>(dot(down_, before)) > C::one() - C::eighth(C::one());
    }
    // Of a point that PlaneView::find() has found at `start`, from where the shape rolls.
    [[nodiscard]] Vec3<Length> place_of(const Vec3<Length>& arm, const RollingPoints& start) const {
        if (!shape_.is_round()) return arm + along(Vec3<Unit>(down_ - start.down_), shape_.half.x());
        return along(shape_.axis, narrow<Length>(dot(shape_.axis, arm))) +
               along(down_, narrow<Length>(dot(start.down_, arm))) +
               along(across_, narrow<Length>(dot(start.across_, arm)));
    }

private:
    const CollisionShape<N>& shape_;
    Vec3<Unit> down_, across_ = Vec3<Unit>::Constant(Unit{});
    bool flat_ = true;
};

}  // namespace tumble

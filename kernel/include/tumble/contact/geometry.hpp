// Where a sphere or a box is relative to a plane: the gap of its nearest point, and its contact points.
// A box is its eight vertices; the nearest one follows from the signs of the normal's components in the box's axes.
#pragma once

#include <tumble/body/mass.hpp>
#include <tumble/loads/wrench.hpp>

namespace tumble {

template <class N>
struct Plane {
    using Work = typename N::Work;

    Vec3<typename N::Unit> normal =
        Vec3<typename N::Unit>::Constant(typename N::Unit{});  // unit; towards the free side
    Work offset{};                                             // m
    Work restitution{}, friction{};                            // negative: the world's default
};

// What touches planes. half: the sphere's radius in the first component; the box's half edges, m.
template <class N>
struct ContactShape {
    ShapeKind kind = ShapeKind::none;  // sphere, box, or none: nothing touches
    WorkVec3<N> half = zero_vector<N>();
    Quat<typename N::Work> principal{};  // principal axes to the box's own
    typename N::Work restitution{}, friction{};
};

// A body's place, in working numbers.
template <class N>
struct Placement {
    typename N::PositionSum x_w[3];
    Quat<typename N::Work> q_wb;
};

template <class N>
class PlaneView {
public:
    using Work = typename N::Work;

    PlaneView(const Placement<N>& place, const ContactShape<N>& shape, const Plane<N>& plane, bool boxes)
        : shape_{shape}, normal_b_{rotate_back(place.q_wb, work_unit<N>(plane.normal))},
          height_{N::along(place.x_w, plane.normal) + plane.offset} {
        if (boxes && shape.kind == ShapeKind::box) {
            const WorkVec3<N> n = rotate(shape.principal, normal_b_);
            for (int i = 0; i < 3; ++i) reach_[i] = n[i] * shape.half[i];
        } else {
            reach_ = {shape.half.x(), Work(0), Work(0)};
        }
    }

    // Signed distance of the nearest point, m.
    [[nodiscard]] Work gap() const {
        Work g = height_;
        for (int i = 0; i < 3; ++i) g -= reach_[i] < Work(0) ? -reach_[i] : reach_[i];
        return g;
    }
    // Calls f(gap, arm in principal axes) for each vertex, or for the sphere's lowest point.
    template <class F>
    void for_each_point(bool boxes, F&& f) const {
        if (!(boxes && shape_.kind == ShapeKind::box)) {
            f(gap(), scaled_by(normal_b_, -shape_.half.x()));
            return;
        }
        for (int corner = 0; corner < 8; ++corner) {
            WorkVec3<N> arm;
            Work g = height_;
            for (int i = 0; i < 3; ++i) {
                const bool positive = ((corner >> i) & 1) != 0;
                arm[i] = positive ? shape_.half[i] : -shape_.half[i];
                g = positive ? g + reach_[i] : g - reach_[i];
            }
            f(g, rotate_back(shape_.principal, arm));
        }
    }
    // The normal in principal axes.
    [[nodiscard]] const WorkVec3<N>& normal_b() const { return normal_b_; }

private:
    const ContactShape<N>& shape_;
    WorkVec3<N> normal_b_;
    Work height_;
    WorkVec3<N> reach_ = zero_vector<N>();
};

}  // namespace tumble

// Narrow phase: the shapes of the bodies, the planes, and the gap, normal and contact points of a pair.
#pragma once

#include <tumble/contact/material.hpp>
#include <tumble/contact/pair.hpp>
#include <tumble/shapes/layers.hpp>
#include <tumble/shapes/pairs.hpp>
#include <tumble/shapes/plane.hpp>
#include <tumble/solver/weights.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class NarrowPhase {
public:
    using Work = typename N::Work;
    using Bodies = tumble::Bodies<N, spin, features.bodies, features.mixed()>;
    using State = typename Bodies::State;
    using C = ContactNumbers<N>;
    using Bounds = ContactBounds<N>;
    using Length = typename C::Length;
    using Speed = typename C::Speed;
    using Pair = tumble::Pair<N, features>;
    using Point = ContactPoint<N, features>;
    using Material = tumble::Material<N, features>;
    using Weights = tumble::Weights<N, features.bodies>;

    constexpr NarrowPhase(Real step, const ContactSpec& spec)
        : materials_{spec}, response_{spec.response}, tolerance_metres_{spec.tolerance} {
        if constexpr (N::fixed_point) (void)make_room(Real{N::Range::velocity} * step);
        (void)make_room(spec.tolerance);
    }

    // Gravity's change of drift in a step.
    constexpr void set_gravity(const typename N::DriftSum (&change)[3], typename N::Scale unit) {
        for (int i = 0; i < 3; ++i) fall_drift_[i] = change[i];
        drift_unit_ = unit;
        set_fall();
        slow_ = speed_of_fall() * Work(Bounds::slow_in_falls);
    }

    // Adds a plane; false when there is no room.
    TUMBLE_COLD constexpr bool add(const PlaneSpec& spec) {
        if (plane_count_ >= features.planes) return false;
        materials_.plane[plane_count_] = Material{spec};
        plane_[plane_count_++] = Plane<N>{spec};
        return true;
    }
    [[nodiscard]] ContactResponse response() const { return response_; }
    [[nodiscard]] constexpr int plane_count() const { return plane_count_; }
    [[nodiscard]] const Plane<N>& plane(int p) const { return plane_[p]; }
    // The band in which bodies touch, and the depth at which a step is redone.
    [[nodiscard]] Length tolerance() const { return tolerance_; }
    // Gravity's change of drift in a step, and the sum of the sizes of its components.
    [[nodiscard]] const StoredVec3<Length>& fall() const { return fall_; }
    [[nodiscard]] Length fall_bound() const { return fall_bound_; }
    // m a step: a slower approach is no impact.
    [[nodiscard]] Work slow() const { return slow_; }

    // Writes or reads what a snapshot holds.
    template <class Archive>
    static void archive(std::conditional_t<Archive::reads, NarrowPhase, const NarrowPhase>& self, Archive& to) {
        to(self.axes_, self.turned_);
    }

    // Sets the collision shape of body b. True where the scale of lengths has changed: lengths from before are invalid
    // then.
    constexpr bool set_shape(int b, const BodySpec& spec, const PrincipalInertia& inertia,
                             const SpinUnits<N, spin>& units) {
        materials_.body[b] = Material{spec};
        layers_.set(b, spec);
        const bool rescaled = make_room(reach_of(spec.shape));
        set_collision_shape<N>(shape_[b], spec, inertia, scale());
        weight_[b].template set<features.mixed()>(spec, inertia, scale(), units);
        return rescaled;
    }
    [[nodiscard]] const CollisionShape<N>& shape(int b) const { return shape_[b]; }
    // Whether the layers of two bodies let them touch.
    [[nodiscard]] TUMBLE_INLINE bool share_a_layer(int a, int b) const { return layers_.meet(a, b); }
    // In the scale of the shapes, where a body has a shape.
    [[nodiscard]] const Weights& weights() const { return weight_; }
    // Of body b when it was placed last.
    [[nodiscard]] const Axes<N>& axes(int b) const { return axes_[features.bodies == 1 ? 0 : b]; }
    [[nodiscard]] constexpr const typename C::LengthScale& scale() const { return shape_.scale(); }
    // From principal axes of body b to the world.
    [[nodiscard]] WorkVec3<N> to_world(int b, const WorkVec3<N>& v) const {
        WorkVec3<N> world;
        for (int i = 0; i < 3; ++i) world[i] = dot(work_unit<N>(axes_[b].row[i]), v);
        return world;
    }
    // m, world, from the centre of mass.
    [[nodiscard]] WorkVec3<N> world_arm(int b, const Vec3<Length>& arm) const {
        return to_world(b, {scale().metres(arm[0]), scale().metres(arm[1]), scale().metres(arm[2])});
    }
    // m, world, of a point halfway between the two surfaces.
    [[nodiscard]] WorkVec3<N> place_of(const Bodies& bodies, const Pair& pair, const Point& point) const {
        const Work up = N::half_of(scale().metres(point.gap));
        return bodies.position(pair.a) + world_arm(pair.a, point.arm) - scaled_by(work_unit<N>(pair.normal), up);
    }
    // Whether a pair of a body with a plane or another body may be in the list of near pairs.
    [[nodiscard]] bool may_touch(const Bodies& bodies, int a, int b) const {
        const auto is_there = [&](int i) { return i < bodies.count && !shape_[i].is(ShapeKind::none); };
        if (!is_there(a) || bodies.constants[a].fixed()) return false;
        if (b < 0) return -1 - b < plane_count_;
        if (!features.pairs || !is_there(b) || b == a || (b < a && !bodies.constants[b].fixed())) return false;
        return touches_bodies(shape_[a].kind) && touches_bodies(shape_[b].kind) &&
               touching_meet(shape_[a].kind, shape_[b].kind) && share_a_layer(a, b);
    }
    // Sets the constants of a new pair.
    void set_up(Pair& pair, [[maybe_unused]] const Bodies& bodies) {
        const Work root_mass = weight_[pair.a].root_mass;
        const Material &a = materials_.body[pair.a],
                       &b = pair.with_plane() ? materials_.plane[pair.plane()] : materials_.body[pair.b];
        pair.share_a = C::one();
        pair.weight = root_mass;
        if (pair.with_plane()) {
            const Plane<N>& plane = plane_[pair.plane()];
            pair.normal = plane.normal;
            if constexpr (features.friction || !features.pairs) {
                pair.tangent[0] = plane.tangent[0];
                pair.tangent[1] = plane.tangent[1];
            }
        } else if constexpr (features.pairs) {
            if (!bodies.constants[pair.b].fixed()) {
                const Work ratio = root_mass * weight_[pair.b].per_root_mass,
                           share = Work(1) / sqrt(Work(1) + ratio * ratio);
                pair.share_a = C::unit(share);
                pair.share_b = C::unit(ratio * share);
                pair.weight = root_mass * share;
            }
            if constexpr (features.moving_surfaces()) note_motion(pair, bodies);
        }
        pair.restitution = C::unit(materials_.restitution(a, b));
        if constexpr (features.friction) {
            const Work friction = materials_.friction(a, b);
            pair.friction = C::friction(friction);
            pair.has_friction = friction > Work(0);
        }
        if constexpr (features.rolling_resistance) {
            set_resistance(pair, a, b);
            pair.has_friction = pair.has_friction || pair.resists_spin();
        }
    }
    // Sets whether the surface moves on which body a may rest.
    void note_motion(Pair& pair, const Bodies& bodies) const requires(features.moving_surfaces()) {
        if (pair.with_plane() || !bodies.constants[pair.b].fixed()) return;
        pair.surface_moves = bodies.moves_by_itself(pair.b) || (features.turntables && bodies.is_turning(pair.b));
    }
    // --- where they are ----------------------------------------------------------------------------------------------

    [[gnu::noinline]] void place(const Bodies& bodies, int b) {
        const Axes<N> axes = Axes<N>::of(bodies.state[b].q_wb.value());
        turned_[b] = !(axes == axes_[b]);
        if (turned_[b]) axes_[b] = axes;
    }
    [[nodiscard]] Length height(const Bodies& bodies, int b, const Plane<N>& plane) const {
        return height(bodies.state[b], plane);
    }
    [[nodiscard]] Length height(const State& s, const Plane<N>& plane) const {
        const typename N::PositionSum x[3] = {N::sum(s.x_w.x), N::sum(s.x_w.y), N::sum(s.x_w.z)};
        return scale().length(N::along(x, plane.normal) + plane.offset);
    }
    // The way of the centre of a body in a step, and a bound on that of its surface by the spin.
    [[nodiscard]] TUMBLE_INLINE Vec3<Length> drift(const Bodies& bodies, int b) const {
        const auto& s = bodies.state[b];
        return {scale().drift(N::sum(s.d_w.x), bodies.scale), scale().drift(N::sum(s.d_w.y), bodies.scale),
                scale().drift(N::sum(s.d_w.z), bodies.scale)};
    }
    [[nodiscard]] TUMBLE_INLINE Length way_of_turn(const Bodies& bodies, int b) const {
        Work turn(0);
        for (int i = 0; i < 3; ++i) turn += magnitude_of(bodies.turn(b, i));
        return scale().length(turn * scale().metres(shape_[b].radius));
    }
    // From the centre of b to that of a.
    [[nodiscard]] Vec3<Length> reach_between(const Bodies& bodies, int a, int b) const {
        return reach_between(bodies.state[a], bodies.state[b]);
    }
    [[nodiscard]] Vec3<Length> reach_between(const State& a, const State& b) const {
        Vec3<Length> reach;
        for (int i = 0; i < 3; ++i) reach[i] = scale().between(N::sum(a.x_w[i]), N::sum(b.x_w[i]));
        return reach;
    }
    [[nodiscard]] PlaneView<N, features> view_of_plane(const Bodies& bodies, const Pair& pair) const {
        const Plane<N>& plane = plane_[pair.plane()];
        return {shape_[pair.a], axes(pair.a), plane.normal, height(bodies, pair.a, plane)};
    }
    [[nodiscard]] PairView<N> view_of(const Bodies& bodies, const Pair& pair) const {
        return view_of(bodies, pair, bodies.state[pair.a]);
    }
    // The same with body a elsewhere.
    [[nodiscard]] PairView<N> view_of(const Bodies& bodies, const Pair& pair, const State& a) const {
        return {shape_[pair.a], shape_[pair.b], axes_[pair.a], axes_[pair.b], reach_between(a, bodies.state[pair.b])};
    }
    // `measured`: neither body has moved since. `margin`: of faces over edges.
    template <class F>
    void with_pair(const Bodies& bodies, const Pair& pair, [[maybe_unused]] bool measured,
                   [[maybe_unused]] Length margin, F&& f) const {
        const auto make = [&]<class Contact>(const PairView<N>& view) {
            if constexpr (requires(Contact contact) { contact.axis; })
                return measured ? Contact{view, pair.axis, pair.normal, pair.gap} : Contact{view, margin};
            else return Contact{view};
        };
        with_contact<features>(view_of(bodies, pair), make, f);
    }
    // A body of the pair has turned when it was placed last. On a fixed body the rows depend through the normal only.
    [[nodiscard]] TUMBLE_INLINE bool has_turned(const Pair& pair) const {
        return turned_[pair.a] || (pair.moves_b() && turned_[pair.b]);
    }
    void measure(const Bodies& bodies, Pair& pair) {
        (void)measure(bodies, pair, Bounds::axis_margin(tolerance_), false);
    }
    // Without a margin the gap of boxes that are apart is not negative. `asks`: whether they touch at an edge of a box,
    // where another side of it is as near. False otherwise.
    bool measure(const Bodies& bodies, Pair& pair, Length margin, [[maybe_unused]] bool asks) {
        pair.moved = pair.moved || turned_[pair.a];
        if (pair.with_plane()) {
            pair.gap = view_of_plane(bodies, pair).gap();
            return false;
        }
        bool at_edge = false;
        if constexpr (features.pairs) {
            pair.moved = pair.moved || has_turned(pair);
            Vec3<typename N::Unit> normal = pair.normal;
            with_pair(bodies, pair, false, margin, [&](const auto& contact, const auto&, bool reversed) {
                pair.gap = contact.gap;
                if constexpr (requires { contact.axis; }) pair.axis = contact.axis;
                normal = reversed ? Vec3<typename N::Unit>(-contact.normal) : contact.normal;
                if constexpr (features.boxes && requires { contact.is_at_edge(margin); })
                    at_edge = asks && !(contact.gap > tolerance_) && contact.is_at_edge(Bounds::edge_depth(tolerance_));
            });
            if constexpr (features.boxes) normal = normal_of_surface(pair, normal);
            pair.moved = pair.moved || !(normal == pair.normal);
            pair.normal = normal;
            if constexpr (features.boxes) {
                pair.axis.covered = pair.axis.idle = false;
                pair.at_edge = at_edge || !asks;
            }
        }
        return at_edge;
    }
    // Along the face of b on which a box lies with its own face, where nothing pushes b. So all blocks of a wall push
    // in one direction, whichever faces are found. Over the box these two part by no more than resting points may be
    // above a surface. Else the normal that was found.
    [[nodiscard]] Vec3<typename N::Unit> normal_of_surface(const Pair& pair, const Vec3<typename N::Unit>& found) const
        requires(features.pairs&& features.boxes) {
        using Unit = typename N::Unit;
        const CollisionShape<N>&a = shape_[pair.a], &b = shape_[pair.b];
        if (pair.moves_b() || !a.is(ShapeKind::box) || !b.is(ShapeKind::box) || pair.axis.index >= 3) return found;
        const Axes<N> axes = b.axes(axes_[pair.b]);
        int face = -1;
        bool along = false;
        for (int i = 0; i < 3; ++i) {
            const Unit part = narrow<Unit>(dot(found, axes.axis(i)));
            if (!(narrow<Length>(mul(magnitude_of(part), a.radius)) > Bounds::resting_gap(tolerance_))) continue;
            if (face >= 0) return found;
            face = i;
            along = part > Unit{};
        }
        if (face < 0) return found;
        return along ? axes.axis(face) : Vec3<Unit>(-axes.axis(face));
    }
    // Finds the contact points of a measured pair that touches: those within the tolerance, and points of a rim that
    // may come as near in a step. Points of the step before keep their impulses for the warm start.
    void find(const Bodies& bodies, Pair& pair) { find_within(bodies, pair, tolerance_); }
    // The same of points within another band.
    void find_within(const Bodies& bodies, Pair& pair, Length band) {
        if (pair.gap > band) {
            pair.count = 0;
            return;
        }
        Manifold<N> found;
        if (pair.with_plane()) {
            view_of_plane(bodies, pair).find(found, band + fall_of_rim(bodies, pair.a));
        } else if constexpr (features.pairs) {
            with_pair(bodies, pair, true, Length{}, [&](const auto& contact, const auto& view, bool reversed) {
                if constexpr (features.boxes)
                    if (pair.axis.idle) return;
                contact.find(view, found, band);
                if (reversed) {
                    for (int i = 0; i < found.count; ++i) {
                        const Vec3<Length> arm = found.point[i].arm;
                        found.point[i].arm = found.point[i].arm_b;
                        found.point[i].arm_b = arm;
                    }
                }
            });
            if constexpr (features.friction)
                if (pair.has_friction) set_tangents<N>(pair.normal, pair.tangent);
        }
        take(pair, found);
    }

private:
    // How far a point of a rim moves in a step at most across the plane of the rim. A coin that rattles changes the
    // point on which it stands within a step: the force at one point does not keep the others up.
    [[nodiscard]] Length fall_of_rim([[maybe_unused]] const Bodies& bodies, [[maybe_unused]] int b) const {
        if constexpr (features.round_shapes) {
            const CollisionShape<N>& shape = shape_[b];
            if (!shape.is_round() || !bodies.is_turning(b)) return Length{};
            const WorkVec3<N> turn{bodies.turn(b, 0), bodies.turn(b, 1), bodies.turn(b, 2)},
                across = cross<Work>(work_unit<N>(shape.axis), turn);
            return scale().length(scale().metres(shape.half.x()) * sqrt(dot(across, across)));
        }
        return Length{};
    }
    // No radius of gyration of a shape exceeds its radius. So an arm that is not below the radius of a body over its
    // share makes a row of at least unit length before it is scaled, and the smaller of the two keeps both bodies'
    // levers within their radii over their radii of gyration.
    void set_resistance(Pair& pair, const Material& a, const Material& b) const requires(features.rolling_resistance) {
        const CollisionShape<N>& shape = shape_[pair.a];
        Work arm = scale().metres(shape.radius);
        bool fits = Bounds::has_levers(weight_[pair.a].gyration, shape.radius);
        if (pair.moves_b()) {
            const CollisionShape<N>& other = shape_[pair.b];
            const Work of_a = arm / N::work(pair.share_a), of_b = scale().metres(other.radius) / N::work(pair.share_b);
            arm = of_a < of_b ? of_a : of_b;
            fits = fits && Bounds::has_levers(weight_[pair.b].gyration, other.radius);
        }
        pair.spin_arm = scale().length(arm);
        const Work over_arm = fits ? Work(1) / arm : Work(0);
        pair.rolling = C::friction(materials_.resistance(a, b, &Material::rolling) * over_arm);
        pair.spinning = C::friction(materials_.resistance(a, b, &Material::spinning) * over_arm);
    }

    // Makes room for a length, m. True where the scale of lengths has changed. Raises the tolerance to the least that
    // the scale resolves.
    constexpr bool make_room(Real largest) {
        const auto finer = scale();
        const bool rescaled = shape_.make_room(largest);
        for (int b = 0; rescaled && b < features.bodies; ++b)
            if (!shape_[b].is(ShapeKind::none)) weight_[b].rescale(finer, scale());
        const Real least = shape_.least_tolerance();
        tolerance_ = scale().length(tolerance_metres_ < least ? least : tolerance_metres_);
        set_fall();
        return rescaled;
    }
    // Takes the points over. A point inherits the impulses of the one that was at its place.
    void take(Pair& pair, const Manifold<N>& found) const {
        const Length near = Bounds::same_point(shape_[pair.a].radius);
        const auto is_same = [&](const Vec3<Length>& p, const Vec3<Length>& q) {
            return !(magnitude_of(p.x() - q.x()) > near) && !(magnitude_of(p.y() - q.y()) > near) &&
                   !(magnitude_of(p.z() - q.z()) > near);
        };
        const int count = found.count < Pair::max_points ? found.count : Pair::max_points;
        const bool only = Pair::max_points == 1 || (count == 1 && pair.count == 1);
        Speed impulse[Pair::max_points][Point::directions];
        [[maybe_unused]] Speed of_spin[Pair::max_points][3];
        for (int i = 0; i < count; ++i) {
            int before = -1;
            for (int j = 0; j < pair.count && before < 0; ++j)
                if (only || is_same(pair.point[j].arm, found.point[i].arm)) before = j;
            for (int k = 0; k < Point::directions; ++k)
                impulse[i][k] = before < 0 ? Speed{} : pair.point[before].row[k].impulse;
            if constexpr (features.rolling_resistance)
                for (int k = 0; k < 3; ++k) of_spin[i][k] = before < 0 ? Speed{} : pair.point[before].spin[k].impulse;
        }
        for (int i = 0; i < count; ++i) {
            Point& point = pair.point[i];
            if (pair.moved || i >= pair.count || !(point.arm == found.point[i].arm)) point.rows_are_valid = false;
            point.arm = found.point[i].arm;
            if constexpr (features.pairs) {
                if (!(point.arm_b == found.point[i].arm_b)) point.rows_are_valid = false;
                point.arm_b = found.point[i].arm_b;
            }
            point.gap = found.point[i].gap;
            for (int k = 0; k < Point::directions; ++k) point.row[k].impulse = impulse[i][k];
            if constexpr (features.rolling_resistance)
                for (int k = 0; k < 3; ++k) point.spin[k].impulse = of_spin[i][k];
        }
        pair.count = static_cast<std::uint8_t>(count);
        pair.moved = false;
    }

    constexpr void set_fall() {
        for (int i = 0; i < 3; ++i) fall_[i] = scale().fall(fall_drift_[i], drift_unit_);
        fall_bound_ = sum_of_magnitudes(fall_);
    }
    // m a step. In floating point in units of the largest component: the square of a small float is zero.
    [[nodiscard]] constexpr Work speed_of_fall() const {
        Work v[3]{}, unit(1), squares(0);
        for (int i = 0; i < 3; ++i) v[i] = N::metres(fall_drift_[i], drift_unit_);
        if constexpr (!N::fixed_point) {
            unit = Work(0);
            for (const Work w : v)
                if (magnitude_of(w) > unit) unit = magnitude_of(w);
            if (!(unit > Work(0))) return Work(0);
            const Work inverse = Work(1) / unit;
            for (Work& w : v) w = w * inverse;
        }
        for (const Work w : v) squares = mul_add(squares, w, w);
        if constexpr (N::fixed_point) return sqrt(squares);
        else return sqrt(squares) * unit;
    }

    Length tolerance_{}, fall_bound_{};
    StoredVec3<Length> fall_{};
    Work slow_{};
    Plane<N> plane_[features.planes > 0 ? features.planes : 1]{};
    int plane_count_ = 0;
    Shapes<N, features.bodies> shape_{};
    Weights weight_{};
    Axes<N> axes_[features.bodies]{};

    Materials<N, features> materials_;
    ContactResponse response_;
    Real tolerance_metres_;
    typename N::DriftSum fall_drift_[3]{};
    typename N::Scale drift_unit_{};
    bool turned_[features.bodies]{};  // since it was placed before
    [[no_unique_address]] Layers<features> layers_{};
};

}  // namespace tumble

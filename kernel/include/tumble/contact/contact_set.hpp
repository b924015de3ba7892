// The contacts of a world: its planes, what of its bodies touches them, and the impulses where they do.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/contact/impulse.hpp>

namespace tumble {

// How the flight of a unit of bodies has ended.
template <class State>
struct Touchdown {
    const State* start;  // of the unit's bodies, where the flight began
    bool impact;         // at the time of an impact; else at the end of the step
    bool resting;        // in touch since it began
    bool stop;           // the last: what still approaches is stopped
    bool sunk;           // deeper than the tolerance
};

template <class N, Spin spin, Capacity capacity>
class ContactSet {
public:
    using Work = typename N::Work;
    using Bodies = tumble::Bodies<N, spin, capacity.bodies>;
    using State = typename Bodies::State;

    ContactSet(Real step, const ContactSpec& spec)
        : steps_per_second_{N::template constant<Work>(Real{1} / step)}, response_{spec.response},
          restitution_{N::template constant<Work>(spec.restitution)}, threshold_{N::template constant<Work>(
                                                                          spec.restitution_threshold)},
          friction_{N::template constant<Work>(spec.friction)}, tolerance_{N::template constant<Work>(spec.tolerance)} {
    }

    // `change` is the size of gravity's change of drift in a step, m.
    void set_gravity(Real change) { slow_ = N::template constant<Work>(change * Real{2}); }

    // What of body b touches.
    [[gnu::noinline]] void set_shape(int b, const BodySpec& spec, const RealQuat& principal) {
        const bool touches = spec.shape.kind == ShapeKind::sphere || spec.shape.kind == ShapeKind::box;
        const Real half = spec.shape.kind == ShapeKind::box ? Real::scaled(1, -1) : Real{1};
        shape_[b] = {touches ? spec.shape.kind : ShapeKind::none,
                     work_vector<N>(spec.shape.size * half),
                     {N::template constant<Work>(principal.w), work_vector<N>(principal.v)},
                     N::template constant<Work>(spec.restitution),
                     N::template constant<Work>(spec.friction)};
    }
    // False when there is no room.
    [[gnu::noinline]] bool add(const PlaneSpec& spec) {
        if (plane_count_ >= capacity.planes) return false;
        Plane<N>& plane = plane_[plane_count_++];
        const RealVec3 n = normalized(spec.normal);
        for (int i = 0; i < 3; ++i) plane.normal[i] = N::template constant<typename N::Unit>(n[i]);
        plane.offset = N::template constant<Work>(spec.offset);
        plane.restitution = N::template constant<Work>(spec.restitution);
        plane.friction = N::template constant<Work>(spec.friction);
        return true;
    }

    // m: the band in which bodies touch, and the depth at which a step is redone.
    [[nodiscard]] Work tolerance() const { return tolerance_; }
    // m: twice the change of drift by gravity in a step; who moves less, rests.
    [[nodiscard]] Work slow() const { return slow_; }
    // Contact points of the body in the last step.
    [[nodiscard]] int count(int b) const { return touching_[b]; }
    template <class Unit>
    void forget(const Unit& unit) {
        for (int k = 0; k < unit.count; ++k) touching_[unit.id[k]] = 0;
    }

    // Can any body of the unit touch anything?
    template <class Unit>
    [[nodiscard]] bool concerns(const Unit& unit) const {
        if (response_ != ContactResponse::impulse || plane_count_ == 0) return false;
        for (int k = 0; k < unit.count; ++k)
            if (shape_[unit.id[k]].kind != ShapeKind::none) return true;
        return false;
    }

    // The least gap between the unit's bodies and the planes, m.
    template <class Unit>
    [[nodiscard]] Work least_gap(const Bodies& bodies, const Unit& unit) const {
        Work least{};
        bool any = false;
        for (int k = 0; k < unit.count; ++k) {
            const int b = unit.id[k];
            if (shape_[b].kind == ShapeKind::none) continue;
            const Placement<N> place = placement(bodies.state[b]);
            for (int p = 0; p < plane_count_; ++p) {
                const Work gap = PlaneView<N>{place, shape_[b], plane_[p], capacity.boxes}.gap();
                if (!any || gap < least) least = gap;
                any = true;
            }
        }
        return least;
    }

    // Impulses at all points in touch, and the position put right where a resting body has sunk. Calls pushed(b) for
    // each body whose motion has changed.
    template <class Unit, class F>
    void resolve(Bodies& bodies, const Unit& unit, const Touchdown<State>& end, F&& pushed) {
        for (int k = 0; k < unit.count; ++k) {
            const int b = unit.id[k];
            if (shape_[b].kind != ShapeKind::none && resolve_body(bodies, b, end.start[k], end)) pushed(b);
        }
    }

private:
    [[nodiscard]] static Placement<N> placement(const State& s) {
        return {{N::sum(s.x_w.x), N::sum(s.x_w.y), N::sum(s.x_w.z)}, work_quaternion<N>(s.q_wb.value())};
    }
    [[nodiscard]] static Work combined_restitution(Work a, Work b, Work otherwise) {
        const Work none(0);
        if (a < none && b < none) return otherwise;
        return a < b ? b : a;  // the larger of what is named
    }
    // The geometric mean; a side that names none takes the world's.
    [[nodiscard]] static Work combined_friction(Work a, Work b, Work otherwise) {
        const Work x = a < Work(0) ? otherwise : a, y = b < Work(0) ? otherwise : b;
        return x == y ? x : sqrt(x * y);
    }

    // False where nothing is in touch.
    bool resolve_body(Bodies& bodies, int b, const State& start, const Touchdown<State>& end) {
        const auto& body = bodies.constants[b];
        const ContactShape<N>& shape = shape_[b];
        const Placement<N> place = placement(bodies.state[b]);
        RigidMotion<N> motion;
        WorkVec3<N> v_w, fall_w;
        for (int i = 0; i < 3; ++i) {
            v_w[i] = N::metres(N::sum(bodies.state[b].d_w[i]), bodies.scale) * steps_per_second_;
            fall_w[i] =
                N::metres(N::sum(bodies.state[b].d_w[i]) - N::sum(start.d_w[i]), bodies.scale) * steps_per_second_;
            const Work rate = body.units.rate(i, steps_per_second_);
            motion.w[i] = N::half_turn(N::sum(bodies.state[b].t_b[i]), bodies.scale) * rate;
            motion.inverse_moments[i] = rate * body.units.per_impulse(i);
        }
        motion.v = rotate_back(place.q_wb, v_w);
        motion.inverse_mass = body.drift_per_impulse * steps_per_second_;

        ContactPoint<N> points[contact::max_points];
        int count = 0;
        Work deepest(0);
        const Plane<N>* deepest_plane = nullptr;
        for (int p = 0; p < plane_count_; ++p) {
            const Plane<N>& plane = plane_[p];
            const PlaneView<N> view{place, shape, plane, capacity.boxes};
            if (view.gap() > tolerance_) continue;
            if (view.gap() < deepest) {
                deepest = view.gap();
                deepest_plane = &plane;
            }
            const Work e = combined_restitution(shape.restitution, plane.restitution, restitution_);
            const Work mu = combined_friction(shape.friction, plane.friction, friction_);
            view.for_each_point(capacity.boxes, [&](Work gap, const WorkVec3<N>& arm) {
                if (gap > tolerance_) return;
                const Work v = dot(motion.at(arm), view.normal_b());
                // Still on its way to the surface: an impact of the next step.
                if (!end.impact && !end.stop && gap > Work(0) && v < -(slow_ * steps_per_second_)) return;
                if (count == contact::max_points) {
                    bodies.report(Issue::contacts_full, b);
                    return;
                }
                ContactPoint<N>& c = points[count++];
                c.arm = arm;
                c.normal = view.normal_b();
                c.turning = cross<Work>(arm, c.normal);
                c.gap = gap;
                c.friction = mu;
                c.pushed = Work(0);
                c.dragged = zero_vector<N>();
                c.mass = Work(1) / motion.response(c.turning);
                if (end.stop && e * v < -(slow_ * steps_per_second_)) bodies.report(Issue::step_bound_hit, b);
                c.target = target_velocity(v, gap, e, end.resting ? dot(fall_w, work_unit<N>(plane.normal)) : Work(0),
                                           end.stop);
            });
        }
        if (count == 0) return false;
        touching_[b] = static_cast<std::uint8_t>(count);
        solve_impulses<N, capacity.friction>(motion, points, count);

        WorkVec3<N> linear = zero_vector<N>(), angular = zero_vector<N>();
        for (int c = 0; c < count; ++c) {
            const WorkVec3<N> j = scaled_by(points[c].normal, points[c].pushed) + points[c].dragged;
            linear += j;
            angular += cross<Work>(points[c].arm, j);
        }
        bodies.push(b, rotate(place.q_wb, linear), angular);

        // A resting body sinks by what gravity adds before the impulse; lift it back towards half the tolerance.
        if (deepest_plane != nullptr && (end.resting || end.sunk)) {
            const Work excess = -deepest - N::half_of(tolerance_);
            if (excess > Work(0)) {
                for (int i = 0; i < 3; ++i) {
                    const Work lift = N::work(deepest_plane->normal[i]) * excess;
                    bodies.state[b].x_w[i].add(N::position_sum(lift));
                }
            }
        }
        return true;
    }

    // The normal velocity after the impact. A body that was in touch before the step bounces only with the speed it had
    // then, not with what loads (`fall`, m/s along the normal) have added since: a resting body must not hop. A point
    // still above the surface may close its gap.
    [[nodiscard]] Work target_velocity(Work v, Work gap, Work restitution, Work fall, bool stop) const {
        Work approach = fall < Work(0) ? v - fall : v;
        if (approach > Work(0) || stop || -approach < threshold_) approach = Work(0);
        const Work bounce = -(restitution * approach);
        if (bounce > Work(0) || !(gap > Work(0))) return bounce;
        return -(gap * steps_per_second_);
    }

    Work steps_per_second_;
    ContactResponse response_;
    Work restitution_, threshold_, friction_, tolerance_;
    Work slow_{};
    Plane<N> plane_[capacity.planes]{};
    int plane_count_ = 0;
    ContactShape<N> shape_[capacity.bodies]{};
    std::uint8_t touching_[capacity.bodies]{};
};

}  // namespace tumble

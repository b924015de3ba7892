// Contacts by springs. A point at the depth d below a surface feels the force k d - c v along the normal, with the
// speed v at which it leaves, and never a pull. With a barrier, a point at the distance d outside feels B / d^2. There
// is no friction. Spheres, boxes, cylinders and capsules touch planes; spheres and boxes touch each other.
//
// While a contact lasts, an explicit method is stable for h < 2 / sqrt(lambda), with the largest eigenvalue lambda of
// M^-1 K. A contact that begins and ends within a step gains energy near that limit, so the largest safe step is half
// of it. A sphere on a plane has lambda = k / m; a box on a face has 4 k max(1 / m, h_j^2 / I_i), because its four
// springs lift and tilt it. Two bodies have the sum of theirs; where more than two touch, twice the sum, as in a long
// row. The stiffness 2 B / d^3 of a barrier is known only during the run. A body that jumps over a barrier is reported,
// too.
#pragma once

#include <tumble/loads/loaded_group.hpp>
#include <tumble/shapes/layers.hpp>
#include <tumble/shapes/pairs.hpp>
#include <tumble/shapes/plane.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class ContactSprings {
public:
    using Work = typename N::Work;
    using C = ContactNumbers<N>;
    using Length = typename C::Length;
    using Bodies = tumble::Bodies<N, spin, features.bodies, features.mixed()>;

    constexpr ContactSprings(Real step, const WorldSpec& world) : ContactSprings(step, world.contact) {}
    constexpr ContactSprings(Real step, const ContactSpec& spec)
        : on_{spec.response == ContactResponse::spring}, has_barrier_{on_ && spec.barrier > Real{}},
          stiffness_{N::template constant<Work>(spec.stiffness)}, damping_{N::template constant<Work>(spec.damping)},
          barrier_{N::template constant<Work>(spec.barrier)}, step2_{N::template constant<Work>(step * step)},
          stiffness_real_{spec.stiffness}, damping_real_{spec.damping}, step_{step} {
        // A barrier reaches as far as two bodies can be apart, twice the range: eight times the largest length.
        if constexpr (N::fixed_point)
            if (has_barrier_) (void)shape_.make_room(Real{N::Range::position} * Real::scaled(1, -2));
    }

    // Call when body b has been added.
    [[gnu::noinline]] constexpr void set_body(int b, const BodySpec& spec, const PrincipalInertia& inertia,
                                              Bodies& bodies) {
        if (!on_) return;
        if constexpr (features.layers)
            if (spec.layers == 0 && spec.shape.kind != ShapeKind::none)
                return set_body(b, as_it_touches(spec), inertia, bodies);
        layers_.set(b, spec);
        const Real reach = reach_of(spec.shape);
        (void)shape_.make_room(reach);
        set_collision_shape<N>(shape_[b], spec, inertia, shape_.scale());
        radius_[b] = N::template constant<Work>(reach);
        per_mass_[b] = spec.is_fixed() ? Work(0) : N::template constant<Work>(Real{1} / spec.mass);
        compliance_[b] = spec.is_fixed() || shape_[b].is(ShapeKind::none) ? Real{} : compliance(spec, inertia);
        if (plane_count_ > 0) require(compliance_[b], b, bodies);
        if constexpr (features.pairs) {
            int touching = 0;
            for (int other = 0; other <= b; ++other) touching += touches_bodies(shape_[other].kind) ? 1 : 0;
            for (int i = 0; i <= b && touching > 1; ++i) {
                for (int k = i + 1; k <= b; ++k) {
                    const Real both = compliance_[i] + compliance_[k];
                    if (meets(shape_[i].kind, shape_[k].kind) && layers_.meet(i, k))
                        require(touching > 2 ? both * Real{2} : both, k, bodies);
                }
            }
        }
    }
    // False when there is no room.
    [[gnu::noinline]] constexpr bool add(const PlaneSpec& spec, Bodies& bodies) {
        if (plane_count_ >= features.planes) return false;
        plane_[plane_count_++] = HalfSpace<N>{spec};
        if (!on_) return true;
        for (int b = 0; b < bodies.count; ++b) require(compliance_[b], b, bodies);
        return true;
    }
    [[nodiscard]] constexpr int plane_count() const { return plane_count_; }
    // True of a body with a shape, where contacts are by springs.
    [[nodiscard]] constexpr bool touches(int b) const { return on_ && !shape_[b].is(ShapeKind::none); }

    // acts_on: the body may touch a plane or another body. couples: it may touch another body.
    [[nodiscard]] bool acts_on(const Bodies& bodies, int b) const {
        return touches(b) && (plane_count_ > 0 || couples(bodies, b));
    }
    [[nodiscard]] bool couples(const Bodies&, int b) const {
        if constexpr (features.pairs) {
            for (int other = 0; on_ && other < features.bodies; ++other)
                if (other != b && meet(b, other)) return true;
        }
        return false;
    }
    [[nodiscard]] bool depends_on_velocity() const { return on_ && damping_ > Work(0); }

    // s; zero where no contact limits it.
    [[nodiscard]] Real largest_safe_step() const {
        Real most = most_compliance_;
        const auto met = static_cast<Real>(stiffest_);
        if (met > most) most = met;
        Real step = most > Real{} ? Real{1} / sqrt(most) : Real{};
        if (most_damping_ > Real{} && (step.is_zero() || Real{1} / most_damping_ < step))
            step = Real{1} / most_damping_;
        return step;
    }

    [[nodiscard]] bool turns(const Bodies& bodies, int b) const { return acts_on(bodies, b); }
    // Contacts wake no body.
    void for_each_coupled(const Bodies&, int, auto&&) const {}
    template <class Group>
    TUMBLE_INLINE void apply_to(const Group& group) const {
        if constexpr (Group::rotation)
            if (on_ && group.turned) add_to(group);
    }

private:
    // A body at a stage, and the sums of what its contacts do, in SI units and working numbers.
    struct Loaded {
        const StageState<N>* stage;
        Quat<Work> q_wb;                // principal axes to world
        WorkVec3<N> v_w, w_b;           // m/s, rad/s
        WorkVec3<N> force_w, torque_b;  // N, N m about the centre of mass

        void set(const Bodies& bodies, int b, const StageState<N>& at, Work steps_per_second) {
            stage = &at;
            force_w = zero_vector<N>();
            for (int i = 0; i < 3; ++i) v_w[i] = N::metres(at.d_w[i], bodies.scale) * steps_per_second;
            q_wb = work_quaternion<N>(at.q_wb);
            torque_b = zero_vector<N>();
            for (int i = 0; i < 3; ++i)
                w_b[i] = N::half_turn(at.t_b[i], bodies.scale) * bodies.constants[b].units.rate(i, steps_per_second);
        }
        // m/s, world, of a point of the body (principal axes, m).
        [[nodiscard]] WorkVec3<N> velocity_at(const WorkVec3<N>& r_b) const {
            return v_w + rotate(q_wb, cross<Work>(w_b, r_b));
        }
        // Adds a force at a point of the body (principal axes, m).
        void push(const WorkVec3<N>& f_w, const WorkVec3<N>& r_b) {
            force_w += f_w;
            torque_b += cross<Work>(r_b, rotate_back(q_wb, f_w));
        }
    };

    template <class Group>
    [[gnu::noinline]] void add_to(const Group& group) const {
        using L = LoadNumbers<N>;
        Bodies& bodies = group.bodies;
        Loaded loaded[features.bodies], outside;  // a fixed body
        StageState<N> stage_outside;
        const Work rate = group.rate(), seconds = group.seconds;
        for (int k = 0; k < group.count; ++k)
            if (bodies.rotates(group.id[k])) loaded[k].set(bodies, group.id[k], group.stage[k], rate);
        for (int k = 0; k < group.count; ++k) {
            const int a = group.id[k];
            apply(loaded[k], a, bodies);
            for (int b = 0; features.pairs && b < bodies.count; ++b) {
                if (b == a) continue;
                const int other = group.place_of(b);
                if ((b < a && other >= 0) || !meet(a, b)) continue;
                if (other < 0) outside.set(bodies, b, stage_outside = stage_of(bodies.state[b]), rate);
                apply(loaded[k], a, other < 0 ? outside : loaded[other], b, bodies);
            }
        }
        for (int k = 0; k < group.count; ++k) {
            const auto& body = bodies.constants[group.id[k]];
            const Work linear = body.drift_per_impulse() * seconds;
            if (!bodies.rotates(group.id[k])) continue;  // a point mass touches nothing
            for (int i = 0; i < 3; ++i) L::add(group.kick[k].linear, i, loaded[k].force_w[i] * linear, bodies.scale);
            for (int i = 0; i < 3; ++i)
                L::add(group.kick[k].angular, i, loaded[k].torque_b[i] * (body.units.per_impulse(i) * seconds),
                       bodies.scale);
        }
    }
    // True of two bodies that touch each other where they meet.
    [[nodiscard]] bool meet(int a, int b) const {
        return touches_bodies(shape_[a].kind) && touches_bodies(shape_[b].kind) &&
               touching_meet(shape_[a].kind, shape_[b].kind) && layers_.meet(a, b);
    }
    // A body against every plane.
    void apply(Loaded& body, int b, Bodies& bodies) const {
        if (!touches(b)) return;
        const CollisionShape<N>& shape = shape_[b];
        for (int p = 0; p < plane_count_; ++p) {
            const HalfSpace<N>& plane = plane_[p];
            const auto height = N::along(body.stage->x_w, plane.normal) + plane.offset;
            const WorkVec3<N> normal = work_unit<N>(plane.normal);
            if (shape.is(ShapeKind::sphere)) {
                const Work gap = N::metres_along(height) - radius_[b];
                if (gap < Work(0) || has_barrier_)
                    push(body, nullptr, b, b, gap, normal, scaled_by(rotate_back(body.q_wb, normal), -radius_[b]),
                         zero_vector<N>(), bodies);
                continue;
            }
            const Axes<N> axes = Axes<N>::of(body.stage->q_wb);
            Manifold<N> found;
            const Length centre = shape_.scale().length(height);
            PlaneView<N, features>{shape, axes, plane.normal, centre}.find(found, band());
            // m: what is left of the centre's height where a length ends.
            const Work rest =
                C::LengthScale::is_cut(centre) ? N::metres_along(height) - shape_.scale().metres(centre) : Work(0);
            push_all(found, rest, body, nullptr, b, b, normal, bodies);
        }
    }
    // Two bodies.
    void apply(Loaded& a, int index_a, Loaded& b, int index_b, Bodies& bodies) const {
        const CollisionShape<N>&shape_a = shape_[index_a], &shape_b = shape_[index_b];
        WorkVec3<N> apart;
        for (int i = 0; i < 3; ++i) apart[i] = N::apart(a.stage->x_w[i], b.stage->x_w[i]);
        const Work square = dot(apart, apart), distance = sqrt(square), touch = radius_[index_a] + radius_[index_b];
        if (!(distance < touch) && !has_barrier_) return;
        if (shape_a.is(ShapeKind::sphere) && shape_b.is(ShapeKind::sphere)) {
            if (!N::is_divisor(square)) return;  // no direction: no force
            const WorkVec3<N> normal = scaled_by(apart, Work(1) / distance);
            push(a, &b, index_a, index_b, distance - touch, normal,
                 scaled_by(rotate_back(a.q_wb, normal), -radius_[index_a]),
                 scaled_by(rotate_back(b.q_wb, normal), radius_[index_b]), bodies);
            return;
        }
        if constexpr (has_other_pairs_than_spheres<features>) {
            const Axes<N> axes_a = Axes<N>::of(a.stage->q_wb), axes_b = Axes<N>::of(b.stage->q_wb);
            Vec3<Length> reach;
            for (int i = 0; i < 3; ++i) reach[i] = shape_.scale().length(apart[i]);
            const PairView<N> both{shape_a, shape_b, axes_a, axes_b, reach};
            const auto make = []<class Contact>(const PairView<N>& view) {
                if constexpr (requires(Contact contact) { contact.axis; }) return Contact{view, Length{}};
                else return Contact{view};
            };
            with_contact<features>(both, make, [&](const auto& contact, const auto& view, bool reversed) {
                if (contact.gap > band()) return;
                Manifold<N> found;
                contact.find(view, found, band());
                const WorkVec3<N> normal = work_unit<N>(contact.normal);
                if (reversed) push_all(found, Work(0), b, &a, index_b, index_a, normal, bodies);
                else push_all(found, Work(0), a, &b, index_a, index_b, normal, bodies);
            });
        }
    }

    // Largest gap of the points that feel a force.
    [[nodiscard]] Length band() const { return has_barrier_ ? C::longest() : Length{}; }

    // `rest` is added to the gap of every point, m.
    void push_all(const Manifold<N>& found, Work rest, Loaded& a, Loaded* b, int index_a, int index_b,
                  const WorkVec3<N>& normal, Bodies& bodies) const {
        for (int i = 0; i < found.count; ++i) {
            const ManifoldPoint<N>& point = found.point[i];
            WorkVec3<N> arm, arm_b;
            for (int k = 0; k < 3; ++k) {
                arm[k] = shape_.scale().metres(point.arm[k]);
                arm_b[k] = shape_.scale().metres(point.arm_b[k]);
            }
            push(a, b, index_a, index_b, shape_.scale().metres(point.gap) + rest, normal, arm, arm_b, bodies);
        }
    }
    // At one point: `normal` in the world, from b to a; arms in principal axes.
    void push(Loaded& a, Loaded* b, int index_a, int index_b, Work gap, const WorkVec3<N>& normal,
              const WorkVec3<N>& arm, const WorkVec3<N>& arm_b, Bodies& bodies) const {
        Work strength(0);
        if (gap < Work(0)) {
            if (has_barrier_) bodies.report(Issue::step_too_long, index_a);  // the body jumped over it
            strength = -(stiffness_ * gap);
            if (damping_ > Work(0)) {
                WorkVec3<N> rate = a.velocity_at(arm);
                if (b != nullptr) rate -= b->velocity_at(arm_b);
                strength -= damping_ * dot(rate, normal);
                if (strength < Work(0)) return;
            }
        } else if (has_barrier_ && N::has_inverse_cube(gap * gap)) {
            strength = barrier_ / (gap * gap);
            const Work per_mass = b == nullptr ? per_mass_[index_a] : per_mass_[index_a] + per_mass_[index_b];
            const Work stiffness = (strength + strength) / gap * per_mass;
            if (stiffest_ < stiffness) stiffest_ = stiffness;
            if (stiffness * step2_ > Work(1)) bodies.report(Issue::step_too_long, index_a);
        } else {
            // At the surface a barrier has no force that is finite.
            const bool is_reached = has_barrier_;
            if (is_reached) bodies.report(Issue::step_too_long, index_a);
            return;
        }
        const WorkVec3<N> force = scaled_by(normal, strength);
        a.push(force, arm);
        if (b != nullptr) b->push(-force, arm_b);
    }

    // The largest eigenvalue of M^-1 K / k for the body on a plane.
    [[nodiscard]] static constexpr Real compliance(const BodySpec& spec, const PrincipalInertia& inertia) {
        const Real lift = Real{1} / spec.mass;
        if (spec.shape.kind == ShapeKind::sphere) return lift;
        const Real half_reach = reach_of(spec.shape);
        Real most = lift;
        if (spec.shape.kind == ShapeKind::box) {
            // Tilt about edge i by springs half an edge j away. A tensor of the user's own may have other axes: then
            // the smallest moment counts.
            const RealVec3 moments = inertia.moments;
            const InertiaTensor& t = spec.inertia;
            const bool own = !(t.xy.is_zero() && t.xz.is_zero() && t.yz.is_zero());
            const Real moment[3] = {own ? moments.z : t.xx, own ? moments.z : t.yy, own ? moments.z : t.zz};
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j) {
                    const Real half = spec.shape.size[j] * Real::scaled(1, -1), tilt = half * half / moment[i];
                    if (i != j && tilt > most) most = tilt;
                }
            }
        } else {
            const Real tilt = half_reach * half_reach / inertia.moments.y;
            if (tilt > most) most = tilt;
        }
        return most * Real{4};
    }
    constexpr void require(Real compliance, int b, Bodies& bodies) {
        const Real stiffness = compliance * stiffness_real_, damping = compliance * damping_real_;
        if (stiffness > most_compliance_) most_compliance_ = stiffness;
        if (damping > most_damping_) most_damping_ = damping;
        if (stiffness * step_ * step_ > Real{1} || damping * step_ > Real{1}) bodies.report(Issue::step_too_long, b);
    }

    bool on_, has_barrier_;
    Work stiffness_, damping_, barrier_, step2_;
    mutable Work stiffest_{};  // 1/s^2, of the barriers so far
    Real stiffness_real_, damping_real_, step_;
    Real most_compliance_{}, most_damping_{};
    Shapes<N, features.bodies> shape_{};
    Work radius_[features.bodies]{}, per_mass_[features.bodies]{};
    Real compliance_[features.bodies]{};
    HalfSpace<N> plane_[features.planes > 0 ? features.planes : 1]{};
    int plane_count_ = 0;
    [[no_unique_address]] Layers<features> layers_{};
};

}  // namespace tumble

// World<Scene>: the only thing that steps. It owns the bodies' state and constants in fixed-size arrays, applies loads,
// events and contacts, and advances everything by one fixed step at a time. Nothing is allocated; nothing throws.
//
// What is computed depends on what the scene contains (a body without loads is advanced without stages), never on what
// is compiled in, so a minimal firmware and a host with every feature give the same bits.
#pragma once

#include <tumble/contact/impulse.hpp>
#include <tumble/hash.hpp>
#include <tumble/loads/drag.hpp>
#include <tumble/loads/gravitation.hpp>
#include <tumble/loads/spring.hpp>
#include <tumble/loads/thrust.hpp>
#include <tumble/scene.hpp>
#include <tumble/script.hpp>
#include <tumble/status.hpp>

namespace tumble {

// A body's number in its world. False where add() found no room.
class BodyId {
public:
    constexpr BodyId() = default;
    constexpr explicit BodyId(int index) : index_{static_cast<std::int16_t>(index)} {}
    [[nodiscard]] constexpr explicit operator bool() const { return index_ >= 0; }
    [[nodiscard]] constexpr BodyId operator*() const { return *this; }
    [[nodiscard]] constexpr int index() const { return index_; }

private:
    std::int16_t index_ = -1;
};

namespace detail {

// Takes no room where a feature is absent; the tag keeps two of them at one address.
template <int tag>
struct Nothing {};

// How spin relates to angular velocity and momentum: half_turn_i = turn_per_impulse_i * L_i;  w_i = rate_i *
// half_turn_i.
template <class N, Spin spin>
struct SpinUnits;

template <class N>
struct SpinUnits<N, Spin::angular_velocity> {
    using Work = typename N::Work;
    Work turn_per_impulse[3]{};  // h / 2 I_i, rad/(N m s)

    [[nodiscard]] static constexpr SpinUnits of(RealVec3 moments, Real step) {
        SpinUnits u;
        for (int i = 0; i < 3; ++i) u.turn_per_impulse[i] = N::template constant<Work>(step / (moments[i] * Real{2}));
        return u;
    }
    [[nodiscard]] static constexpr Real turn_of(RealVec3, Real spin, int, Real step) {
        return spin * step * Real::scaled(1, -1);
    }
    [[nodiscard]] Work per_impulse(int i) const { return turn_per_impulse[i]; }
    [[nodiscard]] Work rate(int, Work steps_per_second) const { return steps_per_second + steps_per_second; }
};

template <class N>
struct SpinUnits<N, Spin::angular_momentum> {
    using Work = typename N::Work;
    Work turn_per_impulse{};  // h / 2 I_y
    Work rate_ratio[3]{};     // 2 I_y / I_i

    [[nodiscard]] static constexpr SpinUnits of(RealVec3 moments, Real step) {
        SpinUnits u;
        u.turn_per_impulse = N::template constant<Work>(step / (moments.y * Real{2}));
        for (int i = 0; i < 3; ++i) u.rate_ratio[i] = N::template constant<Work>(Real{2} * moments.y / moments[i]);
        return u;
    }
    [[nodiscard]] static constexpr Real turn_of(RealVec3 moments, Real spin, int i, Real step) {
        return spin * moments[i] / moments.y * step * Real::scaled(1, -1);
    }
    [[nodiscard]] Work per_impulse(int) const { return turn_per_impulse; }
    [[nodiscard]] Work rate(int i, Work steps_per_second) const { return rate_ratio[i] * steps_per_second; }
};

}  // namespace detail

template <class S>
class World {
public:
    using Numbers = typename S::Numbers;
    using Integrator = typename S::Integrator;
    using N = Numbers;
    using Work = typename N::Work;
    using State = BodyState<N, Integrator::spin>;
    static constexpr bool has_contacts = S::planes > 0;
    static constexpr bool has_loads = S::drag || S::gravitation || S::forces || S::springs > 0;

    // Bounds of one step of one body (or of one group of coupled bodies).
    static constexpr int max_impacts = 8;   // impacts resolved at their own time within one step
    static constexpr int max_resteps = 12;  // flights redone to find one impact

    // A world without bodies. `step` is the length of every step.
    explicit World(Seconds step, const WorldSpec& spec = {})
        : step_length_{step.value}, scale_{N::Scale::of(step.value, turn_per_spin(step.value))} {
        if constexpr (has_loads || has_contacts) steps_per_second_ = N::template constant<Work>(Real{1} / step.value);
        if constexpr (has_loads) seconds_ = N::template constant<Work>(step.value);
        set_gravity(spec.gravity);
        if constexpr (S::drag)
            drag_ = {N::template constant<Work>(spec.linear_drag), N::template constant<Work>(spec.angular_drag)};
        if constexpr (S::gravitation) gravitation_ = {N::template constant<Work>(spec.gravitation)};
        if constexpr (has_contacts) {
            contact_.response = spec.contact.response;
            contact_.restitution = N::template constant<Work>(spec.contact.restitution);
            contact_.threshold = N::template constant<Work>(spec.contact.restitution_threshold);
            contact_.friction = N::template constant<Work>(spec.contact.friction);
            contact_.tolerance = N::template constant<Work>(spec.contact.tolerance);
        }
    }

    // m/s^2, world frame.
    void set_gravity(RealVec3 gravity) {
        if constexpr (has_contacts)
            contact_.slow =
                N::template constant<Work>(sqrt(dot(gravity, gravity)) * step_length_ * step_length_ * Real{2});
        const Real h2 = step_length_ * step_length_;
        for (int i = 0; i < 3; ++i) {
            const Real fall = scale_.drift_units(gravity[i] * h2);
            gravity_[i] = N::fall(fall_in_halves ? fall * Real::scaled(1, -1) : fall);
        }
    }

    // Adds a body; false (and Issue::world_full) when there is no room. Mass and moments must be positive. A start that
    // leaves the range is told in status().
    BodyId add(const BodySpec& spec) {
        if (count_ >= S::bodies) {
            status_.set(Issue::world_full, count_, steps_taken_);
            return {};
        }
        TUMBLE_ASSERT(spec.mass > Real{});
        const PrincipalInertia inertia = principal_inertia(spec.inertia);
        TUMBLE_ASSERT(inertia.moments.z > Real{});
        const int b = count_++;
        BodyData& body = body_[b];
        body.inertia = Integrator::template Inertia<N>::of(inertia.moments, scale_);
        body.units = Units::of(inertia.moments, step_length_);
        body.drift_per_impulse = N::template constant<Work>(step_length_ / spec.mass);
        set_unit(body.principal, inertia.principal);
        State& state = state_[b];
        const RealQuat q = normalized(normalized(spec.orientation) * inertia.principal);
        state.q_wb.w = N::IntegratedUnit::from(q.w);
        state.q_wb.x = N::IntegratedUnit::from(q.v.x);
        state.q_wb.y = N::IntegratedUnit::from(q.v.y);
        state.q_wb.z = N::IntegratedUnit::from(q.v.z);
        const RealVec3 w = inertia.principal.conjugate().rotate(spec.angular_velocity);
        for (int i = 0; i < 3; ++i) {
            assign(state.x_w[i], spec.position[i]);
            assign(state.d_w[i], spec.fixed ? Real{} : scale_.drift_units(spec.velocity[i] * step_length_));
            assign(state.t_b[i],
                   spec.fixed ? Real{} : scale_.turn_units(Units::turn_of(inertia.moments, w[i], i, step_length_)));
        }
        body.fixed = spec.fixed;
        prepare_spin(b);
        if constexpr (S::gravitation) mass_[b] = N::template constant<Work>(spec.mass);
        if constexpr (has_contacts) {
            const bool touches = spec.shape.kind == ShapeKind::sphere || spec.shape.kind == ShapeKind::box;
            const Real half = spec.shape.kind == ShapeKind::box ? Real::scaled(1, -1) : Real{1};
            shape_[b] = {touches ? spec.shape.kind : ShapeKind::none,
                         work_vector<N>(spec.shape.size * half),
                         {N::template constant<Work>(inertia.principal.w), work_vector<N>(inertia.principal.v)},
                         N::template constant<Work>(spec.restitution),
                         N::template constant<Work>(spec.friction)};
        }
        check_range(b);
        return BodyId{b};
    }

    // Adds a plane; false when there is no room.
    bool add(const PlaneSpec& spec) requires has_contacts {
        if (plane_count_ >= S::planes) return false;
        Plane<N>& plane = plane_[plane_count_++];
        const RealVec3 n = normalized(spec.normal);
        for (int i = 0; i < 3; ++i) plane.normal[i] = N::template constant<typename N::Unit>(n[i]);
        plane.offset = N::template constant<Work>(spec.offset);
        plane.restitution = N::template constant<Work>(spec.restitution);
        plane.friction = N::template constant<Work>(spec.friction);
        return true;
    }

    // Adds a spring between bodies already added; false when there is no room.
    bool add(const SpringSpec& spec) requires(S::springs > 0) {
        if (spring_count_ >= S::springs) return false;
        Spring<N>& spring = spring_[spring_count_++];
        spring.body = static_cast<std::int16_t>(spec.body);
        spring.to_body = static_cast<std::int16_t>(spec.to_body);
        spring.point_b = principal_vector(spec.body, spec.point);
        if (spec.to_body >= 0) spring.to = principal_vector(spec.to_body, spec.to);
        else
            for (int i = 0; i < 3; ++i) spring.anchor_w[i] = position_sum(spec.to[i]);
        spring.stiffness = N::template constant<Work>(spec.stiffness);
        spring.damping = N::template constant<Work>(spec.damping);
        spring.rest_length = N::template constant<Work>(spec.rest_length);
        return true;
    }

    // Set-up values as this world's numbers, for arrays of events that outlive it.
    [[nodiscard]] Impulse<N> prepare(const ImpulseSpec& spec) const {
        const bool in_body = spec.frame == Frame::body;
        return {step_of(spec.time),
                static_cast<std::int16_t>(spec.body),
                spec.frame,
                in_body ? principal_vector(spec.body, spec.impulse) : work_vector<N>(spec.impulse),
                in_body ? principal_vector(spec.body, spec.angular_impulse) : work_vector<N>(spec.angular_impulse),
                principal_vector(spec.body, spec.point)};
    }
    [[nodiscard]] Thrust<N> prepare(const ForceSpec& spec) const {
        const bool in_body = spec.frame == Frame::body;
        return {static_cast<std::int16_t>(spec.body),
                spec.frame,
                step_of(spec.from),
                step_of(spec.until),
                in_body ? principal_vector(spec.body, spec.force) : work_vector<N>(spec.force),
                in_body ? principal_vector(spec.body, spec.torque) : work_vector<N>(spec.torque),
                principal_vector(spec.body, spec.point)};
    }
    // The arrays must be sorted by step and stay where they are.
    void set_script(Span<Impulse<N>> impulses) requires S::script { script_ = impulses; }
    void set_forces(Span<Thrust<N>> forces) requires S::forces { forces_ = forces; }

    // Changes the body's momentum by `impulse` (N s, world frame) at a point of it (m, user's body axes); at once, and
    // once. The position is unchanged. About 2000 instructions on a Cortex-M3.
    void apply_impulse(BodyId id, RealVec3 impulse, RealVec3 point = {}) {
        apply({0, static_cast<std::int16_t>(id.index()), Frame::world, work_vector<N>(impulse), zero_vector<N>(),
               principal_vector(id.index(), point)});
    }

    // Takes one step of every body: events that are due, loads, motion, contacts. Returns the sticky status.
    Status step() {
        if constexpr (S::script) {
            while (next_event_ < script_.count && script_.first[next_event_].step <= steps_taken_)
                apply(script_.first[next_event_++]);
        }
        const StepInfo<N> info{scale_, Dither::of_step(steps_taken_)};
        if constexpr (!has_loads && !has_contacts) {
            if constexpr (S::bodies == 1) {
                advance_free(0, info);  // a constant index: every address is known
            } else {
                for (int b = 0; b < count_; ++b) advance_free(b, info);
            }
        } else {
            step_units(info);
        }
        ++steps_taken_;
        return status_;
    }

    [[nodiscard]] int body_count() const { return count_; }
    [[nodiscard]] std::uint32_t steps_taken() const { return steps_taken_; }
    [[nodiscard]] Status status() const { return status_; }
    void clear_status() { status_ = {}; }

    // The body's state as the step keeps it. x_w is in metres; the accessors below give the rest in SI units.
    [[nodiscard]] const State& state(BodyId id) const { return state_[id.index()]; }
    [[nodiscard]] WorkVec3<N> position(BodyId id) const {
        const State& s = state_[id.index()];
        return {N::metres(N::sum(s.x_w.x)), N::metres(N::sum(s.x_w.y)), N::metres(N::sum(s.x_w.z))};
    }
    // m/s, world frame.
    [[nodiscard]] WorkVec3<N> velocity(BodyId id) const {
        const State& s = state_[id.index()];
        WorkVec3<N> v;
        for (int i = 0; i < 3; ++i) v[i] = N::metres(N::sum(s.d_w[i]), scale_) * steps_per_second();
        return v;
    }
    // rad/s, user's body axes.
    [[nodiscard]] WorkVec3<N> angular_velocity(BodyId id) const {
        const BodyData& body = body_[id.index()];
        WorkVec3<N> w;
        for (int i = 0; i < 3; ++i)
            w[i] = N::half_turn(state_[id.index()].t_b[i].value(), scale_) * body.units.rate(i, steps_per_second());
        return rotate_quat(body.principal, w);
    }
    // User's body axes to world; of unit length to rounding.
    [[nodiscard]] Quat<Work> orientation(BodyId id) const {
        const Quat<Work> q = work_quaternion<N>(state_[id.index()].q_wb.value()),
                         p = work_quaternion<N>(body_[id.index()].principal).conjugate();
        const WorkVec3<N> v = scaled_by(p.v, q.w) + scaled_by(q.v, p.w) + cross<Work>(q.v, p.v);
        return {q.w * p.w - dot(q.v, p.v), v};
    }

    // Digest of every body's state.
    [[nodiscard]] std::uint64_t hash() const {
        Hash h;
        for (int b = 0; b < count_; ++b) h.add(state_[b]);
        return h.value();
    }

    // For readers that want more digits than working numbers have (the host): Real values of the state.
    [[nodiscard]] typename N::Scale scale() const { return scale_; }
    [[nodiscard]] const Quat<typename N::Unit>& principal(BodyId id) const { return body_[id.index()].principal; }

    // Contact points of the body in the last step, at most contact::max_points.
    [[nodiscard]] int contact_count(BodyId id) const {
        if constexpr (has_contacts) return touching_[id.index()];
        else return 0;
    }

private:
    using Units = detail::SpinUnits<N, Integrator::spin>;
    using Inertia = typename Integrator::template Inertia<N>;
    using DriftSum = typename N::DriftSum;
    // Where sums are exact, gravity is kept and added in halves: the position moves with the mean drift between them.
    static constexpr bool fall_in_halves = Integrator::coasting == Coasting::mean && N::fixed_point && N::carry;
    [[nodiscard]] static constexpr DriftSum whole_fall(DriftSum f) { return fall_in_halves ? f + f : f; }
    static constexpr int load_capacity = has_loads ? S::bodies : 1;

    struct BodyData {
        Inertia inertia{};
        Units units{};
        Work drift_per_impulse{};            // h / m
        Quat<typename N::Unit> principal{};  // principal axes to the user's body axes
        bool fixed = true;                   // so is a place that no body has taken yet
    };
    struct ContactSettings {
        ContactResponse response{};
        Work restitution{}, threshold{}, friction{}, tolerance{};
        Work slow{};  // m: twice the change of drift by gravity in a step; who moves less, rests
    };
    template <class T, int n>
    using Array = T[n > 0 ? n : 1];
    template <bool present, class T, int tag>
    using If = std::conditional_t<present, T, detail::Nothing<tag>>;

    // Part of a step, for steps that an impact interrupts; whole steps cost nothing extra.
    struct Portion {
        bool whole = true;
        Work length = Work(1);  // of the step, (0, 1]
    };

    // Bodies that a step advances together.
    struct Unit {
        int count = 0;
        std::int16_t id[load_capacity]{};
    };

    [[nodiscard]] Work steps_per_second() const {
        if constexpr (has_loads || has_contacts) return steps_per_second_;
        else return N::template constant<Work>(Real{1} / step_length_);
    }
    [[nodiscard]] static constexpr Real turn_per_spin(Real step) {
        return Integrator::spin == Spin::angular_velocity ? step * Real::scaled(1, -1) : step;
    }
    template <class Number>
    static void assign(Number& number, Real value) {
        number = Number::from(value);
    }
    static void set_unit(Quat<typename N::Unit>& q, const RealQuat& value) {
        q.w = N::template constant<typename N::Unit>(value.w);
        for (int i = 0; i < 3; ++i) q.v[i] = N::template constant<typename N::Unit>(value.v[i]);
    }
    [[nodiscard]] static typename N::PositionSum position_sum(Real metres) {
        if constexpr (N::fixed_point) return {metres.to_fixed(N::PositionSum::fraction_bits, 64)};
        else return N::template constant<typename N::PositionSum>(metres);
    }
    [[nodiscard]] std::uint32_t step_of(Real time) const {
        const std::int64_t n = (time / step_length_).to_fixed(0, 64);
        return n < 0 ? 0 : static_cast<std::uint32_t>(n);
    }
    [[nodiscard]] static WorkVec3<N> rotate_quat(const Quat<typename N::Unit>& q, const WorkVec3<N>& v) {
        return tumble::rotate(work_quaternion<N>(q), v);
    }
    // User's body axes to principal axes.
    [[nodiscard]] WorkVec3<N> principal_vector(int b, RealVec3 v) const {
        return rotate_quat(body_[b].principal.conjugate(), work_vector<N>(v));
    }

    void apply(const Impulse<N>& event) {
        const int b = event.body;
        if (body_[b].fixed) return;
        const Quat<Work> q = work_quaternion<N>(state_[b].q_wb.value());
        WorkVec3<N> linear_w = event.impulse, linear_b = event.impulse, angular_b = event.angular;
        if (event.frame == Frame::world) {
            linear_b = rotate_back(q, event.impulse);
            angular_b = rotate_back(q, event.angular);
        } else {
            linear_w = tumble::rotate(q, event.impulse);
        }
        push(b, linear_w, angular_b + cross<Work>(event.point_b, linear_b));
        check_range(b);
    }
    // Momentum (world, N s) and angular momentum (principal axes, N m s) into the state.
    void push(int b, const WorkVec3<N>& linear_w, const WorkVec3<N>& angular_b) {
        for (int i = 0; i < 3; ++i) {
            N::add_any(state_[b].d_w[i], linear_w[i] * body_[b].drift_per_impulse, scale_);
            N::add_any(state_[b].t_b[i], angular_b[i] * body_[b].units.per_impulse(i), scale_);
        }
        prepare_spin(b);
    }
    // The spin has changed otherwise than by free rotation.
    TUMBLE_INLINE void prepare_spin([[maybe_unused]] int b) {
        if constexpr (requires(Inertia & inertia) { inertia.prepare(state_[0], scale_); })
            body_[b].inertia.prepare(state_[b], scale_);
    }

    TUMBLE_INLINE void check_range(int b) {
        if (N::out_of_range(state_[b])) [[unlikely]]
            leave_range(b);
    }
    [[gnu::noinline]] void leave_range(int b) {
        N::saturate(state_[b]);
        status_.set(Issue::range_left, b, steps_taken_);
    }

    TUMBLE_INLINE void advance_free(int b, const StepInfo<N>& info) {
        if (body_[b].fixed) return;
        coast(b, gravity_);
        rotate(b, info);
        check_range(b);
    }

    // Motion under a constant acceleration, exact for methods of order two and more.
    TUMBLE_INLINE void coast(int b, const DriftSum (&fall)[3]) {
        State& s = state_[b];
        const auto axis = [&](auto& x, auto& d, DriftSum f) {
            if constexpr (Integrator::coasting == Coasting::mean && !fall_in_halves) N::coast(x, d, N::half(f), scale_);
            if constexpr (Integrator::coasting == Coasting::start) N::coast(x, d, {}, scale_);
            N::add(d, f);
            if constexpr (fall_in_halves) {
                N::coast(x, d, {}, scale_);
                N::add(d, f);
            }
            if constexpr (Integrator::coasting == Coasting::end) N::coast(x, d, {}, scale_);
        };
        axis(s.x_w.x, s.d_w.x, fall[0]);
        axis(s.x_w.y, s.d_w.y, fall[1]);
        axis(s.x_w.z, s.d_w.z, fall[2]);
    }
    TUMBLE_INLINE void rotate(int b, const StepInfo<N>& info) {
        if constexpr (std::is_void_v<decltype(Integrator::template rotate<N>(state_[b], body_[b].inertia, info))>) {
            Integrator::template rotate<N>(state_[b], body_[b].inertia, info);
        } else {
            if (!Integrator::template rotate<N>(state_[b], body_[b].inertia, info))
                status_.set(Issue::step_bound_hit, b, steps_taken_);
        }
    }

    // --- loads ---------------------------------------------------------------------------------------------------

    // Evaluates the loads of one unit of bodies for the integrators.
    struct Evaluate {
        static constexpr bool may_depend_on_velocity = S::drag || S::springs > 0;

        World& world;
        const Unit& unit;
        Work seconds, steps_per_second;  // of this portion of a step
        const DriftSum (&fall)[3];

        void operator()(const StageState<N>* stages, Kick<N>* kicks) const {
            world.evaluate(*this, stages, [&](int k, const WorkVec3<N>& linear, const WorkVec3<N>& angular) {
                bool within = true;
                for (int i = 0; i < 3; ++i) {
                    kicks[k].linear[i] =
                        N::limited(whole_fall(fall[i]) + N::drift_sum(linear[i], world.scale_), within);
                    kicks[k].angular[i] = N::limited(N::turn_sum(angular[i], world.scale_), within);
                }
                if (!within) world.status_.set(Issue::range_left, unit.id[k], world.steps_taken_);
            });
        }
        // The same in working numbers, whose range has no end: m and rad.
        void operator()(const StageState<N>* stages, WorkKick<N>* kicks) const {
            world.evaluate(*this, stages, [&](int k, const WorkVec3<N>& linear, const WorkVec3<N>& angular) {
                for (int i = 0; i < 3; ++i)
                    kicks[k].linear[i] = linear[i] + N::metres(whole_fall(fall[i]), world.scale_);
                kicks[k].angular = angular;
            });
        }
        [[nodiscard]] bool depends_on_velocity() const {
            if constexpr (S::drag)
                if (world.drag_.acts()) return true;
            if constexpr (S::springs > 0) {
                for (int s = 0; s < world.spring_count_; ++s)
                    if (world.spring_[s].damping > Work(0)) return true;
            }
            return false;
        }
    };

    // Calls kick(place in the unit, change of drift in m, change of half turn in rad) for each body.
    template <class F>
    void evaluate(const Evaluate& e, const StageState<N>* stages, F&& kick) {
        if constexpr (has_loads) {
            LoadedBody<N> loaded[load_capacity];
            for (int k = 0; k < e.unit.count; ++k) load(loaded[k], e.unit.id[k], stages[k], e);
            const auto find = [&](int b) -> LoadedBody<N>* {
                for (int k = 0; k < e.unit.count; ++k)
                    if (e.unit.id[k] == b) return &loaded[k];
                return nullptr;
            };
            StageState<N> still_stage;  // a fixed body at the other end of a load
            LoadedBody<N> still;
            const auto other_end = [&](int b) -> LoadedBody<N>* {
                if (LoadedBody<N>* found = find(b)) return found;
                still_stage = stage_of(state_[b]);
                load(still, b, still_stage, e);
                return &still;
            };
            if constexpr (S::drag)
                for (int k = 0; k < e.unit.count; ++k) drag_.apply(loaded[k]);
            if constexpr (S::springs > 0) {
                for (int s = 0; s < spring_count_; ++s) {
                    const Spring<N>& spring = spring_[s];
                    LoadedBody<N>* a = find(spring.body);
                    if (a != nullptr) {
                        spring.apply(*a, spring.to_body < 0 ? nullptr : other_end(spring.to_body));
                    } else if (spring.to_body >= 0 && find(spring.to_body) != nullptr) {
                        spring.apply(*other_end(spring.body), find(spring.to_body));
                    }
                }
            }
            if constexpr (S::gravitation) {
                for (int k = 0; k < e.unit.count && gravitation_.constant > Work(0); ++k) {
                    const int a = e.unit.id[k];
                    for (int b = 0; b < count_; ++b) {
                        if (b == a || (b < a && !body_[b].fixed)) continue;  // each pair once, fixed partners always
                        gravitation_.apply(loaded[k], mass_[a], *other_end(b), mass_[b]);
                    }
                }
            }
            if constexpr (S::forces) {
                for (const Thrust<N>& thrust : forces_) {
                    if (!thrust.is_on(steps_taken_)) continue;
                    if (LoadedBody<N>* b = find(thrust.body)) thrust.apply(*b);
                }
            }
            // Force to change of drift: F h^2 / m. The portion's own length enters squared.
            const Work part = e.seconds * e.seconds * steps_per_second_;
            for (int k = 0; k < e.unit.count; ++k) {
                const BodyData& body = body_[e.unit.id[k]];
                WorkVec3<N> angular;
                for (int i = 0; i < 3; ++i) angular[i] = loaded[k].torque_b[i] * (body.units.per_impulse(i) * part);
                kick(k, scaled_by(loaded[k].force_w, body.drift_per_impulse * part), angular);
            }
        }
    }

    void load(LoadedBody<N>& loaded, int b, const StageState<N>& stage, const Evaluate& e) const {
        loaded.stage = &stage;
        loaded.q_wb = work_quaternion<N>(stage.q_wb);
        loaded.force_w = loaded.torque_b = zero_vector<N>();
        if constexpr (Evaluate::may_depend_on_velocity) {
            for (int i = 0; i < 3; ++i) {
                loaded.v_w[i] = N::metres(stage.d_w[i], scale_) * e.steps_per_second;
                loaded.w_b[i] = N::half_turn(stage.t_b[i], scale_) * body_[b].units.rate(i, e.steps_per_second);
            }
        }
    }

    // Does the body feel anything but gravity in this step?
    [[nodiscard]] bool is_loaded(int b) const {
        if constexpr (S::drag)
            if (drag_.acts()) return true;
        if constexpr (S::gravitation)
            if (gravitation_.constant > Work(0) && count_ > 1) return true;
        if constexpr (S::springs > 0) {
            for (int s = 0; s < spring_count_; ++s)
                if (spring_[s].body == b || spring_[s].to_body == b) return true;
        }
        if constexpr (S::forces) {
            for (const Thrust<N>& thrust : forces_)
                if (thrust.body == b && thrust.is_on(steps_taken_)) return true;
        }
        return false;
    }
    // Does it feel another moving body?
    [[nodiscard]] bool is_coupled(int b) const {
        if constexpr (S::gravitation)
            if (gravitation_.constant > Work(0)) return true;
        if constexpr (S::springs > 0) {
            for (int s = 0; s < spring_count_; ++s) {
                if (spring_[s].to_body >= 0 && (spring_[s].body == b || spring_[s].to_body == b)) return true;
            }
        }
        return false;
    }

    void step_units(const StepInfo<N>& info) {
        Unit coupled;
        for (int b = 0; b < count_; ++b) {
            if (body_[b].fixed) continue;
            if constexpr (has_loads) {
                if (is_coupled(b)) {
                    coupled.id[coupled.count++] = static_cast<std::int16_t>(b);
                    continue;
                }
            }
            Unit alone;
            alone.count = 1;
            alone.id[0] = static_cast<std::int16_t>(b);
            advance_unit(alone, info);
        }
        if (coupled.count > 0) advance_unit(coupled, info);
    }

    // Free motion and loads of a unit for a portion of the step.
    void fly(const Unit& unit, const StepInfo<N>& info, const Portion& portion) {
        if (portion.whole) {
            fly_scaled(unit, info, gravity_, Work(1));
            return;
        }
        // In units of the portion, drift and spin shrink with it and accelerations with its square; the same code then
        // steps over the portion. Only the changes are scaled back, so that what did not change stays exact.
        const auto part = N::fraction(portion.length);
        const Work inverse = Work(1) / portion.length;
        struct Kept {
            State whole, scaled;
        };
        Kept kept[load_capacity];
        for (int k = 0; k < unit.count; ++k) {
            State& s = state_[unit.id[k]];
            kept[k].whole = s;
            for (int i = 0; i < 3; ++i) {
                N::add(s.d_w[i], N::part(N::sum(s.d_w[i]), part) - N::sum(s.d_w[i]));
                s.t_b[i].add(N::part(N::sum(s.t_b[i]), part) - N::sum(s.t_b[i]));
            }
            kept[k].scaled = s;
            prepare_spin(unit.id[k]);
        }
        DriftSum fall[3];
        for (int i = 0; i < 3; ++i) fall[i] = N::part(N::part(gravity_[i], part), part);
        fly_scaled(unit, info, fall, portion.length);
        for (int k = 0; k < unit.count; ++k) {
            State& s = state_[unit.id[k]];
            for (int i = 0; i < 3; ++i) {
                const Work linear = N::metres(N::sum(s.d_w[i]) - N::sum(kept[k].scaled.d_w[i]), scale_) * inverse;
                const Work angular = N::half_turn(N::sum(s.t_b[i]) - N::sum(kept[k].scaled.t_b[i]), scale_) * inverse;
                s.d_w[i] = kept[k].whole.d_w[i];
                s.t_b[i] = kept[k].whole.t_b[i];
                N::add(s.d_w[i], N::drift_sum(linear, scale_));
                s.t_b[i].add(N::turn_sum(angular, scale_));
            }
            prepare_spin(unit.id[k]);
        }
    }

    void fly_scaled(const Unit& unit, const StepInfo<N>& info, const DriftSum (&fall)[3], Work length) {
        if constexpr (has_loads) {
            if (unit.count > 1 || is_loaded(unit.id[0])) {
                const Evaluate evaluate{*this, unit, seconds_ * length,
                                        length == Work(1) ? steps_per_second_ : steps_per_second_ / length, fall};
                if (unit.count == 1) {
                    advance_loaded<1>(unit, evaluate, info);
                } else {
                    advance_loaded<load_capacity>(unit, evaluate, info);
                }
                return;
            }
        }
        coast(unit.id[0], fall);
        rotate(unit.id[0], info);
    }

    template <int capacity>
    void advance_loaded(const Unit& unit, const Evaluate& evaluate, const StepInfo<N>& info) {
        Group<N, Integrator::spin, Inertia, capacity> group;
        group.count = unit.count;
        for (int k = 0; k < unit.count; ++k) {
            group.body[k] = &state_[unit.id[k]];
            group.inertia[k] = &body_[unit.id[k]].inertia;
        }
        if (!Integrator::template advance<N, capacity>(group, evaluate, info))
            status_.set(Issue::step_bound_hit, unit.id[0], steps_taken_);
        for (int k = 0; k < unit.count; ++k) prepare_spin(unit.id[k]);
    }

    // --- contacts ------------------------------------------------------------------------------------------------

    void advance_unit(const Unit& unit, const StepInfo<N>& info) {
        if constexpr (has_contacts) {
            if (contact_.response == ContactResponse::impulse && plane_count_ > 0 && touches_anything(unit))
                fly_with_contacts(unit, info);
            else fly(unit, info, {});
        } else {
            fly(unit, info, {});
        }
        for (int k = 0; k < unit.count; ++k) check_range(unit.id[k]);
    }

    [[nodiscard]] bool touches_anything(const Unit& unit) const {
        for (int k = 0; k < unit.count; ++k)
            if (shape_[unit.id[k]].kind != ShapeKind::none) return true;
        return false;
    }

    [[nodiscard]] Placement<N> placement(int b) const {
        const State& s = state_[b];
        return {{N::sum(s.x_w.x), N::sum(s.x_w.y), N::sum(s.x_w.z)}, work_quaternion<N>(s.q_wb.value())};
    }
    // The least gap between the unit's bodies and the planes, m.
    [[nodiscard]] Work least_gap(const Unit& unit) const {
        Work least{};
        bool any = false;
        for (int k = 0; k < unit.count; ++k) {
            const int b = unit.id[k];
            if (shape_[b].kind == ShapeKind::none) continue;
            const Placement<N> place = placement(b);
            for (int p = 0; p < plane_count_; ++p) {
                const Work gap = PlaneView<N>{place, shape_[b], plane_[p], S::boxes}.gap();
                if (!any || gap < least) least = gap;
                any = true;
            }
        }
        return least;
    }

    struct Saved {
        State state[load_capacity];
    };
    void save(const Unit& unit, Saved& saved) const {
        for (int k = 0; k < unit.count; ++k) saved.state[k] = state_[unit.id[k]];
    }
    void restore(const Unit& unit, const Saved& saved) {
        for (int k = 0; k < unit.count; ++k) state_[unit.id[k]] = saved.state[k];
    }

    // One step with impacts. A flight that starts clear of the tolerance band and ends below the surface, or ends
    // deeper than the tolerance, is discarded and redone to the impact, found by a bracketed root finder on the gap;
    // then the rest of the step follows. After max_impacts (a ball coming to rest bounces without end in finite time)
    // the rest of the step is taken without another search and what still approaches is stopped.
    void fly_with_contacts(const Unit& unit, const StepInfo<N>& info) {
        for (int k = 0; k < unit.count; ++k) touching_[unit.id[k]] = 0;
        Work remaining(1);
        for (int impact = 0;; ++impact) {
            Saved start;
            save(unit, start);
            const Work gap_start = least_gap(unit);
            const Portion portion{impact == 0, remaining};
            fly(unit, info, portion);
            const Work gap_end = least_gap(unit);
            // In touch: within the band, and not on the way through it, as a ball is that a step has left above the
            // surface.
            const bool touched =
                gap_start <= contact_.tolerance && !(gap_start > Work(0) && gap_start - gap_end > contact_.slow);
            const bool too_deep = gap_end < (touched ? -contact_.tolerance : Work(0));
            if (!too_deep || impact == max_impacts) {
                resolve(unit, {start.state, false, touched, impact == max_impacts, too_deep && touched});
                return;
            }
            // The surface, or halfway to the tolerance for a body that was already in the band.
            const Work level =
                touched ? N::half_of(gap_start < Work(0) ? gap_start - contact_.tolerance : -contact_.tolerance)
                        : Work(0);
            const Work landed = land(unit, info, start, remaining, gap_start - level, gap_end - level, level);
            resolve(unit, {start.state, true, false, false, false});
            remaining -= landed;
            if (!(remaining > min_portion())) return;
        }
    }
    // Below this fraction of a step the rest is not worth a flight.
    [[nodiscard]] static constexpr Work min_portion() { return N::template constant<Work>(Real::scaled(1, -20)); }

    // Redoes the flight from `start` until the gap is at `level`; returns the portion of the step flown. Illinois'
    // variant of the secant method: the bracket [0, remaining] has gaps of opposite sign and never loses the root.
    Work land(const Unit& unit, const StepInfo<N>& info, const Saved& start, Work remaining, Work gap_low,
              Work gap_high, Work level) {
        Work low(0), high = remaining;
        if (!(gap_low > Work(0))) gap_low = N::half_of(contact_.tolerance);
        const Work close_enough = contact_.tolerance * N::template constant<Work>(Real::scaled(1, -16));
        const Work shortest = min_portion();
        Work at = high;
        int side = 0;
        for (int i = 0; i < max_resteps; ++i) {
            at = low + (high - low) * (gap_low / (gap_low - gap_high));
            if (at < low + shortest) at = low + shortest;
            if (at > high) at = high;
            restore(unit, start);
            fly(unit, info, {false, at});
            const Work gap = least_gap(unit) - level;
            if ((gap < close_enough && -close_enough < gap) || high - low < shortest) break;
            if (gap > Work(0)) {
                low = at;
                gap_low = gap;
                if (side > 0) gap_high = N::half_of(gap_high);
                side = 1;
            } else {
                high = at;
                gap_high = gap;
                if (side < 0) gap_low = N::half_of(gap_low);
                side = -1;
            }
        }
        return at;
    }

    // How a flight has ended.
    struct Touchdown {
        const State* start;  // of the unit's bodies, where the flight began
        bool impact;         // at the time of an impact; else at the end of the step
        bool resting;        // in touch since it began
        bool stop;           // the last: what still approaches is stopped
        bool sunk;           // deeper than the tolerance
    };

    // Impulses at all points in touch, and the position put right where a resting body has sunk.
    void resolve(const Unit& unit, const Touchdown& end) {
        for (int k = 0; k < unit.count; ++k) {
            const int b = unit.id[k];
            if (shape_[b].kind != ShapeKind::none) resolve_body(b, end.start[k], end);
        }
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

    void resolve_body(int b, const State& start, const Touchdown& end) {
        const BodyData& body = body_[b];
        const ContactShape<N>& shape = shape_[b];
        const Placement<N> place = placement(b);
        RigidMotion<N> motion;
        WorkVec3<N> v_w, fall_w;
        for (int i = 0; i < 3; ++i) {
            v_w[i] = N::metres(N::sum(state_[b].d_w[i]), scale_) * steps_per_second_;
            fall_w[i] = N::metres(N::sum(state_[b].d_w[i]) - N::sum(start.d_w[i]), scale_) * steps_per_second_;
            const Work rate = body.units.rate(i, steps_per_second_);
            motion.w[i] = N::half_turn(N::sum(state_[b].t_b[i]), scale_) * rate;
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
            const PlaneView<N> view{place, shape, plane, S::boxes};
            if (view.gap() > contact_.tolerance) continue;
            if (view.gap() < deepest) {
                deepest = view.gap();
                deepest_plane = &plane;
            }
            const Work e = combined_restitution(shape.restitution, plane.restitution, contact_.restitution);
            const Work mu = combined_friction(shape.friction, plane.friction, contact_.friction);
            view.for_each_point(S::boxes, [&](Work gap, const WorkVec3<N>& arm) {
                if (gap > contact_.tolerance) return;
                const Work v = dot(motion.at(arm), view.normal_b());
                // Still on its way to the surface: an impact of the next step.
                if (!end.impact && !end.stop && gap > Work(0) && v < -(contact_.slow * steps_per_second_)) return;
                if (count == contact::max_points) {
                    status_.set(Issue::contacts_full, b, steps_taken_);
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
                if (end.stop && e * v < -(contact_.slow * steps_per_second_))
                    status_.set(Issue::step_bound_hit, b, steps_taken_);
                c.target = target_velocity(v, gap, e, end.resting ? dot(fall_w, work_unit<N>(plane.normal)) : Work(0),
                                           end.stop);
            });
        }
        if (count == 0) return;
        touching_[b] = static_cast<std::uint8_t>(count);
        solve_impulses<N, S::friction>(motion, points, count);

        WorkVec3<N> linear = zero_vector<N>(), angular = zero_vector<N>();
        for (int c = 0; c < count; ++c) {
            const WorkVec3<N> j = scaled_by(points[c].normal, points[c].pushed) + points[c].dragged;
            linear += j;
            angular += cross<Work>(points[c].arm, j);
        }
        push(b, tumble::rotate(place.q_wb, linear), angular);

        // A resting body sinks by what gravity adds before the impulse; lift it back towards half the tolerance.
        if (deepest_plane != nullptr && (end.resting || end.sunk)) {
            const Work excess = -deepest - N::half_of(contact_.tolerance);
            if (excess > Work(0)) {
                for (int i = 0; i < 3; ++i) {
                    const Work lift = N::work(deepest_plane->normal[i]) * excess;
                    state_[b].x_w[i].add(N::position_sum(lift));
                }
            }
        }
    }

    // The normal velocity after the impact. A body that was in touch before the step bounces only with the speed it had
    // then, not with what loads (`fall`, m/s along the normal) have added since: a resting body must not hop. A point
    // still above the surface may close its gap.
    [[nodiscard]] Work target_velocity(Work v, Work gap, Work restitution, Work fall, bool stop) const {
        Work approach = fall < Work(0) ? v - fall : v;
        if (approach > Work(0) || stop || -approach < contact_.threshold) approach = Work(0);
        const Work bounce = -(restitution * approach);
        if (bounce > Work(0) || !(gap > Work(0))) return bounce;
        return -(gap * steps_per_second_);
    }

    Real step_length_;       // s
    DriftSum gravity_[3]{};  // change of drift a step, or half of it: see fall_in_halves
    State state_[S::bodies]{};
    BodyData body_[S::bodies]{};
    Status status_{};
    std::uint32_t steps_taken_ = 0;
    std::int16_t count_ = 0;
    typename N::Scale scale_;
    [[no_unique_address]] If<has_loads || has_contacts, Work, 0> steps_per_second_{};
    [[no_unique_address]] If<has_loads, Work, 1> seconds_{};
    [[no_unique_address]] If<S::drag, Drag<N>, 2> drag_{};
    [[no_unique_address]] If<S::gravitation, Gravitation<N>, 3> gravitation_{};
    [[no_unique_address]] If<S::gravitation, Array<Work, S::bodies>, 4> mass_{};
    [[no_unique_address]] If<(S::springs > 0), Array<Spring<N>, S::springs>, 5> spring_{};
    [[no_unique_address]] If<(S::springs > 0), int, 6> spring_count_{};
    [[no_unique_address]] If<S::forces, Span<Thrust<N>>, 7> forces_{};
    [[no_unique_address]] If<S::script, Span<Impulse<N>>, 8> script_{};
    [[no_unique_address]] If<S::script, int, 9> next_event_{};
    [[no_unique_address]] If<has_contacts, ContactSettings, 10> contact_{};
    [[no_unique_address]] If<has_contacts, Array<Plane<N>, S::planes>, 11> plane_{};
    [[no_unique_address]] If<has_contacts, int, 12> plane_count_{};
    [[no_unique_address]] If<has_contacts, Array<ContactShape<N>, S::bodies>, 13> shape_{};
    [[no_unique_address]] If<has_contacts, Array<std::uint8_t, S::bodies>, 14> touching_{};
};

}  // namespace tumble

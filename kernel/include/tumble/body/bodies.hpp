// The bodies of a world in fixed-size arrays: their state, their constants, and the status. The code does not depend on
// the method of integration, so worlds that differ only in the method share this code, the loads' and the contacts'.
#pragma once

#include <tumble/body/setup.hpp>
#include <tumble/body/words.hpp>
#include <tumble/numbers/vectors.hpp>
#include <tumble/status.hpp>

namespace tumble {

namespace detail {

// An array of n elements, which takes no room if n is 0.
template <class T, int n>
struct RoomFor {
    using Array = T[n];
};
template <class T>
struct RoomFor<T, 0> {
    struct Array {
        // Never called: there is no element.
        [[nodiscard]] constexpr T& operator[](int) { __builtin_unreachable(); }
        [[nodiscard]] constexpr const T& operator[](int) const { __builtin_unreachable(); }
    };
};
// The compiler knows the place of a single one.
template <class T>
struct RoomFor<T, 1> {
    struct Array {
        T only;
        [[nodiscard]] TUMBLE_INLINE constexpr T& operator[](int) { return only; }
        [[nodiscard]] TUMBLE_INLINE constexpr const T& operator[](int) const { return only; }
    };
};

// The parts of a step in which bodies rotate. Nothing where each spin has the same scale.
template <int capacity>
struct StepParts {
    std::int8_t halvings[capacity]{};  // of the step, of each body
    std::int8_t done = 0;              // parts of the present rotation; 0 between rotations
};
template <>
struct StepParts<0> {};

[[nodiscard]] constexpr std::uint64_t nearest_step(Real time, Real step_length) {
    const std::int64_t n = (time / step_length).to_fixed(0, 64);
    return n < 0 ? 0 : static_cast<std::uint64_t>(n);
}

}  // namespace detail

// Bodies that a step advances together, because loads couple them. A body alone is a group too.
template <int capacity>
struct BodyGroup {
    int count = 0;
    std::int16_t id[capacity];  // of `count` bodies

    BodyGroup() = default;
    explicit BodyGroup(int body) { add(body); }
    void add(int body) { id[count++] = static_cast<std::int16_t>(body); }
    // Adds a body that is not in the group yet.
    void add_once(int body) {
        for (int k = 0; k < count; ++k)
            if (id[k] == body) return;
        add(body);
    }
};

// In a world of one body its place is 0, and who asks for it knows that.
struct OnlyPlace {
    // Its place.
    [[nodiscard]] constexpr int operator[](int) const { return 0; }
    // A list of its place.
    [[nodiscard]] constexpr operator const std::int16_t*() const { return &place; }

private:
    static constexpr std::int16_t place = 0;
};
template <>
struct BodyGroup<1> {
    int count = 0;
    static constexpr OnlyPlace id{};

    BodyGroup() = default;
    explicit BodyGroup(int body) { add(body); }
    void add(int) { ++count; }
    void add_once(int) { count = 1; }
};
// A group that is not empty.
struct OnlyBody {
    static constexpr int count = 1;   // bodies
    static constexpr OnlyPlace id{};  // their places

    OnlyBody() = default;
    // Of a group that is not empty.
    OnlyBody(const BodyGroup<1>&) {}
    operator BodyGroup<1>() const { return BodyGroup<1>{0}; }
};
// At least one body of a world.
template <int capacity>
using SomeBodies = std::conditional_t<capacity == 1, OnlyBody, BodyGroup<capacity>>;

// The place of each body in the last group that had it. It is the place in another group only where that group agrees,
// so nothing is cleared from group to group (Briggs and Torczon 1993, "An efficient representation for sparse sets").
template <int capacity>
class BodyPlaces {
public:
    // The places of a group, as pointer to those of all bodies. Valid until the next call.
    [[nodiscard]] const std::int16_t* of(const BodyGroup<capacity>& group) {
        for (int k = 0; k < group.count; ++k) last_[group.id[k]] = static_cast<std::int16_t>(k);
        return last_;
    }

private:
    std::int16_t last_[capacity]{};
};

// Converts a spin to angular velocity and from angular momentum: half_turn_i = turn_per_impulse_i * L_i, w_i = rate_i *
// half_turn_i.
template <class N, Spin spin>
struct SpinUnits;

template <class N>
struct SpinUnits<N, Spin::angular_velocity> {
    using Work = typename N::Work;

    TUMBLE_COLD [[nodiscard]] static constexpr SpinUnits of(RealVec3 moments, Real step) {
        SpinUnits u;
        for (int i = 0; i < 3; ++i)
            u.turn_per_impulse_.set(i, N::template constant<Work>(step / (moments[i] * Real{2})));
        return u;
    }
    [[nodiscard]] static constexpr Real turn_of(RealVec3, Real spin, int, Real step) {
        return spin * step * Real::scaled(1, -1);
    }
    static constexpr bool has_one_rate = true, has_one_factor = false;  // for all axes: rate(), per_impulse()
    [[nodiscard]] constexpr Work per_impulse(int i) const { return turn_per_impulse_[i]; }
    [[nodiscard]] constexpr Work rate(int, Work steps_per_second) const { return steps_per_second + steps_per_second; }
    // rate() with the step as the unit of time.
    [[nodiscard]] Work per_half_turn(int) const {
        static constexpr Work two = Work(2);
        return two;
    }

private:
    [[no_unique_address]] Stored<Work, 3> turn_per_impulse_{};  // h / 2 I_i, rad/(N m s)
};

template <class N>
struct SpinUnits<N, Spin::angular_momentum> {
    using Work = typename N::Work;

    TUMBLE_COLD [[nodiscard]] static constexpr SpinUnits of(RealVec3 moments, Real step) {
        SpinUnits u;
        for (int i = 0; i < 3; i += 2)
            u.constants_.set(i, N::template constant<Work>(Real{2} * moments.y / moments[i]));
        u.constants_.set(1, N::template constant<Work>(step / (moments.y * Real{2})));
        return u;
    }
    [[nodiscard]] static constexpr Real turn_of(RealVec3 moments, Real spin, int i, Real step) {
        return spin * moments[i] / moments.y * step * Real::scaled(1, -1);
    }
    static constexpr bool has_one_rate = false, has_one_factor = true;
    [[nodiscard]] constexpr Work per_impulse(int) const { return constants_[1]; }
    [[nodiscard]] constexpr Work rate(int i, Work steps_per_second) const {
        return per_half_turn(i) * steps_per_second;
    }
    [[nodiscard]] constexpr Work per_half_turn(int i) const {
        constexpr Work two = Work(2);
        return i == 1 ? two : constants_[i];
    }

private:
    [[no_unique_address]] Stored<Work, 3> constants_{};  // 2 I_y / I_x, h / 2 I_y in rad/(N m s), 2 I_y / I_z
};

// The largest half turn in a step, rad, that a spin of 1 rad/s can be.
[[nodiscard]] constexpr Real turn_per_spin(Spin spin, Real step) {
    return spin == Spin::angular_velocity ? step * Real::scaled(1, -1) : step;
}

// What pushes a body: everything, or nothing. A kinematic body moves as its velocity says.
enum class MotionType : std::uint8_t { dynamic, fixed, kinematic };

// The constants of a body.
template <class N, Spin spin, bool points>
struct BodyConstants {
    typename N::Unit axes[4]{};                        // w, x, y, z: principal axes to the user's body axes
    [[no_unique_address]] SpinUnits<N, spin> units{};  // units of the spin
    AxisOrder order{};                                 // `axes`, where they are an order of axes
    MotionType motion = MotionType::fixed;             // so is a place without a body; kinematic ones move
    [[no_unique_address]] Stored<typename N::Work, 1> mass_units{};  // h / m

    // Nothing pushes it.
    [[nodiscard]] TUMBLE_INLINE constexpr bool fixed() const { return motion != MotionType::dynamic; }
    // Moves by itself.
    [[nodiscard]] TUMBLE_INLINE constexpr bool kinematic() const { return motion == MotionType::kinematic; }
    // Change of drift, m, by 1 N s.
    [[nodiscard]] TUMBLE_INLINE constexpr typename N::Work drift_per_impulse() const { return mass_units[0]; }
    // The same, to compute with.
    template <class Vector = Vec3<typename N::Unit>>
    [[nodiscard]] TUMBLE_INLINE constexpr Quat<typename N::Unit, Vector> principal() const {
        return {axes[0], {axes[1], axes[2], axes[3]}};
    }
};
// The constants of a point mass, in a world that has only point masses.
template <class N>
struct BodyConstants<N, Spin::none, false> {
    [[no_unique_address]] Stored<typename N::Work, 1> mass_units{};  // h / m
    MotionType motion = MotionType::fixed;  // so is a place without a body; kinematic ones move

    // Nothing pushes it.
    [[nodiscard]] TUMBLE_INLINE constexpr bool fixed() const { return motion != MotionType::dynamic; }
    // Moves by itself.
    [[nodiscard]] TUMBLE_INLINE constexpr bool kinematic() const { return motion == MotionType::kinematic; }
    // Change of drift, m, by 1 N s.
    [[nodiscard]] TUMBLE_INLINE constexpr typename N::Work drift_per_impulse() const { return mass_units[0]; }
};
// The constants of a body that may be a point mass.
template <class N, Spin spin>
struct BodyConstants<N, spin, true> : BodyConstants<N, spin, false> {
    bool is_point = false;  // without rotation
};

namespace detail {

// The step of a world: a member, or a constant of the program where `Constant::step` names it.
template <class N, Spin spin, class Constant>
struct StepOfWorld {
    static constexpr Real step_length = Constant::step.value;  // s
    static constexpr typename N::Scale scale = N::Scale::of(step_length, turn_per_spin(spin, step_length));
    // False where the declared spin never needs shorter parts than the step.
    static constexpr bool may_need_parts = [] {
        if constexpr (N::fixed_point) return scale.most_halvings > 0;
        else return false;
    }();
    static_assert(step_length > Real{}, "the scene's step must be positive");

    constexpr explicit StepOfWorld(Seconds) {}
};
template <class N, Spin spin>
struct StepOfWorld<N, spin, void> {
    [[no_unique_address]] Real step_length;  // s
    typename N::Scale scale;
    static constexpr bool may_need_parts = N::fixed_point;

    constexpr explicit StepOfWorld(Seconds step)
        : step_length{step.value}, scale{N::Scale::of(step.value, turn_per_spin(spin, step.value))} {
        TUMBLE_ASSERT(step.value > Real{});
    }
};

}  // namespace detail

// Without a spin all bodies are point masses; with `points` some may be. A point mass has no orientation and no spin:
// in a world with rotation, its orientation stays the identity and its spin zero.
template <class N, Spin spin, int capacity, bool points = false, class Constant = void>
class Bodies : public detail::StepOfWorld<N, spin, Constant> {
    static_assert(!(spin == Spin::none && points), "where nothing rotates, all bodies are point masses");
    using Step = detail::StepOfWorld<N, spin, Constant>;

public:
    using Step::scale, Step::step_length;
    using Numbers = N;
    using Work = typename N::Work;
    using State = BodyState<N, spin>;
    using Units = SpinUnits<N, spin>;
    using Constants = BodyConstants<N, spin, points>;
    static constexpr bool rotation = spin != Spin::none, has_points = points;
    static constexpr bool has_parts = rotation && capacity > 0 && Step::may_need_parts;
    static constexpr int room = capacity;

    constexpr explicit Bodies(Seconds step) : Step{step} {}

    // Adds a body at a place, which is free: the end or one that a body has left. Misuse: a point mass with a rotation
    // or a spin, a point mass in a world without point masses, and any other body in a world without rotation.
    TUMBLE_COLD constexpr void add(const BodySpec& spec, [[maybe_unused]] const PrincipalInertia& inertia, int b) {
        TUMBLE_ASSERT(spec.mass > Real{});
        TUMBLE_ASSERT(has_positive_size(spec.shape));
        if (b == count) ++count;
        Constants& body = constants[b];
        body.mass_units.set(0, N::template constant<Work>(step_length / spec.mass));
        State& s = state[b];
        for (int i = 0; i < 3; ++i) {
            assign(s.x_w[i], spec.position[i]);
            assign(s.d_w[i],
                   spec.fixed && !spec.kinematic ? Real{} : scale.drift_units(spec.velocity[i] * step_length));
        }
        body.motion = spec.kinematic ? MotionType::kinematic : spec.fixed ? MotionType::fixed : MotionType::dynamic;
        if constexpr (!rotation) TUMBLE_ASSERT(is_point_mass(spec));
        if constexpr (points) body.is_point = is_point_mass(spec);
        if (!rotates(b)) TUMBLE_ASSERT(spec.orientation.v.is_zero() && spec.angular_velocity.is_zero());
        if constexpr (rotation) set_rotation(b, spec, inertia);
        check_range(b);
    }
    // Leaves a place without a body, as one that no body has had.
    void remove(int b) {
        state[b] = {};
        constants[b] = {};
        if constexpr (has_parts) parts.halvings[b] = 0;
    }
    // False of a point mass.
    [[nodiscard]] TUMBLE_INLINE constexpr bool rotates([[maybe_unused]] int b) const {
        if constexpr (points) return !constants[b].is_point;
        else return rotation;
    }

    // The step nearest to a time. 0 for times before the start, 2^63 - 1 for times after 2^63 steps.
    [[nodiscard]] constexpr std::uint64_t step_of(Real time) const { return detail::nearest_step(time, step_length); }
    // The index of a body that has been added. Any other id is misuse.
    [[nodiscard]] TUMBLE_INLINE constexpr int index_of(BodyId id) const { return index_of(id.index()); }
    [[nodiscard]] TUMBLE_INLINE constexpr int index_of(int b) const {
        TUMBLE_ASSERT(b >= 0 && b < count);
        if constexpr (capacity == 1) return 0;  // every address is known
        else return b;
    }
    // A block in the user's body axes, in principal axes; below: back.
    template <class Block>
    [[nodiscard]] TUMBLE_INLINE constexpr Block in_principal_axes(int b, const Block& user) const requires(rotation) {
        const Constants& body = constants[b];
        if constexpr (N::fixed_point)
            if (std::is_constant_evaluated() && !body.order.is_known())
                return user.rotated_back(body.template principal<StoredVec3<typename N::Unit>>());
        return body.order.is_known() ? user.ordered(body.order) : user.rotated_back(body.principal());
    }
    template <class Block>
    [[nodiscard]] TUMBLE_INLINE Block in_users_axes(int b, const Block& block) const requires(rotation) {
        const Constants& body = constants[b];
        return body.order.is_known() ? block.ordered_back(body.order) : block.rotated(body.principal());
    }
    // From the user's body axes to principal axes.
    [[nodiscard]] WorkVec3<N> principal_vector([[maybe_unused]] int b, RealVec3 v) const {
        if constexpr (!rotation) return work_vector<N>(v);
        else return rotate(work_quaternion<N>(constants[b].principal().conjugate()), work_vector<N>(v));
    }

    // h / m of a body, h in s.
    [[nodiscard]] constexpr Work step_per_mass(int b) const { return constants[b].drift_per_impulse(); }
    // h / I about principal axis i.
    [[nodiscard]] constexpr Work step_per_moment(int b, int i) const requires(rotation) {
        return constants[b].units.per_impulse(i) * constants[b].units.rate(i, Work(1));
    }

    // A spin beyond the format is held in half turns of 2^-halvings of the step, and the rotation of a step has as many
    // parts. The scale of the body's spin:
    [[nodiscard]] TUMBLE_INLINE constexpr int halvings_of([[maybe_unused]] int b) const {
        if constexpr (has_parts) return parts.halvings[b];
        else return 0;
    }
    [[nodiscard]] TUMBLE_INLINE constexpr typename N::Scale spin_scale([[maybe_unused]] int b) const {
        if constexpr (has_parts) return scale.halved(parts.halvings[b]);
        else return scale;
    }
    // The most halvings of a spin, and the scale of one with so many.
    [[nodiscard]] constexpr int most_halvings() const {
        if constexpr (has_parts) return scale.most_halvings;
        else return 0;
    }
    [[nodiscard]] constexpr typename N::Scale finest_scale() const {
        if constexpr (has_parts) return scale.halved(scale.most_halvings);
        else return scale;
    }
    // Halves the parts; false where they are as short as the range needs.
    [[gnu::noinline, gnu::cold]] constexpr bool halve_parts(int b) requires(has_parts) {
        if (parts.halvings[b] >= scale.most_halvings) return false;
        ++parts.halvings[b];
        N::halve(state[b].t_b);
        return true;
    }
    // Halves the parts until the spin is in its range. Returns whether it did.
    TUMBLE_INLINE constexpr bool fit_parts([[maybe_unused]] int b) {
        bool halved = false;
        if constexpr (has_parts)
            while (N::spins_out_of_range(state[b]) && halve_parts(b)) halved = true;
        return halved;
    }
    // Ends a part of a rotation; a spin that has left its range in it has shorter parts from here on. False after the
    // last one. Below: halves the present part, which has not been done; false where it is as short as the range needs.
    bool end_part(int b) requires(has_parts) {
        int done = parts.done + 1;
        for (; N::spins_out_of_range(state[b]) && halve_parts(b);) done *= 2;
        (void)check_range(b);  // a later part may bring the spin back
        const bool left = done < 1 << parts.halvings[b];
        parts.done = static_cast<std::int8_t>(left ? done : 0);
        return left;
    }
    bool repeat_part(int b) requires(has_parts) {
        if (!halve_parts(b)) return false;
        parts.done = static_cast<std::int8_t>(2 * parts.done - 1);  // the end of this part is counted nevertheless
        return true;
    }
    // Doubles the parts of a body that has become slow. z_up: the rotation needs room for the spin about z times
    // 2^z_up. Returns whether it did.
    [[gnu::noinline, gnu::cold]] bool settle_parts(int b, int z_up) requires(has_parts) {
        const int before = parts.halvings[b];
        for (; parts.halvings[b] > 0 && N::is_slow(state[b].t_b, z_up); --parts.halvings[b]) N::twice(state[b].t_b);
        return parts.halvings[b] != before;
    }
    // Takes a spin of a scale with so many halvings to that of the body, which has as many or more.
    void to_scale_of(int b, auto& t_b, int halvings) const {
        if constexpr (has_parts)
            for (; halvings < parts.halvings[b]; ++halvings) N::halve(t_b);
    }
    // Sets the halvings of a spin that has the scale of so many. A step has no shorter parts than the range needs: a
    // spin that asks for them leaves its range.
    void set_halvings(int b, int halvings) requires(has_parts) {
        for (; halvings > scale.most_halvings; --halvings) N::twice_or_beyond(state[b].t_b);
        parts.halvings[b] = static_cast<std::int8_t>(halvings);
    }
    constexpr void stop(int b) requires(rotation) {
        state[b].d_w = {};
        stop_spin(b);
    }
    constexpr void stop_spin(int b) requires(rotation) {
        state[b].t_b = {};
        if constexpr (has_parts) parts.halvings[b] = 0;
    }
    // Calls change(spin, its scale) for the spin of the body, and again in shorter parts where it would leave its
    // range.
    template <class F>
    TUMBLE_INLINE void change_spin(int b, F&& change) requires(rotation) {
        if constexpr (has_parts) {
            struct {
                decltype(State::t_b) t_b;
            } changed{state[b].t_b};
            while (change(changed.t_b, spin_scale(b)), N::spins_out_of_range(changed) && halve_parts(b))
                changed.t_b = state[b].t_b;
            state[b].t_b = changed.t_b;
        } else {
            change(state[b].t_b, scale);
        }
    }

    // Reports range_left if the body left its range. most_turn: the longest half turn in a step that the method follows
    // in floating point, rad; 0: any. Returns whether the spin has another scale from here on.
    TUMBLE_INLINE constexpr bool check_range(int b, double most_turn = 0) {
        if (N::out_of_range(state[b], most_turn)) [[unlikely]]
            return leave_range(b);
        return false;
    }
    [[gnu::noinline]] constexpr bool leave_range(int b) {
        const bool halved = fit_parts(b);
        if constexpr (has_parts)
            if (!N::out_of_range(state[b], 0)) return halved;
        N::saturate(state[b]);
        report(Issue::range_left, b);
        return halved;
    }
    // True of a fixed body that spins.
    [[nodiscard]] constexpr bool is_turning(int b) const requires(rotation) {
        for (int i = 0; i < 3; ++i)
            if (!(state[b].t_b[i].value() == typename N::Turn{})) return true;
        return false;
    }
    // True of a body whose centre of mass moves.
    [[nodiscard]] constexpr bool is_drifting(int b) const { return !(state[b].d_w == decltype(State::d_w){}); }
    // True of a kinematic body with a velocity.
    [[nodiscard]] constexpr bool moves_by_itself(int b) const {
        if (!constants[b].kinematic()) return false;
        if constexpr (rotation) return is_drifting(b) || is_turning(b);
        else return is_drifting(b);
    }
    // True of a body without any velocity.
    [[nodiscard]] bool is_at_rest(int b) const requires(rotation) {
        const State& s = state[b];
        return s.d_w == decltype(s.d_w){} && s.t_b == decltype(s.t_b){};
    }
    constexpr void report(Issue issue, int b) { status.set(issue, b, steps_taken); }

    [[nodiscard]] Work steps_per_second() const { return N::template constant<Work>(Real{1} / step_length); }
    [[nodiscard]] std::uint64_t hash() const {
        Hash h;
        for (int b = 0; b < count; ++b) {
            h.add(state[b], rotates(b));
            if (halvings_of(b) > 0) h.add(static_cast<std::uint32_t>(halvings_of(b)));
        }
        return h.value();
    }

    // Writes or reads how body b stands and moves, with a spin of the kind `from`. Another kind than that of this world
    // is read as the same angular velocity, to rounding. A point mass has the numbers that it has in a world without
    // rotation, and a scale is there whether spins of this world may have another or not.
    template <class Self, class Archive>
    static void archive(Self& self, int b, Archive& to, [[maybe_unused]] Spin from) {
        auto& s = self.state[b];
        if constexpr (!Archive::reads && N::fixed_point)
            if (to.compares()) to.require(is_in_range(self, b, to, from));
        to(s.x_w, s.d_w);
        if constexpr (rotation) {
            if (!self.rotates(b)) return;
            to(s.q_wb);
            constexpr Spin other = spin == Spin::angular_velocity ? Spin::angular_momentum : Spin::angular_velocity;
            if (from != spin) return archive_other_spin<other>(self, b, to);
            to(s.t_b);
            if constexpr (has_parts) (void)to.within(self.parts.halvings[b], 0, self.scale.most_halvings);
            else if constexpr (N::fixed_point) archive_no_halvings(to);
        }
    }

    // The state in SI units. World documents these functions.
    [[nodiscard]] WorkVec3<N> position(int b) const {
        const State& s = state[b];
        return {N::metres(N::sum(s.x_w.x)), N::metres(N::sum(s.x_w.y)), N::metres(N::sum(s.x_w.z))};
    }
    [[nodiscard]] WorkVec3<N> velocity(int b) const {
        const Work rate = steps_per_second();
        WorkVec3<N> v;
        for (int i = 0; i < 3; ++i) v[i] = drift(b, i) * rate;
        return v;
    }
    // The way in a step along axis i of the world, m.
    [[nodiscard]] TUMBLE_INLINE Work drift(int b, int i) const { return N::metres(N::sum(state[b].d_w[i]), scale); }
    // The angle turned in a step about principal axis i, rad.
    [[nodiscard]] Work turn(int b, int i) const requires(rotation) { return turn(b, i, state[b], spin_scale(b)); }
    // The same of another state of the body.
    [[nodiscard]] Work turn(int b, int i, const State& s, typename N::Scale unit) const requires(rotation) {
        return N::half_turn(N::sum(s.t_b[i]), unit) * constants[b].units.rate(i, Work(1));
    }
    [[nodiscard]] WorkVec3<N> angular_velocity([[maybe_unused]] int b) const {
        if constexpr (rotation) {
            if (rotates(b)) {
                const Work rate = steps_per_second();
                WorkVec3<N> w;
                for (int i = 0; i < 3; ++i)
                    w[i] = N::half_turn(state[b].t_b[i].value(), spin_scale(b)) * constants[b].units.rate(i, rate);
                return rotate(work_quaternion<N>(constants[b].principal()), w);
            }
        }
        return zero_vector<N>();
    }
    [[nodiscard]] Quat<Work> orientation([[maybe_unused]] int b) const {
        if constexpr (rotation) {
            if (rotates(b)) {
                const Quat<Work> q = work_quaternion<N>(state[b].q_wb.value()),
                                 p = work_quaternion<N>(constants[b].principal()).conjugate();
                const WorkVec3<N> v = scaled_by(p.v, q.w) + scaled_by(q.v, p.w) + cross<Work>(q.v, p.v);
                return {q.w * p.w - dot(q.v, p.v), v};
            }
        }
        return {Work(1), zero_vector<N>()};
    }

    [[no_unique_address]] typename detail::RoomFor<State, capacity>::Array state{};
    [[no_unique_address]] typename detail::RoomFor<Constants, capacity>::Array constants{};
    Status status{};
    std::uint32_t steps_taken = 0;  // modulo 2^32
    std::int16_t count = 0;         // of places up to the last that has had a body
    [[no_unique_address]] detail::StepParts<has_parts ? capacity : 0> parts{};

private:
    // Whether the state that comes next is one that a step may leave.
    [[nodiscard, gnu::noinline, gnu::cold]] static bool is_in_range(const auto& self, int b, const auto& to,
                                                                    [[maybe_unused]] Spin from) {
        State found{};
        if constexpr (rotation) {
            if (self.rotates(b)) {
                if (from == spin) to.look_ahead(found.x_w, found.d_w, found.q_wb, found.t_b);
                else to.look_ahead(found.x_w, found.d_w, found.q_wb);
                return !N::out_of_range(found, 0) && N::is_unit(found.q_wb.value());
            }
        }
        to.look_ahead(found.x_w, found.d_w);
        return !N::out_of_range(found, 0);
    }
    static void archive_no_halvings(auto& to) {
        int none = 0;
        (void)to.within(none, 0, 0);
    }
    template <Spin from, class Self, class Archive>
    [[gnu::noinline, gnu::cold]] static void archive_other_spin(Self& self, int b, Archive& to) {
        SpinVec3<N, from> t_b{};
        to(t_b);
        auto unit = N::Scale::of(self.step_length, turn_per_spin(from, self.step_length));
        if constexpr (N::fixed_point) {
            int halvings = 0;
            halvings = to.within(halvings, 0, unit.most_halvings);
            unit = unit.halved(halvings);
        }
        if constexpr (Archive::reads) {
            const auto& units = self.constants[b].units;
            Work turn[3];
            for (int i = 0; i < 3; ++i) {
                turn[i] = N::half_turn(N::sum(t_b[i]), unit);  // h/2 omega_i is h/2 L_i / I_y times I_y / I_i
                if constexpr (spin == Spin::angular_velocity)
                    turn[i] = turn[i] * (units.per_impulse(i) / units.per_impulse(1));
                else turn[i] = turn[i] * (Work(2) / units.per_half_turn(i));
            }
            self.stop_spin(b);
            self.change_spin(b, [&](auto& to_spin, typename N::Scale scale_of_spin) {
                for (int i = 0; i < 3; ++i) N::add_any(to_spin[i], turn[i], scale_of_spin);
            });
        }
    }
    TUMBLE_COLD constexpr void set_rotation(int b, const BodySpec& spec,
                                            const PrincipalInertia& inertia) requires(rotation) {
        Constants& body = constants[b];
        State& s = state[b];
        if (!rotates(b)) {
            set_axes(body, {});
            s.q_wb.w = N::IntegratedUnit::from(1);
            return;
        }
        TUMBLE_ASSERT(inertia.moments.z > Real{});
        TUMBLE_ASSERT(are_of_a_body(inertia.moments));
        body.units = Units::of(inertia.moments, step_length);
        set_axes(body, inertia.principal);
        body.order = inertia.order;
        const RealQuat q = normalized(detail::product(normalized(spec.orientation), inertia.principal));
        s.q_wb.w = N::IntegratedUnit::from(q.w);
        s.q_wb.x = N::IntegratedUnit::from(q.v.x);
        s.q_wb.y = N::IntegratedUnit::from(q.v.y);
        s.q_wb.z = N::IntegratedUnit::from(q.v.z);
        const RealVec3 w = detail::rotated_back(inertia.principal, spec.angular_velocity);
        do {
            for (int i = 0; i < 3; ++i)
                assign(s.t_b[i], spin_scale(b).turn_units(Units::turn_of(inertia.moments, w[i], i, step_length)));
        } while (starts_too_fast(b));
    }
    // Halves the parts of a spin that leaves its range.
    [[nodiscard]] constexpr bool starts_too_fast([[maybe_unused]] int b) requires(rotation) {
        if constexpr (has_parts) return N::spins_out_of_range(state[b]) && halve_parts(b);
        else return false;
    }
    template <class Number>
    static constexpr void assign(Number& number, Real value) {
        number = Number::from(value);
    }
    static constexpr void set_axes(Constants& body, const RealQuat& q) {
        body.axes[0] = N::template constant<typename N::Unit>(q.w);
        for (int i = 0; i < 3; ++i) body.axes[i + 1] = N::template constant<typename N::Unit>(q.v[i]);
    }
};

// How bodies are and move, to come back to it. Places without a copy are not initialised, which saves time.
template <class Bodies>
class SavedMotions {
    using State = typename Bodies::State;

public:
    void save(int k, const Bodies& bodies, int b) {  // the motion of body b, as copy k
        copy(std::launder(reinterpret_cast<State*>(states_))[k], bodies.state[b]);
        if constexpr (Bodies::has_parts) halvings_[k] = bodies.parts.halvings[b];
    }
    void restore(int k, Bodies& bodies, int b) const {  // the motion of body b, from copy k
        copy(bodies.state[b], (*this)[k]);
        if constexpr (Bodies::has_parts) bodies.parts.halvings[b] = halvings_[k];
    }
    [[nodiscard]] const State& operator[](int k) const {
        return std::launder(reinterpret_cast<const State*>(states_))[k];
    }
    [[nodiscard]] int halvings(int k) const requires(Bodies::has_parts) { return halvings_[k]; }  // of copy k
    [[nodiscard]] auto spin_scale([[maybe_unused]] int k, const Bodies& bodies) const {           // of copy k
        if constexpr (Bodies::has_parts) return bodies.scale.halved(halvings_[k]);
        else return bodies.scale;
    }

private:
    // Without a call of memcpy().
    TUMBLE_INLINE static void copy(State& to, const State& from) {
        to.x_w = from.x_w;
        detail::keep_apart();
        to.d_w = from.d_w;
        if constexpr (Bodies::rotation) {
            detail::keep_apart();
            to.q_wb = from.q_wb;
            detail::keep_apart();
            to.t_b = from.t_b;
        }
    }

    static_assert(std::is_aggregate_v<State> && std::is_trivially_copyable_v<State>);  // lives where it is assigned
    alignas(State) std::byte states_[sizeof(State) * Bodies::room];
    [[no_unique_address]] typename detail::RoomFor<std::int8_t, Bodies::has_parts ? Bodies::room : 0>::Array halvings_;
};

}  // namespace tumble

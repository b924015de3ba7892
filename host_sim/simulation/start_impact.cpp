#include "simulation/start_impact.hpp"

#include <tumble/body/mass.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "scene/data.hpp"
#include "simulation/long_double.hpp"

namespace tumble::host {
namespace {

using namespace reference;

constexpr Vector world_axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

// What counts, of the speeds of both sides.
constexpr Number least_share = 1e-3;

// In world axes.
struct Side {
    Vector x, v, w;            // m, m/s, rad/s
    Rotation q, to_principal;  // of the user's axes to the world; of the world to principal axes
    Number mass = 0;           // kg; 0: nothing moves it
    Vector moments;            // kg m^2
};

// A direction in which a joint lets its sides not part, or about which it lets them not turn.
struct Row {
    std::size_t joint = 0;
    bool turns = false;
    Vector axis;                   // unit
    std::array<int, 2> bodies{};   // -1: the world
    std::array<Vector, 2> arms{};  // m, of the anchors
    Number rate = 0;               // m/s or rad/s, of `body` against `to_body`
};

std::array<Vector, 2> perpendicular_to(const Vector& axis) {
    const auto size = [&](const Vector& v) { return std::abs(dot(v, axis)); };
    const Vector& least = *std::min_element(std::begin(world_axes), std::end(world_axes),
                                            [&](const Vector& a, const Vector& b) { return size(a) < size(b); });
    const Vector one = unit(cross(axis, least));
    return {one, cross(axis, one)};
}

class Impact {
public:
    explicit Impact(const SceneDescription& scene) : scene_(scene) {
        const SceneData data = build_scene(scene);
        for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
            const BodyDescription& body = scene.bodies[b];
            Side side;
            side.x = vector_of(body.position);
            side.q = rotation_of(body.orientation).normalized();
            if (!body.fixed) {
                const PrincipalInertia inertia = principal_inertia(data.bodies[b].inertia);
                side.v = vector_of(body.velocity);
                side.w = side.q.rotate(vector_of(body.angular_velocity));
                side.to_principal = (side.q * rotation(inertia.principal).normalized()).conjugate();
                side.mass = number(data.bodies[b].mass);
                side.moments = vector(inertia.moments);
            }
            sides_.push_back(side);
        }
        for (std::size_t j = 0; j < scene.joints.size(); ++j) add_rows(j);
    }

    [[nodiscard]] StartImpact result() const {
        StartImpact impact;
        impact.energy = energy();
        Number worst = 0;
        for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
            const JointDescription& joint = scene_.joints[j];
            const auto counting = [&](bool turns) {
                Number sum = 0;
                for (const Row& row : rows_)
                    if (row.joint == j && row.turns == turns) sum += row.rate * row.rate;
                const Number size = std::sqrt(sum),
                             of_sides = speed_of(joint, joint.body, turns) + speed_of(joint, joint.to_body, turns);
                return size > least_share * of_sides ? size : 0;
            };
            const Number speed = counting(false), spin = counting(true);
            if (!(speed > 0) && !(spin > 0)) continue;
            if (impact.joint >= 0) ++impact.others;
            if (std::max(speed, spin) <= worst) continue;
            worst = std::max(speed, spin);
            impact.joint = static_cast<int>(j);
            impact.speed = speed;
            impact.spin = spin;
        }
        if (impact.joint >= 0) fit(impact);
        return impact;
    }

private:
    [[nodiscard]] Side side(int b) const { return b < 0 ? Side{} : sides_[static_cast<std::size_t>(b)]; }
    [[nodiscard]] Vector arm(const JointDescription& joint, int b) const {
        return b < 0 ? Vector{} : vector_of(joint.anchor_on(b)) - side(b).x;
    }
    // Of a side: a bound on the speed of its anchor, or its spin. A difference is judged against this.
    [[nodiscard]] Number speed_of(const JointDescription& joint, int b, bool turns) const {
        const Side of = side(b);
        return turns ? norm(of.w) : norm(of.v) + norm(of.w) * norm(arm(joint, b));
    }
    // The velocity of `body` against `to_body`, at the anchor or of the spin.
    [[nodiscard]] Vector rate_of(const JointDescription& joint, bool turns) const {
        const Side own = side(joint.body), other = side(joint.to_body);
        if (turns) return own.w - other.w;
        return own.v + cross(own.w, arm(joint, joint.body)) - other.v - cross(other.w, arm(joint, joint.to_body));
    }

    void add_rows(std::size_t j) {
        const JointDescription& joint = scene_.joints[j];
        const auto add = [&](bool turns, const Vector& axis) {
            rows_.push_back({j,
                             turns,
                             axis,
                             {joint.body, joint.to_body},
                             {arm(joint, joint.body), arm(joint, joint.to_body)},
                             dot(axis, rate_of(joint, turns))});
        };
        const auto add_all = [&](bool turns, const auto& axes) {
            for (const Vector& axis : axes) add(turns, axis);
        };
        switch (joint.kind) {
        case JointKind::distance:
            if (joint.is_rod()) add(false, unit(vector_of(joint.anchor) - vector_of(joint.to_point)));
            return;
        case JointKind::slider:
            add_all(false, perpendicular_to(unit(vector_of(joint.axis))));
            add_all(true, world_axes);
            return;
        case JointKind::hinge: add_all(true, perpendicular_to(unit(vector_of(joint.axis)))); break;
        case JointKind::universal: add(true, unit(cross(vector_of(joint.axis), vector_of(joint.to_axis)))); break;
        case JointKind::fixed: add_all(true, world_axes); break;
        case JointKind::ball: break;
        }
        add_all(false, world_axes);
    }

    // The rate along one row that a unit impulse along another gives.
    [[nodiscard]] Number response(const Row& one, const Row& other) const {
        Number sum = 0;
        for (std::size_t a = 0; a < 2; ++a)
            for (std::size_t b = 0; b < 2; ++b) {
                if (one.bodies[a] != other.bodies[b] || one.bodies[a] < 0) continue;
                const Side of = side(one.bodies[a]);
                if (of.mass == 0) continue;
                const auto turning = [&](const Row& row, std::size_t i) {
                    return of.to_principal.rotate(row.turns ? row.axis : cross(row.arms[i], row.axis));
                };
                Number both = dot(turning(one, a), over(turning(other, b), of.moments));
                if (!one.turns && !other.turns) both += dot(one.axis, other.axis) / of.mass;
                sum += a == b ? both : -both;
            }
        return sum;
    }

    // r A^-1 r / 2 with the rates r of the rows and their responses A, which are positive definite: joints form trees.
    [[nodiscard]] Number energy() const {
        const std::size_t n = rows_.size();
        std::vector<std::vector<Number>> a(n, std::vector<Number>(n));
        std::vector<Number> rates;
        for (const Row& row : rows_) rates.push_back(row.rate);
        if (std::all_of(rates.begin(), rates.end(), [](Number rate) { return rate == 0; })) return 0;
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t k = 0; k <= i; ++k) a[i][k] = a[k][i] = response(rows_[i], rows_[k]);
        Number sum = 0;
        for (std::size_t i = 0; i < n; ++i) {
            if (!(a[i][i] > 0)) continue;
            sum += rates[i] * rates[i] / (2 * a[i][i]);
            for (std::size_t k = i + 1; k < n; ++k) {
                const Number factor = a[k][i] / a[i][i];
                if (factor == 0) continue;
                rates[k] -= factor * rates[i];
                for (std::size_t m = i; m < n; ++m) a[k][m] -= factor * a[i][m];
            }
        }
        return sum;
    }

    // Takes from one side what the joint does not allow, first of its spin.
    void fit(StartImpact& impact) const {
        const JointDescription& joint = scene_.joints[static_cast<std::size_t>(impact.joint)];
        const bool is_own = !scene_.body(joint.body).fixed;
        impact.body = is_own ? joint.body : joint.to_body;
        const int beside = is_own ? joint.to_body : joint.body;
        Side fitting = side(impact.body);
        const Side other = side(beside);
        const auto take = [&](bool turns, Vector& from, const auto& rate) {
            const Vector before = rate();
            for (const Row& row : rows_)
                if (row.joint == static_cast<std::size_t>(impact.joint) && row.turns == turns)
                    from = from - row.axis * dot(row.axis, before);
        };
        take(true, fitting.w, [&] { return fitting.w - other.w; });
        take(false, fitting.v, [&] {
            return fitting.v + cross(fitting.w, arm(joint, impact.body)) - other.v - cross(other.w, arm(joint, beside));
        });
        const Vector spin = fitting.q.rotate_back(fitting.w);
        const auto triple = [](const Vector& v, Number size) {
            const auto rounded = [&](Number x) { return std::abs(x) < 1e-9L * size ? 0.0 : static_cast<double>(x); };
            return Triple{rounded(v.x), rounded(v.y), rounded(v.z)};
        };
        impact.velocity = triple(fitting.v, speed_of(joint, impact.body, false) + speed_of(joint, beside, false));
        impact.angular_velocity = triple(spin, norm(side(impact.body).w) + norm(other.w));
    }

    const SceneDescription& scene_;
    std::vector<Side> sides_;
    std::vector<Row> rows_;
};

}  // namespace

StartImpact impact_at_start(const SceneDescription& scene) {
    if (scene.joints.empty()) return {};
    return Impact(scene).result();
}

}  // namespace tumble::host

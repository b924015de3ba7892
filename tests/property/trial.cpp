// A scene is made of the field's numbers without unit, each drawn log-uniformly between what has no effect and what no
// step follows: h w of springs, h c/m of drag and dampers, h |w| of spins, v h / size, a h^2 / size of accelerations,
// mass ratios, slenderness, tolerance / size, distance / size. Nothing keeps a scene from being chaotic, stiff or
// absurd: the judge says what it cannot decide. A statement draws once, or in braces, whose order is the same with
// every compiler; the order of operands and arguments is not.
#include "trial.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "../kernel/random.hpp"
#include "simulation/simulation.hpp"
#include "truth/motion.hpp"

namespace tumble::test {
namespace {

using namespace host;
using host::runs_in;
using Vector = reference::Vec<double>;

Triple triple(const Vector& v) { return {v.x, v.y, v.z}; }
Vector vector(const Triple& t) { return {t[0], t[1], t[2]}; }

class Draw : public Random {
public:
    using Random::Random;

    bool one_in(int n) { return between(1, n) == 1; }
    template <class T>
    const T& of(const std::vector<T>& choices) {
        return choices[static_cast<std::size_t>(between(0, static_cast<int>(choices.size()) - 1))];
    }
    // Any power of two between the ends is as likely as another.
    double magnitude(double low, double high) {
        const int exponent = between(std::ilogb(low), std::ilogb(high));
        return std::clamp(std::ldexp(uniform(1.0, 2.0), exponent), low, high);
    }
    // Of unit length; a third of them along an axis of the world.
    Vector direction() {
        Vector v;
        if (one_in(3)) v[between(0, 2)] = one_in(2) ? 1 : -1;
        while (!(norm(v) > 0.1 && norm(v) <= 1)) v = Vector{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
        return v * (1 / norm(v));
    }
    // Of this length, which is drawn before.
    Vector along(double length) { return direction() * length; }
};

class Maker {
public:
    Maker(std::uint64_t seed, std::uint64_t index) : draw_(Random(Random(seed).bits() ^ (index << 20)).bits()) {}

    Trial make(bool has_joints) {
        draw_method();
        draw_step();
        size_ = draw_.magnitude(0.01, 2);
        // Far from the origin floats round a pose by more than a short arm.
        if (draw_.one_in(3) && !has_joints) centre_ = draw_.along(std::min(size_ * draw_.magnitude(1, 1e5), 2e4));
        scene_.duration = draw_.magnitude(20, 512) * h_;
        const int kind = has_joints ? 7 : draw_.between(1, 6);
        constexpr const char* kinds[] = {"flight",  "springs", "orbits", "soft contacts",
                                         "impacts", "impacts", "joints"};
        trial_.kind = kinds[kind - 1];
        if (has_joints) mechanism();
        else if (kind < 4) flight();
        else contacts(kind == 4 ? ContactResponse::spring : ContactResponse::impulse);
        if (kind == 2)
            for (int b = 0; b < static_cast<int>(scene_.bodies.size()); ++b) add_spring(b);
        if (kind == 3) add_gravitation();
        declare_range();
        if (draw_.one_in(20)) make_absurd();
        return trial_;
    }

private:
    void draw_method() {
        Method& method = trial_.method;
        const int system = draw_.between(1, 14);
        method.numbers = system <= 8 ? "q32" : system <= 12 ? "f32" : "f64";
        method.carry = system <= 6 || system == 9 || system == 10;
        do method.integrator = draw_.one_in(2) ? "verlet" : draw_.of(host::integrators()).name;
        while (!runs_in(find_integrator(method.integrator), method.numbers));
    }
    void draw_step() {
        StepSize& step = scene_.step;
        if (draw_.one_in(2)) step = {1, std::int64_t{1} << draw_.between(4, 13), 0};
        else if (draw_.one_in(3)) step = {1, draw_.of<std::int64_t>({20, 30, 50, 60, 100, 120, 240, 300, 1000}), 0};
        else step = {0, 0, draw_.magnitude(1e-4, 0.0625)};
        h_ = step.seconds();
    }
    // m/s, of v h / size, as far as a range holds it.
    double speed(double low, double high) { return std::min(draw_.magnitude(low, high) * size_ / h_, 1000.0); }
    // rad/s, of h |w|. Fixed point rotates by more than a quarter of a radian in parts of the step.
    double spin() { return std::min(draw_.magnitude(1e-4, trial_.method.numbers == "q32" ? 0.24 : 4) / h_, 250.0); }
    // m/s^2, of a h^2 / size.
    double acceleration(double low, double high) { return draw_.magnitude(low, high) * size_ / (h_ * h_); }

    ShapeDescription shape(bool touches) {
        const double thin = size_ * draw_.magnitude(1e-3, 1), edge = size_ * draw_.uniform(0.3, 1);
        const ShapeDescription shapes[] = {
            {ShapeKind::sphere, {size_}, {}},          {ShapeKind::box, {size_, edge, edge}, {}},
            {ShapeKind::box, {size_, thin, edge}, {}}, {ShapeKind::cylinder, {size_, thin}, {}},
            {ShapeKind::capsule, {thin, size_}, {}},   {ShapeKind::hoop, {size_}, {}}};
        return shapes[draw_.between(0, touches ? 2 : 5)];
    }
    // In a row, clear of each other; they move if `speed` is not 0.
    void add_bodies(int count, bool touches, const Vector& row, double gap, double speed) {
        Vector place = centre_;
        const double mass = draw_.magnitude(1e-3, 1e3);
        for (int b = 0; b < count; ++b) {
            BodyDescription body;
            body.name = "body " + std::to_string(b + 1);
            body.shape = shape(touches);
            body.mass = draw_.one_in(2) ? mass : mass * draw_.magnitude(1e-4, 1);
            if (!touches && draw_.one_in(6)) {
                const double x = draw_.magnitude(0.01, 1), y = draw_.magnitude(0.01, 1),
                             part = draw_.uniform(0.01, 0.99);
                body.inertia = {x, y, std::abs(x - y) + 2 * std::min(x, y) * part, 0, 0, 0};
            }
            place = place + row * (reach(body) + gap);
            body.position = triple(place);
            place = place + row * (1.0001 * reach(body));
            if (speed > 0) {
                if (!draw_.one_in(4))
                    body.orientation = {1, draw_.uniform(-1, 1), draw_.uniform(-1, 1), draw_.uniform(-1, 1)};
                // Often about nearly an axis of the body, the middle one among them.
                const Vector beside = draw_.along(draw_.magnitude(1e-4, 0.5)), axis = draw_.direction() + beside;
                if (!draw_.one_in(4)) body.angular_velocity = triple(axis * (spin() / std::max(1.0, norm(axis))));
                body.fixed = b > 0 && draw_.one_in(8);
                if (!body.fixed) body.velocity = triple(draw_.direction() * speed);
            }
            scene_.bodies.push_back(body);
        }
    }
    [[nodiscard]] double lightest() const {
        double mass = *scene_.bodies.front().mass;
        for (const BodyDescription& body : scene_.bodies) mass = std::min(mass, *body.mass);
        return mass;
    }

    Triple point_of(const BodyDescription& body) {
        return draw_.one_in(3) ? Triple{} : triple(draw_.along(draw_.magnitude(1e-3, 1) * reach(body)));
    }
    void add_pushes() {
        const int b = draw_.between(0, static_cast<int>(scene_.bodies.size()) - 1);
        const BodyDescription& body = scene_.body(b);
        const double mass = *body.mass, moment = mass * reach(body) * reach(body) / 40, time = scene_.duration;
        const Frame frame = draw_.one_in(2) ? Frame::body : Frame::world;
        const Triple point = point_of(body), push = triple(draw_.along(speed(1e-5, 0.3) * mass)),
                     force = triple(draw_.along(acceleration(1e-7, 1e-3) * mass)), none{},
                     turn = triple(draw_.along(moment * spin())), torque = triple(draw_.along(moment * spin() / time));
        const double at = time * draw_.uniform(0, 0.9), from = time * draw_.uniform(0, 0.5),
                     until = from + time * draw_.uniform(0.1, 0.45);
        if (!draw_.one_in(3)) scene_.impulses.push_back({at, b, frame, push, point, draw_.one_in(3) ? turn : none});
        if (!draw_.one_in(3))
            scene_.forces.push_back({b, from, until, frame, force, point, draw_.one_in(3) ? torque : none});
    }
    // To another body or to a point of the world, one time in four as far as a range allows. Its length at rest differs
    // from the distance by a part of the size, or it is 0.
    void add_spring(int b) {
        SpringDescription spring;
        const BodyDescription& body = scene_.body(b);
        double distance = size_ * draw_.magnitude(0.1, draw_.one_in(4) ? 1e6 : 10), mass = *body.mass;
        spring.body = b;
        spring.point = point_of(body);
        if (b > 0 && draw_.one_in(2)) {
            const BodyDescription& other = scene_.body(spring.to_body = b - 1);
            distance = norm(vector(other.position) - vector(body.position));
            mass = mass * *other.mass / (mass + *other.mass);
            spring.to = point_of(other);
        } else {
            distance = std::min(distance, 3e4);
            spring.to = triple(vector(body.position) + draw_.direction() * distance);
        }
        double hw = draw_.magnitude(0.004, 4);
        if (draw_.one_in(2)) hw = std::min(hw, h_ * std::sqrt(acceleration(1e-6, 1e-2) / distance));
        else spring.rest_length = std::max(0.0, distance + size_ * draw_.uniform(-0.3, 0.3));
        spring.stiffness = mass * hw * hw / (h_ * h_);
        if (draw_.one_in(2)) spring.damping = 2 * mass * hw / h_ * draw_.magnitude(0.01, 2);
        scene_.springs.push_back(spring);
    }
    // By h times the rate at which bodies turn about each other that are some sizes apart.
    void add_gravitation() {
        const double rate = draw_.magnitude(1e-4, 0.2) / h_, apart = size_ * draw_.magnitude(1, 10);
        for (BodyDescription& body : scene_.bodies)
            if (!body.fixed) body.velocity = triple(draw_.direction() * std::min(rate * apart, 500.0));
        scene_.gravitation = rate * rate * apart * apart * apart / *scene_.bodies.front().mass;
    }

    void flight() {
        scene_.contact.response = ContactResponse::none;
        const double fastest = speed(1e-5, 1), gap = size_ * draw_.magnitude(0.1, 30);
        const Vector row = draw_.direction();
        add_bodies(draw_.between(1, 3), false, row, gap, fastest);
        if (draw_.one_in(2)) scene_.gravity = triple(draw_.along(acceleration(1e-7, 1e-2)));
        if (draw_.one_in(2)) add_pushes();
        if (!draw_.one_in(3)) return;
        const double rate = draw_.magnitude(1e-4, 4) / h_;
        scene_.linear_drag = lightest() * rate;
        if (draw_.one_in(2)) scene_.angular_drag = scene_.linear_drag * size_ * size_ / 40;
    }
    // Bodies in a row, tied to each other and to the world as trees.
    void mechanism() {
        scene_.contact.response = ContactResponse::none;
        const double fastest = draw_.one_in(2) ? 0 : speed(1e-5, 0.1), gap = size_ * draw_.magnitude(1e-3, 1);
        const Vector row = draw_.direction();
        add_bodies(draw_.between(1, 5), false, row, gap, fastest);
        // What does not move has an energy of rounding alone.
        if (fastest == 0 || !draw_.one_in(3)) scene_.gravity = triple(draw_.along(acceleration(1e-7, 1e-3)));
        // Moments are those of the shapes: fixed point does not follow a link whose radius of gyration is 100 arms.
        for (BodyDescription& body : scene_.bodies) {
            body.inertia.reset();
            if (body.fixed) body.angular_velocity = {};
        }
        for (int b = 0; b < static_cast<int>(scene_.bodies.size()); ++b)
            if (!draw_.one_in(8)) add_joint(b);
        if (draw_.one_in(4)) add_pushes();
        if (draw_.one_in(8)) add_spring(0);
    }
    // To the world or to a body before it. Springs are given by h w and the moment or the mass of the body.
    void add_joint(int b) {
        JointDescription joint;
        const BodyDescription& body = scene_.body(b);
        joint.name = "joint " + std::to_string(scene_.joints.size() + 1);
        joint.kind = static_cast<JointKind>(draw_.between(0, 5));
        joint.body = b;
        joint.to_body = draw_.between(-1, b - 1);
        if (body.fixed) return;  // to one that moves it might close a loop
        const Vector place = vector(body.position), anchor = place + vector(point_of(body)) * 2,
                     axis = draw_.direction(), across = cross(axis, draw_.direction());
        joint.anchor = triple(anchor);
        const bool turns = joint.kind != JointKind::slider && joint.kind != JointKind::distance;
        const double extent = reach(body), measure = turns ? extent * extent / 10 : 1;
        if (joint.kind == JointKind::hinge || joint.kind == JointKind::slider || joint.kind == JointKind::universal)
            joint.axis = triple(axis);
        if (joint.kind == JointKind::universal)
            joint.to_axis = triple(norm(across) > 0.1 ? across : cross(axis, Vector{axis.y, axis.z, -axis.x}));
        if (draw_.one_in(3) && (joint.kind == JointKind::hinge || joint.kind == JointKind::slider)) {
            const double most = joint.kind == JointKind::hinge ? 2.6 : extent;
            joint.least = -most * draw_.magnitude(1e-3, 1);
            joint.most = most * draw_.magnitude(1e-3, 1);
        }
        double length = 0;
        if (joint.kind == JointKind::distance) {
            const Vector from = joint.to_body < 0 ? place : vector(scene_.body(joint.to_body).position),
                         to = from + draw_.along(size_ * draw_.magnitude(0.01, 3));
            joint.to_point = triple(to);
            length = norm(anchor - to);
            const bool is_rod = draw_.one_in(2);
            joint.most = is_rod ? length : length * (1 + draw_.magnitude(1e-3, 1));
            joint.least = is_rod ? length : draw_.one_in(2) ? 0.0 : length * draw_.uniform(0, 1);
        }
        if (draw_.one_in(4) && joint.kind != JointKind::fixed && !joint.is_rod()) {
            const double hw = draw_.magnitude(0.004, 0.5);
            joint.spring.stiffness = *body.mass * measure * hw * hw / (h_ * h_);
            if (draw_.one_in(2)) joint.spring.damping = *body.mass * measure * hw / h_ * draw_.magnitude(0.01, 1);
            joint.spring.rest = length;
        }
        scene_.joints.push_back(joint);
    }
    // Bodies above a floor, on it or on each other, and walls at any distance.
    void contacts(ContactResponse response) {
        ContactDescription& contact = scene_.contact;
        contact.response = response;
        contact.restitution = draw_.one_in(3) ? 0.0 : draw_.one_in(4) ? 1.0 : draw_.uniform(0, 1);
        if (draw_.one_in(2)) contact.friction = draw_.magnitude(0.01, 2);
        if (draw_.one_in(2)) contact.tolerance = size_ * draw_.magnitude(1e-5, 0.1);
        if (draw_.one_in(6)) contact.sleep = SleepDescription{0.03, 0.05, draw_.uniform(0.05, 0.5)};
        const bool stands = draw_.one_in(4);
        const Vector up = stands ? Vector{0, 1, 0} : draw_.direction();
        if (!draw_.one_in(8)) scene_.gravity = triple(up * -acceleration(1e-6, 0.01));
        const double fastest = stands ? 0 : speed(1e-5, 0.3), gap = size_ * draw_.magnitude(1e-3, 1);
        const Vector row = stands ? up : draw_.direction();
        add_bodies(draw_.between(1, 3), true, row, gap, fastest);
        double top = centre_.y;
        for (BodyDescription& body : scene_.bodies) {
            const double half = body.shape.kind == ShapeKind::box ? body.shape.size[1] / 2 : body.shape.size[0];
            if (stands) body.position[1] = top + half;
            top += 2 * half;
        }
        if (stands && draw_.one_in(2)) scene_.bodies.back().velocity = {speed(1e-5, 0.1), 0, speed(1e-5, 0.1)};
        const double mass = lightest(), hw = draw_.magnitude(0.004, 1);
        contact.stiffness = mass * hw * hw / (h_ * h_);
        if (draw_.one_in(2)) contact.damping = 2 * mass * hw / h_ * draw_.magnitude(0.01, 1);
        if (stands) add_plane(up, centre_);
        else add_plane_below(up, size_ * draw_.magnitude(1e-4, 4));
        for (int i = draw_.between(0, 3); i > 0; --i)
            if (const Vector normal = draw_.direction(); dot(normal, up) > -0.9)
                add_plane_below(normal, size_ * draw_.magnitude(1e-3, 1e4));
        if (draw_.one_in(4)) add_pushes();
        if (draw_.one_in(8)) add_spring(0);
    }
    void add_plane_below(const Vector& normal, double gap) {
        double depth = 0;
        for (const BodyDescription& body : scene_.bodies)
            depth = std::max(depth, 1.0001 * reach(body) - dot(normal, vector(body.position) - centre_));
        add_plane(normal, centre_ - normal * (depth + gap));
    }
    // The plane n . (p - point) = 0, moved out by more than rounding, so that it touches no body.
    void add_plane(const Vector& normal, const Vector& point) {
        PlaneDescription plane;
        plane.name = "plane " + std::to_string(scene_.planes.size() + 1);
        plane.normal = triple(normal);
        const double offset = -dot(vector(plane.normal), point) / norm(vector(plane.normal));
        plane.offset = offset + 1e-9 * std::abs(offset);
        if (draw_.one_in(3)) plane.restitution = draw_.uniform(0, 1);
        scene_.planes.push_back(plane);
    }

    // The smallest range that holds the start and the end of free flight, or seldom the smallest of all.
    void declare_range() {
        double x = 0, v = 0, w = 0;
        const double time = scene_.duration, g = norm(vector(scene_.gravity));
        for (const BodyDescription& body : scene_.bodies) {
            const double start = norm(vector(body.velocity));
            x = std::max(x, norm(vector(body.position)) + start * time + g * time * time / 2);
            v = std::max(v, start + g * time);
            w = std::max(w, norm(vector(body.angular_velocity)));
        }
        for (const SpringDescription& spring : scene_.springs) x = std::max(x, norm(vector(spring.to)));
        for (const PlaneDescription& plane : scene_.planes) x = std::max(x, std::abs(plane.offset) / 4);
        scene_.range = held_by("field");
        for (const char* name : {"room", "near"}) {
            const RangeDescription range = held_by(name);
            if (x <= range.position && v <= range.velocity && w <= range.angular_velocity) scene_.range = range;
        }
        if (draw_.one_in(20)) scene_.range = held_by("near");
        scene_.range.is_declared = true;
    }
    void make_absurd() {  // any number of the scene, times anything
        trial_.kind = "absurd";
        double factor = draw_.magnitude(10, draw_.one_in(4) ? 1e25 : 1e5);
        if (draw_.one_in(3)) factor = 1 / factor;
        std::vector<double*> numbers;
        for_each_number(scene_, [&](double& x, Measure) {
            if (x != 0) numbers.push_back(&x);
        });
        *draw_.of(numbers) *= factor;
    }

    Draw draw_;
    Trial trial_;
    SceneDescription& scene_ = trial_.scene;
    double h_ = 0;     // s
    double size_ = 0;  // m, of bodies
    Vector centre_;    // m, of the scene
};

}  // namespace

double reach(const BodyDescription& body) {
    const auto& [a, b, c] = body.shape.size;
    switch (body.shape.kind) {
    case ShapeKind::box: return norm(Vector{a, b, c}) / 2;
    case ShapeKind::none: return body.inertia ? std::sqrt((*body.inertia)[0] / *body.mass) : 1;
    default: return a + b / 2;
    }
}

Trial draw_trial(std::uint64_t seed, std::uint64_t index, bool has_joints) {
    Trial trial = Maker(seed, index).make(has_joints);
    trial.index = index;
    trial.scene.name = "trial " + std::to_string(index) + " of seed " + std::to_string(seed);
    return trial;
}

}  // namespace tumble::test

// A scene is made of the field's numbers without unit, each drawn log-uniformly between what has no effect and what no
// step follows: h w of springs, h c/m of dampers and drag, h |w| of spins, v h / size, a h^2 / size of accelerations,
// mass ratios, slenderness, tolerance / size, distance / size. Nothing keeps a scene from being chaotic, stiff or
// absurd: the judge says what it cannot decide.
#include "trial.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "../kernel/random.hpp"
#include "simulation/simulation.hpp"
#include "truth/motion.hpp"

namespace tumble::test {
namespace {

using namespace host;
using Vector = reference::Vec<double>;

constexpr int digits_of_position = 10;  // so that small things may stand far from the origin

// The nearest decimal of some digits.
double short_decimal(double x, int digits = 5) {
    std::array<char, 32> text{};
    const char* const end =
        std::to_chars(text.data(), text.data() + text.size(), x, std::chars_format::scientific, digits - 1).ptr;
    double read = 0;
    std::from_chars(text.data(), end, read);
    return read;
}
Triple triple(const Vector& v, int digits = 5) {
    return {short_decimal(v.x, digits), short_decimal(v.y, digits), short_decimal(v.z, digits)};
}
Vector vector(const Triple& t) { return {t[0], t[1], t[2]}; }

class Draw : public Random {
public:
    using Random::Random;

    bool one_in(int n) { return between(1, n) == 1; }
    template <class T>
    const T& of(const std::vector<T>& choices) {
        return choices[static_cast<std::size_t>(between(0, static_cast<int>(choices.size()) - 1))];
    }
    double uniform(double low, double high) { return short_decimal(Random::uniform(low, high)); }
    // Any power of two between the ends is as likely as another.
    double magnitude(double low, double high) {
        const double x = std::ldexp(Random::uniform(1.0, 2.0), between(std::ilogb(low), std::ilogb(high)));
        return short_decimal(std::clamp(x, low, high));
    }
    // Unit length; a third of them along an axis of the world.
    Vector direction() {
        if (one_in(3)) {
            Vector axis;
            axis[between(0, 2)] = one_in(2) ? 1 : -1;
            return axis;
        }
        for (;;) {
            const Vector v{Random::uniform(-1, 1), Random::uniform(-1, 1), Random::uniform(-1, 1)};
            if (const double n = norm(v); n > 0.1 && n <= 1) return v * (1 / n);
        }
    }
    Vector vector(double low, double high) { return direction() * magnitude(low, high); }
    Quadruple orientation() {
        if (one_in(4)) return {1, 0, 0, 0};
        Quadruple q{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
        q[static_cast<std::size_t>(between(0, 3))] = 1;
        return q;
    }
};

class Maker {
public:
    Maker(std::uint64_t seed, std::uint64_t index) : draw_(Random(Random(seed).bits() ^ (index << 20)).bits()) {}

    Trial make() {
        draw_method();
        draw_step();
        size_ = draw_.magnitude(0.01, 2);
        if (draw_.one_in(3)) centre_ = draw_.direction() * std::min(size_ * draw_.magnitude(1, 1e5), 2e4);
        scene_.duration = draw_.between(20, 40) * draw_.magnitude(1, 32) * h_;
        struct Kind {
            const char* name;
            void (Maker::*make)();
        };
        static constexpr Kind kinds[] = {{"flight", &Maker::flight},   {"springs", &Maker::springs},
                                         {"orbits", &Maker::orbits},   {"impacts", &Maker::impacts},
                                         {"impacts", &Maker::impacts}, {"soft contacts", &Maker::soft_contacts}};
        const Kind& kind = kinds[draw_.between(0, 5)];
        trial_.kind = kind.name;
        (this->*kind.make)();
        declare_range();
        if (draw_.one_in(20)) make_absurd();
        return trial_;
    }

private:
    [[nodiscard]] bool is_fixed_point() const { return trial_.method.numbers == "q32"; }

    void draw_method() {
        static const std::vector<Method> systems{{"", "q32", true},  {"", "q32", true},  {"", "q32", true},
                                                 {"", "q32", false}, {"", "f32", true},  {"", "f32", false},
                                                 {"", "f64", false}, {"", "f64", false}};
        trial_.method = draw_.of(systems);
        do trial_.method.integrator = draw_.one_in(2) ? "verlet" : draw_.of(integrators()).name;
        while (!runs_in(find_integrator(trial_.method.integrator), trial_.method.numbers));
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
    // rad/s, of h |w|. Fixed point holds a quarter of a radian a step.
    double spin() { return std::min(draw_.magnitude(1e-4, is_fixed_point() ? 0.24 : 4) / h_, 250.0); }
    // m/s^2, of a h^2 / size.
    double acceleration(double low, double high) { return draw_.magnitude(low, high) * size_ / (h_ * h_); }
    // kg m^2, without regard to the shape.
    static double moment(const BodyDescription& body) { return *body.mass * reach(body) * reach(body) / 4; }

    // --- bodies ------------------------------------------------------------------------------------------------------

    ShapeDescription shape(bool touches) {
        const double thin = short_decimal(size_ * draw_.magnitude(1e-3, 1)), edge = size_ * draw_.uniform(0.3, 1);
        switch (draw_.between(0, touches ? 2 : 5)) {
        case 0: return {ShapeKind::sphere, {size_}, {}};
        case 1: return {ShapeKind::box, {size_, short_decimal(edge), short_decimal(size_ * draw_.uniform(0.3, 1))}, {}};
        case 2: return {ShapeKind::box, {size_, thin, short_decimal(edge)}, {}};
        case 3: return {ShapeKind::cylinder, {size_, thin}, {}};
        case 4: return {ShapeKind::capsule, {thin, size_}, {}};
        default: return {ShapeKind::hoop, {size_}, {}};
        }
    }
    // One to four bodies in a row that do not touch, `gap` between them at least; they move if `speed` is not 0.
    void add_bodies(int count, bool touches, const Vector& row, double gap, double speed) {
        Vector place = centre_;
        const double mass = draw_.magnitude(1e-3, 1e3);
        for (int b = 0; b < count; ++b) {
            BodyDescription body;
            body.name = "body " + std::to_string(b + 1);
            body.shape = shape(touches);
            body.mass = draw_.one_in(2) ? mass : short_decimal(mass * draw_.magnitude(1e-4, 1));
            if (!touches && draw_.one_in(6)) draw_moments(body);
            place = place + row * (reach(body) + (b > 0 ? gap : 0));
            body.position = triple(place, digits_of_position);
            place = place + row * (1.0001 * reach(body));
            if (speed > 0) {
                body.velocity = triple(draw_.direction() * speed);
                body.orientation = draw_.orientation();
                if (!draw_.one_in(4)) body.angular_velocity = triple(axis_of_spin() * spin());
            }
            body.fixed = b > 0 && draw_.one_in(8);
            if (body.fixed) body.velocity = {};
            scene_.bodies.push_back(body);
        }
    }
    // Any that a body can have: the largest is less than the sum of the others.
    void draw_moments(BodyDescription& body) {
        const double a = draw_.magnitude(0.01, 1), b = draw_.magnitude(0.01, 1);
        body.inertia = {a, b, short_decimal(std::abs(a - b) + 2 * std::min(a, b) * draw_.uniform(0.01, 0.99)), 0, 0, 0};
    }
    // Often near an axis of the body, the middle one among them.
    Vector axis_of_spin() {
        const Vector axis = draw_.direction() + draw_.direction() * draw_.magnitude(1e-4, 0.5);
        return axis * (1 / std::max(1.0, norm(axis)));
    }
    int any_body() { return draw_.between(0, static_cast<int>(scene_.bodies.size()) - 1); }

    // --- loads -------------------------------------------------------------------------------------------------------

    void add_drag() {
        double mass = *scene_.bodies.front().mass, least = moment(scene_.bodies.front());
        for (const BodyDescription& body : scene_.bodies) {
            mass = std::min(mass, *body.mass);
            least = std::min(least, moment(body));
        }
        const double rate = draw_.magnitude(1e-4, 4) / h_;
        scene_.linear_drag = short_decimal(mass * rate);
        if (draw_.one_in(2)) scene_.angular_drag = short_decimal(0.1 * least * rate);
    }
    Vector point_of(const BodyDescription& body) {
        return draw_.one_in(3) ? Vector{} : draw_.direction() * (draw_.magnitude(1e-3, 1) * reach(body));
    }
    Frame frame() { return draw_.one_in(2) ? Frame::body : Frame::world; }
    void add_impulse() {
        ImpulseDescription impulse;
        impulse.body = any_body();
        const BodyDescription& body = scene_.body(impulse.body);
        impulse.time = short_decimal(scene_.duration * draw_.uniform(0, 0.9));
        impulse.frame = frame();
        impulse.impulse = triple(draw_.direction() * (speed(1e-5, 0.3) * *body.mass));
        impulse.point = triple(point_of(body));
        if (draw_.one_in(3)) impulse.angular_impulse = triple(draw_.direction() * (0.1 * moment(body) * spin()));
        scene_.impulses.push_back(impulse);
    }
    void add_force() {
        ForceDescription force;
        force.body = any_body();
        const BodyDescription& body = scene_.body(force.body);
        force.from = short_decimal(scene_.duration * draw_.uniform(0, 0.5));
        force.until = short_decimal(force.from + scene_.duration * draw_.uniform(0.1, 0.45));
        force.frame = frame();
        force.force = triple(draw_.direction() * (acceleration(1e-7, 1e-3) * *body.mass));
        force.point = triple(point_of(body));
        if (draw_.one_in(3))
            force.torque = triple(draw_.direction() * (0.1 * moment(body) * spin() / scene_.duration));
        scene_.forces.push_back(force);
    }
    void add_pushes() {
        for (int i = draw_.between(0, 2); i > 0; --i) add_impulse();
        for (int i = draw_.between(0, 2); i > 0; --i) add_force();
    }
    // To another body or to a point of the world, one time in four as far as a range allows.
    void add_spring(int b) {
        SpringDescription spring;
        spring.body = b;
        spring.to_body = b + 1 < static_cast<int>(scene_.bodies.size()) && draw_.one_in(2) ? b + 1 : -1;
        const BodyDescription& body = scene_.body(b);
        const Vector here = vector(body.position);
        double distance = size_ * draw_.magnitude(0.1, 10), mass = *body.mass;
        if (spring.to_body >= 0) {
            const BodyDescription& other = scene_.body(spring.to_body);
            distance = norm(vector(other.position) - here);
            if (!other.fixed) mass = mass * *other.mass / (mass + *other.mass);
            if (draw_.one_in(2)) spring.to = triple(point_of(other));
        } else {
            if (draw_.one_in(4)) distance = std::min(size_ * draw_.magnitude(10, 1e6), 3e4);
            spring.to = triple(here + draw_.direction() * distance, digits_of_position);
        }
        if (draw_.one_in(2)) spring.point = triple(point_of(body));
        double hw = draw_.magnitude(0.004, 4);
        // Stretched by a part of the size; or pulled from afar, at any acceleration.
        if (draw_.one_in(2)) spring.rest_length = std::max(0.0, distance + size_ * draw_.uniform(-0.3, 0.3));
        else hw = std::min(hw, h_ * std::sqrt(acceleration(1e-6, 1e-2) / distance));
        spring.rest_length = short_decimal(spring.rest_length);
        spring.stiffness = short_decimal(mass * hw * hw / (h_ * h_));
        if (draw_.one_in(2)) spring.damping = short_decimal(2 * mass * hw / h_ * draw_.magnitude(0.01, 2));
        scene_.springs.push_back(spring);
    }
    void add_springs() {
        for (int b = 0; b < static_cast<int>(scene_.bodies.size()); ++b) add_spring(b);
    }

    // --- kinds of scenes ---------------------------------------------------------------------------------------------

    void flight() {
        scene_.contact.response = ContactResponse::none;
        add_bodies(draw_.between(1, 3), false, draw_.direction(), 0, speed(1e-5, 1));
        if (draw_.one_in(2)) scene_.gravity = triple(draw_.direction() * acceleration(1e-7, 1e-2));
        if (draw_.one_in(3)) add_drag();
        if (draw_.one_in(2)) add_pushes();
    }
    void springs() {
        flight();
        add_springs();
    }
    void orbits() {
        scene_.contact.response = ContactResponse::none;
        const Vector row = draw_.direction();
        const double gap = size_ * draw_.magnitude(0.1, 30), rate = draw_.magnitude(1e-4, 0.2) / h_;
        add_bodies(draw_.between(2, 3), false, row, gap, 1e-3 * size_ / h_);
        double mass = 0;
        for (const BodyDescription& body : scene_.bodies) mass += *body.mass;
        const Vector from = vector(scene_.bodies[0].position);
        const double first = norm(vector(scene_.bodies[1].position) - from);
        scene_.gravitation = short_decimal(rate * rate * first * first * first / mass);
        Vector along = cross(row, Vector{row.y, row.z, -row.x});
        along = along * (rate * draw_.uniform(0, 1.3) / norm(along));
        for (BodyDescription& body : scene_.bodies)
            if (!body.fixed) body.velocity = triple(along * std::min(norm(vector(body.position) - from), 1000 / rate));
    }
    // n . (p - point) = 0; the normal has five digits, and the plane stays clear of what it is clear of.
    void add_plane(const Vector& normal, const Vector& point) {
        PlaneDescription plane;
        plane.name = "plane " + std::to_string(scene_.planes.size() + 1);
        plane.normal = triple(normal);
        const Vector n = vector(plane.normal);
        const double offset = -dot(n, point) / norm(n);
        plane.offset = short_decimal(offset + 1e-9 * std::abs(offset), digits_of_position);
        if (draw_.one_in(3)) plane.restitution = draw_.uniform(0, 1);
        scene_.planes.push_back(plane);
    }
    // Bodies above a floor, on it or on each other, and walls at any distance.
    void add_floor(bool stands) {
        const Vector up = stands ? Vector{0, 1, 0} : draw_.direction();
        if (!draw_.one_in(8)) scene_.gravity = triple(up * -acceleration(1e-6, 0.01));
        if (stands) centre_ = {centre_.x, short_decimal(centre_.y, digits_of_position), centre_.z};
        const int count = draw_.between(1, 3);
        add_bodies(count, true, stands ? up : draw_.direction(), size_ * draw_.magnitude(1e-3, 1),
                   stands ? 0 : speed(1e-5, 0.3));
        double height = 0, lowest = 0;  // of what stands; of what flies, below the centre
        for (BodyDescription& body : scene_.bodies) {
            const double half = body.shape.kind == ShapeKind::box ? body.shape.size[1] / 2 : body.shape.size[0];
            if (stands) body.position[1] = centre_.y + height + half;
            height += 2 * half;
            lowest = std::max(lowest, reach(body) - dot(up, vector(body.position) - centre_));
        }
        add_plane(up, stands ? centre_ : centre_ - up * (lowest * (1 + draw_.magnitude(1e-4, 4))));
        if (stands && draw_.one_in(2)) scene_.bodies.back().velocity = {speed(1e-5, 0.1), 0, speed(1e-5, 0.1)};
        for (int i = draw_.between(0, 3); i > 0; --i) {
            const Vector normal = draw_.direction();
            double reached = 0;
            for (const BodyDescription& body : scene_.bodies)
                reached = std::max(reached, reach(body) - dot(normal, vector(body.position) - centre_));
            if (dot(normal, up) > -0.9) add_plane(normal, centre_ - normal * (reached * (1 + draw_.magnitude(1e-3, 1e4))));
        }
        if (draw_.one_in(4)) add_pushes();
        if (draw_.one_in(8)) add_spring(0);
    }
    void impacts() {
        ContactDescription& contact = scene_.contact;
        contact.restitution = draw_.one_in(3) ? 0.0 : draw_.one_in(4) ? 1.0 : draw_.uniform(0, 1);
        if (draw_.one_in(2)) contact.friction = draw_.magnitude(0.01, 2);
        if (draw_.one_in(2)) contact.tolerance = short_decimal(size_ * draw_.magnitude(1e-5, 0.1));
        if (draw_.one_in(6)) contact.sleep = SleepDescription{0.03, 0.05, draw_.uniform(0.05, 0.5)};
        add_floor(draw_.one_in(3));
    }
    void soft_contacts() {
        add_floor(false);
        ContactDescription& contact = scene_.contact;
        contact.response = ContactResponse::spring;
        double mass = *scene_.bodies.front().mass;
        for (const BodyDescription& body : scene_.bodies) mass = std::min(mass, *body.mass);
        const double hw = draw_.magnitude(0.004, 1);
        contact.stiffness = short_decimal(mass * hw * hw / (h_ * h_));
        if (draw_.one_in(2)) contact.damping = short_decimal(2 * mass * hw / h_ * draw_.magnitude(0.01, 1));
    }

    // The smallest range that holds the start and the end of free flight, or seldom any.
    void declare_range() {
        double position = 0, velocity = 0, angular_velocity = 0;
        const double time = scene_.duration, g = norm(vector(scene_.gravity));
        for (const BodyDescription& body : scene_.bodies) {
            const double v = norm(vector(body.velocity));
            position = std::max(position, norm(vector(body.position)) + v * time + g * time * time / 2);
            velocity = std::max(velocity, v + g * time);
            angular_velocity = std::max(angular_velocity, norm(vector(body.angular_velocity)));
        }
        for (const SpringDescription& spring : scene_.springs) position = std::max(position, norm(vector(spring.to)));
        for (const PlaneDescription& plane : scene_.planes) position = std::max(position, std::abs(plane.offset) / 4);
        static const std::vector<RangeDescription> ranges{{64, 32, 32}, {1024, 128, 64}, {32768, 2048, 256}};
        const auto holds = [&](const RangeDescription& range) {
            return position <= range.position && velocity <= range.velocity &&
                   angular_velocity <= range.angular_velocity;
        };
        const auto smallest = std::find_if(ranges.begin(), ranges.end(), holds);
        scene_.range = draw_.one_in(20) ? draw_.of(ranges) : smallest == ranges.end() ? ranges.back() : *smallest;
    }
    // Any number of the scene, times anything.
    void make_absurd() {
        trial_.kind = "absurd";
        double factor = draw_.magnitude(10, draw_.one_in(4) ? 1e25 : 1e5);
        if (draw_.one_in(3)) factor = 1 / factor;
        std::vector<double*> numbers;
        for_each_number(scene_, [&](double& x, Quantity) {
            if (x != 0) numbers.push_back(&x);
        });
        double& number = *draw_.of(numbers);
        number = short_decimal(number * factor);
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
    const auto& s = body.shape.size;
    switch (body.shape.kind) {
    case ShapeKind::box: return norm(vector(s)) / 2;
    case ShapeKind::cylinder: return std::hypot(s[0], s[1] / 2);
    case ShapeKind::capsule: return s[0] + s[1] / 2;
    case ShapeKind::none:
        return body.inertia
                   ? std::sqrt(std::max({(*body.inertia)[0], (*body.inertia)[1], (*body.inertia)[2]}) / *body.mass)
                   : 1;
    default: return s[0];
    }
}

Trial draw_trial(std::uint64_t seed, std::uint64_t index) {
    Trial trial = Maker(seed, index).make();
    trial.scene.name = "trial " + std::to_string(index) + " of seed " + std::to_string(seed);
    return trial;
}

}  // namespace tumble::test

#include "trial.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "../kernel/random.hpp"
#include "truth/motion.hpp"

namespace tumble::test {
namespace {

using namespace host;
using Vector = reference::Vec<double>;
using Rotation = reference::Quaternion<double>;

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
// m: what is small may stand far from the origin.
constexpr int digits_of_place = 10;
Triple place(const Vector& v) { return triple(v, digits_of_place); }

class Draw : public Random {
public:
    using Random::Random;

    bool one_in(int n) { return between(1, n) == 1; }
    template <class T>
    const T& of(std::initializer_list<T> choices) {
        return *(choices.begin() + between(0, static_cast<int>(choices.size()) - 1));
    }
    double uniform(double low, double high) { return short_decimal(Random::uniform(low, high)); }
    // Any power of two between the ends is as likely as another.
    double magnitude(double low, double high) {
        const double x = std::ldexp(Random::uniform(1.0, 2.0), between(std::ilogb(low), std::ilogb(high)));
        return short_decimal(std::clamp(x, low, high));
    }
    Vector direction() {
        for (;;) {
            const Vector v{Random::uniform(-1, 1), Random::uniform(-1, 1), Random::uniform(-1, 1)};
            if (const double n = norm(v); n > 0.1 && n <= 1) return v * (1 / n);
        }
    }
    // In one time of three along an axis of the world.
    Vector direction_or_axis() {
        if (!one_in(3)) return direction();
        Vector axis;
        axis[between(0, 2)] = one_in(2) ? 1 : -1;
        return axis;
    }
    Vector vector(double low, double high) { return direction() * magnitude(low, high); }
    Quadruple orientation() {
        if (one_in(4)) return {1, 0, 0, 0};
        Quadruple q{};
        for (double& c : q) c = uniform(-1, 1);
        q[static_cast<std::size_t>(between(0, 3))] = 1;
        return q;
    }
};

class Maker {
public:
    Maker(std::uint64_t seed, std::uint64_t index) : draw_(Random(Random(seed).bits() ^ (index << 20)).bits()) {
        scene_.bodies.reserve(8);  // references to bodies stay valid
    }

    Trial make() {
        trial_.integrator = draw_.one_in(2)
                                ? "verlet"
                                : draw_.of<const char*>({"explicit_euler", "semi_implicit_euler", "implicit_euler",
                                                         "implicit_midpoint", "midpoint", "heun", "rk4", "strang",
                                                         "suzuki4", "pdmv4", "pdmv6", "pdmv8", "pdmv10"});
        const int numbers = draw_.between(1, 20);
        trial_.numbers = numbers <= 15 ? "q32" : numbers <= 19 ? "f32" : "f64";
        trial_.carry = numbers <= 11 || numbers >= 18;
        draw_step();
        draw_range();
        struct Kind {
            const char* name;
            void (Maker::*make)();
            int weight;
        };
        constexpr Kind kinds[] = {{"flight", &Maker::flight, 3},
                                  {"springs", &Maker::springs, 3},
                                  {"far anchor", &Maker::far_anchor, 2},
                                  {"far plane", &Maker::far_plane, 3},
                                  {"dice", &Maker::dice, 4},
                                  {"top", &Maker::top, 4},
                                  {"fast top", &Maker::fast_top, 2},
                                  {"orbit", &Maker::orbit, 1},
                                  {"billiards", &Maker::billiards, 3},
                                  {"resting", &Maker::resting, 2},
                                  {"soft contacts", &Maker::soft_contacts, 2},
                                  {"corridor", &Maker::corridor, 1},
                                  {"extreme", &Maker::extreme, 2}};
        int weights = 0;
        for (const Kind& kind : kinds) weights += kind.weight;
        int pick = draw_.between(1, weights);
        const Kind* kind = kinds;
        while ((pick -= kind->weight) > 0) ++kind;
        trial_.kind = kind->name;
        (this->*kind->make)();
        if (trial_.integrator == "strang" && !splits_well()) trial_.integrator = "verlet";
        return trial_;
    }

private:
    // --- what every kind of scene has --------------------------------------------------------------------------------

    void draw_step() {
        StepSize& step = scene_.step;
        if (draw_.one_in(2)) step = {1, std::int64_t{1} << draw_.between(4, 13), 0};
        else if (draw_.one_in(3)) step = {1, draw_.of<std::int64_t>({20, 30, 50, 60, 100, 120, 240, 300, 1000}), 0};
        else step = {0, 0, draw_.magnitude(1e-4, 0.0625)};
        h_ = step.seconds();
    }
    // In half of the scenes what is declared is less than what the number system then holds.
    void draw_range() {
        const auto part = [&] { return draw_.one_in(2) ? 1.0 : draw_.uniform(0.6, 1.0); };
        const auto [position, velocity, spin] =
            draw_.of<Triple>({{64, 32, 32}, {64, 32, 32}, {1024, 128, 64}, {1024, 128, 64}, {32768, 2048, 256}});
        scene_.range = {position * part(), velocity * part(), spin * part()};
        for (double* number : {&scene_.range.position, &scene_.range.velocity, &scene_.range.angular_velocity})
            *number = short_decimal(*number);
        if (draw_.one_in(3))
            centre_ = Vector{draw_.uniform(-0.8, 0.8), draw_.uniform(-0.8, 0.8), draw_.uniform(-0.8, 0.8)} *
                      scene_.range.position;
    }
    void last(std::int64_t steps) {
        steps = std::clamp<std::int64_t>(steps, 4, 8192);
        scene_.duration = static_cast<double>(steps) * h_;
        if (scene_.step.denominator == 0) scene_.duration = short_decimal(scene_.duration);
    }
    [[nodiscard]] double duration() const { return scene_.duration; }
    // Not so far that the motion leaves the range: `speed` and `acceleration` bound it. Steps.
    [[nodiscard]] std::int64_t steps_within(double steps, double speed, double acceleration) const {
        const double room = 0.15 * scene_.range.position, top = 0.6 * scene_.range.velocity;
        double time = steps * h_;
        if (acceleration > 0) time = std::min({time, std::sqrt(room / acceleration), (top - speed) / acceleration});
        if (speed > 0) time = std::min(time, room / speed);
        return static_cast<std::int64_t>(std::max(1.0, time / h_));
    }
    // What a body may turn by in a step is an eighth of a radian where it is flat and the method keeps momentum.
    [[nodiscard]] double largest_spin() const { return std::min(0.7 * scene_.range.angular_velocity, 0.11 / h_); }

    BodyDescription& add_body(ShapeDescription shape, double mass, const Vector& position) {
        BodyDescription body;
        body.name = "body " + std::to_string(scene_.bodies.size() + 1);
        body.shape = shape;
        body.mass = mass;
        body.position = place(position);
        scene_.bodies.push_back(body);
        return scene_.bodies.back();
    }
    ShapeDescription sphere(double radius) { return {ShapeKind::sphere, {radius}, {}}; }
    ShapeDescription box(double size) {
        const auto edge = [&] { return short_decimal(size * draw_.uniform(0.3, 1.0)); };
        return {ShapeKind::box, draw_.one_in(3) ? Triple{size, size, size} : Triple{edge(), edge(), edge()}, {}};
    }
    // The spin about the axis of a rod is resolved the worse the thinner it is.
    [[nodiscard]] double thinnest() const { return trial_.carry ? 0.001 : 0.05; }
    ShapeDescription any_shape(double size) {
        const double thin = short_decimal(size * draw_.magnitude(thinnest(), 1));
        switch (draw_.between(0, 5)) {
        case 0: return sphere(size);
        case 1: return {ShapeKind::cylinder, {size, thin}, {}};
        case 2: return {ShapeKind::hoop, {size}, {}};
        case 3: return {ShapeKind::capsule, {short_decimal(size * draw_.magnitude(0.01, 1)), size}, {}};
        case 4: return {ShapeKind::box, {size, thin, short_decimal(size * draw_.uniform(0.3, 1))}, {}};
        default: return box(size);
        }
    }
    void turn(BodyDescription& body, double slowest, double fastest) {
        body.orientation = draw_.orientation();
        if (!(slowest < fastest) || draw_.one_in(5)) return;
        // Some about an axis of the body and nearly so, the middle one among them.
        Vector axis = draw_.direction_or_axis();
        if (draw_.one_in(2)) axis = axis + draw_.direction() * draw_.magnitude(1e-3, 0.1);
        body.angular_velocity = triple(axis * (draw_.magnitude(slowest, fastest) / std::max(1.0, norm(axis))));
    }
    // n . (p - point) = 0.
    PlaneDescription& add_plane(const Vector& normal, const Vector& point) {
        PlaneDescription plane;
        plane.name = "plane " + std::to_string(scene_.planes.size() + 1);
        plane.normal = triple(normal);  // its length is 1 to five digits, and is made 1 by the reader
        const Vector n{plane.normal[0], plane.normal[1], plane.normal[2]};
        plane.offset = above(-dot(n, point) / norm(n));
        scene_.planes.push_back(plane);
        return scene_.planes.back();
    }
    // Never less, so that what stands clear of a plane stays clear.
    static double above(double x) { return short_decimal(x + 1e-9 * std::abs(x), digits_of_place); }
    void draw_contact() {
        scene_.contact.restitution = draw_.one_in(4) ? 0.0 : draw_.one_in(4) ? 1.0 : draw_.uniform(0.1, 0.9);
        if (draw_.one_in(2)) scene_.contact.friction = draw_.uniform(0.05, 1);
        if (draw_.one_in(4)) scene_.contact.tolerance = draw_.magnitude(1e-5, 1e-2);
    }
    void no_contacts() { scene_.contact.response = ContactResponse::none; }
    // kg m^2, a rough one.
    static double moment(const BodyDescription& body) {
        const double r = reach(body);
        return *body.mass * r * r / 4;
    }

    // Turns about x and y leave some momentum about the axis of a slender body, h^2 w^2 / 4 of it a step, by which
    // strang, which is exact for no body, turns it as many times too far as it is slender. More than a 16th of a radian
    // is no motion of the body any more, and multiplies rounding by as much.
    [[nodiscard]] bool splits_well() const {
        return std::all_of(scene_.bodies.begin(), scene_.bodies.end(), [&](const BodyDescription& body) {
            const auto& [x, y, z] = body.angular_velocity;
            return body.shape.kind != ShapeKind::capsule ||
                   (x * x + y * y + z * z) * h_ * h_ / 4 <= thinness(body) / 16;
        });
    }

    // --- loads -------------------------------------------------------------------------------------------------------

    void add_drag() {
        const BodyDescription& body = scene_.bodies.front();
        // 1/s; in one of eight such that the step is of the order of what the methods stand.
        const double rate = draw_.one_in(8) ? draw_.magnitude(0.1, 4) / h_
                                            : std::min(3 / duration(), 0.1 / h_) * draw_.uniform(0.01, 1);
        double lightest = *body.mass, least = moment(body);
        for (const BodyDescription& other : scene_.bodies) {
            lightest = std::min(lightest, *other.mass);
            least = std::min(least, moment(other));
        }
        scene_.linear_drag = short_decimal(lightest * rate);
        if (draw_.one_in(2)) scene_.angular_drag = short_decimal(0.1 * least * rate);
    }
    Vector point_of(const BodyDescription& body) {
        return draw_.one_in(3) ? Vector{} : draw_.direction() * (draw_.uniform(0, 1) * reach(body));
    }
    int any_body() { return draw_.between(0, static_cast<int>(scene_.bodies.size()) - 1); }
    Frame any_frame() { return draw_.one_in(2) ? Frame::body : Frame::world; }
    void add_impulse(double speed) {
        ImpulseDescription impulse;
        impulse.body = any_body();
        const BodyDescription& body = scene_.body(impulse.body);
        impulse.time = short_decimal(duration() * draw_.uniform(0, 0.9));
        impulse.frame = any_frame();
        speed *= draw_.uniform(0.1, 1);
        impulse.impulse = triple(draw_.direction() * (speed * *body.mass));
        impulse.point = triple(point_of(body) * lever(speed, body));
        if (draw_.one_in(3))
            impulse.angular_impulse = triple(draw_.direction() * (moment(body) * draw_.uniform(0, 0.2) * spin_room()));
        scene_.impulses.push_back(impulse);
    }
    void add_force(double acceleration) {
        ForceDescription force;
        force.body = any_body();
        const BodyDescription& body = scene_.body(force.body);
        force.from = short_decimal(duration() * draw_.uniform(0, 0.5));
        force.until = short_decimal(force.from + duration() * draw_.uniform(0.1, 0.45));
        force.frame = any_frame();
        acceleration *= draw_.uniform(0.1, 1);
        force.force = triple(draw_.direction() * (acceleration * *body.mass));
        force.point = triple(point_of(body) * lever(acceleration * duration(), body));
        if (draw_.one_in(3))
            force.torque = triple(draw_.direction() *
                                  (moment(body) * draw_.uniform(0, 0.2) * spin_room() / std::max(duration(), h_)));
        scene_.forces.push_back(force);
    }
    // rad/s that loads may add.
    [[nodiscard]] double spin_room() const { return 0.3 * largest_spin(); }
    // The part of the body's reach at which a push to this speed leaves the spin within what may be added: the
    // smallest moment of a thin body is far below the rough one.
    [[nodiscard]] double lever(double speed, const BodyDescription& body) const {
        const double r = reach(body), least = 0.05 * r * r * thinness(body);
        return std::min(1.0, spin_room() * least / std::max(1e-9, speed * r));
    }
    [[nodiscard]] static double thinness(const BodyDescription& body) {
        const auto& s = body.shape.size;
        double least = s[0], most = s[0];
        for (const double x : s) {
            if (x > 0) {
                least = std::min(least, x);
                most = std::max(most, x);
            }
        }
        return least / most * least / most;
    }
    // The circular frequency of a spring between two masses, in 1/step, made by its stiffness.
    SpringDescription& add_spring(int body, int to_body, const Vector& to, double frequency) {
        SpringDescription spring;
        spring.body = body;
        spring.to_body = to_body;
        spring.to = place(to);
        double mass = *scene_.body(body).mass;
        if (to_body >= 0) mass = mass * *scene_.body(to_body).mass / (mass + *scene_.body(to_body).mass);
        spring.stiffness = short_decimal(mass * frequency * frequency / (h_ * h_));
        if (draw_.one_in(3)) spring.damping = short_decimal(mass * frequency / h_ * draw_.uniform(0, 1));
        scene_.springs.push_back(spring);
        return scene_.springs.back();
    }

    // --- kinds of scenes ---------------------------------------------------------------------------------------------

    // Bodies that fly, turn, and are pushed.
    void flight() {
        no_contacts();
        const double size = draw_.magnitude(0.01, 2), speed = draw_.magnitude(0.01, 0.2 * scene_.range.velocity);
        const double fall = draw_.one_in(3) ? 0.0 : draw_.magnitude(0.1, 40);
        last(steps_within(draw_.magnitude(16, 600), speed, fall));
        scene_.gravity = triple(draw_.direction_or_axis() * fall);
        const int count = draw_.between(1, 3);
        for (int b = 0; b < count; ++b) {
            BodyDescription& body =
                add_body(any_shape(size), draw_.magnitude(0.001, 1000), centre_ + draw_.direction() * size);
            body.velocity = triple(draw_.direction() * speed);
            turn(body, 0.01, 0.4 * largest_spin());
        }
        if (draw_.one_in(3)) add_drag();
        for (int i = draw_.between(0, 2); i > 0; --i) add_impulse(0.2 * speed);
        for (int i = draw_.between(0, 2); i > 0; --i) add_force(0.5 * std::max(speed / duration(), 0.1));
    }

    // Springs to points of the world within reach, and between bodies.
    void springs() {
        no_contacts();
        const double size = draw_.magnitude(0.02, 1), length = draw_.magnitude(0.1, 0.1 * scene_.range.position);
        // 1/step; in one of five of the order of what the methods stand.
        const double frequency = draw_.one_in(5) ? draw_.magnitude(0.25, 4) : draw_.magnitude(0.004, 0.25);
        last(static_cast<std::int64_t>(draw_.magnitude(16, 800)));
        const int count = draw_.between(1, 3);
        for (int b = 0; b < count; ++b) {
            BodyDescription& body =
                add_body(any_shape(size), draw_.magnitude(0.1, 10), centre_ + draw_.direction() * (length * (1 + b)));
            body.velocity = triple(draw_.direction() * std::min(0.05 * scene_.range.velocity, 0.1 * size / h_));
            turn(body, 0.01, 0.2 * largest_spin());
        }
        // Stretched by no more than what throws the body at a tenth of the range, or of its length.
        const double stretch = std::min(0.05 * scene_.range.velocity * h_ / frequency, 0.2 * length);
        for (int b = 0; b < count; ++b) {
            const bool to_next = b + 1 < count && draw_.one_in(2);
            const Vector here = vector_of_place(b), there = to_next ? vector_of_place(b + 1) : centre_;
            SpringDescription& spring = add_spring(b, to_next ? b + 1 : -1, to_next ? Vector{} : there, frequency);
            // Not beside the axis of a slender body, which a spring turns about it at some radians a step once it
            // pulls: of 1845 such scenes three gained energy in double precision, at 0.8 of the limit.
            if (to_next && thinness(scene_.body(b + 1)) > 0.05) spring.to = triple(draw_.direction() * (0.1 * size));
            if (draw_.one_in(2) && thinness(scene_.body(b)) > 0.05)
                spring.point = triple(draw_.direction() * (draw_.uniform(0, 0.1) * size));
            spring.rest_length =
                short_decimal(std::max(0.0, static_cast<double>(norm(there - here)) + stretch * draw_.uniform(-1, 1)));
        }
        if (draw_.one_in(3)) add_drag();
        if (draw_.one_in(3))
            scene_.gravity = triple(draw_.direction_or_axis() * (frequency * frequency / h_ / h_ * stretch));
    }
    Vector vector_of_place(int b) const {
        const Triple& p = scene_.body(b).position;
        return {p[0], p[1], p[2]};
    }

    // Weak springs to points at any distance, also beyond the range.
    void far_anchor() {
        no_contacts();
        const double pull = draw_.magnitude(0.1, 20);  // m/s^2
        last(steps_within(draw_.magnitude(16, 400), 0, pull));
        const double size = draw_.magnitude(0.02, 1);
        BodyDescription& body = add_body(any_shape(size), draw_.magnitude(0.01, 100), centre_);
        body.orientation = draw_.orientation();
        const double distance = scene_.range.position * draw_.magnitude(0.01, 4);
        const int count = draw_.between(1, 2);
        for (int i = 0; i < count; ++i) {
            const Vector to = centre_ + draw_.direction_or_axis() * distance;
            // The frequency that pulls so.
            SpringDescription& spring = add_spring(0, -1, to, std::min(0.2, h_ * std::sqrt(pull / distance)));
            if (draw_.one_in(3)) spring.rest_length = short_decimal(distance * draw_.uniform(0, 2));
        }
    }

    // A ball or a box above planes at any distance, most of them below, some of them far.
    void far_plane() {
        draw_contact();
        const double size = draw_.magnitude(0.02, 2), fall = draw_.magnitude(0.1, 40);
        last(steps_within(draw_.magnitude(16, 600), 0, fall));
        const Vector down = draw_.direction_or_axis();
        scene_.gravity = triple(down * fall);
        BodyDescription& body =
            add_body(draw_.one_in(2) ? sphere(size) : box(size), draw_.magnitude(0.01, 100), centre_);
        if (draw_.one_in(2))
            body.velocity = triple(draw_.direction() * draw_.magnitude(0.01, 0.05 * scene_.range.velocity));
        if (draw_.one_in(2)) turn(body, 0.01, 0.2 * largest_spin());
        const int count = draw_.between(1, 4);
        for (int i = 0; i < count; ++i) {
            Vector normal =
                i == 0 || draw_.one_in(2) ? -down + draw_.direction() * draw_.uniform(0, 0.9) : draw_.direction();
            normal = normal * (1 / norm(normal));
            const double distance =
                1.01 * reach(body) + (draw_.one_in(2) ? draw_.magnitude(0.01, 2) : draw_.magnitude(1, 20000));
            add_plane(normal, centre_ - normal * distance);
        }
    }

    // Small boxes dropped on a plane, every setting a default in half of the scenes.
    void dice() {
        if (draw_.one_in(2)) {
            scene_.range = {};
            scene_.step = {1, draw_.of<std::int64_t>({128, 256, 512, 1024}), 0};
            h_ = scene_.step.seconds();
            centre_ = {};
        }
        draw_contact();
        const double size = draw_.magnitude(0.01, 0.4), fall = draw_.one_in(2) ? 9.81 : draw_.uniform(1, 20);
        const double height = draw_.magnitude(0.05, 1.5);
        const Vector up = draw_.direction_or_axis();
        scene_.gravity = triple(up * -fall);
        last(static_cast<std::int64_t>(std::min(600.0, (std::sqrt(2 * height / fall) * draw_.uniform(1.1, 2)) / h_)));
        const int count = draw_.one_in(4) ? 2 : 1;
        for (int b = 0; b < count; ++b) {
            BodyDescription& body =
                add_body(box(size), draw_.magnitude(0.001, 1), centre_ + up * (size + height + 2 * b * size));
            turn(body, 0.1, std::min(largest_spin(), 15.0));
            // A box that lands all but flat on a rough plane touches with more points than sweeps of friction solve.
            if (scene_.contact.friction > 0 && body.orientation == Quadruple{1, 0, 0, 0})
                body.orientation = {1, draw_.uniform(0.1, 0.4), draw_.uniform(0.1, 0.4), draw_.uniform(0.1, 0.4)};
            if (draw_.one_in(2)) body.velocity = triple(draw_.direction() * draw_.uniform(0, 2));
        }
        add_plane(up, centre_);
        if (draw_.one_in(4)) add_plane(draw_.direction() * 0.3 + up, centre_ - up * 0.3);
    }

    // A body that turns freely, at a spin that every number system and method holds.
    void top() {
        no_contacts();
        last(static_cast<std::int64_t>(draw_.magnitude(64, 4096)));
        BodyDescription& body = add_body(any_shape(draw_.magnitude(0.01, 2)), draw_.magnitude(0.001, 1000), centre_);
        if (draw_.one_in(3)) {  // any moments that a body can have
            const double a = draw_.magnitude(0.01, 1), b = draw_.magnitude(0.01, 1);
            body.inertia = {a, b, short_decimal(std::abs(a - b) + 2 * std::min(a, b) * draw_.uniform(0.01, 0.99)),
                            0, 0, 0};
        }
        turn(body, 0.001, largest_spin());
        if (draw_.one_in(4)) {  // discs and rods, near the fastest
            if (draw_.one_in(2)) trial_.integrator = draw_.of<const char*>({"pdmv4", "pdmv6", "pdmv8", "pdmv10"});
            const double size = body.shape.size[0], thin = short_decimal(size * draw_.magnitude(0.1 * thinnest(), 0.1));
            body.shape = {draw_.of({ShapeKind::cylinder, ShapeKind::hoop, ShapeKind::capsule}), {size, thin}, {}};
            if (body.shape.kind == ShapeKind::capsule) std::swap(body.shape.size[0], body.shape.size[1]);
            if (body.shape.kind == ShapeKind::hoop) body.shape.size[1] = 0;
            body.inertia.reset();
            body.angular_velocity = triple(draw_.direction() * (draw_.uniform(0.2, 1) * largest_spin()));
        }
        if (!draw_.one_in(4)) return;
        body.fixed = true;
        body.angular_velocity = triple(draw_.direction() * draw_.magnitude(0.01, largest_spin()));
    }

    // The same at up to some turns a step, which floating point is asked for, and what turns in place besides.
    void fast_top() {
        no_contacts();
        trial_.numbers = "f32";
        trial_.carry = draw_.one_in(2);
        if (draw_.one_in(6)) trial_.integrator = "exact";
        last(static_cast<std::int64_t>(draw_.magnitude(64, 2048)));
        scene_.range = {32768, 2048, 256};
        BodyDescription& body = add_body(any_shape(draw_.magnitude(0.1, 1)), draw_.magnitude(0.1, 10), centre_);
        const double angle = std::min(draw_.magnitude(0.1, 8), 250 * h_);  // rad a step
        body.orientation = draw_.orientation();
        const Vector axis = draw_.one_in(2) ? draw_.direction() : draw_.direction_or_axis() + draw_.direction() * 0.01;
        body.angular_velocity = triple(axis * (angle / h_ / 1.02));
        body.fixed = draw_.one_in(4);
    }

    // Bodies that attract each other and circle.
    void orbit() {
        no_contacts();
        const double distance = draw_.magnitude(0.5, 0.1 * scene_.range.position), mass = draw_.magnitude(0.1, 100);
        const double angle = std::min(draw_.magnitude(0.004, 0.06), 0.2 * scene_.range.velocity * h_ / distance);
        const double rate = angle / h_;  // rad/s
        last(static_cast<std::int64_t>(draw_.magnitude(32, 800)));
        const Vector out = draw_.direction(), other = draw_.direction();
        Vector along = cross(out, other);
        if (!(norm(along) > 0.1)) along = cross(out, Vector{out.y, out.z, -out.x});
        along = along * (1 / norm(along));
        const double light = short_decimal(mass * draw_.magnitude(0.01, 1)), whole = mass + light;
        scene_.gravitation = short_decimal(rate * rate * distance * distance * distance / whole);
        const double slow = draw_.one_in(6) ? draw_.uniform(0, 0.3) : draw_.uniform(0.8, 1.2);  // some fall together
        BodyDescription& heavy = add_body(any_shape(0.1), mass, centre_ - out * (distance * light / whole));
        heavy.velocity = triple(along * (-slow * rate * distance * light / whole));
        BodyDescription& moon = add_body(any_shape(0.1), light, centre_ + out * (distance * mass / whole));
        moon.velocity = triple(along * (slow * rate * distance * mass / whole));
        turn(moon, 0.01, 0.3 * largest_spin());
        if (draw_.one_in(2)) std::swap(heavy.name, moon.name);
    }

    // Balls and boxes that meet each other and walls.
    void billiards() {
        draw_contact();
        const double size = draw_.magnitude(0.03, 0.5), speed = draw_.magnitude(0.1, std::min(8.0, 0.2 * size / h_));
        const double room = size * draw_.uniform(3, 8);
        last(static_cast<std::int64_t>(std::min(500.0, room * draw_.uniform(0.5, 3) / speed / h_)));
        const int count = draw_.between(1, 4);
        const double mass = draw_.magnitude(0.01, 10);
        // One in each octant of the room, so that none overlap.
        for (int b = 0; b < count; ++b) {
            const Vector corner{(b & 1) != 0 ? 1.0 : -1.0, (b & 2) != 0 ? 1.0 : -1.0, draw_.uniform(-0.5, 0.5)};
            const Vector place = centre_ + corner * (room / 4 + 0.3 * size);
            BodyDescription& body = add_body(draw_.one_in(3) ? box(size) : sphere(short_decimal(0.5 * size)),
                                             short_decimal(mass * draw_.magnitude(0.1, 10)), place);
            body.velocity = triple((draw_.direction() * 0.5 - corner * 0.4) * speed);
            if (draw_.one_in(2)) turn(body, 0.01, std::min(0.2 * largest_spin(), speed / size));
        }
        if (draw_.one_in(2)) scene_.gravity = triple(draw_.direction() * (draw_.uniform(0, 1) * speed * speed / room));
        const int walls = draw_.between(0, 6);
        for (int i = 0; i < walls; ++i) {
            Vector normal;
            normal[i % 3] = i < 3 ? 1 : -1;
            normal = normal + draw_.direction() * draw_.uniform(0, 0.1);
            PlaneDescription& wall =
                add_plane(normal * (1 / norm(normal)), centre_ - normal * (room * 0.5 + 1.5 * size));
            if (draw_.one_in(3)) wall.restitution = draw_.uniform(0, 1);
        }
    }

    // What stands or lies on a plane, on its own or one on another, and may be pushed.
    void resting() {
        draw_contact();
        scene_.contact.restitution = draw_.one_in(2) ? 0.0 : draw_.uniform(0, 0.6);
        const double size = draw_.magnitude(0.05, 1), fall = draw_.uniform(1, 15);
        scene_.gravity = {0, -fall, 0};
        last(static_cast<std::int64_t>(draw_.magnitude(32, 400)));
        const int count = draw_.between(1, 3);
        double height = 0;
        const double floor_height = short_decimal(centre_.y, digits_of_place);
        const double mass = draw_.magnitude(0.01, 100);
        for (int b = 0; b < count; ++b) {
            BodyDescription& body =
                add_body(draw_.one_in(3) ? sphere(short_decimal(size / 2)) : box(size), mass, centre_);
            const double half = body.shape.kind == ShapeKind::box ? body.shape.size[1] / 2 : body.shape.size[0];
            body.position[1] = floor_height + height + half;
            height += 2 * half;
            if (b == 0 && draw_.one_in(2)) body.velocity = {draw_.uniform(-2, 2), 0, draw_.uniform(-1, 1)};
        }
        PlaneDescription& floor = add_plane({0, 1, 0}, centre_);
        floor.offset = -floor_height;
        if (draw_.one_in(3)) scene_.contact.sleep = SleepDescription{0.03, 0.05, draw_.uniform(0.05, 0.5)};
        if (draw_.one_in(3)) add_force(0.5 * fall);
    }

    // Contacts by springs.
    void soft_contacts() {
        draw_contact();
        scene_.contact.friction = 0;
        scene_.contact.response = ContactResponse::spring;
        const double size = draw_.magnitude(0.05, 1), mass = draw_.magnitude(0.05, 20),
                     rate = draw_.magnitude(0.01, 0.2) / h_;
        scene_.contact.stiffness = short_decimal(mass * rate * rate / 8);
        if (draw_.one_in(2)) scene_.contact.damping = short_decimal(mass * rate * draw_.uniform(0, 0.1));
        // Sinks in by a tenth of its size at most.
        const double speed = std::min(0.05 * size * rate, 0.2 * scene_.range.velocity);
        const double fall = draw_.one_in(3) ? 0.0 : 0.01 * size * rate * rate;
        const double height = size * draw_.uniform(0.01, 0.2);
        const Vector up = draw_.direction_or_axis();
        scene_.gravity = triple(up * -fall);
        last(static_cast<std::int64_t>(std::min(600.0, (20 / rate + height / speed) / h_)));
        const int count = draw_.between(1, 2);
        for (int b = 0; b < count; ++b) {
            // Not two boxes: they part along the axis on which they overlap least, which jumps where two overlap alike.
            const bool ball = draw_.one_in(2) || (b > 0 && scene_.bodies.front().shape.kind == ShapeKind::box);
            const ShapeDescription shape = ball ? sphere(short_decimal(size / 2)) : box(size);
            BodyDescription& body = add_body(shape, mass, centre_ + up * (size + height + 2.2 * b * size));
            body.velocity = triple(up * -speed);
            turn(body, 0.01, std::min(0.3 * largest_spin(), speed / size));
        }
        add_plane(up, centre_);
    }

    // A ball that rolls or hops along a floor between two walls.
    void corridor() {
        draw_contact();
        const double radius = draw_.magnitude(0.01, 0.5), room = radius * draw_.uniform(2.1, 8);
        const double speed = std::min(draw_.magnitude(0.1, 0.3 * scene_.range.velocity), 2 * radius / h_),
                     fall = draw_.uniform(1, 20);
        const Vector up = draw_.direction_or_axis();
        Vector along = cross(up, draw_.direction());
        along = along * (1 / norm(along));
        scene_.gravity = triple(up * -fall);
        last(static_cast<std::int64_t>(std::min(600.0, draw_.uniform(2, 20) * room / speed / h_)));
        const double height = draw_.one_in(2) ? 0.0 : radius * draw_.uniform(0, 2);
        BodyDescription& ball =
            add_body(sphere(radius), draw_.magnitude(0.01, 100), centre_ + up * (radius * (1 + 1e-6) + height));
        ball.velocity = triple(along * speed);
        add_plane(up, centre_).restitution = draw_.one_in(2) ? 0.0 : draw_.uniform(0, 1);
        add_plane(along, centre_ - along * (0.5 * room));
        add_plane(-along, centre_ + along * (0.5 * room));
    }

    // A scene of another kind in which one number is absurd.
    void extreme() {
        constexpr std::array<void (Maker::*)(), 6> others{&Maker::flight, &Maker::springs,   &Maker::far_plane,
                                                          &Maker::dice,   &Maker::billiards, &Maker::soft_contacts};
        (this->*others[static_cast<std::size_t>(draw_.between(0, 5))])();
        double factor = draw_.magnitude(10, draw_.one_in(4) ? 1e25 : 1e5);
        if (draw_.one_in(3)) factor = 1 / factor;
        const auto scale = [&](double& x) { x = short_decimal(x * factor); };
        BodyDescription& body = scene_.bodies[static_cast<std::size_t>(any_body())];
        switch (draw_.between(0, 8)) {
        case 0:
            for (double& g : scene_.gravity) scale(g);
            break;
        case 1:
            for (double& edge : body.shape.size) scale(edge);
            break;
        case 2:
            // Fixed point tells of masses that are more unlike than 1e4.
            if (scene_.contact.response == ContactResponse::impulse && scene_.bodies.size() > 1)
                factor = std::clamp(factor, 0.01, 100.0);
            scale(*body.mass);
            break;
        case 3:
            factor = std::min(factor, 1 / factor);
            scale(scene_.contact.tolerance);
            break;
        case 4:
            for (PlaneDescription& plane : scene_.planes) scale(plane.offset);
            break;
        case 5:
            for (SpringDescription& spring : scene_.springs) scale(spring.stiffness);
            break;
        case 6:
            for (SpringDescription& spring : scene_.springs)
                for (double& x : spring.to) scale(x);
            break;
        case 7:
            for (ForceDescription& force : scene_.forces)
                for (double& x : force.force) scale(x);
            break;
        default: {
            const double steps = duration() / h_;
            factor = std::clamp(factor, 1e-4, 1e4);
            scene_.step = {0, 0, short_decimal(h_ * factor)};
            scene_.duration = steps * scene_.step.decimal;
            for (ImpulseDescription& impulse : scene_.impulses) impulse.time *= factor;
            scene_.forces.clear();
        }
        }
    }

    Draw draw_;
    Trial trial_;
    SceneDescription& scene_ = trial_.scene;
    double h_ = 0;   // s
    Vector centre_;  // m: where things happen
};

}  // namespace

double reach(const BodyDescription& body) {
    const auto& s = body.shape.size;
    switch (body.shape.kind) {
    case ShapeKind::box: return norm(Vector{s[0], s[1], s[2]}) / 2;
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

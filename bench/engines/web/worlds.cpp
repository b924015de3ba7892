// This kernel as a module of WebAssembly for run.mjs: a world for each set of features. All numbers of a scene come
// from the caller, in SI units.
//   TUMBLE_NUMBERS   the number system; TUMBLE_WORLDS: 0 those of the scenes, 1 the heaps', 2 one with everything, for
//   its size
#include <tumble/integrators/list.hpp>
#include <tumble/replay.hpp>

#include <cstddef>
#include <memory>
#include <vector>

#define TUMBLE_EXPORT(name) extern "C" [[clang::export_name(#name)]]

namespace {

using namespace tumble;

struct Data {
    static constexpr const char* name = "";
    Seconds step{1, 256};
    std::uint32_t steps = 0;
    WorldSpec world;
    std::vector<BodySpec> bodies;
    std::vector<PlaneSpec> planes;
    std::vector<SpringSpec> springs;
};
Data data;

// Heaps are as wide as a room.
using Range = std::conditional_t<TUMBLE_WORLDS == 1, RoomRange, NearRange>;
using Numbers = NumbersOf<TUMBLE_NUMBERS, Range>;

struct Runner {
    virtual ~Runner() = default;
    virtual void step() = 0;
    virtual void write(double* out) const = 0;
    virtual unsigned status() const = 0;
};
template <Features features>
struct RunnerOf final : Runner {
    using Config = SceneOf<Numbers, integrators::Verlet, features>;
    Replay<Config, Data> replay{data};

    void step() override { (void)replay.step(); }
    void write(double* out) const override {
        const auto& world = replay.world();
        for (int i = 0; i < static_cast<int>(data.bodies.size()); ++i) {
            const auto pose = world.template pose<double>(BodyId{i});
            const auto motion = world.template motion<double>(BodyId{i});
            const auto &x = pose.position, &q = pose.orientation.v, &v = motion.velocity, &w = motion.angular_velocity;
            for (const double number :
                 {x[0], x[1], x[2], pose.orientation.w, q[0], q[1], q[2], v[0], v[1], v[2], w[0], w[1], w[2]})
                *out++ = number;
        }
    }
    unsigned status() const override { return replay.world().status().bits; }
};
std::unique_ptr<Runner> runner;
std::vector<double> numbers;

template <Features features>
void make() {
    runner = std::make_unique<RunnerOf<features>>();
}
constexpr Features boxes(int bodies, int planes, int near_pairs = 0) {
    return {.bodies = bodies,
            .planes = planes,
            .near_pairs = near_pairs,
            .pairs = bodies > 1,
            .boxes = true,
            .friction = true};
}

}  // namespace

TUMBLE_EXPORT(begin)
void begin(double gx, double gy, double gz, int numerator, int denominator, double restitution, double friction) {
    runner.reset();
    data = Data{};
    data.step = Seconds{numerator, denominator};
    data.world.gravity = {Real{gx}, Real{gy}, Real{gz}};
    data.world.contact.restitution = Real{restitution};
    data.world.contact.friction = Real{friction};
}
// Kinds: 0 moments a, b, c without a shape; 1 sphere of radius a; 2 box of edges a, b, c; 3 hoop of radius a.
TUMBLE_EXPORT(body)
void body(int kind, double a, double b, double c, double mass, double x, double y, double z, double qw, double qx,
          double qy, double qz, double vx, double vy, double vz, double wx, double wy, double wz, int fixed) {
    BodySpec spec;
    const Real m{mass}, ra{a}, rb{b}, rc{c};
    switch (kind) {
    case 1: spec = sphere(m, ra); break;
    case 2: spec = box(m, {ra, rb, rc}); break;
    case 3: spec = hoop(m, ra); break;
    default: spec.mass = m; spec.inertia = {.xx = ra, .yy = rb, .zz = rc};
    }
    spec.position = {Real{x}, Real{y}, Real{z}};
    spec.orientation = {Real{qw}, {Real{qx}, Real{qy}, Real{qz}}};
    spec.velocity = {Real{vx}, Real{vy}, Real{vz}};
    spec.angular_velocity = {Real{wx}, Real{wy}, Real{wz}};
    spec.fixed = fixed != 0;
    data.bodies.push_back(spec);
}
TUMBLE_EXPORT(plane) void plane(double x, double y, double z, double offset) {
    PlaneSpec spec;
    spec.normal = {Real{x}, Real{y}, Real{z}};
    spec.offset = Real{offset};
    data.planes.push_back(spec);
}
// 0: there is no such world here.
TUMBLE_EXPORT(make_world) int make_world(int kind) {
    switch (kind) {
#if TUMBLE_WORLDS == 0
    case 0: make<Features{.bodies = 1}>(); break;                              // free
    case 1: make<Features{.bodies = 1, .planes = 1}>(); break;                 // ball on a floor
    case 2: make<boxes(1, 1)>(); break;                                        // box on a floor
    case 3: make<boxes(10, 1)>(); break;                                       // stack, pyramid
    case 4: make<Features{.bodies = 5, .planes = 3, .pairs = true}>(); break;  // cradle
    case 5: make<Features{.bodies = 7, .pairs = true}>(); break;               // break
    case 6: make<Features{.bodies = 2, .pairs = true, .boxes = true, .friction = true, .turntables = true}>(); break;
    case 7: make<Features{.bodies = 1, .planes = 1, .round_shapes = true, .friction = true}>(); break;  // wheel
    case 8: make<boxes(2, 1)>(); break;  // heavy on light
#elif TUMBLE_WORLDS == 1
    case 10: make<boxes(200, 5, 1600)>(); break;
#else
    case 0: make<boxes(64, 6)>(); break;
#endif
    default: return 0;
    }
    return 1;
}
TUMBLE_EXPORT(step) void step() { runner->step(); }
TUMBLE_EXPORT(state) const double* state() {
    numbers.resize(data.bodies.size() * 13);
    runner->write(numbers.data());
    return numbers.data();
}
TUMBLE_EXPORT(status) unsigned status() { return runner->status(); }

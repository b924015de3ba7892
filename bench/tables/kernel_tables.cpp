#include "tables/kernel_tables.hpp"

#include <tumble/integrators/list.hpp>
#include <tumble/tumble.hpp>

#include <cmath>

namespace tumble::bench {
namespace {

std::string short_text(double value, const char* format = "%.4g") {
    return std::isinf(value) ? "any" : text(format, value);
}

// The last digit of a fixed-point number.
template <class Number>
Real last_digit() {
    return Real::scaled(1, -Number::fraction_bits);
}

// The orders of a method: with loads, and of a free rotation where that differs.
template <class Method>
std::string order_of() {
    std::string order = std::to_string(Method::order);
    if constexpr (requires { Method::free_order; }) {
        if (Method::free_order == no_truncation) order += ", free: exact";
        else if (Method::free_order != Method::order) order += ", free: " + std::to_string(Method::free_order);
    }
    return order;
}

template <bool bodies_touch, bool boxes_touch, bool has_friction, int room>
struct Touching : Scene {
    static constexpr Features features{.bodies = 6,
                                       .planes = 2,
                                       .near_pairs = room,
                                       .pairs = bodies_touch,
                                       .boxes = boxes_touch,
                                       .friction = has_friction};
};
template <bool... options>
std::string bytes_of_a_pair() {
    constexpr std::size_t pairs = 8;
    return std::to_string((sizeof(World<Touching<options..., 4 + pairs>>) - sizeof(World<Touching<options..., 4>>)) /
                          pairs);
}

// A world whose contacts are read, and the same without.
template <class N, bool has_friction, bool is_read, int room>
struct Read : Scene {
    using Numbers = N;
    static constexpr Features features{
        .bodies = 6, .near_pairs = room, .pairs = true, .friction = has_friction, .contact_readout = is_read};
};
template <class N, bool has_friction, bool is_read>
constexpr std::size_t bytes_of_a_read_pair() {
    constexpr std::size_t pairs = 8;
    return (sizeof(World<Read<N, has_friction, is_read, 4 + pairs>>) -
            sizeof(World<Read<N, has_friction, is_read, 4>>)) /
           pairs;
}
template <class N, bool has_friction>
std::string bytes_of_readout() {
    return std::to_string(bytes_of_a_read_pair<N, has_friction, true>() -
                          bytes_of_a_read_pair<N, has_friction, false>());
}

struct Boxes : Scene {
    static constexpr Features features{.bodies = 2, .planes = 1, .pairs = true, .boxes = true, .friction = true};
};

}  // namespace

Table integrators_table(const Rows& free_body) {
    Table table{{"integrator", "order", "a step needs", "cortex-m3, q32", "worst", "cortex-m4f, plain float", "worst"},
                {}};
    Integrators::for_each([&]<class Method>() {
        std::string needs = "-";
        if constexpr (requires { Method::needs; }) needs = Method::needs;
        Strings line{in_code(Method::name), order_of<Method>(), needs};
        for (const Where& where : {Where{{"core", "cortex-m3"}, {"numbers", "q32 carry"}},
                                   Where{{"core", "cortex-m4f"}, {"numbers", "f32 plain"}}}) {
            Where of_method = where;
            of_method.emplace_back("integrator", Method::name);
            const Row* row = find(free_body, of_method);
            line.push_back(row == nullptr ? "-" : host::cost_of(*row).mean_text());
            line.push_back(row == nullptr ? "-" : host::cost_of(*row).worst_text());
        }
        table.lines.push_back(line);
    });
    return table;
}

Table formats_table() {
    Table table{{"range preset", "position", "velocity", "spin"}, {}};
    Ranges::for_each([&]<class Entry>() {
        using R = typename Entry::Range;
        using N = Q32<R>;
        const Real step = Real{1} / Real{256}, half{Real::scaled(1, -1)};
        const auto scale = N::Scale::of(step, step * half);
        const auto cell = [](int range, const char* unit, Real unit_in_last_place) {
            return text("±%d %s, to %.1e", range, unit, unit_in_last_place.to_double());
        };
        table.lines.push_back({Entry::name, cell(R::position, "m", last_digit<typename N::Position>()),
                               cell(R::velocity, "m/s", scale.metres(last_digit<typename N::Drift>()) / step),
                               cell(R::spin, "rad/s", scale.angle(last_digit<typename N::Turn>()) / (step * half))});
    });
    return table;
}

Table stability_table() {
    Table table{{"method", "order", "spring, `h w` up to", "drag, `h c/m` up to", "spin in `q32` is"}, {}};
    Integrators::for_each([&]<class Method>() {
        const bool gains = Method::oscillation_limit == 0;
        std::string spin = Method::spin == Spin::angular_momentum ? "L / I_middle" : "w";
        if constexpr (requires { Method::not_in_fixed_point; }) spin = "not there";
        table.lines.push_back({in_code(Method::name), std::to_string(Method::order),
                               gains ? "none, it gains energy" : short_text(Method::oscillation_limit),
                               short_text(Method::drag_limit), spin});
    });
    return table;
}

Table resolution_table() {
    Table table{{"range", "step s", "length m", "speed m/s", "spin rad/s", "spin up to rad/s",
                 "change of speed in a step up to m/s"},
                {}};
    Ranges::for_each([&]<class Entry>() {
        using N = Q32<typename Entry::Range>;
        for (const int n : {64, 256, 1024}) {
            const Real step = Real{1} / Real{n}, half = step * Real::scaled(1, -1);
            const auto scale = N::Scale::of(step, turn_per_spin(Spin::angular_velocity, step));
            const auto smallest = [](Real value) { return short_text(value.to_double(), "%.1e"); };
            table.lines.push_back(
                {Entry::name, "1/" + std::to_string(n), smallest(last_digit<typename N::Position>()),
                 smallest(scale.metres(last_digit<typename N::Drift>()) / step),
                 smallest(scale.angle(last_digit<typename N::Turn>()) / half),
                 short_text((scale.halved(scale.most_halvings).angle(N::largest_turn) / half).to_double()),
                 short_text((scale.metres(N::largest_drift) / step).to_double() / 4)});
        }
    });
    return table;
}

Table bounds_table() {
    struct Bound {
        const char *name, *what;
        int most;
    };
    const Bound bounds[]{{"contact::max_impacts", "impacts of an island's step that are resolved at their own time",
                          contact::max_impacts},
                         {"contact::max_resteps", "flights redone to find one impact", contact::max_resteps},
                         {"contact::max_crossings", "pairs examined because they may have passed through each other",
                          contact::max_crossings},
                         {"contact::max_points", "contact points of a pair", contact::max_points},
                         {"contact::max_sweeps", "sweeps over the resting points", contact::max_sweeps},
                         {"contact::max_impact_sweeps",
                          "sweeps over the points of an impact, and for what corrects overlaps",
                          contact::max_impact_sweeps},
                         {"contact::max_rounds",
                          "rounds of impacts that pass from pair to pair at one moment, besides one for each pair",
                          contact::max_rounds}};
    Table table{{"bound", "it limits", "to"}, {}};
    for (const Bound& bound : bounds)
        table.lines.push_back({in_code(bound.name), bound.what, std::to_string(bound.most)});
    return table;
}

Table near_pairs_table() {
    return {{"bytes of a near pair", "without friction", "with friction"},
            {{"spheres and planes", bytes_of_a_pair<false, false, false>(), bytes_of_a_pair<false, false, true>()},
             {"boxes and planes", bytes_of_a_pair<false, true, false>(), bytes_of_a_pair<false, true, true>()},
             {"spheres and each other", bytes_of_a_pair<true, false, false>(), bytes_of_a_pair<true, false, true>()},
             {"boxes and each other", bytes_of_a_pair<true, true, false>(), bytes_of_a_pair<true, true, true>()}}};
}

std::string readout_bytes(bool is_fixed_point, bool has_friction) {
    if (is_fixed_point) return has_friction ? bytes_of_readout<Q32<>, true>() : bytes_of_readout<Q32<>, false>();
    return has_friction ? bytes_of_readout<F32, true>() : bytes_of_readout<F32, false>();
}

Table control_table(const Rows& control) {
    const std::pair<const char*, const char*> calls[] = {
        {"free_step", "a free step without `control`"},
        {"step", "a free step with `control` and `imu`, and nothing set"},
        {"step_under_body_torque", "a step under a torque in the body's frame"},
        {"step_under_world_force", "a step under a force in the world's frame"},
        {"step_under_body_force", "a step under a force in the body's frame"},
        {"set_torque", "`set_torque`, body frame"},
        {"set_world_force", "`set_force`, world frame"},
        {"set_body_force", "`set_force`, body frame"},
        {"set_gravity", "`set_gravity` of a world of one body"},
        {"impulse_at_centre", "`apply_impulse` at the centre of mass"},
        {"impulse_at_point", "`apply_impulse` at a point"},
        {"impulse_prepared", "the same of two `InputVector`"},
        {"impulse_of_reals", "the same of set-up numbers"},
        {"pose_and_motion", "`pose<float>` and `motion<float>`: thirteen floats"},
        {"imu", "`imu<float>`"},
        {"set_velocity", "`set_velocity`"},
        {"set_angular_velocity", "`set_angular_velocity`, body frame"},
        {"set_pose", "`set_pose`"},
        {"recorded_torque", "`set_torque` while the world records"},
        {"scripted_step", "a step of two bodies, with an event of a script"},
        {"copy", "a copy of a world of two bodies"},
        {"save", "`save()` of it"},
        {"restore", "`restore()` of it"},
        {"remove", "`remove()` of a body"},
        {"add", "`add()` of a body: set-up numbers"}};
    std::vector<Line> lines;
    for (const auto& [call, what] : calls) lines.push_back({{what}, {{"call", call}}});
    std::vector<Column> columns;
    for (const auto& [core, numbers] :
         {std::pair{"cortex-m0", "q32"}, {"cortex-m3", "q32"}, {"cortex-m4f", "q32"}, {"cortex-m4f", "f32"}})
        columns.push_back({std::string{core} + ", " + numbers,
                           value("cycles_est"),
                           {{"core", core}, {"numbers", std::string{numbers} == "q32" ? "q32 carry" : "f32 plain"}}});
    return cross(control, {""}, lines, columns);
}

Table stories_table(const Rows& control) {
    Table table{{"example", "core", "function", "cycles", "worst"}, {}};
    for (const Row& row : control)
        if (row.contains("story"))
            table.lines.push_back({in_code(row.at("story").get<std::string>() + ".cpp"), row.at("core"),
                                   in_code(row.at("call")), text_of(row, "cycles_est"),
                                   text_of(row, "cycles_worst_est")});
    return table;
}

std::string largest_turn() {
    World<Scene> world{Seconds{1, 1}};
    BodySpec ball = sphere(1, 1);
    ball.angular_velocity = {40, 0, 0};
    const auto id = world.add(ball);
    if (!id || world.step().ok()) throw std::runtime_error{"40 rad in a step are within the numbers"};
    return text("%.3g", world.angular_velocity(*id).x.to_real().to_double());
}

}  // namespace tumble::bench

// Two systems on which explicit Euler fails, integrated with the kernel's Butcher tables: a harmonic oscillator, to
// which explicit Euler adds energy at any step, and the Lorenz equations, where every error grows a thousandfold within
// seconds. Errors are against a closed form and an integration in long double.
#include "accuracy/ordinary.hpp"

#include "rows/rows.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <boost/numeric/odeint.hpp>
#pragma GCC diagnostic pop

#include <algorithm>
#include <cstdio>

namespace {

using namespace tumble::bench;
using Number = long double;

constexpr int finest = 14;  // 2^-14 s

// E. Lorenz, Deterministic Nonperiodic Flow, J. Atmos. Sci. 20 (1963) 130: sigma 10, rho 28, beta 8/3. Dimensionless;
// `s` stands for the unit of time.
struct Lorenz {
    static constexpr const char* name = "Lorenz system";
    static constexpr std::size_t size = 3;
    static constexpr int samples = 16, coarsest = 4;
    static constexpr double interval = 0.5;
    static constexpr int fraction_bits = 23;  // the attractor lies within +-50, stages of large steps outside
    static constexpr std::array<double, size> start{1, 1, 1};

    template <class A>
    struct Rates {
        using Value = typename A::Value;
        Value one = A::value(1), sigma = A::value(10), rho = A::value(28), beta = A::value(8.0 / 3);
        void operator()(const std::array<Value, size>& y, std::array<typename A::Product, size>& rate) const {
            rate[0] = A::mul(sigma, y[1] - y[0]);
            rate[1] = A::mul(y[0], rho - y[2]) - A::mul(one, y[1]);
            rate[2] = A::mul(y[0], y[1]) - A::mul(beta, y[2]);
        }
    };
    static std::vector<std::array<Number, size>> truth() {
        using State = std::array<Number, size>;
        namespace odeint = boost::numeric::odeint;
        const auto rates = [](const State& y, State& rate, Number) {
            rate = {10 * (y[1] - y[0]), y[0] * (28 - y[2]) - y[1], y[0] * y[1] - 8 * y[2] / 3};
        };
        const auto stepper =
            odeint::make_controlled<odeint::runge_kutta_fehlberg78<State, Number, State, Number>>(1e-17L, 1e-17L);
        State y{start[0], start[1], start[2]};
        std::vector<State> states{y};
        for (int i = 0; i < samples; ++i) {
            odeint::integrate_adaptive(stepper, rates, y, i * Number(interval), (i + 1) * Number(interval),
                                       Number(1) / 256);
            states.push_back(y);
        }
        return states;
    }
    static double energy(const std::array<Number, size>&) { return 0; }
};

// x'' = -w^2 x with w = 2 rad/s from rest at 1 m.
struct Oscillator {
    static constexpr const char* name = "harmonic oscillator";
    static constexpr std::size_t size = 2;
    static constexpr int samples = 20, coarsest = 0;
    static constexpr double interval = 1;
    static constexpr int fraction_bits = 26;  // +-32
    static constexpr std::array<double, size> start{1, 0};

    template <class A>
    struct Rates {
        using Value = typename A::Value;
        Value one = A::value(1), minus_w2 = A::value(-4);
        void operator()(const std::array<Value, size>& y, std::array<typename A::Product, size>& rate) const {
            rate[0] = A::mul(one, y[1]);
            rate[1] = A::mul(minus_w2, y[0]);
        }
    };
    static std::vector<std::array<Number, size>> truth() {
        std::vector<std::array<Number, size>> states;
        for (int i = 0; i <= samples; ++i) states.push_back({std::cos(2.0L * i), -2 * std::sin(2.0L * i)});
        return states;
    }
    static double energy(const std::array<Number, size>& y) {
        return static_cast<double>((y[1] * y[1] + 4 * y[0] * y[0]) / 2);
    }
};

struct Point {
    double error = 0, energy = 0;  // the largest distance from the truth; energy at the end over energy at the start
    bool failed = false;
};

template <const auto& table, class A, class System>
Point measure(const std::vector<std::array<Number, System::size>>& truth, int n) {
    std::array<typename A::State, System::size> y;
    for (std::size_t i = 0; i < System::size; ++i) y[i] = A::State::from(tumble::Real{System::start[i]});
    const typename System::template Rates<A> rates;
    std::array<Number, System::size> now{};
    Point point;
    const auto steps = static_cast<std::int64_t>(std::ldexp(System::interval, n));
    for (std::size_t sample = 1; sample < truth.size(); ++sample) {
        for (std::int64_t step = 0; step < steps; ++step) {
            ordinary_step<table, A>(y, rates, n);
            for (const auto& number : y) point.failed = point.failed || !A::holds(number.value());
            if (point.failed) return point;
        }
        Number square = 0;
        for (std::size_t i = 0; i < System::size; ++i) {
            now[i] = static_cast<Number>(y[i].to_real().to_double());
            square += (now[i] - truth[sample][i]) * (now[i] - truth[sample][i]);
        }
        point.error = std::max(point.error, static_cast<double>(std::sqrt(square)));
    }
    point.energy = System::energy(now) / System::energy(truth[0]);
    return point;
}

template <const auto& table, class A, class System>
void add_rows(std::vector<Row>& rows, const char* method, const std::vector<std::array<Number, System::size>>& truth) {
    Point before{0, 0, true};
    for (int n = System::coarsest; n <= finest; ++n) {
        const Point point = measure<table, A, System>(truth, n);
        Row row = row_of(System::name, "host", A::name, A::carry, method, std::ldexp(1.0, -n));
        if (point.failed) {
            row["failure"] = A::name == std::string{"q32"} ? "range_left" : "not finite";
        } else {
            row["state_error"] = point.error;
            if (System::size == 2) row["energy_ratio"] = point.energy;
            if (!before.failed && point.error > 0) row["observed_order"] = observed_order(before.error, point.error);
        }
        rows.push_back(row);
        before = point;
    }
}

template <class System>
void add_system(std::vector<Row>& rows) {
    const auto truth = System::truth();
    const auto in = [&]<class A>() {
        add_rows<tumble::euler_table, A, System>(rows, "explicit_euler", truth);
        add_rows<tumble::midpoint_table, A, System>(rows, "midpoint", truth);
        add_rows<tumble::heun_table, A, System>(rows, "heun", truth);
        add_rows<tumble::rk4_table, A, System>(rows, "rk4", truth);
    };
    in.template operator()<FixedArithmetic<System::fraction_bits, true>>();
    in.template operator()<FixedArithmetic<System::fraction_bits, false>>();
    in.template operator()<FloatArithmetic<float, true>>();
    in.template operator()<FloatArithmetic<float, false>>();
    in.template operator()<FloatArithmetic<double, false>>();
}

}  // namespace

int main(int argc, char** argv) try {
    tumble::host::tell_lost_output();
    const char* results = argc > 1 ? argv[1] : "build/results/ordinary.jsonl";
    tumble::host::OutputFile file = tumble::bench::rows_file(results);
    std::vector<Row> rows;
    add_system<Oscillator>(rows);
    add_system<Lorenz>(rows);
    write_rows(file, rows);
    std::printf("%zu rows in %s\n", rows.size(), results);
    return 0;
} catch (...) { return tumble::bench::report_failure("tumble_ordinary"); }

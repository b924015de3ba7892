// Maps of stability: for every method and number system, the outcome of a scene over two of its parameters, one of
// which is or sets the step. A map is a scene file, the changes of its two parameters, and the measurement of a run. A
// cell's outcome follows from the measurement by rules that all maps share (judge). A new map is one file here, one
// scene, and a line in the list of maps.cpp.
#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene/description.hpp"
#include "simulation/simulation.hpp"
#include "stress/scene_file.hpp"
#include "verdict/accuracy.hpp"

namespace tumble::bench::stress {

using host::Method;

// The letters of the rows.
enum class Outcome : char {
    accurate = 'a',    // as accurate as the method's order and the number system's rounding let it be, and within 0.1
    drifts = 'd',      // wrong, but a motion of the same kind: bounded energy, orientation of unit length, no status
    blows_up = 'b',    // beyond that without a status, and the verdict of `tumble run` is that the run is wrong
    range_left = 'r',  // the status says that a value left the range of its number system
    told = 't',        // another status
    silent = 's',      // wrong beyond drifting, or by far more than the number system explains: no status, no verdict
    not_run = '.',     // the method does not take such a scene
};
inline constexpr Outcome all_outcomes[] = {Outcome::accurate,   Outcome::drifts, Outcome::blows_up,
                                           Outcome::range_left, Outcome::told,   Outcome::silent};
// A few words, for legends and counts.
[[nodiscard]] const char* words_of(Outcome outcome);

struct Axis {
    std::string key;    // of rows
    std::string label;  // of pictures
    std::string unit;   // empty: a pure number
    bool logarithmic = false;
    std::vector<double> fine, coarse;     // ascending
    std::vector<std::string> names = {};  // of the values 0, 1, 2 ... where these are no quantity; empty: they are

    [[nodiscard]] const std::vector<double>& values(bool coarse_ones) const { return coarse_ones ? coarse : fine; }
};
// Numbers of equal ratio, or of equal distance, with both ends; rounded to four digits.
[[nodiscard]] std::vector<double> logarithmic_values(double first, double last, int count);
[[nodiscard]] std::vector<double> linear_values(double first, double last, int count);

// In rad or relative. An error beyond the first is not accurate, one up to the second always is; between them it is
// accurate up to this multiple of the expected error.
inline constexpr double largest_accurate_error = 0.1;
inline constexpr double always_accurate = 1e-6;
inline constexpr double accurate_factor = 4;
// A larger error is silent if the number system makes it: it is 1000 times the floor and 1000 times that of f64.
inline constexpr double least_silent_error = 1e-3;
inline constexpr double number_system_factor = 1000;

// A wrong motion within these bounds is of the same kind.
struct Bounds {
    double energy = 2;         // relative to the largest energy of the true motion
    double norm_error = 1e-3;  // of a quaternion's length
    double depth = unbounded;  // penetration, in tolerances of contacts
    double error = unbounded;  // unless the method's order or the floor explains it

    static constexpr double unbounded = std::numeric_limits<double>::infinity();
};

// The measurements of a run, from which its outcome follows.
struct Measured {
    // Largest distance from the truth over the samples of the map: rad, or relative to the size of the motion.
    double error = 0;
    // The largest energy, relative to the largest of the true motion.
    double energy_most = 1;
    double norm_error = 0;  // of a quaternion's length
    double depth = 0;       // penetration, in tolerances of contacts
    bool finite = true;
    std::vector<host::Trouble> troubles;

    void see_error(long double now) { see(error, now); }
    void see_energy(long double ratio) { see(energy_most, ratio); }
    void see_norm(long double length) { see(norm_error, std::abs(length - 1)); }
    void see_depth(long double now) { see(depth, now); }

private:
    // NaN counts as the largest.
    void see(double& largest, long double now) {
        if (!(now <= largest)) largest = static_cast<double>(now);
        finite = finite && std::isfinite(now);
    }
};

struct Judgement {
    Outcome outcome = Outcome::not_run;
    std::string cause;  // why it is not accurate, in a few words; a status by its name
};

class Map {
public:
    // The scene is scenes/NAME.toml beside this file; a map that shares another's names it.
    Map(std::string name, std::string title, Axis x, Axis y, const std::string& scene = {});
    virtual ~Map() = default;

    [[nodiscard]] const std::string& name() const { return name_; }    // key of rows, stem of the picture's file
    [[nodiscard]] const std::string& title() const { return title_; }  // of the picture
    [[nodiscard]] const Axis& x() const { return x_; }
    [[nodiscard]] const Axis& y() const { return y_; }

    // The scene of a cell as a file, and read.
    [[nodiscard]] SceneFile scene_file(double x, double y) const;
    [[nodiscard]] host::SceneDescription scene(double x, double y) const { return scene_file(x, y).description(); }

    // Silent cells of contacts are listed; those of other maps are an error.
    [[nodiscard]] virtual bool has_contacts() const { return false; }
    // Computes the data that runs share, such as the truth of each y. Called once before the first measurement.
    virtual void prepare(const std::vector<double>& /*y_values*/) {}

    // Measures the cell's scene in a simulation that has not begun.
    [[nodiscard]] virtual Measured measure_run(double x, double y, host::Simulation& simulation) const = 0;
    [[nodiscard]] Measured measure(double x, double y, const Method& method) const;
    // The error that rounding alone makes in this cell, in the unit of Measured::error. See resolution().
    [[nodiscard]] virtual double rounding_floor(double x, double y, const Method& method) const = 0;
    // An integrator for which this is false has no row.
    [[nodiscard]] virtual bool takes(const host::IntegratorInfo& /*method*/) const { return true; }
    [[nodiscard]] virtual Bounds bounds(const host::IntegratorInfo& /*method*/) const { return {}; }
    // In floors: beyond this error truncation dominates rounding, so that the run shows the error of the order.
    [[nodiscard]] virtual double floors_of_truncation() const { return number_system_factor; }
    // The order at which the error shrinks with the step.
    [[nodiscard]] virtual int order(const host::IntegratorInfo& method) const { return method.order; }

    // The largest x, from the shortest step on, at which theory says that the method is stable; the end of the axis
    // where it never is, empty where it always is or theory does not say.
    [[nodiscard]] virtual std::optional<double> limit(double /*y*/, const Method& /*method*/) const { return {}; }
    // The outcome of a cell, or of a simulation of it that has not begun.
    [[nodiscard]] Judgement judge(double x, double y, const Method& method) const;
    [[nodiscard]] Judgement judge(double x, double y, const Method& method, host::Simulation& simulation) const;

protected:
    virtual void change(SceneFile& scene, double x, double y) const = 0;
    // The position on the x axis at which is_beyond(x) becomes true; as limit().
    [[nodiscard]] std::optional<double> limit_where(double y, const std::function<bool(double)>& is_beyond) const;

private:
    [[nodiscard]] double expected_error(double x, double y, const Method& method) const;

    std::string name_, title_;
    Axis x_, y_;
    SceneFile template_;
    struct Anchor {
        std::string integrator;
        double y, step, error;
    };
    mutable std::vector<Anchor> anchors_;
};

// Where the scenes are.
[[nodiscard]] std::filesystem::path scene_directory();

// The maps, each made once.
[[nodiscard]] const std::vector<std::unique_ptr<Map>>& maps();
// Throws std::invalid_argument for an unknown name.
[[nodiscard]] Map& map_named(const std::string& name);

// ---- Parts of judging, and helpers of the measurements. ----

// Facts of a cell beside its run. The functions are called only if the outcome depends on them.
struct Expectation {
    double floor = 0, floor_in_f64 = 0;  // error that rounding alone makes
    std::function<double()> of_order;    // error that the method's order gives
    std::function<Measured()> in_f64;    // the same run in f64
    std::function<std::string()> wrong;  // why the verdict on the cell is that it is wrong; empty: it is not
    bool is_f64 = false;
    Bounds bounds;
};
[[nodiscard]] Judgement judge(const Measured& run, const Expectation& expectation);

// The relative error of one rounding: 2^-53 in f64, 2^-24 in f32; in fixed point half the last digit of a quantity of
// this size, which has 30 bits below the limit of the scene's range.
enum class Quantity { position, velocity, spin };
[[nodiscard]] double resolution(const host::SceneDescription& scene, const Method& method, Quantity quantity,
                                double size);
// The sum of the roundings of many steps, in units of one: a random walk, or 1 with carried residuals.
[[nodiscard]] double random_walk(const Method& method, double steps);

// Steps until the simulation has a status, is not finite, or has ended. Calls after_steps() after each `every` steps.
[[nodiscard]] Measured run_to_the_end(host::Simulation& simulation, std::int64_t every,
                                      const std::function<void(Measured&)>& after_steps);

}  // namespace tumble::bench::stress

// Bounds of errors, made of tolerances. Every comparison of an error with a bound is recorded. A run of all tests then
// shows the used share of each tolerance, and finds tolerances that are much larger than any error.
#pragma once

#include "worlds.hpp"

#include <iosfwd>

namespace tumble::test {

// A tolerance times a factor of the case, or a sum of such terms, which counts as its largest term.
class Bound {
public:
    Bound() = default;  // zero
    Bound(const char* row, const char* column, Number tolerance)
        : row_{row}, column_{column}, tolerance_{tolerance}, value_{tolerance} {}

    [[nodiscard]] Number value() const { return value_; }

    friend Bound operator*(Bound a, Number factor) {
        a.factor_ *= factor;
        a.value_ *= factor;
        return a;
    }
    friend Bound operator*(Number factor, const Bound& a) { return a * factor; }
    friend Bound operator+(const Bound& a, const Bound& b) {
        const bool b_is_larger = a.is_zero() || (!b.is_zero() && a.factor_ * a.tolerance_ < b.factor_ * b.tolerance_);
        Bound sum = b_is_larger ? b : a;
        sum.value_ = a.value_ + b.value_;
        return sum;
    }
    // Also records the error. A negative error, of a quantity with one side only, needs no tolerance.
    friend bool operator<=(Number error, const Bound& bound) {
        bound.note(error);
        return error <= bound.value_;
    }
    friend void PrintTo(const Bound& bound, std::ostream* out);

private:
    void note(Number error) const;
    [[nodiscard]] bool is_zero() const { return row_[0] == '\0' || factor_ == 0; }

    const char* row_ = "";
    const char* column_ = "";
    Number tolerance_ = 0, factor_ = 1;  // of the largest part
    Number value_ = 0;                   // of the whole
};

// A name in the first column of tolerances.txt, with the values for the running test.
class Tolerance {
public:
    constexpr explicit Tolerance(const char* name) : name_{name} {}
    [[nodiscard]] Bound of(const System& system) const { return in(system.name); }
    [[nodiscard]] Bound of_order(int order) const;
    operator Bound() const { return in("all"); }

private:
    [[nodiscard]] Bound in(const char* column) const;
    const char* name_;
};
inline Bound operator*(const Tolerance& a, Number factor) { return Bound{a} * factor; }
inline Bound operator*(Number factor, const Tolerance& a) { return Bound{a} * factor; }
inline Bound operator+(const Tolerance& a, const Bound& b) { return Bound{a} + b; }
inline Bound operator+(const Bound& a, const Tolerance& b) { return a + Bound{b}; }
inline bool operator<=(Number error, const Tolerance& tolerance) { return error <= Bound{tolerance}; }
inline void PrintTo(const Tolerance& tolerance, std::ostream* out) { PrintTo(Bound{tolerance}, out); }

}  // namespace tumble::test

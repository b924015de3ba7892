// The cost of an instruction on a core with zero-wait-state memory: the least and the most that its manual allows, and
// an estimate by the documented rules of how neighbours overlap. README.md says what was checked on silicon.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "instruction.hpp"

namespace cycles {

struct Cycles {
    int min = 0, est = 0, max = 0;

    constexpr Cycles& operator+=(const Cycles& c) {
        min += c.min, est += c.est, max += c.max;
        return *this;
    }
    friend constexpr bool operator==(const Cycles&, const Cycles&) = default;
};

enum class Model : std::uint8_t { m0, m0plus, m3, m4f };
inline constexpr int model_count = 4;

// The model of this name (m0, m0+, m3, m4f); none for another name.
[[nodiscard]] std::optional<Model> model_named(std::string_view name);
// The manual that its table is from.
[[nodiscard]] std::string_view manual_of(Model);

class Timing {
public:
    // `multiplier`: cycles of MUL on an M0 or M0+, 1 or, with the small multiplier that a chip may have, 32.
    explicit Timing(Model model, int multiplier = 1) : model_{model}, multiplier_{multiplier} {}

    // Does the core have this instruction?
    [[nodiscard]] bool knows(const Instruction&) const;

    // The cost of each of some instructions that run one after the other, beside its neighbours. The neighbours of the
    // whole stretch are unknown, and a taken branch at its end is left out.
    [[nodiscard]] std::vector<Cycles> costs(std::span<const Instruction>) const;

    // The additional cost of a branch at the end of a stretch if it is taken, to an instruction of `target_size` bytes
    // at `target`.
    [[nodiscard]] Cycles taken(const Instruction& branch, std::uint32_t target, int target_size) const;

private:
    [[nodiscard]] Cycles cost(const Instruction&, const Instruction* before, const Instruction* after) const;
    [[nodiscard]] int hidden_beside_division(std::span<const Instruction> following) const;
    [[nodiscard]] bool is_v6m() const { return model_ == Model::m0 || model_ == Model::m0plus; }

    Model model_;
    int multiplier_;
};

}  // namespace cycles

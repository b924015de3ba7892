#include "kinds.hpp"

namespace tumble::test {

const std::vector<Kind> kinds{
    {"resistance_slows_a_body_by_its_law_and_leaves_finite_numbers", judge_resistance},
};

}  // namespace tumble::test

#include "kinds.hpp"

namespace tumble::test {

const std::vector<Kind> kinds{};

}  // namespace tumble::test

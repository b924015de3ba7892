// The scenes that are compared bit by bit: one for each set of features. Speeds and places fit the smallest range.
#pragma once

#include "worlds.hpp"

namespace tumble::test {

[[nodiscard]] const std::vector<SceneSetup>& scenes();

}  // namespace tumble::test

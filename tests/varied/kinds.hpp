// The kinds of varied scenes: each is one source file, one declaration here and one line in kinds.cpp.
#pragma once

#include "varied.hpp"

namespace tumble::test {

std::string judge_resistance(Draw& draw, Case& drawn);

}  // namespace tumble::test

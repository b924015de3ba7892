// The kinds of varied scenes: each is one source file, one declaration here and one line in kinds.cpp.
#pragma once

#include "varied.hpp"

namespace tumble::test {

std::string judge_resistance(Draw& draw, Case& drawn);

namespace moving_surfaces {  // carried.cpp
std::string carried(Draw& draw, Case& run);
std::string pushed(Draw& draw, Case& run);
std::string turned(Draw& draw, Case& run);
}  // namespace moving_surfaces

namespace edges {
std::string leaving_ball(Draw& draw, Case& run);
std::string tipping_box(Draw& draw, Case& run);
}  // namespace edges

}  // namespace tumble::test

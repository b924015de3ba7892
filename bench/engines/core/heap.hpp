// The heap of the engines, which firmware of this project does not have.
#pragma once

#include <cstddef>

// Most bytes that were in use at one time, with 8 for each block.
[[nodiscard]] std::size_t heap_peak();

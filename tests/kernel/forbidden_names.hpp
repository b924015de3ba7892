// What the kernel's headers may include, and then the names they may not use: no heap, no exceptions, no output.
#pragma once

#include <tumble/config.hpp>

#include <Eigen/Core>

#include <bit>
#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#pragma GCC poison malloc calloc realloc free new throw try catch printf puts abort exit
#pragma GCC poison sin cos sinf cosf sqrtf tan atan2 pow fabs floor

// Names that the kernel's headers may not use. Included after all headers that they include: no heap, no exceptions, no
// output.
#pragma once

#include <tumble/config.hpp>

#pragma GCC poison malloc calloc realloc free new throw try catch printf puts abort exit
#pragma GCC poison sin cos sinf cosf sqrtf tan atan2 pow fabs floor

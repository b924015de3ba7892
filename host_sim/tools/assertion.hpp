// What a failed assertion of the kernel does on the host: the command says what failed and ends with status 1. Included
// before everything else, by the compiler's command line.
#pragma once

namespace tumble::host {

// Throws std::logic_error.
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line);

}  // namespace tumble::host

#define TUMBLE_ASSERT(condition)                                                                                       \
    ((condition) ? (void)0 : ::tumble::host::assertion_failed(#condition, __FILE__, __LINE__))

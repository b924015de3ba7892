// On the host a failed assertion of the kernel throws, so that the command prints a message and ends with status 1. The
// compiler's command line includes this file before every source.
#pragma once

namespace tumble::host {

// Throws std::logic_error.
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line);

}  // namespace tumble::host

#define TUMBLE_ASSERT(condition)                                                                                       \
    ((condition) ? (void)0 : ::tumble::host::assertion_failed(#condition, __FILE__, __LINE__))

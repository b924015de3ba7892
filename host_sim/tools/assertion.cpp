#include "tools/assertion.hpp"

#include <stdexcept>
#include <string>

#include "tools/raise.hpp"

namespace tumble::host {

void assertion_failed(const char* condition, const char* file, int line) {
    raise(std::logic_error("the kernel's assertion " + std::string(condition) + " failed in " + file + ", line " +
                           std::to_string(line)));
}

}  // namespace tumble::host

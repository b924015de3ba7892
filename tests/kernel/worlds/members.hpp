// The number of members of an aggregate.
#pragma once

#include <cstddef>

namespace tumble::test {

// Converts to any member. Counts the members of an aggregate.
struct Anything {
    template <class T>
    constexpr operator T() const;
};
template <class T, class... Members>
[[nodiscard]] constexpr std::size_t count_of_members() {
    if constexpr (requires { T{Members{}..., Anything{}}; }) return count_of_members<T, Members..., Anything>();
    else return sizeof...(Members);
}

}  // namespace tumble::test

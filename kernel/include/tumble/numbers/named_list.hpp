// Lists of types with names. The entries of the lists in systems.hpp are such types.
#pragma once

#include <tumble/config.hpp>
#include <tumble/numbers/ieee.hpp>

namespace tumble {

namespace detail {

// A name as a template argument.
template <std::size_t size>
struct Name {
    char text[size];

    constexpr Name(const char (&name)[size]) {  // NOLINT(google-explicit-constructor): literals read as names
        for (std::size_t i = 0; i < size; ++i) text[i] = name[i];
    }
    template <std::size_t other>
    [[nodiscard]] constexpr bool operator==(const Name<other>& name) const {
        if (size != other) return false;
        for (std::size_t i = 0; i < size; ++i)
            if (text[i] != name.text[i]) return false;
        return true;
    }
};

}  // namespace detail

template <detail::Name range_name, class R>
struct NamedRange {
    static constexpr detail::Name key = range_name;
    static constexpr const char* name = key.text;
    using Range = R;
};

// Where a number system runs. f64 with a carried residual is a reference for the host; no firmware is built with it.
enum class Runs : std::uint8_t { everywhere, on_the_host };

// FixedPoint: a number system whose formats follow from the declared range. FloatingPoint: one without a range.
template <detail::Name system_name, template <class, bool> class Type, bool carry, Runs where = Runs::everywhere>
struct FixedPoint {
    static constexpr detail::Name key = system_name;
    static constexpr const char* name = key.text;
    static constexpr bool fixed_point = true;
    static constexpr Runs runs = where;
    template <class Range>
    using Numbers = Type<Range, carry>;
};
template <detail::Name system_name, class T, bool carry, Runs where = Runs::everywhere>
struct FloatingPoint {
    static constexpr detail::Name key = system_name;
    static constexpr const char* name = key.text;
    static constexpr bool fixed_point = false;
    static constexpr Runs runs = where;
    template <class>
    using Numbers = Float<T, carry>;
};

namespace detail {

template <Name name, class... Entries>
struct FindNamed {
    static_assert(name == Name{""}, "no entry of the list has this name");
};
template <Name name, class First, class... Rest>
struct FindNamed<name, First, Rest...>
    : std::conditional_t<name == First::key, std::type_identity<First>, FindNamed<name, Rest...>> {};

}  // namespace detail

template <class... Entries>
struct NamedList {
    static constexpr int count = sizeof...(Entries);

    template <detail::Name name>
    using Named = typename detail::FindNamed<name, Entries...>::type;
    // Calls f.template operator()<Entry>() for each.
    template <class F>
    static constexpr void for_each(F&& f) {
        (f.template operator()<Entries>(), ...);
    }
};

}  // namespace tumble

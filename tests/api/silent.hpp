// A header in which two public names have no comment: a member and a function.
#pragma once

namespace tumble {

// A comment above.
struct Talk {
    // Of a constructor whose initialisers have braces.
    Talk(int first, int second) : told{first}, spoken{second, 1} {}

    int told = 0;            // behind, "quoted"
    int spoken[2] = {1, 2};  // behind braces
    int silent = 0;
};

int quiet(int silent);

// Above a template.
template <int most = 1, class = decltype(Talk{1, 2})>
struct Talks {
    // Not of the function, but in it.
    friend bool operator==(const Talks&, const Talks&) { return true; }  // operators are hidden
};

}  // namespace tumble

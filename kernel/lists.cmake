# The kernel's own lists, for builds that make one program an entry: the integrators in integrators/list.hpp and the
# number-system variants in numbers/variants.hpp. The headers are the source; nothing is listed twice.
set(kernel_headers ${CMAKE_CURRENT_LIST_DIR}/include/tumble)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
    ${kernel_headers}/integrators/list.hpp ${kernel_headers}/numbers/variants.hpp)

file(STRINGS ${kernel_headers}/integrators/list.hpp TUMBLE_INTEGRATORS REGEX "^    integrators::")
list(TRANSFORM TUMBLE_INTEGRATORS REPLACE "^ *integrators::([A-Za-z0-9]+).*" "\\1")

file(STRINGS ${kernel_headers}/numbers/variants.hpp TUMBLE_NUMBER_VARIANTS REGEX "^struct [a-z0-9_]+ {")
list(TRANSFORM TUMBLE_NUMBER_VARIANTS REPLACE "^struct ([a-z0-9_]+) .*" "\\1")

# Compiler options that suit a number system. GCC schedules before it allocates registers; 13 of them full of 64-bit sums
# then spill, which costs integer systems 4 to 8 % of a step. Floating point has its own registers and gains from it.
# Registers renamed after allocation save 2 %, and no partial redundancy elimination, which lengthens lives, 1 %.
function(tumble_variant_options variant result)
    set(options "")
    if(variant MATCHES "^q32")
        set(options -fno-schedule-insns -frename-registers -fno-tree-pre)
    endif()
    set(${result} ${options} PARENT_SCOPE)
endfunction()

# The kernel's own lists, for builds that make one program an entry: the integrators in integrators/list.hpp and the
# number-system variants in numbers/variants.hpp. The headers are the source; nothing is listed twice.
set(kernel_headers ${CMAKE_CURRENT_LIST_DIR}/include/tumble)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
    ${kernel_headers}/integrators/list.hpp ${kernel_headers}/numbers/variants.hpp)

file(STRINGS ${kernel_headers}/integrators/list.hpp TUMBLE_INTEGRATORS REGEX "^    integrators::")
list(TRANSFORM TUMBLE_INTEGRATORS REPLACE "^ *integrators::([A-Za-z0-9]+).*" "\\1")

file(STRINGS ${kernel_headers}/numbers/variants.hpp TUMBLE_NUMBER_VARIANTS REGEX "^struct [a-z0-9_]+ {")
list(TRANSFORM TUMBLE_NUMBER_VARIANTS REPLACE "^struct ([a-z0-9_]+) .*" "\\1")

# The integrators that say why they do not run in fixed point, as runs_in in integrators/method.hpp asks them.
set(TUMBLE_FLOATING_POINT_INTEGRATORS "")
file(GLOB method_headers CONFIGURE_DEPENDS ${kernel_headers}/integrators/*.hpp)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${method_headers})
foreach(header IN LISTS method_headers)
    file(STRINGS ${header} lines REGEX "^struct [A-Za-z0-9]+|const char\\* not_in_fixed_point")
    foreach(line IN LISTS lines)
        if(line MATCHES "^struct ([A-Za-z0-9]+)")
            set(method ${CMAKE_MATCH_1})
        else()
            list(APPEND TUMBLE_FLOATING_POINT_INTEGRATORS ${method})
        endif()
    endforeach()
endforeach()

# The integrators that run in a number system.
function(tumble_integrators_of variant result)
    set(methods ${TUMBLE_INTEGRATORS})
    if(variant MATCHES "^q32")
        list(REMOVE_ITEM methods ${TUMBLE_FLOATING_POINT_INTEGRATORS})
    endif()
    set(${result} ${methods} PARENT_SCOPE)
endfunction()

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

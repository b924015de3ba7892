# The kernel's lists, for builds that make one program for each entry. They are read from the headers, so nothing is
# listed twice.
#   TUMBLE_INTEGRATORS                 integrators/list.hpp, in its order
#   TUMBLE_FLOATING_POINT_INTEGRATORS  those with a member not_in_fixed_point, see runs_in in integrators/method.hpp
#   TUMBLE_NUMBER_SYSTEMS              numbers/systems.hpp, in its order
#   TUMBLE_FIXED_POINT_SYSTEMS         those in integers
#   TUMBLE_NUMBER_VARIANTS             those with which firmware is built
#   TUMBLE_RANGES                      the ranges of fixed point, the smallest first
#   TUMBLE_RANGED_SYSTEMS              the number systems, those in integers once for each range: q32_near, ..., f64
# A list is read entry by entry; line breaks do not matter. Text that is not an entry stops the build. A test compares
# the result with the compiled headers (tests/kernel/worlds/lists_test.cpp).
set(kernel_headers ${CMAKE_CURRENT_LIST_DIR}/include/tumble)

# The text of a header without its comments. When the header changes, the build is configured again.
function(tumble_read_header header result)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${header})
    file(READ ${header} text)
    string(REGEX REPLACE "//[^\n]*" "" text "${text}")
    set(${result} "${text}" PARENT_SCOPE)
endfunction()

# The entries between the angle brackets of `using <name> = <list><...>;`, each of which must match `entry`.
function(tumble_read_list header name list entry result)
    tumble_read_header(${header} text)
    if(NOT text MATCHES "using[ \n]+${name}[ \n]*=[ \n]*${list}<([^;]*)>[ \n]*;")
        message(FATAL_ERROR "${header}: expected \"using ${name} = ${list}<...>;\", which kernel/lists.cmake reads")
    endif()
    string(REGEX REPLACE "[ \n]" "" body "${CMAKE_MATCH_1}")
    string(REGEX MATCHALL "${entry}" entries "${body}")
    list(JOIN entries "," read)
    if(NOT read STREQUAL body OR body STREQUAL "")
        message(FATAL_ERROR "${header}: ${name} holds \"${body}\", of which kernel/lists.cmake can read \"${read}\"; "
            "expected entries like ${entry}")
    endif()
    set(${result} "${entries}" PARENT_SCOPE)
endfunction()

tumble_read_list(${kernel_headers}/integrators/list.hpp Integrators IntegratorList "integrators::[A-Za-z0-9_]+"
    TUMBLE_INTEGRATORS)
list(TRANSFORM TUMBLE_INTEGRATORS REPLACE "^integrators::" "")

# A member belongs to the last struct that begins before it.
set(TUMBLE_FLOATING_POINT_INTEGRATORS "")
file(GLOB method_headers CONFIGURE_DEPENDS ${kernel_headers}/integrators/*.hpp)
foreach(header IN LISTS method_headers)
    tumble_read_header(${header} text)
    string(REGEX MATCHALL "(struct|class)[ \n]+[A-Za-z0-9_]+|char[ \n]*\\*[ \n]*not_in_fixed_point" words "${text}")
    set(method "")
    foreach(word IN LISTS words)
        if(word MATCHES "^(struct|class)[ \n]+(.*)")
            set(method ${CMAKE_MATCH_2})
        elseif(NOT method IN_LIST TUMBLE_INTEGRATORS)
            message(FATAL_ERROR "${header}: not_in_fixed_point is a member of ${method}, expected one of the integrators: "
                "${TUMBLE_INTEGRATORS}")
        else()
            list(APPEND TUMBLE_FLOATING_POINT_INTEGRATORS ${method})
        endif()
    endforeach()
endforeach()

set(systems_header ${kernel_headers}/numbers/systems.hpp)
tumble_read_list(${systems_header} Ranges NamedList "NamedRange<\"[a-z0-9_]+\",[A-Za-z0-9]+>" TUMBLE_RANGES)
list(TRANSFORM TUMBLE_RANGES REPLACE "^[^\"]*\"([a-z0-9_]+)\".*" "\\1")
tumble_read_list(${systems_header} NumberSystems NamedList
    "(FixedPoint|FloatingPoint)<\"[a-z0-9_]+\",[A-Za-z0-9]+,(true|false)(,Runs::on_the_host)?>" entries)
foreach(list IN ITEMS TUMBLE_NUMBER_SYSTEMS TUMBLE_FIXED_POINT_SYSTEMS TUMBLE_NUMBER_VARIANTS TUMBLE_RANGED_SYSTEMS)
    set(${list} "")
endforeach()
foreach(entry IN LISTS entries)
    string(REGEX REPLACE "^[^\"]*\"([a-z0-9_]+)\".*" "\\1" system "${entry}")
    list(APPEND TUMBLE_NUMBER_SYSTEMS ${system})
    if(entry MATCHES "^FixedPoint")
        list(APPEND TUMBLE_FIXED_POINT_SYSTEMS ${system})
        list(TRANSFORM TUMBLE_RANGES PREPEND ${system}_ OUTPUT_VARIABLE of_ranges)
        list(APPEND TUMBLE_RANGED_SYSTEMS ${of_ranges})
    else()
        list(APPEND TUMBLE_RANGED_SYSTEMS ${system})
    endif()
    if(NOT entry MATCHES "Runs::on_the_host")
        list(APPEND TUMBLE_NUMBER_VARIANTS ${system})
    endif()
endforeach()

# The integrators that run in a number system.
function(tumble_integrators_of variant result)
    set(methods ${TUMBLE_INTEGRATORS})
    if(variant IN_LIST TUMBLE_FIXED_POINT_SYSTEMS)
        list(REMOVE_ITEM methods ${TUMBLE_FLOATING_POINT_INTEGRATORS})
    endif()
    set(${result} ${methods} PARENT_SCOPE)
endfunction()

# The best compiler options for a number system. GCC schedules before it allocates registers. The 13 registers of a core
# then spill 64-bit sums, which costs integer systems 4 to 8 % of a step. Floating point has registers of its own and
# gains from scheduling. Renaming registers after allocation saves 2 %. Partial redundancy elimination lengthens the
# lives of values; without it a step is 1 % shorter.
function(tumble_variant_options variant result)
    set(options "")
    if(variant IN_LIST TUMBLE_FIXED_POINT_SYSTEMS)
        set(options -fno-schedule-insns -frename-registers -fno-tree-pre)
    endif()
    set(${result} ${options} PARENT_SCOPE)
endfunction()

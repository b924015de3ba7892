# tumble_add_firmware() and tumble_add_firmware_objects() for a build without a cross compiler: the same programs for the
# workstation, with the host's port. OPTIONS are for a core's compiler and are ignored. GCC does not always see that a loop
# over axes or stages sets them all; its warning of that ends no build.
include_guard(GLOBAL)
if(NOT TARGET tumble::tumble)
    add_subdirectory(${CMAKE_CURRENT_LIST_DIR}/../../kernel kernel)
endif()

add_library(tumble_program_flags INTERFACE)
target_link_libraries(tumble_program_flags INTERFACE tumble_port_host tumble::tumble)
target_compile_options(tumble_program_flags INTERFACE -O2 -fno-math-errno -fno-exceptions -fno-rtti
    -Wall -Wextra -Wconversion -Wdouble-promotion -Werror
    $<$<CXX_COMPILER_ID:GNU>:-Wno-error=maybe-uninitialized>)

function(tumble_add_firmware name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;DEFINES;OPTIONS")
    add_executable(${name} ${arg_SOURCES})
    set_target_properties(${name} PROPERTIES SUFFIX .elf)
    target_link_libraries(${name} PRIVATE tumble_program_flags)
    target_compile_definitions(${name} PRIVATE ${arg_DEFINES})
endfunction()

function(tumble_add_firmware_objects name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;DEFINES;OPTIONS")
    add_library(${name} OBJECT ${arg_SOURCES})
    target_link_libraries(${name} PRIVATE tumble_program_flags)
    target_compile_definitions(${name} PRIVATE ${arg_DEFINES})
endfunction()

# tumble_add_firmware_test(<test> FIRMWARE <name> [OUTPUT <regex>])
#   runs it under ctest; it must end with status 0, or print what matches the regex.
function(tumble_add_firmware_test test)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "FIRMWARE;OUTPUT" "")
    add_test(NAME ${test} COMMAND ${arg_FIRMWARE})
    if(arg_OUTPUT)
        set_tests_properties(${test} PROPERTIES PASS_REGULAR_EXPRESSION "${arg_OUTPUT}")
    endif()
endfunction()

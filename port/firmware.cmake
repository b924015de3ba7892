# tumble_add_firmware(<name> SOURCES <file>... [DEFINES <definition>...] [OPTIONS <option of GCC>...] [MINIMAL] [WHOLE])
#   makes <name>.elf and <name>.map for the current core (TUMBLE_CORE), linked with the start-up code, the compiler's own
#   library and no libc. MINIMAL: the least start-up code, without port.hpp, where the core's family has it. WHOLE: no other
#   source calls a function of this one but main. GCC then changes what functions take and return, as it does with -flto:
#   worlds with contacts become 4 to 8 % smaller.
# tumble_add_firmware_objects(<name> ...)
#   takes the same arguments and only compiles. Several firmware use the result as SOURCES $<TARGET_OBJECTS:<name>>.
# tumble_add_firmware_test(<test> FIRMWARE <name> [STATUS <n>] [OUTPUT <regex>] [TIMEOUT <seconds>])
#   runs it in the core's emulator under ctest; exit status n or n|m (default 0), and the text must match the regex.
# Each family of cores has a file port/<port>/family.cmake, which sets
#   family_sources         the start-up code and the port, compiled for every firmware
#   family_minimal_sources the start-up code of firmware without port.hpp, if there is one
#   family_options         compiler options of all firmware, besides the row's
#   family_linker_script   the linker's script, or the template from which CMake makes it; empty: the linker's own
#   family_link_options    the linker's options, besides the row's
#   family_libraries       libraries that are linked
#   family_libc            the C library with its mathematics, if there is one; firmware of this project does not use it
include_guard(GLOBAL)
include(${CMAKE_CURRENT_LIST_DIR}/board.cmake)

set(TUMBLE_OPTIMIZE "-O2" CACHE STRING "Optimisation flags of firmware")
set(TUMBLE_PORT_DIR ${CMAKE_CURRENT_LIST_DIR})

if(NOT TARGET tumble::tumble)
    add_subdirectory(${TUMBLE_PORT_DIR}/../kernel kernel)
endif()

tumble_read_board(${TUMBLE_CORE})
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${TUMBLE_BOARDS_FILE} ${TUMBLE_FAMILIES_FILE})
set(TUMBLE_BOARD_DIR ${CMAKE_CURRENT_BINARY_DIR}/board)
set(family_dir ${TUMBLE_PORT_DIR}/${TUMBLE_BOARD_PORT})
include(${family_dir}/family.cmake)
configure_file(${family_dir}/board.hpp.in ${TUMBLE_BOARD_DIR}/board.hpp @ONLY)
if(family_linker_script)
    configure_file(${family_linker_script} ${TUMBLE_BOARD_DIR}/firmware.ld @ONLY)
    list(APPEND family_link_options -T${TUMBLE_BOARD_DIR}/firmware.ld)
endif()

# Debug information would double the time to build; add -g to TUMBLE_OPTIMIZE for a session with a debugger.
add_library(tumble_firmware_flags INTERFACE)
target_link_libraries(tumble_firmware_flags INTERFACE tumble::tumble)
target_compile_options(tumble_firmware_flags INTERFACE
    ${TUMBLE_BOARD_FLAGS} ${family_options} -fno-exceptions -fno-rtti -fno-threadsafe-statics
    -fno-math-errno -ffunction-sections -fdata-sections -fstack-usage
    -Wall -Wextra -Wconversion -Wdouble-promotion -Werror)
target_include_directories(tumble_firmware_flags INTERFACE ${TUMBLE_PORT_DIR})

# Objects and not an archive, because nothing refers to the code of the reset. The level of optimisation is fixed, so a
# reading of the counter costs the same in every firmware. Loops stay loops: otherwise memcpy would call itself.
function(tumble_add_startup name)
    add_library(${name} OBJECT EXCLUDE_FROM_ALL ${ARGN} ${TUMBLE_PORT_DIR}/runtime.cpp)
    target_link_libraries(${name} PRIVATE tumble_firmware_flags tumble::f64)
    target_include_directories(${name} PRIVATE ${TUMBLE_BOARD_DIR} ${family_dir})
    set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF)
    target_compile_options(${name} PRIVATE -ffreestanding -fno-builtin
        $<$<CXX_COMPILER_ID:GNU>:-fno-tree-loop-distribute-patterns>)
endfunction()
tumble_add_startup(tumble_startup ${family_sources})
target_compile_options(tumble_startup PRIVATE -O2)
if(family_minimal_sources)
    tumble_add_startup(tumble_minimal_startup ${family_minimal_sources})
    target_compile_options(tumble_minimal_startup PRIVATE -Os)
endif()

add_library(tumble_firmware_link INTERFACE)
target_link_options(tumble_firmware_link INTERFACE ${TUMBLE_BOARD_FLAGS} -nostdlib ${family_link_options}
    -Wl,--gc-sections -Wl,--fatal-warnings $<TARGET_PROPERTY:tumble::f64,INTERFACE_LINK_OPTIONS>)
target_link_libraries(tumble_firmware_link INTERFACE ${family_libraries})
if(family_linker_script)
    set_property(TARGET tumble_firmware_link PROPERTY INTERFACE_LINK_DEPENDS ${TUMBLE_BOARD_DIR}/firmware.ld)
endif()

# For firmware of other projects.
add_library(tumble_libc INTERFACE)
if(family_libc)
    target_link_libraries(tumble_libc INTERFACE ${family_libc} ${family_libraries})
else()
    target_compile_options(tumble_libc INTERFACE -fno-math-errno)
endif()

# Uses the caller's arg_DEFINES, arg_OPTIONS and arg_WHOLE.
function(tumble_compile_as_firmware name)
    target_link_libraries(${name} PRIVATE tumble_firmware_flags)
    set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF)
    target_compile_definitions(${name} PRIVATE ${arg_DEFINES})
    separate_arguments(optimize UNIX_COMMAND "${TUMBLE_OPTIMIZE}")
    if(arg_WHOLE)
        list(APPEND arg_OPTIONS -fwhole-program)
    endif()
    target_compile_options(${name} PRIVATE ${optimize} "$<$<CXX_COMPILER_ID:GNU>:${arg_OPTIONS}>")
endfunction()

function(tumble_add_firmware name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "MINIMAL;WHOLE" "" "SOURCES;DEFINES;OPTIONS")
    if(arg_UNPARSED_ARGUMENTS OR NOT arg_SOURCES)
        message(FATAL_ERROR "tumble_add_firmware(${name}): needs SOURCES; unknown: '${arg_UNPARSED_ARGUMENTS}'")
    endif()
    if(NOT arg_MINIMAL)
        set(startup tumble_startup)
    elseif(TARGET tumble_minimal_startup)
        set(startup tumble_minimal_startup)
    else()
        message(FATAL_ERROR "tumble_add_firmware(${name} MINIMAL): ${family_dir} has no minimal start-up code")
    endif()
    add_executable(${name} ${arg_SOURCES} $<TARGET_OBJECTS:${startup}>)
    set_target_properties(${name} PROPERTIES SUFFIX .elf)
    tumble_compile_as_firmware(${name})
    target_link_libraries(${name} PRIVATE tumble_firmware_link)
    target_link_options(${name} PRIVATE -Wl,-Map=$<TARGET_FILE_DIR:${name}>/${name}.map)
endfunction()

function(tumble_add_firmware_objects name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;DEFINES;OPTIONS")
    add_library(${name} OBJECT ${arg_SOURCES})
    tumble_compile_as_firmware(${name})
endfunction()

function(tumble_add_firmware_test test)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "FIRMWARE;STATUS;OUTPUT;TIMEOUT" "")
    if("${arg_STATUS}" STREQUAL "")
        set(arg_STATUS 0)
    endif()
    if("${arg_TIMEOUT}" STREQUAL "")
        set(arg_TIMEOUT 60)
    endif()
    add_test(NAME ${test} COMMAND ${CMAKE_COMMAND}
        -DRUN=${CMAKE_CURRENT_FUNCTION_LIST_DIR}/qemu/run -DCORE=${TUMBLE_CORE} -DELF=$<TARGET_FILE:${arg_FIRMWARE}>
        "-DSTATUS=${arg_STATUS}" "-DOUTPUT=${arg_OUTPUT}" -DTIMEOUT=${arg_TIMEOUT}
        -P ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/qemu/expect.cmake)
endfunction()

# tumble_add_firmware() for a build without a cross compiler: the same program for the workstation, with the host's port.
# Options are those of a core's compiler and are left out.
include_guard(GLOBAL)
find_path(TUMBLE_EIGEN_DIR Eigen/Core PATH_SUFFIXES eigen3 REQUIRED DOC "Directory that holds Eigen/Core")

function(tumble_add_firmware name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;DEFINES;OPTIONS")
    add_executable(${name} ${arg_SOURCES})
    set_target_properties(${name} PROPERTIES SUFFIX .elf)
    target_link_libraries(${name} PRIVATE tumble_port_host)
    target_include_directories(${name} PRIVATE ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../../kernel/include)
    target_include_directories(${name} SYSTEM PRIVATE ${TUMBLE_EIGEN_DIR})
    target_compile_definitions(${name} PRIVATE ${arg_DEFINES})
    # No fused multiply-add: results have the same bits everywhere.
    target_compile_options(${name} PRIVATE -O2 -ffp-contract=off -fno-math-errno -fno-exceptions -fno-rtti
        -Wall -Wextra -Wconversion -Wdouble-promotion -Werror)
endfunction()

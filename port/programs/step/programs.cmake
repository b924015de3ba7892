# tumble_add_step_firmware(<prefix> VARIANT <variant> METHODS <method>... HEADER <scene header> SCENE <struct> [GROUP <group>]
#                          [PRECOMPILED])
#   makes a program <prefix>-<method>.elf for each method, which replays the scene and measures its steps. They share one
#   compilation, of <group>.cpp (default: the prefix), into the objects steps-<group>. PRECOMPILED: it reads the kernel from a
#   precompiled header of its number system, where there are several groups.
include_guard(GLOBAL)

function(tumble_add_step_firmware prefix)
    cmake_parse_arguments(PARSE_ARGV 1 arg "PRECOMPILED" "VARIANT;HEADER;SCENE;GROUP" "METHODS")
    set(group ${prefix})
    if(arg_GROUP)
        set(group ${arg_GROUP})
    endif()
    tumble_variant_options(${arg_VARIANT} options)
    # GCC does not always see that a loop over three axes sets them all, which depends on method and scene.
    list(APPEND options -Wno-error=maybe-uninitialized)
    set(source "#define TUMBLE_SCENE_HEADER \"${arg_HEADER}\"\n#define TUMBLE_SCENE ${arg_SCENE}\n")
    string(APPEND source "#define TUMBLE_VARIANT \"${arg_VARIANT}\"\n#include \"step.hpp\"\n\n")
    foreach(method IN LISTS arg_METHODS)
        string(APPEND source "int measure_${method}() { return measure<tumble::integrators::${method}>(); }\n")
    endforeach()
    file(CONFIGURE OUTPUT ${group}.cpp CONTENT "${source}" @ONLY)
    tumble_add_firmware_objects(steps-${group} SOURCES ${CMAKE_CURRENT_BINARY_DIR}/${group}.cpp OPTIONS ${options})
    target_include_directories(steps-${group} PRIVATE ${CMAKE_CURRENT_FUNCTION_LIST_DIR})
    if(arg_PRECOMPILED)
        # Its options are those of the sources that use it.
        set(headers steps-headers-${arg_VARIANT})
        if(NOT TARGET ${headers})
            file(CONFIGURE OUTPUT ${headers}.cpp CONTENT "\n" @ONLY)
            tumble_add_firmware_objects(${headers} SOURCES ${CMAKE_CURRENT_BINARY_DIR}/${headers}.cpp OPTIONS ${options})
            target_precompile_headers(${headers} PRIVATE <tumble/replay.hpp>)
            set_target_properties(${headers} PROPERTIES EXCLUDE_FROM_ALL ON)
        endif()
        target_precompile_headers(steps-${group} REUSE_FROM ${headers})
    endif()
    foreach(method IN LISTS arg_METHODS)
        tumble_add_firmware_calling(${prefix}-${method} measure_${method} steps-${group})
    endforeach()
endfunction()

# tumble_add_step_firmware(<prefix> VARIANT <variant> METHODS <method>... HEADER <scene header> SCENE <struct> [GROUP <group>])
#   makes a program <prefix>-<method>.elf for each method, which replays the scene and measures its steps. They share one
#   compilation, of <group>.cpp (default: the prefix), into the objects steps-<group>.
include_guard(GLOBAL)
set(TUMBLE_STEP_DIR ${CMAKE_CURRENT_LIST_DIR})

function(tumble_add_step_firmware prefix)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "VARIANT;HEADER;SCENE;GROUP" "METHODS")
    set(group ${prefix})
    if(arg_GROUP)
        set(group ${arg_GROUP})
    endif()
    tumble_variant_options(${arg_VARIANT} options)
    # GCC does not always see that a loop over three axes sets them all, which depends on method and scene.
    list(APPEND options -Wno-error=maybe-uninitialized)
    set(source "#define TUMBLE_SCENE_HEADER \"${arg_HEADER}\"\n#define TUMBLE_SCENE ${arg_SCENE}\n")
    string(APPEND source "#define TUMBLE_VARIANT ${arg_VARIANT}\n#include \"step.hpp\"\n\n")
    foreach(method IN LISTS arg_METHODS)
        string(APPEND source "int measure_${method}() { return measure<tumble::integrators::${method}>(); }\n")
    endforeach()
    file(CONFIGURE OUTPUT ${group}.cpp CONTENT "${source}" @ONLY)
    tumble_add_firmware_objects(steps-${group} SOURCES ${CMAKE_CURRENT_BINARY_DIR}/${group}.cpp OPTIONS ${options})
    target_include_directories(steps-${group} PRIVATE ${TUMBLE_STEP_DIR})
    foreach(method IN LISTS arg_METHODS)
        file(CONFIGURE OUTPUT main_${method}.cpp @ONLY CONTENT
            "int measure_@method@();\nint main() { return measure_@method@(); }\n")
        tumble_add_firmware(${prefix}-${method}
            SOURCES ${CMAKE_CURRENT_BINARY_DIR}/main_${method}.cpp $<TARGET_OBJECTS:steps-${group}>)
    endforeach()
endfunction()

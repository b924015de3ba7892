# tumble_compile_scene(<scene file> <directory> <header variable> [<struct variable> [<option>...]]): runs `tumble compile`
# with these options at build time. It writes <directory>/<name>.hpp, with a struct in the namespace tumble::scenes. The
# name of the struct is scene_<name> if a variable for it is given, otherwise the command's default.
include_guard(GLOBAL)

function(tumble_compile_scene scene directory header)
    get_filename_component(name ${scene} NAME_WE)
    set(file ${directory}/${name}.hpp)
    set(struct "")
    set(options ${ARGN})
    list(POP_FRONT options)
    if(ARGC GREATER 3)
        set(struct --struct scene_${name})
        set(${ARGV3} scene_${name} PARENT_SCOPE)
    endif()
    add_custom_command(OUTPUT ${file} DEPENDS ${scene} ${TUMBLE_COMMAND}
        COMMAND ${CMAKE_COMMAND} -E make_directory ${directory}
        COMMAND ${TUMBLE_COMMAND} compile ${scene} -o ${file} ${struct} ${options} VERBATIM)
    set(${header} ${file} PARENT_SCOPE)
endfunction()

# tumble_compile_scene(<scene file> <directory> <header variable> <struct variable>): what `tumble compile` makes of the
# file, at build time: <directory>/<name>.hpp, and in it a struct of the file's name in PascalCase.
include_guard(GLOBAL)

function(tumble_compile_scene scene directory header struct)
    get_filename_component(name ${scene} NAME_WE)
    set(file ${directory}/${name}.hpp)
    add_custom_command(OUTPUT ${file} DEPENDS ${scene} ${TUMBLE_COMMAND}
        COMMAND ${CMAKE_COMMAND} -E make_directory ${directory}
        COMMAND ${TUMBLE_COMMAND} compile ${scene} -o ${file} VERBATIM)
    set(type "")
    string(REPLACE "_" ";" words ${name})
    foreach(word IN LISTS words)
        string(SUBSTRING ${word} 0 1 first)
        string(SUBSTRING ${word} 1 -1 rest)
        string(TOUPPER ${first} first)
        string(APPEND type ${first}${rest})
    endforeach()
    set(${header} ${file} PARENT_SCOPE)
    set(${struct} ${type} PARENT_SCOPE)
endfunction()

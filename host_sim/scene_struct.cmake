# tumble_scene_struct(<scene file> <variable>): the name of the struct in the header that `tumble compile` makes of the
# file, which is the file's name in PascalCase.
include_guard(GLOBAL)

function(tumble_scene_struct scene result)
    get_filename_component(name ${scene} NAME_WE)
    set(type "")
    string(REPLACE "_" ";" words ${name})
    foreach(word IN LISTS words)
        string(SUBSTRING ${word} 0 1 first)
        string(SUBSTRING ${word} 1 -1 rest)
        string(TOUPPER ${first} first)
        string(APPEND type ${first}${rest})
    endforeach()
    set(${result} ${type} PARENT_SCOPE)
endfunction()

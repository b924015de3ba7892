# tumble_add_firmware_calling(<name> <function> <objects>)
#   makes the firmware <name>. Its main calls `int <function>()`, which tumble_add_firmware_objects(<objects> ...) has
#   compiled. Programs that share a compilation differ in this function only, and the linker drops the others.
include_guard(GLOBAL)

function(tumble_add_firmware_calling name function objects)
    file(CONFIGURE OUTPUT ${function}.cpp @ONLY CONTENT "int @function@();\nint main() { return @function@(); }\n")
    tumble_add_firmware(${name} SOURCES ${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp $<TARGET_OBJECTS:${objects}>)
endfunction()

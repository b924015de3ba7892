# WebAssembly with WASI, as a module that node runs: its stack has the lowest addresses of its memory, so that an overflow
# traps. The memory is the row's RAM; code is no part of it.
set(family_sources ${family_dir}/port.cpp)
set(family_options "")
set(family_linker_script "")
set(family_link_options -Wl,--stack-first -Wl,-z,stack-size=${TUMBLE_BOARD_STACK_BYTES}
    -Wl,--initial-memory=${TUMBLE_BOARD_RAM_BYTES} -Wl,--max-memory=${TUMBLE_BOARD_RAM_BYTES} -Wl,--export=__stack_pointer)
set(family_libraries "")
set(family_libc "")

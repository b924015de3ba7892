# Cortex-M: vector table and faults, SysTick or DWT as the counter, semihosting.
set(stack_alignment 8)
set(family_sources ${family_dir}/startup.cpp ${family_dir}/port.cpp ${TUMBLE_PORT_DIR}/bare_metal.cpp)
set(family_minimal_sources ${family_dir}/minimal.cpp)
set(family_options -masm-syntax-unified)
set(family_linker_script ${TUMBLE_PORT_DIR}/firmware.ld.in)
# Which words of the program are addresses: port/cortex_m/stack_bound follows pointers.
set(family_link_options -Wl,--emit-relocs)
set(family_libraries gcc)
set(family_libc m c)

# RISC-V of 32 bits in machine mode: traps and memory protection, minstret or mcycle as the counter, semihosting.
set(stack_alignment 16)
set(family_sources ${family_dir}/startup.cpp ${family_dir}/port.cpp ${TUMBLE_PORT_DIR}/bare_metal.cpp)
set(family_options "")
set(family_linker_script ${TUMBLE_PORT_DIR}/firmware.ld.in)
set(family_link_options "")
set(family_libraries gcc)
set(family_libc "")

# A bare-metal tool chain file such as firmware projects have: headers and packages are searched under the root path only.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CPU)
set(CMAKE_CXX_FLAGS_INIT "-mcpu=${CPU} -mthumb -fno-exceptions -fno-rtti -ffunction-sections")
set(CMAKE_EXE_LINKER_FLAGS_INIT
    "-mcpu=${CPU} -mthumb -nostartfiles --specs=nosys.specs -Wl,--gc-sections -T ${CMAKE_CURRENT_LIST_DIR}/cortex_m.ld")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(START_UP ${CMAKE_CURRENT_LIST_DIR}/cortex_m.cpp)

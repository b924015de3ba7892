# Tool chain for bare-metal Cortex-M: cmake -DCMAKE_TOOLCHAIN_FILE=port/cortex_m/toolchain.cmake -DTUMBLE_CORE=cortex-m3
# It checks the core against boards.txt. The row's compiler flags are applied per target (firmware.cmake), so an edited
# row takes effect in an existing build directory.
include(${CMAKE_CURRENT_LIST_DIR}/../board.cmake)

if(NOT TUMBLE_CORE)
    message(FATAL_ERROR "Name a core of port/boards.txt: -DTUMBLE_CORE=<core>")
endif()
set(TUMBLE_CORE ${TUMBLE_CORE} CACHE STRING "Core to build for: a row of port/boards.txt")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES TUMBLE_CORE)
tumble_read_board(${TUMBLE_CORE})

set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR ${TUMBLE_CORE})
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE NEVER)

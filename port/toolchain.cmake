# Tool chain of a core: cmake -DCMAKE_TOOLCHAIN_FILE=port/toolchain.cmake -DTUMBLE_CORE=cortex-m3
# It checks the core against boards.txt. The row's compiler flags are applied per target (firmware.cmake), so an edited
# row takes effect in an existing build directory. What a family of cores needs besides its compiler is in
# port/<port>/toolchain.cmake.
include(${CMAKE_CURRENT_LIST_DIR}/board.cmake)

if(NOT TUMBLE_CORE)
    message(FATAL_ERROR "Name a core of port/boards.txt: -DTUMBLE_CORE=<core>")
endif()
set(TUMBLE_CORE ${TUMBLE_CORE} CACHE STRING "Core to build for: a row of port/boards.txt")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES TUMBLE_CORE)
tumble_read_board(${TUMBLE_CORE})

set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR ${TUMBLE_CORE})
set(CMAKE_CXX_COMPILER ${TUMBLE_BOARD_COMPILER})
string(REPLACE "clang++" "clang" CMAKE_C_COMPILER ${CMAKE_CXX_COMPILER})
string(REPLACE "-g++" "-gcc" CMAKE_C_COMPILER ${CMAKE_C_COMPILER})
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE NEVER)
include(${CMAKE_CURRENT_LIST_DIR}/${TUMBLE_BOARD_PORT}/toolchain.cmake OPTIONAL)

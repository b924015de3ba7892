# Debian's compiler for RISC-V comes without a C++ library. The kernel needs header-only parts of one. Those of the
# compiler for Cortex-M serve, with newlib's C headers, because they are the same for every processor.
execute_process(COMMAND arm-none-eabi-g++ -mcpu=cortex-m0 -x c++ -E -v /dev/null
    OUTPUT_QUIET ERROR_VARIABLE search COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCH "#include <[^\n]*\n(.*)\nEnd of search list" search "${search}")
string(REGEX MATCHALL "[^ \n]+" directories "${CMAKE_MATCH_1}")
set(CMAKE_CXX_STANDARD_INCLUDE_DIRECTORIES "")
foreach(directory IN LISTS directories)
    file(REAL_PATH ${directory} directory)
    if(NOT directory MATCHES "/lib/gcc/")  # that compiler's own
        list(APPEND CMAKE_CXX_STANDARD_INCLUDE_DIRECTORIES ${directory})
    endif()
endforeach()

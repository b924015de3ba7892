# clang with Debian's packages of WASI: headers of C and C++, and the compiler's own library.
set(CMAKE_CXX_COMPILER_TARGET wasm32-wasi)

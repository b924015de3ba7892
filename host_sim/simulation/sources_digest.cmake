# Writes a header with a digest of the sources that the command and the modules of worlds have in common:
# cmake -DHEADER=sources_digest.hpp "-DROOTS=directory;directory" -P sources_digest.cmake
cmake_policy(VERSION 3.20)
set(digests "")
foreach(root IN LISTS ROOTS)
    file(GLOB_RECURSE sources ${root}/*.hpp ${root}/*.cpp)
    list(SORT sources)
    foreach(source IN LISTS sources)
        file(SHA256 ${source} digest)
        string(APPEND digests "${digest}\n")
    endforeach()
endforeach()
string(SHA256 digest "${digests}")
file(CONFIGURE OUTPUT ${HEADER} @ONLY CONTENT
"// A digest of the sources.
#pragma once

#define TUMBLE_SOURCES_DIGEST \"@digest@\"
")

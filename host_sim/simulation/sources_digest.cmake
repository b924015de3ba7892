# Writes a header with a digest of all headers that the command and the modules of worlds are compiled from:
# cmake -DHEADER=sources_digest.hpp -DROOTS=directory;directory -P sources_digest.cmake
set(digests "")
foreach(root IN LISTS ROOTS)
    file(GLOB_RECURSE headers ${root}/*.hpp)
    list(SORT headers)
    foreach(header IN LISTS headers)
        file(SHA256 ${header} digest)
        string(APPEND digests "${digest}\n")
    endforeach()
endforeach()
string(SHA256 digest "${digests}")
file(CONFIGURE OUTPUT ${HEADER} @ONLY CONTENT
"// Of the headers that this was compiled from.
#pragma once

#define TUMBLE_SOURCES_DIGEST \"@digest@\"
")

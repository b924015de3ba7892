// TUMBLE_ENTRY: what other sources call of one that is compiled as the whole program (port/firmware.cmake).
#pragma once

#if defined(__GNUC__) && !defined(__clang__)
#define TUMBLE_ENTRY [[gnu::externally_visible]]
#else
#define TUMBLE_ENTRY
#endif

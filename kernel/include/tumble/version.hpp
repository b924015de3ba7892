// The version of the kernel, and the version of its results. This is the only place that states them: CMake and the
// tests of the package manifests read the three numbers here.
#pragma once

// A program for one version builds with the next unless this has risen, or before 1.0 the minor number.
#define TUMBLE_VERSION_MAJOR 0
// Rises with what is added.
#define TUMBLE_VERSION_MINOR 1
// Rises with what is mended.
#define TUMBLE_VERSION_PATCH 0

// It rises by one whenever a recorded state hash changes: programs with equal TUMBLE_BITS give equal bits for every
// scene that both can run.
#define TUMBLE_BITS 2

#define TUMBLE_VERSION_TEXT(major, minor, patch) #major "." #minor "." #patch
#define TUMBLE_VERSION_OF(major, minor, patch) TUMBLE_VERSION_TEXT(major, minor, patch)
// "major.minor.patch"
#define TUMBLE_VERSION TUMBLE_VERSION_OF(TUMBLE_VERSION_MAJOR, TUMBLE_VERSION_MINOR, TUMBLE_VERSION_PATCH)

// The version of the kernel and the version of its results. Stated only here: CMake and the tests of the package
// manifests read these three numbers.
#pragma once

// A program for one version builds with a later one unless this number differs (before 1.0: the minor number).
#define TUMBLE_VERSION_MAJOR 0
// Rises with additions.
#define TUMBLE_VERSION_MINOR 1
// Rises with corrections.
#define TUMBLE_VERSION_PATCH 0

// Rises by one when a recorded state hash changes. Programs with equal TUMBLE_BITS give equal bits for every scene that
// both can run.
#define TUMBLE_BITS 20

#define TUMBLE_VERSION_TEXT(major, minor, patch) #major "." #minor "." #patch
#define TUMBLE_VERSION_OF(major, minor, patch) TUMBLE_VERSION_TEXT(major, minor, patch)
// "major.minor.patch"
#define TUMBLE_VERSION TUMBLE_VERSION_OF(TUMBLE_VERSION_MAJOR, TUMBLE_VERSION_MINOR, TUMBLE_VERSION_PATCH)

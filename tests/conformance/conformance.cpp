// The program with every method, as the host has room for it.
#include "conformance.hpp"

int main() { return replay_all<tumble::Integrators>(); }

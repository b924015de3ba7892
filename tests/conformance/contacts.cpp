// The contact scenes with the default integrator: see conformance.hpp.
#define TUMBLE_SUITE "contact_scenes.hpp"
#include "conformance.hpp"

int main() { return replay_all<tumble::IntegratorList<tumble::integrators::Verlet>>(); }

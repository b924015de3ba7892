// The contact scenes with the default integrator: see conformance.hpp.
#include "conformance.hpp"

int main() { return replay_all<tumble::IntegratorList<tumble::integrators::Verlet>>(); }

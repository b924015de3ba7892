// The program with every method, as the host has room for it; or with those of TUMBLE_METHODS, types joined by commas.
#include "conformance.hpp"

#ifdef TUMBLE_METHODS
using namespace tumble::integrators;
using Methods = tumble::IntegratorList<TUMBLE_METHODS>;
#else
using Methods = tumble::Integrators;
#endif

int main() { return replay_all<Methods>(); }

// The messages of ODE, in place of its own file, which takes 20 KB for printing: an error ends the program.
#include <ode/ode.h>

extern "C" {
void dSetErrorHandler(dMessageFunction*) {}
void dSetDebugHandler(dMessageFunction*) {}
void dSetMessageHandler(dMessageFunction*) {}
dMessageFunction* dGetErrorHandler() { return nullptr; }
dMessageFunction* dGetDebugHandler() { return nullptr; }
dMessageFunction* dGetMessageHandler() { return nullptr; }
void dError(int, const char*, ...) { __builtin_trap(); }
void dDebug(int, const char*, ...) { __builtin_trap(); }
void dMessage(int, const char*, ...) {}
}

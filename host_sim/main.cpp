// The command `tumble`.
#include "command/command.hpp"

int main(int argc, char** argv) { return tumble::host::command(argc, argv); }

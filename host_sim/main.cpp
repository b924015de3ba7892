// The command `tumble`.
#include "command.hpp"

int main(int argc, char** argv) { return tumble::host::command(argc, argv); }

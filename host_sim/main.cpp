// The command `tumble`.
#include "command/command.hpp"
#include "tools/output.hpp"

int main(int argc, char** argv) {
    tumble::host::tell_lost_output();
    return tumble::host::command(argc, argv);
}

// Returns MAIN_STATUS from main, after one line of text.
#include "port.hpp"

int main() {
    tumble::port::init();
    tumble::port::write("core ");
    tumble::port::write(tumble::port::core());
    tumble::port::write(", unit ");
    tumble::port::write(tumble::port::tick_unit());
    tumble::port::write("\n", 1);
    return MAIN_STATUS;
}

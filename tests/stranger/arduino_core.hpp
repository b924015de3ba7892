// The part of an Arduino core that the library's examples call.
#pragma once

struct SerialPort {
    void begin(long) {}
    template <class T>
    void println(const T&) {}
};
inline SerialPort Serial;
inline void delay(unsigned long) {}
void setup();
void loop();

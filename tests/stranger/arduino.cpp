// The kernel behind Arduino's macros, as the header Arduino.h of ArduinoCore-avr and what it includes define them. They
// are the sketch's again afterwards.
#define HIGH 0x1
#define LOW 0x0
#define INPUT 0x0
#define OUTPUT 0x1
#define INPUT_PULLUP 0x2
#define PI 3.1415926535897932384626433832795
#define HALF_PI 1.5707963267948966192313216916398
#define TWO_PI 6.283185307179586476925286766559
#define DEG_TO_RAD 0.017453292519943295769236907684886
#define RAD_TO_DEG 57.295779513082320876798154814105
#define EULER 2.718281828459045235360287471352
#define SERIAL 0x0
#define DISPLAY 0x1
#define LSBFIRST 0
#define MSBFIRST 1
#define CHANGE 1
#define FALLING 2
#define RISING 3
#define INTERNAL 3
#define DEFAULT 1
#define EXTERNAL 0
#define min(a, b) ((a) < (b) ? (a) : (b))
#define max(a, b) ((a) > (b) ? (a) : (b))
#define abs(x) ((x) > 0 ? (x) : -(x))
#define constrain(amt, low, high) ((amt) < (low) ? (low) : ((amt) > (high) ? (high) : (amt)))
#define round(x) ((x) >= 0 ? (long)((x) + 0.5) : (long)((x)-0.5))
#define radians(deg) ((deg)*DEG_TO_RAD)
#define degrees(rad) ((rad)*RAD_TO_DEG)
#define sq(x) ((x) * (x))
#define interrupts() sei()
#define noInterrupts() cli()
#define lowByte(w) ((unsigned char)((w)&0xff))
#define highByte(w) ((unsigned char)((w) >> 8))
#define bitRead(value, bit) (((value) >> (bit)) & 0x01)
#define bitSet(value, bit) ((value) |= (1UL << (bit)))
#define bitClear(value, bit) ((value) &= ~(1UL << (bit)))
#define bitToggle(value, bit) ((value) ^= (1UL << (bit)))
#define bitWrite(value, bit, bitvalue) ((bitvalue) ? bitSet(value, bit) : bitClear(value, bit))
#define bit(b) (1UL << (b))
#define word(...) makeWord(__VA_ARGS__)
#define F(string_literal) (reinterpret_cast<const __FlashStringHelper*>(string_literal))
#define PA 1
#define PB 2
#define PC 3
#define PD 4
#define PE 5
#define PF 6
#define PG 7
#define PH 8
#define PJ 10
#define PK 11
#define PL 12
#define B0 0
#define B00 0
#define B000 0
#define B0000 0
#define B00000000 0
#define B1 1
#define B01 1
#define B001 1
#define B0001 1
#define B00000001 1
#define B10 2
#define B010 2
#define B11 3
#define B011 3
#define B100 4
#define B101 5
#define B110 6
#define B111 7
#define B1000 8
#define B1111 15
#define B11111111 255
// Pins of some boards, and a sketch's own.
#define A0 10
#define A1 11
#define A2 12
#define A3 13
#define C0 14
#define C1 15
#define C2 16
#define C3 17
#define D0 18
#define D1 19
#define D2 20
#define D3 21
#define B2 30
#define B3 31
#define K 32

#include <tumble/tumble.hpp>

static_assert(min(3, 4) == 3 && max(3, 4) == 4 && abs(-3) == 3 && round(2.5) == 3 && B1 == 1 && B11111111 == 255);
static_assert(A0 == 10 && A1 == 11 && B0 == 0 && B3 == 31 && C2 == 16 && D3 == 21 && K == 32);
static_assert(sq(3) == 9 && constrain(5, 0, 4) == 4 && bit(3) == 8 && PI > 3 && lowByte(0x1234) == 0x34);

namespace {

struct Drone : tumble::Scene {};

}  // namespace

int main() {
    static tumble::World<Drone> world{tumble::Seconds{1, 256}};
    return world.step().ok() ? 0 : 1;
}

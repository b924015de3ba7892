// Correctly rounded sums of doubles, for cores without double arithmetic. GCC 12's routines for ARMv7-M lose the bits
// that are shifted out when the exponents differ by 32 or more, and so round a few differences wrongly: 14 of 60000
// measured with sparse mantissas, for example 0x403000000007ffff + 0xbe200000000003ff. The bits would then differ from
// the host's. The linker puts these functions in their place (--wrap). Exponents that differ by less go to GCC's
// routine. This file is empty for every other machine, because tumble::f64 compiles it wherever it is linked.
#if defined(__ARM_EABI__) && !(defined(__ARM_FP) && (__ARM_FP & 8) != 0)
#include <bit>
#include <cstdint>

// Run-time routines take their operands in core registers, also on cores with floating-point registers.
extern "C" {
[[gnu::pcs("aapcs")]] double __real___aeabi_dadd(double a, double b);
[[gnu::pcs("aapcs")]] double __wrap___aeabi_dadd(double a, double b);
[[gnu::pcs("aapcs")]] double __wrap___aeabi_dsub(double a, double b);
[[gnu::pcs("aapcs")]] double __wrap___aeabi_drsub(double a, double b);
}

namespace {

constexpr std::uint64_t sign_bit = std::uint64_t{1} << 63, fraction_mask = (std::uint64_t{1} << 52) - 1;

int exponent_of(std::uint64_t bits) { return static_cast<int>(bits >> 52) & 0x7ff; }

double negated(double a) { return std::bit_cast<double>(std::bit_cast<std::uint64_t>(a) ^ sign_bit); }

}  // namespace

double __wrap___aeabi_dadd(double a, double b) {
    std::uint64_t large = std::bit_cast<std::uint64_t>(a), small = std::bit_cast<std::uint64_t>(b);
    if (exponent_of(large) < exponent_of(small)) {
        const std::uint64_t other = large;
        large = small;
        small = other;
    }
    const int exponent = exponent_of(large), gap = exponent - exponent_of(small);
    if (gap < 32 || exponent == 0x7ff) return __real___aeabi_dadd(a, b);

    // The larger number is normal. Ten bits are kept below the last place; the lowest of them is sticky. A sum moves
    // the leading bit by at most one place.
    constexpr int extra = 10;
    const std::uint64_t big = ((large & fraction_mask) | (fraction_mask + 1)) << extra;
    const bool is_normal = exponent_of(small) != 0;
    const std::uint64_t mantissa = ((small & fraction_mask) | (is_normal ? fraction_mask + 1 : 0)) << extra;
    const int shift = is_normal ? gap : gap - 1;
    const std::uint64_t moved = shift < 64 ? mantissa >> shift : 0;
    const bool is_exact = shift < 64 ? (moved << shift) == mantissa : mantissa == 0;
    const std::uint64_t addend = moved | (is_exact ? 0 : 1);
    const bool subtract = ((large ^ small) & sign_bit) != 0;
    std::uint64_t sum = subtract ? big - addend : big + addend;
    int e = exponent;
    if ((sum >> (53 + extra)) != 0) {
        sum = (sum >> 1) | (sum & 1);
        ++e;
    } else if ((sum >> (52 + extra)) == 0) {
        sum <<= 1;
        --e;
    }
    const std::uint64_t rest = sum & ((1u << extra) - 1), half = 1u << (extra - 1);
    std::uint64_t bits = (static_cast<std::uint64_t>(e) << 52) + ((sum >> extra) - (fraction_mask + 1));
    if (rest > half || (rest == half && (bits & 1) != 0)) ++bits;  // a carry goes into the exponent, up to infinity
    return std::bit_cast<double>(bits | (large & sign_bit));
}
double __wrap___aeabi_dsub(double a, double b) { return __wrap___aeabi_dadd(a, negated(b)); }
double __wrap___aeabi_drsub(double a, double b) { return __wrap___aeabi_dadd(b, negated(a)); }
#endif

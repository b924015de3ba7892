// What the compiler expects of a C and C++ runtime, and nothing more: firmware links the compiler's library, no libc.
// So a heap, printf, libm or the unwinder cannot come in unnoticed: a use of one does not link.
#include <cstddef>
#include <cstdint>

#include "port.hpp"

namespace {

[[noreturn]] void stop(std::string_view why) {
    tumble::port::write(why);
    tumble::port::exit(tumble::port::abort_status);
}

// Memory seen as words whatever is stored there.
using Word [[gnu::may_alias]] = std::uint32_t;

bool word_aligned(const void* a, const void* b) {
    return ((reinterpret_cast<std::uintptr_t>(a) | reinterpret_cast<std::uintptr_t>(b)) & 3) == 0;
}

#if defined(__thumb2__)
// Copies blocks of four words, where both are word-aligned, and returns the bytes that it copied. LDM and STM
// move each word in one cycle: 3.5 cycles a word in place of 7 on a Cortex-M3. Apart, so that short copies save no
// registers for it. On a Cortex-M0, the test for a long copy would cost more than it saves.
[[gnu::noinline]] std::size_t copy_blocks(unsigned char* to, const unsigned char* from, std::size_t size) {
    const std::size_t blocks = size & ~std::size_t{15};
    for (const unsigned char* const end = to + blocks; to != end;)
        asm volatile("ldmia %0!, {r3-r6}\n\tstmia %1!, {r3-r6}"
                     : "+l"(from), "+l"(to)
                     :
                     : "r3", "r4", "r5", "r6", "memory");
    return blocks;
}
#endif

}  // namespace

extern "C" {

// Ascending, by words where both are aligned. Safe for overlap when `to` is below `from`.
void* memcpy(void* __restrict to, const void* __restrict from, std::size_t size) {
    auto* t = static_cast<unsigned char*>(to);
    auto* f = static_cast<const unsigned char*>(from);
    if (word_aligned(t, f)) {
#if defined(__thumb2__)
        if (size >= 64) [[unlikely]] {
            const std::size_t copied = copy_blocks(t, f, size);
            t += copied;
            f += copied;
            size -= copied;
        }
#endif
        for (; size >= 4; size -= 4, t += 4, f += 4) *reinterpret_cast<Word*>(t) = *reinterpret_cast<const Word*>(f);
    }
    for (; size != 0; --size) *t++ = *f++;
    return to;
}

void* memmove(void* to, const void* from, std::size_t size) {
    auto* t = static_cast<unsigned char*>(to);
    auto* f = static_cast<const unsigned char*>(from);
    if (t <= f) {
        if (word_aligned(t, f))
            for (; size >= 4; size -= 4, t += 4, f += 4)
                *reinterpret_cast<Word*>(t) = *reinterpret_cast<const Word*>(f);
        for (; size != 0; --size) *t++ = *f++;
    } else
        while (size-- != 0) t[size] = f[size];
    return to;
}

void* memset(void* to, int value, std::size_t size) {
    auto* t = static_cast<unsigned char*>(to);
    const auto byte = static_cast<unsigned char>(value);
    for (; size != 0 && !word_aligned(t, t); --size) *t++ = byte;
    const Word word = byte * 0x01010101U;
    for (; size >= 4; size -= 4, t += 4) *reinterpret_cast<Word*>(t) = word;
    for (; size != 0; --size) *t++ = byte;
    return to;
}

int memcmp(const void* a, const void* b, std::size_t size) {
    auto* x = static_cast<const unsigned char*>(a);
    auto* y = static_cast<const unsigned char*>(b);
    for (; size != 0; --size, ++x, ++y)
        if (*x != *y) return *x - *y;
    return 0;
}

// For text given as const char*, whose length the optimiser usually knows.
std::size_t strlen(const char* text) {
    const char* end = text;
    while (*end != 0) ++end;
    return static_cast<std::size_t>(end - text);
}

// Statics are never destroyed: firmware ends by exit or not at all.
void* __dso_handle = nullptr;
int __cxa_atexit(void (*)(void*), void*, void*) { return 0; }

void abort() { stop("abort\n"); }
[[noreturn]] void __cxa_pure_virtual() { stop("pure virtual call\n"); }

// Called by assert() of newlib's <cassert>.
[[noreturn]] void __assert_func(const char* file, int, const char* function, const char* condition) {
    tumble::port::write("assertion failed: ");
    tumble::port::write(condition);
    tumble::port::write(" in ");
    tumble::port::write(function != nullptr ? function : "?");
    tumble::port::write(", ");
    tumble::port::write(file);
    stop("\n");
}

#ifdef __ARM_EABI__
int __aeabi_atexit(void*, void (*)(void*), void*) { return 0; }
[[noreturn]] void __aeabi_idiv0() { stop("integer division by zero\n"); }
[[noreturn]] void __aeabi_ldiv0() { stop("integer division by zero\n"); }

// libgcc's division routines name these; defining them keeps the unwinder out of the image.
void __aeabi_unwind_cpp_pr0() {}
void __aeabi_unwind_cpp_pr1() {}
#endif
}

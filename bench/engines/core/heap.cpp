// A heap from the end of the data upwards. A block that is freed goes to a list of its size, rounded up to a power of
// two or three quarters of one. malloc takes about 35 instructions, which is in the engines' favour.
#include "heap.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <new>

extern "C" unsigned char __bss_end[];

namespace {

struct Block {
    std::size_t bytes;  // that were asked for
    Block* next;        // while it is free; its data begin here otherwise
};
constexpr std::size_t header = 8, most = 2u << 20;
static_assert(offsetof(Block, next) <= header);

std::size_t reserved, in_use, peak;
std::array<Block*, 64> free_blocks;

struct Class {
    unsigned number;
    std::size_t size;
};
Class class_of(std::size_t bytes) {
    const std::size_t wanted = bytes + header < 16 ? 16 : bytes + header;
    const auto rank = static_cast<unsigned>(std::bit_width(wanted - 1));
    const std::size_t size = std::size_t{1} << rank, smaller = size - size / 4;
    return wanted <= smaller && smaller % 8 == 0 ? Class{2 * rank, smaller} : Class{2 * rank + 1, size};
}

}  // namespace

std::size_t heap_peak() { return peak; }

extern "C" {

void* malloc(std::size_t bytes) {
    const Class wanted = class_of(bytes);
    Block*& list = free_blocks[wanted.number];
    Block* block = list;
    if (block != nullptr) {
        list = block->next;
    } else {
        if (reserved + wanted.size > most) __builtin_trap();
        block = reinterpret_cast<Block*>(reinterpret_cast<std::uintptr_t>(__bss_end + 7) / 8 * 8 + reserved);
        reserved += wanted.size;
    }
    block->bytes = bytes;
    in_use += bytes + header;
    if (in_use > peak) peak = in_use;
    return reinterpret_cast<unsigned char*>(block) + header;
}
void free(void* data) {
    if (data == nullptr) return;
    auto* block = reinterpret_cast<Block*>(static_cast<unsigned char*>(data) - header);
    in_use -= block->bytes + header;
    Block*& list = free_blocks[class_of(block->bytes).number];
    block->next = list;
    list = block;
}
void* calloc(std::size_t count, std::size_t size) {
    void* data = malloc(count * size);
    std::memset(data, 0, count * size);
    return data;
}
void* realloc(void* data, std::size_t bytes) {
    void* wider = malloc(bytes);
    if (data == nullptr) return wider;
    const std::size_t old = reinterpret_cast<Block*>(static_cast<unsigned char*>(data) - header)->bytes;
    std::memcpy(wider, data, old < bytes ? old : bytes);
    free(data);
    return wider;
}
// newlib's own functions take theirs here.
void* _malloc_r(void*, std::size_t bytes) { return malloc(bytes); }
void _free_r(void*, void* data) { free(data); }
void* _calloc_r(void*, std::size_t count, std::size_t size) { return calloc(count, size); }
void* _realloc_r(void*, void* data, std::size_t bytes) { return realloc(data, bytes); }

}  // extern "C"

void* operator new(std::size_t bytes) { return malloc(bytes); }
void* operator new[](std::size_t bytes) { return malloc(bytes); }
void operator delete(void* data) noexcept { free(data); }
void operator delete(void* data, std::size_t) noexcept { free(data); }
void operator delete[](void* data) noexcept { free(data); }
void operator delete[](void* data, std::size_t) noexcept { free(data); }

// The standard library's containers report failures here, where exceptions are off.
namespace std {
[[noreturn]] void __throw_length_error(const char*) { __builtin_trap(); }
[[noreturn]] void __throw_logic_error(const char*) { __builtin_trap(); }
[[noreturn]] void __throw_bad_alloc() { __builtin_trap(); }
[[noreturn]] void __throw_bad_array_new_length() { __builtin_trap(); }
}  // namespace std

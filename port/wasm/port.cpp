// The port on WebAssembly with WASI: its monotonic clock in nanoseconds, standard output, process exit. WebAssembly has
// no counter of instructions, and no part of a program sees all of its stack.
#include "port.hpp"

#include "board.hpp"

namespace wasi {
namespace {

struct Bytes {
    const void* data;
    std::size_t size;
};
using Result = std::uint16_t;  // 0: done
constexpr std::uint32_t standard_output = 1, monotonic_clock = 1;

}  // namespace

extern "C" {
[[clang::import_module("wasi_snapshot_preview1"), clang::import_name("fd_write")]] Result
wasi_fd_write(std::uint32_t file, const Bytes* bytes, std::size_t count, std::size_t* written);
[[clang::import_module("wasi_snapshot_preview1"), clang::import_name("clock_time_get")]] Result
wasi_clock_time_get(std::uint32_t clock, std::uint64_t precision_ns, std::uint64_t* time_ns);
[[noreturn, clang::import_module("wasi_snapshot_preview1"), clang::import_name("proc_exit")]] void
wasi_proc_exit(std::uint32_t status);
}

}  // namespace wasi

namespace tumble::port {

namespace {
bool text_lost = false;
}

void init() {
    if (ticks() == Instant{}) {
        write("port: the machine has no monotonic clock\n");
        exit(no_counter_status);
    }
}

Instant ticks() {
    std::uint64_t time_ns = 0;
    if (wasi::wasi_clock_time_get(wasi::monotonic_clock, 1, &time_ns) != 0) return Instant{};
    return Instant{time_ns};
}

// The cost of reading the clock (hundreds of ns, not constant) stays in.
std::uint64_t elapsed(Instant from, Instant to) {
    return to > from ? static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from) : 0;
}

std::string_view tick_unit() { return "ns"; }

std::string_view core() { return board::core; }

void write(std::string_view text) {
    while (!text.empty()) {
        const wasi::Bytes bytes{text.data(), text.size()};
        std::size_t written = 0;
        if (wasi::wasi_fd_write(wasi::standard_output, &bytes, 1, &written) != 0 || written == 0) {
            text_lost = true;
            return;
        }
        text.remove_prefix(written);
    }
}

std::size_t stack_peak() { return 0; }

void exit(int status) {
    if (status == 0 && text_lost) status = text_lost_status;
    if (status != 0 && (status & 0xFF) == 0) status = 255;
    wasi::wasi_proc_exit(static_cast<std::uint32_t>(status) & 0xFF);
}

}  // namespace tumble::port

extern "C" {
void __wasm_call_ctors();
int __main_void();  // main, as clang names one without arguments

// Memory is there when a module begins; constructors are not called yet.
void _start() {
    __wasm_call_ctors();
    tumble::port::exit(__main_void());
}
}

// Writes the counts, as one JSON row and as files of text.
#pragma once

#include <ostream>

#include "counter.hpp"

namespace cycles {

// One line, keys as in bench/KEYS.md. A row with unknown instructions says "valid": false.
void write_row(std::ostream&, const Counter&, Model);
// A line for each function, most expensive first: estimated cycles, min, max, insn, calls, symbol; sums over all calls.
void write_profile(std::ostream&, const Counter&, const Symbols&);
// Lines "caller;callee cycles", for programs that draw flame graphs. Their sum is the total of estimated cycles.
void write_folded(std::ostream&, const Counter&, const Symbols&);
// Lines "caller;callee address cycles": the same by the address of the instruction, for tumble_flame.
void write_places(std::ostream&, const Counter&, const Symbols&);
// A line for each conditional branch that ran: address, how often it was taken and not taken, symbol.
void write_branches(std::ostream&, const Counter&, const Symbols&);
// A line for each block that ran: start, end, runs, insn, min, est, max over all runs; for addr2line.
void write_blocks(std::ostream&, const Counter&);
// A line for each instruction of the counted code that no table has.
void write_unknown(std::ostream&, const Counter&);

}  // namespace cycles

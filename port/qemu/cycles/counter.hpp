// Sums costs over the translation blocks that QEMU executes. The cost of a block is known when it is translated, except
// for the branch at its end: the next block tells whether it was taken. So only one short callback a block runs.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <unordered_map>
#include <vector>

#include "symbols.hpp"
#include "timing.hpp"

namespace cycles {

struct Totals {
    std::uint64_t insn = 0, min = 0, est = 0, max = 0, loads = 0, stores = 0;  // loads and stores in words

    void pay(const Cycles& c) {
        min += static_cast<std::uint64_t>(static_cast<std::int64_t>(c.min));
        est += static_cast<std::uint64_t>(static_cast<std::int64_t>(c.est));
        max += static_cast<std::uint64_t>(static_cast<std::int64_t>(c.max));
    }
};

// How control leaves a block. All but `falls` may depend on a condition.
enum class Exit : std::uint8_t { falls, jump, call, returns };

// Instructions that run one after the other: a translation block of QEMU, or a part of one between markers.
struct Block {
    std::uint32_t start = 0, end = 0;  // addresses; the end is behind the last instruction
    Cycles cost;                       // without the branch at its end
    std::vector<int> est;              // estimated cycles of each instruction, where places are asked for
    std::vector<std::uint32_t> address;
    std::uint32_t insn = 0, loads = 0, stores = 0;
    Instruction last;
    Exit exit = Exit::falls;
    int first_size = 2;   // bytes of the first instruction
    int symbol = -1;      // of the start
    bool enters = false;  // the first block of a counted function
    bool begins = false;  // a counted stretch begins after it
    bool ends = false;    // a counted stretch ends before it
    bool skipped = false;
    std::array<std::uint16_t, class_count> classes{};
    std::vector<Instruction> unknown;

    std::uint64_t runs = 0, taken = 0;  // within counted calls
    Totals totals;

    [[nodiscard]] bool is_conditional() const { return exit != Exit::falls && last.conditional; }
    // Does control go on to `next` without a branch that is taken?
    [[nodiscard]] bool falls_to(const Block& next) const {
        return exit == Exit::falls || (is_conditional() && next.start == end);
    }
};

// A node of the tree of calls: a function called from another, with the costs of its own code, without its callees.
struct Node {
    int symbol = -1;
    Node* parent = nullptr;
    std::vector<std::unique_ptr<Node>> children;
    Totals own;
    std::uint64_t calls = 0;
    struct Place {
        std::uint64_t runs = 0, branches = 0;  // estimated cycles of branches taken at its end
    };
    std::unordered_map<const Block*, Place> places;  // the blocks that ran here, if places are asked for

    [[nodiscard]] Node& child(int of_symbol);
};

// The sum, the largest and the last value of a quantity over calls.
struct Spread {
    std::uint64_t sum = 0, most = 0, last = 0;
    void add(std::uint64_t value) {
        sum += value;
        if (value > most) most = value;
        last = value;
    }
};

class Counter {
public:
    Counter(const Timing& timing, const Symbols& symbols) : timing_{timing}, symbols_{symbols} {}

    // A new block, to be filled in and passed to run(). It keeps its address.
    [[nodiscard]] Block& add_block() { return blocks_.emplace_back(); }
    // The block is about to be executed.
    void run(Block&);
    // Call for a push: its lowest address, and the bytes that the function takes below it.
    void push(std::uint32_t address, std::uint32_t below);
    // Keeps for each node of the tree of calls which blocks ran in it.
    void keep_places() { keeps_places_ = true; }
    // Called with the totals of every call when it has ended.
    void (*on_call)(const Totals&, void*) = nullptr;
    void* on_call_data = nullptr;

    [[nodiscard]] const std::deque<Block>& blocks() const { return blocks_; }
    [[nodiscard]] const Node& calls_tree() const { return root_; }
    [[nodiscard]] std::uint64_t calls() const { return calls_; }
    // Of insn, min, est, max, loads and stores, in this order.
    [[nodiscard]] const std::array<Spread, 6>& spreads() const { return spreads_; }
    // From the highest to the lowest address that calls have pushed to or reserved.
    [[nodiscard]] std::uint32_t stack_bytes() const { return stack_low_ < stack_high_ ? stack_high_ - stack_low_ : 0; }

private:
    struct Frame {
        std::uint32_t return_address;
        Node* node;
    };
    // The cost of deeper calls counts for their caller.
    static constexpr std::size_t most_frames = 256;

    void settle_branch(Block& from, const Block& to);
    void pay(Block&, const Cycles&);
    void begin();
    void finish();
    void follow_call(const Block&);

    const Timing& timing_;
    const Symbols& symbols_;
    std::deque<Block> blocks_;
    Node root_;
    Node* node_ = &root_;
    std::vector<Frame> frames_;
    bool active_ = false, keeps_places_ = false;
    std::uint32_t return_address_ = 0;  // of the counted call
    Block* previous_ = nullptr;
    Totals call_;
    std::array<Spread, 6> spreads_{};
    std::uint64_t calls_ = 0;
    std::uint32_t stack_low_ = ~0u, stack_high_ = 0;
};

}  // namespace cycles

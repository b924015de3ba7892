#include "counter.hpp"

namespace cycles {

namespace {

constexpr std::uint32_t no_address = ~0u;

}  // namespace

Node& Node::child(int of_symbol) {
    for (const auto& c : children)
        if (c->symbol == of_symbol) return *c;
    children.push_back(std::make_unique<Node>());
    Node& made = *children.back();
    made.symbol = of_symbol;
    made.parent = this;
    return made;
}

void Counter::run(Block& block) {
    // An interrupt. The interrupted code continues after it.
    if (block.skipped) return;

    if (active_) {
        if (previous_ != nullptr) settle_branch(*previous_, block);
        if (block.start == return_address_ || block.ends) finish();
    }
    if (!active_ && (block.enters || block.begins)) {
        // A function returns to the end of the block that called it.
        return_address_ = block.enters && previous_ != nullptr ? previous_->end : no_address;
        begin();
    }
    if (active_) {
        follow_call(block);
        ++block.runs;
        if (keeps_places_) ++node_->places[&block].runs;
        call_.insn += block.insn;
        call_.loads += block.loads;
        call_.stores += block.stores;
        node_->own.insn += block.insn;
        block.totals.insn += block.insn;
        pay(block, block.cost);
    }
    previous_ = &block;
}

void Counter::settle_branch(Block& from, const Block& to) {
    if (from.falls_to(to)) return;
    if (from.is_conditional()) ++from.taken;
    const Cycles refill = timing_.taken(from.last, to.start, to.first_size);
    pay(from, refill);
    if (keeps_places_) node_->places[&from].branches += static_cast<std::uint64_t>(refill.est);
}

void Counter::pay(Block& block, const Cycles& c) {
    call_.pay(c);
    block.totals.pay(c);
    node_->own.pay(c);
}

void Counter::begin() {
    active_ = true;
    frames_.clear();
    node_ = &root_;
    previous_ = nullptr;
    call_ = {};
}

void Counter::finish() {
    active_ = false;
    ++calls_;
    const std::uint64_t values[]{call_.insn, call_.min, call_.est, call_.max, call_.loads, call_.stores};
    for (std::size_t i = 0; i < spreads_.size(); ++i) spreads_[i].add(values[i]);
    if (on_call != nullptr) on_call(call_, on_call_data);
}

// Moves to the node of the tree that the block belongs to.
void Counter::follow_call(const Block& block) {
    // Without names, or at the start, there is one node.
    if (symbols_.empty() || previous_ == nullptr) {
        if (node_ == &root_) node_ = &root_.child(block.symbol);
        return;
    }
    const Block& from = *previous_;
    if (from.falls_to(block)) return;
    if (from.exit == Exit::call) {
        // GCC for Armv6-M uses BL for far jumps within a function. A call goes to the start of a symbol.
        const bool stays =
            block.symbol >= 0 && block.symbol == from.symbol && block.start != symbols_[block.symbol].address;
        if (stays || frames_.size() == most_frames) return;
        frames_.push_back({from.end, node_});
        node_ = &node_->child(block.symbol);
        ++node_->calls;
        return;
    }
    for (std::size_t i = from.exit == Exit::returns ? frames_.size() : 0; i-- > 0;) {
        if (frames_[i].return_address != block.start) continue;
        node_ = frames_[i].node;
        frames_.resize(i);
        return;
    }
    // A tail call.
    if (block.symbol != node_->symbol && node_->parent != nullptr) {
        node_ = &node_->parent->child(block.symbol);
        ++node_->calls;
    }
}

void Counter::push(std::uint32_t address, std::uint32_t below) {
    if (!active_) return;
    if (address - below < stack_low_) stack_low_ = address - below;
    if (address + 4 > stack_high_) stack_high_ = address + 4;
}

}  // namespace cycles

// Angular momentum stands still in the world while the axes of its body turn.
#pragma once

#include <tumble/numbers/vector_block.hpp>

namespace tumble {

// Turns an angular momentum, or a change of one, from the axes of a body at `from` into those at `to`. It is in half
// turns of the scale `unit`. Only the change is rounded: to 2^-28 of the largest component in fixed point, as the
// speeds of an impact.
template <class N>
[[gnu::noinline]] void turn_momentum(typename N::TurnSum (&t)[3], typename N::Scale unit,
                                     const Quat<typename N::Unit>& from, const Quat<typename N::Unit>& to) {
    using Block = VectorBlock<N>;
    const Block before = Block::of_turns(t, unit);
    if (before.is_zero()) return;
    const Block after = before.rotated(from).rotated_back(to);
    const auto one = typename N::Work(1);
    for (int i = 0; i < 3; ++i) t[i] += after.turn(i, one, unit) - before.turn(i, one, unit);
}

}  // namespace tumble

# What WebAssembly does with a fault: it traps, and the status of a trap is 128. It has no counter of instructions, and its
# stack is not measured.
set(bad_address 0x9F000000)  # beyond the memory
set(unit ns)
set(not_here instruction_counts_are_exact stack_peak_is_the_deepest_point_since_init)
set(outcome_of_bad_read STATUS 128 OUTPUT "^fault: memory access out of bounds\n")
set(outcome_of_bad_write STATUS 128 OUTPUT "^fault: memory access out of bounds\n")
set(outcome_of_bad_jump STATUS 128 OUTPUT "^fault: table index is out of bounds\n")
set(outcome_of_stack_overflow STATUS 128 OUTPUT "^fault: .*, stack overflow\n")
set(outcome_of_undefined_instruction STATUS 128 OUTPUT "^fault: unreachable\n")
set(outcome_of_divide_by_zero STATUS 128 OUTPUT "^fault: divide by zero\n")

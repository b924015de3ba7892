# What a RISC-V hart does with a fault. It divides by zero without one.
set(unit insn)
set(not_here "")
set(bad_address 0x9F000000)  # of RAM that no board has
set(outcome_of_bad_read STATUS 133 OUTPUT "fault: load access fault at pc 0x8[0-9a-f]+, mtval 0x9f000000\n")
set(outcome_of_bad_write STATUS 135 OUTPUT "fault: store access fault at pc 0x8[0-9a-f]+, mtval 0x9f000000\n")
set(outcome_of_bad_jump STATUS 129 OUTPUT "fault: instruction access fault at pc 0x9f000000")
set(outcome_of_stack_overflow STATUS 135 OUTPUT "fault: store access fault, stack overflow")
set(outcome_of_undefined_instruction STATUS 130 OUTPUT "fault: illegal instruction")
set(outcome_of_divide_by_zero STATUS 0 OUTPUT "^$")

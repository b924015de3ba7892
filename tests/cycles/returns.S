// A function that calls others, which return by a condition, by POP, and by a tail call. Armv6-M has no IT; this is for the
// M3 and the M4.
    .syntax unified
    .thumb
    .word 0x20001000
    .word reset + 1

    .balign 4
    .type early, %function
early:
    cmp r0, #0
    it eq
    bxeq lr
    movs r0, #0
    bx lr

    .balign 4
    .type popped, %function
popped:
    push {r4, lr}
    cmp r0, #0
    it eq
    popeq {r4, pc}
    pop {r4, pc}

    .balign 4
    .type tail, %function
tail:
    cmp r0, #0
    beq early
    bx lr

    .balign 4
    .type after, %function
after:
    nop
    bx lr

    .balign 4
    .type step_run, %function
step_run:
    push {r4, lr}
    movs r0, #0
    bl early
    bl after
    movs r0, #0
    bl popped
    bl after
    movs r0, #0
    bl tail
    bl after
    pop {r4, pc}

    .balign 4
    .global reset
    .type reset, %function
reset:
    bl step_run
    bl step_run

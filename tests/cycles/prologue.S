// What stands before the sequences: vectors, the functions that they call, and what each finds in the registers.
    .syntax unified
    .thumb

    .equ buffer, 0x20000100
    .equ top_of_stack, 0x20001000

    .word top_of_stack
    .word reset + 1

    .balign 4
    .type leaf, %function
leaf:
    bx lr

    .balign 4
    .type pair, %function
pair:
    push {r4, lr}
    pop {r4, pc}

    .macro sequence
    ldr r4, =buffer
    str r4, [r4]
    ldr r5, =buffer + 16
    movs r6, #0
    ldr r7, =leaf + 1
    movs r0, #3
    movs r1, #5
    movs r2, #7
    movs r3, #11
    b 99f
    .ltorg
    .balign 4
99: .inst.n 0xbfe0
    .endm

    .macro end_of_sequence
    .inst.n 0xbff0
    b 99f
    .ltorg
    .balign 4
99:
    .endm

    .balign 4
    .global reset
    .type reset, %function
reset:
#ifdef __ARM_FP
    ldr r0, =0xe000ed88  // CPACR: full access to the FPU
    ldr r1, =0x00f00000
    str r1, [r0]
    dsb
    isb
#endif

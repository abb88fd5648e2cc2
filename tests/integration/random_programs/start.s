; The H8S's side of a random program: start, output, end, and the 32-bit product the compiler calls.
; SPDX-License-Identifier: Apache-2.0
  .h8300s
  .section .text
  .global _start
_start:
  mov.l #0xf00000,er7
  jsr @_main
; SLEEP with these in ER1, ER2 and R0L ends the program; R0H is the status.
  mov.w #0,r0
  mov.w #0xdead,r1
  mov.w #0xbeef,r2
  sleep

; void kaz_put(const char *text, unsigned length): ER0 descriptor, ER1 address, ER2 length.
  .global _kaz_put
_kaz_put:
  mov.l er1,er2
  mov.l er0,er1
  mov.l #1,er0
  jsr @@0xc7:8
  rts

  .global ___main
___main:
  rts

; ER0 := ER0 * ER1 from three products of halves.
  .global ___mulsi3
___mulsi3:
  mov.w e0,r3
  mulxu.w r1,er3
  mov.w r0,r2
  mulxu.w e1,er2
  mulxu.w r1,er0
  add.w r2,r3
  add.w r3,e0
  rts

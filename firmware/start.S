; Start of the application, and the call of the tick.
; SPDX-License-Identifier: Apache-2.0
	.h8300s
	.section .text

; R0 is the CRC that the loader found.
	.global _kz_start
_kz_start:
	mov.l	#_kz_stack_top,er7
	mov.w	r0,r4

; The free-running counter measures the start, in units of 8 states.
	mov.b	#0x1f,r3l
	mov.b	r3l,@0xffff86:8		; MSTPCRH: out of module stop
	mov.b	#0x01,r3l
	mov.b	r3l,@0xffff96:8		; TCR: phi/8

; Each word of RAM takes its own address, which finds damaged address lines too, then the complement
; of that. R5 collects the bits that were wrong. At the end RAM is full of A5, so that the depth of
; the stack can be seen later. The short RAM (restart.h) is not touched.
	mov.l	#_kz_stack_top,er1
	mov.l	#_kz_ram_start,er0
	sub.w	r5,r5
	mov.w	#0xa5a5,r3
write:
	mov.w	r0,@er0
	inc.l	#2,er0
	cmp.l	er1,er0
	blo	write
	mov.l	#_kz_ram_start,er0
	.global ram_written		; for a test that damages RAM
ram_written:
upwards:
	mov.w	@er0,r2
	xor.w	r0,r2
	or.w	r2,r5
	mov.w	r0,r2
	not.w	r2
	mov.w	r2,@er0
	inc.l	#2,er0
	cmp.l	er1,er0
	blo	upwards
	mov.l	#_kz_ram_start,er1
downwards:
	dec.l	#2,er0
	mov.w	@er0,r2
	xor.w	r0,r2
	not.w	r2
	or.w	r2,r5
	mov.w	r3,@er0
	cmp.l	er1,er0
	bhi	downwards

	mov.l	#_kz_data_load,er0
	mov.l	#_kz_data_start,er1
	mov.l	#_kz_data_end,er2
copy:
	cmp.l	er2,er1
	bhs	copied
	mov.b	@er0+,r3l
	mov.b	r3l,@er1
	inc.l	#1,er1
	bra	copy
copied:

	mov.l	#_kz_bss_start,er1
	mov.l	#_kz_bss_end,er2
	sub.b	r3l,r3l
clear:
	cmp.l	er2,er1
	bhs	cleared
	mov.b	r3l,@er1
	inc.l	#1,er1
	bra	clear
cleared:

	mov.w	r4,r0
	mov.w	r5,r1
	jsr	@_kz_main		; does not return

; Two labels around the tick's computation, for whoever watches it from outside: at kz_tick_begin
; the snapshot kz_input is complete and kz_servo_state as the last tick left it, at kz_tick_end
; kz_output and kz_servo_state are new.
	.global _kz_tick_begin
	.global _kz_tick_end
_kz_tick_begin:
	mov.l	#_kz_servo_state,er0
	mov.l	#_kz_input,er1
	mov.l	#_kz_output,er2
	jsr	@_kz_tick
_kz_tick_end:
	rts

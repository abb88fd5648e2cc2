; Start of the application, and the call of the tick.
; SPDX-License-Identifier: Apache-2.0
	.h8300s
	.section .text

; R0 is the CRC that the loader found.
	.global _kz_start
_kz_start:
	mov.l	#_kz_stack_top,er7
	mov.w	r0,r4

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

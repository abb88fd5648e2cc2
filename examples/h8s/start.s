; Vectors and start of a program for the H8S/2128 in advanced mode: stack, initialised data, cleared RAM, main.
; SPDX-License-Identifier: Apache-2.0
	.h8300s
	.section .vect,"r"
	.long	_start
	.rept	51			; 1..51
	.long	_unexpected
	.endr
	.long	_tick			; 52: OCIA, compare match A of the free-running timer
	.rept	51			; 53..103
	.long	_unexpected
	.endr

	.text
	.global	_start
_start:
	mov.l	#_stack_top,er7
	mov.l	#_data_load,er0		; initialised data from flash
	mov.l	#_data_begin,er1
1:	cmp.l	#_data_end,er1
	bhs	2f
	mov.w	@er0+,r2
	mov.w	r2,@er1
	adds	#2,er1
	bra	1b
2:	mov.l	#_bss_begin,er1		; the rest of the variables is zero
	sub.w	r2,r2
3:	cmp.l	#_bss_end,er1
	bhs	4f
	mov.w	r2,@er1
	adds	#2,er1
	bra	3b
4:	jsr	@_main
	.global	_done
_done:	sleep
	bra	_done
_unexpected:
	bra	_unexpected

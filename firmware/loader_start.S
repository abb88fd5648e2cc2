; Reset: the loader starts the application if it is whole, else sleeps with all motors off.
; SPDX-License-Identifier: Apache-2.0
;
; After reset every pin is an input, and the driver-enable's pull-down keeps the motors off: the
; loader touches none. Interrupts stay masked. The application gets its CRC in R0.
	.h8300s
	.section .text
	.global _kz_loader_start
_kz_loader_start:
	mov.l	#_kz_stack_top,er7
	jsr	@_kz_loader_check
	cmp.l	#0xffffffff,er0
	beq	asleep
	jmp	@_kz_jump_table
asleep:
	sleep
	bra	asleep

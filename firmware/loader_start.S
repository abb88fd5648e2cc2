; Reset: the loader starts the application if it is whole and nobody wants to replace it.
; SPDX-License-Identifier: Apache-2.0
;
; After reset every pin is an input, and the driver-enable's pull-down keeps the motors off: neither the
; loader nor the flash writer touches more than the host line. Interrupts stay masked. The application
; gets its CRC in R0. Else the flash writer goes to RAM and waits for a host: for as many seconds as were
; requested, forever where there is no whole application.
	.h8300s
	.section .text
	.global _kz_loader_start
_kz_loader_start:
	mov.l	#_kz_stack_top,er7
	jsr	@_kz_loader_check
	mov.w	e0,e0
	bne	to_writer
	jmp	@_kz_jump_table
to_writer:
	mov.w	r0,r1			; seconds
	mov.l	#_kz_loader_writer,er4
	mov.l	#_kz_loader_writer_end,er5
	mov.l	#_kz_ram_start,er6
copy:
	mov.w	@er4+,r0
	mov.w	r0,@er6
	adds	#2,er6
	cmp.l	er5,er4
	blo	copy
	mov.w	#_kz_loader_board_id,r2
	jmp	@_kz_ram_start+4	; writer_start.S

; Where the flash writer begins, and where it leaves.
; SPDX-License-Identifier: Apache-2.0
;
; Boot mode jumps to the first address, the loader to the one behind the length, with how many seconds to
; wait in R1 and the board's id in R2. Interrupts are masked in both.
	.h8300s
	.section .first,"x"
	.global _kz_writer_start
_kz_writer_start:
	bra	boot
	.word	_kz_writer_boot_size	; what boot mode has to load
	mov.w	#1,r0
	bra	begin
boot:
	sub.w	r0,r0
	sub.w	r1,r1
	mov.w	#0xffff,r2
begin:
	mov.l	#_kz_writer_stack,er7
	orc	#0x80,ccr
	jmp	@_kz_writer_main

; Through the reset vector.
	.section .text
	.global _kz_writer_leave
_kz_writer_leave:
	sub.l	er0,er0
	mov.l	@er0,er0
	jmp	@er0

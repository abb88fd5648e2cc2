; The chip's vectors in block EB0, which is never rewritten in the field, and the jump table.
; SPDX-License-Identifier: Apache-2.0
;
; Vector numbers: hardware manual, section 5 (exceptions and interrupts); the part ends at 103.
	.h8300s
	.section .vect,"r"
	.long	_kz_loader_start
vector	=	1
	.rept	103
	.long	_kz_jump_table + 4 * vector
vector	=	vector + 1
	.endr

; One 4-byte JMP for each vector; entry 0 is the application's start.
	.section .jumps,"x"
	.global _kz_jump_table
_kz_jump_table:
	jmp	@_kz_start
	.rept	27			; 1..27
	jmp	@_kz_unexpected
	.endr
	jmp	@_kz_analog_interrupt	; 28 ADI
	.rept	23			; 29..51
	jmp	@_kz_unexpected
	.endr
	jmp	@_kz_clock_interrupt	; 52 OCIA
	.rept	27			; 53..79
	jmp	@_kz_unexpected
	.endr
	jmp	@_kz_serial_receive_error	; 80 ERI0
	jmp	@_kz_serial_received	; 81 RXI0
	jmp	@_kz_serial_transmit	; 82 TXI0
	jmp	@_kz_serial_transmitted	; 83 TEI0
	.rept	20			; 84..103
	jmp	@_kz_unexpected
	.endr

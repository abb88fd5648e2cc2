; The host line's bytes, one interrupt each: up to 24 in a tick, so in assembler.
; SPDX-License-Identifier: Apache-2.0
;
; Variables and rings are those of serial.c. BCLR reads the status with its flag as 1 and writes it
; back as 0: the chip wants both.
#include "firmware/serial_rings.h"

	.h8300s
	.section .text
#define SCI0_SCR 0xffffda
#define SCI0_TDR 0xffffdb
#define SCI0_SSR 0xffffdc
#define SCI0_RDR 0xffffdd
#define SSR_TDRE_BIT 7
#define SSR_RDRF_BIT 6

	.global _kz_serial_received
_kz_serial_received:
	stm.l	er0-er1,@-sp
	mov.b	@SCI0_RDR:8,r0l
	sub.l	er1,er1
	mov.b	@_kz_received_in:16,r1l
	mov.b	r1l,r0h
	inc.b	r0h
	mov.b	r0h,@_kz_received_in:16
	and.b	#KZ_RING-1,r1l
	mov.b	r0l,@(_kz_received_byte:32,er1)
	bclr	#SSR_RDRF_BIT,@SCI0_SSR:8
	ldm.l	@sp+,er0-er1
	rte

; There is always a byte: after the last one the interrupt is switched off.
	.global _kz_serial_transmit
_kz_serial_transmit:
	stm.l	er0-er1,@-sp
	sub.l	er1,er1
	mov.b	@_kz_queued_out:16,r1l
	mov.b	@(_kz_queued_byte:32,er1),r0l
	mov.b	r0l,@SCI0_TDR:8
	bclr	#SSR_TDRE_BIT,@SCI0_SSR:8
	inc.b	r1l
	and.b	#KZ_RING-1,r1l
	mov.b	r1l,@_kz_queued_out:16
	mov.b	@_kz_queued_in:16,r0l
	cmp.b	r0l,r1l
	beq	emptied
	ldm.l	@sp+,er0-er1
	rte
emptied:
	mov.b	@_kz_scr_last_byte:16,r0l
	mov.b	r0l,@SCI0_SCR:8
	ldm.l	@sp+,er0-er1
	rte

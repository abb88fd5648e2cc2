; The A/D converter has scanned AN0, AN1, AN2: seven times in each tick, so in assembler. The first of
; them has AN3 besides, which stays in its data register.
; SPDX-License-Identifier: Apache-2.0
;
; Takes the three codes, and goes on with the next input of the multiplexers: after one of the
; supplies' (6 or 7) with input 0, after 5 the scan is done: then the converter goes round AN4 and AN5
; without interrupts, until the next tick looks (analog.c).
	.h8300s
	.section .text
#define ADDRA 0xffffe0
#define ADDRB 0xffffe2
#define ADDRC 0xffffe4
#define ADCSR 0xffffe8
#define P4DR 0xffffb7
#define STOPPED 0x5f		/* neither ADF nor ADST */
#define INERTIAL_STOPPED 0x15	/* SCAN, AN4 to AN5 */
#define INERTIAL_RUNNING 0x35	/* and ADST */
#define SCAN_STOPPED 0x52	/* ADIE, SCAN, AN0 to AN2 (analog.c) */
#define SCAN_RUNNING 0x72	/* and ADST */
#define LAST_POT_INPUT 5

	.global _kz_analog_interrupt
_kz_analog_interrupt:
	stm.l	er0-er1,@-sp
	mov.b	@ADCSR:8,r0l		; reads ADF as 1, so that the next write clears it
	and.b	#STOPPED,r0l		; channels change only while it stands
	mov.b	r0l,@ADCSR:8
	sub.l	er1,er1
	mov.b	@_kz_pins_selects,r1l
	shll.w	r1
	add.l	#_kz_analog_code,er1
	mov.w	@ADDRA:16,r0
	shlr.w	#2,r0
	shlr.w	#2,r0
	shlr.w	#2,r0
	mov.w	r0,@er1
	mov.w	@ADDRB:16,r0
	shlr.w	#2,r0
	shlr.w	#2,r0
	shlr.w	#2,r0
	mov.w	r0,@(16:16,er1)
	mov.w	@ADDRC:16,r0
	shlr.w	#2,r0
	shlr.w	#2,r0
	shlr.w	#2,r0
	mov.w	r0,@(32:16,er1)
	mov.b	@_kz_pins_selects,r0l
	cmp.b	#LAST_POT_INPUT,r0l
	beq	last
	bhi	first
	inc.b	r0l
go_on:
	mov.b	r0l,@_kz_pins_selects
	mov.b	@_kz_pins_p4,r0h
	or.b	r0h,r0l
	mov.b	r0l,@P4DR:8
	mov.b	#SCAN_RUNNING,r0l
	mov.b	r0l,@ADCSR:8
	ldm.l	@sp+,er0-er1
	rte
first:
	mov.b	#SCAN_STOPPED,r0l
	mov.b	r0l,@ADCSR:8
	sub.b	r0l,r0l
	bra	go_on
last:
	mov.b	#INERTIAL_STOPPED,r0l
	mov.b	r0l,@ADCSR:8
	mov.b	#INERTIAL_RUNNING,r0l
	mov.b	r0l,@ADCSR:8
	sub.b	r0l,r0l
	mov.b	r0l,@_kz_analog_scanning
	ldm.l	@sp+,er0-er1
	rte

; The joints' loop of shared/servo/joint_loop.c, in assembler: more than a third of each tick. Equal to
; the C in every bit; the comparison of the engines (kaz mcu compare) shows it.
; SPDX-License-Identifier: Apache-2.0
;
; ER6 joint, ER5 A/D codes, R4L joints left, R4H those left at the first fault. From the measurement on
; R0 is the angle, R1 the rate, R3 the command, then ER3 the drive.
#include "firmware/joint_loop.h"

	.h8300s
	.section .text

; The ramp's next command in R3, for joints that are constrained and for those that are not. R2 is what was
; left of it.
	.macro	ramp	kind
	dec.w	#1,r2
	mov.w	r2,@(JOINT_RAMP_LEFT:16,er6)
	mov.w	@(JOINT_RAMP_WHOLE:16,er6),r2
	add.w	r2,r3
	mov.l	@(JOINT_RAMP_REST:16,er6),er2	; and the room
	sub.w	e2,r2
	bls	\kind\()_one_more
	mov.w	r2,@(JOINT_RAMP_ROOM:16,er6)
	mov.w	@(JOINT_RAMP_EXTRA:16,er6),r2
	bmi	\kind\()_downwards
\kind\()_upwards:
	mov.w	@(JOINT_UPPER:16,er6),r2
	cmp.w	r2,r3
	bgt	\kind\()_meets_upper
\kind\()_ramped:
	mov.w	r3,@(JOINT_COMMAND:16,er6)
	.endm

; What is less frequent of that. A ramp ends at a limit, or where it is if that is outside.
	.macro	ramp_rest	kind
\kind\()_one_more:
	mov.w	@(JOINT_RAMP_TIME:16,er6),e2
	add.w	e2,r2
	mov.w	r2,@(JOINT_RAMP_ROOM:16,er6)
	mov.w	@(JOINT_RAMP_EXTRA:16,er6),r2
	add.w	r2,r3
	mov.w	r2,r2
	bpl	\kind\()_upwards
\kind\()_downwards:
	mov.w	@(JOINT_LOWER:16,er6),r2
	cmp.w	r2,r3
	bge	\kind\()_ramped
	mov.w	@(JOINT_COMMAND:16,er6),r3
	cmp.w	r2,r3
	blt	\kind\()_ends
	bra	\kind\()_cut
\kind\()_meets_upper:
	mov.w	@(JOINT_COMMAND:16,er6),r3
	cmp.w	r2,r3
	bgt	\kind\()_ends
\kind\()_cut:
	mov.w	r2,r3
\kind\()_ends:
	mov.w	r3,@(JOINT_TARGET:16,er6)
	sub.w	r2,r2
	mov.w	r2,@(JOINT_RAMP_LEFT:16,er6)
	bra	\kind\()_ramped:16
	.endm

	.global _kz_joint_loop
_kz_joint_loop:
	stm.l	er4-er6,@-sp
	mov.l	er0,er6
	mov.l	er1,er5
	mov.w	#LOOP_JOINTS,r4
	bra	next
; What is rare, within reach of the short branches: each saves a state in every round.
to_bad:
	bra	bad:16
to_unmeasured:
	bra	unmeasured:16
to_jumped_up:
	bra	jumped_up:16
to_jumped_down:
	bra	jumped_down:16
to_special:
	bra	special:16
next:
	sub.l	er0,er0
	mov.b	@(JOINT_POT_INPUT:16,er6),r0l
	shll.w	r0
	add.l	er5,er0
	mov.w	@er0,r0
	mov.w	r0,r1
	sub.w	#LOOP_POT_LOWEST,r1
	cmp.w	#LOOP_POT_HIGHEST-LOOP_POT_LOWEST,r1
	bhi	to_bad

; angle = centre + (code - 512) * 64 * scale / 2^15
	mov.l	@(JOINT_POT_CENTRE:16,er6),er1	; and the scale
	shll.w	#2,r0
	shll.w	#2,r0
	shll.w	#2,r0
	add.b	#0x80,r0h
	mulxs.w	r1,er0
	shll.l	er0
	mov.w	e0,r0
	add.w	e1,r0

; rate += delta * 8 - rate / 8
	mov.l	@(JOINT_ANGLE:16,er6),er1	; and the rate
	mov.w	r0,r2
	sub.w	e1,r2
	mov.b	@(JOINT_POT_BAD_MS:16,er6),r3l
	bne	to_unmeasured
	cmp.w	#LOOP_DELTA_MAX,r2
	bgt	to_jumped_up
	cmp.w	#-LOOP_DELTA_MAX,r2
	blt	to_jumped_down
measured:
	mov.w	r1,r3
	shar.w	#2,r3
	shar.w	r3
	sub.w	r3,r1
	shll.w	#2,r2
	shll.w	r2
	add.w	r2,r1
	mov.w	r1,@(JOINT_RATE:16,er6)
	mov.w	r0,@(JOINT_ANGLE:16,er6)
	mov.w	@(JOINT_CONSTRAINED:16,er6),r2	; and whether it is on
	cmp.w	#1,r2
	bne	to_special
	mov.w	@(JOINT_COMMAND:16,er6),r3
	mov.w	@(JOINT_RAMP_LEFT:16,er6),r2
	beq	at_rest
	ramp	plain
at_rest:

; drive = kp * error / 2 - kd * rate
	exts.l	er3
	mov.w	r0,r2
	exts.l	er2
	sub.l	er2,er3
	shar.l	er3
	mov.l	@(JOINT_KP:16,er6),er2	; and kd
	mulxs.w	e2,er3
	mulxs.w	r1,er2
	sub.l	er2,er3

; Duty and direction of the drive, whose sign is in the flags. The duty is the drive in its upper half
; once that has 65536 to a count, rounded by the bit below.
put:
	ble	backward
	mov.b	@(JOINT_MIRRORED:16,er6),r0l
	xor.b	#1,r0l
strength:
	cmp.l	#(LOOP_DUTY_MAX<<LOOP_DRIVE_SHIFT)-(1<<(LOOP_DRIVE_SHIFT-1)),er3
	bhs	full
	shll.l	#2,er3
	shll.l	#2,er3
	shll.l	er3
	shll.w	r3
	mov.w	e3,r3
	addx.b	#0,r3l
	mov.b	r3l,r0h
	mov.w	r0,@(JOINT_DUTY:16,er6)
	add.l	#JOINT_SIZE,er6
	dec.b	r4l
	bne	next:16
	bra	done:16

	ramp_rest	plain

backward:
	mov.b	@(JOINT_MIRRORED:16,er6),r0l
	neg.l	er3
	bra	strength
full:
	mov.b	#LOOP_DUTY_MAX,r0h
store:
	mov.w	r0,@(JOINT_DUTY:16,er6)
end:
	add.l	#JOINT_SIZE,er6
	dec.b	r4l
	bne	next:16
	bra	done:16

	ramp_rest	constrained
off:
	sub.w	r0,r0
	bra	store

; Off, or the same with dead band, friction and soft limits. The upper byte of E1 keeps the reason.
special:
	mov.b	r2l,r2l
	beq	off
	mov.w	r2,e1
	mov.w	@(JOINT_COMMAND:16,er6),r3
	mov.w	@(JOINT_RAMP_LEFT:16,er6),r2
	beq	constrained
	ramp	constrained
constrained:
	exts.l	er3
	mov.w	r0,r2
	exts.l	er2
	sub.l	er2,er3
	mov.w	@(JOINT_DEAD_BAND:16,er6),r2
	beq	not_banded
	extu.l	er2
	cmp.l	er2,er3
	bgt	not_banded
	neg.l	er2
	cmp.l	er2,er3
	blt	not_banded
	sub.l	er3,er3
not_banded:
	mov.w	@(JOINT_FRICTION_DRIVE:16,er6),r2
	bne	rubbing
smooth:
	shar.l	er3
	mov.l	@(JOINT_KP:16,er6),er2	; and kd
	mulxs.w	e2,er3
	mulxs.w	r1,er2
	sub.l	er2,er3
	bra	driven

; Friction with the sign of the error. E0 keeps it.
	.macro	rub	operation
	shar.l	er3
	mov.l	@(JOINT_KP:16,er6),er2	; and kd
	mulxs.w	e2,er3
	mulxs.w	r1,er2
	sub.l	er2,er3
	mov.w	e0,r2
	extu.l	er2
	.rept	LOOP_DRIVE_SHIFT-8
	shll.l	er2
	.endr
	\operation	er2,er3
	.endm
rubbing:
	mov.w	r2,e0
	mov.l	er3,er3
	beq	smooth
	bmi	rub_backward
	rub	add.l
	bra	driven
rub_backward:
	rub	sub.l
driven:
	mov.w	e1,r2
	btst	#LOOP_AT_LIMITS_BIT,r2h
	beq	check
	mov.w	@(JOINT_UPPER:16,er6),r2
	cmp.w	r2,r0
	bge	beyond_upper
below_upper:
	mov.w	@(JOINT_LOWER:16,er6),r2
	cmp.w	r2,r0
	ble	beyond_lower
inside:
	cmp.w	#LOOP_SLOW,r1
	bgt	rising
	cmp.w	#-LOOP_SLOW,r1
	blt	falling
; Sets the flags for `put`.
check:
	mov.l	er3,er3
	bra	put:16

beyond_upper:
	mov.l	er3,er3
	ble	below_upper
	sub.l	er3,er3
	bra	below_upper
beyond_lower:
	mov.l	er3,er3
	bge	inside
	sub.l	er3,er3
	bra	inside

; Fast towards the upper limit: the remaining distance allows so much.
rising:
	mov.w	@(JOINT_UPPER:16,er6),r2
	cmp.w	r0,r2
	ble	brake_down
	sub.w	r0,r2
	cmp.w	#LOOP_NEAR_LIMIT,r2
	blo	near_upper
	add.w	#LOOP_NEAR_LIMIT,r2
	bra	upper_allows
near_upper:
	shll.w	r2
upper_allows:
	cmp.w	r2,r1
	bls	check
	sub.w	r2,r1
brake_down:
	mov.w	#LOOP_BRAKE,r2
	mulxu.w	r1,er2
	neg.l	er2
	cmp.l	er2,er3
	ble	check
	mov.l	er2,er3
	bra	check

falling:
	neg.w	r1
	mov.w	@(JOINT_LOWER:16,er6),r2
	cmp.w	r2,r0
	ble	brake_up
	sub.w	r2,r0
	cmp.w	#LOOP_NEAR_LIMIT,r0
	blo	near_lower
	add.w	#LOOP_NEAR_LIMIT,r0
	bra	lower_allows
near_lower:
	shll.w	r0
lower_allows:
	cmp.w	r0,r1
	bls	check
	sub.w	r0,r1
brake_up:
	mov.w	#LOOP_BRAKE,r2
	mulxu.w	r1,er2
	cmp.l	er2,er3
	bge	check
	mov.l	er2,er3
	bra	check

unmeasured:
	sub.b	r3l,r3l
	mov.b	r3l,@(JOINT_POT_BAD_MS:16,er6)
	sub.w	r2,r2
	bra	measured:16
jumped_up:
	mov.w	#LOOP_DELTA_MAX,r2
	bra	measured:16
jumped_down:
	mov.w	#-LOOP_DELTA_MAX,r2
	bra	measured:16

; Nobody knows where the joint is.
bad:
	sub.w	r0,r0
	mov.w	r0,@(JOINT_RATE:16,er6)
	mov.w	r0,@(JOINT_DUTY:16,er6)
	mov.b	@(JOINT_POT_BAD_MS:16,er6),r1l
	cmp.b	#LOOP_POT_FAULT_MS,r1l
	bhs	counted
	inc.b	r1l
	mov.b	r1l,@(JOINT_POT_BAD_MS:16,er6)
counted:
	cmp.b	#LOOP_POT_FAULT_MS,r1l
	bne	end:16
	mov.b	@(JOINT_ON:16,er6),r1l
	beq	end:16
	mov.b	r4h,r4h
	bne	end:16
	mov.b	r4l,r4h
	bra	end:16

done:
	sub.w	r0,r0
	mov.b	r4h,r4h
	beq	sound
	mov.w	#LOOP_SHUTDOWN_POT*256+LOOP_JOINTS,r0
	sub.b	r4h,r0l
sound:
	ldm.l	@sp+,er4-er6
	rts

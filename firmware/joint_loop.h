// Constants of the joint loop in assembler (joint_loop.S): offsets in kz_joint, and parameters.
// joint_loop_check.c compares them with the C code at compile time.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_JOINT_LOOP_H
#define KAZ_FIRMWARE_JOINT_LOOP_H

#define JOINT_POT_CENTRE 4
#define JOINT_POT_SCALE 6
#define JOINT_ANGLE 8
#define JOINT_RATE 10
#define JOINT_TARGET 12
#define JOINT_COMMAND 14
#define JOINT_RAMP_LEFT 16
#define JOINT_RAMP_TIME 18
#define JOINT_RAMP_WHOLE 20
#define JOINT_RAMP_EXTRA 22
#define JOINT_RAMP_REST 24
#define JOINT_RAMP_ROOM 26
#define JOINT_LOWER 30
#define JOINT_UPPER 32
#define JOINT_DEAD_BAND 34
#define JOINT_KP 38
#define JOINT_KD 40
#define JOINT_FRICTION_DRIVE 44
#define JOINT_DUTY 46  // accessed as a word together with JOINT_FORWARD
#define JOINT_FORWARD 47
#define JOINT_POT_BAD_MS 48
#define JOINT_POT_INPUT 49
#define JOINT_MIRRORED 50
#define JOINT_CONSTRAINED 54
#define JOINT_ON 55
#define JOINT_SIZE 56

#define LOOP_JOINTS 18
#define LOOP_POT_LOWEST 4
#define LOOP_POT_HIGHEST 1019
#define LOOP_POT_FAULT_MS 20
#define LOOP_SHUTDOWN_POT 3
#define LOOP_DELTA_MAX 511
#define LOOP_DUTY_MAX 255
#define LOOP_DRIVE_SHIFT 11
#define LOOP_NEAR_LIMIT 1000
#define LOOP_SLOW 320
#define LOOP_BRAKE 204
#define LOOP_AT_LIMITS_BIT 0

#endif

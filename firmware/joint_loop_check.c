// Compile-time check of the constants of joint_loop.S against the C: adds nothing to the image.
// SPDX-License-Identifier: Apache-2.0
#include <stddef.h>

#include "firmware/joint_loop.h"
#include "shared/servo/joint_loop.h"

#define SAME(name, a, b) typedef char kz_same_##name[(a) == (b) ? 1 : -1];
#define AT(name, member) SAME(name, JOINT_##name, offsetof(kz_joint, member))

AT(POT_CENTRE, pot_centre)
AT(POT_SCALE, pot_scale)
AT(ANGLE, angle)
AT(RATE, rate)
AT(TARGET, target)
AT(COMMAND, command)
AT(RAMP_LEFT, ramp_left)
AT(RAMP_TIME, ramp_time)
AT(RAMP_WHOLE, ramp_whole)
AT(RAMP_EXTRA, ramp_extra)
AT(RAMP_REST, ramp_rest)
AT(RAMP_ROOM, ramp_room)
AT(LOWER, lower)
AT(UPPER, upper)
AT(DEAD_BAND, dead_band)
AT(KP, kp)
AT(KD, kd)
AT(DUTY, duty)
AT(FORWARD, forward)
AT(POT_BAD_MS, pot_bad_ms)
AT(POT_INPUT, pot_input)
AT(MIRRORED, mirrored)
AT(FRICTION_DRIVE, friction_drive)
AT(CONSTRAINED, constrained)
AT(ON, on)
SAME(SIZE, JOINT_SIZE, sizeof(kz_joint))
SAME(WORD, JOINT_DUTY % 2, 0)
SAME(JOINTS, LOOP_JOINTS, KZ_JOINTS)
SAME(POT_LOWEST, LOOP_POT_LOWEST, KZ_POT_LOWEST)
SAME(POT_HIGHEST, LOOP_POT_HIGHEST, KZ_POT_HIGHEST)
SAME(POT_FAULT_MS, LOOP_POT_FAULT_MS, KZ_POT_FAULT_MS)
SAME(SHUTDOWN_POT, LOOP_SHUTDOWN_POT, KZ_SHUTDOWN_POT)
SAME(DELTA_MAX, LOOP_DELTA_MAX, KZ_DELTA_MAX)
SAME(DUTY_MAX, LOOP_DUTY_MAX, KZ_DUTY_MAX)
SAME(DRIVE_SHIFT, LOOP_DRIVE_SHIFT, KZ_DRIVE_SHIFT)
SAME(NEAR_LIMIT, LOOP_NEAR_LIMIT, KZ_NEAR_LIMIT)
SAME(SLOW, LOOP_SLOW, KZ_SLOW)
SAME(BRAKE, LOOP_BRAKE, KZ_BRAKE)
SAME(AT_LIMITS, 1 << LOOP_AT_LIMITS_BIT, KZ_CONSTRAINED_NEAR_LIMIT)
SAME(POT_CODES, KZ_POT_CODES, 1024)  // the shift by 6 and the 0x80

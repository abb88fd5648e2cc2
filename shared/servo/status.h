// Status word of the board and flags of a joint, as replies report them.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_STATUS_H
#define KAZ_SHARED_SERVO_STATUS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

u16 kz_status(const kz_servo* servo);
// KZ_JOINT_* flags. `fresh`: its ramp has not started yet.
u8 kz_joint_flags(const kz_joint* joint, u8 fresh);

#ifdef __cplusplus
}
#endif

#endif

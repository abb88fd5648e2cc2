// Status word of the board and flags of a joint, as in replies.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_STATUS_H
#define KAZ_SHARED_SERVO_STATUS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Returns the KZ_STATUS_* flags, with the latched KZ_SHUTDOWN_* reason in the upper byte.
u16 kz_status(const kz_servo* servo);
// Returns the KZ_JOINT_* flags. `fresh` is 1 if the joint's ramp has not started yet; such a joint counts as
// moving.
u8 kz_joint_flags(const kz_joint* joint, u8 fresh);

#ifdef __cplusplus
}
#endif

#endif

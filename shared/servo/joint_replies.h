// Writes replies that have one number per joint directly into the sender's buffer.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_JOINT_REPLIES_H
#define KAZ_SHARED_SERVO_JOINT_REPLIES_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Writes the fields `tick` and `status`. All replies except `identify_reply` begin with these two fields.
// Returns the end of the output.
u8* kz_put_head(const kz_servo* servo, u8* to);

// Write the fields of one reply, including tick and status, and return the end of the output. Each number is
// written directly into the reply. A structure that is first filled and then packed would need two loops over
// the joints.
u8* kz_put_state(const kz_servo* servo, u8* to);
u8* kz_put_read_targets(const kz_servo* servo, u32 mask, u8* to);
u8* kz_put_calibration(const kz_servo* servo, const kz_tick_input* input, u8* to);

// Write `joints_reply` in two ticks: first angles, speeds and drives, then load and flags.
// kz_put_joints_rest continues at the end of the first part.
u8* kz_put_joints(const kz_servo* servo, u32 mask, u8* to);
u8* kz_put_joints_rest(const kz_servo* servo, u32 mask, u8* to);

#ifdef __cplusplus
}
#endif

#endif

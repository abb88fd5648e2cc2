// Parts of replies that are written straight to the sender's bytes.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_JOINT_REPLIES_H
#define KAZ_SHARED_SERVO_JOINT_REPLIES_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Tick and status, with which every reply but that to `identify` begins. Returns the place behind.
u8* kz_put_head(const kz_servo* servo, u8* to);

// Those with a number for each joint, written straight to the sender's bytes (joint_replies.c).
// They are not packed from a structure: that would go over the joints twice. All return the place
// behind what they wrote.
u8* kz_put_state(const kz_servo* servo, u8* to);
u8* kz_put_read_targets(const kz_servo* servo, u32 mask, u8* to);
u8* kz_put_calibration(const kz_servo* servo, const kz_tick_input* input, u8* to);

// `joints_reply` is made in two ticks: first what was measured, then load and flags.
u8* kz_put_joints(const kz_servo* servo, u32 mask, u8* to);
u8* kz_put_joints_rest(const kz_servo* servo, u32 mask, u8* to);

#ifdef __cplusplus
}
#endif

#endif

// The fields of every reply.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_REPLIES_H
#define KAZ_SHARED_SERVO_REPLIES_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KZ_JOINTS_REPLY_MOST 9  // joints that a `joints_reply` has room for

// Writes the fields of the reply to a request that was done; returns how many bytes.
u8 kz_reply(const kz_servo* servo, const kz_tick_input* input, const kz_answer* answer, u8* fields);

// The rest of one that is made in two ticks: `bytes` of fields are there. Returns how many then.
u8 kz_reply_rest(const kz_servo* servo, const kz_answer* answer, u8* fields, u8 bytes);
u8 kz_reply_takes_two(u8 request_type);

// Whether making it is work enough for a tick that has not started 18 ramps besides.
u8 kz_reply_is_large(u8 request_type);

// What every reply but that to `identify` begins with: tick and status. Returns the place behind.
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

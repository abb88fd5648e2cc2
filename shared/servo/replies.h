// The fields of every reply.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_REPLIES_H
#define KAZ_SHARED_SERVO_REPLIES_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Writes the fields of the reply to a request that was done; returns how many bytes.
u8 kz_reply(const kz_servo* servo, const kz_tick_input* input, const kz_answer* answer, u8* fields);

// The rest of one that is made in two ticks: `bytes` of fields are there. Returns how many then.
u8 kz_reply_rest(const kz_servo* servo, const kz_answer* answer, u8* fields, u8 bytes);
u8 kz_reply_takes_two(u8 request_type);

// Whether making it is work enough for a tick that has not started 18 ramps besides.
u8 kz_reply_is_large(u8 request_type);

// Sends the fields that stand in the sender's body already, behind the place of the header.
void kz_send(kz_servo* servo, u8 type, u8 sequence, u8 field_bytes);

#ifdef __cplusplus
}
#endif

#endif

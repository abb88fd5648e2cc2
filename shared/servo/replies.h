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

// Second part of a SPLIT_REPLY, behind `bytes` bytes of fields. Returns how many bytes there are then.
u8 kz_reply_rest(const kz_servo* servo, const kz_answer* answer, u8* fields, u8 bytes);
u8 kz_reply_takes_two(u8 request_type);

// Whether writing it takes so long that a tick does not also start ramps or write another one.
u8 kz_reply_is_large(u8 request_type);

// Sends the fields that are already in the sender's body, behind its header.
void kz_send(kz_servo* servo, u8 type, u8 sequence, u8 field_bytes);

#ifdef __cplusplus
}
#endif

#endif

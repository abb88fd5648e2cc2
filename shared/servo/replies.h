// Writes the fields of every reply and sends them.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_REPLIES_H
#define KAZ_SHARED_SERVO_REPLIES_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Writes the fields of the reply to an executed request. If the reply is a SPLIT_REPLY, writes only the first
// part of the fields. Returns the size in bytes.
u8 kz_reply(const kz_servo* servo, const kz_tick_input* input, const kz_answer* answer, u8* fields);

// Appends the second part of a SPLIT_REPLY to `fields`. The first part has the size `bytes`. Returns the
// total size in bytes.
u8 kz_reply_rest(const kz_servo* servo, const kz_answer* answer, u8* fields, u8 bytes);
// Returns 1 if the request's reply is a SPLIT_REPLY, which takes two ticks to write.
u8 kz_reply_takes_two(u8 request_type);

// Returns 1 for a LARGE_REPLY or SPLIT_REPLY. Writing such a reply takes so long that the same tick must not
// start ramps or write a second large reply.
u8 kz_reply_is_large(u8 request_type);

// Adds the header to the fields that the caller wrote to sender.body + KZ_HEADER_SIZE, and starts sending.
// The sender must be idle.
void kz_send(kz_servo* servo, u8 type, u8 sequence, u8 field_bytes);

#ifdef __cplusplus
}
#endif

#endif

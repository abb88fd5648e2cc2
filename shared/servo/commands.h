// Dispatch of requests: from type and bytes to what a request does.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_COMMANDS_H
#define KAZ_SHARED_SERVO_COMMANDS_H

#include "shared/servo/handlers.h"
#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Does the request of this type whose fields are given. Either all of it is done or nothing.
// `parameter` becomes what its reply is about, where the reply depends on the request's fields.
kz_outcome kz_command(kz_servo* servo, u8 type, const u8* fields, u8 length, u32* parameter);

#ifdef __cplusplus
}
#endif

#endif

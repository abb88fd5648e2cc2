// Dispatches each request to the handler of its type.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_COMMANDS_H
#define KAZ_SHARED_SERVO_COMMANDS_H

#include "shared/servo/handlers.h"
#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Checks and executes a request of type `type` with `length` bytes of fields. A refused request changes
// nothing. If the reply depends on the fields, sets `*parameter` to the joint (or mask of joints) that the
// fields select.
kz_outcome kz_command(kz_servo* servo, u8 type, const u8* fields, u8 length, u32* parameter);

#ifdef __cplusplus
}
#endif

#endif

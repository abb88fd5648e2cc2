// The requests that change something.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_COMMANDS_H
#define KAZ_SHARED_SERVO_COMMANDS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KZ_NO_DETAIL 255

// 0 or a KZ_REFUSED_* reason, with what was wrong.
typedef struct kz_outcome {
  u8 reason;
  u8 detail;
} kz_outcome;

// Does the request of this type whose fields are given. Either all of it is done or nothing.
kz_outcome kz_command(kz_servo* servo, u8 type, const u8* fields, u8 length);

#ifdef __cplusplus
}
#endif

#endif

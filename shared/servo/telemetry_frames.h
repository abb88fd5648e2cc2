// Writes telemetry frames.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_TELEMETRY_FRAMES_H
#define KAZ_SHARED_SERVO_TELEMETRY_FRAMES_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Starts sending the next frame that is due. telemetry_due must not be 0, and the sender must be idle.
void kz_telemetry_send(kz_servo* servo, const kz_tick_input* input);

#ifdef __cplusplus
}
#endif

#endif

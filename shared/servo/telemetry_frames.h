// Frames of telemetry.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_TELEMETRY_FRAMES_H
#define KAZ_SHARED_SERVO_TELEMETRY_FRAMES_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Starts the next frame that is due (telemetry_due is not 0). The sender is idle.
void kz_telemetry_send(kz_servo* servo, const kz_tick_input* input);

#ifdef __cplusplus
}
#endif

#endif

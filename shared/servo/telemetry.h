// Telemetry: which frames are due, at the period that the host requested.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_TELEMETRY_H
#define KAZ_SHARED_SERVO_TELEMETRY_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// To be called each tick while telemetry_ms is not 0. When a period is over its frames become due;
// those of the period before that have not begun are dropped.
void kz_telemetry_update(kz_servo* servo);

void kz_telemetry_end(kz_servo* servo);

#ifdef __cplusplus
}
#endif

#endif

// Telemetry schedule: selects the frames that are due in each period. The host sets the period.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_TELEMETRY_H
#define KAZ_SHARED_SERVO_TELEMETRY_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Updates the schedule; call kz_telemetry_update in every tick while telemetry_ms is not 0. At the start of
// each period, all frames that the host selected become due. Frames of the previous period whose transmission
// has not begun are dropped and counted.
void kz_telemetry_update(kz_servo* servo);

// Ends telemetry. If the transmission of a due frame has not begun, the frame is dropped.
void kz_telemetry_end(kz_servo* servo);

#ifdef __cplusplus
}
#endif

#endif

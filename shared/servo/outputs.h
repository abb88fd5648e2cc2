// Converts joint state to pin outputs.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_OUTPUTS_H
#define KAZ_SHARED_SERVO_OUTPUTS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Writes duties, directions and the driver-enable bit: all zero while no joint is on and no raw drive runs.
void kz_outputs_write(const kz_servo* servo, kz_tick_output* output);

#ifdef __cplusplus
}
#endif

#endif

// From the state of the joints to the pins.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_OUTPUTS_H
#define KAZ_SHARED_SERVO_OUTPUTS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Duties, directions and the driver-enable bit. All of it is 0 while no joint is on.
void kz_outputs_write(const kz_servo* servo, kz_tick_output* output);

#ifdef __cplusplus
}
#endif

#endif

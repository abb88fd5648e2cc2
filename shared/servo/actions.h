// Actions between two ticks: writing flash, reset, start of the loader.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_ACTIONS_H
#define KAZ_SHARED_SERVO_ACTIONS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Takes the result of the action that the previous tick requested.
void kz_action_finish(kz_servo* servo, const kz_tick_input* input);

// Returns the pending action once all that has to be sent before it has left the transmitter; until then
// KZ_ACTION_NONE.
u8 kz_action_start(kz_servo* servo, const kz_tick_input* input);

#ifdef __cplusplus
}
#endif

#endif

// Actions between two ticks: write flash, reset, start the loader.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_ACTIONS_H
#define KAZ_SHARED_SERVO_ACTIONS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Completes the action that the previous tick requested, and clears the action. The request that started the
// action gets the outcome input->result.
void kz_action_finish(kz_servo* servo, const kz_tick_input* input);

// Returns the pending action (KZ_ACTION_*) once all earlier replies have been sent and the transmit buffer is
// empty. Returns KZ_ACTION_NONE until then.
u8 kz_action_start(kz_servo* servo, const kz_tick_input* input);

#ifdef __cplusplus
}
#endif

#endif

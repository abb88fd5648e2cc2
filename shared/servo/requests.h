// What the board does when a frame has come, and what it answers.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_REQUESTS_H
#define KAZ_SHARED_SERVO_REQUESTS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// A sound frame stands in servo->receiver. Does what it asks for and starts the reply, if it is for
// this board; each request is answered by its reply or by `refused`, unless it went to all boards.
void kz_request_received(kz_servo* servo, const kz_tick_input* input);

// Starts the refusal of the request that came while another reply was being sent. To be called when
// there is one (busy_type) and the sender is idle.
void kz_refuse_busy(kz_servo* servo, const kz_tick_input* input);

#ifdef __cplusplus
}
#endif

#endif

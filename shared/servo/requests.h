// Executes requests and schedules their replies.
// SPDX-License-Identifier: Apache-2.0
//
// A request is executed in the tick in which its frame ends; only its reply may have to wait. Replies keep
// the order of the requests. Each reports the state at the time of writing.
#ifndef KAZ_SHARED_SERVO_REQUESTS_H
#define KAZ_SHARED_SERVO_REQUESTS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

void kz_requests_init(kz_servo* servo);

// Executes the request in servo->receiver, a valid frame, if it is addressed to this board or to all. Queues
// its reply or refusal, unless it was sent to all boards. A repeated request is answered with the outcome of
// the first, and not executed again. Exceptions: `stop`, and the part that switches something off.
void kz_request_received(kz_servo* servo);

// Sets the outcome (kz_outcome, handlers.h) of requests that waited for an action.
void kz_requests_finish(kz_servo* servo, u16 outcome);
// Returns 1 if nothing is being sent, and no reply must be sent before the pending action.
u8 kz_requests_leave_room(const kz_servo* servo);

// Starts the next reply or, if none is due, telemetry. Does nothing while the sender is busy.
void kz_requests_answer(kz_servo* servo, const kz_tick_input* input);

#ifdef __cplusplus
}
#endif

#endif

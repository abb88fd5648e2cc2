// Execution of requests and scheduling of their replies.
// SPDX-License-Identifier: Apache-2.0
//
// A request is executed in the tick in which its frame ends; only its reply may have to wait. Replies are
// in the order of the requests, and each reports the state at the time when it is written.
#ifndef KAZ_SHARED_SERVO_REQUESTS_H
#define KAZ_SHARED_SERVO_REQUESTS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

void kz_requests_init(kz_servo* servo);

// Executes the request of the valid frame in servo->receiver if it is addressed to this board, and queues
// its reply or `refused`, unless it was sent to all boards.
void kz_request_received(kz_servo* servo);

// Sets the outcome of requests that waited for an action.
void kz_requests_finish(kz_servo* servo, u16 outcome);
// Whether nothing is being sent or has to be sent before the pending action.
u8 kz_requests_leave_room(const kz_servo* servo);

// Starts the next reply, or else telemetry, if the sender is idle and one is due.
void kz_requests_answer(kz_servo* servo, const kz_tick_input* input);

#ifdef __cplusplus
}
#endif

#endif

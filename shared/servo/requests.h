// Executes requests and schedules their replies.
// SPDX-License-Identifier: Apache-2.0
//
// A request is executed in the tick in which the request's frame ends. The reply can be sent in a later tick.
// Replies are sent in the order of the requests. Each reply reports the state at the time when the reply is
// written.
#ifndef KAZ_SHARED_SERVO_REQUESTS_H
#define KAZ_SHARED_SERVO_REQUESTS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

void kz_requests_init(kz_servo* servo);

// Executes the request in servo->receiver if the request is addressed to this board or to all boards.
// servo->receiver must contain a valid frame. Queues the reply or refusal, unless the request was sent to all
// boards. A repeated request is not executed again, and the reply reports the outcome of the first execution.
// There are two exceptions. A repeated `stop` is executed again. A repeated `enable`, `clear`, `unlock` or
// `raw_drive` can still switch something off, but cannot switch anything on. For example, a repeated `enable`
// switches joints outside its mask off, but switches no joint on.
void kz_request_received(kz_servo* servo);

// Sets the outcome of the requests that waited for the end of an action. `outcome` is a kz_outcome
// (handlers.h).
void kz_requests_finish(kz_servo* servo, u16 outcome);
// Returns 1 if the pending action can begin: the sender is idle, and all replies to earlier requests have
// been sent.
u8 kz_requests_leave_room(const kz_servo* servo);

// Starts the next reply, or telemetry if no reply is due. Does nothing while the sender is busy.
void kz_requests_answer(kz_servo* servo, const kz_tick_input* input);

#ifdef __cplusplus
}
#endif

#endif

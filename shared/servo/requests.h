// What the board does when a frame has come, and when it answers.
// SPDX-License-Identifier: Apache-2.0
//
// A request is done in the tick in which it is heard; what may have to wait is its reply. So the
// order of the replies is that of the requests, and each tells of the moment in which it is made.
#ifndef KAZ_SHARED_SERVO_REQUESTS_H
#define KAZ_SHARED_SERVO_REQUESTS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

void kz_requests_init(kz_servo* servo);

// A sound frame stands in servo->receiver. Does what it asks for and remembers to answer it, if it
// is for this board; each request is answered by its reply or by `refused`, unless it went to all
// boards.
void kz_request_received(kz_servo* servo);

// What requests that wait for an action came to.
void kz_requests_finish(kz_servo* servo, u16 outcome);
// Nothing is being sent, and nothing is to be sent before the action that is wanted.
u8 kz_requests_leave_room(const kz_servo* servo);

// Starts the next reply, or else telemetry, if the sender is idle and one is due.
void kz_requests_answer(kz_servo* servo, const kz_tick_input* input);

#ifdef __cplusplus
}
#endif

#endif

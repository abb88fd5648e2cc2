// Handlers of requests that change state, and the outcomes of requests.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_HANDLERS_H
#define KAZ_SHARED_SERVO_HANDLERS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Outcome of a request. Upper byte: 0 if the request was executed, else KZ_REFUSED_*. Lower byte: detail of
// the refusal.
typedef u16 kz_outcome;
#define KZ_REFUSE(reason, detail) ((kz_outcome)((u16)((u16)(reason) << 8) | (u16)(detail)))
#define KZ_DONE ((kz_outcome)KZ_NO_DETAIL)
// Temporary outcome of a request that waits for an action (actions.h). When the action has ended,
// kz_requests_finish sets the final outcome.
#define KZ_PENDING 255
#define KZ_LATER KZ_REFUSE(KZ_PENDING, KZ_NO_DETAIL)

// Declares the handler kz_do_<name> for each command of messages.def. The handlers are in motion.c,
// settings.c, telemetry.c and bench.c. Before kz_command calls a handler, kz_command checks that the fields
// are within the bounds of messages.def. A BULK_COMMAND is an exception: its handler gets bytes that have not
// been checked. `request` is null if the message has no fields. A handler checks the whole request before it
// changes anything.
#define KZ_HANDLER_QUERY(name)
#define KZ_HANDLER_JOINT_QUERY(name)
#define KZ_HANDLER_COMMAND(name) kz_outcome kz_do_##name(kz_servo* servo, const kz_##name* request);
#define KZ_HANDLER_BULK_COMMAND(name) \
  kz_outcome kz_do_##name(kz_servo* servo, const u8* fields, u8 length);
#define KZ_HANDLER_FLASH_COMMAND(name) KZ_HANDLER_COMMAND(name)
#define KZ_HANDLER_RESTART_COMMAND(name) KZ_HANDLER_COMMAND(name)
#define KZ_HANDLER_REPLY(name)
#define KZ_HANDLER_LARGE_REPLY(name)
#define KZ_HANDLER_SPLIT_REPLY(name)
#define KZ_HANDLER_ACKNOWLEDGEMENT(name)
#define KZ_HANDLER_REFUSAL(name)
#define KZ_HANDLER_TELEMETRY(name)
#define KZ_MESSAGE(name, code, kind, text) KZ_HANDLER_##kind(name)
#include "shared/protocol/messages.def"

#ifdef __cplusplus
}
#endif

#endif

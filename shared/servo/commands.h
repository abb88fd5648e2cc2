// Every request: checks, and what it does. Nothing is changed before all of it has been checked.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_COMMANDS_H
#define KAZ_SHARED_SERVO_COMMANDS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KZ_NO_DETAIL 255

// How a request came out: KZ_REFUSED_* in the upper byte (0: it is done), its detail in the lower.
typedef u16 kz_outcome;
// It will be known after the action between this tick and the next: kz_requests_finish.
#define KZ_PENDING 255
#define KZ_LATER KZ_REFUSE(KZ_PENDING, KZ_NO_DETAIL)
#define KZ_DONE ((kz_outcome)KZ_NO_DETAIL)
#define KZ_REFUSE(reason, detail) ((kz_outcome)((u16)((u16)(reason) << 8) | (u16)(detail)))

// Does the request of this type whose fields are given. Either all of it is done or nothing.
// `parameter` becomes what its reply is about, where the reply depends on the request's fields.
kz_outcome kz_command(kz_servo* servo, u8 type, const u8* fields, u8 length, u32* parameter);

// The requests of each kind; fields are in their bounds.

// motion.c
kz_outcome kz_do_enable(kz_servo* servo, u32 mask);
kz_outcome kz_do_targets(kz_servo* servo, const u8* fields, u8 length);
kz_outcome kz_do_stop(kz_servo* servo);
kz_outcome kz_do_clear(kz_servo* servo);
kz_outcome kz_do_heartbeat(kz_servo* servo, const kz_heartbeat* request);

// settings.c
kz_outcome kz_do_gains(kz_servo* servo, const kz_gains* request);
kz_outcome kz_do_limits(kz_servo* servo, const kz_limits* request);

kz_outcome kz_do_calibrate(kz_servo* servo, const u8* fields, u8 length);

// telemetry.c
kz_outcome kz_do_telemetry(kz_servo* servo, const kz_telemetry* request);

// bench.c
kz_outcome kz_do_unlock(kz_servo* servo, const kz_unlock* request);
kz_outcome kz_do_raw_drive(kz_servo* servo, const kz_raw_drive* request);
kz_outcome kz_do_store_calibration(kz_servo* servo);
kz_outcome kz_do_set_address(kz_servo* servo, const kz_set_address* request);
kz_outcome kz_do_reset(kz_servo* servo);
kz_outcome kz_do_loader(kz_servo* servo);

// How many joints a mask has.
u8 kz_count_joints(u32 mask);

#ifdef __cplusplus
}
#endif

#endif

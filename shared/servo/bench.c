// Requests for the bench: unlock, raw drive, flash, reset.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/bench.h"

#include "shared/servo/handlers.h"
#include "shared/servo/joints.h"
#include "shared/servo/safety.h"
#include "shared/servo/shutdown.h"

#define MS_PER_S 1000

static void lock(kz_servo* servo) {
  servo->unlocked_ms = 0;
  servo->raw_ms = 0;
}

// Locking is always allowed: it makes nothing possible.
kz_outcome kz_do_unlock(kz_servo* servo, const kz_unlock* request) {
  if (request->seconds == 0) {
    lock(servo);
    return KZ_DONE;
  }
  if (kz_motors_on(servo)) return KZ_REFUSE(KZ_REFUSED_ARMED, KZ_NO_DETAIL);
  servo->extras = 1;
  servo->unlocked_ms = (u16)((u16)request->seconds * MS_PER_S);
  return KZ_DONE;
}

kz_outcome kz_do_raw_drive(kz_servo* servo, const kz_raw_drive* request) {
  u8 reason = servo->shutdown;
  if (servo->unlocked_ms == 0) return KZ_REFUSE(KZ_REFUSED_LOCKED, KZ_NO_DETAIL);
  if (servo->enabled != 0) return KZ_REFUSE(KZ_REFUSED_ARMED, KZ_NO_DETAIL);
  if (reason == KZ_SHUTDOWN_NONE && request->duty != 0) {
    reason = kz_active_fault(servo, (u32)1 << request->joint);
  }
  if (reason != KZ_SHUTDOWN_NONE) return KZ_REFUSE(KZ_REFUSED_FAULT, reason);
  kz_joint_at(servo, servo->raw_joint)->duty = 0;  // the one that this drive replaces, at once
  servo->raw_joint = request->joint;
  servo->raw_duty = request->duty;
  servo->raw_ms = request->duty == 0 ? 0 : request->duration_ms;
  servo->raw_begun = 0;
  return KZ_DONE;
}

// Time goes on in ticks that were missed.
static void run_down(u16* ms, u16 elapsed) {
  *ms = (u16)(*ms > elapsed ? *ms - elapsed : 0);
}

void kz_bench_update(kz_servo* servo, const kz_tick_input* input) {
  const u16 elapsed = (u16)(input->missed + 1);
  // The motor is driven from the tick after the request's: so is its time counted.
  if (servo->raw_begun) run_down(&servo->raw_ms, elapsed);
  servo->raw_begun = (u8)(servo->raw_ms != 0);
  run_down(&servo->unlocked_ms, elapsed);
  if (servo->unlocked_ms == 0) lock(servo);
}

void kz_bench_drive(kz_servo* servo) {
  kz_joint* joint = kz_joint_at(servo, servo->raw_joint);
  if (joint->pot_bad_ms == 0) {
    kz_joint_drive_raw(joint, servo->raw_duty);
  } else if (joint->pot_bad_ms >= KZ_POT_FAULT_MS) {
    kz_shutdown(servo, KZ_SHUTDOWN_POT, servo->raw_joint);
  }
}

static kz_outcome request_action(kz_servo* servo, u8 action, kz_outcome outcome) {
  if (kz_motors_on(servo)) return KZ_REFUSE(KZ_REFUSED_ARMED, KZ_NO_DETAIL);
  servo->extras = 1;
  servo->action = action;
  return outcome;
}

kz_outcome kz_do_store_calibration(kz_servo* servo, const kz_store_calibration* request) {
  (void)request;
  return request_action(servo, KZ_ACTION_STORE_CALIBRATION, KZ_LATER);
}

kz_outcome kz_do_set_address(kz_servo* servo, const kz_set_address* request) {
  if (servo->unlocked_ms == 0) return KZ_REFUSE(KZ_REFUSED_LOCKED, KZ_NO_DETAIL);
  if (kz_motors_on(servo)) return KZ_REFUSE(KZ_REFUSED_ARMED, KZ_NO_DETAIL);
  servo->new_address = request->address;
  servo->new_shared_line = request->shared_line;
  return request_action(servo, KZ_ACTION_STORE_ADDRESS, KZ_LATER);
}

kz_outcome kz_do_reset(kz_servo* servo, const kz_reset* request) {
  (void)request;
  return request_action(servo, KZ_ACTION_RESET, KZ_DONE);
}

kz_outcome kz_do_loader(kz_servo* servo, const kz_loader* request) {
  (void)request;
  return request_action(servo, KZ_ACTION_LOADER, KZ_DONE);
}

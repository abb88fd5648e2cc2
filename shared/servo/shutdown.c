// Switching all motors off, and the latched reason for it.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/shutdown.h"

#include "shared/servo/joints.h"

u8 kz_motors_on(const kz_servo* servo) {
  return (u8)(servo->enabled != 0 || servo->raw_ms != 0);
}

void kz_latch_shutdown(kz_servo* servo, u8 reason, u8 detail) {
  if (servo->shutdown != KZ_SHUTDOWN_NONE) return;
  servo->shutdown = reason;
  servo->shutdown_detail = detail;
  servo->shutdown_tick = servo->tick;
}

void kz_shutdown(kz_servo* servo, u8 reason, u8 detail) {
  kz_joints_enable(servo, 0);
  kz_latch_shutdown(servo, reason, detail);
}

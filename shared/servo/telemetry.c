// Telemetry: which frames are due.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/telemetry.h"

#include "shared/servo/handlers.h"

#define FIELD_PERIOD 0  // position of `period_ms` in the message

kz_outcome kz_do_telemetry(kz_servo* servo, const kz_telemetry* request) {
  if (request->period_ms != 0 && request->period_ms < KZ_TELEMETRY_PERIOD_MIN_MS) {
    return KZ_REFUSE(KZ_REFUSED_RANGE, FIELD_PERIOD);
  }
  if (servo->shared_line) return KZ_REFUSE(KZ_REFUSED_SHARED_LINE, KZ_NO_DETAIL);
  kz_telemetry_end(servo);
  if (request->selection == 0) return KZ_DONE;
  if (request->period_ms == 0) return KZ_DONE;
  servo->extras = 1;
  servo->telemetry_ms = request->period_ms;
  servo->telemetry_left_ms = request->period_ms;
  servo->telemetry_selection = request->selection;
  return KZ_DONE;
}

void kz_telemetry_end(kz_servo* servo) {
  servo->telemetry_ms = 0;
  servo->telemetry_due = 0;
}

void kz_telemetry_update(kz_servo* servo) {
  u8 late;
  if (--servo->telemetry_left_ms != 0) return;
  servo->telemetry_left_ms = servo->telemetry_ms;
  for (late = servo->telemetry_due; late != 0; late >>= 1) {
    if (late & 1) kz_count(&servo->telemetry_dropped);
  }
  servo->telemetry_due = servo->telemetry_selection;
}

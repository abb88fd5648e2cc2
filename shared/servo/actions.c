// Actions between two ticks.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/actions.h"

#include "shared/servo/handlers.h"
#include "shared/servo/requests.h"

u8 kz_action_start(kz_servo* servo, const kz_tick_input* input) {
  if (!kz_requests_leave_room(servo)) return KZ_ACTION_NONE;
  if (input->tx_room < KZ_TX_BUFFER) return KZ_ACTION_NONE;
  servo->acting = 1;
  return servo->action;
}

void kz_action_finish(kz_servo* servo, const kz_tick_input* input) {
  const u8 done = (u8)(input->result == KZ_RESULT_DONE);
  if (done && servo->action == KZ_ACTION_STORE_CALIBRATION) servo->uncalibrated = 0;
  servo->acting = 0;
  servo->action = KZ_ACTION_NONE;
  if (!done) kz_count(&servo->refusals);
  kz_requests_finish(servo, done ? KZ_DONE : KZ_REFUSE(KZ_REFUSED_STORE, KZ_NO_DETAIL));
}

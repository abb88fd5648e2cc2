// The servo tick: safety, joints, requests, replies, pins, in this order.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/tick.h"

#include "shared/protocol/messages.h"
#include "shared/servo/joints.h"
#include "shared/servo/outputs.h"
#include "shared/servo/requests.h"
#include "shared/servo/safety.h"

void kz_servo_init(kz_servo* servo, kz_tick_output* output) {
  u8* byte = (u8*)servo;
  u16 i;
  for (i = 0; i < sizeof *servo; ++i) byte[i] = 0;
  byte = (u8*)output;
  for (i = 0; i < sizeof *output; ++i) byte[i] = 0;
  servo->address = KZ_ADDRESS_DEFAULT;
  servo->outcome = KZ_REFUSED_UNKNOWN_TYPE;  // the answer to a "repetition" of nothing
  servo->watchdog_ms = KZ_WATCHDOG_DEFAULT_MS;
  kz_receiver_init(&servo->receiver);
  kz_sender_init(&servo->sender);
  kz_joints_init(servo);
}

static void receive(kz_servo* servo, const kz_tick_input* input) {
  const u8 count = input->rx_count < KZ_RX_PER_TICK ? input->rx_count : KZ_RX_PER_TICK;
  u8 i;
  for (i = 0; i < count; ++i) {
    const u8 result = kz_receive(&servo->receiver, input->rx[i], input->rx_flags[i]);
    if (result == KZ_RECEIVE_MORE) continue;
    if (result == KZ_RECEIVE_FRAME) {
      kz_request_received(servo, input);
    } else if (servo->bad_frames < 0xFFFF) {
      ++servo->bad_frames;
    }
  }
}

static void transmit(kz_servo* servo, const kz_tick_input* input, kz_tick_output* output) {
  const u8 room = input->tx_room < KZ_TX_PER_TICK ? input->tx_room : KZ_TX_PER_TICK;
  u8* unused = output->tx;
  u8 left;
  if (servo->busy_type != 0 && !kz_sender_busy(&servo->sender)) kz_refuse_busy(servo, input);
  output->tx_count = kz_sender_take(&servo->sender, output->tx, room);
  unused += output->tx_count;
  for (left = (u8)(KZ_TX_PER_TICK - output->tx_count); left != 0; --left) *unused++ = 0;
}

void kz_tick(kz_servo* servo, const kz_tick_input* input, kz_tick_output* output) {
  kz_safety_update(servo, input);
  if (servo->fresh_targets != 0) kz_joints_start_ramps(servo);
  if (kz_joints_update(servo, input)) kz_safety_trip(servo, KZ_STATUS_POT_FAULT);
  receive(servo, input);
  transmit(servo, input, output);
  kz_outputs_write(servo, output);
}

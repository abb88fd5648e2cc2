// The servo tick: safety, joints, requests, replies, pins, in this order.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/tick.h"

#include "shared/protocol/messages.h"
#include "shared/servo/actions.h"
#include "shared/servo/bench.h"
#include "shared/servo/health.h"
#include "shared/servo/joint_loop.h"
#include "shared/servo/joints.h"
#include "shared/servo/outputs.h"
#include "shared/servo/protection.h"
#include "shared/servo/requests.h"
#include "shared/servo/safety.h"
#include "shared/servo/shutdown.h"
#include "shared/servo/telemetry.h"

#define NOT_INLINE __attribute__((noinline))
// As many bytes keep the wire busy until the next tick.
#define WIRE_ENOUGH 12

void kz_servo_init(kz_servo* servo, const kz_startup* startup, kz_tick_output* output) {
  u8* byte = (u8*)servo;
  u16 i;
  for (i = 0; i < sizeof *servo; ++i) byte[i] = 0;
  byte = (u8*)output;
  for (i = 0; i < sizeof *output; ++i) byte[i] = 0;
  servo->address = startup->address;
  servo->shared_line = startup->shared_line;
  servo->calibration = startup->calibration;
  if (startup->calibration == KZ_CALIBRATION_NOMINAL) servo->uncalibrated = KZ_STATUS_UNCALIBRATED;
  servo->image_crc = startup->image_crc;
  servo->start_8states = startup->start_8states;
  servo->reset_cause = startup->reset_cause;
  servo->tests_done = startup->tests_done;
  servo->tests_failed = startup->tests_failed;
  servo->shutdown_detail = KZ_NO_DETAIL;
  servo->reaction = KZ_REACTION_LIMP;
  servo->watchdog_ms = KZ_WATCHDOG_DEFAULT_MS;
  kz_receiver_init(&servo->receiver);
  kz_sender_init(&servo->sender);
  kz_requests_init(servo);
  kz_health_init(servo);
  kz_joints_init(servo, startup);
  if (startup->tests_failed != 0) kz_shutdown(servo, KZ_SHUTDOWN_SELF_TEST, KZ_NO_DETAIL);
}

static NOT_INLINE void count_damage(kz_servo* servo, u8 result) {
  switch (result) {
    case KZ_RECEIVE_BAD_CHECK:
      kz_count(&servo->bad_check);
      break;
    case KZ_RECEIVE_BAD_STUFFING:
      kz_count(&servo->bad_stuffing);
      break;
    case KZ_RECEIVE_TOO_SHORT:
      kz_count(&servo->too_short);
      break;
    case KZ_RECEIVE_TOO_LONG:
      kz_count(&servo->too_long);
      break;
    case KZ_RECEIVE_LINE_ERROR:
      kz_count(&servo->line_errors);
      break;
    case KZ_RECEIVE_OVERRUN:
      kz_count(&servo->overruns);
      break;
    default:
      kz_count(&servo->idle);
      break;
  }
}

static NOT_INLINE void frame_ended(kz_servo* servo, u8 result) {
  if (result == KZ_RECEIVE_FRAME) {
    kz_request_received(servo);
  } else {
    count_damage(servo, result);
  }
}

// The parts of a tick are functions of their own: what is inlined into one runs out of registers.
static NOT_INLINE void receive(kz_servo* servo, const kz_tick_input* input) {
  const u8 count = input->rx_count < KZ_RX_PER_TICK ? input->rx_count : KZ_RX_PER_TICK;
  u8 taken = 0;
  servo->receiver.silent_ms = 0;
  while (taken < count) {
    const u16 some = kz_receive_some(&servo->receiver, input->rx + taken, input->rx_flags + taken,
                                     (u8)(count - taken));
    const u8 result = (u8)(some >> 8);
    taken = (u8)(taken + (u8)some);
    if (result != KZ_RECEIVE_MORE) frame_ended(servo, result);
  }
}

static void receive_nothing(kz_servo* servo) {
  const u8 result = kz_receiver_silent(&servo->receiver);
  if (result != KZ_RECEIVE_MORE) count_damage(servo, result);
}

// Bytes that may be sent now: in a tick that has done much only as many as the wire needs.
static u8 room(u8 tx_room, u8 tx_throttled) {
  if (tx_throttled) return tx_room <= KZ_TX_BUFFER - WIRE_ENOUGH ? 0 : WIRE_ENOUGH;
  return tx_room < KZ_TX_PER_TICK ? tx_room : KZ_TX_PER_TICK;
}

// Bytes of `tx` that are not used are 0: those that were in the tick before are cleared.
static NOT_INLINE void transmit(kz_servo* servo, u8 tx_room, kz_tick_output* output) {
  const u8 before = output->tx_count;
  u8 count = 0;
  if (kz_sender_busy(&servo->sender)) {
    count = kz_sender_take(&servo->sender, output->tx, room(tx_room, servo->tx_throttled));
    if (!kz_sender_busy(&servo->sender)) servo->replying = 0;
  }
  output->tx_count = count;
  if (count < before) {
    u8* unused = output->tx + count;
    u8 left = (u8)(before - count);
    do *unused++ = 0;
    while (--left != 0);
  }
}

// Rarely active: actions, bench, telemetry.
static NOT_INLINE void begin_extras(kz_servo* servo, const kz_tick_input* input) {
  if (servo->acting) kz_action_finish(servo, input);
  if (servo->unlocked_ms != 0) kz_bench_update(servo, input);
  if (servo->telemetry_ms != 0) kz_telemetry_update(servo);
}

static NOT_INLINE u8 end_extras(kz_servo* servo, const kz_tick_input* input) {
  if (servo->action != KZ_ACTION_NONE) return kz_action_start(servo, input);
  servo->extras = (u8)(servo->unlocked_ms != 0 || servo->telemetry_ms != 0);
  return KZ_ACTION_NONE;
}

void kz_tick(kz_servo* servo, const kz_tick_input* input, kz_tick_output* output) {
  u16 fault;
  servo->tick = input->tick;
  servo->tx_throttled = 0;
  if (servo->extras) begin_extras(servo, input);
  kz_safety_update(servo, input);
  if ((++servo->phase & 3) != 0) kz_health_update(servo, input);
  if (servo->fresh_targets != 0) {
    kz_joints_start_ramps(servo);
    servo->tx_throttled = 1;
  }
  fault = kz_joints_update(servo, input);
  if (fault != 0) kz_shutdown(servo, (u8)(fault >> 8), (u8)fault);
  if (servo->raw_ms != 0) kz_bench_drive(servo);
  fault = kz_protection_update(servo);
  if (fault != 0) kz_shutdown(servo, (u8)(fault >> 8), (u8)fault);
  if (input->rx_count != 0) {
    receive(servo, input);
  } else {
    receive_nothing(servo);
  }
  if ((servo->queued | servo->refuse_busy | servo->extras) != 0) {
    kz_requests_answer(servo, input);
  }
  if (output->tx_count != 0 || kz_sender_busy(&servo->sender)) {
    transmit(servo, input->tx_room, output);
  }
  output->action = servo->extras ? end_extras(servo, input) : KZ_ACTION_NONE;
  kz_outputs_write(servo, output);
}

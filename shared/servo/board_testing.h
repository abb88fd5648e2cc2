// Test fixture: the servo tick with a host line and simulated A/D codes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <optional>
#include <vector>

#include "shared/board/table.h"
#include "shared/protocol/messages.h"
#include "shared/servo/tick.h"

namespace kaz::test {

using Bytes = std::vector<u8>;

struct Reply {
  u8 address, type, sequence;
  Bytes fields;
};

// Returns the unpacked fields of a reply: fields_of<kz_state_reply, kz_unpack_state_reply>(reply).
// Fails the test if the length is wrong.
template <class Message, u8 (*unpack)(Message*, const u8*, u8)>
Message fields_of(const Reply& reply) {
  Message message = {};
  EXPECT_EQ(unpack(&message, reply.fields.data(), static_cast<u8>(reply.fields.size())), 1);
  return message;
}

class TestBoard {
 public:
  static constexpr u16 kCenterCode = 512;
  static constexpr u16 kImageCrc = 0xABCD;
  static constexpr u16 kHealthySupplyCode = 667;  // 10.005 V at 15 mV per code

  static kz_startup valid_startup() {
    kz_startup startup;
    kz_startup_nominal(&startup);
    startup.image_crc = kImageCrc;
    startup.calibration = KZ_CALIBRATION_A;
    return startup;
  }

  explicit TestBoard(const kz_startup& startup = valid_startup()) {
    kz_servo_init(&servo, &startup, &output);
    kz_receiver_init(&host_receiver_);
    for (int joint = 0; joint < KZ_JOINTS; ++joint) set_pot(joint, kCenterCode);
    input.analog[KZ_ANALOG_SUPPLY] = kHealthySupplyCode;
    input.analog[KZ_ANALOG_REFERENCE] = KZ_REFERENCE_CODE;
    input.analog[KZ_ANALOG_TEMPERATURE] = 250;  // 25.0 degC
    input.tx_room = 63;
    ticks(4);  // measures every input once
  }

  void set_pot(int joint, u16 code) { input.analog[kz_board_joints[joint].analog] = code; }

  // Runs one tick, with up to KZ_RX_PER_TICK pending bytes from the host. Collects replies and actions.
  void tick() {
    input.rx_count = 0;
    while (input.rx_count < KZ_RX_PER_TICK && !to_board_.empty()) {
      input.rx[input.rx_count++] = to_board_.front();
      to_board_.pop_front();
    }
    kz_tick(&servo, &input, &output);
    ++input.tick;
    input.result = KZ_RESULT_NONE;
    if (output.action != KZ_ACTION_NONE) {
      actions.push_back(output.action);
      input.result = action_result;
    }
    for (int i = 0; i < output.tx_count; ++i) {
      if (kz_receive(&host_receiver_, output.tx[i], 0) != KZ_RECEIVE_FRAME) continue;
      const u8* body = host_receiver_.body;
      replies.push_back(
          {body[0], body[1], body[2], Bytes(body + KZ_HEADER_SIZE, body + host_receiver_.length)});
    }
  }
  void ticks(int count) {
    for (int i = 0; i < count; ++i) tick();
  }

  void send(u8 type, u8 number, const Bytes& fields, u8 address = KZ_ADDRESS_DEFAULT) {
    Bytes body = {address, type, number};
    body.insert(body.end(), fields.begin(), fields.end());
    Bytes wire(KZ_FRAME_MAX);
    wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
    to_board_.insert(to_board_.end(), wire.begin(), wire.end());
  }

  // Sends a request and runs ticks until the reply or refusal arrives. Returns nullopt after 50 ms.
  std::optional<Reply> exchange(u8 type, const Bytes& fields, u8 address = KZ_ADDRESS_DEFAULT) {
    replies.clear();
    send(type, ++sequence, fields, address);
    const auto is_answer = [&](const Reply& reply) {
      return reply.sequence == sequence &&
             (reply.type == (type | KZ_REPLY) || reply.type == KZ_TYPE_refused);
    };
    for (int i = 0; i < 50; ++i) {
      tick();
      const auto found = std::find_if(replies.begin(), replies.end(), is_answer);
      if (found != replies.end()) return *found;
    }
    return std::nullopt;
  }

  // Sends a request. Returns 0 if the request was executed, or the reason (KZ_REFUSED_*) if the request was
  // refused. Returns -1 if no valid reply came. Stores the refusal's detail in `detail`.
  int outcome(u8 type, const Bytes& fields) {
    const auto reply = exchange(type, fields);
    if (!reply) return -1;
    if (reply->type == (type | KZ_REPLY)) return 0;
    kz_refused refused;
    if (!kz_unpack_refused(&refused, reply->fields.data(), static_cast<u8>(reply->fields.size())))
      return -1;
    detail = refused.detail;
    return refused.request == type ? refused.reason : -1;
  }
  int enable(u32 mask) {
    const kz_enable request = {.mask = mask};
    Bytes fields(KZ_SIZE_enable);
    kz_pack_enable(&request, fields.data());
    return outcome(KZ_TYPE_enable, fields);
  }
  int target(int joint, s16 angle, u16 duration_ms) {
    kz_targets request = {};
    request.mask = 1u << joint;
    request.duration_ms = duration_ms;
    request.angle[joint] = angle;
    return targets(request);
  }
  int targets(const kz_targets& request) {
    Bytes fields(KZ_SIZE_targets);
    fields.resize(kz_pack_targets(&request, fields.data()));
    return outcome(KZ_TYPE_targets, fields);
  }
  int gains(u32 mask, u16 kp, u16 kd) {
    const kz_gains request = {.mask = mask, .kp = kp, .kd = kd, .dead_band = 0, .friction = 0};
    Bytes fields(KZ_SIZE_gains);
    kz_pack_gains(&request, fields.data());
    return outcome(KZ_TYPE_gains, fields);
  }
  int limits(u32 mask, u16 ramp, s16 lower = -32768, s16 upper = 32767) {
    const kz_limits request = {.mask = mask, .ramp = ramp, .lower = lower, .upper = upper};
    Bytes fields(KZ_SIZE_limits);
    kz_pack_limits(&request, fields.data());
    return outcome(KZ_TYPE_limits, fields);
  }
  int heartbeat(u8 watchdog_10ms = 0, u8 reaction = 0) {
    return outcome(KZ_TYPE_heartbeat, {watchdog_10ms, reaction});
  }
  // Returns the fields of the reply to a request. If the request was refused, fails the test and returns
  // zeros.
  template <class Message, u8 (*unpack)(Message*, const u8*, u8)>
  Message query(u8 type, const Bytes& fields = {}) {
    const auto reply = exchange(type, fields);
    EXPECT_TRUE(reply && reply->type == (type | KZ_REPLY)) << "type " << int(type);
    if (!reply || reply->type != (type | KZ_REPLY)) return {};
    return fields_of<Message, unpack>(*reply);
  }
#define KZ_TEST_QUERY(name) query<kz_##name##_reply, kz_unpack_##name##_reply>
  kz_health_reply health() {
    return KZ_TEST_QUERY(health)(KZ_TYPE_health);
  }
  kz_statistics_reply statistics() {
    return KZ_TEST_QUERY(statistics)(KZ_TYPE_statistics);
  }
  kz_joints_reply joints(u32 mask) {
    return KZ_TEST_QUERY(joints)(KZ_TYPE_joints, bytes_of(mask));
  }
  kz_read_targets_reply read_targets(u32 mask) {
    return KZ_TEST_QUERY(read_targets)(KZ_TYPE_read_targets, bytes_of(mask));
  }
  kz_settings_reply settings(u8 joint) {
    return KZ_TEST_QUERY(settings)(KZ_TYPE_settings, {joint});
  }
  kz_calibration_reply calibration() {
    return KZ_TEST_QUERY(calibration)(KZ_TYPE_calibration);
  }
  kz_self_test_reply self_test() {
    return KZ_TEST_QUERY(self_test)(KZ_TYPE_self_test);
  }
#undef KZ_TEST_QUERY
  static Bytes bytes_of(u32 number) {
    return {static_cast<u8>(number >> 24), static_cast<u8>(number >> 16),
            static_cast<u8>(number >> 8), static_cast<u8>(number)};
  }

  int telemetry(u16 period_ms, u8 selection) {
    const kz_telemetry request = {.period_ms = period_ms, .selection = selection};
    Bytes fields(KZ_SIZE_telemetry);
    kz_pack_telemetry(&request, fields.data());
    return outcome(KZ_TYPE_telemetry, fields);
  }
  int unlock(u8 seconds, u16 key = KZ_KEY) {
    const kz_unlock request = {.key = key, .seconds = seconds};
    Bytes fields(KZ_SIZE_unlock);
    kz_pack_unlock(&request, fields.data());
    return outcome(KZ_TYPE_unlock, fields);
  }
  int raw_drive(u8 joint, s16 duty, u16 duration_ms) {
    const kz_raw_drive request = {.joint = joint, .duty = duty, .duration_ms = duration_ms};
    Bytes fields(KZ_SIZE_raw_drive);
    kz_pack_raw_drive(&request, fields.data());
    return outcome(KZ_TYPE_raw_drive, fields);
  }
  int calibrate(const kz_calibrate& request) {
    Bytes fields(KZ_SIZE_calibrate);
    fields.resize(kz_pack_calibrate(&request, fields.data()));
    return outcome(KZ_TYPE_calibrate, fields);
  }
  int stop() {
    return outcome(KZ_TYPE_stop, {});
  }
  int clear() {
    return outcome(KZ_TYPE_clear, {});
  }
  u16 status() {
    const auto reply = exchange(KZ_TYPE_state, {});
    kz_state_reply state = {};
    if (reply)
      kz_unpack_state_reply(&state, reply->fields.data(), static_cast<u8>(reply->fields.size()));
    return state.status;
  }
  bool drivers_on() const {
    return (output.p4 & KZ_P4_ENABLE) != 0;
  }
  void put_on_wire(const Bytes& bytes) {
    to_board_.insert(to_board_.end(), bytes.begin(), bytes.end());
  }

  kz_servo servo;
  kz_tick_input input = {};
  kz_tick_output output;
  std::vector<Reply> replies;
  std::vector<u8> actions;  // all KZ_ACTION_* that ticks requested
  u8 action_result = KZ_RESULT_DONE;
  u8 sequence = 0;
  u8 detail = 0;

 private:
  kz_receiver host_receiver_;
  std::deque<u8> to_board_;
};

}  // namespace kaz::test

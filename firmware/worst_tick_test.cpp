// What a tick costs under the worst that a host may legally send.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "firmware/image_testing.h"
#include "shared/board/table.h"
#include "shared/protocol/messages.h"
#include "sim/h8s/chip/chip.h"
#include "sim/mcu/h8_mcu.h"

namespace kaz::sim {
namespace {

constexpr States ms = KZ_STATES_PER_TICK;
constexpr int longest_share = 75;  // % of a tick

using Bytes = std::vector<u8>;

template <class Message>
Bytes packed(u8 (*pack)(const Message*, u8*), const Message& message) {
  Bytes fields(KZ_PAYLOAD_MAX);
  fields.resize(pack(&message, fields.data()));
  return fields;
}

// All joints on and moving, bytes both ways without a pause, telemetry beside it.
class WorstTick : public testing::Test {
 protected:
  void SetUp() override {
    auto loaded = H8Mcu::load(firmware_image());
    ASSERT_TRUE(loaded) << loaded.error().message;
    mcu = std::move(*loaded);
    mcu->set_analog([](int channel, const PinLevels& levels, States at) {
      const int input = channel * KZ_MUX_INPUTS + (levels.p4 & KZ_P4_MUX_MASK);
      if (input == KZ_ANALOG_SUPPLY) return 667.5 / KZ_POT_CODES;
      if (input == KZ_ANALOG_REFERENCE) return 512.5 / KZ_POT_CODES;
      if (input == KZ_ANALOG_TEMPERATURE) return 250.5 / KZ_POT_CODES;
      return 0.5 + 0.2 * std::sin(6.0 * static_cast<double>(at) / KZ_CLOCK_HZ + input);
    });
    mcu->on_tick([this](const TickRecord& tick) {
      const int busy = tick.input.busy_8states * 8;  // of the tick before
      if (busy > worst) {
        worst = busy;
        worst_at = tick.input.tick - 1;
      }
      missed += tick.input.missed;
    });
    kz_receiver_init(&receiver);
    run(100 * ms);
    worst = 0;
  }

  void run(States states) {
    const auto ran = mcu->run_until(mcu->now() + states);
    ASSERT_TRUE(ran) << ran.error().message;
  }

  void send(u8 type, const Bytes& fields) {
    Bytes body = {KZ_ADDRESS_DEFAULT, type, ++sequence};
    body.insert(body.end(), fields.begin(), fields.end());
    u8 wire[KZ_FRAME_MAX];
    const int length = kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire);
    wire_free = std::max(wire_free, mcu->now());
    // Two frames share a zero: as much as can come.
    for (int i = last_was_frame ? 1 : 0; i < length; ++i) {
      wire_free += KZ_STATES_PER_BYTE;
      mcu->receive({wire[i], wire_free, false});
    }
    last_was_frame = true;
  }

  void enable() { send(KZ_TYPE_enable, packed(kz_pack_enable, kz_enable{KZ_ALL_JOINTS})); }
  void targets() {
    kz_targets request = {};
    request.mask = KZ_ALL_JOINTS;
    request.duration_ms = static_cast<u16>(random() % 3 * 7);
    for (int i = 0; i < KZ_JOINTS; ++i) {
      const int span = kz_board_joints[i].upper - kz_board_joints[i].lower;
      request.angle[i] = static_cast<s16>(kz_board_joints[i].lower +
                                          static_cast<int>(random() % unsigned(span + 1)));
    }
    send(KZ_TYPE_targets, packed(kz_pack_targets, request));
  }
  void joints() { send(KZ_TYPE_joints, packed(kz_pack_joints, kz_joints{0x3FE00})); }
  void read_targets() {
    send(KZ_TYPE_read_targets, packed(kz_pack_read_targets, kz_read_targets{KZ_ALL_JOINTS}));
  }
  void gains() {
    send(KZ_TYPE_gains, packed(kz_pack_gains, kz_gains{KZ_ALL_JOINTS, KZ_KP_MAX, KZ_KD_MAX,
                                                       static_cast<u16>(random() % 20), 30}));
  }
  void limits() {
    send(KZ_TYPE_limits,
         packed(kz_pack_limits, kz_limits{KZ_ALL_JOINTS, KZ_RAMP_MAX, -32768, 32767}));
  }
  void calibrate() {  // refused: motors are on
    kz_calibrate request = {};
    request.mask = KZ_ALL_JOINTS;
    send(KZ_TYPE_calibrate, packed(kz_pack_calibrate, request));
  }
  void telemetry() {
    send(KZ_TYPE_telemetry,
         packed(kz_pack_telemetry, kz_telemetry{KZ_TELEMETRY_PERIOD_MIN_MS, 15}));
  }

  void any_request() {
    switch (random() % 16) {
      case 0:
        return joints();
      case 1:
        return read_targets();
      case 2:
        return send(KZ_TYPE_state, {});
      case 3:
        return send(KZ_TYPE_calibration, {});
      case 4:
        return send(KZ_TYPE_statistics, {});
      case 5:
        return send(KZ_TYPE_health, {});
      case 6:
        return gains();
      case 7:
        return limits();
      case 8:
        return calibrate();
      case 9:
        return enable();
      case 10:
        return send(KZ_TYPE_heartbeat, {0, 0});
      case 11:
        return joints();
      case 12:
        return send(KZ_TYPE_inertial, {});
      default:
        return targets();
    }
  }

  // Number of complete replies to requests received since the last call.
  int replies() {
    int count = 0;
    for (const SerialByte& byte : mcu->take_transmitted()) {
      if (kz_receive(&receiver, byte.value, 0) != KZ_RECEIVE_FRAME) continue;
      const u8 type = receiver.body[1];
      if (type < KZ_TYPE_telemetry_state || type == KZ_TYPE_refused) ++count;
    }
    return count;
  }

  // Runs until the wire to the board is about to fall silent.
  void keep_up() {
    while (wire_free > mcu->now() + 2 * ms) run(ms);
  }

  std::unique_ptr<H8Mcu> mcu;
  std::mt19937 random{4};
  u8 sequence = 0;
  bool last_was_frame = false;
  kz_receiver receiver = {};
  States wire_free = 0;
  int worst = 0, missed = 0;
  u32 worst_at = 0;
};

TEST_F(WorstTick, OfAllRequestsWithoutAPause) {
  // Where in a tick frames end depends on when the host begins, and on the time of the board's start, which
  // depends on the size of the image.
  constexpr int phases = 8;
  int highest = 0;
  for (int phase = 0; phase < phases; ++phase) {
    SetUp();
    last_was_frame = false;
    wire_free = mcu->now() + phase * ms / phases;
    enable();
    telemetry();
    while (mcu->now() < 5000 * ms) {
      any_request();
      keep_up();
    }
    ASSERT_NE(mcu->pins().p4 & KZ_P4_ENABLE, 0) << "the motors went off";
    highest = std::max(highest, worst);
  }
  std::printf("worst tick: any request, no pause: %d states (%.1f %%)\n", highest,
              100.0 * highest / ms);
  // Back to back, with telemetry at its shortest period: no tick may be missed.
  EXPECT_EQ(missed, 0);
  EXPECT_LT(highest, ms * 83 / 100);  // docs/limits.md
}

// A host that keeps to the protocol: at most two requests under way, the next one as soon as a reply
// has come. Telemetry beside it, settings that make each joint constrained.
TEST_F(WorstTick, OfTwoRequestsUnderWay) {
  enable();
  telemetry();
  gains();
  run(20 * ms);
  mcu->take_transmitted();
  int under_way = 0, done = 0;
  while (mcu->now() < 5000 * ms) {
    const int came = replies();
    under_way -= came;
    done += came;
    for (; under_way < 2; ++under_way) any_request();
    run(ms / 8);
  }
  ASSERT_NE(mcu->pins().p4 & KZ_P4_ENABLE, 0) << "the motors went off";
  std::printf("worst tick: two requests under way: %d states (%.1f %%), %d requests\n", worst,
              100.0 * worst / ms, done);
  EXPECT_GT(done, 500);
  EXPECT_EQ(missed, 0);
  EXPECT_LT(worst, ms * longest_share / 100);
}

// A host as it may be: targets, then what has the longest reply, at each shift against the tick.
TEST_F(WorstTick, OfTargetsAndALongReplyAtEachShift) {
  enable();
  telemetry();
  run(20 * ms);
  int worst_of = 0;
  for (int kind = 0; kind < 4; ++kind) {
    worst = 0;
    for (int shift = 0; shift < 24; ++shift) {
      targets();
      if (kind == 0) joints();
      if (kind == 1) send(KZ_TYPE_calibration, {});
      if (kind == 2) read_targets();
      if (kind == 3) send(KZ_TYPE_state, {});
      while (wire_free > mcu->now()) run(ms / 4);
      run(18 * ms);
      wire_free = mcu->now() + shift * ms / 24;
    }
    std::printf("worst tick: targets and long reply %d: %d states (%.1f %%)\n", kind, worst,
                100.0 * worst / ms);
    worst_of = std::max(worst_of, worst);
  }
  ASSERT_NE(mcu->pins().p4 & KZ_P4_ENABLE, 0) << "the motors went off";
  EXPECT_EQ(missed, 0);
  EXPECT_LT(worst_of, ms * longest_share / 100);
}

}  // namespace
}  // namespace kaz::sim

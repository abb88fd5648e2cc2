// Flash and reset as a host observes them, equal with both engines: stored values survive power loss at
// any time, and a board reports a requested reset.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdio>
#include <optional>

#include "shared/base/random.hpp"
#include "shared/board/table.h"
#include "sim/mcu/h8_mcu.h"
#include "sim/mcu/host_testing.h"

namespace kaz::sim {
namespace {

constexpr States kMs = KZ_STATES_PER_TICK;

struct Answer {
  std::uint8_t address = 0, type = 0;
  std::vector<std::uint8_t> fields;
  States first = 0;  // when its first byte had come
};

class Remember : public testing::TestWithParam<McuKind> {
 protected:
  void SetUp() override {
    if (GetParam() == McuKind::native) {
      mcu = make_native();
    } else {
      auto made = make_h8(KAZ_FIRMWARE_IMAGE);
      ASSERT_TRUE(made) << made.error().message;
      mcu = std::move(*made);
    }
    mcu->set_analog(quiet_board);
    run(100 * kMs);
  }
  void run(States states) {
    const auto ran = mcu->run_until(mcu->now() + states);
    ASSERT_TRUE(ran) << ran.error().message;
  }
  // Returns when the request's last bit has passed.
  States put(std::uint8_t type, const std::vector<std::uint8_t>& fields) {
    std::vector<std::uint8_t> body{address, type, ++sequence};
    body.insert(body.end(), fields.begin(), fields.end());
    std::vector<std::uint8_t> wire(KZ_FRAME_MAX);
    wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
    mcu->take_transmitted();
    return send(*mcu, wire);
  }
  std::optional<Answer> answer(States longest) {
    std::vector<SerialByte> all;
    for (const States end = mcu->now() + longest; mcu->now() < end;) {
      run(kMs);
      for (const SerialByte& byte : mcu->take_transmitted()) all.push_back(byte);
      const auto bodies = bodies_of(all);
      if (bodies.empty()) continue;
      const auto& body = bodies.front();
      return Answer{body[0], body[1], {body.begin() + KZ_HEADER_SIZE, body.end()}, all.front().at};
    }
    return std::nullopt;
  }
  std::optional<Answer> query(std::uint8_t type, const std::vector<std::uint8_t>& fields,
                              States longest = 50 * kMs) {
    put(type, fields);
    return answer(longest);
  }
  // The reason of a refusal, 0 if it was done, -1 without a reply.
  int outcome(std::uint8_t type, const std::vector<std::uint8_t>& fields,
              States longest = 50 * kMs) {
    const auto got = query(type, fields, longest);
    if (!got) return -1;
    if (got->type == (type | KZ_REPLY)) return 0;
    kz_refused refused{};
    kz_unpack_refused(&refused, got->fields.data(), static_cast<u8>(got->fields.size()));
    return refused.reason;
  }
  static std::vector<std::uint8_t> key() { return {KZ_KEY >> 8, KZ_KEY & 0xFF}; }

  int calibrate(int offset) {
    kz_calibrate request{};
    request.mask = KZ_ALL_JOINTS;
    for (int j = 0; j < KZ_JOINTS; ++j) {
      request.centre[j] = static_cast<s16>(kz_board_joints[j].pot_centre + offset - j);
      request.scale[j] = static_cast<s16>(kz_board_joints[j].pot_scale + 2 * offset + j);
    }
    std::vector<std::uint8_t> fields(KZ_SIZE_calibrate);
    fields.resize(kz_pack_calibrate(&request, fields.data()));
    return outcome(KZ_TYPE_calibrate, fields);
  }
  kz_calibration_reply calibration() {
    kz_calibration_reply reply{};
    const auto got = query(KZ_TYPE_calibration, {});
    EXPECT_TRUE(got);
    if (!got) return reply;
    EXPECT_TRUE(kz_unpack_calibration_reply(&reply, got->fields.data(),
                                            static_cast<u8>(got->fields.size())));
    return reply;
  }
  // The offset in use for every joint; nullopt if they differ.
  std::optional<int> offset_in_use() {
    const kz_calibration_reply reply = calibration();
    if (reply.source == KZ_CALIBRATION_NOMINAL) return 0;
    const int offset = reply.centre[0] - kz_board_joints[0].pot_centre;
    for (int j = 0; j < KZ_JOINTS; ++j) {
      if (reply.centre[j] != kz_board_joints[j].pot_centre + offset - j ||
          reply.scale[j] != kz_board_joints[j].pot_scale + 2 * offset + j)
        return std::nullopt;
    }
    return offset;
  }
  kz_identify_reply identity() {
    kz_identify_reply reply{};
    const auto got = query(KZ_TYPE_identify, {});
    EXPECT_TRUE(got);
    if (!got) return reply;
    EXPECT_TRUE(
        kz_unpack_identify_reply(&reply, got->fields.data(), static_cast<u8>(got->fields.size())));
    return reply;
  }

  std::unique_ptr<Mcu> mcu;
  std::uint8_t sequence = 0, address = KZ_ADDRESS_DEFAULT;
};

TEST_P(Remember, CalibrationOutlivesThePower) {
  EXPECT_EQ(calibration().source, KZ_CALIBRATION_NOMINAL);
  EXPECT_TRUE(calibration().status & KZ_STATUS_UNCALIBRATED);
  ASSERT_EQ(calibrate(100), 0);
  const States sent = put(KZ_TYPE_store_calibration, {});
  const auto got = answer(3000 * kMs);
  ASSERT_TRUE(got);
  ASSERT_EQ(got->type, KZ_TYPE_store_calibration_reply);
  std::printf("%s: answer to store_calibration %.1f ms after the request\n", to_string(GetParam()),
              static_cast<double>(got->first - sent) / static_cast<double>(kMs));
  EXPECT_LT(got->first - sent, 3000 * kMs);
  kz_store_calibration_reply reply{};
  ASSERT_TRUE(kz_unpack_store_calibration_reply(&reply, got->fields.data(),
                                                static_cast<u8>(got->fields.size())));
  EXPECT_EQ(reply.sequence, 1);
  EXPECT_EQ(reply.erases_a, 0);
  EXPECT_EQ(reply.erases_b, 0);
  EXPECT_FALSE(reply.status & KZ_STATUS_MISSED_TICK);
  EXPECT_FALSE(reply.status & KZ_STATUS_UNCALIBRATED);

  mcu->power_cycle();
  run(100 * kMs);
  EXPECT_EQ(calibration().source, KZ_CALIBRATION_A);
  EXPECT_EQ(calibration().sequence, 1);
  EXPECT_EQ(offset_in_use(), 100);
}

TEST_P(Remember, WearIsReported) {
  for (int i = 1; i <= 22; ++i) {
    ASSERT_EQ(calibrate(i), 0);
    ASSERT_EQ(outcome(KZ_TYPE_store_calibration, {}, 3000 * kMs), 0);
  }
  const kz_calibration_reply reply = calibration();
  EXPECT_EQ(reply.sequence, 22);
  EXPECT_EQ(reply.erases_a, 1);
  EXPECT_EQ(reply.erases_b, 1);
  EXPECT_FALSE(reply.status & KZ_STATUS_MISSED_TICK);
}

TEST_P(Remember, NothingIsStoredWhileAMotorIsOn) {
  const auto before = mcu->memory();
  const kz_enable request{1};
  std::vector<std::uint8_t> fields(KZ_SIZE_enable);
  kz_pack_enable(&request, fields.data());
  ASSERT_EQ(outcome(KZ_TYPE_enable, fields), 0);
  EXPECT_EQ(outcome(KZ_TYPE_store_calibration, {}), KZ_REFUSED_ARMED);
  EXPECT_EQ(outcome(KZ_TYPE_reset, key()), KZ_REFUSED_ARMED);
  EXPECT_EQ(outcome(KZ_TYPE_loader, key()), KZ_REFUSED_ARMED);
  EXPECT_EQ(mcu->memory(), before);
}

TEST_P(Remember, BytesThatCameMeanwhileAreLostAndTheNextFrameIsHeard) {
  ASSERT_EQ(calibrate(5), 0);
  put(KZ_TYPE_store_calibration, {});
  run(2 * kMs);  // the write is in progress
  send(*mcu, frame_of(KZ_TYPE_heartbeat, 200, {0, 0}));
  const auto got = answer(3000 * kMs);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->type, KZ_TYPE_store_calibration_reply);
  const auto statistics_reply = query(KZ_TYPE_statistics, {});
  ASSERT_TRUE(statistics_reply);
  ASSERT_EQ(statistics_reply->type, KZ_TYPE_statistics_reply);
  kz_statistics_reply statistics{};
  ASSERT_TRUE(kz_unpack_statistics_reply(&statistics, statistics_reply->fields.data(),
                                         static_cast<u8>(statistics_reply->fields.size())));
  EXPECT_EQ(statistics.missed_ticks, 0);
  EXPECT_EQ(statistics.overruns, 1);
}

TEST_P(Remember, ResetAnswersFirstAndIsReportedAfterwards) {
  ASSERT_EQ(outcome(KZ_TYPE_reset, key()), 0);
  run(100 * kMs);
  const kz_identify_reply reply = identity();
  EXPECT_EQ(reply.reset_cause, KZ_RESET_COMMAND);
  EXPECT_LT(reply.tick, 120u);
  mcu->reset();
  run(100 * kMs);
  EXPECT_EQ(identity().reset_cause, KZ_RESET_POWER);
}

TEST_P(Remember, LoaderGoesAndComesBack) {
  ASSERT_EQ(outcome(KZ_TYPE_loader, key()), 0);
  run((KZ_LOADER_S * 1000 - 100) * kMs);
  EXPECT_FALSE(query(KZ_TYPE_identify, {}));
  run(250 * kMs);
  EXPECT_EQ(identity().reset_cause, KZ_RESET_COMMAND);
}

TEST_P(Remember, AddressIsInForceAfterAReset) {
  const std::vector<std::uint8_t> seven{7, 0};
  EXPECT_EQ(outcome(KZ_TYPE_set_address, seven), KZ_REFUSED_LOCKED);
  auto unlock = key();
  unlock.push_back(10);
  ASSERT_EQ(outcome(KZ_TYPE_unlock, unlock), 0);
  ASSERT_EQ(outcome(KZ_TYPE_set_address, seven, 3000 * kMs), 0);
  EXPECT_EQ(outcome(KZ_TYPE_heartbeat, {0, 0}), 0) << "not before the reset";
  mcu->power_cycle();
  run(100 * kMs);
  EXPECT_EQ(outcome(KZ_TYPE_heartbeat, {0, 0}), -1);
  address = 7;
  EXPECT_EQ(outcome(KZ_TYPE_heartbeat, {0, 0}), 0);
}

TEST_P(Remember, PowerLostWhileStoringLeavesTheOldOrTheNewCopy) {
  Random random(5);
  int kept = 0, stored = 0, lost = 0;
  for (int i = 1; i <= 40; ++i) {
    ASSERT_EQ(calibrate(i), 0);
    const States sent = put(KZ_TYPE_store_calibration, {});
    ASSERT_TRUE(mcu->run_until(sent + random.below(static_cast<std::uint32_t>(12 * kMs))));
    mcu->power_cycle();
    run(100 * kMs);
    const auto now = offset_in_use();
    ASSERT_TRUE(now == kept || now == i) << "cut " << i;
    ++(*now == i ? stored : lost);
    kept = *now;
  }
  EXPECT_GT(stored, 5);
  EXPECT_GT(lost, 5);
}

INSTANTIATE_TEST_SUITE_P(Engines, Remember, testing::ValuesIn(kMcuKinds),
                         [](const auto& mcu) { return to_string(mcu.param); });

}  // namespace
}  // namespace kaz::sim

// Calibration: set in RAM within its tolerance, used at once, stored by an action.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>

#include "shared/servo/board_testing.h"

namespace kaz::test {
namespace {

kz_calibrate nominal(u32 mask) {
  kz_calibrate request = {};
  request.mask = mask;
  for (int i = 0; i < KZ_JOINTS; ++i) {
    if (!(mask >> i & 1)) continue;
    request.centre[i] = kz_board_joints[i].pot_centre;
    request.scale[i] = kz_board_joints[i].pot_scale;
  }
  return request;
}

TEST(Calibrate, IsUsedAtOnceAndReadBack) {
  TestBoard board;
  board.set_pot(6, 800);
  board.ticks(50);
  kz_calibrate request = nominal(1u << 0 | 1u << 6);
  request.centre[0] = 1234;
  request.scale[6] = static_cast<s16>(kz_board_joints[6].pot_scale + 2000);
  ASSERT_EQ(board.calibrate(request), 0);
  board.tick();
  EXPECT_EQ(board.servo.joint[0].angle, 1234);
  const kz_board_joint changed = {kz_board_joints[6].pot_centre, request.scale[6], 0, 0, 0, 0};
  EXPECT_EQ(board.servo.joint[6].angle, kz_pot_angle(&changed, 800));
  EXPECT_EQ(board.servo.joint[6].rate, 0);  // the step is no motion
  const kz_calibration_reply now = board.calibration();
  for (int i = 0; i < KZ_JOINTS; ++i) {
    EXPECT_EQ(now.centre[i], i == 0 ? 1234 : kz_board_joints[i].pot_centre);
    EXPECT_EQ(now.scale[i], i == 6 ? request.scale[6] : kz_board_joints[i].pot_scale);
  }
  EXPECT_EQ(board.enable(1), 0);
}

TEST(Calibrate, TakesAllJointsInOneFrame) {
  TestBoard board;
  kz_calibrate request = nominal(KZ_ALL_JOINTS);
  for (int i = 0; i < KZ_JOINTS; ++i) request.centre[i] = static_cast<s16>(request.centre[i] + i);
  ASSERT_EQ(board.calibrate(request), 0);
  const kz_calibration_reply now = board.calibration();
  for (int i = 0; i < KZ_JOINTS; ++i) EXPECT_EQ(now.centre[i], kz_board_joints[i].pot_centre + i);
}

TEST(Calibrate, RefusesWhatIsFarFromNominalAsAWhole) {
  TestBoard board;
  for (int joint = 0; joint < KZ_JOINTS; ++joint) {
    const int centre = kz_board_joints[joint].pot_centre, scale = kz_board_joints[joint].pot_scale;
    for (const int sign : {-1, 1}) {
      kz_calibrate request = nominal(1u << joint | 1);
      request.centre[joint] = static_cast<s16>(centre + sign * KZ_CENTRE_TOLERANCE);
      EXPECT_EQ(board.calibrate(request), 0);
      request.centre[joint] = static_cast<s16>(centre + sign * (KZ_CENTRE_TOLERANCE + 1));
      EXPECT_EQ(board.calibrate(request), KZ_REFUSED_RANGE);
      EXPECT_EQ(board.detail, joint);
      request = nominal(1u << joint | 1);
      request.scale[joint] = static_cast<s16>(scale + sign * std::abs(scale) / 4);
      EXPECT_EQ(board.calibrate(request), 0);
      request.scale[joint] = static_cast<s16>(scale + sign * (std::abs(scale) / 4 + 1));
      EXPECT_EQ(board.calibrate(request), KZ_REFUSED_RANGE);
      EXPECT_EQ(board.detail, joint);
      request.scale[joint] = sign > 0 ? s16{32767} : s16{-32768};
      EXPECT_EQ(board.calibrate(request), KZ_REFUSED_RANGE);
    }
    ASSERT_EQ(board.calibrate(nominal(1u << joint)), 0);
  }
  const kz_calibration_reply now = board.calibration();
  for (int i = 0; i < KZ_JOINTS; ++i) EXPECT_EQ(now.centre[i], kz_board_joints[i].pot_centre);
}

TEST(Calibrate, IsRefusedWhileAMotorIsOnOrTheFrameIsWrong) {
  TestBoard board;
  EXPECT_EQ(board.outcome(KZ_TYPE_calibrate, {0, 0, 0}), KZ_REFUSED_LENGTH);
  EXPECT_EQ(board.outcome(KZ_TYPE_calibrate, {0, 0, 0, 1, 0, 0}), KZ_REFUSED_LENGTH);
  EXPECT_EQ(board.outcome(KZ_TYPE_calibrate, {0, 4, 0, 0}), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.detail, 0);
  ASSERT_EQ(board.enable(2), 0);
  EXPECT_EQ(board.calibrate(nominal(1)), KZ_REFUSED_ARMED);
}

TEST(StoreCalibration, IsAnsweredWhenItIsStored) {
  kz_startup startup = TestBoard::valid_startup();
  startup.calibration = KZ_CALIBRATION_NOMINAL;
  TestBoard board(startup);
  ASSERT_EQ(board.status(), KZ_STATUS_UNCALIBRATED);
  board.replies.clear();
  board.send(KZ_TYPE_state, 50, {});
  board.send(KZ_TYPE_store_calibration, 51, {});
  while (board.actions.empty() && board.input.tick < 100) board.tick();
  ASSERT_EQ(board.replies.size(), 1u);  // state, not yet the other
  EXPECT_EQ(board.output.action, KZ_ACTION_STORE_CALIBRATION);
  board.input.missed = 40;
  board.input.calibration_sequence = 8;
  board.input.erases_b = 3;
  board.tick();
  board.input.missed = 0;
  board.ticks(5);
  ASSERT_EQ(board.replies.size(), 2u);
  ASSERT_EQ(board.replies[1].type, KZ_TYPE_store_calibration_reply);
  const auto stored =
      fields_of<kz_store_calibration_reply, kz_unpack_store_calibration_reply>(board.replies[1]);
  EXPECT_EQ(stored.sequence, 8);
  EXPECT_EQ(stored.erases_a, 0);
  EXPECT_EQ(stored.erases_b, 3);
  EXPECT_EQ(stored.status, 0);  // calibrated, and no missed tick
  EXPECT_EQ(board.actions.size(), 1u);
  // Once more the same request: the reply alone.
  board.send(KZ_TYPE_store_calibration, 51, {});
  board.ticks(10);
  EXPECT_EQ(board.replies.size(), 3u);
  EXPECT_EQ(board.actions.size(), 1u);
}

TEST(StoreCalibration, AFailedWriteIsReported) {
  TestBoard board;
  board.action_result = KZ_RESULT_FAILED;
  EXPECT_EQ(board.outcome(KZ_TYPE_store_calibration, {}), KZ_REFUSED_STORE);
  EXPECT_EQ(board.statistics().refusals, 1);
}

TEST(StoreCalibration, IsRefusedWhileAMotorIsOn) {
  TestBoard board;
  ASSERT_EQ(board.enable(1), 0);
  EXPECT_EQ(board.outcome(KZ_TYPE_store_calibration, {}), KZ_REFUSED_ARMED);
  EXPECT_TRUE(board.actions.empty());
}

TEST(StoreCalibration, OthersAreTurnedAwayUntilItIsDoneButNotStop) {
  TestBoard board;
  board.input.tx_room = KZ_TX_BUFFER - 1;
  board.send(KZ_TYPE_store_calibration, 1, {});
  board.send(KZ_TYPE_enable, 2, {0, 0, 0, 1});
  board.send(KZ_TYPE_stop, 3, {});
  board.ticks(10);
  EXPECT_TRUE(board.replies.empty());
  EXPECT_EQ(board.servo.enabled, 0u);
  EXPECT_EQ(board.servo.shutdown, KZ_SHUTDOWN_STOP);
  board.input.tx_room = KZ_TX_BUFFER;
  board.ticks(20);
  ASSERT_EQ(board.replies.size(), 3u);
  EXPECT_EQ(board.replies[0].type, KZ_TYPE_store_calibration_reply);
  EXPECT_EQ(board.replies[1].type, KZ_TYPE_stop_reply);
  EXPECT_EQ(board.replies[2].type, KZ_TYPE_refused);
}

TEST(StoreCalibration, TelemetryGivesWay) {
  TestBoard board;
  ASSERT_EQ(board.telemetry(5, 15), 0);
  board.ticks(20);
  EXPECT_EQ(board.outcome(KZ_TYPE_heartbeat, {0, 0}), 0);
  board.replies.clear();
  board.send(KZ_TYPE_store_calibration, 77, {});
  board.ticks(20);
  EXPECT_EQ(board.actions.size(), 1u);
}

}  // namespace
}  // namespace kaz::test

// Contents of each reply.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "shared/servo/board_testing.h"

namespace kaz::test {
namespace {

constexpr int kNeckPan = 0, kRShPitch = 6, kLHand = 5;

TEST(Replies, HealthReportsWhatIsMeasured) {
  TestBoard board;
  board.input.analog[KZ_ANALOG_SUPPLY] = 600;
  board.input.analog[KZ_ANALOG_TEMPERATURE] = 312;
  board.input.analog[KZ_ANALOG_REFERENCE] = 510;
  board.ticks(4);
  board.input.analog[KZ_ANALOG_SUPPLY] = 700;
  board.ticks(4);
  const kz_health_reply health = board.health();
  EXPECT_EQ(health.supply_mv, 10500);
  EXPECT_EQ(health.supply_lowest_mv, 9000);
  EXPECT_EQ(health.temperature_dc, 312);
  EXPECT_EQ(health.reference, 510);
  EXPECT_EQ(health.detail, 255);
  EXPECT_EQ(health.shutdown_tick, 0u);
  EXPECT_EQ(health.status, 0);
}

TEST(Replies, SelfTestReportsWhatTheStartFound) {
  kz_startup startup = TestBoard::valid_startup();
  startup.tests_done = KZ_TEST_RAM | KZ_TEST_FLASH | KZ_TEST_CONVERTER;
  startup.start_8states = 12345;
  TestBoard board(startup);
  const kz_self_test_reply test = board.self_test();
  EXPECT_EQ(test.done, 7);
  EXPECT_EQ(test.failed, 0);
  EXPECT_EQ(test.image_crc, TestBoard::kImageCrc);
  EXPECT_EQ(test.start_8states, 12345);
}

TEST(Replies, ReadTargetsReportsTargetsAndAnglesOfWhatIsOff) {
  TestBoard board;
  board.set_pot(1, 555);
  ASSERT_EQ(board.enable(0b1), 0);
  ASSERT_EQ(board.target(kNeckPan, 4321, 5000), 0);
  const kz_read_targets_reply reply = board.read_targets(0b11);
  EXPECT_EQ(reply.mask, 0b11u);
  EXPECT_EQ(reply.angle[0], 4321);
  EXPECT_EQ(reply.angle[1], kz_pot_angle(&kz_board_joints[1], 555));
  EXPECT_EQ(board.outcome(KZ_TYPE_read_targets, {0, 4, 0, 0}), KZ_REFUSED_RANGE);
}

TEST(Replies, ReadTargetsOfAJointJustSwitchedOnIsItsAngle) {
  TestBoard board;
  board.set_pot(kNeckPan, 600);
  ASSERT_EQ(board.enable(1), 0);
  EXPECT_EQ(board.read_targets(1).angle[0], kz_pot_angle(&kz_board_joints[0], 600));
}

TEST(Replies, JointsReportsAngleSpeedAndDrive) {
  TestBoard board;
  const u32 mask = 1u << kNeckPan | 1u << kRShPitch | 1u << 17;
  ASSERT_EQ(board.enable(mask), 0);
  for (const int joint : {kNeckPan, kRShPitch}) {
    // One code a millisecond: 3.238 rad/s. The neck goes up, the shoulder's angle down.
    for (u16 i = 0; i < 60; ++i) {
      board.set_pot(joint, static_cast<u16>(512 + i));
      board.tick();
    }
    const kz_joints_reply reply = board.joints(mask);
    EXPECT_EQ(reply.mask, mask);
    const bool mirrored = joint == kRShPitch;
    // The pot stands still for the milliseconds that the request takes, so the speed is less.
    EXPECT_GT(mirrored ? -reply.speed[joint] : reply.speed[joint], 1500);
    EXPECT_LT(mirrored ? -reply.speed[joint] : reply.speed[joint], 3300);
    EXPECT_EQ(reply.angle[joint], board.servo.joint[joint].angle);
    // Back to where it was switched on: against the motion.
    EXPECT_LT(mirrored ? -reply.duty[joint] : reply.duty[joint], -100);
    EXPECT_EQ(reply.faults[joint] & KZ_JOINT_ON, KZ_JOINT_ON);
  }
}

TEST(Replies, JointsReportsFlags) {
  TestBoard board;
  ASSERT_EQ(board.enable(0b1), 0);
  ASSERT_EQ(board.target(kNeckPan, 5000, 2000), 0);
  board.set_pot(1, 2);
  board.set_pot(kLHand, 1019);  // beyond what the hand's mechanics allow
  const kz_joints_reply reply = board.joints(0b100111);
  EXPECT_EQ(reply.faults[0], KZ_JOINT_ON | KZ_JOINT_MOVING);
  EXPECT_EQ(reply.faults[1], KZ_JOINT_POT);
  EXPECT_EQ(reply.faults[2], 0);
  EXPECT_EQ(reply.faults[kLHand], KZ_JOINT_AT_LIMIT);
}

TEST(Replies, JointsTakesNineAndNoMore) {
  TestBoard board;
  EXPECT_EQ(board.joints(0b111111111).mask, 0b111111111u);
  EXPECT_EQ(board.joints(0x3FE00).mask, 0x3FE00u);
  EXPECT_EQ(board.outcome(KZ_TYPE_joints, {0, 0, 0x03, 0xFF}), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.detail, 0);
  EXPECT_EQ(board.outcome(KZ_TYPE_joints, {0, 4, 0, 0}), KZ_REFUSED_RANGE);
}

TEST(Replies, SettingsReportsWhatIsInForceAfterAReset) {
  TestBoard board;
  const kz_settings_reply neck = board.settings(kNeckPan), hand = board.settings(kLHand);
  EXPECT_EQ(neck.joint, kNeckPan);
  EXPECT_NEAR(neck.kp, KZ_KP_DEFAULT, 2);
  EXPECT_NEAR(neck.kd, KZ_KD_DEFAULT, 3);
  EXPECT_EQ(neck.dead_band, 0);
  EXPECT_EQ(neck.friction, 0);
  EXPECT_EQ(neck.ramp, KZ_RAMP_DEFAULT);
  EXPECT_EQ(neck.lower, kz_board_joints[kNeckPan].lower);
  EXPECT_EQ(neck.upper, kz_board_joints[kNeckPan].upper);
  EXPECT_EQ(hand.joint, kLHand);
  EXPECT_NEAR(hand.kp, KZ_KP_HAND, 2);
  EXPECT_EQ(board.outcome(KZ_TYPE_settings, {18}), KZ_REFUSED_RANGE);
  EXPECT_EQ(board.detail, 0);
}

TEST(Replies, CalibrationReportsValuesSourceAndWear) {
  kz_startup startup = TestBoard::valid_startup();
  startup.calibration = KZ_CALIBRATION_B;
  startup.pot_centre[3] = 777;
  startup.pot_scale[17] = -15000;
  TestBoard board(startup);
  board.input.calibration_sequence = 500;
  board.input.erases_a = 7;
  board.input.erases_b = 9;
  const kz_calibration_reply reply = board.calibration();
  EXPECT_EQ(reply.source, KZ_CALIBRATION_B);
  EXPECT_EQ(reply.sequence, 500);
  EXPECT_EQ(reply.erases_a, 7);
  EXPECT_EQ(reply.erases_b, 9);
  for (int i = 0; i < KZ_JOINTS; ++i) {
    EXPECT_EQ(reply.centre[i], startup.pot_centre[i]);
    EXPECT_EQ(reply.scale[i], startup.pot_scale[i]);
  }
  EXPECT_EQ(reply.status, 0);
}

TEST(Replies, WithoutAStoredCalibrationTheStatusSaysSo) {
  kz_startup startup = TestBoard::valid_startup();
  startup.calibration = KZ_CALIBRATION_NOMINAL;
  TestBoard board(startup);
  EXPECT_EQ(board.status(), KZ_STATUS_UNCALIBRATED);
}

}  // namespace
}  // namespace kaz::test

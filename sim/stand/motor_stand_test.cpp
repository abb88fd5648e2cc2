// The stand against the motor's characteristic line, and its tools.
// SPDX-License-Identifier: Apache-2.0
#include "sim/stand/motor_stand.h"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/angle.hpp"
#include "sim/body/motor/motor_testing.h"
#include "sim/stand/stand_commands.h"

namespace kaz::sim {
namespace {

constexpr std::size_t kJoint = 2;  // l_sh_pitch: -140 to 40 degrees

MotorStand stand_of_kaz() {
  return MotorStand({.motor = test::motor_params()});
}

void run(MotorStand& stand, int ms, double duty = 0, bool powered = false, double volts = 10) {
  std::vector<MotorDrive> drives(KZ_JOINTS);
  drives[kJoint] = {.duty = duty, .powered = powered};
  for (int i = 0; i < ms; ++i) stand.step(drives, volts);
}

double angle(const MotorStand& stand) {
  return stand.joints()[kJoint].angle;
}

TEST(MotorStand, RunsAtItsMotorsSpeedWithoutLoad) {
  MotorStand stand = stand_of_kaz();
  const MotorParams& motor = stand.motor();
  stand.turn(kJoint, -2.2);
  run(stand, 1500);
  stand.release(kJoint);
  run(stand, 60, 1, true);
  const double from = angle(stand);
  run(stand, 50, 1, true);
  const double speed = (angle(stand) - from) / 0.05;
  const double line =
      (motor.stall_slope_nm_per_v * 10 - motor.friction_nm) / motor.back_emf_nms_per_rad;
  EXPECT_NEAR(speed, line, 0.005 * line);
}

TEST(MotorStand, ClampAndScaleReadTheTorqueAtStandstill) {
  for (const double duty : {1.0, -1.0, 0.4}) {
    MotorStand stand = stand_of_kaz();
    const MotorParams& motor = stand.motor();
    EXPECT_EQ(stand.scale_nm(kJoint), 0);
    stand.clamp(kJoint, true);
    const double before = angle(stand);
    run(stand, 100, duty, true);
    EXPECT_EQ(angle(stand), before);
    const double torque =
        std::copysign(motor.stall_slope_nm_per_v * 10 * std::abs(duty) - motor.friction_nm, duty);
    const double reading = stand.scale_nm(kJoint);
    EXPECT_NEAR(reading, torque, 0.01 + 0.004 * std::abs(torque)) << "noise of 2 mNm; first heat";
    run(stand, 500);
    EXPECT_EQ(stand.scale_nm(kJoint), reading) << "the scale holds it";
    stand.clamp(kJoint, true);
    EXPECT_EQ(stand.scale_nm(kJoint), 0);
  }
}

// What a bench that was killed has left on the shafts.
TEST(MotorStand, FreesEveryShaft) {
  MotorStand stand = stand_of_kaz();
  stand.clamp(kJoint, true);
  stand.press(3, 0.2);
  stand.turn(4, 0.5);
  EXPECT_EQ(stand.free_all(), 3);
  EXPECT_EQ(stand.free_all(), 0);
  const double before = angle(stand);
  run(stand, 100, 0.4, true);
  EXPECT_NE(angle(stand), before);
}

TEST(MotorStand, CloneGoesOnAsTheOriginal) {
  MotorStand stand = stand_of_kaz();
  stand.press(kJoint, 0.1);
  run(stand, 100, 0.4, true);
  const auto clone = stand.clone();
  ASSERT_TRUE(clone) << clone.error().message;
  auto& other = dynamic_cast<MotorStand&>(**clone);
  run(stand, 200, -0.4, true);
  EXPECT_NE(angle(other), angle(stand));
  run(other, 200, -0.4, true);
  EXPECT_EQ(angle(other), angle(stand));
}

TEST(MotorStand, ScaleReadsEachPressALittleOtherwise) {
  MotorStand stand = stand_of_kaz();
  stand.clamp(kJoint, true);
  double min = 1e9, max = -1e9;
  for (int press = 0; press < 10; ++press) {
    run(stand, 100, 0.3, true);
    min = std::min(min, stand.scale_nm(kJoint));
    max = std::max(max, stand.scale_nm(kJoint));
    run(stand, 100);
  }
  EXPECT_GT(max - min, 0.002) << "sigma 2 mNm";
  EXPECT_LT(max - min, 0.02);
}

TEST(MotorStand, GentleWeightsShowTheBacklashAndNothingElse) {
  MotorStand stand = stand_of_kaz();
  double ends[2];
  for (int round = 0; round < 3; ++round) {
    for (const int side : {0, 1}) {
      stand.press(kJoint, side ? 0.03 : -0.03);
      run(stand, 500);
      ends[side] = angle(stand);
    }
    EXPECT_NEAR(ends[1] - ends[0], stand.motor().backlash_rad, 0.01 * stand.motor().backlash_rad);
  }
  stand.press(kJoint, 0);
  run(stand, 100);
  EXPECT_NEAR(angle(stand), ends[1], 1e-4);
}

TEST(MotorStand, AHeavyWeightTurnsTheMotor) {
  MotorStand stand = stand_of_kaz();
  stand.press(kJoint, 0.3);
  run(stand, 500);
  EXPECT_GT(angle(stand), 3 * stand.motor().backlash_rad);
}

TEST(MotorStand, HandTurnsAndLetsGo) {
  MotorStand stand = stand_of_kaz();
  for (const double goal : {-1.5, 0.3, 0.31, -2.0}) {
    stand.turn(kJoint, goal);
    run(stand, 2500);
    // The motor's friction bends the hand by 0.166 Nm / 60 Nm/rad.
    EXPECT_NEAR(angle(stand), goal, 3.5e-3);
    EXPECT_NEAR(stand.protractor_rad(kJoint), angle(stand), 0.00501 * kDegree);
    stand.release(kJoint);
    const double there = angle(stand);
    run(stand, 500);
    // It may fall back through the gap, and press the other flank as it comes.
    EXPECT_NEAR(angle(stand), there, stand.motor().backlash_rad + 5e-4);
  }
}

TEST(MotorStand, ShaftsHaveTheServosStops) {
  MotorStand stand = stand_of_kaz();
  run(stand, 1000, 1, true);
  EXPECT_NEAR(angle(stand), 41 * kDegree, 1e-3);
  EXPECT_EQ(stand.joints()[kJoint].velocity, 0);
  EXPECT_EQ(stand.joints()[kJoint + 1].angle, 0) << "its neighbour was not driven";
}

TEST(MotorStand, GoesOnFromWhatWasSaved) {
  MotorStand one = stand_of_kaz();
  one.clamp(kJoint, true);
  one.press(kJoint + 1, 0.02);
  run(one, 37, 0.7, true);
  StateWriter to;
  one.save(to);
  MotorStand other = stand_of_kaz();
  StateReader from(to.bytes());
  other.restore(from);
  ASSERT_TRUE(from.good());
  for (MotorStand* stand : {&one, &other}) {
    run(*stand, 20, -0.4, true);
    stand->clamp(kJoint, false);
    run(*stand, 50, -0.4, true);
  }
  EXPECT_EQ(angle(one), angle(other));
  EXPECT_EQ(one.joints()[kJoint].winding_celsius, other.joints()[kJoint].winding_celsius);
}

TEST(StandCommands, AreCheckedWordByWord) {
  const auto simulation = make_stand({}, {.motor = test::motor_params()});
  ASSERT_TRUE(simulation) << simulation.error().message;
  const auto refused = [&](const std::string& line) {
    const auto answer = answer_stand(**simulation, line);
    return answer ? "done: " + line : answer.error().message;
  };
  EXPECT_EQ(refused("lift l_hand"), "there is no command `stand lift`; `stand help` lists them");
  EXPECT_EQ(refused(""), "there is no command `stand`; `stand help` lists them");
  EXPECT_EQ(refused("clamp l_hand"), "`stand clamp` takes 2 words, got 1");
  EXPECT_EQ(refused("clamp l_foot on"),
            "there is no joint `l_foot`; docs/reference/robot.md lists the joints");
  EXPECT_EQ(refused("clamp l_hand in"), "`clamp` takes a joint and on or off, got `in`");
  EXPECT_EQ(refused("supply 99"), "the supply in V must be 0 to 15, got `99`");
  EXPECT_EQ(refused("press l_hand nan"), "a weight's torque in Nm must be -1 to 1, got `nan`");
  EXPECT_EQ(refused("turn l_hand 1e9"), "an angle in rad must be -4 to 4, got `1e9`");
}

TEST(StandCommands, DoWhatTheySay) {
  const auto made = make_stand({}, {.motor = test::motor_params()});
  ASSERT_TRUE(made) << made.error().message;
  Simulation& simulation = **made;
  const auto query = [&](const std::string& line) {
    const auto answer = answer_stand(simulation, line);
    EXPECT_TRUE(answer) << answer.error().message;
    return answer.value_or(nlohmann::ordered_json());
  };
  EXPECT_EQ(query("disc")["disc_kgm2"], 4e-4);
  const auto help = query("help")["commands"];
  EXPECT_EQ(help.size(), 9u);
  EXPECT_EQ(help["supply V"], "set the supply's voltage without load, 0 to 15 V");
  EXPECT_EQ(help["press JOINT NM"], "put a weight on the shaft, -1 to 1 Nm; 0 removes it");
  EXPECT_EQ(help["turn JOINT RAD"],
            "turn the shaft by hand to this angle, -4 to 4 rad, and hold it");
  query("supply 6.5");
  EXPECT_NEAR(simulation.board().supply_volts(), 6.5, 1e-9);
  query("turn l_elbow -0.5");
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(simulation.step());
  EXPECT_NEAR(query("protractor l_elbow")["angle_rad"], -0.5, 3.5e-3);
  query("let l_elbow");
  query("press l_elbow 0.03");
  query("clamp l_elbow on");
  EXPECT_EQ(query("scale l_elbow")["torque_nm"], 0);
}

// What a bench that was killed may have left.
TEST(StandCommands, FreeAlsoSetsTheSupplyAsAtTheBeginning) {
  for (const double volts : {10.0, 7.4}) {
    SimulationOptions options;
    options.supply_volts = volts;
    const auto made = make_stand(options, {.motor = test::motor_params()});
    ASSERT_TRUE(made) << made.error().message;
    Simulation& simulation = **made;
    ASSERT_TRUE(answer_stand(simulation, "supply 5"));
    ASSERT_TRUE(answer_stand(simulation, "clamp l_elbow on"));
    const auto freed = answer_stand(simulation, "free");
    ASSERT_TRUE(freed) << freed.error().message;
    EXPECT_EQ((*freed)["freed"], 1);
    EXPECT_EQ((*freed)["supply_v"], volts);
    EXPECT_NEAR(simulation.board().supply_volts(), volts, 1e-9);
  }
}

}  // namespace
}  // namespace kaz::sim

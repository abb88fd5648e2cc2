// What a log of a servo may hold.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/servo_log.h"

#include <gtest/gtest.h>

namespace kaz::hil {
namespace {

const std::string kHead =
    "# mass_kg 0.5\n# length_m 0.2\n# gain_per_rad 5\n"
    "time_s,goal_rad,position_rad,volts\n";
const std::string kRows = "0,0,0,5\n0.4,0.1,0,5\n0.8,0.1,0.1,5\n1.2,0.1,0.1,5\n";

std::string error_of(const std::string& text) {
  const auto log = parse_servo_log(text, "a.csv");
  return log ? "" : log.error().message;
}

TEST(ServoLogs, AreReadWithTheirUnitsAndDefaults) {
  const auto log = parse_servo_log("# of the 28th\n# arm_kg 0.03\n" + kHead + kRows, "a.csv");
  ASSERT_TRUE(log) << log.error().message;
  EXPECT_NEAR(log->load_kgm2(), 0.5 * 0.04 + 0.03 * 0.04 / 3, 1e-12);
  EXPECT_NEAR(log->gravity_nm(), (0.5 + 0.015) * 9.80665 * 0.2, 1e-12);
  EXPECT_EQ(log->most_duty, 1);
  EXPECT_FALSE(log->has_current);
  ASSERT_EQ(log->samples.size(), 4u);
  EXPECT_TRUE(log->samples[2].torque_on);
  EXPECT_EQ(log->samples[2].position_rad, 0.1);
  const auto again = parse_servo_log(servo_log_text(*log), "again");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->samples.size(), 4u);
  EXPECT_EQ(again->arm_kg, 0.03);
}

TEST(ServoLogs, WhatIsWrongIsNamedWithItsLine) {
  EXPECT_EQ(error_of(kHead + kRows), "");
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"", "the line `# mass_kg VALUE` is missing"},
      {kHead, "must cover at least 1 s"},
      {"# mass_kg -1\n" + kHead + kRows, "line 1: mass_kg is '-1': must be 0 to 100"},
      {"# mass_kg 1\n" + kHead + kRows, "line 2: mass_kg occurs twice"},
      {"# mass_kg 0\n# length_m 1\n# gain_per_rad 1\n" + kHead.substr(kHead.find("time")) + kRows,
       "length_m must be above 0, and mass_kg or arm_kg must be above 0"},
      {kHead + kRows + "1.1,0,0,5\n", "line 9: time_s must be greater than in the previous sample"},
      {kHead + kRows + "9,0,0,5\n", "line 9: time_s must be at most 0.5 s after"},
      {kHead + kRows + "1.3,0,0\n", "line 9: 3 fields: must be 4, one for each column"},
      {kHead + kRows + "1.3,0,x,5\n", "line 9: position_rad is 'x': must be -1000 to 1000"},
      {kHead + kRows + "1.3,0,nan,5\n", "line 9: position_rad is 'nan'"},
      {kHead + kRows + "1.3,0,1e9,5\n", "line 9: position_rad is '1e9'"},
      {"time_s,goal_rad,volts\n", "the column position_rad is missing"},
      {"time_s,time_s,goal_rad,position_rad,volts\n", "the column time_s occurs twice"},
      {"time_s,goal_rad,position_rad,volts,torque_on\n0,0,0,5,2\n", "torque_on must be 0 or 1"},
  };
  for (const auto& [text, part] : wrong)
    EXPECT_NE(error_of(text).find(part), std::string::npos) << part << ": " << error_of(text);
  const std::string long_value(5000, '\xb0');
  EXPECT_LT(error_of("# mass_kg " + long_value).size(), 200u);
  EXPECT_LT(error_of(kHead + "0," + long_value + ",0,5\n").size(), 200u);
}

TEST(ServoLogs, PreferInertiaAndGravityOfTheHeader) {
  const auto log = parse_servo_log(
      "# inertia_kgm2 0.03\n# gravity_nm 1.2\n# motion wave\n" + kHead + kRows, "a.csv");
  ASSERT_TRUE(log) << log.error().message;
  EXPECT_EQ(log->load_kgm2(), 0.03);
  EXPECT_EQ(log->gravity_nm(), 1.2);
  EXPECT_EQ(log->motion, "wave");
  EXPECT_EQ(log->rig(), "0.5 kg, 0.2 m");
  const auto again = parse_servo_log(servo_log_text(*log), "again");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->load_kgm2(), 0.03);
  EXPECT_EQ(again->motion, "wave");
  EXPECT_NE(error_of("# inertia_kgm2 0\n" + kHead + kRows).find("line 1: inertia_kgm2 is '0'"),
            std::string::npos);
}

TEST(ServoLogs, NameTheMotionByTheFile) {
  for (const auto& [file, motion] : std::vector<std::pair<std::string, std::string>>{
           {"logs/kp04_m0.535_l0.10_lift_and_drop_182851.csv", "lift_and_drop"},
           {"fit-p32-wave.csv", "wave"},
           {"2026-01-15.csv", "motion"}}) {
    const auto log = parse_servo_log(kHead + kRows, file);
    ASSERT_TRUE(log) << log.error().message;
    EXPECT_EQ(log->motion, motion);
  }
}

// Rows every 10 ms: the arm moves slowly, and the supply is 12 V.
std::string rows(const std::vector<std::pair<int, std::string>>& changed) {
  std::string text;
  for (int i = 0; i <= 150; ++i) {
    std::string row = std::to_string(0.01 * i) + ",0,0." + std::to_string(100 + i) + ",12\n";
    for (const auto& [at, other] : changed)
      if (at == i) row = std::to_string(0.01 * i) + "," + other + "\n";
    text += row;
  }
  return text;
}

TEST(ServoLogs, RepairImpossibleSamplesAndCountThem) {
  const auto log =
      parse_servo_log(kHead + rows({{40, "0,-3.14,12"}, {70, "0,0.17,25"}, {90, "0,0.19,0"}}), "a");
  ASSERT_TRUE(log) << log.error().message;
  EXPECT_EQ(log->repaired_positions, 1);
  EXPECT_EQ(log->repaired_volts, 2);
  EXPECT_NEAR(log->samples[40].position_rad, 0.14, 1e-9);
  EXPECT_EQ(log->samples[70].volts, 12);
  // The supply sags under load, and an arm falls fast: both are possible.
  const auto possible = parse_servo_log(
      kHead + rows({{40, "0,0.3,10"}, {41, "0,0.6,10"}, {42, "0,0.9,10"}, {43, "0,0.6,12"}}), "a");
  ASSERT_TRUE(possible) << possible.error().message;
  EXPECT_EQ(possible->repaired_positions + possible->repaired_volts, 0);
}

TEST(ServoLogs, LoseCurrentsWithoutSign) {
  std::string text = kHead.substr(0, kHead.size() - 1) + ",current_a\n";
  for (int i = 0; i < 20; ++i)
    text += std::to_string(0.1 * i) + (i < 10 ? ",0.2,0,5,0.3\n" : ",-0.2,0,5,0.3\n");
  std::string one_way = text;
  for (std::size_t at; (at = one_way.find(",-0.2")) != std::string::npos;) one_way.erase(at + 1, 1);
  std::string with_sign = text;
  with_sign.replace(with_sign.rfind(",0.3"), 4, ",-0.3");
  std::vector<ServoLog> logs;
  for (const std::string& one : {text, one_way, with_sign}) {
    auto log = parse_servo_log(one, "a");
    ASSERT_TRUE(log) << log.error().message;
    EXPECT_TRUE(log->has_current);
    logs.push_back(*log);
  }
  drop_unsigned_currents(logs);
  EXPECT_TRUE(logs[0].unsigned_current);
  EXPECT_TRUE(logs[1].unsigned_current) << "its currents only look right";
  EXPECT_TRUE(logs[2].has_current);
  std::vector<ServoLog> good = {logs[2]};
  drop_unsigned_currents(good);
  EXPECT_TRUE(good[0].has_current);
}

std::string bam(const std::string& head, const std::string& entries) {
  return R"({"mass": 0.49, "length": 0.1, "trajectory": "sin_sin", )" + head + R"("entries": [)" +
         entries + "]}";
}
const std::string kBamMotor = R"("kp": 400, "motor": "xl330", )";
const std::string kBamEntries =
    R"({"position": 0, "goal_position": 0.5, "input_volts": 7.4, "timestamp": 0},
       {"position": 0.1, "goal_position": 0.5, "input_volts": 7.4, "timestamp": 0.5},
       {"position": 0.2, "goal_position": 0.5, "input_volts": 7.4, "timestamp": 1,
        "torque_enable": false})";

TEST(BamLogs, AreReadAsTheyAre) {
  const auto log = parse_servo_log(bam(kBamMotor + R"("arm_mass": 0.02, )", kBamEntries), "a.json");
  ASSERT_TRUE(log) << log.error().message;
  EXPECT_EQ(log->mass_kg, 0.49);
  EXPECT_EQ(log->arm_kg, 0.02);
  EXPECT_EQ(log->motion, "sin_sin");
  EXPECT_NEAR(log->gain_per_rad, 1.151, 1e-3) << "a real XL330 shows 805 of 1000 at 0.70 rad";
  ASSERT_EQ(log->samples.size(), 3u);
  EXPECT_TRUE(log->samples[1].torque_on);
  EXPECT_FALSE(log->samples[2].torque_on);
  EXPECT_EQ(log->samples[2].position_rad, 0.2);
}

TEST(BamLogs, ReportTheEntryThatIsWrong) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"{", "a.csv: line 1"},
      {"{}", "has no list `entries`"},
      {bam("", kBamEntries), "add \"gain_per_rad\""},
      {bam(R"("kp": 400, "motor": "mx64", )", kBamEntries), "motor is \"mx64\""},
      {bam(kBamMotor, ""), "must cover at least 1 s"},
      {bam(kBamMotor, "7"), "an entry is no object: 7"},
      {bam(kBamMotor, kBamEntries + R"(, {"timestamp": 1.1, "position": "x"})"),
       "entry 4: goal_rad is 'missing'"},
      {bam(kBamMotor, kBamEntries + "," + kBamEntries), "entry 4: time_s must be greater"},
  };
  for (const auto& [text, part] : wrong)
    EXPECT_NE(error_of(text).find(part), std::string::npos) << part << ": " << error_of(text);
}

}  // namespace
}  // namespace kaz::hil

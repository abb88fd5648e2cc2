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

}  // namespace
}  // namespace kaz::hil

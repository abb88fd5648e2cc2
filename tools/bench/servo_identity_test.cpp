// The servo of a fit can be read back, and is compared parameter by parameter.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/servo_identity.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kaz::tools {
namespace {

ServoResult some_fit() {
  ServoResult result;
  hil::ServoLog log;
  for (int i = 0; i < 4; ++i) log.samples.push_back({0.01 * i, 0, 0, 11.5 + i, 0, true});
  result.logs = result.held_out = {log};
  hil::ServoFit fit;
  fit.model = 3;
  fit.held_out.position_rad = 0.012;
  for (const hil::ServoParamInfo& info : servo_model::servo_params(3))
    fit.fitted.push_back({&info, info.high, 0.25, true});
  fit.fitted[2].determined_within = INFINITY;
  result.fits = {fit};
  return result;
}

TEST(ServoIdentity, IsThatOfTheChosenModel) {
  const auto servo = identified_servo(some_fit(), "sts3215");
  EXPECT_EQ(servo.volts, 13);
  EXPECT_EQ(servo.model, 3);
  EXPECT_EQ(servo.held_out_rad, 0.012);
  EXPECT_TRUE(std::isnan(servo.floor_rad));
  EXPECT_EQ(servo.logs, "1 logs fitted, 1 held out");
  const auto read = servo_model::parse_servo_file("a", servo_model::servo_file_text(servo));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->params().kt, servo_model::servo_params(3)[0].high);
}

TEST(ServoIdentity, FindsShippedServosByName) {
  const auto shipped = named_servo("sts3215-12v");
  ASSERT_TRUE(shipped) << shipped.error().message;
  EXPECT_EQ(shipped->servo, "sts3215");
  EXPECT_EQ(named_servo("sts9999").error().message,
            "no shipped servo has the name `sts9999`: must be one of sts3215-12v, xl330-7v4");
  EXPECT_EQ(named_servo("no/such.json").error().fault, Fault::usage);
}

TEST(ServoIdentity, SaysWhichParametersDiffer) {
  auto own = identified_servo(some_fit(), "sts3215"), shipped = own;
  shipped.identified[0].value -= 0.6;  // more than the sum of both intervals
  shipped.identified[1].value -= 0.4;
  shipped.identified.pop_back();
  const auto all = servo_model::differences(shipped, own);
  const auto json = differences_json("other", all);
  EXPECT_EQ(json["servo"], "other");
  EXPECT_EQ(json["params"]["kt"]["verdict"], "differs");
  EXPECT_EQ(json["params"]["kt"]["own"]["within"], 0.25);
  EXPECT_EQ(json["params"]["resistance"]["verdict"], "agrees");
  EXPECT_EQ(json["params"]["armature"]["verdict"], "unknown");
  EXPECT_FALSE(json["params"]["armature"]["own"].contains("within"));
  EXPECT_EQ(json["params"]["load"]["verdict"], "only in one model");
  EXPECT_TRUE(json["params"]["load"]["shipped"].is_null());
  const std::string text = differences_text("other", all);
  EXPECT_NE(text.find("kt                N m/A     19.4 +- 0.25            20 +- 0.25              "
                      "differs\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("1, not determined"), std::string::npos) << text;
}

}  // namespace
}  // namespace kaz::tools

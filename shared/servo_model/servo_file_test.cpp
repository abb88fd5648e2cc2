// Files of identified servos: what is written can be read, and every error names file and key.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo_model/servo_file.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kaz::servo_model {
namespace {

IdentifiedServo some_servo(int model) {
  IdentifiedServo servo{"sts3215", 12, model, {}, "us", "public", "2026-12-01", "12 logs"};
  for (const ServoParamInfo& info : servo_params(model))
    servo.identified.push_back({&info, 0.5 * (info.low + info.high), 1.0 / 3});
  servo.identified[1].within = INFINITY;
  return servo;
}

// Text of a valid file, in which `from` is replaced by `to`.
std::string changed(const std::string& from, const std::string& to) {
  std::string text = servo_file_text(some_servo(1));
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(ServoFile, ReadsWhatItWrites) {
  for (int model = 1; model <= 6; ++model) {
    IdentifiedServo servo = some_servo(model);
    if (model % 2 == 0) servo.held_out_rad = 0.011;
    const auto read = parse_servo_file("a.json", servo_file_text(servo));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(servo_file_text(*read), servo_file_text(servo));
    EXPECT_EQ(read->model, model);
    EXPECT_EQ(read->identified[2].within, 1.0 / 3);
    EXPECT_TRUE(std::isinf(read->identified[1].within));
    EXPECT_EQ(std::isnan(read->held_out_rad), model % 2 != 0);
    for (const IdentifiedParam& one : servo.identified)
      EXPECT_EQ(read->params().*one.of->at, one.value) << one.of->name;
  }
}

TEST(ServoFile, HasDefaultsForParametersOfOtherModels) {
  EXPECT_EQ(some_servo(1).params().stribeck, ServoParams().stribeck);
}

TEST(ServoFile, IsShippedForTwoServos) {
  for (const char* name : {"sts3215-12v", "xl330-7v4"}) {
    const auto servo = shipped_servo(name);
    ASSERT_TRUE(servo) << servo.error().message;
    EXPECT_GT(servo->held_out_rad, 0.005);
  }
  EXPECT_EQ(shipped_servo("sts1").error().message,
            "no shipped servo has the name `sts1`: must be one of sts3215-12v, xl330-7v4");
}

TEST(ServoFile, ReportsAllErrorsWithFileAndKey) {
  std::string text = changed("\"volts\": 12.0", "\"volts\": 120.0");
  text.replace(text.find("\"delay\""), 7, "\"daley\"");
  text.replace(text.find("ohm"), 3, "Ohm");
  const auto read = parse_servo_file("a.json", text);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().fault, Fault::usage);
  EXPECT_EQ(read.error().message, "a.json: \"volts\" is 120: must be 1 to 60");
  EXPECT_EQ(read.error().details,
            (std::vector<std::string>{
                "a.json: \"params\": unknown key \"daley\"; remove it",
                "a.json: \"params\": \"resistance\": \"unit\" must be \"ohm\"",
                "a.json: \"params\": \"delay\": is missing or not an object; model 1 needs it"}));
}

TEST(ServoFile, RejectsWhatIsNotAServo) {
  for (const auto& [text, error] : std::vector<std::pair<std::string, std::string>>{
           {"[]", "a.json: must be a JSON object"},
           {"{", "a.json: line 1 is not valid JSON"},
           {changed("\"model\": 1", "\"model\": 1.5"), "a.json: \"model\" must be a whole number"},
           {changed("\"model\": 1", "\"model\": 7"), "a.json: \"model\" is 7: must be 1 to 6"},
           {changed("2026-12-01", "today"), "a.json: \"date\" is \"today\": must be YYYY-MM-DD"},
           {changed("\"us\"", "\"\""), "a.json: \"source\" is missing, empty or not a text"},
           {changed("\"params\"", "\"parts\""), "a.json: unknown key \"parts\"; remove it"}}) {
    const auto read = parse_servo_file("a.json", text);
    ASSERT_FALSE(read) << error;
    EXPECT_EQ(read.error().message, error);
  }
}

TEST(ServoDifferences, AreThoseWhoseIntervalsDoNotOverlap) {
  const IdentifiedServo shipped = some_servo(1);
  IdentifiedServo own = some_servo(3);
  own.identified[0].value += 0.67;  // kt: above the sum of the two intervals
  own.identified[1].value += 10;    // resistance: an infinite interval
  own.identified[2].value += 0.66;  // armature
  const auto all = differences(shipped, own);
  ASSERT_EQ(all.size(), own.identified.size());
  for (const ServoDifference& one : all) EXPECT_EQ(one.differs, one.name == "kt") << one.name;
  EXPECT_EQ(all.back().name, "load");
  EXPECT_TRUE(std::isnan(all.back().shipped));
  EXPECT_EQ(all.back().own, own.identified.back().value);
}

}  // namespace
}  // namespace kaz::servo_model

// Stands by text: commands to a machine, prompts for a person.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bench/motor/stand.h"

#include <deque>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/robot/posture.h"

namespace kaz::hil {
namespace {

constexpr int kJoint = host::l_elbow;

class StandingClock final : public host::Clock {
 public:
  Time now() const override { return now_; }
  Result<void> sleep_until(Time t) override {
    now_ = std::max(now_, t);
    return {};
  }

 private:
  Time now_{};
};

TEST(CommandStand, SendsItsCommands) {
  std::vector<std::string> commands;
  StandingClock clock;
  CommandStand stand(
      "a machine",
      [&](const std::string& line) -> Result<nlohmann::ordered_json> {
        commands.push_back(line);
        return nlohmann::ordered_json{
            {"disc_kgm2", 5e-4}, {"torque_nm", 1.25}, {"angle_rad", -0.498}};
      },
      clock);
  EXPECT_EQ(*stand.disc_kgm2(), 5e-4);
  EXPECT_TRUE(stand.set_supply(6.5));
  EXPECT_TRUE(stand.clamp(kJoint, true));
  EXPECT_EQ(*stand.scale_nm(kJoint), 1.25);
  EXPECT_TRUE(stand.clamp(kJoint, false));
  EXPECT_TRUE(stand.press(kJoint, -0.03));
  EXPECT_EQ(*stand.turn(kJoint, 1.5), -0.498);
  EXPECT_TRUE(stand.let_go(kJoint));
  EXPECT_TRUE(stand.put_back(12));
  EXPECT_EQ(commands,
            (std::vector<std::string>{
                "disc", "supply 6.500", "clamp l_elbow on", "scale l_elbow", "clamp l_elbow off",
                "press l_elbow -0.0300", "protractor l_elbow", "turn l_elbow 1.5000",
                "protractor l_elbow", "let l_elbow", "free", "supply 12.000"}));
  // 2 rad at 2 rad/s, and the time to settle.
  EXPECT_GE(clock.now(), std::chrono::milliseconds(1200));
}

TEST(CommandStand, AReplyThatMakesNoSenseIsAnError) {
  StandingClock clock;
  CommandStand stand(
      "a machine",
      [](const std::string&) -> Result<nlohmann::ordered_json> {
        return nlohmann::ordered_json{{"torque_nm", "much"}};
      },
      clock);
  EXPECT_EQ(stand.scale_nm(kJoint).error().message,
            "stand a machine: its reply to `scale l_elbow` has no number `torque_nm`");
  EXPECT_EQ(stand.turn(kJoint, 0).error().message,
            "stand a machine: its reply to `protractor l_elbow` has no number `angle_rad`");
}

// Somebody who answers one after the other.
struct Person {
  std::deque<std::string> answers;
  std::vector<std::string> prompts;
  ManualStand stand{[this](const std::string& prompt) -> Result<std::string> {
                      prompts.push_back(prompt);
                      if (answers.empty()) return fail(Fault::usage, "nobody there");
                      std::string answer = answers.front();
                      answers.pop_front();
                      return answer;
                    },
                    4e-4};
};

TEST(ManualStand, PromptsAndReads) {
  Person person;
  person.answers = {"", "", "", "1.31", " -44.5 \r", ""};
  EXPECT_EQ(*person.stand.disc_kgm2(), 4e-4);
  EXPECT_TRUE(person.stand.set_supply(10));
  EXPECT_EQ(person.prompts.back(), "Set the supply to 10.00 V without load, then press Enter");
  EXPECT_TRUE(person.stand.clamp(kJoint, true));
  EXPECT_NE(person.prompts.back().find("against the scale"), std::string::npos);
  EXPECT_TRUE(person.stand.prepare_press(kJoint, false));
  EXPECT_NE(person.prompts.back().find("in its negative direction for 0.7 s"), std::string::npos);
  EXPECT_EQ(*person.stand.scale_nm(kJoint), 1.31);
  EXPECT_NEAR(*person.stand.turn(kJoint, -0.8), -44.5 * std::numbers::pi / 180, 1e-12);
  EXPECT_NE(person.prompts.back().find("about -46 degrees"), std::string::npos)
      << person.prompts.back();
  EXPECT_TRUE(person.stand.press(kJoint, -0.03));
  EXPECT_NE(person.prompts.back().find("0.03 Nm in its negative direction"), std::string::npos);
}

TEST(ManualStand, PromptsAgainWithoutANumber) {
  Person person;
  person.answers = {"", "two", "1.2 Nm", "nan", "1.2"};
  EXPECT_EQ(*person.stand.scale_nm(kJoint), 1.2);
  ASSERT_EQ(person.prompts.size(), 5u);
  EXPECT_EQ(person.prompts[1].rfind("Not a number: type one such as -0.95. Value on", 0), 0u)
      << person.prompts[1];
}

TEST(ManualStand, NobodyThereIsAnErrorAtOnce) {
  Person person;
  EXPECT_EQ(person.stand.scale_nm(kJoint).error().message, "nobody there");
  EXPECT_EQ(person.stand.clamp(kJoint, false).error().message, "nobody there");
}

}  // namespace
}  // namespace kaz::hil

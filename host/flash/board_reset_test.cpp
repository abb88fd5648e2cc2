// Board resets: levels, commands and prompts, and their times.
// SPDX-License-Identifier: Apache-2.0
#include "host/flash/board_reset.h"

#include <gtest/gtest.h>

#include <vector>

namespace kaz::host {
namespace {

using std::chrono::milliseconds;

// Records the levels that are set, with their times.
class Bench final : public ModemLines, public Clock {
 public:
  struct Step {
    Time at;
    bool dtr, rts;
    bool operator==(const Step&) const = default;
  };

  Result<void> set_dtr_rts(bool dtr, bool rts) override {
    if (broken) return fail(Fault::environment, "no lines");
    steps.push_back({now_, dtr, rts});
    return {};
  }
  Time now() const override { return now_; }
  Result<void> sleep_until(Time t) override {
    now_ = t;
    return {};
  }

  bool broken = false;
  std::vector<Step> steps;

 private:
  Time now_{};
};

// Resets last 25 ms, and the mode pins hold their level while RES rises.
TEST(ModemLineReset, IntoBootModeAndIntoTheFlash) {
  Bench bench;
  ModemLineReset reset(bench, bench);
  ASSERT_TRUE(reset.reset(true));
  const std::vector<Bench::Step> boot{{Time::zero(), true, true}, {milliseconds(25), false, true}};
  EXPECT_EQ(bench.steps, boot);
  EXPECT_EQ(bench.now(), milliseconds(50));
  bench.steps.clear();
  ASSERT_TRUE(reset.reset(false));
  const std::vector<Bench::Step> run{{milliseconds(50), true, false},
                                     {milliseconds(75), false, false}};
  EXPECT_EQ(bench.steps, run);
}

TEST(ModemLineReset, APortWithoutLinesIsAnError) {
  Bench bench;
  bench.broken = true;
  EXPECT_FALSE(ModemLineReset(bench, bench).reset(true));
  EXPECT_EQ(bench.now(), Time::zero());
}

TEST(ModemLines, OtherLinesStayAsTheyAre) {
  const int others = TIOCM_CTS | TIOCM_DSR | TIOCM_CAR;
  EXPECT_EQ(with_dtr_rts(others | TIOCM_RTS, true, false), others | TIOCM_DTR);
  EXPECT_EQ(with_dtr_rts(others | TIOCM_DTR, false, true), others | TIOCM_RTS);
  EXPECT_EQ(with_dtr_rts(others | TIOCM_DTR | TIOCM_RTS, false, false), others);
  EXPECT_EQ(with_dtr_rts(0, true, true), TIOCM_DTR | TIOCM_RTS);
}

TEST(ManualReset, SaysWhatToDo) {
  std::vector<std::string> prompts;
  ManualReset reset([&](const std::string& prompt) -> Result<void> {
    prompts.push_back(prompt);
    if (prompts.size() == 3) return fail(Fault::usage, "nobody there");
    return {};
  });
  EXPECT_TRUE(reset.reset(true));
  EXPECT_TRUE(reset.reset(false));
  EXPECT_FALSE(reset.reset(true));
  EXPECT_NE(prompts[0].find("boot mode"), std::string::npos);
  EXPECT_NE(prompts[1].find("run"), std::string::npos);
}

TEST(ControlSocketReset, NobodyThereSaysWhatToLookAt) {
  ControlSocketReset reset("/nonexistent/board.ctl");
  const auto done = reset.reset(true);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().fault, Fault::environment);
  EXPECT_NE(done.error().message.find("kaz sim"), std::string::npos);
}

}  // namespace
}  // namespace kaz::host

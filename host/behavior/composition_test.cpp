// Order, retries, replacement and time, with tasks that log their calls.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/composition.h"

#include <gtest/gtest.h>

#include "host/robot/robot_testing.h"

namespace kaz::behavior {
namespace {

using namespace std::chrono_literals;

constexpr Option kTimes[] = {{"times", "1", "", 1, 10, "how often", true}};

struct Composition : ::testing::Test {
  host::TestBoard board;
  host::Robot robot = host::connect_to(board);
  Recording recording;
  Context context{robot, board, nullptr, recording, *OptionValues::parse({}, {})};
  int calls = 0;

  Task ends(bool success, std::string cause = {}) {
    return [=, this](Context&) -> Result<Outcome> {
      ++calls;
      return Outcome{success, cause, {{"call", calls}}, cause};
    };
  }
  static Task breaks() {
    return [](Context&) -> Result<Outcome> { return fail(Fault::environment, "no link"); };
  }
};

TEST_F(Composition, SequenceRunsInOrderAndStopsAtTheFirstFailure) {
  const auto all = sequence("dance", {{"bow", ends(true)}, {"turn", ends(true)}})(context);
  ASSERT_TRUE(all && all->success);
  EXPECT_EQ(all->measurements.size(), 2u);
  ASSERT_EQ(recording.phases.size(), 2u);
  EXPECT_EQ(recording.phases[0].behavior, "dance");
  EXPECT_EQ(recording.phases[1].phase, "turn");

  const auto part = sequence(
      "dance", {{"bow", ends(true)}, {"leap", ends(false, "fell")}, {"end", ends(true)}})(context);
  ASSERT_TRUE(part);
  EXPECT_FALSE(part->success);
  EXPECT_EQ(part->cause, "fell");
  EXPECT_EQ(calls, 4);
  EXPECT_TRUE(sequence("dance", {})(context)->success);
}

TEST_F(Composition, FallbackTakesTheFirstThatSucceeds) {
  const auto outcome = fallback(
      "hold", {{"left", ends(false)}, {"right", ends(true)}, {"both", ends(true)}})(context);
  ASSERT_TRUE(outcome && outcome->success);
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(
      fallback("hold", {{"left", ends(false, "a")}, {"right", ends(false, "b")}})(context)->cause,
      "b");
}

TEST_F(Composition, RetryEndsWithSuccessOrWhenItIsNotWorthIt) {
  const auto third = [this](Context&) -> Result<Outcome> {
    return Outcome{++calls == 3, "", {}, "missed"};
  };
  auto outcome = retry(5, third)(context);
  ASSERT_TRUE(outcome && outcome->success);
  EXPECT_EQ(outcome->measurements.back().second, 3);
  calls = 0;
  outcome = retry(2, third)(context);
  EXPECT_FALSE(outcome->success);
  EXPECT_EQ(calls, 2);
  calls = 0;
  outcome =
      retry(5, ends(false, "fell"), [](const Outcome& o) { return o.cause != "fell"; })(context);
  EXPECT_EQ(calls, 1);
}

TEST_F(Composition, AnErrorEndsAllAtOnce) {
  EXPECT_FALSE(sequence("a", {{"x", breaks()}, {"y", ends(true)}})(context));
  EXPECT_FALSE(fallback("a", {{"x", breaks()}, {"y", ends(true)}})(context));
  EXPECT_FALSE(retry(3, breaks())(context));
  EXPECT_FALSE(within(1s, breaks())(context)) << "not its time";
  EXPECT_EQ(calls, 0);
}

TEST_F(Composition, TimeIsLimitedWhereverATaskWaits) {
  const Time start = board.now();
  Task waits = [](Context& c) -> Result<Outcome> {
    for (;;) KAZ_TRY(c.clock.sleep_until(c.clock.now() + 300ms));
  };
  const auto outcome = retry(3, within(1s, waits), [](const Outcome&) { return false; })(context);
  ASSERT_TRUE(outcome);
  EXPECT_FALSE(outcome->success);
  EXPECT_EQ(outcome->cause, "time");
  EXPECT_EQ(board.now() - start, 1s);
  EXPECT_TRUE(within(1s, ends(true))(context)->success);
  // The shorter of two limits counts, and the longer one does not take it for its own.
  EXPECT_EQ(within(5s, within(500ms, waits))(context)->cause, "time");
  EXPECT_LT(board.now() - start, 1600ms);
}

TEST_F(Composition, ATaskWithinATimeHasTheContextOfTheWhole) {
  context.options = *OptionValues::parse(kTimes, {{"times", "3"}});
  context.seed = 7;
  context.other_joints = {"turn", "shoulder"};
  context.ball_radius_m = 0.033;
  context.camera = "camera /dev/video7";
  bool ran = false;
  const auto outcome = within(1s, [&](Context& c) -> Result<Outcome> {
    ran = true;
    EXPECT_EQ(&c.robot, &robot);
    EXPECT_EQ(c.vision, context.vision);
    EXPECT_EQ(&c.sink, &context.sink);
    EXPECT_EQ(c.options.number("times"), 3);
    EXPECT_EQ(c.seed, 7u);
    EXPECT_EQ(c.other_joints, context.other_joints);
    EXPECT_EQ(c.ball_radius_m, 0.033);
    EXPECT_EQ(c.camera, "camera /dev/video7");
    return Outcome{true, "", {}};
  })(context);
  EXPECT_TRUE(ran && outcome && outcome->success);
}

}  // namespace
}  // namespace kaz::behavior

// Registry, options, filter, search pattern, and stand.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/behavior.h"
#include "host/behavior/get_up.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "host/behavior/control_cycle.h"
#include "host/behavior/search_pattern.h"
#include "host/robot/robot_testing.h"
#include "shared/base/angle.hpp"

namespace kaz::behavior {
namespace {

using namespace std::chrono_literals;

TEST(Registry, NamesAreUniqueAndFound) {
  std::set<std::string_view> names;
  for (const Behavior& behavior : behaviors()) {
    EXPECT_TRUE(names.insert(behavior.name).second);
    ASSERT_TRUE(find_behavior(behavior.name));
    EXPECT_FALSE(behavior.text.empty());
    EXPECT_TRUE(OptionValues::parse(behavior.options, {}))
        << behavior.name << ": defaults are legal";
  }
  EXPECT_TRUE(names.count("search-ball") && names.count("track-ball") && names.count("stand"));
  const auto none = find_behavior("dance");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().fault, Fault::usage);
  EXPECT_NE(none.error().message.find("search-ball, stand, track-ball"), std::string::npos);
  EXPECT_EQ(none.error().message.find(".so"), std::string::npos) << "it loads no plug-ins";
}

TEST(Options, AreCheckedAgainstRangeAndChoices) {
  constexpr Option options[] = {{"seconds", "5", "", 1, 10, "how long, s"},
                                {"side", "left", "left|right", 0, 0, "which"},
                                {"tries", "4", "", 1, 20, "how many", true}};
  EXPECT_EQ(valid_values(options[0]), "1 to 10");
  EXPECT_EQ(valid_values(options[1]), "left|right");
  const auto good = OptionValues::parse(options, {{"side", "right"}, {"seconds", "2.5"}});
  ASSERT_TRUE(good);
  EXPECT_DOUBLE_EQ(good->number("seconds"), 2.5);
  EXPECT_EQ(good->choice("side"), "right");
  EXPECT_DOUBLE_EQ(OptionValues::parse(options, {})->number("seconds"), 5);

  for (const auto& [name, value, hint] : std::initializer_list<std::array<const char*, 3>>{
           {"seconds", "11", "a number from 1 to 10"},
           {"seconds", "2x", "a number from 1 to 10"},
           {"seconds", "nan", "a number from 1 to 10"},
           {"seconds", "", "a number from 1 to 10"},
           {"side", "up", "one of left|right"},
           {"side", "", "one of left|right"},
           {"side", "left|right", "one of left|right"},
           {"tries", "1.5", "a whole number from 1 to 20"},
           {"tries", "21", "a whole number from 1 to 20"},
           {"sid", "left", "its options are seconds, side, tries"}}) {
    const auto bad = OptionValues::parse(options, {{name, value}});
    ASSERT_FALSE(bad) << name << "=" << value;
    EXPECT_EQ(bad.error().fault, Fault::usage);
    EXPECT_NE(bad.error().message.find(hint), std::string::npos) << bad.error().message;
  }
}

// Every direction that the head can see is in the middle part of the view at some time of the first
// round. The field of view is 40 degrees to each side and 32 up and down; required are 36 and 29.
TEST(SearchPattern, CoversTheViewSphere) {
  for (const double start_pan : {-60.0, 0.0, 30.0}) {
    for (const double start_tilt : {-40.0, 0.0, 70.0}) {
      const SearchPattern pattern({start_pan * kDegree, start_tilt * kDegree}, 90 * kDegree, true);
      for (double pan = -115; pan <= 115; pan += 10) {
        for (double tilt = -43; tilt <= 80; tilt += 6) {
          bool seen = false;
          for (double t = 0; t <= pattern.once() && !seen; t += 0.01) {
            const host::Gaze gaze = pattern.at(t);
            seen = std::abs(gaze.pan_rad / kDegree - pan) <= 36 &&
                   std::abs(gaze.tilt_rad / kDegree - tilt) <= 29;
          }
          ASSERT_TRUE(seen) << pan << ", " << tilt;
        }
      }
    }
  }
}

TEST(SearchPattern, MovesSteadilyAndStaysInReach) {
  const SearchPattern pattern({1.2, -0.5}, 1.5, false);
  EXPECT_DOUBLE_EQ(pattern.at(0).pan_rad, 1.2);
  EXPECT_DOUBLE_EQ(pattern.at(0).tilt_rad, -0.5);
  EXPECT_LT(pattern.once(), 8);
  host::Gaze last = pattern.at(0);
  for (double t = 0.01; t < 40; t += 0.01) {
    const host::Gaze gaze = pattern.at(t);
    EXPECT_LE(std::abs(gaze.pan_rad - last.pan_rad), 0.015 + 1e-9) << t;
    EXPECT_LE(std::abs(gaze.tilt_rad - last.tilt_rad), 0.015 + 1e-9) << t;
    const host::Gaze inside = host::within_limits(gaze, 0.05);
    EXPECT_DOUBLE_EQ(gaze.pan_rad, inside.pan_rad);
    EXPECT_DOUBLE_EQ(gaze.tilt_rad, inside.tilt_rad);
    last = gaze;
  }
}

struct Stand : ::testing::Test {
  host::TestBoard board;
  host::Robot robot = host::connect_to(board);
  Recording recording;

  Result<Outcome> run(const char* posture) {
    const auto behavior = find_behavior("stand");
    Context context{robot, board, nullptr, recording,
                    *OptionValues::parse(behavior->options, {{"posture", posture}})};
    return behavior->run(context);
  }
};

TEST_F(Stand, GoesHomeSlowly) {
  double fastest = 0;
  host::JointAngles last{};
  board.after_tick = [&](Time start) {
    const host::JointAngles angle = board.angles_at(start);
    for (std::size_t j = 0; j < angle.size(); ++j) {
      fastest = std::max(fastest, std::abs(angle[j] - last[j]) / 1e-3);
    }
    last = angle;
  };
  const auto outcome = run("home");
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_TRUE(outcome->success) << outcome->sentence;
  const host::JointAngles angle = board.angles_at(board.now());
  EXPECT_NEAR(angle[host::l_knee] / kDegree, 55.6, 1);
  EXPECT_NEAR(angle[host::r_hip_pitch] / kDegree, -30.8, 1);
  EXPECT_NEAR(angle[host::r_sh_roll] / kDegree, -12, 1);
  EXPECT_TRUE(board.motors_on());
  EXPECT_LT(fastest, 1.5);  // 0.5 rad/s of the ramp, and the steps of a potentiometer's code
}

// All ramps end when the board starts anew: they are begun again.
TEST_F(Stand, GetsThereAlthoughTheBoardWasResetOnTheWay) {
  const Time start = board.now();
  bool was_reset = false;
  board.after_tick = [&](Time now) {
    if (now < start + 800ms || std::exchange(was_reset, true)) return;
    board.reset();
  };
  const auto outcome = run("home");
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_TRUE(was_reset);
  EXPECT_TRUE(outcome->success) << outcome->sentence;
  EXPECT_NEAR(board.angles_at(board.now())[host::l_knee] / kDegree, 55.6, 1);
}

TEST(ControlCycle, ReportsThatTheLinkWasLost) {
  host::TestBoard board;
  host::Robot robot = host::connect_to(board);
  Recording recording;
  Context context{robot, robot.clock(), nullptr, recording, *OptionValues::parse({}, {})};
  ASSERT_TRUE(hold_still(robot));
  ControlCycle cycle(context);
  const host::JointTarget target[] = {{host::neck_pan, 0.3}};
  for (int i = 0; i < 100; ++i) {
    const auto input = cycle.next(target);
    ASSERT_TRUE(input) << input.error().message;
    EXPECT_FALSE(input->resumed);
  }
  ASSERT_TRUE(board.sleep_until(board.now() + 200ms));  // a behavior that thinks for too long
  const auto input = cycle.next(target);
  ASSERT_TRUE(input) << input.error().message;
  ASSERT_TRUE(input->resumed);
  EXPECT_EQ(input->resumed->cause, host::Resumption::Cause::watchdog);
  EXPECT_FALSE(cycle.next(target)->resumed);
}

TEST_F(Stand, KeepsWhatItFinds) {
  for (int j = 0; j < KZ_JOINTS; ++j) board.set_angle(j, j == host::l_elbow ? -0.7 : 0.05);
  ASSERT_TRUE(board.sleep_until(board.now() + 5ms));
  const auto outcome = run("keep");
  ASSERT_TRUE(outcome);
  EXPECT_TRUE(outcome->success);
  EXPECT_NEAR(board.angles_at(board.now())[host::l_elbow], -0.7, 0.01);
}

// At rest the accelerometer measures the direction of gravity, with an offset of up to 0.2 g.
TEST(GetUp, KnowsHowItLies) {
  EXPECT_EQ(lying_from(-0.8, 0.2), Lying::on_face);
  EXPECT_EQ(lying_from(1.0, -0.2), Lying::on_back);
  EXPECT_EQ(lying_from(0.2, -1.0), Lying::on_left);  // up is to its right
  EXPECT_EQ(lying_from(-0.2, 0.8), Lying::on_right);
  EXPECT_EQ(lying_from(0.25, -0.2), Lying::upright);
}

}  // namespace
}  // namespace kaz::behavior

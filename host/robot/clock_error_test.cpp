// Robot::clock_error() bounds the error of Posture::time on lines with jitter and drifting crystals.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "host/robot/robot_testing.h"

namespace kaz::host {
namespace {

using namespace std::chrono_literals;

struct Line {
  const char* name;
  Time to_board, to_host;
  double ppm;
  bool byte_time;
  double bound_ms;  // what clock_error() must have come down to after 5 s
};

class ClockUnderJitter : public ::testing::TestWithParam<Line> {};

// The bound must hold at all times, for crystals within the drift bound and any delays. (The formula's
// one millisecond drifts by less than a microsecond.)
TEST_P(ClockUnderJitter, BoundHolds) {
  TestBoard::Options options;
  options.latency_to_board = GetParam().to_board;
  options.latency_to_host = GetParam().to_host;
  options.crystal_ppm = GetParam().ppm;
  options.state_byte_time = GetParam().byte_time;
  TestBoard board(options);
  Robot robot = connect_to(board);
  for (int i = 0; i < 300; ++i) {
    ASSERT_TRUE(board.sleep_until(board.now() + 9ms + Time(i % 7 * 311'000)));
    const auto state = robot.state();
    ASSERT_TRUE(state);
    const Time error = state->time - board.start_of_tick(state->tick);
    ASSERT_LE(std::abs(seconds(error)), seconds(robot.clock_error()) + 1e-6) << "after " << i;
  }
  EXPECT_LT(seconds(robot.clock_error()) * 1e3, GetParam().bound_ms);
}

INSTANTIATE_TEST_SUITE_P(Lines, ClockUnderJitter,
                         ::testing::Values(Line{"ideal", 0ms, 0ms, 0, true, 0.6},
                                           Line{"fast_crystal", 0ms, 0ms, -150, true, 0.6},
                                           Line{"usb_1ms", 1ms, 1ms, 80, true, 1.0},
                                           Line{"usb_16ms", 1ms, 16ms, 80, true, 3.0},
                                           Line{"bytes_unknown", 0ms, 0ms, 50, false, 3.5}),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace kaz::host

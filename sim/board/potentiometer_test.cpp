// A potentiometer's output over a whole turn.
// SPDX-License-Identifier: Apache-2.0
#include "sim/board/potentiometer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shared/base/angle.hpp"
#include "shared/board/table.h"

namespace kaz::sim {
namespace {

PotentiometerParams params() {
  return load_sensor_file("shared/robot/kaz/sensors.xml").value().potentiometer;
}

TEST(Potentiometer, TrackOf190DegreesAndItsTerminals) {
  const Potentiometer pan(0, params(), {}, 1);  // neck_pan: sign +1, centre 0
  EXPECT_NEAR(pan.ratio(0), 0.5, 1e-12);
  EXPECT_NEAR(pan.ratio(-95 * kDegree), 0.0, 1e-12);
  EXPECT_NEAR(pan.ratio(95 * kDegree), 1.0, 1e-12);
  EXPECT_NEAR(pan.ratio(19 * kDegree), 0.6, 1e-12);
  EXPECT_EQ(pan.ratio(-96.9 * kDegree), 0.0) << "on the terminal, 2 degrees wide";
  EXPECT_EQ(pan.ratio(96.9 * kDegree), 1.0);
}

TEST(Potentiometer, BeyondTheTerminalsTheInputsPullUpDecides) {
  const Potentiometer pan(0, params(), {}, 1);
  EXPECT_EQ(pan.ratio(-97.1 * kDegree), 1.0);
  EXPECT_EQ(pan.ratio(-150 * kDegree), 1.0);
  EXPECT_EQ(pan.ratio(97.1 * kDegree), 1.0);
  PotentiometerParams pulled_down = params();
  pulled_down.open_level = 0;
  EXPECT_EQ(Potentiometer(0, pulled_down, {}, 1).ratio(120 * kDegree), 0.0);
}

TEST(Potentiometer, IdealIsTheNominalLawAndStopsAtItsEnds) {
  for (int joint = 0; joint < KZ_JOINTS; ++joint) {
    const Potentiometer ideal(joint, params(), SensorSwitches::ideal(), 1);
    for (double angle = -4; angle < 4; angle += 0.01)
      ASSERT_EQ(ideal.ratio(angle), pot_ratio(joint, angle)) << joint;
  }
}

TEST(Potentiometer, NominalIsWhereTheFirmwareThinksItIs) {
  // Code and angle through the firmware's own table: half a code and its rounding, to both sides.
  for (int joint = 0; joint < KZ_JOINTS; ++joint) {
    const Potentiometer pot(joint, params(), {}, 5);
    const kz_board_joint& board = kz_board_joints[joint];
    for (int angle = board.lower; angle <= board.upper; angle += 37) {
      const auto code = static_cast<u16>(std::floor(pot.ratio(angle * 1e-4) * KZ_POT_CODES));
      ASSERT_NEAR(kz_pot_angle(&board, code), angle, 18) << joint;
    }
  }
}

TEST(AsBuilt, LinearityErrorIsSmoothBoundedZeroAtTheEndsAndTheJointsOwn) {
  PotentiometerParams bent = params();
  bent.mounting_rad = 0;
  double largest = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Potentiometer pot(0, bent, SensorSwitches::as_built(), seed);
    double last = 0;
    for (int i = 0; i <= 1900; ++i) {
      const double angle = (0.1 * i - 95) * kDegree;
      const double error = pot.ratio(angle) - pot_ratio(0, angle);
      largest = std::max(largest, std::abs(error));
      // Slope of each wave at most k pi times its share: together 3 pi of the limit a range.
      ASSERT_LT(std::abs(error - last), 3 * std::numbers::pi * 0.005 / 1900 + 1e-12);
      last = error;
    }
    EXPECT_NEAR(last, 0, 1e-12);
  }
  EXPECT_LE(largest, 0.005);
  EXPECT_GT(largest, 0.002);
  const Potentiometer a(0, bent, SensorSwitches::as_built(), 1);
  const Potentiometer b(1, bent, SensorSwitches::as_built(), 1);
  const Potentiometer again(0, bent, SensorSwitches::as_built(), 1);
  EXPECT_NE(a.ratio(0) - pot_ratio(0, 0), b.ratio(15 * kDegree) - pot_ratio(1, 15 * kDegree));
  EXPECT_EQ(a.ratio(0.3), again.ratio(0.3));
}

TEST(AsBuilt, MountingShiftsTheWholeCurveAndNotMoreThanTheTrackAllows) {
  PotentiometerParams shifted = params();
  shifted.linearity = 0;
  double squares = 0;
  constexpr int count = 2000;
  for (int seed = 0; seed < count; ++seed) {
    const Potentiometer pot(0, shifted, SensorSwitches::as_built(),
                            static_cast<std::uint64_t>(seed));
    ASSERT_LE(std::abs(pot.offset_rad()), 1.0 * kDegree);
    ASSERT_NEAR(pot.ratio(0.4), pot_ratio(0, 0.4 + pot.offset_rad()), 1e-12);
    squares += pot.offset_rad() * pot.offset_rad();
  }
  // Normal of half a degree cut at two sigma: its sigma is 0.48 degrees (clamped, 0.9199 of the
  // variance); five standard errors.
  EXPECT_NEAR(std::sqrt(squares / count) / kDegree, 0.5 * std::sqrt(0.9199), 0.04);
}

}  // namespace
}  // namespace kaz::sim

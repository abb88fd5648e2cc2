// The joint table: wiring without conflicts, limits that the potentiometers can see.
// SPDX-License-Identifier: Apache-2.0
#include "shared/board/table.h"

#include <gtest/gtest.h>

#include <numbers>
#include <set>
#include <utility>

namespace {

struct Wiring {
  int index, pwm, port, bit, mux, input, sign, pot_centre;
};
constexpr Wiring kWiring[] = {
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) \
  {index, pwm, port, bit, mux, input, sign, pot_centre},
#include "shared/board/joints.def"
#undef KZ_JOINT
};

TEST(JointTable, NoPinIsUsedTwice) {
  std::set<int> pwm, analog;
  std::set<std::pair<int, int>> direction = {{4, 5}, {4, 0}, {4, 1}, {4, 2}};  // enable, selects
  int expected_index = 0;
  for (const Wiring& joint : kWiring) {
    EXPECT_EQ(joint.index, expected_index++);
    EXPECT_TRUE(pwm.insert(joint.pwm).second) << joint.index;
    EXPECT_TRUE(direction.insert({joint.port, joint.bit}).second) << joint.index;
    EXPECT_TRUE(analog.insert(joint.mux * KZ_MUX_INPUTS + joint.input).second) << joint.index;
    EXPECT_LT(joint.input, KZ_ANALOG_SUPPLY) << joint.index;
    EXPECT_TRUE(joint.sign == 1 || joint.sign == -1) << joint.index;
  }
  EXPECT_EQ(expected_index, KZ_JOINTS);
}

TEST(JointTable, AngleOfACodeIsTheGeometryOfThePotentiometer) {
  constexpr double rad_per_decideg = std::numbers::pi / 1800;
  for (const Wiring& joint : kWiring) {
    for (int code = 0; code < KZ_POT_CODES; ++code) {
      const double decideg = joint.pot_centre + joint.sign * (code + 0.5 - 512) *
                                                    double{KZ_POT_RANGE_DECIDEG} / KZ_POT_CODES;
      const double exact = decideg * rad_per_decideg * KZ_ANGLE_PER_RAD;
      ASSERT_NEAR(kz_pot_angle(&kz_board_joints[joint.index], static_cast<u16>(code)), exact, 2.5)
          << "joint " << joint.index << " code " << code;
    }
  }
}

TEST(JointTable, LimitsLieInsideSoundCodes) {
  for (const kz_board_joint& joint : kz_board_joints) {
    const int a = kz_pot_angle(&joint, 4), b = kz_pot_angle(&joint, 1019);
    EXPECT_LT(joint.lower, joint.upper);
    EXPECT_GE(joint.lower, std::min(a, b) - 1);
    EXPECT_LE(joint.upper, std::max(a, b) + 1);
  }
}

TEST(JointTable, LimitsAreThoseOfTheRobot) {
  // Neck: +-90 degrees, and -45 to 75 degrees (kaz-model, section 2), rounded inwards.
  EXPECT_NEAR(kz_board_joints[0].upper, std::numbers::pi / 2 * KZ_ANGLE_PER_RAD, 2);
  EXPECT_NEAR(kz_board_joints[0].lower, -std::numbers::pi / 2 * KZ_ANGLE_PER_RAD, 2);
  EXPECT_NEAR(kz_board_joints[1].upper, 75 * std::numbers::pi / 180 * KZ_ANGLE_PER_RAD, 2);
}

}  // namespace

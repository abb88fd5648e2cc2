// Error bounds of the default dynamics, `reduced`, against closed forms.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "tests/studies/dynamics_table/table.h"

namespace kaz::dynamics_table {
namespace {

// Errors of `reduced` by prefixes of scene and quantity.
class Errors {
 public:
  Errors(void (*scenes)(const std::string&, Table&)) { scenes("reduced", table_); }
  double of(const std::string& scene, const std::string& quantity) const {
    for (const Row& row : table_.rows()) {
      if (row.scene.rfind(scene, 0) == 0 && row.quantity.rfind(quantity, 0) == 0)
        return std::abs(row.error.at("reduced"));
    }
    ADD_FAILURE() << "no row " << scene << ": " << quantity;
    return NAN;
  }

 private:
  Table table_;
};

TEST(DynamicsTable, Flight) {
  const Errors errors(fly);
  EXPECT_LT(errors.of("rigid body", "angular momentum"), 1e-9);
  // Midpoint rule: relative error (w h)^2 = 1.7e-4, without drift of the energy; the attitude's error is a
  // fraction of that for each radian.
  EXPECT_LT(errors.of("rigid body", "energy"), 1e-5);
  EXPECT_LT(errors.of("rigid body", "attitude after 1 s"), 13 * 1.7e-4 / 4);
  EXPECT_LT(errors.of("rigid body", "attitude after 10 s"), 130 * 1.7e-4 / 4);
  EXPECT_LT(errors.of("Kaz tumbles", "angular momentum"), 1e-9);
  EXPECT_LT(errors.of("Kaz tumbles", "centre of mass"), 1e-12);
  EXPECT_EQ(errors.of("Kaz tumbles", "gap in a joint"), 0);
}

TEST(DynamicsTable, Pendulums) {
  const Errors errors(swing);
  for (const char* pendulum : kPendulums) {
    EXPECT_LT(errors.of(pendulum, "energy"), 1e-3);
    // The tip moves at up to 6 m/s. Positions are those of half a step later; then the error is of second
    // order.
    EXPECT_LT(errors.of(pendulum, "path"), 6 * 0.5e-3);
    EXPECT_LT(errors.of(pendulum, "the same"), 3e-4);
  }
}

// Of first order at least.
TEST(DynamicsTable, EnergyFollowsTheStep) {
  Table table;
  swing_by_step("reduced", table);
  for (const char* pendulum : kPendulums) {
    const std::vector<double>& errors = table.energies.at(pendulum).at("reduced");
    EXPECT_GT(slope(errors), 1) << pendulum;
    for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_LT(errors[i - 1], errors[i]);
  }
}

TEST(DynamicsTable, Sliding) {
  const Errors errors(slide);
  // The velocity at the end of a step moves the block: half a step's distance too short, 0.5 mm of 102.
  for (const char* scene :
       {"block pushed to 1 m/s, mu 0.5, hard", "block pushed to 1 m/s, mu 0.5, soft"}) {
    EXPECT_LT(errors.of(scene, "distance"), 0.006);
    EXPECT_LT(errors.of(scene, "time"), 0.006);
  }
  EXPECT_LT(errors.of("block on a slope of 25", "creep in 10 s, hard"), 1e-6);
  EXPECT_LT(errors.of("block on a slope of 25", "creep in 10 s, soft"), 1e-6);
  EXPECT_LT(errors.of("block on a slope of 27", "acceleration"), 1e-6);
  EXPECT_LT(errors.of("block on a slope of 35", "acceleration"), 1e-6);
}

// Friction that changes the normal force which bounds it.
TEST(DynamicsTable, Braking) {
  const Errors errors(brake);
  EXPECT_LT(errors.of("shoe on a lever", "deceleration, trailing"), 1e-6);
  EXPECT_LT(errors.of("shoe on a lever", "deceleration, leading"), 1e-6);
}

TEST(DynamicsTable, Rolling) {
  const Errors errors(roll);
  EXPECT_LT(errors.of("ball rolls down", "acceleration"), 1e-6);
  EXPECT_LT(errors.of("ball pushed", "speed"), 1e-6);
  // Half a step of the deceleration while it slips: 50 um of 128 mm.
  EXPECT_LT(errors.of("ball pushed", "distance"), 5e-4);
  EXPECT_LT(errors.of("ball with rolling", "deceleration"), 1e-6);
  EXPECT_LT(errors.of("ball with rolling", "creep"), 1e-9);
}

TEST(DynamicsTable, Standing) {
  const Errors errors(stand);
  EXPECT_LT(errors.of("stack", "force"), 1e-6);
  EXPECT_LT(errors.of("stack", "position"), 1e-9);
  EXPECT_LT(errors.of("stack", "its height"), 1e-9);
  EXPECT_LT(errors.of("joint driven", "penetration at rest"), 0.073);  // stiction over stall torque
  // Rotor and rod at 12 rad/s hit a stop that yields by 1 mrad at stall torque.
  EXPECT_LT(errors.of("joint driven", "max penetration"), 3e-3);
  EXPECT_EQ(errors.of("joint driven", "bounce"), 0);
  EXPECT_LT(errors.of("Kaz in its crouch", "force"), 1e-6);
  EXPECT_LT(errors.of("Kaz in its crouch", "sideways"), 1e-6);
  EXPECT_LT(errors.of("Kaz in its crouch", "trunk, 10 s"), 1e-6);
  EXPECT_LT(errors.of("Kaz in its crouch", "trunk turns"), 1e-6);
  EXPECT_EQ(errors.of("Kaz in its crouch", "gap"), 0);
}

}  // namespace
}  // namespace kaz::dynamics_table

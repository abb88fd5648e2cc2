// Robots as built are calibrated through wire and board, and ground truth judges.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/robot/posture.h"
#include "shared/base/angle.hpp"
#include "tests/studies/common/calibrated.h"

namespace kaz {
namespace {

TEST(Joints, OfARobotAsBuiltErrLessThanHalfADegreeAfterwards) {
  sim::SimulationOptions options;
  options.world_path = "sim/worlds/empty.sdf";
  options.robot_path = "shared/robot/kaz/kaz.urdf";
  options.camera_path = "shared/robot/kaz/camera.json";
  options.imu = true;
  options.seed = 5;
  options.sensors = sim::SensorSet::as_built;
  const auto done = studies::calibrate_joints(options);
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_LT(done->worst_residual, 4.5);
  EXPECT_LT(done->seconds, 180);
  const auto params = sim::load_sensor_file("shared/robot/kaz/sensors.xml").value();
  std::vector<double> all;
  for (int j = 0; j < KZ_JOINTS; ++j) {
    const auto i = static_cast<std::size_t>(j);
    for (const double error : studies::true_errors(params, sim::SensorSet::as_built, options.seed,
                                                   j, done->all[i], 41)) {
      all.push_back(std::abs(error));
      // Three standard deviations of its worst angle, for 18 joints.
      ASSERT_LT(std::abs(error), 3 * done->worst_rad[i]) << host::joint_table()[i].name;
    }
  }
  std::ranges::sort(all);
  std::printf("95 %% of angles: %.2f deg, worst %.2f, %.0f s\n",
              all[all.size() * 95 / 100] / kDegree, all.back() / kDegree, done->seconds);
  EXPECT_LT(all[all.size() * 95 / 100], 0.5 * kDegree);
}

}  // namespace
}  // namespace kaz

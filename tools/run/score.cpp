// How well the head was kept on the ball.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/robot/posture.h"

namespace kaz::tools {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kAllowedDeg = 3.0;

}  // namespace

void TruthProbe::sample() {
  const sim::World& world = simulation_.world();
  const auto ball = world.object_position("ball");
  if (!ball) return;
  const Eigen::Isometry3d eye = world.link_pose("left_eye");  // optical frame: z forward
  const Eigen::Vector3d to_ball = (eye.inverse() * *ball).normalized();
  const auto joints = world.joints();
  samples_.push_back({simulation_.time(), std::atan2(to_ball.head<2>().norm(), to_ball.z()),
                      joints[host::neck_pan].angle, joints[host::neck_tilt].angle});
}

Score score(const behavior::Recording& recording, const TruthProbe* probe, Time start) {
  Score score;
  for (const auto& phase : recording.phases) {
    if (phase.phase == "track") {
      score.found_s = seconds(phase.time - start);
      break;
    }
  }
  if (!score.found_s) return score;
  if (probe != nullptr && !probe->samples().empty()) {
    score.measured_by = "truth";
    for (const auto& sample : probe->samples()) {
      score.time_s.push_back(seconds(sample.time - start));
      score.error_deg.push_back(sample.error_rad * kDegrees);
    }
  } else {
    score.measured_by = "pictures";
    for (const auto& picture : recording.pictures) {
      score.time_s.push_back(seconds(picture.exposure - start));
      score.error_deg.push_back(picture.found ? picture.error_rad * kDegrees
                                              : std::numeric_limits<double>::quiet_NaN());
    }
  }
  std::size_t after = 0, within = 0, seen = 0;
  double squares = 0;
  for (std::size_t i = 0; i < score.time_s.size(); ++i) {
    if (score.time_s[i] < *score.found_s) continue;
    ++after;
    const double error = score.error_deg[i];
    if (std::isnan(error)) continue;
    ++seen;
    squares += error * error;
    if (error <= kAllowedDeg) ++within;
  }
  if (after > 0) score.within_3deg = static_cast<double>(within) / static_cast<double>(after);
  if (seen > 0) score.rms_deg = std::sqrt(squares / static_cast<double>(seen));
  return score;
}

}  // namespace kaz::tools

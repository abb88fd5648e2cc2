// Pairs wait here until the posture at their exposure is known.
// SPDX-License-Identifier: Apache-2.0
#include "host/camera/capture.h"

#include "host/robot/kinematics.h"

namespace kaz::host {

Result<std::optional<vision::StereoPair>> Capture::poll() {
  const Time now = robot_.clock().now();
  while (true) {
    auto next = camera_.poll();
    if (!next && waiting_.empty()) return tl::unexpected(next.error());
    if (!next || !*next) break;
    waiting_.push_back({std::move(**next), now});
  }
  if (waiting_.empty()) return std::nullopt;

  Arrived& first = waiting_.front();
  vision::FrameInfo& info = first.pair.info;
  if (const auto posture = robot_.posture_at(info.exposure)) {
    info.joint_rad.assign(posture->angle.begin(), posture->angle.end());
    info.foot_from_eye = foot_from_eye(posture->angle);
    info.posture_known = true;
  } else {
    const auto newest = robot_.newest_posture();
    const bool may_come = !newest || *newest < info.exposure;
    if (may_come && now - first.at < kPatience) return std::nullopt;
    info.posture_known = false;
  }
  vision::StereoPair pair = std::move(first.pair);
  waiting_.pop_front();
  return pair;
}

}  // namespace kaz::host

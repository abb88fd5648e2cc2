// By the name's beginning.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/session/live_camera.h"

#include "host/camera/published_camera.h"
#include "host/camera/v4l2_camera.h"
#include "vision/calibration/calibration_file.h"

namespace kaz::tools {

std::string LiveCamera::summary() const {
  const auto* real = dynamic_cast<const host::V4l2Camera*>(camera.get());
  return real != nullptr ? real->summary() : "";
}

bool is_real_camera(const std::string& where) {
  return where.starts_with(host::kV4l2);
}

Result<void> check_live_camera(const std::string& where, const std::string& calibration) {
  if (!is_real_camera(where)) {
    if (!calibration.empty())
      return fail(Fault::usage,
                  "--calibration goes with real cameras (v4l2:...); what comes from " + where +
                      " is rectified already: leave it out");
    return {};
  }
  KAZ_TRY(host::parse_v4l2_source(where));
  if (calibration.empty())
    return fail(Fault::usage, where +
                                  " needs --calibration FILE (kaz calibrate stereo): pictures of "
                                  "real lenses have to be rectified");
  return {};
}

Result<LiveCamera> open_live_camera(const std::string& where, const std::string& calibration) {
  KAZ_TRY(check_live_camera(where, calibration));
  if (!is_real_camera(where)) {
    auto published = KAZ_TRY(host::PublishedCamera::connect(where));
    const Time latency = published->latency();
    return LiveCamera{std::move(published), latency};
  }
  const auto eyes = KAZ_TRY(vision::read_calibration(calibration));
  const auto source = host::parse_v4l2_source(where);
  auto real = KAZ_TRY(host::V4l2Camera::open(*source, eyes));
  return LiveCamera{std::move(real), Time::zero()};
}

Result<std::optional<vision::StereoPair>> JudgedCamera::poll() {
  auto pair = camera_.poll();
  // Pictures that are still on their way are not waited for.
  if (pair && *pair && (*pair)->images.wait_for(Time(0)) == std::future_status::ready)
    eyes_.look(*(*pair)->images.get(), (*pair)->info);
  return pair;
}

}  // namespace kaz::tools

// By the name's beginning.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/live_camera.h"

#include <cstdio>

#include "host/camera/published_camera.h"
#include "host/camera/v4l2_camera.h"
#include "host/link/wall_clock.h"
#include "vision/calibration/calibration_file.h"

namespace kaz::tools {

std::string LiveCamera::summary() const {
  const vision::Camera* inner = camera.get();
  if (const auto* returning = dynamic_cast<const ReturningCamera*>(inner))
    inner = returning->camera();
  const auto* real = dynamic_cast<const host::V4l2Camera*>(inner);
  return real != nullptr ? real->summary() : "";
}

bool is_real_camera(const std::string& where) {
  return where.starts_with(host::kV4l2);
}

Result<void> check_live_camera(const std::string& where, const std::string& calibration) {
  if (!is_real_camera(where)) {
    if (where.starts_with("/dev/video") || where.starts_with("v4l:"))
      return fail(
          Fault::usage,
          "--camera " + where +
              ": give real cameras as a pair, such as v4l2:/dev/video0,/dev/video2 (left, right)");
    if (!calibration.empty())
      return fail(Fault::usage,
                  "--calibration is only valid with real cameras (v4l2:...); pictures from " +
                      where + " are already rectified: leave out --calibration");
    return {};
  }
  KAZ_TRY(host::parse_v4l2_source(where));
  if (calibration.empty())
    return fail(Fault::usage, where +
                                  " needs --calibration FILE (kaz calibrate stereo): pictures of "
                                  "real lenses must be rectified");
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

ReturningCamera::ReturningCamera(std::unique_ptr<vision::Camera> camera, Open open, Time patience,
                                 std::function<void(const std::string&)> report)
    : camera_(std::move(camera)),
      model_(camera_->model()),
      open_(std::move(open)),
      patience_(patience),
      report_(std::move(report)) {}

ReturningCamera::~ReturningCamera() = default;  // waits for an opening in progress

Result<std::optional<vision::StereoPair>> ReturningCamera::poll() {
  const Time now = host::WallClock().now();
  if (camera_ == nullptr) {
    try_again(now);
    if (camera_ == nullptr) return std::nullopt;
  }
  auto pair = camera_->poll();
  if (!pair) {
    // What the cameras' sentence advises behind the semicolon is for a program that has ended.
    const std::string& why = pair.error().message;
    char text[80];
    std::snprintf(text, sizeof text,
                  "; the robot stands still until the cameras are back, for up to %.3g s",
                  seconds(patience_));
    report_(why.substr(0, why.find(';')) + text);
    lost_ = tried_ = now;
    camera_.reset();
    return std::nullopt;
  }
  // Numbers begin anew with each opening; those passed on do not.
  if (*pair) {
    (*pair)->info.sequence += first_sequence_;
    next_sequence_ = (*pair)->info.sequence + 1;
  }
  return pair;
}

// Opening takes longer than a control cycle, and the board's watchdog may not wait for it.
void ReturningCamera::try_again(Time now) {
  constexpr Time kBetweenTries = std::chrono::milliseconds(300);
  if (!opening_.valid()) {
    if (now - tried_ < kBetweenTries) return;
    tried_ = now;
    opening_ = std::async(std::launch::async, open_);
    return;
  }
  if (opening_.wait_for(Time(0)) != std::future_status::ready) return;
  auto opened = opening_.get();
  if (!opened) return;
  camera_ = std::move(*opened);
  first_sequence_ = next_sequence_;
  char text[60];
  std::snprintf(text, sizeof text, "the cameras are back, after %.1f s", seconds(now - lost_));
  report_(text);
}

Result<std::optional<vision::StereoPair>> JudgedCamera::poll() {
  auto pair = camera_.poll();
  // Pictures that are still on their way are not waited for.
  if (pair && *pair && (*pair)->images.wait_for(Time(0)) == std::future_status::ready)
    eyes_.look(*(*pair)->images.get(), (*pair)->info);
  return pair;
}

}  // namespace kaz::tools

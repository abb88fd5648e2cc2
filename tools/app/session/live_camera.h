// A camera that is not in this process: a published one, or two real ones at this machine.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "vision/depth/swapped_cameras.h"
#include "vision/image/frame.h"

namespace kaz::tools {

struct LiveCamera {
  std::unique_ptr<vision::Camera> camera;
  Time latency{};  // from exposure to arrival, as a publisher declares it; else zero

  // What became of the pictures of real cameras, one line; empty for others.
  std::string summary() const;
};

// Whether `where` names real cameras, as v4l2:/dev/video0,/dev/video2 (host/camera/v4l2_camera.h).
bool is_real_camera(const std::string& where);
// Checks what can be checked without opening anything; `calibration` is a file, empty for none.
Result<void> check_live_camera(const std::string& where, const std::string& calibration);
// `where`: real cameras, or else the path of a camera socket.
Result<LiveCamera> open_live_camera(const std::string& where, const std::string& calibration);

// Passes the pairs of another one on, and judges whether left and right are exchanged.
class JudgedCamera final : public vision::Camera {
 public:
  // `camera` must outlive this.
  explicit JudgedCamera(vision::Camera& camera) : camera_(camera) {}
  const vision::CameraModel& model() const override { return camera_.model(); }
  Result<std::optional<vision::StereoPair>> poll() override;
  // Over all pairs so far; one sentence, empty if nothing is wrong.
  std::string warning() const { return eyes_.found() ? vision::kSwappedCameras : ""; }

 private:
  vision::Camera& camera_;
  vision::SwappedCameras eyes_;
};

// In front of a behaviour that does not look.
class NoCamera final : public vision::Camera {
 public:
  const vision::CameraModel& model() const override { return model_; }
  Result<std::optional<vision::StereoPair>> poll() override { return std::nullopt; }

 private:
  vision::CameraModel model_;
};

}  // namespace kaz::tools

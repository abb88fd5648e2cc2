// Cameras outside of this process: a camera of another program, or two real cameras at this machine.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <string>

#include "vision/depth/swapped_cameras.h"
#include "vision/image/frame.h"

namespace kaz::tools {

// Longest time to wait for a lost real camera.
inline constexpr Time kCameraPatience = std::chrono::seconds(60);

struct LiveCamera {
  std::unique_ptr<vision::Camera> camera;
  // Time from exposure to arrival, as declared by the publisher; zero for real cameras.
  Time latency{};

  // Returns one line with the numbers of pictures that real cameras delivered; empty for a published camera.
  std::string summary() const;
};

// Returns whether `where` names real cameras, for example v4l2:/dev/video0,/dev/video2
// (host/camera/v4l2_camera.h).
bool is_real_camera(const std::string& where);
// Checks both arguments without opening a device or socket. `calibration`: path of a calibration file; empty:
// no calibration.
Result<void> check_live_camera(const std::string& where, const std::string& calibration);
// Opens real cameras if `where` names real cameras. Otherwise connects to the camera socket at the path
// `where`.
Result<LiveCamera> open_live_camera(const std::string& where, const std::string& calibration);

// Two real cameras that are opened again after a loss. While a camera is lost, poll() returns no pairs.
// Reports one line when a camera is lost, and one line when the cameras have returned.
class ReturningCamera final : public vision::Camera {
 public:
  using Open = std::function<Result<std::unique_ptr<vision::Camera>>()>;
  // `open` runs on another thread to open the cameras again. `report` receives the lines. The lines contain
  // `patience`, the timeout after which the caller gives up.
  ReturningCamera(std::unique_ptr<vision::Camera> camera, Open open, Time patience,
                  std::function<void(const std::string&)> report);
  ~ReturningCamera() override;

  const vision::CameraModel& model() const override { return model_; }
  Result<std::optional<vision::StereoPair>> poll() override;
  // Returns null while the cameras are lost.
  const vision::Camera* camera() const { return camera_.get(); }

 private:
  void try_again(Time now);

  std::unique_ptr<vision::Camera> camera_;
  const vision::CameraModel model_;
  const Open open_;
  const Time patience_;
  const std::function<void(const std::string&)> report_;
  std::future<Result<std::unique_ptr<vision::Camera>>> opening_;
  Time lost_{}, tried_{};
  // Used to give the returned pairs consecutive numbers after a loss.
  std::uint64_t first_sequence_ = 0, next_sequence_ = 0;
};

// Passes on the pairs of a camera, and checks whether the left and right camera are swapped.
class JudgedCamera final : public vision::Camera {
 public:
  // `camera` must outlive this object.
  explicit JudgedCamera(vision::Camera& camera) : camera_(camera) {}
  const vision::CameraModel& model() const override { return camera_.model(); }
  Result<std::optional<vision::StereoPair>> poll() override;
  // Returns a warning about swapped cameras, based on all pairs so far; empty if there is no problem.
  std::string warning() const { return eyes_.found() ? vision::kSwappedCameras : ""; }

 private:
  vision::Camera& camera_;
  vision::SwappedCameras eyes_;
};

// Camera without pictures, for behaviors that need no camera.
class NoCamera final : public vision::Camera {
 public:
  const vision::CameraModel& model() const override { return model_; }
  Result<std::optional<vision::StereoPair>> poll() override { return std::nullopt; }

 private:
  vision::CameraModel model_;
};

}  // namespace kaz::tools

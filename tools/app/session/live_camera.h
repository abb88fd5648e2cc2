// A camera that is not in this process: a published one, or two real ones at this machine.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <string>

#include "vision/depth/swapped_cameras.h"
#include "vision/image/frame.h"

namespace kaz::tools {

// How long a lost real camera is waited for.
inline constexpr Time kCameraPatience = std::chrono::seconds(60);

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

// Two real cameras that come back: when one is lost there are no pairs, and both are opened again until that
// succeeds. One line on standard error for each loss and each return.
class ReturningCamera final : public vision::Camera {
 public:
  using Open = std::function<Result<std::unique_ptr<vision::Camera>>()>;
  // `open` opens it again, in another thread; `report` gets the lines. `patience` is named in them: how long
  // their user waits.
  ReturningCamera(std::unique_ptr<vision::Camera> camera, Open open, Time patience,
                  std::function<void(const std::string&)> report);
  ~ReturningCamera() override;

  const vision::CameraModel& model() const override { return model_; }
  Result<std::optional<vision::StereoPair>> poll() override;
  // Null while it is lost.
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
  std::uint64_t first_sequence_ = 0, next_sequence_ = 0;  // of the pairs passed on
};

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

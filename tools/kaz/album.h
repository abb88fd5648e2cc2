// Pictures of a run, taken at a few moments: what the left eye sees, and an onlooker's view.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/behavior/sink.h"
#include "sim/runtime/simulation.h"
#include "tools/kaz/output.h"
#include "vision/frame.h"

namespace kaz::tools {

// Passes pairs through and remembers the newest.
class RememberingCamera final : public vision::Camera {
 public:
  explicit RememberingCamera(vision::Camera& camera) : camera_(camera) {}
  const vision::CameraModel& model() const override { return camera_.model(); }
  Result<std::optional<vision::StereoPair>> poll() override {
    auto pair = camera_.poll();
    if (pair && *pair) newest_ = **pair;
    return pair;
  }
  const std::optional<vision::StereoPair>& newest() const { return newest_; }

 private:
  vision::Camera& camera_;
  std::optional<vision::StereoPair> newest_;
};

class Album {
 public:
  // `simulation` may be null: then there is no onlooker.
  Album(const RememberingCamera& camera, sim::Simulation* simulation)
      : camera_(camera), simulation_(simulation) {}

  // Keeps what is to be seen now. The onlooker's view is drawn only by write().
  void take(Time now);

  // left_eye.png, color_extraction.png, outside.png of the latest moment with a ball in sight, and
  // moments.png with all of them. Returns the names written.
  Result<std::vector<std::string>> write(const OutputFolder& folder) const;

 private:
  struct Moment {
    Time time{};
    vision::StereoPair pair;
    sim::ScenePose pose;  // of the world; empty without a simulation
  };
  Result<vision::Image> outside(const Moment& moment) const;

  const RememberingCamera& camera_;
  sim::Simulation* simulation_;
  std::vector<Moment> moments_;
};

}  // namespace kaz::tools

// Pictures of a run, taken at a few moments: what the left eye sees, and an onlooker's view.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/behavior/sink.h"
#include "sim/runtime/simulation/simulation.h"
#include "tools/app/base/output.h"
#include "vision/color/ball.h"
#include "vision/image/frame.h"

namespace kaz::tools {

// Passes pairs through and remembers the newest.
class RememberingCamera final : public vision::Camera {
 public:
  explicit RememberingCamera(vision::Camera& camera,
                             std::function<void(const vision::StereoPair&)> on_pair = {})
      : camera_(camera), on_pair_(std::move(on_pair)) {}
  const vision::CameraModel& model() const override { return camera_.model(); }
  Result<std::optional<vision::StereoPair>> poll() override {
    auto pair = camera_.poll();
    if (pair && *pair) {
      newest_ = **pair;
      if (on_pair_) on_pair_(*newest_);
    }
    return pair;
  }
  const std::optional<vision::StereoPair>& newest() const { return newest_; }

 private:
  vision::Camera& camera_;
  std::function<void(const vision::StereoPair&)> on_pair_;
  std::optional<vision::StereoPair> newest_;
};

// Robot and ball from the robot's front right, so near that what is around `middle`, `extent_m` across, is
// shown; without a middle the floor before a robot at its start. World frame, m.
// Pictures are 4 : 3, `width` px wide.
sim::View onlooker_view(const std::optional<Eigen::Vector3d>& middle, double extent_m,
                        int width = 960);

// One of a run's moments, drawn.
struct MomentPictures {
  Time time{};
  std::string shown;         // what there is to see: "approach"
  vision::Image outside;     // an onlooker's view; empty without a simulation
  vision::Image left;        // the left eye, twice as large, its axis and the ball marked
  vision::Image extraction;  // the same as colour extraction has it
  bool found = false;        // the ball, in the left eye
  double distance_m = 0;     // of the ball by its size, if found
};

class Snapshots {
 public:
  // `simulation` may be null: then there is no onlooker.
  // `ball`: what is looked for in the left eye. `stopped`: whether drawing, which takes seconds, is to end.
  Snapshots(const RememberingCamera& camera, sim::Simulation* simulation,
            const vision::BallOptions& ball, std::function<bool()> stopped = nullptr)
      : camera_(camera), simulation_(simulation), ball_(ball), stopped_(std::move(stopped)) {}

  bool stopped() const { return stopped_ && stopped_(); }

  // Keeps the present pictures and poses under the name `shown`; nothing without pictures. The
  // onlooker's view is drawn only by write().
  void take(Time now, const std::string& shown);

  // In order of time; without those whose pixels are not there, and none once it is stopped.
  Result<std::vector<MomentPictures>> draw() const;

  // left_eye.png, color_extraction.png, outside.png of the latest snapshot with the ball in view, and
  // moments.png with all of them, and the same as moments.jpg, a tenth as large. Returns the names written:
  // those that were whole when it was stopped.
  Result<std::vector<std::string>> write(const OutputFolder& folder) const;

 private:
  struct Snapshot {
    Time time{};
    std::string shown;
    vision::StereoPair pair;
    sim::ScenePose pose;                  // of the world; empty without a simulation
    std::optional<Eigen::Vector3d> near;  // where an onlooker looks from close by
    double extent_m = 0;                  // of what is in view there
  };
  Result<vision::Image> outside(const Snapshot& snapshot) const;

  const RememberingCamera& camera_;
  sim::Simulation* simulation_;
  vision::BallOptions ball_;
  std::function<bool()> stopped_;
  std::vector<Snapshot> moments_;
};

}  // namespace kaz::tools

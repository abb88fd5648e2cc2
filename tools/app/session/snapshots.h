// Pictures of selected moments of a run: the left eye's picture and an external view.
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

// Passes pairs through and stores the newest.
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

// Returns a 4 : 3 view of robot and ball from the robot's front right, `width` px wide. It shows the
// surroundings of `middle` with a size of `extent_m`. Without a middle it shows the floor in front of a robot
// at its start. World frame, m.
sim::View onlooker_view(const std::optional<Eigen::Vector3d>& middle, double extent_m,
                        int width = 960);

// Pictures of one moment.
struct MomentPictures {
  Time time{};
  std::string shown;         // name of the moment: "approach"
  vision::Image outside;     // external view; empty without a simulation
  vision::Image left;        // the left eye, enlarged twice, with its axis and the ball marked
  vision::Image extraction;  // the same with the pixels that color extraction selects
  bool found = false;        // ball found in the left eye
  double distance_m = 0;     // distance of the ball by its size, if found
};

class Snapshots {
 public:
  // `simulation` may be null: then there are no external views. `ball`: the ball to look for in the left eye.
  // `stopped`: returns whether to stop drawing, which takes seconds. The referenced objects must outlive
  // this.
  Snapshots(const RememberingCamera& camera, sim::Simulation* simulation,
            const vision::BallOptions& ball, std::function<bool()> stopped = nullptr)
      : camera_(camera), simulation_(simulation), ball_(ball), stopped_(std::move(stopped)) {}

  bool stopped() const { return stopped_ && stopped_(); }

  // Stores the newest pair and the present poses under the name `shown`. Does nothing before the first pair.
  // write() and draw() draw the external view later.
  void take(Time now, const std::string& shown);

  // Draws all moments in order of time. Leaves out moments without pixels. Returns none once stopped.
  Result<std::vector<MomentPictures>> draw() const;

  // Writes left_eye.png, color_extraction.png and outside.png of the latest snapshot in which the ball was
  // found (the first one if it never was). Writes all moments to moments.png, and to moments.jpg at a tenth
  // of the size. Returns the names of the files written before it was stopped.
  Result<std::vector<std::string>> write(const OutputFolder& folder) const;

 private:
  struct Snapshot {
    Time time{};
    std::string shown;
    vision::StereoPair pair;
    sim::ScenePose pose;                  // whole world; empty without a simulation
    std::optional<Eigen::Vector3d> near;  // target of a close external view
    double extent_m = 0;                  // size of the subject in that view
  };
  Result<vision::Image> outside(const Snapshot& snapshot) const;

  const RememberingCamera& camera_;
  sim::Simulation* simulation_;
  vision::BallOptions ball_;
  std::function<bool()> stopped_;
  std::vector<Snapshot> moments_;
};

}  // namespace kaz::tools

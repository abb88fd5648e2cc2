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
#include "tools/base/output.h"
#include "tools/run/run_observer.h"
#include "vision/color/ball.h"
#include "vision/image/frame.h"

namespace kaz::tools {

// Passes on the pairs of a camera, also to the run's observer, and stores the newest pair.
class RememberingCamera final : public vision::Camera {
 public:
  RememberingCamera(vision::Camera& camera, RunObserver& observer)
      : camera_(camera), observer_(observer) {}
  const vision::CameraModel& model() const override { return camera_.model(); }
  Result<std::optional<vision::StereoPair>> poll() override {
    auto pair = camera_.poll();
    if (pair && *pair) {
      newest_ = **pair;
      observer_.pair(*newest_);
    }
    return pair;
  }
  const std::optional<vision::StereoPair>& newest() const { return newest_; }

 private:
  vision::Camera& camera_;
  RunObserver& observer_;
  std::optional<vision::StereoPair> newest_;
};

// Returns a 4 : 3 view of robot and ball from the robot's front right, `width` px wide. The view is centered
// on `middle` and shows an area with a size of `extent_m`. If `middle` is empty, the view shows the floor in
// front of a robot at its start. World frame, m.
sim::View onlooker_view(const std::optional<Eigen::Vector3d>& middle, double extent_m,
                        int width = 960);

// Pictures of one moment.
struct MomentPictures {
  Time time{};
  std::string shown;      // name of the moment: "approach"
  vision::Image outside;  // external view; empty without a simulation
  // Picture of the left eye, enlarged by 2, in which the eye's axis and the ball are marked.
  vision::Image left;
  // Picture of the left eye that shows the pixels selected by color extraction.
  vision::Image extraction;
  bool found = false;     // the ball was found in the left eye's picture
  double distance_m = 0;  // distance of the ball computed from its size; valid if `found`
};

class Snapshots {
 public:
  // If `simulation` is null, there are no external views. `ball`: the ball to look for in the left eye's
  // pictures. `stopped`: returns true to stop drawing early, because drawing takes seconds. `camera` and
  // `simulation` must outlive this object.
  Snapshots(const RememberingCamera& camera, sim::Simulation* simulation,
            const vision::BallOptions& ball, std::function<bool()> stopped = nullptr)
      : camera_(camera), simulation_(simulation), ball_(ball), stopped_(std::move(stopped)) {}

  bool stopped() const { return stopped_ && stopped_(); }

  // Stores the newest pair and the present poses under the name `shown`. Does nothing if there is no pair
  // yet. The external view is drawn later, by write().
  void take(Time now, const std::string& shown);

  // Writes left_eye.png, color_extraction.png and outside.png of the latest snapshot in which the ball was
  // found. If the ball was never found, uses the first snapshot. Writes all moments to moments.png. The file
  // moments.jpg shows the same picture in about a tenth of the file size. Returns the names of the written
  // files. If `stopped` returns true, the remaining files are not written.
  Result<std::vector<std::string>> write(const OutputFolder& folder) const;

 private:
  struct Snapshot {
    Time time{};
    std::string shown;
    vision::StereoPair pair;
    sim::ScenePose pose;                  // poses of the whole world; empty without a simulation
    std::optional<Eigen::Vector3d> near;  // point at the center of a close external view
    double extent_m = 0;                  // size of the subject in the close external view
  };
  Result<vision::Image> outside(const Snapshot& snapshot) const;
  // Draws all moments in order of time. Leaves out moments whose pictures have no pixels. If `stopped`
  // returns true, returns an empty list.
  Result<std::vector<MomentPictures>> draw() const;

  const RememberingCamera& camera_;
  sim::Simulation* simulation_;
  vision::BallOptions ball_;
  std::function<bool()> stopped_;
  std::vector<Snapshot> moments_;
};

}  // namespace kaz::tools

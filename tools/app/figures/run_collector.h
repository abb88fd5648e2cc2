// Collects the data of the paper's figures during a run.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/behavior/sink.h"
#include "host/map/local_map.h"
#include "shared/base/result.hpp"
#include "sim/runtime/simulation/simulation.h"
#include "tools/app/session/session.h"
#include "vision/color/ball.h"
#include "vision/depth/depth.h"
#include "vision/flow/flow.h"
#include "vision/planes/plane_segments.h"

namespace kaz::tools {

// Figure 3: one frame with the ball in view, and the results of vision for this frame. `outside` shows the
// world at the exposure of the frame.
struct SceneView {
  std::shared_ptr<const vision::StereoImages> images;
  vision::BallObservation ball;  // ball.info is the frame information
  vision::DepthImage depth;
  vision::FlowImage flow;      // flow since the previous frame
  double ball_moved_px = 0;    // motion of the ball since the previous frame
  vision::Image outside = {};  // external view
};

// Figure 5: the world before the robot moves.
struct SetupView {
  vision::Image from_side, from_above;
  // Positions in the view from above, px. ball_px is empty if there is no ball.
  std::pair<double, double> robot_px{0, 0};
  std::optional<std::pair<double, double>> ball_px;
  std::optional<Eigen::Vector2d> ball_m;  // position relative to the robot's start; x ahead, y left
};

// Figure 6: one frame taken while the robot looks around.
struct PlaneView {
  double wanted_pan_rad = 0, pan_rad = 0;  // commanded and actual head angle; positive to the left
  std::shared_ptr<const vision::StereoImages> images;
  vision::PlaneSegments planes;  // planes.info is the frame information
  vision::DepthImage depth;
};

// Figure 6: map and path when the robot begins to walk.
struct PlanView {
  Time time{};
  map::LocalMap map;
  Eigen::Vector2d robot{0, 0}, goal{0, 0};
  double heading_rad = 0;
  std::vector<Eigen::Vector2d> path;  // corners of the path, from the robot to its destination
};

// Observes one session. Collects only the behavior's reports, its pictures and external views. Ground truth
// is used only to direct the camera of the external views.
class RunCollector final : public Onlooker, public VisionWatcher, public behavior::Sink {
 public:
  struct Wanted {
    bool scene = false, setup = false, plan = false, moments = false;
  };
  explicit RunCollector(Wanted wanted) : wanted_(wanted) {}
  // Adds this object, and the vision modules that the object needs, to the options of a session. The object
  // must outlive the session.
  void listen(SessionOptions& options);

  const std::optional<SceneView>& scene() const { return scene_; }
  const std::optional<SetupView>& setup() const { return setup_; }
  const std::vector<PlaneView>& look_around() const { return look_around_; }
  const std::optional<PlanView>& plan() const { return plan_; }
  const std::vector<MomentPictures>& moments() const { return moments_; }
  // Error of a view that could not be drawn; empty if all views were drawn.
  const std::optional<Error>& error() const { return error_; }

  void look(sim::Simulation& simulation) override;
  void begin(vision::Pipeline& pipeline) override;
  void end(const vision::Pipeline& pipeline) override;
  void phase(Time time, std::string_view behavior, std::string_view phase) override;
  void map(const behavior::MapReport& report) override;

 private:
  // State of the world at one time, for drawing external views.
  struct Pose {
    Time time{};
    sim::ScenePose scene;
    Eigen::Vector3d trunk{0, 0, 0};
    std::optional<Eigen::Vector3d> ball;
  };
  struct Seen {
    std::uint64_t sequence = 0;
    std::optional<vision::BallObservation> ball;
    std::optional<vision::FlowImage> flow;
  };
  Seen& seen(std::uint64_t sequence);
  void consider(const vision::Frame& frame, const vision::DepthImage& depth);
  void consider(const vision::Frame& frame, const vision::PlaneSegments& planes);
  Pose pose_of(const sim::Simulation& simulation) const;
  void draw_setup(sim::Simulation& simulation);
  vision::Image drawn(sim::Simulation& simulation, const sim::View& view,
                      const sim::ScenePose& pose);

  Wanted wanted_;
  sim::Simulation* simulation_ = nullptr;
  std::deque<Pose> poses_;  // newest poses
  std::deque<Seen> seen_;   // results of the newest frames
  std::optional<vision::BallObservation> ball_before_;
  std::optional<Pose> scene_pose_;
  double scene_score_ = 0;
  bool looks_around_ = false;
  std::optional<SceneView> scene_;
  std::optional<SetupView> setup_;
  std::vector<PlaneView> look_around_;
  std::optional<PlanView> plan_;
  std::vector<MomentPictures> moments_;
  std::optional<Error> error_;
};

}  // namespace kaz::tools

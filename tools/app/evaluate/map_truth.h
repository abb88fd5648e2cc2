// How far the map of a walking robot agrees with what truly stands about.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "host/behavior/sink.h"
#include "shared/base/time.hpp"
#include "tools/app/evaluate/obstacle.h"
#include "tools/app/evaluate/own_body.h"
#include "vision/image/frame.h"

namespace kaz::tools {

// Frame: from between the feet of the start; x ahead, y left; m, rad. A map is compared where the robot is in
// truth: the drift of its odometry, which is judged by where it arrives, does not count here.
//
// Obstacles: points of their outlines, 1 cm apart, that lay in both eyes' pictures within 1 m, hidden by
// nothing, the robot's own limbs included, for half a second or more; found are those with an obstacle's cell
// of the map within 2.5 cm. Each counts at every report from then on, however long ago it was in view.
// In view: of these, points that were so in both eyes' pictures 2 s or less before the report: what the look
// before a plan shows, and the last steps. Pictures that the behaviour does not enter (turns) count, too.
// Floor: cells within 1 m that the map knows, 2 cm or more from anything that stands there; wrong are those
// that it has as obstacles. A cell's state is the one by which paths are planned, LocalMap::certain().
// Counted at every report.
class MapTruth {
 public:
  // Those that slide or roll are left out, and so is what is near them.
  explicit MapTruth(const std::vector<Obstacle>& obstacles);

  // Whether the next look counts: those nearer together than 0.1 s are left out.
  bool looks_at(Time now) const;
  // What the eyes see now. `start_from_eye`: optical frame of the left one; `own`: the robot, where it is now
  // in the frame of the start, if any of it may be in view.
  void look(Time now, const Eigen::Isometry3d& start_from_eye, const vision::CameraModel& camera,
            const OwnBody* own = nullptr);
  // `robot`: its true place and heading.
  void compare(const behavior::MapReport& report, const Eigen::Isometry2d& robot);

  // `outline_points`, `outline_found`, `outline_points_in_view`, `outline_found_in_view`, `floor_cells`,
  // `floor_wrong`.
  nlohmann::ordered_json json() const;

 private:
  struct Outline {
    Eigen::Vector2d at;
    double seen_s = 0;
    Time newest{};  // look that had it in view; of those with seen_s > 0
  };
  bool hidden(const Eigen::Vector2d& from, const Eigen::Vector2d& at) const;

  std::vector<Obstacle> fixed_, loose_;
  std::vector<Outline> outline_;
  Time looked_{-1};
  std::int64_t points_ = 0, found_ = 0, points_in_view_ = 0, found_in_view_ = 0, cells_ = 0,
               wrong_ = 0;
};

}  // namespace kaz::tools

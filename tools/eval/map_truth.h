// Compares the map of a walking robot with the true obstacles.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "host/behavior/sink.h"
#include "shared/base/time.hpp"
#include "tools/eval/obstacle.h"
#include "tools/eval/own_body.h"
#include "vision/image/frame.h"

namespace kaz::tools {

// Coordinate frame: origin between the feet of the robot at the start; x ahead, y left; m, rad. A map is
// compared relative to the robot's true pose, so drift of the robot's odometry does not count as an error.
// This drift appears in the robot's final distance from the goal instead. Each report of a map is compared,
// and three kinds of points and cells are counted:
//
// - Outline points lie on the outlines of obstacles, 1 cm apart. A point counts after it was visible in both
//   eyes' pictures, at most 1 m away, for at least 0.5 s in total. A point is not visible if another obstacle
//   or a limb of the robot hides the point. From then on, the point counts at every report that the robot
//   makes within 1 m of the point. The point is found if the map has an obstacle cell within 2.5 cm of the
//   point.
// - Outline points in view are outline points that were visible at most 2 s before the report. This time
//   covers the look before a plan and the last steps. Pictures that the behavior does not add to its map, for
//   example during turns, also count as looks.
// - Floor cells are known cells within 1 m of the robot, and at least 2 cm from any obstacle. A floor cell is
//   wrong if the map marks the cell as an obstacle.
//
// The compared state of a cell is the state used for planning, LocalMap::certain().
class MapTruth {
 public:
  // Leaves out obstacles that slide or roll, and all points and cells within 0.3 m of these obstacles.
  explicit MapTruth(const std::vector<Obstacle>& obstacles);

  // Returns whether a look at the time `now` would count. A look less than 0.1 s after the previous look does
  // not count.
  bool looks_at(Time now) const;
  // Adds the points that the eyes see now. `start_from_eye`: pose of the left eye's optical frame in the
  // frame of the start. `own`: shapes of the robot in the frame of the start, if the robot's limbs may be in
  // view; else null.
  void look(Time now, const Eigen::Isometry3d& start_from_eye, const vision::CameraModel& camera,
            const OwnBody* own = nullptr);
  // Compares one reported map. `robot`: true position and heading of the robot.
  void compare(const behavior::MapReport& report, const Eigen::Isometry2d& robot);

  // Returns the counts over all reports: `outline_points`, `outline_found`, `outline_points_in_view`,
  // `outline_found_in_view`, `floor_cells` and `floor_wrong`.
  nlohmann::ordered_json json() const;

 private:
  struct Outline {
    Eigen::Vector2d at;
    double seen_s = 0;
    Time newest{};  // time of the last look in which the point was visible; valid if seen_s > 0
  };
  bool hidden(const Eigen::Vector2d& from, const Eigen::Vector2d& at) const;

  std::vector<Obstacle> fixed_, loose_;
  std::vector<Outline> outline_;
  Time looked_{-1};
  std::int64_t points_ = 0, found_ = 0, points_in_view_ = 0, found_in_view_ = 0, cells_ = 0,
               wrong_ = 0;
};

}  // namespace kaz::tools

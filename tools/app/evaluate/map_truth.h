// Compares the map of a walking robot with the true obstacles.
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

// Frame: between the feet at the start; x ahead, y left; m, rad. A map is compared relative to the robot's
// true pose. So drift of its odometry does not count here; the position of arrival shows that. Counts at
// every report:
//
// - Outline points lie on the outlines of obstacles, 1 cm apart. A point counts once it has been visible in
//   both eyes' pictures, at most 1 m away, for at least 0.5 s in total. Other obstacles and the robot's own
//   limbs may hide it. From then on it counts at every report within 1 m of it. It is found if the map has an
//   obstacle cell within 2.5 cm.
// - Outline points in view were last visible at most 2 s before the report: during the look before a plan and
//   the last steps. Pictures that the behavior does not add to its map (turns) count, too.
// - Floor cells are known cells within 1 m of the robot, and at least 2 cm from any obstacle. They are wrong
//   if the map has them as obstacles.
//
// A cell's state is the one used for planning, LocalMap::certain().
class MapTruth {
 public:
  // Leaves out obstacles that slide or roll, and everything within 0.3 m of them.
  explicit MapTruth(const std::vector<Obstacle>& obstacles);

  // Whether the next look would count. Looks less than 0.1 s after the last one do not count.
  bool looks_at(Time now) const;
  // Adds what the eyes see now. `start_from_eye`: pose of the left eye's optical frame. `own`: the robot's
  // shapes in the frame of the start, if its limbs may be in view; else null.
  void look(Time now, const Eigen::Isometry3d& start_from_eye, const vision::CameraModel& camera,
            const OwnBody* own = nullptr);
  // Compares one report. `robot`: true position and heading.
  void compare(const behavior::MapReport& report, const Eigen::Isometry2d& robot);

  // Counts: `outline_points`, `outline_found`, `outline_points_in_view`, `outline_found_in_view`,
  // `floor_cells` and `floor_wrong`.
  nlohmann::ordered_json json() const;

 private:
  struct Outline {
    Eigen::Vector2d at;
    double seen_s = 0;
    Time newest{};  // last look in which it was visible; valid if seen_s > 0
  };
  bool hidden(const Eigen::Vector2d& from, const Eigen::Vector2d& at) const;

  std::vector<Obstacle> fixed_, loose_;
  std::vector<Outline> outline_;
  Time looked_{-1};
  std::int64_t points_ = 0, found_ = 0, points_in_view_ = 0, found_in_view_ = 0, cells_ = 0,
               wrong_ = 0;
};

}  // namespace kaz::tools

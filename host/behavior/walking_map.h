// The local map of a robot that walks: pictures entered where the robot was when they were exposed.
// SPDX-License-Identifier: Apache-2.0
//
// Frame: odometry's, which is the foot frame of the start: x ahead, y left, origin below the hips. m, rad.
#pragma once

#include <optional>
#include <vector>

#include "host/behavior/floor_detector.h"
#include "host/behavior/place_history.h"
#include "host/map/floor_texture.h"
#include "host/map/local_map.h"
#include "host/map/pose_filter.h"

namespace kaz::behavior {

class WalkingMap {
 public:
  explicit WalkingMap(map::LocalMap map) : map_(std::move(map)) {}

  // Pictures of which posture or place are not known are left out. Errors: of LocalMap::update() but for
  // these.
  Result<void> enter(const std::vector<FloorPicture>& pictures, const PlaceHistory& places);

  // Odometry's place as the floor's pattern has corrected it.
  motion::Place corrected(const motion::Place& place) const;
  // Compares the floor's pattern in a picture of a standing robot with what was remembered, the oldest first,
  // and corrects. True if any matched.
  bool align(const FloorPicture& picture, const PlaceHistory& places);
  // Remembers the pattern, to be compared with later.
  void remember(const FloorPicture& picture, const PlaceHistory& places);
  // Where patterns lie that a robot at `place` can look at, the oldest first: directions, rad, + to its left,
  // each more than 25 degrees from those before.
  std::vector<double> directions_of_patterns(const motion::Place& place) const;
  int corrections() const { return corrections_; }

  const map::LocalMap& map() const { return map_; }
  // Exposure of the newest picture entered; zero before the first.
  Time newest() const { return newest_; }
  // Pictures entered that were exposed at `since` or later.
  int entered_since(Time since) const;

 private:
  void fade(const motion::Place& place);
  struct Remembered {
    map::FloorView view;
    int pose = 0;           // its number in the filter
    Eigen::Vector3d drawn;  // where the robot was taken to be
  };
  map::FloorPictureView view_of(const FloorPicture& picture, const Eigen::Isometry3d& foot) const;
  // `now`: where the robot is taken to be.
  bool match(const Remembered& before, map::FloorMatcher& matcher, const Eigen::Vector3d& now);
  // Pose of the foot at the exposure; nothing where posture or place are not known.
  std::optional<Eigen::Isometry3d> foot_at(const FloorPicture& picture,
                                           const PlaceHistory& places) const;

  map::LocalMap map_;
  Time newest_{};
  std::vector<Time> entered_;                           // exposures of the newest pictures
  std::optional<motion::Place> faded_at_, matched_at_;  // by odometry
  map::PoseFilter pose_;
  std::vector<Remembered> remembered_;
  int corrections_ = 0;
};

// Pose of the supporting sole (vision/image/frame.h) in the map, from odometry's place and joint angles of
// the same time.
Eigen::Isometry3d map_from_foot(const motion::Place& place, const std::vector<double>& joint_rad);

// The floor ahead of a robot at `place`: how far it may walk straight ahead, as far as `until_m`.
struct Ahead {
  double clear_m = 0;  // nothing is in the way of the robot's middle so far
  enum class By { nothing, obstacle, unknown } by = By::nothing;
  Eigen::Vector2d where{0, 0};  // of what ends it
};
// `unknown_ends`: floor that was not seen ends it, too.
Ahead look_ahead(const map::LocalMap& map, const motion::Place& place, double until_m,
                 bool unknown_ends);

}  // namespace kaz::behavior

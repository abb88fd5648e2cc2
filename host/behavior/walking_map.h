// Local map of a walking robot. Enters each picture into the map with the robot's pose at the exposure.
// SPDX-License-Identifier: Apache-2.0
//
// All positions are in the odometry frame. This frame is the robot's foot frame at the start of the run. Its
// x axis points ahead, its y axis points left, and its origin is below the hips. Units: m, rad.
#pragma once

#include <optional>
#include <vector>

#include "host/behavior/place_history.h"
#include "host/behavior/vision.h"
#include "host/map/floor_texture.h"
#include "host/map/local_map.h"
#include "host/map/pose_filter.h"

namespace kaz::behavior {

class WalkingMap {
 public:
  explicit WalkingMap(map::LocalMap map) : map_(std::move(map)) {}

  // Enters pictures into the map. Skips pictures with unknown posture or place, and pictures that are not
  // newer than the newest entered picture. Returns the errors of LocalMap::update().
  Result<void> enter(const std::vector<FloorPicture>& pictures, const PlaceHistory& places);

  // Returns the place after the correction by floor-pattern matches. The standard deviations are not
  // corrected.
  motion::Place corrected(const motion::Place& place) const;
  // Compares the floor pattern in a picture with the remembered views, oldest first, and corrects the pose.
  // The robot must have stood still at the exposure. Returns true if any view matched.
  bool align(const FloorPicture& picture, const PlaceHistory& places);
  // Remembers the floor pattern in the picture for later comparison. At most 60 views are remembered.
  void remember(const FloorPicture& picture, const PlaceHistory& places);
  // Returns the directions (rad, positive to the left) in which a robot at `place` can look at remembered
  // patterns, oldest pattern first. Any two directions in the result differ by more than 25 degrees.
  std::vector<double> directions_of_patterns(const motion::Place& place) const;
  // Number of calls of align() that corrected the pose.
  int corrections() const { return corrections_; }

  const map::LocalMap& map() const { return map_; }
  // Exposure of the newest picture entered; zero before the first picture.
  Time newest() const { return newest_; }
  // Returns the number of entered pictures that were exposed at `since` or later. Only the 64 newest pictures
  // are counted.
  int entered_since(Time since) const;

 private:
  void fade(const motion::Place& place);
  struct Remembered {
    map::FloorView view;
    int pose = 0;           // number of this view's pose, from PoseFilter::remember()
    Eigen::Vector3d drawn;  // estimated pose at the time when the view was remembered
  };
  map::FloorPictureView view_of(const FloorPicture& picture, const Eigen::Isometry3d& foot) const;
  // Compares the picture in `matcher` with the remembered view `before`. If the picture matches this view,
  // and the pose filter accepts the match, corrects the pose and returns true. `now`: estimated pose of the
  // robot at the exposure of the picture.
  bool match(const Remembered& before, map::FloorMatcher& matcher, const Eigen::Vector3d& now);
  // Pose of the foot at the exposure; nothing if the posture or the place is unknown.
  std::optional<Eigen::Isometry3d> foot_at(const FloorPicture& picture,
                                           const PlaceHistory& places) const;

  map::LocalMap map_;
  Time newest_{};
  std::vector<Time> entered_;  // exposures of the newest pictures
  // `faded_at_`: place of the robot at the last fading of the map in fade(). `matched_at_`: place of the
  // robot when a floor pattern last matched. `faded_at_` and `matched_at_` come from odometry alone, without
  // the corrections by floor patterns.
  std::optional<motion::Place> faded_at_, matched_at_;
  map::PoseFilter pose_;
  std::vector<Remembered> remembered_;
  int corrections_ = 0;
};

// Returns the pose of the supporting sole (vision/image/frame.h) in the map. `place` and the joint angles
// `joint_rad` must describe the robot at the same time. `joint_rad` must have KZ_JOINTS elements.
Eigen::Isometry3d map_from_foot(const motion::Place& place, const std::vector<double>& joint_rad);

// Result of look_ahead().
struct Ahead {
  double clear_m = 0;  // distance that the robot's center can move straight ahead
  enum class By { nothing, obstacle, unknown } by = By::nothing;
  Eigen::Vector2d where{0, 0};  // position of the obstacle or unknown cell that limits clear_m
};
// Returns how far a robot at `place` may walk straight ahead, at most `until_m`. If `unknown_ends` is true,
// unknown floor limits the distance in the same way as an obstacle.
Ahead look_ahead(const map::LocalMap& map, const motion::Place& place, double until_m,
                 bool unknown_ends);

}  // namespace kaz::behavior

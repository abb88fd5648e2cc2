// The local map: its cells, queries, and validation of updates.
// SPDX-License-Identifier: Apache-2.0
#include "host/map/local_map.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "host/map/votes.h"

namespace kaz::map {

using Eigen::Isometry3d;

namespace {

constexpr double kLevelShare = 0.1;  // of the picture, that shows the floor's plane

// Turns and lifts the eye so that the largest floor segment, of points p with n . p = -d in the optical
// frame, is z = 0: the least turn of R n onto z, and the height d.
void level(Isometry3d& eye, const vision::PlaneSegments& planes) {
  const vision::PlaneSegment* largest = nullptr;
  for (const vision::PlaneSegment& s : planes.segments) {
    if (s.floor && (largest == nullptr || s.pixels > largest->pixels)) largest = &s;
  }
  if (largest == nullptr || largest->pixels < kLevelShare * planes.width * planes.height) return;
  const Eigen::Vector3d up = eye.linear() * largest->normal;
  eye.linear() =
      Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ()).toRotationMatrix() *
      eye.linear();
  eye.translation().z() = largest->distance_m;
}

}  // namespace

Result<LocalMap> LocalMap::make(const LocalMapOptions& o) {
  const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
  if (!positive(o.cell_m) || !positive(o.size_m) || o.size_m < 2 * o.cell_m ||
      o.size_m > 2000 * o.cell_m)
    return fail(Fault::usage,
                "the local map must have 2 to 2000 cells per side: change cell_m or size_m");
  if (!positive(o.farthest_m) || !positive(o.drop_m) || !positive(o.obstacle_m) ||
      !positive(o.robot_m) || !positive(o.disparity_error_px) || !(o.own_m >= 0) ||
      o.robot_m <= o.obstacle_m)
    return fail(Fault::usage,
                "local map: farthest_m, drop_m, obstacle_m, robot_m and disparity_error_px must be "
                "above 0; own_m must be at least 0; robot_m must be above obstacle_m");
  return LocalMap(o);
}

LocalMap::LocalMap(const LocalMapOptions& options)
    : options_(options), cells_(static_cast<int>(std::lround(options.size_m / options.cell_m))) {
  clear();
}

void LocalMap::clear() {
  const auto all = static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_);
  odds_.assign(all, 0);
  seen_.assign(all, 0);
  hits_.assign(all, 0);
  points_.assign(all, 0);
  touched_.clear();
  for (std::vector<int>* row : {&row_u_, &row_v_, &row_vote_})
    row->assign(static_cast<std::size_t>(cells_) + 1, 0);
  counts_ = {};
  last_ = {};
}

void LocalMap::fade(double share) {
  const double kept = std::clamp(share, 0.0, 1.0);
  for (std::int16_t& odds : odds_) odds = static_cast<std::int16_t>(kept * odds);
}

Result<void> LocalMap::check(const vision::PlaneSegments& planes, const vision::DepthImage& depth,
                             const vision::FrameInfo& info, const Isometry3d& map_from_foot) {
  const std::string picture = "picture " + std::to_string(info.sequence);
  if (!info.posture_known) {
    ++counts_.without_posture;
    return fail(Fault::failed, picture +
                                   " is not entered into the map: the posture at its exposure is "
                                   "not known");
  }
  if (counts_.updates > 0 && info.exposure <= last_) {
    ++counts_.out_of_order;
    return fail(Fault::failed,
                picture +
                    " is not entered into the map: its exposure is not later than the exposure of "
                    "the previous picture; clear the map if the clock was set back");
  }
  const auto pixels =
      static_cast<std::size_t>(depth.width) * static_cast<std::size_t>(std::max(0, depth.height));
  if (depth.width <= 0 || depth.height <= 0 || planes.width != depth.width ||
      planes.height != depth.height || depth.disparity_px.size() != pixels ||
      planes.label.size() != pixels || planes.info.sequence != depth.info.sequence ||
      planes.info.exposure != depth.info.exposure)
    return fail(Fault::usage, picture + ": planes and depth image belong to different pairs");
  std::uint8_t largest = 0;
  for (const std::uint8_t label : planes.label) largest = std::max(largest, label);
  if (largest > planes.segments.size())
    return fail(Fault::usage, picture + ": a pixel refers to a missing segment");
  const vision::CameraModel& c = info.camera;
  if (c.width != depth.width || c.height != depth.height || !(c.fx > 0) || !(c.fy > 0) ||
      !(c.baseline_m > 0) || !std::isfinite(c.fx * c.fy * c.baseline_m + c.cx + c.cy))
    return fail(Fault::usage, picture + ": its camera model has no focal length, no baseline, or " +
                                  "another size than the depth image");
  if (!info.foot_from_eye.matrix().allFinite() || !map_from_foot.matrix().allFinite())
    return fail(Fault::usage, picture + ": the pose of the eye or of the foot is not finite");
  return {};
}

Result<void> LocalMap::update(const vision::PlaneSegments& planes, const vision::DepthImage& depth,
                              const vision::FrameInfo& info, const Isometry3d& map_from_foot,
                              std::span<const OwnPart> own) {
  if (auto fine = check(planes, depth, info, map_from_foot); !fine) return fine;
  ++counts_.updates;
  last_ = info.exposure;
  View view(info.camera, map_from_foot * info.foot_from_eye, options_);
  row_up_.resize(static_cast<std::size_t>(depth.width));
  own_.assign(depth.disparity_px.size(), 0);
  for (const OwnPart& part : own) mask(part, info);
  const Eigen::Vector2d foot = map_from_foot.translation().head<2>();
  level(view.eye, planes);
  see_floor(view, planes, foot);
  see_obstacles(view, planes, depth, foot);
  enter_obstacles(view, depth.width);
  return {};
}

int LocalMap::number(double m) const {
  const double cell = std::floor(m / options_.cell_m + 0.5 * cells_);
  return std::isfinite(cell) ? static_cast<int>(std::clamp(cell, -1.0, 1.0 * cells_)) : -1;
}

double LocalMap::middle(int cell) const {
  return (cell + 0.5 - 0.5 * cells_) * options_.cell_m;
}

double LocalMap::log_odds(int x, int y) const {
  const bool inside = x >= 0 && y >= 0 && x < cells_ && y < cells_;
  return inside ? odds_[index(x, y)] * kStep : 0;
}

Cell LocalMap::cell(int x, int y) const {
  const double odds = log_odds(x, y);
  if (std::abs(odds) < kKnown) return {};
  return {odds > 0 ? CellState::obstacle : CellState::floor, std::tanh(0.5 * std::abs(odds))};
}

CellState LocalMap::certain(int x, int y) const {
  const CellState state = cell(x, y).state;
  const bool one_vote = log_odds(x, y) < kObstacleVote + kStep;
  return state == CellState::obstacle && one_vote ? CellState::unknown : state;
}

Footprint LocalMap::footprint(const Eigen::Isometry2d& pose, double length_m,
                              double width_m) const {
  const Eigen::Vector2d half(0.5 * length_m, 0.5 * width_m), middle = pose.translation();
  if (!pose.matrix().allFinite() || !(length_m > 0) || !(width_m > 0)) return Footprint::unknown;
  const Eigen::Vector2d reach = pose.linear().cwiseAbs() * half;
  const auto outside = [&](double m) { return std::abs(m) > 0.5 * cells_ * options_.cell_m; };
  bool known = !outside(middle.x() - reach.x()) && !outside(middle.x() + reach.x()) &&
               !outside(middle.y() - reach.y()) && !outside(middle.y() + reach.y());
  // A footprint smaller than a cell may cover no cell's middle: its own counts then.
  bool any = false;
  const auto look = [&](int x, int y) {
    const CellState state = cell(x, y).state;
    any = true;
    known = known && state != CellState::unknown;
    return state == CellState::obstacle;
  };
  for (int x = number(middle.x() - reach.x()); x <= number(middle.x() + reach.x()); ++x) {
    for (int y = number(middle.y() - reach.y()); y <= number(middle.y() + reach.y()); ++y) {
      const Eigen::Vector2d at =
          pose.linear().transpose() * (Eigen::Vector2d(this->middle(x), this->middle(y)) - middle);
      if ((at.cwiseAbs() - half).maxCoeff() > 0) continue;
      if (look(x, y)) return Footprint::blocked;
    }
  }
  if (!any && look(number(middle.x()), number(middle.y()))) return Footprint::blocked;
  return known ? Footprint::free : Footprint::unknown;
}

vision::Image LocalMap::picture() const {
  constexpr double kGrey[3] = {150, 153, 156}, kGreen[3] = {33, 140, 77}, kRed[3] = {214, 48, 38};
  vision::Image image{cells_, cells_, {}};
  image.rgb.reserve(odds_.size() * 3);
  for (int row = 0; row < cells_; ++row) {
    for (int column = 0; column < cells_; ++column) {
      const Cell c = cell(cells_ - 1 - row, cells_ - 1 - column);
      const double* to = c.state == CellState::obstacle ? kRed : kGreen;
      const double share = c.state == CellState::unknown ? 0 : 0.35 + 0.65 * c.confidence;
      for (int k = 0; k < 3; ++k)
        image.rgb.push_back(
            static_cast<std::uint8_t>(std::lround((1 - share) * kGrey[k] + share * to[k])));
    }
  }
  return image;
}

}  // namespace kaz::map

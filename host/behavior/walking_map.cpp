// Enters pictures by odometry; reads the way ahead.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/walking_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/motion/body_model.h"
#include "host/robot/kinematics.h"
#include "shared/base/angle.hpp"

namespace kaz::behavior {

namespace {

using Eigen::Vector2d, Eigen::Vector3d;

// Odometry errs by 1.5 % of the way and a degree of a turn: after 2 m, or a full turn, what was not
// seen again has a seventh of its evidence left; after twice as much where the floor's pattern has corrected
// the place so near by.
constexpr double kFadeEvery_m = 0.1, kFadeEvery_rad = 18 * kDegree, kFade = 0.9,
                 kFadeCorrected = 0.95;
constexpr double kCorrectedWithin_m = 0.5, kCorrectedWithin_rad = 90 * kDegree;
constexpr std::size_t kRemembered = 64;    // pictures
constexpr std::size_t kViews = 60;         // of the floor's pattern
constexpr int kMinPattern = 2500;          // of its cells known: 0.16 m^2
constexpr double kAnother = 25 * kDegree;  // of directions
constexpr double kViewNear = 0.25, kViewFar = 0.8, kViewAside = 60 * kDegree;
// Of a match, one sigma, as 550 of them were against truth (decision 102): of the place of the floor in
// common; of its turn, where the correlation is 1: at 0.8 0.5 degrees, at 0.5 0.9. Along planks: unknown.
constexpr double kMatch_m = 0.004, kMatch_rad = 0.4 * kDegree, kNoMatch_m = 0.1;
// A match is searched as far as odometry may have erred, and this.
constexpr double kMatchReach_m = 0.012, kMatchReach_rad = 1.5 * kDegree, kSigmas = 3;
constexpr double kMinCommon = 0.12;            // m^2
constexpr int kMaxTried = 8, kMaxMatched = 4;  // in one look

// The strip that is looked at: half of its width, and how far the robot's front is from its middle.
constexpr double kHalfWidth = 0.14, kFront = 0.08;
// The eyes do not see nearer than that, from the middle: chest and feet are in the way.
constexpr double kBlindUntil = 0.20;
// Of the cells across the strip that may be unknown. Two obstacle cells in a row are none by chance.
constexpr double kMaxUnknown = 0.3;
constexpr int kMinObstacle = 2;

// The robot's limbs in the foot frame.
std::vector<map::OwnPart> own_parts(const std::vector<double>& joint_rad) {
  host::JointAngles angles;
  std::copy(joint_rad.begin(), joint_rad.end(), angles.begin());
  const Eigen::Isometry3d foot_from_trunk =
      host::trunk_from_sole(angles, host::supporting_foot(angles)).inverse();
  std::vector<map::OwnPart> parts;
  for (const motion::Limb& limb : motion::limbs(angles))
    parts.push_back({foot_from_trunk * limb.from, foot_from_trunk * limb.to, limb.radius_m});
  return parts;
}

}  // namespace

Eigen::Isometry3d map_from_foot(const motion::Place& place, const std::vector<double>& joint_rad) {
  host::JointAngles angles;
  std::copy(joint_rad.begin(), joint_rad.end(), angles.begin());
  const Vector3d hips = motion::hips_over_sole(angles, host::supporting_foot(angles));
  return Eigen::Translation3d(place.x, place.y, 0) *
         Eigen::AngleAxisd(place.heading, Vector3d::UnitZ()) *
         Eigen::Translation3d(-hips.x(), -hips.y(), 0);
}

motion::Place WalkingMap::corrected(const motion::Place& place) const {
  motion::Place out = place;
  const Vector3d at = pose_.at({place.x, place.y, place.heading});
  out.x = at.x();
  out.y = at.y();
  out.heading = at.z();
  return out;
}

std::optional<Eigen::Isometry3d> WalkingMap::foot_at(const FloorPicture& picture,
                                                     const PlaceHistory& places) const {
  const vision::FrameInfo& info = picture.planes.info;
  const auto place = places.at(info.exposure);
  if (!info.posture_known || info.joint_rad.size() != KZ_JOINTS || !place) return std::nullopt;
  return map_from_foot(corrected(*place), info.joint_rad);
}

Result<void> WalkingMap::enter(const std::vector<FloorPicture>& pictures,
                               const PlaceHistory& places) {
  for (const FloorPicture& picture : pictures) {
    const vision::FrameInfo& info = picture.planes.info;
    const auto foot = foot_at(picture, places);
    if (!foot || info.exposure <= newest_) continue;
    const motion::Place place = places.at(info.exposure).value_or(motion::Place{});
    pose_.move({place.x, place.y, place.heading});
    fade(place);
    KAZ_TRY(map_.update(picture.planes, picture.depth, info, *foot, own_parts(info.joint_rad)));
    newest_ = info.exposure;
    if (entered_.size() == kRemembered) entered_.erase(entered_.begin());
    entered_.push_back(newest_);
  }
  return {};
}

map::FloorPictureView WalkingMap::view_of(const FloorPicture& picture,
                                          const Eigen::Isometry3d& foot) const {
  return {picture.images->left, picture.planes, foot, &picture.depth, &map_};
}

bool WalkingMap::match(const Remembered& before, map::FloorMatcher& matcher, const Vector3d& now) {
  const Eigen::Matrix3d spread = pose_.covariance_from(before.pose);
  const double place = std::sqrt(spread.topLeftCorner<2, 2>().trace());
  const auto found = matcher.match(
      before.view,
      {kMatchReach_m + kSigmas * place, kMatchReach_rad + kSigmas * std::sqrt(spread(2, 2))});
  if (!found) return false;
  const Vector3d seen(now.x() + found->shift.x(), now.y() + found->shift.y(),
                      now.z() + found->turn_rad);
  // The floor in common is where it was found to be within kMatch_m; an error of its turn also
  // moves the robot, which stands beside it.
  const Vector2d aside = found->middle - now.head<2>();
  Eigen::Matrix3d noise = Eigen::Matrix3d::Zero();
  noise.topLeftCorner<2, 2>().diagonal().setConstant(kMatch_m * kMatch_m);
  if (const auto& along = found->unknown_along)
    noise.topLeftCorner<2, 2>() += kNoMatch_m * kNoMatch_m * *along * along->transpose();
  const Vector3d lever(aside.y(), -aside.x(), 1);
  const double turn = kMatch_rad / found->correlation;
  noise += turn * turn * lever * lever.transpose();
  // Axes of the pose from which it was seen.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  axes.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(-before.drawn.z()).toRotationMatrix();
  return pose_.measure(before.pose, map::pose_between(before.drawn, seen),
                       axes * noise * axes.transpose());
}

bool WalkingMap::align(const FloorPicture& picture, const PlaceHistory& places) {
  const auto foot = foot_at(picture, places);
  if (!foot || !picture.images) return false;
  const motion::Place place = places.at(picture.planes.info.exposure).value_or(motion::Place{});
  pose_.move({place.x, place.y, place.heading});
  const motion::Place at = corrected(place);
  const Vector3d now(at.x, at.y, at.heading);
  map::FloorMatcher matcher(view_of(picture, *foot), now.head<2>());
  int matched = 0, tried = 0;
  for (const Remembered& before : remembered_) {
    if (matcher.floor_in_common(before.view) < kMinCommon) continue;
    if (tried++ == kMaxTried || matched == kMaxMatched) break;
    matched += match(before, matcher, now) ? 1 : 0;
  }
  corrections_ += matched > 0 ? 1 : 0;
  if (matched > 0) matched_at_ = place;
  return matched > 0;
}

std::vector<double> WalkingMap::directions_of_patterns(const motion::Place& place) const {
  std::vector<double> directions;
  for (const auto& [view, pose, drawn] : remembered_) {
    if (view.count < kMinPattern) continue;
    const Vector2d middle =
        map::FloorView::kCell * (view.corner.cast<double>().array() + map::FloorView::kCells / 2);
    const Vector2d there = middle - Vector2d(place.x, place.y);
    const double direction =
        std::remainder(std::atan2(there.y(), there.x()) - place.heading, 2 * std::numbers::pi);
    const bool another = std::ranges::all_of(
        directions, [&](double one) { return std::abs(one - direction) > kAnother; });
    if (another && there.norm() > kViewNear && there.norm() < kViewFar &&
        std::abs(direction) < kViewAside)
      directions.push_back(direction);
  }
  return directions;
}

void WalkingMap::remember(const FloorPicture& picture, const PlaceHistory& places) {
  const auto foot = foot_at(picture, places);
  if (!foot || !picture.images || remembered_.size() == kViews) return;
  const motion::Place place = places.at(picture.planes.info.exposure).value_or(motion::Place{});
  pose_.move({place.x, place.y, place.heading});
  const motion::Place at = corrected(place);
  remembered_.push_back(
      {map::floor_view(view_of(picture, *foot)), pose_.remember(), {at.x, at.y, at.heading}});
}

int WalkingMap::entered_since(Time since) const {
  return static_cast<int>(
      std::ranges::count_if(entered_, [&](Time exposure) { return exposure >= since; }));
}

void WalkingMap::fade(const motion::Place& place) {
  if (faded_at_) {
    const double moved = std::hypot(place.x - faded_at_->x, place.y - faded_at_->y);
    if (moved < kFadeEvery_m && std::abs(place.heading - faded_at_->heading) < kFadeEvery_rad)
      return;
    const bool corrected =
        matched_at_ &&
        std::hypot(place.x - matched_at_->x, place.y - matched_at_->y) < kCorrectedWithin_m &&
        std::abs(place.heading - matched_at_->heading) < kCorrectedWithin_rad;
    map_.fade(corrected ? kFadeCorrected : kFade);
  }
  faded_at_ = place;
}

Ahead look_ahead(const map::LocalMap& map, const motion::Place& place, double until_m,
                 bool unknown_ends) {
  const Vector2d from(place.x, place.y), forward(std::cos(place.heading), std::sin(place.heading)),
      left(-forward.y(), forward.x());
  const double cell = map.options().cell_m;
  const int across = static_cast<int>(std::ceil(2 * kHalfWidth / cell));
  int consecutive = 0;
  for (double d = kFront; d <= until_m + kFront; d += cell) {
    int obstacles = 0, unknown = 0;
    Vector2d nearest = from + d * forward;
    for (int i = 0; i <= across; ++i) {
      const Vector2d at = from + d * forward + (i * cell - kHalfWidth) * left;
      const map::CellState state = map.certain_at(at.x(), at.y());
      unknown += state == map::CellState::unknown;
      if (state != map::CellState::obstacle) continue;
      if (obstacles++ == 0) nearest = at;
    }
    consecutive = obstacles > 0 ? consecutive + obstacles : 0;
    const double clear = std::max(0.0, d - kFront - 0.02);
    if (consecutive >= kMinObstacle) return {clear, Ahead::By::obstacle, nearest};
    if (unknown_ends && d > kBlindUntil && unknown > kMaxUnknown * (across + 1))
      return {clear, Ahead::By::unknown, from + d * forward};
  }
  return {until_m, Ahead::By::nothing, from};
}

}  // namespace kaz::behavior

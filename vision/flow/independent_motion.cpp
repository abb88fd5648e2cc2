// Depth interval and residual of each cell, candidates, verification on the images, regions.
// SPDX-License-Identifier: Apache-2.0
#include "vision/flow/independent_motion.h"

#include <algorithm>
#include <cmath>

#include "vision/flow/cell_disparity.h"

namespace kaz::vision {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMaxSpeed_m_s = 5, kMaxRate_rad_s = 20;  // of the camera
constexpr double kFarFloor_m = 3;  // beyond, the floor constrains no more than the horizon
constexpr int kReach_px = 3;   // half side of the square of pixels compared around a cell's centre
constexpr double kNoise2 = 8;  // codes^2: variance of a difference, noise of 2 codes a pixel
constexpr double kMinDescent_rad = 0.17;  // of the ray, to intersect it with a horizontal plane

int cell_middle(int cell, int cells, int pixels) {
  return std::min((2 * cell + 1) * pixels / (2 * cells), pixels - 1);
}

Result<void> check(const FlowImage& flow, const DepthImage* depth) {
  if (flow.flow_px.empty() || flow.certainty.empty())
    return fail(Fault::usage, "moving: the flow image is empty: compute the flow first");
  const FrameInfo &a = flow.before, &b = flow.after;
  if (!a.posture_known || !b.posture_known)
    return fail(Fault::failed, std::string("moving: the posture at the ") +
                                   (a.posture_known ? "later" : "earlier") +
                                   " picture is not known, so ego-motion cannot be separated from "
                                   "independent motion: wait for the board's state");
  const double dt = flow.seconds_between();
  if (!(dt > 0)) return fail(Fault::usage, "moving: no time passed between the pictures");
  const Eigen::Isometry3d motion = a.foot_from_eye.inverse() * b.foot_from_eye;
  if (!motion.matrix().allFinite() || motion.translation().norm() > kMaxSpeed_m_s * dt ||
      Eigen::AngleAxisd(motion.linear()).angle() > kMaxRate_rad_s * dt)
    return fail(Fault::failed,
                "moving: the pose of the eye jumped between the two pictures, perhaps because the "
                "robot changed its supporting foot: use the next pair");
  if (!depth) return {};
  if (depth->width != flow.width || depth->height != flow.height || depth->width < 4 ||
      depth->height < 4)
    return fail(Fault::usage, "moving: flow and depth image differ in size");
  if (depth->info.exposure != a.exposure && depth->info.exposure != b.exposure)
    return fail(Fault::usage,
                "moving: the depth image belongs to neither of the flow's two pictures");
  if (!(depth->info.camera.fx * depth->info.camera.baseline_m > 0))
    return fail(Fault::usage, "moving: the depth image lacks its camera model");
  return {};
}

}  // namespace

Result<void> IndependentMotionDetector::find(const FlowImage& flow, const Image& before,
                                             const Image& after, const DepthImage* depth,
                                             MovingRegions& moving) {
  const auto picture = [](const Image& p) { return Picture{p.width, p.height, 3, p.rgb}; };
  return find(flow, picture(before), picture(after), depth, moving);
}
Result<void> IndependentMotionDetector::find(const FlowImage& flow, const GreyPicture& before,
                                             const GreyPicture& after, const DepthImage* depth,
                                             MovingRegions& moving) {
  const auto picture = [](const GreyPicture& p) { return Picture{p.width, p.height, 1, p.pixels}; };
  return find(flow, picture(before), picture(after), depth, moving);
}

Result<void> IndependentMotionDetector::find(const FlowImage& flow, const Picture& before,
                                             const Picture& after, const DepthImage* depth,
                                             MovingRegions& moving) {
  moving.before = flow.before;
  moving.after = flow.after;
  moving.regions.clear();
  if (auto ok = check(flow, depth); !ok) return ok;
  for (const Picture* picture : {&before, &after})
    if (picture->width != flow.width || picture->height != flow.height ||
        picture->bytes.size() != flow.flow_px.size() * static_cast<std::size_t>(picture->channels))
      return fail(Fault::usage,
                  "moving: pictures and flow differ in size: give the two pictures of this flow");
  const std::size_t cells = flow.certainty.size();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  moving.cells_across = flow.cells_across;
  moving.cells_down = flow.cells_down;
  moving.residual_px.assign(cells, {kNan, kNan});
  moving.depth.assign(cells, MovingRegions::Depth::none);
  moving.label.assign(cells, 0);
  inverse_depth_.assign(cells, 0);
  candidates_.width = flow.cells_across;
  candidates_.height = flow.cells_down;
  candidates_.pixels.assign(cells, 0);
  proven_.assign(cells, 0);
  find_candidates(flow, depth, moving);
  if (moving.turn_error_rad.norm() > options_.max_posture_error_rad ||
      moving.shift_error_m.norm() > options_.max_posture_error_m)
    return fail(
        Fault::failed,
        "moving: most of the flow does not match the robot's posture. Either the robot slips or "
        "falls, or a moving object covers most of the picture: use the next pair");
  if (std::ranges::find(candidates_.pixels, 255) == candidates_.pixels.end()) return {};
  const auto reader = [](const Picture& p, std::vector<float>& codes) {
    grey_codes(p.bytes, p.channels, codes);
    return GreyReader{p.width, p.height, codes};
  };
  const GreyReader grey_before = reader(before, grey_[0]), grey_after = reader(after, grey_[1]);
  verify_on_images(flow, grey_before, grey_after, moving);
  collect_regions(flow, grey_before, grey_after, moving);
  return {};
}

FlowSample IndependentMotionDetector::sample(std::size_t k) const {
  const FlowSamples& s = samples_;
  return {
      {s.u[k], s.v[k]}, {s.flow_u[k], s.flow_v[k]}, s.min_inverse_depth[k], s.max_inverse_depth[k]};
}

// Of the cells of row y, with centres at v, that have flow: where they are in the depth image's picture, if
// inside; 0 elsewhere.
void IndependentMotionDetector::find_disparities(const FlowImage& flow, const DepthImage& depth,
                                                 bool later, int y, int v) {
  places_.clear();
  inside_.clear();
  for (int x = 0; x < flow.cells_across; ++x) {
    const auto i = static_cast<std::size_t>(y * flow.cells_across + x);
    if (!(flow.certainty[i].xx > 0)) continue;
    const int u = columns_[static_cast<std::size_t>(x)];
    Vector2d at(u, v);
    if (later) at = flow.at(u, v).cast<double>() + at;
    const bool inside = at.x() >= 0 && at.y() >= 0 && at.x() < flow.width && at.y() < flow.height;
    inside_.push_back(inside ? 1 : 0);
    places_.push_back(inside ? Eigen::Vector2i(static_cast<int>(at.x()), static_cast<int>(at.y()))
                             : Eigen::Vector2i::Zero());
  }
  disparity_.resize(places_.size());
  median_disparities(depth, places_, disparity_.data());
  for (std::size_t k = 0; k < places_.size(); ++k) {
    if (inside_[k] == 0) disparity_[k] = 0;
  }
}

void IndependentMotionDetector::find_candidates(const FlowImage& flow, const DepthImage* depth,
                                                MovingRegions& moving) {
  EgoMotion eye(flow.before, flow.after);
  const Eigen::Matrix3d foot_from_ray = flow.before.foot_from_eye.linear();
  const double height = flow.before.foot_from_eye.translation().z();
  const bool later = depth && depth->info.exposure == flow.after.exposure;
  const double per_px = depth ? 1 / (depth->info.camera.fx * depth->info.camera.baseline_m) : 0;
  samples_.resize(flow.certainty.size());  // at most
  cell_.clear();
  sample_.assign(flow.certainty.size(), 0);
  columns_.clear();
  for (int x = 0; x < flow.cells_across; ++x)
    columns_.push_back(cell_middle(x, flow.cells_across, flow.width));
  for (int y = 0; y < flow.cells_down; ++y) {
    const int v = cell_middle(y, flow.cells_down, flow.height);
    if (depth) find_disparities(flow, *depth, later, y, v);
    std::size_t of_row = 0;
    for (int x = 0; x < flow.cells_across; ++x) {
      const auto i = static_cast<std::size_t>(y * flow.cells_across + x);
      if (!(flow.certainty[i].xx > 0)) continue;
      const int u = columns_[static_cast<std::size_t>(x)];
      const Vector2d measured = flow.at(u, v).cast<double>();
      const double disparity = depth ? static_cast<double>(disparity_[of_row++]) : 0;
      // Interval of inverse depth, 1/m, unless stereo or floor constrain it:
      double min_w = 0, max_w = 1 / options_.nearest_elsewhere_m;
      const double slope = (foot_from_ray * eye.ray(u, v)).z();
      if (disparity > 0) {
        moving.depth[i] = MovingRegions::Depth::stereo;
        inverse_depth_[i] = static_cast<float>(disparity * per_px);
        min_w = std::max(0.0, disparity - 1) * per_px;
        max_w = (disparity + 1) * per_px;
      } else if (slope < 0 && height > options_.highest_on_floor_m &&
                 height < -slope * kFarFloor_m) {
        moving.depth[i] = MovingRegions::Depth::floor;
        // Foot frame: eye.z + (R r).z / w = h for a point at height h, so w = -slope / (height - h),
        // with h from 0 to highest_on_floor_m.
        min_w = -slope / height;
        max_w = -slope / (height - options_.highest_on_floor_m);
      } else {
        moving.depth[i] = MovingRegions::Depth::far;
      }
      samples_.set(cell_.size(), u, v, measured.x(), measured.y(), min_w, max_w);
      cell_.push_back(i);
      sample_[i] = static_cast<int>(cell_.size());
    }
  }
  samples_.resize(cell_.size());
  const auto correction =
      eye.correct(samples_, {options_.posture_error_rad, options_.posture_error_m});
  moving.turn_error_rad = correction.rotation_rad;
  moving.shift_error_m = correction.translation_m;
  moving.spread_px = correction.spread_px;
  later_ = eye.later();
  // Candidates: residual above 3 standard deviations of the ego-motion's residuals plus the flow's error,
  // and Mahalanobis distance under the flow's covariance above min_surprise.
  const double allowed = options_.flow_error_px + 3 * correction.spread_px;
  const double surprise = options_.min_surprise * options_.min_surprise;
  eye.residuals(samples_, residuals_);
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    if (residuals_.valid[k] == 0) continue;
    Vector2d residual(residuals_.u[k], residuals_.v[k]);
    const std::size_t i = cell_[k];
    if (moving.depth[i] == MovingRegions::Depth::stereo && residuals_.length[k] > allowed) {
      // Stereo has outliers: a residual that another depth explains is not evidence of motion.
      FlowSample any = sample(k);
      any.min_inverse_depth = 0;
      any.max_inverse_depth = std::max(any.max_inverse_depth, 1 / options_.nearest_elsewhere_m);
      Vector2d other, epipolar;
      if (eye.residual(any, other, epipolar) && other.norm() <= allowed) residual = other;
    }
    moving.residual_px[i] = residual.cast<float>();
    candidates_.pixels[i] =
        residual.norm() > allowed &&
                static_cast<double>(flow.certainty[i].surprise(moving.residual_px[i])) > surprise
            ? 255
            : 0;
  }
}

// Compares two warps of the square around each candidate: by the measured flow and by ego-motion alone
// (mean squared difference of grey values, codes^2). Near the border of a moving object the flow is that of
// either side; the warp that matches decides.
void IndependentMotionDetector::verify_on_images(const FlowImage& flow, const GreyReader& before,
                                                 const GreyReader& after,
                                                 const MovingRegions& moving) {
  for (int y = 0; y < flow.cells_down; ++y) {
    for (int x = 0; x < flow.cells_across; ++x) {
      const auto i = static_cast<std::size_t>(y * flow.cells_across + x);
      if (!candidates_.pixels[i]) continue;
      const int u = cell_middle(x, flow.cells_across, flow.width);
      const int v = cell_middle(y, flow.cells_down, flow.height);
      const Vector2d measured = flow.at(u, v).cast<double>();
      const double by_flow = misfit(before, after, u, v, kReach_px, measured);
      const Vector2d rest = measured - moving.residual_px[i].cast<double>();
      const double by_ego = misfit(before, after, u, v, kReach_px, rest);
      if (!(by_flow <= 1.5 * by_ego + kNoise2)) candidates_.pixels[i] = 0;
      if (!candidates_.pixels[i] || !(by_ego > 2 * by_flow + 4 * kNoise2)) continue;
      // The ego-motion flow has an error of about `off` px, and a sharp edge does not match one pixel off:
      // the best of it and eight neighbours at that distance counts.
      double nearby = by_ego;
      const double off = options_.flow_error_px + moving.spread_px;
      for (const Vector2d& direction :
           {Vector2d(1, 0), Vector2d(-1, 0), Vector2d(0, 1), Vector2d(0, -1), Vector2d(0.7, 0.7),
            Vector2d(0.7, -0.7), Vector2d(-0.7, 0.7), Vector2d(-0.7, -0.7)})
        nearby = std::min(nearby, misfit(before, after, u, v, kReach_px, rest + off * direction));
      proven_[i] = nearby > 2 * by_flow + 4 * kNoise2 ? 1 : 0;
    }
  }
}

void IndependentMotionDetector::collect_regions(const FlowImage& flow, const GreyReader& before,
                                                const GreyReader& after, MovingRegions& moving) {
  constexpr int kCell = FlowImage::kCell_px;
  const double dt = flow.seconds_between();
  for (const Region& found : finder_.find(candidates_, options_.min_cells)) {
    if (moving.regions.size() == 255) break;
    // Means over the region's cells, px: residual, ego-motion flow, position.
    Vector2d residual(0, 0), rest(0, 0), middle(0, 0);
    int proven = 0;
    corners_.clear();
    for (const Run& run : found.runs) {
      for (int x = run.left; x <= run.right; ++x) {
        const auto i = static_cast<std::size_t>(run.row * flow.cells_across + x);
        const int u = cell_middle(x, flow.cells_across, flow.width);
        const int v = cell_middle(run.row, flow.cells_down, flow.height);
        const Vector2d r = moving.residual_px[i].cast<double>();
        residual += r / found.area;
        rest += (flow.at(u, v).cast<double>() - r) / found.area;
        middle += Vector2d(u, v) / found.area;
        proven += proven_[i];
        corners_.emplace_back(x * kCell, run.row * kCell);
      }
    }
    if (proven < options_.min_proven_cells || proven < options_.min_proven * found.area) continue;
    if (is_own_body(flow, found, options_.flow_error_px + 3 * moving.spread_px)) continue;
    for (const Run& run : found.runs)
      for (int x = run.left; x <= run.right; ++x)
        moving.label[static_cast<std::size_t>(run.row * flow.cells_across + x)] =
            static_cast<std::uint8_t>(moving.regions.size() + 1);
    MovingRegion region;
    region.pixels = found.area * kCell * kCell;
    region.left = found.left * kCell;
    region.top = found.top * kCell;
    region.right = std::min(found.right * kCell + kCell, flow.width) - 1;
    region.bottom = std::min(found.bottom * kCell + kCell, flow.height) - 1;
    Vector2d own = rest + residual;
    // Re-estimate the flow as one translation, on up to kMaxSquares cells: enough for large regions.
    constexpr std::size_t kMaxSquares = 60;
    if (const std::size_t step = (corners_.size() - 1) / kMaxSquares + 1; step > 1) {
      std::size_t n = 0;
      for (std::size_t k = 0; k < corners_.size(); k += step) corners_[n++] = corners_[k];
      corners_.resize(n);
    }
    if (refine_flow(before, after, corners_, kCell, own)) residual = own - rest;
    // Centre of the moving pixels in the box grown by half a patch: cells at its border are often missed.
    constexpr int kMore = 2 * kCell;
    moved_middle(before, after, region.left - kMore, region.top - kMore, region.right + kMore,
                 region.bottom + kMore, own, rest, middle);
    region.center_u = middle.x();
    region.center_v = middle.y();
    region.velocity_px_s = residual / dt;
    region.confidence = static_cast<double>(proven) / found.area;
    locate(flow, region, found);
    moving.regions.push_back(region);
  }
}

bool IndependentMotionDetector::is_own_body(const FlowImage& flow, const Region& cells,
                                            double allowed_px) const {
  if (10 * (cells.bottom + 1) < 9 * flow.cells_down) return false;
  // Error of the camera's translation, and the distance at which it counts: fx kTranslation / kNear px.
  constexpr double kTranslation_m = 0.0005, kNear_m = 0.1;
  FrameInfo later = flow.after;
  later.foot_from_eye = flow.before.foot_from_eye * later_.inverse();
  const EgoMotion eye(flow.before, later);
  int near = 0;
  for (const Run& run : cells.runs) {
    for (int x = run.left; x <= run.right; ++x) {
      const auto i = static_cast<std::size_t>(run.row * flow.cells_across + x);
      if (sample_[i] == 0 || inverse_depth_[i] > 0) continue;
      FlowSample any = sample(static_cast<std::size_t>(sample_[i] - 1));
      any.min_inverse_depth = 0;
      any.max_inverse_depth = 1 / options_.nearest_body_m;
      Vector2d left, epipolar;
      near += eye.residual(any, left, epipolar) &&
              left.norm() <= allowed_px + flow.before.camera.fx * kTranslation_m / kNear_m;
    }
  }
  return 3 * near > 2 * cells.area;
}

void IndependentMotionDetector::locate(const FlowImage& flow, MovingRegion& region,
                                       const Region& cells) const {
  std::vector<float> known;
  for (const Run& run : cells.runs)
    for (int x = run.left; x <= run.right; ++x)
      if (const float w = inverse_depth_[static_cast<std::size_t>(run.row * flow.cells_across + x)];
          w > 0)
        known.push_back(w);
  // Median inverse depth of the cells with stereo; a third of them must have it.
  if (3 * known.size() < static_cast<std::size_t>(cells.area)) return;
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
  std::nth_element(known.begin(), middle, known.end());
  const auto w = static_cast<double>(*middle);
  FrameInfo later = flow.after;
  later.foot_from_eye = flow.before.foot_from_eye * later_.inverse();
  const EgoMotion eye(flow.before, later);
  const double u = region.center_u, v = region.center_v, dt = flow.seconds_between();
  Vector2d rest;
  if (!eye.flow(u, v, w, rest)) return;
  // Foot frame: the point at the earlier exposure, and the ray through its image at the later one.
  const Vector3d from = flow.before.foot_from_eye * (eye.ray(u, v) / w);
  const Vector2d to = Vector2d(u, v) + rest + dt * region.velocity_px_s;
  const Vector3d eye_then = later.foot_from_eye.translation();
  const Vector3d ray = (later.foot_from_eye.linear() * eye.ray(to.x(), to.y())).normalized();
  region.position_m = from;
  // Distance along that ray to the horizontal plane through `from`, and to the foot of the perpendicular.
  const double level = (from.z() - eye_then.z()) / ray.z();
  const double across = (from - eye_then).dot(ray);
  const double reach = std::abs(ray.z()) > std::sin(kMinDescent_rad) && level > 0 ? level : across;
  region.velocity_m_s = (eye_then + reach * ray - from) / dt;
}

}  // namespace kaz::vision

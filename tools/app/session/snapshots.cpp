// Pictures of a run, taken at a few moments.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/session/snapshots.h"

#include <cstdio>
#include <string>

#include "tools/figure/figure.h"

namespace kaz::tools {
namespace {

constexpr int kOutsideWidth = 960, kOutsideHeight = 720;

// Where an onlooker stands, in front of the robot and to its right, looking at its chest and the
// floor before it. World frame, m.
const Eigen::Vector3d kEye(1.62, -0.62, 0.88), kTarget(0.26, 0.02, 0.07);

sim::View onlooker(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d axes;
  axes << right, forward.cross(right), forward;
  sim::View view;
  view.camera = sim::Pinhole::from_horizontal_view(kOutsideWidth, kOutsideHeight, 0.78);
  view.samples_per_axis = 2;
  view.world_from_optical.linear() = axes;
  view.world_from_optical.translation() = eye;
  return view;
}

struct LeftEye {
  vision::Image marked;  // with the ball's outline
  vision::Image extraction;
  bool found = false;
  double distance_m = 0;  // by its size
};

LeftEye look(const vision::Image& left, const vision::FrameInfo& info,
             const vision::BallOptions& options) {
  vision::BallDetector detector{options};
  const vision::BallObservation ball = detector.detect(left, info);
  LeftEye eye{figure::enlarge(left, 2), figure::mask_picture(detector.mask(), left), ball.found,
              ball.distance_m};
  const auto doubled = [](double pixel) { return 2 * pixel + 0.5; };  // pixel centres at integers
  figure::draw_crosshair(eye.marked, doubled(info.camera.cx), doubled(info.camera.cy), 22,
                         figure::kWhite);
  if (ball.found) {
    figure::draw_circle(eye.marked, doubled(ball.center_u), doubled(ball.center_v),
                        2 * ball.radius_px + 3, figure::kYellow);
  }
  eye.extraction = figure::enlarge(eye.extraction, 2);
  return eye;
}

}  // namespace

void Snapshots::take(Time now, const std::string& shown) {
  if (!camera_.newest()) return;
  Snapshot snapshot{now, shown, *camera_.newest(), {}, {}, 0};
  if (simulation_ != nullptr) {
    const sim::World& world = simulation_->world();
    snapshot.pose = world.pose();
    const auto ball = world.object_position("ball");
    if (ball && !shown.empty()) {
      const Eigen::Vector3d trunk = world.link_pose("trunk").translation();
      snapshot.near = 0.5 * (trunk + *ball) + Eigen::Vector3d(0, 0, 0.03);  // its head is higher
      snapshot.extent_m = (trunk - *ball).norm();
    }
  }
  moments_.push_back(std::move(snapshot));
}

Result<vision::Image> Snapshots::outside(const Snapshot& snapshot) const {
  if (simulation_ == nullptr) return vision::Image{};
  sim::View view = onlooker(kEye, kTarget);
  // From the same side, and as near as robot and ball allow.
  if (snapshot.near)
    view =
        onlooker(*snapshot.near + (0.55 + 1.1 * snapshot.extent_m) * (kEye - kTarget).normalized(),
                 *snapshot.near);
  auto picture = KAZ_TRY(simulation_->picture(view, snapshot.pose));
  return vision::Image{picture.width, picture.height, std::move(picture.rgb)};
}

Result<std::vector<std::string>> Snapshots::write(const OutputFolder& folder) const {
  std::vector<std::string> names;
  const auto write = [&](const std::string& name, const vision::Image& image) -> Result<void> {
    names.push_back(name);
    return figure::write_png(folder.path(name), image);
  };
  std::vector<figure::Panel> panels;
  std::optional<LeftEye> best;
  vision::Image best_outside;
  for (const Snapshot& snapshot : moments_) {
    const auto images = snapshot.pair.images.get();
    if (images == nullptr) continue;
    LeftEye eye = look(images->left, snapshot.pair.info, ball_);
    char when[64], caption[48] = "left eye";
    std::snprintf(when, sizeof when, "%s%s%.1f s", snapshot.shown.c_str(),
                  snapshot.shown.empty() ? "" : ", ", seconds(snapshot.time));
    if (eye.found)
      std::snprintf(caption, sizeof caption, "left eye: %.2f m by the ball's size", eye.distance_m);
    auto outside_view = KAZ_TRY(outside(snapshot));
    if (outside_view.width > 0) panels.push_back({outside_view, when});
    panels.push_back({eye.marked, caption});
    panels.push_back({eye.extraction, "colour extraction"});
    if (eye.found || !best) {
      best = std::move(eye);
      best_outside = std::move(outside_view);
    }
  }
  if (!best) return names;
  Result<void> written = write("left_eye.png", best->marked);
  if (written) written = write("color_extraction.png", best->extraction);
  if (written && best_outside.width > 0) written = write("outside.png", best_outside);
  const int columns = simulation_ != nullptr ? 3 : 2;
  const vision::Image all = figure::compose(panels, columns, 300);
  if (written) written = write("moments.png", all);
  names.emplace_back("moments.jpg");
  if (written) written = figure::write_jpeg(folder.path("moments.jpg"), all, 80);
  if (!written) return tl::unexpected(written.error());
  return names;
}

}  // namespace kaz::tools

// Pictures of a run, taken at a few moments.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/snapshots.h"

#include <cstdio>
#include <string>

#include "sim/render/camera.h"
#include "tools/drawing/figure.h"

namespace kaz::tools {
namespace {

// Where an onlooker stands, in front of the robot and to its right, looking at its chest and the
// floor before it. World frame, m.
const Eigen::Vector3d kEye(1.62, -0.62, 0.88), kTarget(0.26, 0.02, 0.07);

MomentPictures look(const vision::Image& left, const vision::FrameInfo& info,
                    const vision::BallOptions& options) {
  vision::BallFinder detector{options};
  const vision::BallObservation ball = detector.detect(left, info);
  MomentPictures moment;
  moment.left = figure::enlarge(left, 2);
  moment.found = ball.found;
  moment.distance_m = ball.distance_m;
  const auto doubled = [](double pixel) { return 2 * pixel + 0.5; };  // pixel centres at integers
  figure::draw_crosshair(moment.left, doubled(info.camera.cx), doubled(info.camera.cy), 22,
                         figure::kWhite);
  if (ball.found) {
    figure::draw_circle(moment.left, doubled(ball.center_u), doubled(ball.center_v),
                        2 * ball.radius_px + 3, figure::kYellow);
  }
  moment.extraction = figure::enlarge(figure::mask_picture(detector.mask(), left), 2);
  return moment;
}

}  // namespace

sim::View onlooker_view(const std::optional<Eigen::Vector3d>& middle, double extent_m, int width) {
  const Eigen::Vector3d target = middle.value_or(kTarget);
  const Eigen::Vector3d eye =
      middle ? target + (0.55 + 1.1 * extent_m) * (kEye - kTarget).normalized() : kEye;
  sim::View view;
  view.camera = sim::camera_of_view(width, 3 * width / 4, 0.78);
  view.samples_per_axis = 2;
  view.world_from_optical = sim::look_at(eye, target);
  return view;
}

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
  const sim::View view = onlooker_view(snapshot.near, snapshot.extent_m);
  return simulation_->picture(view, snapshot.pose);
}

Result<std::vector<MomentPictures>> Snapshots::draw() const {
  std::vector<MomentPictures> moments;
  for (const Snapshot& snapshot : moments_) {
    if (stopped()) return std::vector<MomentPictures>();
    const auto images = snapshot.pair.images.get();
    if (images == nullptr) continue;
    MomentPictures moment = look(images->left, snapshot.pair.info, ball_);
    moment.time = snapshot.time;
    moment.shown = snapshot.shown;
    moment.outside = KAZ_TRY(outside(snapshot));
    moments.push_back(std::move(moment));
  }
  return moments;
}

Result<std::vector<std::string>> Snapshots::write(const OutputFolder& folder) const {
  std::vector<std::string> names;
  const auto write = [&](const std::string& name, const vision::Image& image) -> Result<void> {
    if (stopped()) return {};
    names.push_back(name);
    return figure::write_png(folder.path(name), image);
  };
  const auto moments = KAZ_TRY(draw());
  std::vector<figure::Panel> panels;
  const MomentPictures* best = nullptr;
  for (const MomentPictures& moment : moments) {
    char when[64], caption[48] = "left eye";
    std::snprintf(when, sizeof when, "%s%s%.1f s", moment.shown.c_str(),
                  moment.shown.empty() ? "" : ", ", seconds(moment.time));
    if (moment.found)
      std::snprintf(caption, sizeof caption, "left eye: ball %.2f m away", moment.distance_m);
    if (moment.outside.width > 0) panels.push_back({moment.outside, when});
    panels.push_back({moment.left, caption});
    panels.push_back({moment.extraction, "color extraction"});
    if (moment.found || best == nullptr) best = &moment;
  }
  if (best == nullptr || stopped()) return names;
  Result<void> written = write("left_eye.png", best->left);
  if (written) written = write("color_extraction.png", best->extraction);
  if (written && best->outside.width > 0) written = write("outside.png", best->outside);
  const int columns = simulation_ != nullptr ? 3 : 2;
  const vision::Image all = figure::compose(panels, columns, 300);
  if (written) written = write("moments.png", all);
  if (!written) return tl::unexpected(written.error());
  if (stopped()) return names;
  names.emplace_back("moments.jpg");
  KAZ_TRY(figure::write_jpeg(folder.path("moments.jpg"), all, 80));
  return names;
}

}  // namespace kaz::tools

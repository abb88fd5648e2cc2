// Pictures of a run, taken at a few moments.
// SPDX-License-Identifier: Apache-2.0
#include "tools/kaz/album.h"

#include <cstdio>

#include "tools/figure/figure.h"
#include "vision/ball.h"

namespace kaz::tools {
namespace {

constexpr int kOutsideWidth = 960, kOutsideHeight = 720;

// Where an onlooker stands, in front of the robot and to its right, looking at its chest and the
// floor before it. World frame, m.
sim::View onlooker() {
  const Eigen::Vector3d eye(1.62, -0.62, 0.88), target(0.26, 0.02, 0.07);
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
};

LeftEye look(const vision::Image& left, const vision::FrameInfo& info) {
  vision::BallDetector detector{vision::BallOptions{}};
  const vision::BallObservation ball = detector.detect(left, info);
  LeftEye eye{figure::enlarge(left, 2), figure::mask_picture(detector.mask(), left), ball.found};
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

void Album::take(Time now) {
  if (!camera_.newest()) return;
  Moment moment{now, *camera_.newest(), {}};
  if (simulation_ != nullptr) moment.pose = simulation_->world().pose();
  moments_.push_back(std::move(moment));
}

Result<vision::Image> Album::outside(const Moment& moment) const {
  if (simulation_ == nullptr) return vision::Image{};
  auto picture = simulation_->picture(onlooker(), moment.pose);
  if (!picture) return tl::unexpected(picture.error());
  return vision::Image{picture->width, picture->height, std::move(picture->rgb)};
}

Result<std::vector<std::string>> Album::write(const OutputFolder& folder) const {
  std::vector<std::string> names;
  const auto write = [&](const std::string& name, const vision::Image& image) -> Result<void> {
    names.push_back(name);
    return figure::write_png(folder.path(name), image);
  };
  std::vector<figure::Panel> panels;
  std::optional<LeftEye> best;
  vision::Image best_outside;
  for (const Moment& moment : moments_) {
    const auto images = moment.pair.images.get();
    if (images == nullptr) continue;
    LeftEye eye = look(images->left, moment.pair.info);
    char when[32];
    std::snprintf(when, sizeof when, "%.1f s", seconds(moment.time));
    auto outside_view = outside(moment);
    if (!outside_view) return tl::unexpected(outside_view.error());
    if (outside_view->width > 0) panels.push_back({*outside_view, when});
    panels.push_back({eye.marked, std::string("left eye, ") + when});
    panels.push_back({eye.extraction, "colour extraction"});
    if (eye.found || !best) {
      best = std::move(eye);
      best_outside = std::move(*outside_view);
    }
  }
  if (!best) return names;
  Result<void> written = write("left_eye.png", best->marked);
  if (written) written = write("color_extraction.png", best->extraction);
  if (written && best_outside.width > 0) written = write("outside.png", best_outside);
  const int columns = simulation_ != nullptr ? 3 : 2;
  if (written) written = write("moments.png", figure::compose(panels, columns, 300));
  if (!written) return tl::unexpected(written.error());
  return names;
}

}  // namespace kaz::tools

// Outline points and their sub-pixel positions.
// SPDX-License-Identifier: Apache-2.0
#include "vision/color/outline.h"

#include <algorithm>

#include <Eigen/Core>

namespace kaz::vision {

std::vector<OutlinePoint> outline_of(const Region& region, int width, int height) {
  std::vector<OutlinePoint> points;
  const auto add = [&](int u, int v, int step_u, int step_v) {
    const int outer_u = u + step_u, outer_v = v + step_v;
    if (outer_u < 0 || outer_v < 0 || outer_u >= width || outer_v >= height) return;
    points.push_back({u + 0.5 * step_u, v + 0.5 * step_v, u, v, step_u, step_v});
  };
  struct Column {
    int top = -1, bottom = -1;
  };
  std::vector<Column> columns(static_cast<std::size_t>(region.right - region.left + 1));
  const std::vector<Run>& runs = region.runs;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Run& run = runs[i];
    if (i == 0 || runs[i - 1].row != run.row) add(run.left, run.row, -1, 0);
    if (i + 1 == runs.size() || runs[i + 1].row != run.row) add(run.right, run.row, 1, 0);
    for (int u = run.left; u <= run.right; ++u) {
      Column& column = columns[static_cast<std::size_t>(u - region.left)];
      if (column.top < 0) column.top = run.row;
      column.bottom = run.row;
    }
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].top < 0) continue;
    const int u = region.left + static_cast<int>(i);
    add(u, columns[i].top, 0, -1);
    add(u, columns[i].bottom, 0, 1);
  }
  return points;
}

OutlinePoint refined(const Image& image, const OutlinePoint& point) {
  const auto inside_image = [&](int along) {
    const int u = point.inside_u + along * point.step_u, v = point.inside_v + along * point.step_v;
    return u >= 0 && v >= 0 && u < image.width && v < image.height;
  };
  if (!inside_image(-2) || !inside_image(2)) return point;
  const auto color = [&](int along) {
    const int u = point.inside_u + along * point.step_u, v = point.inside_v + along * point.step_v;
    const std::uint8_t* p =
        &image.rgb[(static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width) +
                    static_cast<std::size_t>(u)) *
                   3];
    return Eigen::Vector3d(p[0], p[1], p[2]);
  };
  // Pixels -1 and 2 are taken as pure; light that falls off towards the rim is continued to pixel
  // 0.
  const Eigen::Vector3d outer = color(2), inner = 2 * color(-1) - color(-2);
  const Eigen::Vector3d contrast = inner - outer;
  constexpr double kMinContrast = 24;  // of 255 in each component: below that noise decides
  if (contrast.squaredNorm() < kMinContrast * kMinContrast) return point;
  const auto share = [&](int along) {
    return std::clamp((color(along) - outer).dot(contrast) / contrast.squaredNorm(), 0.0, 1.0);
  };
  const double edge = share(0) + share(1) - 0.5;  // from the centre of the inner pixel, outwards
  OutlinePoint moved = point;
  moved.u = point.inside_u + edge * point.step_u;
  moved.v = point.inside_v + edge * point.step_v;
  return moved;
}

}  // namespace kaz::vision

// Watershed between floor and all else, in a band along the floor's border.
// SPDX-License-Identifier: Apache-2.0
#include "vision/planes/floor_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <opencv2/imgproc.hpp>

#include "vision/image/opencv_quiet.h"

namespace kaz::vision {

struct FloorEdges::State {
  FloorEdgeOptions options;
  cv::Mat mask, closed, inner, outer, markers;
};

namespace {

constexpr int kSpeck_px = 2;  // holes and specks up to 2 kSpeck_px + 1 wide are removed

}  // namespace

FloorEdges::FloorEdges(const FloorEdgeOptions& options) : state_(std::make_unique<State>()) {
  state_->options = options;
}
FloorEdges::~FloorEdges() = default;
FloorEdges::FloorEdges(FloorEdges&&) noexcept = default;
FloorEdges& FloorEdges::operator=(FloorEdges&&) noexcept = default;

Result<void> FloorEdges::sharpen(const Image& left, PlaneSegments& planes) {
  constexpr int kFloor = 1, kOther = 2;
  const int reach = state_->options.reach_px;
  if (reach < 1 || reach > 64)
    return fail(Fault::usage, "floor edges: reach_px is " + std::to_string(reach) + ", not 1..64");
  const auto pixels = static_cast<std::size_t>(std::max(0, left.width)) *
                      static_cast<std::size_t>(std::max(0, left.height));
  if (pixels == 0 || left.rgb.size() != 3 * pixels || planes.width != left.width ||
      planes.height != left.height || planes.label.size() != pixels)
    return fail(Fault::usage, "floor edges: picture and planes are not of the same size");

  // Labels that count as floor: floor segments whose middle is within step_m of the plane n . p + d = 0 of
  // the largest one (optical frame, m). Label 0 is no segment; segment k has label k + 1.
  std::array<bool, 256> floor{};
  int largest = 0;
  for (std::size_t k = 0; k < planes.segments.size() && k < 255; ++k) {
    if (!planes.segments[k].floor) continue;
    floor[k + 1] = true;
    const auto& so_far = planes.segments[static_cast<std::size_t>(std::max(0, largest - 1))];
    if (largest == 0 || planes.segments[k].pixels > so_far.pixels)
      largest = static_cast<int>(k) + 1;
  }
  if (largest == 0) return {};
  const PlaneSegment& ground = planes.segments[static_cast<std::size_t>(largest - 1)];
  for (std::size_t k = 0; k < planes.segments.size() && k < 255; ++k) {
    const double above = ground.normal.dot(planes.segments[k].middle) + ground.distance_m;
    if (std::abs(above) > state_->options.step_m) floor[k + 1] = false;
  }

  // Binary floor mask. Only rows within 2 reach of the floor are processed below.
  State& s = *state_;
  s.mask.create(left.height, left.width, CV_8U);
  const auto columns = static_cast<std::size_t>(left.width);
  int top = left.height, bottom = -1;
  for (int v = 0; v < left.height; ++v) {
    const std::uint8_t* label = planes.label.data() + static_cast<std::size_t>(v) * columns;
    std::uint8_t* to = s.mask.ptr(v);
    std::uint8_t any = 0;
    for (std::size_t u = 0; u < columns; ++u) {
      to[u] = floor[label[u]] ? 1 : 0;
      any |= to[u];
    }
    if (any == 0) continue;
    top = std::min(top, v);
    bottom = v;
  }
  if (bottom < 0) return {};
  top = std::max(0, top - 2 * reach);
  bottom = std::min(left.height - 1, bottom + 2 * reach);
  const cv::Mat mask = s.mask.rowRange(top, bottom + 1);
  const auto square = [](int reach_px) -> cv::Mat {
    return cv::Mat::ones(2 * reach_px + 1, 2 * reach_px + 1, CV_8U);
  };
  // Markers: closing and opening remove holes and specks; pixels that survive erosion by `reach` are floor,
  // those outside of the dilation by `reach` are not, and the band between is 0, undecided.
  cv::morphologyEx(mask, s.closed, cv::MORPH_CLOSE, square(kSpeck_px));
  cv::morphologyEx(s.closed, s.closed, cv::MORPH_OPEN, square(kSpeck_px));
  cv::erode(s.closed, s.inner, square(reach));
  cv::dilate(s.closed, s.outer, square(reach));
  s.markers.create(mask.rows, mask.cols, CV_32S);
  const std::size_t size = static_cast<std::size_t>(mask.rows) * columns;
  int* const markers = s.markers.ptr<int>();
  for (std::size_t i = 0; i < size; ++i)
    markers[i] = s.inner.data[i] != 0 ? kFloor : s.outer.data[i] == 0 ? kOther : 0;
  const std::size_t first = static_cast<std::size_t>(top) * columns;
  const cv::Mat picture(mask.rows, mask.cols, CV_8UC3,
                        const_cast<std::uint8_t*>(left.rgb.data() + 3 * first));  // is only read
  cv::watershed(picture, s.markers);
  for (std::size_t i = 0; i < size; ++i) {
    std::uint8_t& label = planes.label[first + i];
    if (markers[i] == kFloor && !floor[label]) label = static_cast<std::uint8_t>(largest);
    if (markers[i] == kOther && floor[label]) label = 0;
    // The watershed line (-1), one pixel wide, and the picture's frame, which cv::watershed skips, keep
    // their labels.
  }
  return {};
}

}  // namespace kaz::vision

// Watershed between floor and all else, in a band along the floor's border.
// SPDX-License-Identifier: Apache-2.0
#include "vision/planes/floor_edges.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "vision/planes/bit_image.h"
#include "vision/planes/watershed.h"

namespace kaz::vision {
namespace {

constexpr int kSpeck_px = 2;  // holes and specks up to 2 kSpeck_px + 1 wide are removed
constexpr std::size_t kLabels = 256;
// Of a narrow thing's points above the floor: three sigma of disparity, and the height from which on the map
// takes things for obstacles.
constexpr double kStands_px = 0.6, kStands_m = 0.015;

// Writes 1 where the label is one of `floor`, else 0; returns whether there is any.
bool mark_floor(const std::uint8_t* __restrict label, std::size_t pixels,
                const std::vector<std::uint8_t>& floor, std::uint8_t* __restrict to) {
  std::fill(to, to + pixels, std::uint8_t{0});
  for (const std::uint8_t one : floor) {
    for (std::size_t i = 0; i < pixels; ++i)
      to[i] = static_cast<std::uint8_t>(to[i] | (label[i] == one ? 1 : 0));
  }
  return std::memchr(to, 1, pixels) != nullptr;
}

// Pixels on the floor's side that were not floor get the label `ground`, floor on the other side gets 0. The
// watershed line, one pixel wide, and the picture's frame keep their labels.
void move_border(const std::uint8_t* __restrict side, const std::uint8_t* __restrict was_floor,
                 std::size_t pixels, std::uint8_t ground, std::uint8_t* __restrict label) {
  for (std::size_t i = 0; i < pixels; ++i) {
    const bool joins = (side[i] == Watershed::kFirst) & (was_floor[i] == 0);
    const bool leaves = (side[i] == Watershed::kSecond) & (was_floor[i] != 0);
    const std::uint8_t kept = leaves ? std::uint8_t{0} : label[i];
    label[i] = joins ? ground : kept;
  }
}

// Leaves those pixels whose point stands above `ground`. Row 0 of `image` is row `top` of the picture. A
// plane n . p = -h has the disparity d0 = -n . r fx baseline / h at the ray r = (x, y, 1), and a point of
// disparity d on that ray is h (1 - d0 / d) above it.
void keep_standing(BitImage& image, int top, const PlaneSegment& ground, const CameraModel& camera,
                   const DepthImage& depth) {
  const double scale = -camera.fx * camera.baseline_m / ground.distance_m;
  for (int v = 0; v < image.height(); ++v) {
    std::uint64_t* words = image.row(v);
    const double y = (v + top - camera.cy) / camera.fy;
    for (std::size_t i = 0; i < image.words(); ++i) {
      for (std::uint64_t todo = words[i]; todo != 0; todo &= todo - 1) {
        const int bit = std::countr_zero(todo), u = static_cast<int>(i) * 64 + bit;
        const Eigen::Vector3d ray((u - camera.cx) / camera.fx, y, 1);
        const double floor_px = scale * ground.normal.dot(ray), px = depth.disparity(u, v + top);
        const bool stands = px > 0 && px > floor_px + kStands_px &&
                            ground.distance_m * (1 - floor_px / px) > kStands_m;
        if (!stands) words[i] &= ~(std::uint64_t{1} << bit);
      }
    }
  }
}

}  // namespace

struct FloorEdges::State {
  FloorEdgeOptions options;
  std::vector<std::uint8_t> mask;
  BitImage closed, inner, outer, narrow, beside;
  Watershed watershed;
};

FloorEdges::FloorEdges(const FloorEdgeOptions& options) : state_(std::make_unique<State>()) {
  state_->options = options;
}
FloorEdges::~FloorEdges() = default;
FloorEdges::FloorEdges(FloorEdges&&) noexcept = default;
FloorEdges& FloorEdges::operator=(FloorEdges&&) noexcept = default;

Result<void> FloorEdges::sharpen(const Image& left, PlaneSegments& planes,
                                 const DepthImage* depth) {
  const int reach = state_->options.reach_px;
  if (reach < 1 || reach > 64)
    return fail(Fault::usage,
                "floor edges: reach_px " + std::to_string(reach) + ": must be 1 to 64");
  const auto pixels = static_cast<std::size_t>(std::max(0, left.width)) *
                      static_cast<std::size_t>(std::max(0, left.height));
  if (pixels == 0 || left.rgb.size() != 3 * pixels || planes.width != left.width ||
      planes.height != left.height || planes.label.size() != pixels)
    return fail(Fault::usage, "floor edges: picture and planes differ in size");
  if (depth != nullptr && (depth->width != left.width || depth->height != left.height ||
                           depth->disparity_px.size() != pixels))
    return fail(Fault::usage, "floor edges: picture and depth differ in size");

  // Labels that count as floor: floor segments whose middle is within step_m of the plane n . p + d = 0 of
  // the largest one (optical frame, m). Label 0 is no segment; segment k has label k + 1.
  std::array<bool, kLabels> is_floor{};
  int largest = 0;
  for (std::size_t k = 0; k < planes.segments.size() && k < 255; ++k) {
    if (!planes.segments[k].floor) continue;
    is_floor[k + 1] = true;
    const auto& so_far = planes.segments[static_cast<std::size_t>(std::max(0, largest - 1))];
    if (largest == 0 || planes.segments[k].pixels > so_far.pixels)
      largest = static_cast<int>(k) + 1;
  }
  if (largest == 0) return {};
  const PlaneSegment& ground = planes.segments[static_cast<std::size_t>(largest - 1)];
  for (std::size_t k = 0; k < planes.segments.size() && k < 255; ++k) {
    const double above = ground.normal.dot(planes.segments[k].middle) + ground.distance_m;
    if (std::abs(above) > state_->options.step_m) is_floor[k + 1] = false;
  }

  std::vector<std::uint8_t> floor;
  for (std::size_t k = 0; k < kLabels; ++k) {
    if (is_floor[k]) floor.push_back(static_cast<std::uint8_t>(k));
  }

  // Binary floor mask. Only rows within 2 reach of the floor are processed below.
  State& s = *state_;
  s.mask.resize(pixels);
  const auto columns = static_cast<std::size_t>(left.width);
  int top = left.height, bottom = -1;
  for (int v = 0; v < left.height; ++v) {
    const std::size_t row = static_cast<std::size_t>(v) * columns;
    if (!mark_floor(&planes.label[row], columns, floor, &s.mask[row])) continue;
    top = std::min(top, v);
    bottom = v;
  }
  if (bottom < 0) return {};
  top = std::max(0, top - 2 * reach);
  bottom = std::min(left.height - 1, bottom + 2 * reach);
  // Markers: closing and opening remove holes and specks; pixels that survive erosion by `reach` are floor,
  // those outside of the dilation by `reach` are not, and the band between is undecided.
  const std::size_t first = static_cast<std::size_t>(top) * columns;
  s.closed.pack(&s.mask[first], left.width, bottom + 1 - top);
  s.closed.dilate(kSpeck_px);
  s.closed.erode(2 * kSpeck_px);
  s.closed.dilate(kSpeck_px);
  s.inner = s.outer = s.closed;
  s.inner.erode(reach);
  s.outer.dilate(reach);
  s.outer.invert();
  // Narrow things have no pixel so far from the floor. Beside a wide one it would be the rim of that.
  if (depth != nullptr) {
    s.narrow = s.closed;
    s.narrow.dilate(reach - reach / 4);
    s.narrow.invert();
    s.beside = s.outer;
    s.beside.dilate(reach);
    s.narrow.remove(s.beside);
    keep_standing(s.narrow, top, ground, planes.info.camera, *depth);
    s.outer.join(s.narrow);
  }
  const std::vector<std::uint8_t>& side =
      s.watershed.grow(left.rgb.data() + 3 * first, s.inner, s.outer);
  move_border(side.data(), &s.mask[first], side.size(), static_cast<std::uint8_t>(largest),
              &planes.label[first]);
  return {};
}

}  // namespace kaz::vision

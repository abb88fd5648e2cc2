// Plane segmentation: Hough candidates, robust fits, connected cells, then pixels.
// SPDX-License-Identifier: Apache-2.0
#include "vision/planes/plane_segments.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "vision/planes/plane_cells.h"
#include "vision/planes/plane_pixels.h"
#include "vision/planes/plane_votes.h"

namespace kaz::vision {
namespace {

constexpr std::uint8_t kOff = 0, kOn = 1, kUnknown = 2, kPart = 3;  // state of a cell
constexpr int kGap = 2;               // cells without depth that a part may span
constexpr std::size_t kSample = 250;  // cells for ranking candidates

Result<void> check(const DepthImage& depth, const PlaneOptions& o) {
  const CameraModel& c = depth.info.camera;
  const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
  if (depth.width < 32 || depth.height < 32 || depth.width > 8192 || depth.height > 8192)
    return fail(Fault::usage, "planes: the depth image has " + std::to_string(depth.width) + " x " +
                                  std::to_string(depth.height) +
                                  " pixels: must be 32 to 8192 a side");
  if (depth.disparity_px.size() !=
      static_cast<std::size_t>(depth.width) * static_cast<std::size_t>(depth.height))
    return fail(Fault::usage, "planes: the depth image has " +
                                  std::to_string(depth.disparity_px.size()) +
                                  " values, but must have one value per pixel");
  if (!positive(c.fx) || !positive(c.fy) || !std::isfinite(c.cx) || !std::isfinite(c.cy) ||
      !positive(c.baseline_m))
    return fail(Fault::usage,
                "planes: the camera model has no focal length or no baseline: calibrate the eyes");
  if (o.triples < 1 || o.triples > 1'000'000 || o.max_planes < 1 || o.max_planes > kMaxPlanes)
    return fail(Fault::usage,
                "planes: triples must be 1 to 1000000, and max_planes must be 1 to 16");
  if (!positive(o.tolerance_px) || !(o.min_share >= 0 && o.min_share <= 1))
    return fail(Fault::usage, "planes: tolerance_px must be above 0, and min_share must be 0 to 1");
  return {};
}

}  // namespace

struct PlaneSegmentFinder::State {
  PlaneOptions options;
  CellGrid grid;
  PlaneVotes votes;
  PlanePixels pixels;
  std::vector<std::uint8_t> open;  // per cell: usable and on no plane yet
  std::vector<int> open_cells;
  // Per cell, with a border of kOff, so that each cell has four neighbours: kUnknown or kOff; kOff and so on,
  // of the plane in question.
  std::vector<std::uint8_t> unknown, on;
  std::vector<int> bordered, unbordered;  // a cell's number with the border, and the reverse
  struct Visit {
    int cell, gap;  // cell: with the border
  };
  std::vector<Visit> queue;
  std::vector<int> part;
  int bordered_columns = 0, bordered_rows = 0;
  std::vector<std::vector<int>> parts;
  double widest = 0;  // px: inlier threshold of the first round of a fit
  double rms = 0;     // px: of the inliers of the last fit

  double off(const Cell& cell, const DisparityPlane& plane) const {
    return std::abs(static_cast<double>(cell.d - plane.at(cell.u, cell.v)));
  }

  // Trimmed least squares over every `stride`-th of these cells, in `rounds` rounds: inliers within `widest`
  // first, then within 2.5 times the rms of the previous round, so that an adjoining surface does not bias
  // the plane. Returns the number of inliers of the last round; 0 if they do not span a plane.
  int fit(const std::vector<int>& among, std::size_t stride, int rounds, DisparityPlane& plane) {
    double band = widest;
    int count = 0;
    for (int round = 0; round < rounds; ++round) {
      PlaneFit sums;
      double square = 0;
      count = 0;
      for (std::size_t i = 0; i < among.size(); i += stride) {
        const Cell& c = grid.cells[static_cast<std::size_t>(among[i])];
        const double r = off(c, plane);
        if (!(r < band)) continue;
        sums.add(static_cast<double>(c.u), static_cast<double>(c.v), static_cast<double>(c.d));
        square += r * r;
        ++count;
      }
      if (count < 3 || !sums.solve(plane)) return 0;
      rms = std::sqrt(square / count);
      band = std::clamp(2.5 * rms, 0.1 * options.tolerance_px, widest);
    }
    return count;
  }

  // Stores in `parts` the 4-connected components of inlier cells of at least `min_cells` cells, largest
  // first. Gaps of up to kGap cells without depth do not separate a component.
  void connect(const DisparityPlane& plane, int min_cells) {
    on = unknown;
    for (const int i : open_cells) {
      const auto at = static_cast<std::size_t>(i);
      if (off(grid.cells[at], plane) < widest) on[static_cast<std::size_t>(bordered[at])] = kOn;
    }
    parts.clear();
    for (const int i : open_cells) {
      const int seed = bordered[static_cast<std::size_t>(i)];
      if (on[static_cast<std::size_t>(seed)] != kOn) continue;
      flood(seed);
      if (static_cast<int>(part.size()) >= min_cells && broad()) parts.push_back(part);
    }
    std::stable_sort(parts.begin(), parts.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
  }

  // Into `part`; breadth first, so that gaps are crossed by the shortest path.
  void flood(int seed) {
    part.clear();
    queue.resize(on.size());  // a cell is visited once
    std::size_t end = 0;
    Visit* const visits = queue.data();
    std::uint8_t* const state = on.data();
    visits[end++] = {seed, 0};
    state[seed] = kOff;
    for (std::size_t head = 0; head < end; ++head) {
      const auto [i, gap] = visits[head];
      if (gap == 0) part.push_back(unbordered[static_cast<std::size_t>(i)]);
      for (const int step : {-1, 1, -grid.columns - 2, grid.columns + 2}) {
        std::uint8_t& what = state[i + step];
        if (what == kOff || (what == kUnknown && gap == kGap)) continue;
        visits[end++] = {i + step, what == kOn ? 0 : gap + 1};
        what = kOff;
      }
    }
  }

  // Rejects strips: a plane that cuts through other surfaces has its inliers along lines, where almost every
  // cell has a neighbour off the plane. True if a quarter of the cells are interior.
  bool broad() {
    const auto state = [this](int i) -> std::uint8_t& {
      return on[static_cast<std::size_t>(bordered[static_cast<std::size_t>(i)])];
    };
    for (const int i : part) state(i) = kPart;
    int inner = 0;
    for (const int i : part) {
      const int middle = bordered[static_cast<std::size_t>(i)], row = grid.columns + 2;
      const auto is = [&](int j) {
        const auto at = static_cast<std::size_t>(j);
        return on[at] == kPart || unknown[at] == kUnknown;
      };
      if (is(middle - 1) && is(middle + 1) && is(middle - row) && is(middle + row)) ++inner;
    }
    for (const int i : part) state(i) = kOff;
    return 4 * inner >= static_cast<int>(part.size());
  }

  void number_bordered() {
    if (bordered_columns == grid.columns && bordered_rows == grid.rows) return;
    bordered_columns = grid.columns;
    bordered_rows = grid.rows;
    const auto pitch = static_cast<std::size_t>(grid.columns + 2);
    bordered.clear();
    unbordered.assign(pitch * static_cast<std::size_t>(grid.rows + 2), -1);
    unknown.assign(unbordered.size(), kOff);
    for (int row = 0; row < grid.rows; ++row) {
      for (int column = 0; column < grid.columns; ++column) {
        const int at = (row + 1) * (grid.columns + 2) + column + 1;
        unbordered[static_cast<std::size_t>(at)] = static_cast<int>(bordered.size());
        bordered.push_back(at);
      }
    }
  }

  void list_open() {
    open_cells.clear();
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (open[i] != 0) open_cells.push_back(static_cast<int>(i));
    }
  }

  // Finds the next plane and its parts; false if there is none.
  bool next(const CameraModel& camera, int triples, int min_cells, Random& random,
            DisparityPlane& plane) {
    const auto candidates = votes.count(grid, open, open_cells, camera, triples, random);
    struct Ranked {
      int count;
      DisparityPlane plane;
    };
    std::vector<Ranked> ranked;
    const std::size_t stride = std::max<std::size_t>(1, open_cells.size() / kSample);
    for (DisparityPlane candidate : candidates) {
      const int count = static_cast<int>(stride) * fit(open_cells, stride, 2, candidate);
      ranked.push_back({count, candidate});
    }
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const Ranked& a, const Ranked& b) { return a.count > b.count; });
    for (Ranked& r : ranked) {
      if (3 * r.count < min_cells) break;
      if (fit(open_cells, 1, 2, r.plane) < min_cells / 2) continue;
      connect(r.plane, min_cells);
      if (parts.empty() || fit(parts.front(), 1, 3, r.plane) == 0) continue;
      connect(r.plane, min_cells);
      if (parts.empty()) continue;
      plane = r.plane;
      return true;
    }
    return false;
  }
};

PlaneSegmentFinder::PlaneSegmentFinder(const PlaneOptions& options)
    : state_(std::make_unique<State>()) {
  state_->options = options;
}
PlaneSegmentFinder::~PlaneSegmentFinder() = default;
PlaneSegmentFinder::PlaneSegmentFinder(PlaneSegmentFinder&&) noexcept = default;
PlaneSegmentFinder& PlaneSegmentFinder::operator=(PlaneSegmentFinder&&) noexcept = default;

Result<void> PlaneSegmentFinder::find(const DepthImage& depth, PlaneSegments& found) {
  State& s = *state_;
  const PlaneOptions& o = s.options;
  found.info = depth.info;
  if (auto ok = check(depth, o); !ok) return ok;
  s.grid.fill(depth);
  s.number_bordered();
  s.open.resize(s.grid.cells.size());
  for (std::size_t i = 0; i < s.open.size(); ++i) {
    s.open[i] = s.grid.cells[i].usable ? 1 : 0;
    s.unknown[static_cast<std::size_t>(s.bordered[i])] = s.grid.cells[i].usable ? kOff : kUnknown;
  }
  s.list_open();
  s.pixels.begin(s.grid);
  const int min_cells =
      std::max(9, static_cast<int>(o.min_share * static_cast<double>(s.grid.cells.size())));
  Random random(o.seed);
  s.widest = o.tolerance_px;
  bool ended = false;
  int triples = o.triples;
  while (s.pixels.planes() < o.max_planes && !ended &&
         static_cast<int>(s.open_cells.size()) >= min_cells) {
    DisparityPlane plane;
    if (!s.next(depth.info.camera, triples, min_cells, random, plane)) {
      ended = true;
      continue;
    }
    triples = std::max(1, o.triples / 3);
    // The first plane, usually the largest, measures the noise of the cells, taken as uniform.
    if (s.pixels.planes() == 0) s.widest = std::clamp(4 * s.rms, 0.2 * s.widest, s.widest);
    s.pixels.add(plane, s.parts);
    for (const auto& part : s.parts) {
      for (const int i : part) s.open[static_cast<std::size_t>(i)] = 0;
    }
    s.list_open();
  }
  s.pixels.assign(depth, static_cast<float>(o.tolerance_px), found);
  if (depth.info.posture_known) {
    // The floor: a segment whose normal is vertical and whose centre is at height 0, foot frame.
    const Eigen::Vector3d up = depth.info.foot_from_eye.linear().row(2).transpose();
    for (PlaneSegment& segment : found.segments) {
      const double height = (depth.info.foot_from_eye * segment.middle).z();
      segment.floor = up.dot(segment.normal) > std::cos(o.floor_angle_rad) &&
                      std::abs(height) < o.floor_height_m;
    }
  }
  return {};
}

}  // namespace kaz::vision

// Views of the floor from above, and their correlation.
// SPDX-License-Identifier: Apache-2.0
#include "host/map/floor_texture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/base/angle.hpp"

namespace kaz::map {

namespace {

using Eigen::Isometry3d, Eigen::Vector2d, Eigen::Vector2i, Eigen::Vector3d;

constexpr int kCells = FloorView::kCells;
constexpr double kCell = FloorView::kCell;
constexpr double kFarthest = 0.95, kAhead = 0.55;  // m from the eye; of the square's middle
constexpr double kAtFloor_px = 1;                  // of disparity
constexpr int kBox = 4;                            // cells to each side, of the mean
constexpr int kShift = 8;                          // cells: 6.4 cm
constexpr int kTurns = 6;                          // degrees, to each side
constexpr double kFineTurn = 0.25 * kDegree;
constexpr double kMinOverlap = 0.12, kMinCorrelation = 0.4;
// On a floor of planks, which look alike along the grain, what is fixed to the picture (blur, light, the
// rim) draws two views together as if the robot had not moved. m, of a test along the grain, and by how much
// the correlation must fall there to be believed: 0.09 to 0.4 where the shift was right, 0.04 to 0.06 where
// it was 6 cm off.
constexpr double kGrainStep = 0.016, kMinDrop = 0.08;
// Of the correlation, at a shift of 2 cm or a turn of 6 degrees: on a floor of planks, which look alike along
// the grain, the smallest shift is the likeliest.
constexpr double kPrior = 0.04, kPriorShift = 0.02, kPriorTurn = 6 * kDegree;

std::size_t index(int x, int y) {
  return static_cast<std::size_t>(x) * kCells + static_cast<std::size_t>(y);
}

// Whether the map says so of a place whose pixel has no depth, or the floor's; `z`: its depth, m.
bool known_floor(const FloorPictureView& picture, std::size_t pixel, const Vector3d& at, double z) {
  if (picture.map == nullptr || picture.depth == nullptr ||
      picture.map->at(at.x(), at.y()).state != CellState::floor)
    return false;
  const vision::CameraModel& c = picture.planes.info.camera;
  const double disparity = picture.depth->disparity_px[pixel];
  return !(disparity > 0) || std::abs(disparity - c.fx * c.baseline_m / z) < kAtFloor_px;
}

// Brightness of the cells' middles, bilinear; -1 where not known.
std::vector<std::int16_t> brightness(const FloorPictureView& picture,
                                     const Isometry3d& map_from_eye, const Vector2i& corner) {
  const vision::CameraModel& c = picture.planes.info.camera;
  const Isometry3d eye_from_map = map_from_eye.inverse();
  const Vector3d eye = map_from_eye.translation();
  std::array<bool, 256> floor{};
  for (std::size_t i = 0; i < std::min<std::size_t>(picture.planes.segments.size(), 255); ++i)
    floor[i + 1] = picture.planes.segments[i].floor;
  std::vector<std::int16_t> grey(static_cast<std::size_t>(kCells) * kCells, -1);
  for (int x = 0; x < kCells; ++x) {
    for (int y = 0; y < kCells; ++y) {
      const Vector3d at((corner.x() + x + 0.5) * kCell, (corner.y() + y + 0.5) * kCell, 0);
      if ((at - eye).head<2>().squaredNorm() > kFarthest * kFarthest) continue;
      const Vector3d p = eye_from_map * at;
      if (p.z() < 0.05) continue;
      const Vector2d px = c.pixel(p);
      const double u = px.x(), v = px.y();
      if (!(u >= 1 && v >= 1 && u < c.width - 2 && v < c.height - 2)) continue;
      const int column = static_cast<int>(u), row = static_cast<int>(v);
      const auto pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(c.width) +
                         static_cast<std::size_t>(column);
      if (!floor[picture.planes.label[pixel]] && !known_floor(picture, pixel, at, p.z())) continue;
      // 8 bits of the fraction.
      const int du = static_cast<int>((u - column) * 256), dv = static_cast<int>((v - row) * 256);
      const auto green = [&](std::size_t k) {
        return static_cast<int>(picture.left.rgb[3 * k + 1]);
      };
      const auto below = pixel + static_cast<std::size_t>(c.width);
      const int top = green(pixel) * (256 - du) + green(pixel + 1) * du;
      const int bottom = green(below) * (256 - du) + green(below + 1) * du;
      grey[index(x, y)] = static_cast<std::int16_t>((top * (256 - dv) + bottom * dv) >> 16);
    }
  }
  return grey;
}

// Less the mean of what is known in a square around each.
FloorView without_mean(const std::vector<std::int16_t>& grey, const Vector2i& corner) {
  constexpr int kRow = kCells + 1;
  std::vector<int> sums(static_cast<std::size_t>(kRow) * kRow, 0), counts = sums;
  const auto at = [](int x, int y) {
    return static_cast<std::size_t>(x) * kRow + static_cast<std::size_t>(y);
  };
  for (int x = 0; x < kCells; ++x) {
    for (int y = 0; y < kCells; ++y) {
      const int value = grey[index(x, y)];
      const bool known = value >= 0;
      sums[at(x + 1, y + 1)] =
          sums[at(x, y + 1)] + sums[at(x + 1, y)] - sums[at(x, y)] + (known ? value : 0);
      counts[at(x + 1, y + 1)] =
          counts[at(x, y + 1)] + counts[at(x + 1, y)] - counts[at(x, y)] + (known ? 1 : 0);
    }
  }
  FloorView view;
  view.corner = corner;
  view.value.assign(grey.size(), 0);
  view.known.assign(grey.size(), 0);
  for (int x = 0; x < kCells; ++x) {
    for (int y = 0; y < kCells; ++y) {
      if (grey[index(x, y)] < 0) continue;
      const int x0 = std::max(0, x - kBox), x1 = std::min(kCells, x + kBox + 1);
      const int y0 = std::max(0, y - kBox), y1 = std::min(kCells, y + kBox + 1);
      const auto box = [&](const std::vector<int>& all) {
        return all[at(x1, y1)] - all[at(x0, y1)] - all[at(x1, y0)] + all[at(x0, y0)];
      };
      const int value = grey[index(x, y)] - box(sums) / box(counts);
      view.value[index(x, y)] = static_cast<std::int16_t>(std::clamp(value, -127, 127));
      view.known[index(x, y)] = 1;
      ++view.count;
    }
  }
  return view;
}

Vector2i corner_before(const Isometry3d& map_from_eye) {
  Vector2d ahead = map_from_eye.linear().col(2).head<2>();
  if (ahead.norm() > 1e-6) ahead.normalize();
  const Vector2d middle = map_from_eye.translation().head<2>() + kAhead * ahead;
  return (middle / kCell).array().floor().cast<int>() - kCells / 2;
}

struct Sums {
  std::int64_t ab = 0, aa = 0, bb = 0;
  int both = 0;
};
// Of `a` and of `b` moved by (dx, dy) cells.
Sums overlap(const FloorView& a, const FloorView& b, int dx, int dy) {
  Sums sums;
  const Vector2i off = b.corner - a.corner + Vector2i(dx, dy);  // of b's first cell in a
  const int x0 = std::max(0, off.x()), x1 = std::min(kCells, off.x() + kCells);
  const int y0 = std::max(0, off.y()), y1 = std::min(kCells, off.y() + kCells);
  for (int x = x0; x < x1; ++x) {
    const std::int16_t *in_a = &a.value[index(x, 0)], *in_b = &b.value[index(x - off.x(), 0)];
    const std::uint8_t *has_a = &a.known[index(x, 0)], *has_b = &b.known[index(x - off.x(), 0)];
    int ab = 0, aa = 0, bb = 0, both = 0;
    for (int y = y0; y < y1; ++y) {
      const int has = has_a[y] & has_b[y - off.y()];
      const int va = in_a[y] * has, vb = in_b[y - off.y()] * has;
      ab += va * vb;
      aa += va * va;
      bb += vb * vb;
      both += has;
    }
    sums.ab += ab;
    sums.aa += aa;
    sums.bb += bb;
    sums.both += both;
  }
  return sums;
}

// The middle of what both know, of `b` moved by (dx, dy) cells; m, map.
Vector2d middle_of(const FloorView& a, const FloorView& b, int dx, int dy) {
  const Vector2i off = b.corner - a.corner + Vector2i(dx, dy);
  Vector2d sum(0, 0);
  int both = 0;
  for (int x = std::max(0, off.x()); x < std::min(kCells, off.x() + kCells); ++x) {
    for (int y = std::max(0, off.y()); y < std::min(kCells, off.y() + kCells); ++y) {
      if (!(a.known[index(x, y)] & b.known[index(x - off.x(), y - off.y())])) continue;
      sum += Vector2d(x + 0.5, y + 0.5);
      ++both;
    }
  }
  return kCell * (a.corner.cast<double>() + sum / std::max(1, both));
}

struct Best {
  double score = -2, correlation = -1;
  int dx = 0, dy = 0, both = 0;
};

// Of one shift and turn; a score of -2 where too little is in common.
Best score_of(const FloorView& a, const FloorView& b, double turn_rad, int dx, int dy) {
  const Sums sums = overlap(a, b, dx, dy);
  if (sums.both * kCell * kCell < kMinOverlap || sums.aa == 0 || sums.bb == 0) return {};
  const double correlation = static_cast<double>(sums.ab) /
                             std::sqrt(static_cast<double>(sums.aa) * static_cast<double>(sums.bb));
  const double shift = kCell * std::hypot(dx, dy) / kPriorShift, turn = turn_rad / kPriorTurn;
  const double score = correlation - kPrior * (shift * shift + turn * turn);
  return {score, correlation, dx, dy, sums.both};
}

// The best shift of one turn. `step`: of the shifts tried.
Best best_shift(const FloorView& a, const FloorView& b, double turn_rad, int from_x, int from_y,
                int reach, int step) {
  Best best;
  for (int dx = from_x - reach; dx <= from_x + reach; dx += step) {
    for (int dy = from_y - reach; dy <= from_y + reach; dy += step) {
      const Best one = score_of(a, b, turn_rad, dx, dy);
      if (one.score > best.score) best = one;
    }
  }
  return best;
}

// The direction in which a view changes least: across the principal axis of its gradients' tensor, which is
// at atan2(2 xy, xx - yy) / 2.
Vector2d grain(const FloorView& view) {
  double xx = 0, xy = 0, yy = 0;
  for (int x = 0; x + 1 < kCells; ++x) {
    for (int y = 0; y + 1 < kCells; ++y) {
      const std::size_t at = index(x, y), ahead = index(x + 1, y), left = index(x, y + 1);
      if (!(view.known[at] & view.known[ahead] & view.known[left])) continue;
      const double dx = view.value[ahead] - view.value[at], dy = view.value[left] - view.value[at];
      xx += dx * dx;
      xy += dx * dy;
      yy += dy * dy;
    }
  }
  const double across = 0.5 * std::atan2(2 * xy, xx - yy);
  return {-std::sin(across), std::cos(across)};
}

// Where the parabola through the scores at -1, 0 and 1 is highest, of a middle that is: within -0.5..0.5.
double top(double before, double here, double after) {
  const double bend = before - 2 * here + after;
  if (before < -1 || after < -1 || !(bend < 0)) return 0;
  return std::clamp(0.5 * (before - after) / bend, -0.5, 0.5);
}

}  // namespace

FloorView floor_view(const FloorPictureView& picture) {
  const Isometry3d eye = picture.map_from_foot * picture.planes.info.foot_from_eye;
  const Vector2i corner = corner_before(eye);
  return without_mean(brightness(picture, eye, corner), corner);
}

FloorMatcher::FloorMatcher(const FloorPictureView& picture, const Vector2d& pivot)
    : picture_(picture), pivot_(pivot) {}

FloorView FloorMatcher::moved(double turn_rad, const Vector2d& shift) const {
  const Vector2d to = pivot_ + shift;
  FloorPictureView picture = picture_;
  picture.map_from_foot =
      Eigen::Translation3d(to.x(), to.y(), 0) * Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ()) *
      Eigen::Translation3d(-pivot_.x(), -pivot_.y(), 0) * picture_.map_from_foot;
  return floor_view(picture);
}

const FloorView& FloorMatcher::turned(int quarters) {
  const auto [at, absent] = turned_.try_emplace(quarters);
  if (absent) at->second = moved(quarters * kFineTurn, {0, 0});
  return at->second;
}

double FloorMatcher::floor_in_common(const FloorView& before) {
  return overlap(before, view(), 0, 0).both * kCell * kCell;
}

std::optional<FloorShift> FloorMatcher::match(const FloorView& before, const FloorSearch& within) {
  const int reach_cells =
      std::clamp(static_cast<int>(std::ceil(within.shift_m / kCell)), 2, kShift);
  const int reach_degrees =
      std::clamp(static_cast<int>(std::ceil(within.turn_rad / kDegree)), 1, kTurns);
  Best best;
  int turn = 0;  // quarters of a degree
  const auto attempt = [&](int quarters, int from_x, int from_y, int reach, int step) {
    const Best found =
        best_shift(before, turned(quarters), quarters * kFineTurn, from_x, from_y, reach, step);
    if (found.score > best.score) best = found, turn = quarters;
  };
  for (int degrees = -reach_degrees; degrees <= reach_degrees; ++degrees)
    attempt(4 * degrees, 0, 0, reach_cells, 2);
  if (best.score < -1) return std::nullopt;
  const Best coarse = best;
  const int coarse_turn = turn;
  for (const int quarters : {-3, -2, -1, 0, 1, 2, 3})
    attempt(coarse_turn + quarters, coarse.dx, coarse.dy, 2, 1);
  if (best.correlation < kMinCorrelation || std::abs(best.dx) > reach_cells ||
      std::abs(best.dy) > reach_cells || std::abs(turn) > 4 * reach_degrees + 2)
    return std::nullopt;
  const FloorView& here = turned(turn);
  const double turn_rad = turn * kFineTurn;
  const auto shifted = [&](int dx, int dy) {
    return score_of(before, here, turn_rad, best.dx + dx, best.dy + dy).score;
  };
  const auto turned_by = [&](int more) {
    return score_of(before, turned(turn + more), (turn + more) * kFineTurn, best.dx, best.dy).score;
  };
  // Where the next places have too little in common, the best is at the rim of what is compared, and no peak.
  for (const auto& [dx, dy] : {std::pair{2, 0}, {-2, 0}, {0, 2}, {0, -2}})
    if (shifted(dx, dy) < -1) return std::nullopt;
  const Vector2d part(top(shifted(-1, 0), best.score, shifted(1, 0)),
                      top(shifted(0, -1), best.score, shifted(0, 1)));
  const double turn_part = top(turned_by(-1), best.score, turned_by(1));
  FloorShift found;
  found.shift = kCell * (Vector2d(best.dx, best.dy) + part);
  found.turn_rad = turn_rad + kFineTurn * turn_part;
  found.correlation = best.correlation;
  found.overlap_m2 = best.both * kCell * kCell;
  found.middle = middle_of(before, here, best.dx, best.dy);
  const Vector2d along = grain(here);
  const auto correlation_along = [&](double m) {
    return score_of(before, moved(turn_rad, found.shift + m * along), turn_rad, 0, 0).correlation;
  };
  const double beside = std::max(correlation_along(-kGrainStep), correlation_along(kGrainStep));
  if (correlation_along(0) - beside < kMinDrop) {
    found.shift -= found.shift.dot(along) * along;
    found.unknown_along = along;
  }
  if (found.shift.norm() > within.shift_m || std::abs(found.turn_rad) > within.turn_rad)
    return std::nullopt;
  return found;
}

}  // namespace kaz::map

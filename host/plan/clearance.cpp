// Distance of each cell to the nearest obstacle.
// SPDX-License-Identifier: Apache-2.0
#include "host/plan/clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include <opencv2/imgproc.hpp>

namespace kaz::plan {
namespace {

// From an obstacle cell's middle to its farthest point, cells.
constexpr double kHalfDiagonal = 0.70710678118654752;

// Number of the part that each cell belongs to; free cells of a part are connected.
cv::Mat parts_of(const Grid& grid, const std::vector<std::uint8_t>& free) {
  // OpenCV only reads it.
  const cv::Mat cells(grid.cells_x, grid.cells_y, CV_8U, const_cast<std::uint8_t*>(free.data()));
  cv::Mat parts;
  cv::connectedComponents(cells, parts, 8, CV_32S);
  return parts;
}

}  // namespace

Clearance::Clearance(const Grid& grid, const PlanOptions& options)
    : grid_(grid), unknown_factor_(options.unknown_factor) {
  const bool closed = std::isinf(options.unknown_factor);
  const std::size_t n = grid.state.size();
  cv::Mat passable(grid.cells_x, grid.cells_y, CV_8U);
  bool any = false;
  for (std::size_t i = 0; i < n; ++i) {
    const bool blocked = grid.state[i] == map::CellState::obstacle ||
                         (closed && grid.state[i] == map::CellState::unknown);
    passable.data[i] = blocked ? 0 : 1;
    any = any || blocked;
  }
  cv::Mat cells;
  // Without a zero anywhere its result is not defined.
  if (any) cv::distanceTransform(passable, cells, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  clear_m_.resize(n);
  free_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double distance = any ? reinterpret_cast<const float*>(cells.data)[i] : 1e6;
    const double clear = std::max(0.0, (distance - kHalfDiagonal) * grid.cell_m);
    clear_m_[i] = static_cast<float>(clear);
    free_[i] = clear >= options.radius_m ? 1 : 0;
  }
}

double Clearance::weighted_m(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
  const double length = (b - a).norm();
  const int steps = std::max(1, static_cast<int>(std::ceil(length / (0.5 * grid_.cell_m))));
  double sum = 0;
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector2i c = grid_.cell(a + (b - a) * (static_cast<double>(i) / steps));
    if (!free(c.x(), c.y())) return std::numeric_limits<double>::infinity();
    // Trapezoids: the two ends count half.
    sum += factor(c.x(), c.y()) * (i == 0 || i == steps ? 0.5 : 1);
  }
  return length * sum / steps;
}

bool Clearance::connected(const Eigen::Vector2i& from, const Eigen::Vector2i& to) const {
  const cv::Mat parts = parts_of(grid_, free_);
  return parts.at<int>(from.x(), from.y()) == parts.at<int>(to.x(), to.y());
}

std::optional<Eigen::Vector2i> Clearance::nearest_connected(const Eigen::Vector2i& from,
                                                            const Eigen::Vector2d& to) const {
  if (!free(from.x(), from.y())) return std::nullopt;
  const cv::Mat parts = parts_of(grid_, free_);
  const int here = parts.at<int>(from.x(), from.y());
  std::optional<Eigen::Vector2i> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (int x = 0; x < grid_.cells_x; ++x) {
    for (int y = 0; y < grid_.cells_y; ++y) {
      if (parts.at<int>(x, y) != here || grid_.at(x, y) != map::CellState::floor) continue;
      const double d = (grid_.middle(x, y) - to).squaredNorm();
      if (d < least) least = d, nearest = {x, y};
    }
  }
  return nearest;
}

Eigen::Vector2d Clearance::obstacle_near(const Eigen::Vector2i& cell) const {
  const bool closed = std::isinf(unknown_factor_);
  double best = std::numeric_limits<double>::infinity();
  Eigen::Vector2d at = grid_.middle(cell.x(), cell.y());
  for (int x = 0; x < grid_.cells_x; ++x) {
    for (int y = 0; y < grid_.cells_y; ++y) {
      const map::CellState state = grid_.at(x, y);
      if (state != map::CellState::obstacle && !(closed && state == map::CellState::unknown))
        continue;
      const double d = (Eigen::Vector2i(x, y) - cell).cast<double>().squaredNorm();
      if (d >= best) continue;
      best = d;
      at = grid_.middle(x, y);
    }
  }
  return at;
}

// Dijkstra's algorithm with the least clearance of a way in the place of its length.
NoPath Clearance::narrowest(const Eigen::Vector2i& from, const Eigen::Vector2i& to) const {
  struct Open {
    float clear;
    int x, y;
    bool operator<(const Open& other) const { return clear < other.clear; }
  };
  std::vector<float> widest(clear_m_.size(), -1);
  std::vector<std::uint32_t> before(clear_m_.size());
  std::priority_queue<Open> open;
  const auto reach = [&](int x, int y, float clear, std::size_t by) {
    const std::size_t i = grid_.index(x, y);
    clear = std::min(clear, clear_m_[i]);
    if (clear <= widest[i]) return;
    widest[i] = clear;
    before[i] = static_cast<std::uint32_t>(by);
    open.push({clear, x, y});
  };
  reach(from.x(), from.y(), std::numeric_limits<float>::max(), grid_.index(from.x(), from.y()));
  while (!open.empty()) {
    const Open now = open.top();
    open.pop();
    if (now.x == to.x() && now.y == to.y()) break;
    if (now.clear < widest[grid_.index(now.x, now.y)]) continue;
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        if ((dx != 0 || dy != 0) && grid_.inside(now.x + dx, now.y + dy))
          reach(now.x + dx, now.y + dy, now.clear, grid_.index(now.x, now.y));
      }
    }
  }
  std::size_t i = grid_.index(to.x(), to.y());
  std::size_t least = i;
  for (; before[i] != i; i = before[i])
    if (clear_m_[before[i]] < clear_m_[least]) least = before[i];
  const auto row = static_cast<std::size_t>(grid_.cells_y);
  const Eigen::Vector2i cell(static_cast<int>(least / row), static_cast<int>(least % row));
  return {NoPath::Why::enclosed, obstacle_near(cell), clear_m_[least]};
}

}  // namespace kaz::plan

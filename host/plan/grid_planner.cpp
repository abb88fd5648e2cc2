// The reference planner: A* over cells and 16 headings.
// SPDX-License-Identifier: Apache-2.0
#include "host/plan/grid_planner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

#include "host/plan/clearance.h"
#include "host/plan/precheck.h"
#include "host/plan/straighten.h"

namespace kaz::plan {
namespace {

using Eigen::Vector2d;
using Eigen::Vector2i;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr int kHeadings = 16;
// By heading, counter-clockwise.
constexpr std::array<std::array<int, 2>, kHeadings> kStep{{{1, 0},
                                                           {2, 1},
                                                           {1, 1},
                                                           {1, 2},
                                                           {0, 1},
                                                           {-1, 2},
                                                           {-1, 1},
                                                           {-2, 1},
                                                           {-1, 0},
                                                           {-2, -1},
                                                           {-1, -1},
                                                           {-1, -2},
                                                           {0, -1},
                                                           {1, -2},
                                                           {1, -1},
                                                           {2, -1}}};

struct Headings {
  std::array<double, kHeadings> angle_rad, length;
  Headings() {
    for (std::size_t k = 0; k < kHeadings; ++k) {
      angle_rad[k] = std::atan2(kStep[k][1], kStep[k][0]);
      length[k] = std::hypot(kStep[k][0], kStep[k][1]);
    }
  }
};
const Headings& headings() {
  static const Headings all;
  return all;
}

struct Open {
  float estimate;  // s, of the whole way
  std::uint32_t state;
  bool operator<(const Open& other) const { return estimate > other.estimate; }
};

class GridPlanner final : public Planner {
 public:
  explicit GridPlanner(Search search) : search_(search) {}

  std::string name() const override { return search_ == Search::astar ? "astar" : "exhaustive"; }

  Result<Planned> plan(const Grid& grid, const Pose& start, const Goal& goal,
                       const PlanOptions& options) override {
    KAZ_TRY(check(grid, start, goal, options));
    if (options.any_heading) return plan_here(grid, start, goal, options);
    // The cells turned with the robot, so that its steps are along their sides and diagonals.
    const Grid turned = turned_with(grid, start);
    const Eigen::Rotation2Dd back(start.heading_rad);
    Goal there{back.inverse() * (goal.position - start.position), std::nullopt};
    if (goal.heading_rad) there.heading_rad = *goal.heading_rad - start.heading_rad;
    Planned planned = plan_here(turned, Pose{}, there, options);
    const auto place = [&](Vector2d& p) { p = start.position + back * p; };
    if (auto* path = std::get_if<Path>(&planned))
      std::ranges::for_each(path->corners, place);
    else
      place(std::get<NoPath>(planned).where);
    return planned;
  }

 private:
  // The same floor by cells whose x is the robot's heading; what was outside is unknown.
  static Grid turned_with(const Grid& grid, const Pose& start) {
    const double half = std::hypot(grid.cells_x, grid.cells_y) * grid.cell_m;
    Grid turned;
    turned.cell_m = grid.cell_m;
    // The robot in the middle of a cell.
    const int cells = 2 * static_cast<int>(std::ceil(half / grid.cell_m)) + 1;
    turned.cells_x = turned.cells_y = cells;
    turned.corner.setConstant(-0.5 * cells * grid.cell_m);
    turned.state.reserve(static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
    const Eigen::Rotation2Dd turn(start.heading_rad);
    for (int x = 0; x < cells; ++x) {
      for (int y = 0; y < cells; ++y) {
        const Vector2i cell = grid.cell(start.position + turn * turned.middle(x, y));
        turned.state.push_back(grid.at(cell.x(), cell.y()));
      }
    }
    return turned;
  }

  Planned plan_here(const Grid& grid, const Pose& start, const Goal& goal,
                    const PlanOptions& options) {
    const Clearance clearance(grid, options);
    if (auto none = no_path(clearance, start, goal)) return *none;
    const Vector2i from = grid.cell(start.position), to = grid.cell(goal.position);
    begin(grid, to, goal, options);
    const auto last = search(clearance, start, from);
    if (!last) return clearance.narrowest(from, to);
    Path path = straighten(clearance, start, goal, options, corners_of(*last));
    path.expanded = expanded_;
    path.searched_seconds = cost_[*last] + end_turn_s_[*last % kHeadings];
    return path;
  }

  void begin(const Grid& grid, const Vector2i& to, const Goal& goal, const PlanOptions& options) {
    grid_ = &grid;
    goal_ = &goal;
    options_ = &options;
    to_ = to;
    expanded_ = 0;
    const std::size_t states = grid.state.size() * kHeadings;
    cost_.assign(states, std::numeric_limits<float>::infinity());
    before_.resize(states);
    left_m_.assign(grid.state.size(), -1);
    towards_rad_.resize(grid.state.size());
    open_ = {};
    for (int k = 0; k < kHeadings; ++k) {
      end_turn_s_[static_cast<std::size_t>(k)] =
          goal.heading_rad
              ? turn_s(*goal.heading_rad - headings().angle_rad[static_cast<std::size_t>(k)])
              : 0;
    }
  }

  double turn_s(double angle_rad) const {
    return options_->turn_s_per_rad * std::abs(std::remainder(angle_rad, 2 * std::numbers::pi));
  }

  // Time without obstacles.
  float left_s(int x, int y, int heading) {
    if (search_ == Search::exhaustive) return 0;
    const std::size_t i = grid_->index(x, y);
    if (left_m_[i] < 0) {
      const Vector2i d = to_ - Vector2i(x, y);
      left_m_[i] = static_cast<float>(d.cast<double>().norm() * grid_->cell_m);
      towards_rad_[i] = static_cast<float>(std::atan2(d.y(), d.x()));
    }
    const auto k = static_cast<std::size_t>(heading);
    if (left_m_[i] == 0) return static_cast<float>(end_turn_s_[k]);
    const double towards = towards_rad_[i];
    double s = options_->go_s_per_m * left_m_[i] + turn_s(towards - headings().angle_rad[k]);
    if (goal_->heading_rad) s += turn_s(*goal_->heading_rad - towards);
    return static_cast<float>(s);
  }

  std::uint32_t state_of(int x, int y, int heading) const {
    return static_cast<std::uint32_t>(grid_->index(x, y) * kHeadings +
                                      static_cast<std::size_t>(heading));
  }

  void reach(int x, int y, int heading, float cost, std::uint32_t before) {
    const std::uint32_t state = state_of(x, y, heading);
    if (!(cost < cost_[state])) return;
    cost_[state] = cost;
    before_[state] = before;
    open_.push({cost + left_s(x, y, heading), state});
  }

  // The state at the goal, by the fastest way.
  std::optional<std::uint32_t> search(const Clearance& clearance, const Pose& start,
                                      const Vector2i& from) {
    const int every = options_->any_heading ? 1 : 2;
    for (int k = 0; k < kHeadings; k += every) {
      const double turn =
          turn_s(headings().angle_rad[static_cast<std::size_t>(k)] - start.heading_rad);
      reach(from.x(), from.y(), k, static_cast<float>(turn), state_of(from.x(), from.y(), k));
    }
    const auto cells_y = static_cast<std::uint32_t>(grid_->cells_y);
    while (!open_.empty()) {
      const Open now = open_.top();
      open_.pop();
      const std::uint32_t cell = now.state / kHeadings;
      const int heading = static_cast<int>(now.state % kHeadings);
      const int x = static_cast<int>(cell / cells_y), y = static_cast<int>(cell % cells_y);
      const float cost = cost_[now.state];
      if (now.estimate > cost + left_s(x, y, heading)) continue;  // reached faster since
      ++expanded_;
      if (x == to_.x() && y == to_.y() && search_ == Search::astar) return now.state;
      step(clearance, x, y, heading, now.state, cost);
      turn(x, y, heading, every, now.state, cost);
    }
    return search_ == Search::exhaustive ? best_at_goal() : std::nullopt;
  }

  std::optional<std::uint32_t> best_at_goal() const {
    std::optional<std::uint32_t> best;
    double least = kInfinite;
    for (int k = 0; k < kHeadings; ++k) {
      const std::uint32_t state = state_of(to_.x(), to_.y(), k);
      const double s = cost_[state] + end_turn_s_[static_cast<std::size_t>(k)];
      if (s >= least) continue;
      least = s;
      best = state;
    }
    return best;
  }

  void step(const Clearance& clearance, int x, int y, int heading, std::uint32_t state,
            float cost) {
    const auto k = static_cast<std::size_t>(heading);
    const int dx = kStep[k][0], dy = kStep[k][1];
    if (!clearance.free(x + dx, y + dy)) return;
    if (k % 2 == 1) {  // the two cells between, along the longer side
      const int sx = dx / std::abs(dx), sy = dy / std::abs(dy);
      const bool along_x = std::abs(dx) == 2;
      if (!clearance.free(x + (along_x ? sx : 0), y + (along_x ? 0 : sy)) ||
          !clearance.free(x + sx, y + sy))
        return;
    }
    const double factor = 0.5 * (clearance.factor(x, y) + clearance.factor(x + dx, y + dy));
    const double s = options_->go_s_per_m * headings().length[k] * grid_->cell_m * factor;
    reach(x + dx, y + dy, heading, cost + static_cast<float>(s), state);
  }

  void turn(int x, int y, int heading, int every, std::uint32_t state, float cost) {
    for (const int side : {-every, every}) {
      const int next = (heading + side + kHeadings) % kHeadings;
      const double s = turn_s(headings().angle_rad[static_cast<std::size_t>(next)] -
                              headings().angle_rad[static_cast<std::size_t>(heading)]);
      reach(x, y, next, cost + static_cast<float>(s), state);
    }
  }

  // Middles of the cells in which the way begins, turns and ends.
  std::vector<Vector2d> corners_of(std::uint32_t state) const {
    const auto cells_y = static_cast<std::uint32_t>(grid_->cells_y);
    std::vector<Vector2d> corners;
    std::uint32_t heading = state % kHeadings;
    for (;; state = before_[state]) {
      const std::uint32_t cell = state / kHeadings;
      const Vector2d here =
          grid_->middle(static_cast<int>(cell / cells_y), static_cast<int>(cell % cells_y));
      const bool first = before_[state] == state;
      const bool turns = state % kHeadings != heading;
      heading = state % kHeadings;
      if ((corners.empty() || turns || first) && (corners.empty() || corners.back() != here))
        corners.push_back(here);
      if (first) break;
    }
    std::ranges::reverse(corners);
    return corners;
  }

  Search search_;
  const Grid* grid_ = nullptr;
  const Goal* goal_ = nullptr;
  const PlanOptions* options_ = nullptr;
  Vector2i to_{0, 0};
  std::size_t expanded_ = 0;
  std::array<double, kHeadings> end_turn_s_{};
  std::vector<float> cost_;  // s, of the fastest way so far
  std::vector<std::uint32_t> before_;
  std::vector<float> left_m_, towards_rad_;  // by cell; -1: not computed yet
  std::priority_queue<Open> open_;
};

}  // namespace

std::unique_ptr<Planner> make_grid_planner(Search search) {
  return std::make_unique<GridPlanner>(search);
}

}  // namespace kaz::plan

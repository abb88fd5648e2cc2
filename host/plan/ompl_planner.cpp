// A second planner: ABIT* of OMPL, which samples poses instead of cells and headings.
// SPDX-License-Identifier: Apache-2.0
#include "host/plan/ompl_planner.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <mutex>
#include <numbers>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/OptimizationObjective.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/goals/GoalState.h>
#include <ompl/base/samplers/InformedStateSampler.h>
#include <ompl/base/spaces/SE2StateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/informedtrees/ABITstar.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include "host/plan/clearance.h"
#include "host/plan/precheck.h"
#include "host/plan/straighten.h"
#include "shared/base/random.hpp"

namespace kaz::plan {
namespace {

using Eigen::Vector2d;
using Eigen::Vector2i;
namespace ob = ompl::base;
namespace og = ompl::geometric;
using SE2 = ob::SE2StateSpace;

constexpr double kPi = std::numbers::pi;
// Times the least number of neighbours with which ABIT*'s paths become the fastest, as poses become more.
constexpr double kRewire = 1.5;
// ABIT* ends by itself (OMPL's issues report loops for other problems); a guard for plan() to end, too.
constexpr std::int64_t kMaxSteps = 2'000'000;
constexpr int kTries = 200;      // for a pose that may be on a faster path
constexpr double kRim = 2;       // cells beside an obstacle
constexpr double kShort = 1e-9;  // m: the same place

Vector2d position_of(const ob::State* state) {
  const auto* pose = state->as<SE2::StateType>();
  return {pose->getX(), pose->getY()};
}
double heading_of(const ob::State* state) {
  return state->as<SE2::StateType>()->getYaw();
}
void set(ob::State* state, const Vector2d& position, double heading_rad) {
  auto* pose = state->as<SE2::StateType>();
  pose->setXY(position.x(), position.y());
  pose->setYaw(std::remainder(heading_rad, 2 * kPi));
}

// From pose to pose: turn to the other's position, go, turn to its heading.
class Steering {
 public:
  Steering(const Clearance& clearance, const Goal& goal, const PlanOptions& options)
      : clearance_(clearance), goal_(goal), options_(options) {}

  // s, on known floor with nothing in the way: no path from `a` to `b` takes less.
  double least_s(const ob::State* a, const ob::State* b) const {
    const Vector2d line = position_of(b) - position_of(a);
    const double m = line.norm();
    if (m < kShort) return ends_anyhow(b) ? 0 : turn_s(heading_of(b) - heading_of(a));
    return by_line(a, b, m, std::atan2(line.y(), line.x()));
  }

  // The same up to 4 degrees in each turn: most of the time goes into comparing neighbours.
  double roughly_s(const ob::State* a, const ob::State* b) const {
    const Vector2d line = position_of(b) - position_of(a);
    const double sum = std::abs(line.x()) + std::abs(line.y());
    const double quarter = sum > 0 ? 0.5 * kPi * line.y() / sum : 0;
    const double along = line.x() < 0 ? std::copysign(kPi, line.y()) - quarter : quarter;
    return by_line(a, b, line.norm(), along);
  }

  bool is_free(const ob::State* a, const ob::State* b) const {
    return std::isfinite(weighted_m(a, b));
  }

  // s, where it is free; elsewhere as on known floor.
  double seconds(const ob::State* a, const ob::State* b) const {
    const double m = weighted_m(a, b), s = least_s(a, b);
    if (!std::isfinite(m)) return s;
    return s + options_.go_s_per_m * std::max(0.0, m - (position_of(b) - position_of(a)).norm());
  }

 private:
  double by_line(const ob::State* a, const ob::State* b, double m, double along_rad) const {
    double s = turn_s(along_rad - heading_of(a)) + options_.go_s_per_m * m;
    if (!ends_anyhow(b)) s += turn_s(heading_of(b) - along_rad);
    return s;
  }

  // The last turn costs nothing where the goal has no heading.
  bool ends_anyhow(const ob::State* b) const {
    return !goal_.heading_rad && position_of(b) == goal_.position;
  }

  // Between headings within a full turn.
  double turn_s(double angle_rad) const {
    const double a = std::abs(angle_rad);
    return options_.turn_s_per_rad * (a > kPi ? 2 * kPi - a : a);
  }

  // ABIT* takes the time of an edge and then whether it is free: the line is looked at once.
  double weighted_m(const ob::State* a, const ob::State* b) const {
    const Vector2d from = position_of(a), to = position_of(b);
    if (from != from_ || to != to_) {
      from_ = from;
      to_ = to;
      weighted_m_ = clearance_.weighted_m(from, to);
    }
    return weighted_m_;
  }

  const Clearance& clearance_;
  const Goal& goal_;
  const PlanOptions& options_;
  mutable Vector2d from_{0, 0}, to_{0, 0};
  mutable double weighted_m_ = 0;
};

// Neighbours of a pose are those that it reaches first, which is not symmetric: OMPL then compares all poses,
// and needs no random numbers for it. Nothing interpolates in this space.
class Space final : public SE2 {
 public:
  Space(const Grid& grid, const Steering& steering) : steering_(steering) {
    ob::RealVectorBounds bounds(2);
    const Vector2d end = grid.corner + grid.cell_m * Vector2d(grid.cells_x, grid.cells_y);
    for (int axis = 0; axis < 2; ++axis) {
      bounds.setLow(static_cast<unsigned>(axis), grid.corner[axis]);
      bounds.setHigh(static_cast<unsigned>(axis), end[axis]);
    }
    setBounds(bounds);
  }
  double distance(const ob::State* a, const ob::State* b) const override {
    return steering_.roughly_s(a, b);
  }
  bool isMetricSpace() const override { return false; }
  bool hasSymmetricDistance() const override { return false; }
  bool hasSymmetricInterpolate() const override { return false; }

 private:
  const Steering& steering_;
};

class Validator final : public ob::MotionValidator {
 public:
  Validator(const ob::SpaceInformationPtr& space, const Steering& steering)
      : MotionValidator(space), steering_(steering) {}
  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    return steering_.is_free(a, b);
  }
  bool checkMotion(const ob::State* a, const ob::State* b,
                   std::pair<ob::State*, double>& last_valid) const override {
    if (checkMotion(a, b)) return true;
    last_valid.second = 0;
    if (last_valid.first != nullptr) si_->copyState(last_valid.first, a);
    return false;
  }

 private:
  const Steering& steering_;
};

// Poses on free floor through which a path may be faster than the one found. Half of them are anywhere, the
// others beside obstacles and along them: there, in that direction, the shortest paths bend.
class Poses {
 public:
  Poses(const Clearance& clearance, const Steering& steering, double radius_m, std::uint64_t seed)
      : clearance_(clearance), steering_(steering), random_(seed) {
    const Grid& grid = clearance.grid();
    for (int x = 0; x < grid.cells_x; ++x) {
      for (int y = 0; y < grid.cells_y; ++y) {
        if (!clearance.free(x, y)) continue;
        free_.emplace_back(x, y);
        if (clearance.m(x, y) < radius_m + kRim * grid.cell_m) rim_.emplace_back(x, y);
      }
    }
  }

  // Between start and goal in less than `before_s`. False: none was found.
  bool draw(const ob::State* start, const ob::State* goal, double before_s, ob::State* state) {
    for (int i = 0; i < kTries; ++i) {
      const bool beside = !rim_.empty() && random_.chance(0.5);
      const Vector2i cell = any(beside ? rim_ : free_);
      const Grid& grid = clearance_.grid();
      const Vector2d p = grid.middle(cell.x(), cell.y()) +
                         grid.cell_m * Vector2d(random_.uniform() - 0.5, random_.uniform() - 0.5);
      set(state, p, beside ? along(cell) : between(p, position_of(start), position_of(goal)));
      if (steering_.least_s(start, state) + steering_.least_s(state, goal) < before_s) return true;
    }
    return false;
  }

 private:
  const Vector2i& any(const std::vector<Vector2i>& cells) {
    return cells[random_.below(static_cast<std::uint32_t>(cells.size()))];
  }

  // Across to where clearance grows, by central differences; one way or the other.
  double along(const Vector2i& cell) {
    const int x = cell.x(), y = cell.y();
    const auto m = [&](int at_x, int at_y) {
      return clearance_.grid().inside(at_x, at_y) ? clearance_.m(at_x, at_y) : clearance_.m(x, y);
    };
    const Vector2d grows(m(x + 1, y) - m(x - 1, y), m(x, y + 1) - m(x, y - 1));
    return std::atan2(grows.x(), -grows.y()) + (random_.chance(0.5) ? kPi : 0);
  }

  // Half of them any heading, half between that from the start and that to the goal: all of these are as fast
  // where a path bends once.
  double between(const Vector2d& p, const Vector2d& start, const Vector2d& goal) {
    const Vector2d from = p - start, to = goal - p;
    const double part = random_.uniform();
    if (random_.chance(0.5)) return 2 * kPi * part;
    const double first = std::atan2(from.y(), from.x());
    return first + part * std::remainder(std::atan2(to.y(), to.x()) - first, 2 * kPi);
  }

  const Clearance& clearance_;
  const Steering& steering_;
  Random random_;
  std::vector<Vector2i> free_, rim_;  // cells; start and goal are among those that are free
};

class Sampler final : public ob::InformedSampler {
 public:
  Sampler(const ob::ProblemDefinitionPtr& problem, unsigned int calls, Poses& poses)
      : InformedSampler(problem, calls), poses_(poses) {}
  bool sampleUniform(ob::State* state, const ob::Cost& before) override {
    const ob::ProblemDefinition& problem = *getProblemDefn();
    return poses_.draw(problem.getStartState(0), problem.getGoal()->as<ob::GoalState>()->getState(),
                       before.value(), state);
  }
  // From `first` on: ABIT* gives the time without obstacles, which no pose is below.
  bool sampleUniform(ob::State* state, const ob::Cost&, const ob::Cost& before) override {
    return sampleUniform(state, before);
  }
  bool hasInformedMeasure() const override { return false; }
  double getInformedMeasure(const ob::Cost&) const override { return space_->getMeasure(); }

 private:
  Poses& poses_;
};

class Seconds final : public ob::OptimizationObjective {
 public:
  Seconds(const ob::SpaceInformationPtr& space, const Steering& steering, Poses& poses)
      : OptimizationObjective(space), steering_(steering), poses_(poses) {}
  ob::Cost stateCost(const ob::State*) const override { return identityCost(); }
  ob::Cost motionCost(const ob::State* a, const ob::State* b) const override {
    return ob::Cost(steering_.seconds(a, b));
  }
  ob::Cost motionCostHeuristic(const ob::State* a, const ob::State* b) const override {
    return ob::Cost(steering_.least_s(a, b));
  }
  bool isSymmetric() const override { return false; }
  ob::InformedSamplerPtr allocInformedStateSampler(const ob::ProblemDefinitionPtr& problem,
                                                   unsigned int calls) const override {
    return std::make_shared<Sampler>(problem, calls, poses_);
  }

 private:
  const Steering& steering_;
  Poses& poses_;
};

class OmplPlanner final : public Planner {
 public:
  explicit OmplPlanner(const OmplOptions& options) : own_(options) {
    // OMPL writes its progress to the console. Its own random numbers are used for nothing that counts (no
    // sampler of its own, no tree of neighbours); they have a seed for all of the process.
    static std::once_flag once;
    std::call_once(once, [] {
      ompl::msg::noOutputHandler();
      ompl::RNG::setSeed(1);
    });
  }

  std::string name() const override { return "ompl"; }

  Result<Planned> plan(const Grid& grid, const Pose& start, const Goal& goal,
                       const PlanOptions& options) override {
    KAZ_TRY(check(grid, start, goal, options));
    if (!options.any_heading)
      return fail(
          Fault::usage,
          "plan: the planner ompl does not support turns of 45 degrees; use the planner grid");
    const Clearance clearance(grid, options);
    if (auto none = no_path(clearance, start, goal)) return *none;
    try {
      return search(clearance, start, goal, options);
    } catch (const std::exception& error) {
      return fail(Fault::failed, std::string("plan: OMPL failed: ") + error.what());
    }
  }

 private:
  Planned search(const Clearance& clearance, const Pose& from, const Goal& to,
                 const PlanOptions& options) const {
    const Grid& grid = clearance.grid();
    const Steering steering(clearance, to, options);
    Poses poses(clearance, steering, options.radius_m, own_.seed);
    const auto information =
        std::make_shared<ob::SpaceInformation>(std::make_shared<Space>(grid, steering));
    information->setStateValidityChecker([&](const ob::State* state) {
      const Vector2i cell = grid.cell(position_of(state));
      return clearance.free(cell.x(), cell.y());
    });
    information->setMotionValidator(std::make_shared<Validator>(information, steering));
    information->setup();
    ob::ScopedState<> start(information), goal(information);
    set(start.get(), from.position, from.heading_rad);
    set(goal.get(), to.position, to.heading_rad.value_or(0));
    const auto problem = std::make_shared<ob::ProblemDefinition>(information);
    problem->setStartAndGoalStates(start, goal);
    const auto seconds = std::make_shared<Seconds>(information, steering, poses);
    // Rounding must not keep it from seeing that no path can be faster.
    seconds->setCostThreshold(
        ob::Cost(steering.least_s(start.get(), goal.get()) * (1 + 1e-9) + 1e-9));
    problem->setOptimizationObjective(seconds);

    og::ABITstar planner(information, "kaz");
    planner.setSamplesPerBatch(static_cast<unsigned>(own_.batch_size));
    planner.setUseKNearest(true);
    planner.setRewireFactor(kRewire);
    planner.setProblemDefinition(problem);
    planner.setup();
    std::int64_t steps = 0;
    planner.solve(ob::PlannerTerminationCondition([&] {
      const bool found = std::isfinite(planner.bestCost().value());
      const int batches = found ? own_.batches : std::max(own_.batches, own_.batches_until_found);
      return ++steps > kMaxSteps || planner.numBatches() > static_cast<unsigned>(batches);
    }));

    if (!problem->hasExactSolution()) {
      NoPath none = clearance.narrowest(grid.cell(from.position), grid.cell(to.position));
      none.why = NoPath::Why::not_found;
      return none;
    }
    std::vector<Vector2d> corners;
    for (const ob::State* state : problem->getSolutionPath()->as<og::PathGeometric>()->getStates())
      corners.push_back(position_of(state));
    Path path = straighten(clearance, from, to, options, corners);
    path.expanded = planner.numIterations();
    path.searched_seconds = planner.bestCost().value();
    return path;
  }

  OmplOptions own_;
};

}  // namespace

Result<std::unique_ptr<Planner>> make_ompl_planner(const OmplOptions& options) {
  if (options.batches < 1 || options.batch_size < 1)
    return fail(
        Fault::usage,
        "plan: the planner ompl needs at least one batch, with at least one pose per batch");
  return std::make_unique<OmplPlanner>(options);
}

}  // namespace kaz::plan

// navigate: looks around, maps the floor, plans a path and walks it; plans again where the way is not free.
// SPDX-License-Identifier: Apache-2.0
//
// The paper's experiment, sections 4.1 and 4.2: before each straight piece of the path the floor ahead is
// looked at in pictures that are newer than the last step; while walking, each further picture is entered
// into the map, and the robot stops where the way ahead is no longer floor.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "host/behavior/approach.h"
#include "host/behavior/catch_ball.h"
#include "host/behavior/composition.h"
#include "host/behavior/navigation_goal.h"
#include "host/behavior/walking_map.h"
#include "host/map/next_view.h"
#include "host/plan/grid_planner.h"
#include "host/plan/ompl_module.h"
#include "shared/base/angle.hpp"

namespace kaz::behavior {

namespace {

using Eigen::Vector2d;

constexpr Option kOptions[] = {
    {"goal", "1.2,0.1", "X,Y or X,Y,HEADING or ball", 0, 0,
     "X,Y: position in m ahead and to the left of the start, at most 3 m away; HEADING: degrees to "
     "the left, at most 360; ball: find and catch the ball",
     false, is_navigation_goal},
    {"turns", "steered", "steered|paper", 0, 0, "paper: turns are multiples of 45 degrees"},
    {"unknown", "costly", "costly|closed", 0, 0,
     "costly: a path over unseen floor costs twice as much as a path over seen floor; closed: no "
     "path leads over unseen floor"},
    {"planner", "grid", "grid|ompl", 0, 0,
     "grid: searches over cells and headings; ompl: samples random poses (with the algorithm "
     "ABIT* of the library OMPL); ompl is only valid with turns=steered"},
    {"seconds", "600", "", 10, 3600, "time after which the behavior gives up, s"},
};

constexpr host::Gaze kAhead{0, 35 * kDegree};
// Farther aside the eyes see the robot's arms.
constexpr double kSweep = 60 * kDegree, kSweepSpeed = 60 * kDegree;
constexpr double kLookEvery = 15 * kDegree;  // of the directions that may be worth a look
constexpr double kHalfView = 25 * kDegree, kEyesAhead = 0.03;  // m, of the middle
constexpr double kLargestTurn = 60 * kDegree;                  // before the floor is compared
constexpr double kRememberEvery = 25 * kDegree;                // of the sweep, the floor's pattern
constexpr int kPictures = 4;                                   // before a straight piece
constexpr std::size_t kLooks = 3;                              // for a pattern that was seen before
// After a move: the gyro's zero is measured after 0.6 s (motion.cpp).
constexpr Time kGyroStill = std::chrono::milliseconds(1200);
constexpr Time kHeadSettles = std::chrono::milliseconds(250);

constexpr double kArrived = 0.030, kHeadingArrived = 5 * kDegree;  // m, rad, by odometry
constexpr double kTooFarBeside = 0.040;  // m, after the turn to the heading: approaches again
constexpr int kApproaches = 2;
constexpr double kSteered = 9 * kDegree;  // a turn that is walked as a bend
// m, walked before the next look: after 0.45 the floor that both looks see was too little to match.
constexpr double kPiece = 0.3;
constexpr double kShortest = 0.04;  // m, walked at all
constexpr double kBack = 0.10;      // m, up to which the goal behind is walked to backwards
// The ball: approach takes over so near to it, or before it; how far the map may smear it; toes before the
// middle.
constexpr double kApproachable = 0.40, kStandOff = 0.30, kBallMargin = 0.045, kToes = 0.08;  // m
constexpr int kSides = 12;
constexpr double kOwnBody = 0.22;  // m, from a foot's middle to the other side's hand
constexpr double kUnseen = 0.26;   // m, from the middle: below and just before the robot
// Fewer obstacle cells together are strays of depth; near by all count.
// Where no path is left, also more of them are doubted from afar: each piece is looked at before it is
// walked.
constexpr int kSpeck = 8, kDoubtful = 60;
constexpr double kSpecksBeyond = 0.3;  // m
// m: a place from where more may be seen, on the way to a goal that has no path; how near it is walked to.
constexpr double kNearer = 0.15, kAtWaypoint = 0.06;
constexpr int kMaxWaypoints = 4;
constexpr double kHardlyAnyFloor = 0.5;  // m2, in the whole map; a look around shows three
constexpr double kMarginAround = 0.5;    // m, of the map around start and goal
// m, of the disc: with room for what map and odometry err; the smallest is what the hands reach. A nearer
// way with less room is not taken: robots got stuck there.
constexpr double kWiderDiscs[] = {0.19, 0.175, 0.16};
constexpr double kSmallestDisc = 0.15;
constexpr double kRoomToTurn = kSmallestDisc - 0.10;  // m, beyond what look_ahead() leaves

double wrapped(double angle) {
  return std::remainder(angle, 2 * std::numbers::pi);
}

class Navigation {
 public:
  Navigation(BodyControl& body, NavigationGoal goal, map::LocalMap map,
             std::unique_ptr<plan::Planner> planner)
      : body_(body), goal_(std::move(goal)), map_(std::move(map)), planner_(std::move(planner)) {}

  void set_options(bool any_heading, bool unknown_closed) {
    options_.any_heading = any_heading;
    if (unknown_closed) options_.unknown_factor = std::numeric_limits<double>::infinity();
  }

  Result<Outcome> run() {
    const Time start = body_.now();
    KAZ_TRY(look_around());
    if (goal_.ball) {
      const auto found = KAZ_TRY(find_ball());
      if (!found)
        return Outcome{false, "no ball was found", {}, body_.fallen() ? "fell" : "not found"};
    }
    auto outcome = KAZ_TRY(walk_there());
    draw();
    const motion::Place last = place();
    outcome.measurements.insert(outcome.measurements.begin(),
                                {{"navigate_s", seconds(body_.now() - start)},
                                 {"goal_x_m", goal_now().x()},
                                 {"goal_y_m", goal_now().y()},
                                 {"place_x_m", last.x},
                                 {"place_y_m", last.y},
                                 {"heading_deg", wrapped(last.heading) / kDegree},
                                 {"walked_m", walked_m_},
                                 {"moving_s", moving_s_},
                                 {"turns", turns_},
                                 {"looks", looks_},
                                 {"plans", plans_},
                                 {"corrections", map_.corrections()}});
    return outcome;
  }

 private:
  motion::Motion& motion() { return body_.motion(); }
  motion::Place place() { return map_.corrected(body_.motion().place()); }
  Vector2d here() {
    const motion::Place now = place();
    return {now.x, now.y};
  }
  Vector2d in_map(const Vector2d& by_odometry) {
    const motion::Place there = map_.corrected({.x = by_odometry.x(), .y = by_odometry.y()});
    return {there.x, there.y};
  }
  Vector2d goal_now() { return goal_.ball ? ball_ : goal_.position; }

  // ---- Pictures

  Result<void> step() {
    KAZ_TRY(body_.step());
    if (motion().state() == motion::State::turning) turned_until_ = body_.now();
    auto pictures = KAZ_TRY(body_.context().vision->take_floor());
    std::erase_if(pictures, [&](const FloorPicture& picture) {
      return picture.planes.info.exposure <= turned_until_;
    });
    // Standing after a move, the place is odometry's alone until the floor is compared: the pictures of a
    // second would outvote what was seen from places that are better known.
    const bool waits = !looked_since_move_ && motion().idle();
    if (!waits) KAZ_TRY(map_.enter(pictures, body_.places()));
    for (const FloorPicture& picture : pictures) exposures_.push_back(picture.planes.info.exposure);
    if (!pictures.empty()) newest_picture_ = std::move(pictures.back());
    if (goal_.ball && body_.ball().known() && body_.consecutive() >= 3)
      ball_ = in_map(body_.ball().at(body_.now())), ball_known_ = true;
    return {};
  }

  Result<void> stay(Time duration) {
    const Time end = body_.now() + duration;
    while (body_.now() < end && !body_.fallen()) KAZ_TRY(step());
    return {};
  }

  // Until so many pictures have come that were exposed from now on, the head at rest; after the floor was
  // compared they are in the map.
  Result<void> gaze(const host::Gaze& gaze) {
    body_.set_gaze(gaze);
    KAZ_TRY(stay(kHeadSettles));
    const Time since = body_.now();
    exposures_.clear();
    const auto fresh = [&] {
      return looked_since_move_ ? map_.entered_since(since)
                                : static_cast<int>(std::ranges::count_if(
                                      exposures_, [&](Time at) { return at >= since; }));
    };
    while (fresh() < kPictures && !body_.fallen()) KAZ_TRY(step());
    return {};
  }

  // After a move first to where the floor was seen longest ago, and where that shows nothing, elsewhere: its
  // pattern says where the robot is. Then pictures of where it is to look.
  Result<void> look(const host::Gaze& to) {
    if (!looked_since_move_) KAZ_TRY(compare_floor(to));
    looked_since_move_ = true;
    KAZ_TRY(gaze(to));
    if (newest_picture_) map_.align(*newest_picture_, body_.places());
    if (newest_picture_) map_.remember(*newest_picture_, body_.places());
    return {};
  }

  Result<void> compare_floor(const host::Gaze& to) {
    std::vector<double> directions = map_.directions_of_patterns(place());
    if (directions.size() > kLooks) directions.resize(kLooks);
    for (double& direction : directions)
      if (std::abs(direction - to.pan_rad) <= kRememberEvery / 2) direction = to.pan_rad;
    if (std::ranges::find(directions, to.pan_rad) == directions.end())
      directions.push_back(to.pan_rad);
    for (const double direction : directions) {
      if (body_.fallen()) break;
      KAZ_TRY(gaze({direction, to.tilt_rad}));
      if (newest_picture_ && map_.align(*newest_picture_, body_.places())) break;
    }
    return {};
  }

  Result<void> look_around() {
    body_.phase("look around");
    ++looks_;
    looked_around_at_ = here();
    const host::Gaze from = host::gaze_of(body_.measured());
    double pan = from.pan_rad, remembered = pan;
    for (const double to : sweep(from.pan_rad > 0)) {
      const double begin = pan, lasts = std::abs(to - begin) / kSweepSpeed;
      const Time start = body_.now();
      for (double t = 0; t < lasts && !body_.fallen(); t = seconds(body_.now() - start)) {
        pan = begin + std::copysign(kSweepSpeed * t, to - begin);
        body_.set_gaze({pan, kAhead.tilt_rad});
        KAZ_TRY(step());
        if (std::abs(pan - remembered) > kRememberEvery && newest_picture_) {
          remembered = pan;
          map_.remember(*newest_picture_, body_.places());
        }
      }
      pan = to;
    }
    return look(kAhead);
  }

  // To the left and right as far as floor that was not seen yet would come into view, along the path first of
  // all, if there is one.
  std::vector<double> sweep(bool left_first) {
    const motion::Place now = place();
    const Eigen::Vector2d ahead(std::cos(now.heading), std::sin(now.heading));
    std::vector<double> candidates;
    for (double pan = -kSweep; pan < kSweep + 1e-9; pan += kLookEvery) candidates.push_back(pan);
    double left = 0, right = 0;
    for (const double pan : map::directions_worth_a_look(
             map_.map(), {here() + kEyesAhead * ahead, now.heading, kHalfView}, candidates,
             corners_)) {
      left = std::max(left, pan);
      right = std::min(right, pan);
    }
    return left_first ? std::vector{left, right, 0.0} : std::vector{right, left, 0.0};
  }

  Result<bool> find_ball() {
    if (ball_known_) return true;
    const bool found = KAZ_TRY(scan_for_ball(body_, 3, body_.context().seed & 1));
    if (!found) return false;
    body_.set_gaze(kAhead);
    ball_ = in_map(body_.ball().at(body_.now()));
    ball_known_ = true;
    KAZ_TRY(look_around());
    return true;
  }

  // ---- Planning

  plan::Grid grid() {
    const double reach = std::max(goal_now().cwiseAbs().maxCoeff(), here().cwiseAbs().maxCoeff());
    plan::Grid grid = plan::grid_of(
        map_.map(), std::min(2 * (reach + kMarginAround), map_.map().options().size_m));
    plan::forget_specks(grid, doubts_ ? kDoubtful : kSpeck, here(), kSpecksBeyond);
    for (const Vector2d& at : closed_) {
      const Eigen::Vector2i cell = grid.cell(at);
      if (grid.at(cell.x(), cell.y()) == map::CellState::unknown && grid.inside(cell.x(), cell.y()))
        grid.state[grid.index(cell.x(), cell.y())] = map::CellState::obstacle;
    }
    if (unknown_ends()) open_below(grid);
    return grid;
  }

  // The eyes do not see the floor on which the robot stands, nor what is just before its feet.
  void open_below(plan::Grid& grid) {
    for (int x = 0; x < grid.cells_x; ++x) {
      for (int y = 0; y < grid.cells_y; ++y) {
        map::CellState& state = grid.state[grid.index(x, y)];
        if (state == map::CellState::unknown && (grid.middle(x, y) - here()).norm() < kUnseen)
          state = map::CellState::floor;
      }
    }
  }

  // The goal; or places around it, facing it, the nearest first: from there approach takes over, or the
  // map shows whether the goal is free.
  std::vector<plan::Goal> goals() {
    if (waypoint_) return {{*waypoint_, {}}};
    if (!goal_.ball && !explores_) return {{goal_.position, goal_.heading_rad}};
    const Vector2d from = here() - goal_now();
    const double nearest = std::atan2(from.y(), from.x());
    std::vector<plan::Goal> around;
    for (int i = 0; i < kSides; ++i) {
      const int side = (i + 1) / 2 * (i % 2 == 0 ? 1 : -1);  // 0, -1, 1, -2, ...
      const double angle = nearest + side * 2 * std::numbers::pi / kSides;
      around.push_back({goal_now() + kStandOff * Vector2d(std::cos(angle), std::sin(angle)),
                        wrapped(angle + std::numbers::pi)});
    }
    return around;
  }

  // Approach walks straight to the ball, without a map.
  bool near_ball() {
    const Vector2d there = ball_ - here();
    if (there.norm() > kApproachable) return false;
    motion::Place facing = place();
    facing.heading = std::atan2(there.y(), there.x());
    const double until = there.norm() - kBallMargin - kToes;
    return until < 0 || look_ahead(map_.map(), facing, until, false).by != Ahead::By::obstacle;
  }

  Result<plan::Planned> find_path() {
    body_.phase("plan");
    ++plans_;
    auto found = KAZ_TRY(roomiest());
    const auto* path = std::get_if<plan::Path>(&found);
    corners_ = path == nullptr ? std::vector<Vector2d>{} : path->corners;
    draw();
    return found;
  }

  // With the largest disc for which there is a path; without any, why there is none for the smallest.
  Result<plan::Planned> roomiest() {
    const plan::Grid now = grid();
    for (const double radius : kWiderDiscs) {
      options_.radius_m = radius;
      auto found = KAZ_TRY(best_of(now));
      if (std::holds_alternative<plan::Path>(found)) return found;
    }
    options_.radius_m = kSmallestDisc;
    return best_of(now);
  }

  // Of the paths to all goals the fastest; without any, why there is none to the first.
  Result<plan::Planned> best_of(const plan::Grid& grid) {
    std::optional<plan::Planned> best;
    for (const plan::Goal& goal : goals()) {
      auto planned = KAZ_TRY(planner_->plan(grid, {here(), place().heading}, goal, options_));
      const auto* path = std::get_if<plan::Path>(&planned);
      const auto* before = best ? std::get_if<plan::Path>(&*best) : nullptr;
      if (!best || (path != nullptr && (before == nullptr || path->seconds < before->seconds)))
        best = std::move(planned);
    }
    return std::move(*best);
  }

  void draw() {
    trail_.push_back(here());
    body_.context().sink.map(
        {body_.now(), map_.map(), here(), place().heading, corners_, trail_, goal_now()});
  }

  bool unknown_ends() const { return std::isinf(options_.unknown_factor); }

  // ---- Moves

  // In parts, so that after each the eyes see floor that they saw before it: its pattern says by how much the
  // gyro has erred.
  Result<void> turn(double angle) {
    const int parts = 1 + static_cast<int>(std::abs(angle) / kLargestTurn);
    for (int part = 1; part <= parts && !body_.fallen(); ++part) {
      if (std::abs(angle) / parts > kRememberEvery) {
        body_.phase("look aside");
        KAZ_TRY(gaze({std::clamp(angle / parts, -kSweep, kSweep), kAhead.tilt_rad}));
        if (newest_picture_) map_.remember(*newest_picture_, body_.places());
      }
      KAZ_TRY(turn_once(angle / parts));
      if (part < parts) KAZ_TRY(look(kAhead));
    }
    return {};
  }

  Result<void> turn_once(double angle) {
    body_.phase("turn");
    body_.set_gaze(kAhead);
    ++turns_;
    const Time start = body_.now();
    looked_since_move_ = false;
    motion().turn(angle);
    while (!motion().idle() && !body_.fallen()) KAZ_TRY(step());
    moving_s_ += seconds(body_.now() - start);
    return stay(kGyroStill);
  }

  // Bends by `steer` at the beginning, and stops where the way ahead is not free any more.
  Result<void> walk(double distance, double steer) {
    body_.phase("walk");
    body_.set_gaze(kAhead);
    const Time start = body_.now();
    const double from = motion().walked();
    looked_since_move_ = false;
    motion().walk(distance, steer);
    Time seen = map_.newest();
    while (!motion().idle() && !body_.fallen()) {
      KAZ_TRY(step());
      const double left = distance - (motion().walked() - from);
      const bool fresh = map_.newest() > seen;
      seen = map_.newest();
      // A camera that stands still shows no way.
      const bool blind = body_.blind();
      if (distance > 0 && left > kShortest && (blind || (fresh && blocked(left)))) motion().stop();
    }
    walked_m_ += std::abs(motion().walked() - from);
    moving_s_ += seconds(body_.now() - start);
    trail_.push_back(here());
    return stay(kGyroStill);
  }

  bool blocked(double left) {
    const double within = std::min(left, 0.2);
    return free_ahead(place(), within).clear_m < within - 0.02;
  }

  // As look_ahead(), which lets the toes come up to an obstacle: where it ends the robot turns, and its hands
  // reach farther than they do.
  Ahead free_ahead(const motion::Place& along, double until) {
    Ahead ahead = look_ahead(map_.map(), along, until + kRoomToTurn, unknown_ends());
    if (ahead.by != Ahead::By::unknown) ahead.clear_m = std::max(0.0, ahead.clear_m - kRoomToTurn);
    return ahead;
  }

  // The first piece of a path that begins with a straight line. False: it is not free.
  Result<bool> go(double distance, double steer) {
    body_.phase("look ahead");
    KAZ_TRY(look({steer, kAhead.tilt_rad}));
    motion::Place along = place();
    along.heading += steer;
    const double piece = std::min(distance, kPiece);
    const Ahead ahead = free_ahead(along, piece);
    if (ahead.clear_m < std::min(piece, 2 * kShortest)) {
      if (ahead.by == Ahead::By::unknown) close(ahead.where, along.heading);
      return false;
    }
    KAZ_TRY(walk(std::min(piece, ahead.clear_m), steer));
    return true;
  }

  // What was looked at and stays unknown is not floor: an edge, a hole, a mirror.
  void close(const Vector2d& where, double heading) {
    const Vector2d left(-std::sin(heading), std::cos(heading));
    for (double aside = -0.14; aside <= 0.14; aside += 0.01)
      closed_.push_back(where + aside * left);
  }

  Result<Outcome> walk_there() {
    int fruitless = 0;
    for (int moves = 0; moves < kMaxMoves && !body_.fallen(); ++moves) {
      const Vector2d there = goal_now() - here();
      if (!goal_.ball && there.norm() < kArrived) {
        if (!looked_since_move_) {
          KAZ_TRY(look(kAhead));  // the floor's pattern may say otherwise
          continue;
        }
        auto arrived = KAZ_TRY(turn_to_heading());
        // A turn on the spot moves the robot by some centimetres.
        const bool beside = (goal_now() - here()).norm() > kTooFarBeside;
        if (!arrived.success || !beside || again_ == kApproaches) return arrived;
        ++again_;
        continue;
      }
      const double behind =
          wrapped(std::atan2(there.y(), there.x()) - place().heading - std::numbers::pi);
      if (!goal_.ball && there.norm() < kBack && std::abs(behind) < 30 * kDegree) {
        KAZ_TRY(walk(-there.norm(), 0));
        continue;
      }
      // Path and map begin where the robot stands.
      if (!looked_since_move_) {
        KAZ_TRY(look(kAhead));
        continue;
      }
      if (goal_.ball && near_ball())
        return Outcome{true, "the ball is near, and the way is free", {}};
      explores_ = explores_ && there.norm() > kStandOff + kShortest;
      if (waypoint_ && (*waypoint_ - here()).norm() < kAtWaypoint) {
        waypoint_.reset();
        doubts_ = false;
        explored_ = 0;
        KAZ_TRY(look_around());
        continue;
      }
      const auto planned = KAZ_TRY(find_path());
      if (const auto* none = std::get_if<plan::NoPath>(&planned)) {
        const std::string why = text_of(*none);
        const auto again = KAZ_TRY(try_otherwise(*none));
        if (again) continue;
        return Outcome{false, "no path: " + why, {}, "no path"};
      }
      const auto& path = std::get<plan::Path>(planned);
      if (path.legs.empty()) break;
      const bool moved = KAZ_TRY(follow(path));
      fruitless = moved ? 0 : fruitless + 1;
      if (fruitless == 3) KAZ_TRY(look_around());
      if (fruitless > 8) break;
    }
    if (body_.fallen()) return Outcome{false, "the robot fell", {}, "fell"};
    return Outcome{false, "the goal was not reached", {}, "not reached"};
  }

  // Towards the path's first corner that is not just here. False: the way is not free.
  Result<bool> follow(const plan::Path& path) {
    if (path.legs.size() == 1 && path.legs[0].kind == plan::Leg::Kind::turn) {
      KAZ_TRY(turn(path.legs[0].amount));
      return true;
    }
    std::size_t next = 1;
    while (next + 1 < path.corners.size() && (path.corners[next] - here()).norm() < kShortest)
      ++next;
    const Vector2d there = path.corners[next] - here();
    const double off = wrapped(std::atan2(there.y(), there.x()) - place().heading);
    if (std::abs(off) > kSteered) {
      KAZ_TRY(turn(off));
      return true;
    }
    const Vector2d before = here();
    const bool went = KAZ_TRY(go(there.norm(), off));
    return went && (here() - before).norm() > 0.01;
  }

  std::string text_of(const plan::NoPath& none) const {
    std::string text = plan::text(none, options_);
    const std::string goal = "the goal";
    // Planned to places around the goal it is the first of these that is meant.
    if ((goal_.ball || explores_) && text.starts_with(goal))
      text = (goal_.ball ? "the place 0.3 m in front of the ball"
                         : "the place 0.3 m in front of the goal") +
             text.substr(goal.size());
    if (text.find(" at (") != std::string::npos)
      text += "; positions are in m ahead and to the left of the start";
    if (const double seen = floor_seen_m2(); seen < kHardlyAnyFloor) {
      char line[120];
      std::snprintf(
          line, sizeof line,
          ". Only %.2f m2 of floor was seen: add light, or put a texture on a plain floor", seen);
      text += line;
    }
    return text;
  }

  double floor_seen_m2() const {
    const map::LocalMap& map = map_.map();
    int floor = 0;
    for (int x = 0; x < map.cells(); ++x)
      for (int y = 0; y < map.cells(); ++y)
        floor += map.certain(x, y) == map::CellState::floor ? 1 : 0;
    return floor * map.options().cell_m * map.options().cell_m;
  }

  // What may help where there is no path. False: nothing was left to try.
  Result<bool> try_otherwise(const plan::NoPath& none) {
    if (none.why == plan::NoPath::Why::goal_blocked && !explores_ && explored_ < 2 &&
        (goal_now() - here()).norm() > kStandOff + 2 * kShortest) {
      explores_ = true;
      ++explored_;
      return true;
    }
    explores_ = false;
    waypoint_.reset();
    if (none.why == plan::NoPath::Why::start_blocked && stepped_back_ < 2) {
      ++stepped_back_;
      KAZ_TRY(walk(-0.06, 0));
      return true;
    }
    if (!looked_around_at_ || (*looked_around_at_ - here()).norm() > 0.05 || !closed_.empty()) {
      closed_.clear();
      KAZ_TRY(look_around());
      return true;
    }
    if (const auto nearer = nearer_place(); nearer && waypoints_ < kMaxWaypoints) {
      waypoint_ = nearer;
      ++waypoints_;
      return true;
    }
    if (!doubts_) {
      doubts_ = true;
      explored_ = 0;
      return true;
    }
    return false;
  }

  // On floor that was seen, and so much nearer to the goal that it may look otherwise from there.
  std::optional<Vector2d> nearer_place() {
    const auto place = plan::nearest_reachable(grid(), here(), goal_now(), options_);
    if (!place || (*place - goal_now()).norm() > (here() - goal_now()).norm() - kNearer)
      return std::nullopt;
    return place;
  }

  Result<Outcome> turn_to_heading() {
    if (goal_.heading_rad) {
      for (int i = 0; i < 4 && !body_.fallen(); ++i) {
        if (!looked_since_move_) KAZ_TRY(look(kAhead));
        const double off = wrapped(*goal_.heading_rad - place().heading);
        if (std::abs(off) < kHeadingArrived) break;
        KAZ_TRY(turn(off));
      }
    }
    if (body_.fallen()) return Outcome{false, "the robot fell", {}, "fell"};
    const double missed = (goal_now() - here()).norm();
    char text[120];
    std::snprintf(text, sizeof text,
                  "the goal is reached; according to odometry, the error is %.0f mm", 1e3 * missed);
    Outcome outcome{true, text, {{"missed_m", missed}}};
    if (goal_.heading_rad) {
      const double missed_deg = wrapped(*goal_.heading_rad - place().heading) / kDegree;
      outcome.measurements.emplace_back("missed_deg", missed_deg);
      std::snprintf(text, sizeof text, " and %.1f degrees", std::abs(missed_deg));
      outcome.sentence += text;
    }
    return outcome;
  }

  static constexpr int kMaxMoves = 200;

  BodyControl& body_;
  NavigationGoal goal_;
  WalkingMap map_;
  plan::PlanOptions options_;
  std::unique_ptr<plan::Planner> planner_;
  // On slipping soles, which roll, the place of the eyes over the floor is not well known: such pictures
  // smear what stands about.
  Time turned_until_{};
  std::optional<FloorPicture> newest_picture_;
  std::vector<Time> exposures_;  // of the pictures since the head began to rest
  Vector2d ball_{0, 0};
  bool ball_known_ = false;
  std::optional<Vector2d> looked_around_at_;
  std::optional<Vector2d> waypoint_;  // on the way to a goal that has no path yet
  std::vector<Vector2d> closed_, corners_, trail_;
  double walked_m_ = 0, moving_s_ = 0;
  int turns_ = 0, looks_ = 0, plans_ = 0, stepped_back_ = 0, explored_ = 0, again_ = 0,
      waypoints_ = 0;
  bool looked_since_move_ = true;
  bool doubts_ = false;    // small obstacles that are far away
  bool explores_ = false;  // goes to where it can see the goal, which seems not free from afar
};

Result<std::unique_ptr<plan::Planner>> planner_of(const Context& context) {
  if (context.options.choice("planner") == "grid") return plan::make_grid_planner();
  if (context.options.choice("turns") == "paper")
    return fail(Fault::usage,
                "navigate: turns=paper is only valid with planner=grid; leave out turns=paper or "
                "planner=ompl");
  return plan::load_ompl_planner({.seed = context.seed});
}

Result<Outcome> navigate(Context& context) {
  if (context.vision == nullptr)
    return fail(Fault::usage, "navigate needs a camera: give one with --camera");
  auto planner = KAZ_TRY(planner_of(context));
  const NavigationGoal goal = *navigation_goal(context.options.choice("goal"));
  map::LocalMapOptions options;
  options.own_m = kOwnBody;
  options.size_m = std::max(4.0, 2 * (goal.position.cwiseAbs().maxCoeff() + 1));
  auto map = KAZ_TRY(map::LocalMap::make(options));
  auto body = KAZ_TRY(BodyControl::begin(context, kNavigate.name));
  Navigation navigation(body, goal, std::move(map), std::move(planner));
  navigation.set_options(context.options.choice("turns") != "paper",
                         context.options.choice("unknown") == "closed");
  auto outcome = KAZ_TRY(navigation.run());
  if (!goal.ball || !outcome.success) return outcome;
  auto caught = KAZ_TRY(catch_ball(body, {.left_first = (context.seed & 1) != 0}));
  caught.measurements.insert(caught.measurements.begin(), outcome.measurements.begin(),
                             outcome.measurements.end());
  return caught;
}

Result<Outcome> run(Context& context) {
  return within(from_seconds(context.options.number("seconds")), navigate)(context);
}

}  // namespace

constinit const Behavior kNavigate{
    .name = "navigate",
    .text = "map the floor, plan a path to a goal, and walk along the path",
    .needs_camera = true,
    .options = kOptions,
    .run = run,
    .needs_floor = true,
    .world = "boxes",
    .evaluation = {.criterion = Criterion::at_goal, .stage = Stage::course}};

}  // namespace kaz::behavior

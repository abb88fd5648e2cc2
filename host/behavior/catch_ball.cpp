// catch-ball: search, approach, pick up and hold a ball on the floor (paper, section 4.2); retries.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/behavior/approach.h"
#include "host/behavior/catch_ball.h"
#include "host/behavior/composition.h"
#include "host/motion/reach.h"
#include "shared/base/angle.hpp"

namespace kaz::behavior {

namespace {

using Eigen::Vector2d, Eigen::Vector3d;
using motion::Pickup;

constexpr Option kOptions[] = {
    {"tries", "4", "", 1, 20, "maximum number of tries", true},
    {"hold", "3", "", 0.5, 60, "time for which the robot holds the ball, s"},
    {"turns", "3", "", 0, 3, "maximum number of quarter turns of the body during the search", true},
    {"seconds", "300", "", 10, 3600, "time after which the behavior gives up, s"},
};

// After 5 s of walking, the robot is 0.2 m nearer to the ball. After 1.2 s of holding, the head has turned to
// the hand.
constexpr Milestone kMilestones[] = {{"search", "search", 0.5},
                                     {"look", "track", 0.4},
                                     {"walk", "approach", 5},
                                     {"close", "catch", 0},
                                     {"hold", "hold", 1.2}};

// Threshold of the jaw's position error: a jaw blocked by the ball stays 11 degrees from its target, a
// free one at most 3 (friction of 0.05 Nm at 0.8 of full duty (2.16 Nm) per rad, and one code of its
// potentiometer).
constexpr double kStopped = 6 * kDegree;
constexpr Time kDropped = std::chrono::milliseconds(300);
// m, maximum distance of the observed ball from the grasp's centre; its distance comes from its apparent
// size, which the jaws occlude in part.
constexpr double kInHand = 0.045;
constexpr int kOnFloor = 3;  // images

class Catch {
 public:
  explicit Catch(BodyControl& body) : body_(body) {}

  Result<Outcome> search(int turns, bool left_first) {
    if (body_.ball().known() && !body_.unseen_for(std::chrono::milliseconds(500)) &&
        !body_.fallen())
      return Outcome{true, "the ball is in view", {}};
    const Time start = body_.now();
    const auto found = KAZ_TRY(scan_for_ball(body_, turns, left_first));
    if (body_.fallen()) return fell();
    if (!found) return Outcome{false, "no ball was found", {}, "not found"};
    return Outcome{true, "found", {{"found_s", seconds(body_.now() - start)}}};
  }

  Result<Outcome> approach() {
    const auto end = KAZ_TRY(behavior::approach(body_));
    if (end.cause == "fell") return fell();
    if (end.cause == "lost") return Outcome{false, "the ball was lost on the way", {}, "lost"};
    if (!end.cause.empty())
      return Outcome{false, "the robot did not reach the ball", {}, end.cause};
    plan_ = Pickup::plan(end.hand, end.ball, body_.context().ball_radius_m);
    if (!plan_) return Outcome{false, "the ball is out of the hand's reach", {}, "not reached"};
    ball_ = end.ball;
    return Outcome{true,
                   "the ball is in front of a hand",
                   {{"ball_ahead_m", ball_.x()}, {"ball_left_m", ball_.y()}}};
  }

  Result<Outcome> pick_up() {
    time_ = 0;
    KAZ_TRY(play(plan_->bent_s()));
    KAZ_TRY(aim_again());
    body_.phase("reach");
    KAZ_TRY(play(plan_->down_s()));
    body_.phase("close");
    KAZ_TRY(play(plan_->closed_s() + 0.4));
    if (body_.fallen()) return fell();
    if (gap() < kStopped) return give_up("the hand closed without the ball", "not grasped");
    body_.phase("lift");
    KAZ_TRY(play(plan_->end_s()));
    if (body_.fallen()) return fell();
    if (gap() < kStopped) return give_up("the ball was dropped on the way up", "dropped");
    return Outcome{true, "the ball is lifted", {}};
  }

  // Observes the hand for the first half of the time, then the floor where the ball lay.
  Result<Outcome> hold(double hold_s) {
    const Time start = body_.now(), end = start + from_seconds(hold_s);
    const auto load = body_.context().robot.joints(std::uint32_t{1} << plan_->hand_joint());
    if (!load) return tl::unexpected(load.error());
    int in_hand = 0, on_floor = 0;
    Time free_since = start;
    double min_gap = gap();
    while (body_.now() < end && !body_.fallen()) {
      const bool first_half = body_.now() < start + (end - start) / 2;
      const host::JointAngles& angles = body_.measured();
      const Vector3d grasp = motion::trunk_from_grasp(angles, plan_->hand()).translation();
      body_.set_gaze(first_half ? host::gaze_at(grasp)
                                : gaze_at_floor(angles, {ball_.x() + 0.05, ball_.y(), 0.02}));
      KAZ_TRY(body_.step(plan_->at(plan_->end_s())));
      for (const auto& seen : body_.observations()) {
        if (sees_in_hand(seen))
          ++in_hand;
        else if (behavior::on_floor(seen, body_.context().ball_radius_m))
          ++on_floor;
      }
      min_gap = std::min(min_gap, gap());
      if (gap() >= kStopped) free_since = body_.now();
      if (body_.now() - free_since > kDropped) return give_up("the ball was dropped", "dropped");
    }
    if (body_.fallen()) return fell();
    if (on_floor >= kOnFloor && in_hand < on_floor)
      return give_up("the ball is still seen on the floor", "not grasped");
    return Outcome{true,
                   "the ball was lifted and held",
                   {{"held_s", hold_s},
                    {"hand_load", load->front().load},
                    {"hand_gap_deg", min_gap / kDegree},
                    {"seen_in_hand", in_hand}}};
  }

 private:
  static Outcome fell() { return {false, "the robot fell", {}, "fell"}; }

  double gap() const {
    return plan_->closed() - body_.measured()[static_cast<std::size_t>(plan_->hand_joint())];
  }

  bool sees_in_hand(const vision::BallObservation& seen) const {
    if (!seen.found || !seen.info.posture_known) return false;
    host::JointAngles angles;
    std::copy(seen.info.joint_rad.begin(), seen.info.joint_rad.end(), angles.begin());
    const Vector3d ball = host::trunk_from_eye(angles) * seen.position();
    const Vector3d grasp = motion::trunk_from_grasp(angles, plan_->hand()).translation();
    return (ball - grasp).norm() < kInHand;
  }

  Result<void> play(double until_s) {
    const Time start = body_.now() - from_seconds(time_);
    while (time_ < until_s && !body_.fallen()) {
      body_.set_gaze(gaze_at_floor(body_.measured(), {ball_.x(), ball_.y(), 0.02}));
      // The pose is reached about one control cycle after it was sent.
      constexpr double kControlCycle_s = 0.015;
      if (auto done = body_.step(plan_->at(std::min(time_ + kControlCycle_s, until_s))); !done)
        return done;
      time_ = seconds(body_.now() - start);
    }
    time_ = until_s;
    return {};
  }

  // Bent down, the cameras are close above the ball: the arm is aimed at its position measured now.
  Result<void> aim_again() {
    std::vector<double> x, y;
    const Time start = body_.now();
    while (body_.now() - start < std::chrono::milliseconds(600) && !body_.fallen()) {
      body_.set_gaze(gaze_at_floor(body_.measured(), {ball_.x(), ball_.y(), 0.02}));
      if (auto done = body_.step(plan_->at(time_)); !done) return done;
      for (const auto& seen : body_.observations()) {
        const auto point = behavior::on_floor(seen, body_.context().ball_radius_m);
        if (!point || seen.info.exposure < start + std::chrono::milliseconds(200)) continue;
        x.push_back(point->from_middle.x());
        y.push_back(point->from_middle.y());
      }
    }
    if (x.size() < 4) return {};
    std::sort(x.begin(), x.end());
    std::sort(y.begin(), y.end());
    const Vector2d ball(x[x.size() / 2], y[y.size() / 2]);
    if (auto again = plan_->aimed_at(ball)) {
      plan_ = *again;
      ball_ = ball;
    }
    return {};
  }

  // Opens the hand, stands up and restarts odometry.
  Result<Outcome> give_up(const char* sentence, const char* cause) {
    body_.phase("stand up");
    const Time start = body_.now();
    for (double t = 0; t < Pickup::kGiveUp_s && !body_.fallen(); t = seconds(body_.now() - start))
      KAZ_TRY(body_.step(plan_->back(time_, t)));
    body_.track_ball();
    KAZ_TRY(body_.restart());
    if (body_.fallen()) return fell();
    return Outcome{false, sentence, {}, cause};
  }

  BodyControl& body_;
  std::optional<Pickup> plan_;
  Vector2d ball_{0, 0};  // m, from the midpoint of the ankles
  double time_ = 0;      // of the plan, s
};

Result<Outcome> catch_it(Context& context) {
  auto body = KAZ_TRY(BodyControl::begin(context, kCatchBall.name));
  return catch_ball(body, {.tries = static_cast<int>(context.options.number("tries")),
                           .turns = static_cast<int>(context.options.number("turns")),
                           .hold_s = context.options.number("hold"),
                           .left_first = (context.seed & 1) != 0});
}

Result<Outcome> run(Context& context) {
  return within(from_seconds(context.options.number("seconds")), catch_it)(context);
}

}  // namespace

Result<Outcome> catch_ball(BodyControl& body, const CatchOptions& options) {
  const Time start = body.now();
  Catch parts(body);
  const Task once = sequence(
      std::string(kCatchBall.name),
      {{"search", [&](Context&) { return parts.search(options.turns, options.left_first); }},
       {"approach", [&](Context&) { return parts.approach(); }},
       {"catch", [&](Context&) { return parts.pick_up(); }},
       {"hold", [&](Context&) { return parts.hold(options.hold_s); }}});
  const auto retriable = [](const Outcome& failed) {
    return failed.cause != "fell" && failed.cause != "not found";
  };
  auto outcome = retry(options.tries, once, retriable)(body.context());
  if (!outcome) return outcome;
  const double took = seconds(body.now() - start);
  outcome->measurements.emplace_back("catch_s", took);
  char text[120];
  std::snprintf(text, sizeof text, " for %g s, %.0f s after the search began", options.hold_s,
                took);
  if (outcome->success) outcome->sentence += text;
  return outcome;
}

constinit const Behavior kCatchBall{
    .name = "catch-ball",
    .text = "find a ball on the floor, pick up the ball and hold it",
    .needs_camera = true,
    .options = kOptions,
    .run = run,
    .world = "catch",
    .milestones = kMilestones,
    .evaluation = {.criterion = Criterion::ball_held}};

}  // namespace kaz::behavior

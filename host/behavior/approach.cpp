// Observes the ball, turns, walks, observes again.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/approach.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/behavior/search_pattern.h"
#include "shared/base/angle.hpp"

namespace kaz::behavior {

namespace {

using Eigen::Vector2d;

constexpr double kScanSpeed = 90 * kDegree;
constexpr int kConsecutive = 3;

// Best position of the ball for grasping, m from the midpoint of the ankles (right hand: y negative),
// and the deviation from it within which the hand still reaches it with its tolerance of 10 mm left
// (motion::Pickup).
constexpr double kHandX = 0.100, kHandY = 0.047;
constexpr double kRoomX = 0.016, kRoomY = 0.017;

constexpr double kTurnOff = 12 * kDegree;  // above: turn on the spot; below: steer while walking
constexpr double kNear = 0.08;             // m left to walk, from which short strides are used
constexpr double kTooClose = 0.075;        // m ahead, below which the robot steps back first
constexpr double kRolling = 0.04;          // m/s; odometry errors appear as up to half of it
constexpr Time kLost = std::chrono::milliseconds(1000);
constexpr Time kObserveFor = std::chrono::milliseconds(350);
constexpr Time kPatience = std::chrono::seconds(150);
constexpr Time kRemembered = std::chrono::seconds(6);
constexpr double kBehindShoulder = 40 * kDegree;
constexpr std::size_t kMinDetections = 8;
constexpr int kMaxMoves = 30;

// The ball as observed while standing.
struct Observation {
  Vector2d ball{0, 0};  // m, from the midpoint of the ankles
  double speed = 0;     // m/s
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Median position over at least kMinDetections images, or the newest one if the ball rolls. Nothing if
// images came for kLost without a detection. A camera without new images is waited for, up to
// Context::camera_patience.
Result<std::optional<Observation>> observe(BodyControl& body) {
  std::vector<double> x, y, t;
  const Time start = body.now();
  body.track_ball();
  while (!body.fallen()) {
    KAZ_TRY(body.step());
    for (const auto& seen : body.observations()) {
      if (seen.info.exposure < start) continue;
      const auto point = on_floor(seen, body.context().ball_radius_m);
      if (!point) continue;
      x.push_back(point->from_middle.x());
      y.push_back(point->from_middle.y());
      t.push_back(seconds(seen.info.exposure));
    }
    if (body.newest_exposure() - start > kObserveFor && x.size() >= kMinDetections) {
      const std::size_t last = x.size() - 1;
      const auto mean = [](const std::vector<double>& v, std::size_t i) {
        return (v[i] + v[i + 1] + v[i + 2]) / 3;
      };
      const Vector2d moved(mean(x, last - 2) - mean(x, 0), mean(y, last - 2) - mean(y, 0));
      const double speed = moved.norm() / std::max(t[last - 1] - t[1], 0.05);
      if (speed > kRolling) return std::optional<Observation>({{x[last], y[last]}, speed});
      return std::optional<Observation>({{median(x), median(y)}, speed});
    }
    if (body.newest_exposure() - start > kLost && body.unseen_for(kLost)) break;
    if (body.now() - start > 5 * kLost && !body.blind()) break;  // detected only now and then
  }
  return std::optional<Observation>();
}

// Turn (rad, + left) after which a straight walk brings the ball in front of a hand, the smaller of
// both hands': bearing +- asin(hand_y / distance), for the walking line passes the ball at hand_y.
double turn_for(const Vector2d& ball) {
  const double distance = std::max(ball.norm(), 1.05 * kHandY);
  const double bearing = std::atan2(ball.y(), ball.x()), aside = std::asin(kHandY / distance);
  const double right = bearing + aside, left = bearing - aside;
  return std::abs(right) < std::abs(left) ? right : left;
}
// Length of that walk, m: the other leg of the right triangle, less the hand's reach ahead.
double walk_for(const Vector2d& ball) {
  return std::sqrt(std::max(0.0, ball.squaredNorm() - kHandY * kHandY)) - kHandX;
}

Result<void> turn(BodyControl& body, double angle) {
  body.phase("turn");
  body.motion().turn(angle);
  return body.finish();
}

// Walks by short strides and stops by odometry.
Result<void> walk_short(BodyControl& body, double distance) {
  body.phase("step");
  motion::Motion& motion = body.motion();
  const double stride = std::clamp(std::abs(distance) / 2, 0.008, 0.025);
  const double start = motion.walked();
  motion.walk_on(std::copysign(stride, distance), motion.heading());
  constexpr double kRampDown = 0.75;  // strides walked while stopping from full amplitude
  while (!motion.idle() && !body.fallen()) {
    const double walked = std::abs(motion.walked() - start);
    if (walked + kRampDown * stride * motion.amplitude() >= std::abs(distance)) motion.stop();
    if (auto done = body.step(); !done) return done;
  }
  return body.finish();
}

// Walks toward the ball under visual steering; ends standing near it, or earlier when the ball is lost or
// far off the heading.
Result<void> walk_far(BodyControl& body) {
  body.phase("walk");
  motion::Motion& motion = body.motion();
  bool going = true;
  for (bool first = true; first || (!motion.idle() && !body.fallen()); first = false) {
    if (going) {
      const Vector2d ball = body.ball_now();
      const double left = walk_for(ball) - kNear / 2, off = turn_for(ball);
      const bool abort = body.blind() || body.unseen_for(kLost) || std::abs(off) > 2 * kTurnOff;
      if (abort) {
        motion.stop();
        going = false;
      } else {
        motion.walk(std::max(left, 0.0), off);
        going = left > kNear;  // the rest without steering
      }
    }
    if (auto done = body.step(); !done) return done;
    // A frozen camera or a lost ball also ends the rest.
    if (body.blind() || body.unseen_for(kLost)) motion.stop();
  }
  return body.finish();
}

// Makes the next move toward the ball.
Result<void> move(BodyControl& body, const Observation& seen) {
  const Vector2d& ball = seen.ball;
  const double off = turn_for(ball), left = walk_for(ball);
  if (seen.speed > kRolling && ball.norm() < 0.30) {
    body.phase("wait");
    return body.stay(std::chrono::milliseconds(500));
  }
  if (ball.x() < kTooClose && ball.norm() < 0.12)
    return walk_short(body, std::min(ball.x() - kHandX - 0.01, -0.03));
  if (left > kNear) return std::abs(off) > kTurnOff ? turn(body, off) : walk_far(body);
  // Close: straight ahead if that brings it in front of a hand, else turn.
  if (std::abs(std::abs(ball.y()) - kHandY) <= kRoomY) return walk_short(body, ball.x() - kHandX);
  return turn(body, off);
}

}  // namespace

std::optional<host::Side> hand_for(const Vector2d& ball) {
  if (std::abs(ball.x() - kHandX) > kRoomX || std::abs(std::abs(ball.y()) - kHandY) > kRoomY)
    return std::nullopt;
  return ball.y() < 0 ? host::Side::right : host::Side::left;
}

Result<bool> scan_for_ball(BodyControl& body, int turns, bool left_first) {
  motion::Motion& motion = body.motion();
  const auto found = [&] { return body.consecutive() >= kConsecutive && body.ball().known(); };
  body.ball().forget();
  for (int i = 0; i <= turns && !body.fallen(); ++i) {
    if (i > 0) {
      body.phase("turn");
      body.set_gaze({0, 35 * kDegree});
      motion.turn((left_first ? 90 : -90) * kDegree);
      while (!motion.idle() && !body.fallen()) {
        KAZ_TRY(body.step());
        if (found()) motion.stop();
      }
    }
    body.phase("search");
    const SearchPattern pattern(host::gaze_of(body.measured()), kScanSpeed, left_first);
    const Time start = body.now();
    while (seconds(body.now() - start) < pattern.once() && !found() && !body.fallen()) {
      body.set_gaze(pattern.at(seconds(body.now() - start)));
      KAZ_TRY(body.step());
    }
    if (found()) {
      body.track_ball();
      return true;
    }
  }
  return false;
}

Result<Approached> approach(BodyControl& body) {
  const Time end = body.now() + kPatience;
  Approached result;
  bool turned_blindly = false;
  for (int i = 0; i < kMaxMoves && body.now() < end; ++i) {
    body.phase("look");
    const auto seen = KAZ_TRY(observe(body));
    if (body.fallen()) break;
    if (!seen) {
      // Far to the side a shoulder occludes it: turn to its last position, once.
      const bool aside = body.ball().known() &&
                         body.now() - body.ball().last_seen() < kRemembered &&
                         std::abs(turn_for(body.ball_now())) > kBehindShoulder;
      if (!aside || turned_blindly) {
        result.cause = "lost";
        return result;
      }
      turned_blindly = true;
      KAZ_TRY(turn(body, turn_for(body.ball_now())));
      continue;
    }
    turned_blindly = false;
    result.ball = seen->ball;
    const auto hand = hand_for(result.ball);
    if (hand && seen->speed <= kRolling) {
      result.hand = *hand;
      return result;
    }
    KAZ_TRY(move(body, *seen));
  }
  result.cause = body.fallen() ? "fell" : "not reached";
  return result;
}

namespace {

constexpr Option kOptions[] = {{"turns", "3", "", 0, 3,
                                "maximum number of quarter turns of the body during the search",
                                true}};

Result<Outcome> run(Context& context) {
  auto body = KAZ_TRY(BodyControl::begin(context, kApproachBall.name));
  const Time start = body.now();
  const auto found = KAZ_TRY(
      scan_for_ball(body, static_cast<int>(context.options.number("turns")), context.seed & 1));
  if (!found) return Outcome{false, "no ball was found", {}, body.fallen() ? "fell" : "not found"};
  const auto end = KAZ_TRY(approach(body));

  Outcome outcome;
  outcome.success = end.cause.empty();
  outcome.cause = end.cause;
  const double took = seconds(body.now() - start);
  char text[160];
  std::snprintf(text, sizeof text, "the ball is %s, %.0f mm ahead and %.0f mm to the left",
                outcome.success ? "in front of a hand" : end.cause.c_str(), 1e3 * end.ball.x(),
                1e3 * end.ball.y());
  outcome.sentence = text;
  outcome.measurements = {{"approach_s", took},
                          {"ball_ahead_m", end.ball.x()},
                          {"ball_left_m", end.ball.y()},
                          {"walked_m", body.motion().walked()}};
  return outcome;
}

}  // namespace

constinit const Behavior kApproachBall{
    .name = "approach-ball",
    .text = "find a ball and walk until a hand can grasp the ball",
    .needs_camera = true,
    .options = kOptions,
    .run = run,
    .evaluation = {.criterion = Criterion::ball_in_reach}};

}  // namespace kaz::behavior

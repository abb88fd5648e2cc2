// Looks, turns, walks, looks again.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/approach.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/behavior/search_pattern.h"

namespace kaz::behavior {

namespace {

using Eigen::Vector2d;
using motion::kDegree;

constexpr double kScanSpeed = 90 * kDegree;
constexpr int kPicturesInARow = 3;

// Where the hand takes the ball best, from the middle of the ankles (right hand: y negative), and how
// far beside that it still does with its own tolerance of 10 mm left over (motion::Pickup).
constexpr double kHandX = 0.100, kHandY = 0.047;
constexpr double kRoomX = 0.016, kRoomY = 0.017;

constexpr double kTurnOff = 12 * kDegree;  // beyond it turns on the spot; below, it steers
constexpr double kNear = 0.08;             // m still to walk: from here on by short strides
constexpr double kTooClose = 0.075;        // m ahead: steps back before it turns or reaches
constexpr double kRolling = 0.04;          // m/s; odometry's own errors look like half of it
constexpr Time kGone = std::chrono::milliseconds(1000);
constexpr Time kLookFor = std::chrono::milliseconds(350);
constexpr Time kPatience = std::chrono::seconds(150);
constexpr Time kRemembered = std::chrono::seconds(6);
constexpr double kBehindShoulder = 40 * kDegree;
constexpr std::size_t kPictures = 8;
constexpr int kMostMoves = 30;

// The ball as seen while standing.
struct Look {
  Vector2d ball{0, 0};
  double speed = 0;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Nothing where pictures came for a while and did not show it. A camera that stands still is waited
// for (up to ControlCycle::kBlind).
Result<std::optional<Look>> look(BodyControl& body) {
  std::vector<double> x, y, t;
  const Time start = body.now();
  body.look_at_ball();
  while (!body.fallen()) {
    if (auto done = body.step(); !done) return tl::unexpected(done.error());
    for (const auto& seen : body.seen()) {
      if (seen.info.exposure < start) continue;
      const auto point = on_floor(seen, body.context().ball_radius_m);
      if (!point) continue;
      x.push_back(point->from_middle.x());
      y.push_back(point->from_middle.y());
      t.push_back(seconds(seen.info.exposure));
    }
    if (body.newest_exposure() - start > kLookFor && x.size() >= kPictures) {
      const std::size_t last = x.size() - 1;
      const auto mean = [](const std::vector<double>& v, std::size_t i) {
        return (v[i] + v[i + 1] + v[i + 2]) / 3;
      };
      const Vector2d moved(mean(x, last - 2) - mean(x, 0), mean(y, last - 2) - mean(y, 0));
      const double speed = moved.norm() / std::max(t[last - 1] - t[1], 0.05);
      if (speed > kRolling) return std::optional<Look>({{x[last], y[last]}, speed});
      return std::optional<Look>({{median(x), median(y)}, speed});
    }
    if (body.newest_exposure() - start > kGone && body.unseen_for(kGone)) break;
    if (body.now() - start > 5 * kGone && !body.blind()) break;  // seen now and then only
  }
  return std::optional<Look>();
}

// What to turn by so that a straight walk brings the ball before a hand, by the smaller turn.
double turn_for(const Vector2d& ball) {
  const double way = std::max(ball.norm(), 1.05 * kHandY);
  const double bearing = std::atan2(ball.y(), ball.x()), aside = std::asin(kHandY / way);
  const double right = bearing + aside, left = bearing - aside;
  return std::abs(right) < std::abs(left) ? right : left;
}
double walk_for(const Vector2d& ball) {
  return std::sqrt(std::max(0.0, ball.squaredNorm() - kHandY * kHandY)) - kHandX;
}

Result<void> turn(BodyControl& body, double angle) {
  body.phase("turn");
  body.motion().turn(angle);
  return body.finish();
}

// By short strides; odometry says when to stop.
Result<void> walk_short(BodyControl& body, double distance) {
  body.phase("step");
  motion::Motion& motion = body.motion();
  const double stride = std::clamp(std::abs(distance) / 2, 0.008, 0.025);
  const double start = motion.walked();
  motion.walk_on(std::copysign(stride, distance), motion.heading());
  constexpr double kRampDown = 0.75;  // strides that a stop from full amplitude still walks
  while (!motion.idle() && !body.fallen()) {
    const double walked = std::abs(motion.walked() - start);
    if (walked + kRampDown * stride * motion.amplitude() >= std::abs(distance)) motion.stop();
    if (auto done = body.step(); !done) return done;
  }
  return body.finish();
}

// Toward the ball, steering by what is seen; ends standing near it, or sooner when something is odd.
Result<void> walk_far(BodyControl& body) {
  body.phase("walk");
  motion::Motion& motion = body.motion();
  bool going = true;
  for (bool first = true; first || (!motion.idle() && !body.fallen()); first = false) {
    if (going) {
      const Vector2d ball = body.ball_now();
      const double way = walk_for(ball) - kNear / 2, off = turn_for(ball);
      const bool odd = body.blind() || body.unseen_for(kGone) || std::abs(off) > 2 * kTurnOff;
      if (odd) {
        motion.stop();
        going = false;
      } else {
        motion.walk(std::max(way, 0.0), off);
        going = way > kNear;  // the rest by itself
      }
    }
    if (auto done = body.step(); !done) return done;
    // A camera that stands still or a ball that is gone also ends the rest.
    if (body.blind() || body.unseen_for(kGone)) motion.stop();
  }
  return body.finish();
}

// The next move toward a ball that lies or rolls there.
Result<void> move(BodyControl& body, const Look& seen) {
  const Vector2d& ball = seen.ball;
  const double off = turn_for(ball), way = walk_for(ball);
  if (seen.speed > kRolling && ball.norm() < 0.30) {
    body.phase("wait");
    return body.stay(std::chrono::milliseconds(500));
  }
  if (ball.x() < kTooClose && ball.norm() < 0.12)
    return walk_short(body, std::min(ball.x() - kHandX - 0.01, -0.03));
  if (way > kNear) return std::abs(off) > kTurnOff ? turn(body, off) : walk_far(body);
  // Close: straight ahead if that puts it before a hand, else turn.
  if (std::abs(std::abs(ball.y()) - kHandY) <= kRoomY) return walk_short(body, ball.x() - kHandX);
  return turn(body, off);
}

}  // namespace

std::optional<host::Side> hand_for(const Vector2d& ball) {
  if (std::abs(ball.x() - kHandX) > kRoomX || std::abs(std::abs(ball.y()) - kHandY) > kRoomY)
    return std::nullopt;
  return ball.y() < 0 ? host::Side::right : host::Side::left;
}

Result<bool> look_around(BodyControl& body, int turns, bool left_first) {
  motion::Motion& motion = body.motion();
  const auto found = [&] { return body.seen_in_a_row() >= kPicturesInARow && body.ball().known(); };
  body.ball().forget();
  for (int i = 0; i <= turns && !body.fallen(); ++i) {
    if (i > 0) {
      body.phase("turn");
      body.look({0, 35 * kDegree});
      motion.turn((left_first ? 90 : -90) * kDegree);
      while (!motion.idle() && !body.fallen()) {
        if (auto done = body.step(); !done) return tl::unexpected(done.error());
        if (found()) motion.stop();
      }
    }
    body.phase("search");
    const SearchPattern pattern(host::gaze_of(body.measured()), kScanSpeed, left_first);
    const Time start = body.now();
    while (seconds(body.now() - start) < pattern.once() && !found() && !body.fallen()) {
      body.look(pattern.at(seconds(body.now() - start)));
      if (auto done = body.step(); !done) return tl::unexpected(done.error());
    }
    if (found()) {
      body.look_at_ball();
      return true;
    }
  }
  return false;
}

Result<Approached> approach(BodyControl& body) {
  const Time end = body.now() + kPatience;
  Approached result;
  bool turned_blindly = false;
  for (int i = 0; i < kMostMoves && body.now() < end; ++i) {
    body.phase("look");
    const auto seen = look(body);
    if (!seen) return tl::unexpected(seen.error());
    if (body.fallen()) break;
    if (!*seen) {
      // Far to the side a shoulder hides it: turn to where it was, once.
      const bool aside = body.ball().known() &&
                         body.now() - body.ball().last_seen() < kRemembered &&
                         std::abs(turn_for(body.ball_now())) > kBehindShoulder;
      if (!aside || turned_blindly) {
        result.cause = "lost";
        return result;
      }
      turned_blindly = true;
      if (auto done = turn(body, turn_for(body.ball_now())); !done)
        return tl::unexpected(done.error());
      continue;
    }
    turned_blindly = false;
    result.ball = (*seen)->ball;
    const auto hand = hand_for(result.ball);
    if (hand && (*seen)->speed <= kRolling) {
      result.hand = *hand;
      return result;
    }
    if (auto done = move(body, **seen); !done) return tl::unexpected(done.error());
  }
  result.cause = body.fallen() ? "fell" : "not reached";
  return result;
}

namespace {

constexpr Option kOptions[] = {{"turns", "3", "", 0, 3, "quarter turns of the body in the search"}};

Result<Outcome> run(Context& context) {
  auto body = BodyControl::begin(context, kApproachBall.name);
  if (!body) return tl::unexpected(body.error());
  const Time start = body->now();
  const auto found =
      look_around(*body, static_cast<int>(context.options.number("turns")), context.seed & 1);
  if (!found) return tl::unexpected(found.error());
  if (!*found)
    return Outcome{
        false, "no ball was found all around", {}, body->fallen() ? "fell" : "not found"};
  const auto end = approach(*body);
  if (!end) return tl::unexpected(end.error());

  Outcome outcome;
  outcome.success = end->cause.empty();
  outcome.cause = end->cause;
  const double took = seconds(body->now() - start);
  char text[160];
  std::snprintf(text, sizeof text, "the ball is %s, %.0f mm ahead and %.0f mm to the left",
                outcome.success ? "before a hand" : end->cause.c_str(), 1e3 * end->ball.x(),
                1e3 * end->ball.y());
  outcome.sentence = text;
  outcome.figures = {{"approach_s", took},
                     {"ball_ahead_m", end->ball.x()},
                     {"ball_left_m", end->ball.y()},
                     {"walked_m", body->motion().walked()}};
  return outcome;
}

}  // namespace

constinit const Behavior kApproachBall{
    "approach-ball", "find a ball and walk until a hand can take it", true, kOptions, run};

}  // namespace kaz::behavior

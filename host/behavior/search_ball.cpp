// search-ball: moves the head along the search pattern, then turns the body, until a ball is found.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/search_ball.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/behavior/approach.h"
#include "host/behavior/composition.h"
#include "host/behavior/search_pattern.h"
#include "shared/base/angle.hpp"

namespace kaz::behavior {

namespace {

constexpr Option kOptions[] = {
    {"seconds", "100", "", 0.1, 3600, "time after which the behavior gives up, s"},
    {"turns", "3", "", 0, 3,
     "maximum number of quarter turns of the body; the head scans for the "
     "ball before and after each turn",
     true}};

// At 90 degrees/s an object stays in a view 80 degrees wide for 0.9 s: 26 images at 30 Hz.
constexpr double kSpeed = 90 * kDegree;
constexpr int kConsecutive = 3;

Outcome not_found(const char* text) {
  return {false, text, {}, "not found"};
}

// Where the ball is from the left eye as the head is held now, in the trunk's axes: `ball_bearing_deg` to the
// left, `ball_elevation_deg` up. Nothing of an observation without posture.
void report_direction(const vision::BallObservation& seen, const host::JointAngles& now,
                      Outcome& outcome) {
  if (!seen.info.posture_known || seen.info.joint_rad.size() != KZ_JOINTS) return;
  host::JointAngles then;
  std::copy(seen.info.joint_rad.begin(), seen.info.joint_rad.end(), then.begin());
  const Eigen::Vector3d ball = host::trunk_from_eye(then) * seen.position();
  const Eigen::Vector3d ray = ball - host::trunk_from_eye(now).translation();
  outcome.measurements.emplace_back("ball_bearing_deg", std::atan2(ray.y(), ray.x()) / kDegree);
  outcome.measurements.emplace_back("ball_elevation_deg",
                                    std::atan2(ray.z(), ray.head<2>().norm()) / kDegree);
}

// With turns of the body, after a scan by the head alone found nothing; from the walking crouch.
Result<Outcome> run_turning(Context& context) {
  auto body = KAZ_TRY(BodyControl::begin(context, kSearchBall.name));
  const Time start = body.now();
  const auto found = KAZ_TRY(
      scan_for_ball(body, static_cast<int>(context.options.number("turns")), context.seed & 1));
  if (body.fallen()) return Outcome{false, "the robot fell", {}, "fell"};
  if (!found) return not_found("no ball was found");
  const Eigen::Vector2d ball = body.ball_now();
  char text[120];
  const double after = seconds(body.now() - start);
  std::snprintf(text, sizeof text, "the ball was found after %.1f s, %.2f m away", after,
                ball.norm());
  Outcome outcome{true,
                  text,
                  {{"found_s", after},
                   {"ball_distance_m", ball.norm()},
                   {"turned_deg", body.motion().heading() / kDegree}}};
  if (body.newest_ball()) report_direction(*body.newest_ball(), body.measured(), outcome);
  return outcome;
}

Result<Outcome> run(Context& context) {
  auto head = KAZ_TRY(HeadControl::begin(context, kSearchBall.name));
  const Time start = head.now();
  const double limit = context.options.number("seconds");
  const bool turns = context.options.number("turns") >= 1 && context.other_joints.empty();
  const SearchPattern once(head.measured(), kSpeed, context.seed & 1);
  const double alone = turns ? std::min(limit, once.once()) : limit;
  const auto found = KAZ_TRY(search(head, from_seconds(alone), context.seed & 1));
  if (!found && alone < limit) {
    auto outcome = within(from_seconds(limit - alone), run_turning)(context);
    if (outcome && outcome->cause == "time") {
      char text[80];
      std::snprintf(text, sizeof text, "no ball was found in %g s", limit);
      *outcome = not_found(text);
    }
    return outcome;
  }

  Outcome outcome;
  outcome.success = found;
  char text[120];
  if (found) {
    const double after = seconds(head.now() - start);
    const host::Gaze ball = head.tracker().at(head.now());
    std::snprintf(text, sizeof text, "the ball was found after %.1f s, %.2f m away", after,
                  head.ball()->distance_m);
    outcome.measurements = {{"found_s", after},
                            {"ball_pan_deg", ball.pan_rad / kDegree},
                            {"ball_tilt_deg", ball.tilt_rad / kDegree},
                            {"ball_distance_m", head.ball()->distance_m}};
    report_direction(*head.ball(), head.posture(), outcome);
  } else {
    std::snprintf(text, sizeof text, "no ball was found in %g s", limit);
    outcome.cause = "not found";
  }
  outcome.sentence = text;
  return outcome;
}

}  // namespace

constinit const Behavior kSearchBall{
    .name = "search-ball",
    .text = "look around until a ball is found",
    .needs_camera = true,
    .options = kOptions,
    .run = run,
    .evaluation = {.criterion = Criterion::ball_direction, .walks = false}};

Result<bool> search(HeadControl& head, Time limit, bool left_first) {
  head.phase("search");
  head.tracker().forget();
  const Time start = head.now();
  const SearchPattern pattern(head.measured(), kSpeed, left_first);
  while (head.now() - start < limit) {
    if (head.consecutive() >= kConsecutive && head.tracker().known()) return true;
    KAZ_TRY(head.step(pattern.at(seconds(head.now() - start))));
  }
  return false;
}

}  // namespace kaz::behavior

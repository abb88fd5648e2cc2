// search-ball: the search pattern, until the ball is there.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/search_ball.h"

#include <cstdio>
#include <numbers>

#include "host/behavior/approach.h"
#include "host/behavior/search_pattern.h"

namespace kaz::behavior {

namespace {

constexpr Option kOptions[] = {{"seconds", "20", "", 0.1, 3600, "gives up after this time, s"}};

constexpr double kDegree = std::numbers::pi / 180;
// At 90 degrees/s a thing stays in a view 80 degrees wide for 0.9 s: 26 pictures at 30 Hz.
constexpr double kSpeed = 90 * kDegree;
constexpr int kPicturesInARow = 3;

Result<Outcome> run(Context& context) {
  auto head = HeadControl::begin(context, kSearchBall.name);
  if (!head) return tl::unexpected(head.error());
  const Time start = head->now();
  const double limit = context.options.number("seconds");
  const auto found = search(*head, from_seconds(limit), context.seed & 1);
  if (!found) return tl::unexpected(found.error());

  Outcome outcome;
  outcome.success = *found;
  char text[120];
  if (*found) {
    const double after = seconds(head->now() - start);
    const host::Gaze ball = head->tracker().at(head->now());
    std::snprintf(text, sizeof text, "the ball was found after %.1f s, %.2f m away", after,
                  head->ball()->distance_m);
    outcome.figures = {{"found_s", after},
                       {"ball_pan_deg", ball.pan_rad / kDegree},
                       {"ball_tilt_deg", ball.tilt_rad / kDegree},
                       {"ball_distance_m", head->ball()->distance_m}};
  } else {
    std::snprintf(text, sizeof text, "no ball was found in %g s", limit);
  }
  outcome.sentence = text;
  return outcome;
}

}  // namespace

constinit const Behavior kSearchBall{"search-ball", "look around until a ball is found", true,
                                     kOptions, run};

Result<bool> search(HeadControl& head, Time limit, bool left_first) {
  head.phase("search");
  head.tracker().forget();
  const Time start = head.now();
  const SearchPattern pattern(head.measured(), kSpeed, left_first);
  while (head.now() - start < limit) {
    if (head.seen_in_a_row() >= kPicturesInARow && head.tracker().known()) return true;
    if (auto stepped = head.step(pattern.at(seconds(head.now() - start))); !stepped) {
      return tl::unexpected(stepped.error());
    }
  }
  return false;
}

}  // namespace kaz::behavior

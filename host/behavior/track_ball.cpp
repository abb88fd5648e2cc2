// track-ball: centres a ball in the left camera by moving the head; searches when it is lost (paper, 4.2).
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/behavior/search_ball.h"
#include "shared/base/angle.hpp"

namespace kaz::behavior {

namespace {

constexpr Option kOptions[] = {
    {"seconds", "20", "", 0.1, 86400, "tracking time after the ball was found, s"},
    {"search-seconds", "20", "", 0.1, 3600, "time after which the search for the ball ends, s"}};

constexpr double kWithin = 3 * kDegree;
constexpr double kShare = 0.9;
constexpr Time kLostAfter = std::chrono::milliseconds(500);

bool lost(HeadControl& head) {
  return head.newest_exposure() - head.tracker().last_seen() > kLostAfter;
}

// Tracks until `end`, searching after each loss. Returns the number of losses.
Result<int> follow(HeadControl& head, Time end, bool left_first) {
  int losses = 0;
  head.phase("track");
  while (head.now() < end) {
    if (lost(head)) {
      ++losses;
      const auto again = KAZ_TRY(search(head, end - head.now(), left_first));
      if (!again) break;
      head.phase("track");
    }
    const host::Gaze ahead = head.tracker().at(head.now() + HeadControl::kLead);
    KAZ_TRY(head.step(ahead));
  }
  return losses;
}

// Quantile of sorted values.
double quantile(const std::vector<double>& sorted, double q) {
  if (sorted.empty()) return 0;
  return sorted[std::min(sorted.size() - 1,
                         static_cast<std::size_t>(q * static_cast<double>(sorted.size())))];
}

// Statistics of the images since the ball was found; those without a detection count as misses.
Outcome score(const std::vector<PictureRow>& pictures, Time found_at, double found_s, int losses) {
  std::size_t taken = 0, within = 0;
  std::vector<double> errors;
  for (const PictureRow& row : pictures) {
    if (row.exposure < found_at) continue;
    ++taken;
    if (!row.found) continue;
    errors.push_back(row.error_rad / kDegree);
    if (row.error_rad <= kWithin) ++within;
  }
  std::sort(errors.begin(), errors.end());
  const double share = taken ? static_cast<double>(within) / static_cast<double>(taken) : 0;

  Outcome outcome;
  outcome.success = share >= kShare;
  char text[160];
  std::snprintf(text, sizeof text,
                "the ball was found after %.1f s; after that, vision saw the ball within 3 degrees "
                "of the image center in %.0f %% of %zu pictures",
                found_s, std::min(share * 100, 100.0), taken);
  outcome.sentence = text;
  if (!outcome.success)
    outcome.sentence +=
        ", but at least " + std::to_string(std::lround(kShare * 100)) + " % are required";
  outcome.measurements = {{"found_s", found_s},
                          {"pictures_of_tracking", static_cast<double>(taken)},
                          {"pictures_with_ball", static_cast<double>(errors.size())},
                          {"losses", static_cast<double>(losses)}};
  if (taken > 0) outcome.measurements.emplace_back("tracking_within_3deg", share);
  if (!errors.empty()) {
    outcome.measurements.emplace_back("tracking_error_median_deg", quantile(errors, 0.5));
    outcome.measurements.emplace_back("tracking_error_p95_deg", quantile(errors, 0.95));
  }
  return outcome;
}

Result<Outcome> run(Context& context) {
  auto head = KAZ_TRY(HeadControl::begin(context, kTrackBall.name));
  const Time start = head.now();
  const bool left_first = context.seed & 1;
  const double patience = context.options.number("search-seconds");
  const auto found = KAZ_TRY(search(head, from_seconds(patience), left_first));
  if (!found) {
    char text[80];
    std::snprintf(text, sizeof text, "no ball was found in %g s", patience);
    return Outcome{false, text, {}, "not found"};
  }
  const Time found_at = head.now();
  const Time end = found_at + from_seconds(context.options.number("seconds"));
  const auto losses = KAZ_TRY(follow(head, end, left_first));
  return score(head.pictures(), found_at, seconds(found_at - start), losses);
}

}  // namespace

constinit const Behavior kTrackBall{
    .name = "track-ball",
    .text = "find a ball and follow it with the head",
    .needs_camera = true,
    .options = kOptions,
    .run = run,
    .evaluation = {.criterion = Criterion::ball_tracked, .walks = false}};

}  // namespace kaz::behavior

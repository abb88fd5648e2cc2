// play: moves through the poses of a file (motion/pose_sequence.h).
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "host/behavior/pose_player.h"
#include "shared/base/angle.hpp"

namespace kaz::behavior {

namespace {

constexpr std::string_view kNone = "none";

bool is_poses(std::string_view text) {
  return text == kNone || motion::parse_poses(text, "poses").has_value();
}

constexpr Option kOptions[] = {
    {"poses", kNone, "the text of a pose file", 0, 0, "poses to play; give --poses FILE", false,
     is_poses},
    {"times", "1", "", 1, 1000, "number of times to play the poses", true},
};

// At the end each joint is this near to its place, as `stand` demands it; on the way none is farther than the
// other: it is blocked, or asked for more than the motor can do.
constexpr double kAtEnd = 5 * kDegree, kOnTheWay = 20 * kDegree;

Result<Outcome> run(Context& context) {
  const std::string& text = context.options.choice("poses");
  if (text == kNone)
    return fail(Fault::usage,
                "play: no poses are given; give --poses FILE (`kaz run pose --view` writes "
                "such files, see docs/howto/watch.md)");
  const auto sequence = KAZ_TRY(motion::parse_poses(text, "poses"));
  const auto names = joint_names(context);
  const auto motion = KAZ_TRY(motion::PoseMotion::create(sequence, names));
  PosePlayer player(context);
  KAZ_TRY(player.check(motion));
  KAZ_TRY(hold_still(context.robot));

  PosePlayer::Followed worst;
  const int times = static_cast<int>(context.options.number("times"));
  for (int i = 0; i < times; ++i) {
    context.sink.phase(context.clock.now(), kPlay.name,
                       times > 1 ? "play " + std::to_string(i + 1) : "play");
    const auto followed = KAZ_TRY(player.play(motion));
    if (followed.farthest_rad >= worst.farthest_rad) {
      worst.farthest_rad = followed.farthest_rad;
      worst.farthest = followed.farthest;
      worst.farthest_s = followed.farthest_s;
    }
    worst.left_rad = followed.left_rad;
    worst.left = followed.left;
  }

  Outcome outcome;
  outcome.success = worst.left_rad <= kAtEnd && worst.farthest_rad <= kOnTheWay;
  const auto name = [&](int joint) { return names[static_cast<std::size_t>(joint)].c_str(); };
  char sentence[240];
  std::snprintf(
      sentence, sizeof sentence,
      "%zu poses in %.1f s%s; largest error during the motion: %.1f degrees (%s, after %.2f s); "
      "largest error at the end: %.1f degrees (%s)",
      sequence.poses.size(), motion.end_s(), outcome.success ? "" : " were not followed",
      worst.farthest_rad / kDegree, name(worst.farthest), worst.farthest_s,
      worst.left_rad / kDegree, name(worst.left));
  outcome.sentence = sentence;
  if (!outcome.success) outcome.cause = "not reached";
  outcome.measurements = {{"largest_error_on_the_way_deg", worst.farthest_rad / kDegree},
                          {"largest_error_at_the_end_deg", worst.left_rad / kDegree}};
  return outcome;
}

}  // namespace

constinit const Behavior kPlay{"play", "move through the poses of a file (--poses FILE)", false,
                               kOptions, run};

}  // namespace kaz::behavior

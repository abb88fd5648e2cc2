// Options of `kaz evaluate` that would draw nothing.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/given_options.h"

#include <algorithm>
#include <cmath>

namespace kaz::tools {

using behavior::Stage;

namespace {

using Kinds = std::vector<WorldKind>;

bool any(const Kinds& kinds, bool (*is)(WorldKind)) {
  return std::ranges::any_of(kinds, is);
}

std::string names(bool (*is)(WorldKind)) {
  std::string text;
  for (const WorldKindInfo& info : world_kinds())
    if (is(info.kind)) text += (text.empty() ? "" : ", ") + std::string(info.name);
  return text;
}

bool is_lit(WorldKind kind) {
  return kind != WorldKind::dark;
}

// Where a ball that is the goal lies as far away as --ball-distance has it.
bool has_ball_at_distance(WorldKind kind) {
  return kind == WorldKind::clutter || kind == WorldKind::two_balls;
}

// Why an option of an evaluation on a course has no effect; empty if it has.
std::string why_unused(const std::string& option, const CampaignOptions& options) {
  const Kinds& kinds = options.variation.worlds;
  const auto goal = options.settings.find("goal");
  const bool drawn = goal == options.settings.end();
  const bool two_balls = std::ranges::count(kinds, WorldKind::two_balls) > 0;
  const bool ball = drawn ? two_balls : goal->second == "ball";
  // In these the goal is the ball, or a place at its own distance.
  const bool all_at_ball = std::ranges::all_of(kinds, has_ball_at_distance) &&
                           (!drawn || std::ranges::count(kinds, WorldKind::clutter) == 0);
  if (option == "--obstacles" && !any(kinds, has_clutter))
    return "is only valid in worlds with clutter: add one of " + names(has_clutter) +
           " to --worlds, or leave the option out";
  if (option == "--goal-distance" && !drawn && !ball)
    return "chooses a random goal, but --set goal=" + goal->second +
           " fixes the goal: leave out one of the two options";
  if (option == "--goal-distance" && ball && all_at_ball)
    return "has no effect, because the goal is the ball: use --ball-distance";
  if (option == "--ball-distance" && !(ball && any(kinds, has_ball_at_distance)))
    return "is only valid if the ball is the goal: give --set goal=ball with worlds " +
           names(has_ball_at_distance) + ", or leave the option out";
  if ((option == "--radii" || option == "--colors") && !ball)
    return "is only valid in worlds with a ball: give --set goal=ball or --worlds two-balls, or "
           "leave the option out";
  if ((option == "--lamp" || option == "--shade") && !any(kinds, is_lit))
    return "has no effect in world dark, which has its own light: leave the option out";
  return "";
}

}  // namespace

std::string course_behaviors() {
  std::string text;
  for (const behavior::Behavior& one : behavior::behaviors())
    if (one.evaluation.stage == Stage::course)
      text += (text.empty() ? "" : ", ") + std::string(one.name);
  return text;
}

Result<void> check_given(const CampaignOptions& options, const std::vector<std::string>& given) {
  const Interval& props = options.variation.props;
  if (props.min != std::floor(props.min) || props.max != std::floor(props.max))
    return fail(
        Fault::usage,
        "the minimum and the maximum of --props must be whole numbers, for example --props 3 10");
  // The run reports an unknown behavior.
  const auto judged = options.judged_behavior();
  const Stage stage = judged ? judged->evaluation.stage : Stage::ball;
  for (const std::string& option : given) {
    if (option == "--props" && stage != Stage::ball)
      return fail(Fault::usage,
                  "--props is not valid with " + std::string(judged->name) + ": leave out --props" +
                      std::string(stage == Stage::course ? ", or use --obstacles" : ""));
    if (option == "--calibrated" && options.backend.sensors != sim::SensorSet::as_built)
      return fail(Fault::usage,
                  "--calibrated is only valid with --sensors as-built: give both, or leave out "
                  "--calibrated");
    if (stage == Stage::course) {
      if (const std::string why = why_unused(option, options); !why.empty())
        return fail(Fault::usage, option + " " + why);
    } else if (std::ranges::count(kCourseOptions, option) > 0) {
      return fail(Fault::usage, option + " is only valid with " + course_behaviors() +
                                    ": leave the option out, or evaluate " + course_behaviors());
    }
  }
  return {};
}

}  // namespace kaz::tools

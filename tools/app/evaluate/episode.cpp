// One episode of a campaign: a scenario's files, a session, the judge.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/evaluate/episode.h"

#include <cmath>
#include <filesystem>
#include <optional>

#include "host/behavior/plugin.h"
#include "tools/app/base/paths.h"
#include "tools/app/evaluate/judge.h"
#include "tools/app/session/run_report.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

double rounded(double value) {
  return std::round(value * 1e6) / 1e6;
}

// Removes a run's results, and their folder where nothing else is in it.
Result<void> remove_run(const std::string& folder) {
  KAZ_TRY(OutputFolder::begin(folder, run_output()));  // its list goes with the object
  std::error_code ignored;
  fs::remove(folder, ignored);
  return {};
}

}  // namespace

Result<Json> run_episode(const CampaignOptions& options, std::uint64_t number,
                         const std::string& failures) {
  const auto known = KAZ_TRY(behavior::named_behavior(options.behavior));
  const auto values = KAZ_TRY(behavior::OptionValues::parse(known.options, options.settings));
  const Scenario scenario = Scenario::draw(options.variation, options.seed, number);
  const auto robot = KAZ_TRY(data_file("robot/kaz/kaz.urdf"));
  const auto files = KAZ_TRY(scenario_files(scenario, fs::path(robot).parent_path().string()));
  const auto color = KAZ_TRY(ball_color(scenario.ball_color));

  Judge judge(scenario.ball_radius_m);
  Result<behavior::Outcome> ended = fail(Fault::environment, "the episode did not begin");
  double run_s = 0, rtf = 0;
  SessionOptions session;
  session.backend = options.backend;
  session.backend.world = files.world();
  session.backend.robot_file = files.robot();
  session.backend.seed = scenario.seed;
  session.backend.supply_volts = scenario.supply_volts;
  session.behavior = options.behavior;
  session.settings = options.settings;
  session.vision.ball.radius_m = scenario.ball_radius_m;
  session.vision.ball.color = color.range;
  session.quiet = true;
  session.json = true;  // no progress
  session.keep_interrupted = false;
  session.onlooker = &judge;
  std::optional<Error> lost;
  session.on_loss = [&](const Error& error) { lost = error; };
  session.on_end = [&](const Result<behavior::Outcome>& outcome, double seconds, double speed) {
    ended = outcome;
    run_s = seconds;
    rtf = speed;
  };
  char name[32];
  std::snprintf(name, sizeof name, "%06llu", static_cast<unsigned long long>(number));
  const std::string kept = (fs::path(failures) / name).string();
  session.out = kept;
  const auto ran = run_session(session);
  if (!ran && ran.error().fault == Fault::interrupted) {
    (void)remove_run(kept);
    return tl::unexpected(ran.error());
  }
  if (lost) return tl::unexpected(*lost);
  if (!ran && ended.has_value()) ended = tl::unexpected(ran.error());
  if (!ran && !ended) ended = tl::unexpected(ran.error());

  const std::string cause = cause_of_failure(options.behavior, values, ended, judge);
  if (cause.empty()) KAZ_TRY(remove_run(kept));
  Json results = Json::object();
  if (ended) {
    for (const auto& [key, value] : ended->measurements) results[key] = value;
  }
  const std::string end = ended ? ended->sentence : ended.error().message;
  Json episode{{"episode", number},        {"scenario", scenario_json(scenario)},
               {"success", cause.empty()}, {"cause", cause},
               {"sentence", end},          {"measurements", results},
               {"truth", judge.json()}};
  if (run_s > 0) {  // else it did not begin
    episode["seconds"] = rounded(run_s);
    episode["rtf"] = rounded(rtf);
  }
  return episode;
}

}  // namespace kaz::tools

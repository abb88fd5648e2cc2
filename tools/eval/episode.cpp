// One episode of a campaign: a scenario's files, a run, the judge.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/episode.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>

#include "host/behavior/plugin.h"
#include "tools/base/paths.h"
#include "tools/eval/learned_color.h"
#include "tools/lockstep/calibrated_joints.h"
#include "tools/run/run_report.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

double rounded(double value) {
  return std::round(value * 1e6) / 1e6;
}

// Removes a run's results, and their folder where nothing else is in it.
Result<void> remove_run(const std::string& folder) {
  KAZ_TRY(OutputFolder::begin(folder, run_output()));  // its mark goes with the object
  std::error_code ignored;
  fs::remove(folder, ignored);
  return {};
}

// World and robot beside the recording, where kaz replay finds them.
Result<void> keep_files(const trials::RobotFolder& files, const std::string& failure) {
  const auto folder = KAZ_TRY(OutputFolder::open(failure, run_output()));
  return files.each([&folder](const std::string& name, const std::string& contents) {
    return folder.write(name, contents);
  });
}

// How an episode went.
struct Ended {
  Result<behavior::Outcome> outcome = fail(Fault::environment, "the episode did not begin");
  double run_s = 0, rtf = 0;
  bool crashed = false;  // the behavior's program
};

// Judges an episode while it runs.
class EpisodeObserver final : public RunObserver {
 public:
  // `viewer` may be null. All arguments must outlive this object.
  EpisodeObserver(const Task& task, Judge& judge, RunObserver* viewer)
      : task_(task), judge_(judge), viewer_(viewer) {}
  void map(const behavior::MapReport& report) override { judge_.map(report); }
  void look(sim::Simulation& simulation) override { judge_.look(simulation); }
  void pair(const vision::StereoPair& pair) override {
    if (viewer_ != nullptr) viewer_->pair(pair);
  }
  void threw() override { end_.crashed = true; }
  void lost(const Error& error) override { loss_ = error; }
  void ended(const Result<behavior::Outcome>& outcome, double run_s, double rtf) override {
    judge_.end();
    end_ = {outcome, run_s, rtf, end_.crashed};
  }
  bool is_worth_keeping() override { return !verdict_of(task_, end_.outcome, judge_).success; }

  const Ended& end() const { return end_; }
  const std::optional<Error>& loss() const { return loss_; }

 private:
  const Task& task_;
  Judge& judge_;
  RunObserver* viewer_;
  Ended end_;
  std::optional<Error> loss_;
};

Json episode_json(std::uint64_t number, const Scenario& scenario, const Ended& ended,
                  const EpisodeVerdict& verdict, const Judge& judge) {
  const auto& outcome = ended.outcome;
  Json results = Json::object();
  if (outcome) {
    for (const auto& [key, value] : outcome->measurements) results[key] = value;
  }
  Json episode{{"episode", number},
               {"scenario", scenario_json(scenario)},
               {"success", verdict.success},
               {"claim", verdict.claim},
               {"cause", verdict.cause},
               {"sentence", outcome ? outcome->sentence : outcome.error().message},
               {"measurements", results},
               {"truth", judge.json()}};
  if (!verdict.judged) episode["judged"] = false;
  if (ended.run_s > 0) {  // else it did not begin
    episode["seconds"] = rounded(ended.run_s);
    episode["rtf"] = rounded(ended.rtf);
    add_pushes(episode, scenario, judge);
  }
  return episode;
}

// A world to walk in and, unless one is set, its goal.
Result<void> add_goal(const Variation& variation, Scenario& scenario,
                      std::map<std::string, std::string>& settings) {
  const auto set = settings.find("goal");
  const bool none_set = set == settings.end();
  const bool ball = none_set ? scenario.kind == WorldKind::two_balls : set->second == "ball";
  KAZ_TRY(scenario.add_layout(variation, ball));
  if (!none_set) return {};
  if (ball) {
    settings["goal"] = "ball";
    return {};
  }
  const Layout& layout = scenario.layout;
  char goal[80];
  const int length =
      std::snprintf(goal, sizeof goal, "%.3f,%.3f", layout.goal.x(), layout.goal.y());
  if (layout.goal_heading_rad)
    std::snprintf(goal + length, sizeof goal - static_cast<std::size_t>(length), ",%.1f",
                  *layout.goal_heading_rad * 180 / std::numbers::pi);
  settings["goal"] = goal;
  return {};
}

}  // namespace

void add_pushes(Json& episode, const Scenario& scenario, const Judge& judge) {
  if (scenario.pushes.empty()) return;
  const auto walked = judge.walked_s();
  const double seconds = scenario.pushes_from_first_step ? walked.value_or(0) : judge.watched_s();
  episode["pushes"] = scenario.pushes_within(seconds);
  if (walked) episode["walked_s"] = rounded(*walked);
}

Result<DrawnEpisode> draw_episode(const CampaignOptions& options, std::uint64_t number) {
  DrawnEpisode drawn{Scenario::draw(options.variation, options.seed, number), options.settings};
  const auto judged = KAZ_TRY(options.judged_behavior());
  switch (judged.evaluation.stage) {
    case behavior::Stage::ball:
      KAZ_TRY(drawn.scenario.add_props(options.variation));
      break;
    case behavior::Stage::lying:
      drawn.scenario.has_ball = false;
      drawn.scenario.lay_down();
      break;
    case behavior::Stage::course:
      KAZ_TRY(add_goal(options.variation, drawn.scenario, drawn.settings));
      break;
  }
  return drawn;
}

Result<std::string> episode_memory(const CampaignOptions& options, const Scenario& scenario,
                                   const std::string& robot_file) {
  if (!options.calibrated) return std::string();
  sim::SimulationOptions robot;
  robot.seed = scenario.seed;
  robot.imu = true;
  robot.sensors = options.backend.sensors;
  robot.world_path = KAZ_TRY(world_file("empty"));
  robot.robot_path = robot_file;
  robot.camera_path = fs::path(robot_file).replace_filename("camera.json").string();
  return lockstep::calibrated_memory(robot);
}

Result<Json> run_episode(const CampaignOptions& options, std::uint64_t number,
                         const std::string& failures) {
  const auto known = KAZ_TRY(behavior::named_behavior(options.behavior));
  const auto drawn = KAZ_TRY(draw_episode(options, number));
  const Scenario& scenario = drawn.scenario;
  const std::map<std::string, std::string>& settings = drawn.settings;
  const auto values = KAZ_TRY(behavior::OptionValues::parse(known.options, settings));
  const auto judged = KAZ_TRY(options.judged_behavior());
  const Task task = KAZ_TRY(task_of(judged, values));
  const auto robot = KAZ_TRY(data_file("robot/kaz/kaz.urdf"));
  const auto files = KAZ_TRY(scenario_files(scenario, fs::path(robot).parent_path().string()));
  vision::ColorRange color;
  if (options.backend.eyes != sim::EyeKind::none)
    color = KAZ_TRY(learned_ball_color(scenario, options.backend));

  Judge judge({.ball_radius_m = scenario.ball_radius_m,
               .watches_touch = task.criterion == behavior::Criterion::at_goal,
               .lies = scenario.lies.has_value()});
  if (const Obstacle* moving = scenario.moving())
    judge.watch_way(*moving, scenario.name_of(*moving), scenario.world_from_start());
  // Beyond the edge of a table there is no floor: what the map has there is not compared.
  if (judged.evaluation.stage == behavior::Stage::course && scenario.layout.table.empty())
    judge.watch_map(scenario.layout.obstacles, scenario.world_from_start());
  RunOptions run_options;
  run_options.backend = options.backend;
  run_options.backend.world = files.world();
  run_options.backend.robot_file = files.robot();
  run_options.backend.seed = scenario.seed;
  run_options.backend.supply_volts = scenario.supply_volts;
  run_options.backend.memory = KAZ_TRY(episode_memory(options, scenario, files.robot()));
  run_options.behavior = options.behavior;
  run_options.settings = settings;
  run_options.vision.ball.radius_m = scenario.ball_radius_m;
  run_options.vision.ball.color = color;
  run_options.quiet = true;
  run_options.json = true;  // no progress
  run_options.keep_interrupted = false;
  char name[32];
  std::snprintf(name, sizeof name, "%06llu", static_cast<unsigned long long>(number));
  const std::string kept = (fs::path(failures) / name).string();
  run_options.out = kept;
  const auto viewer = options.watch ? options.watch(run_options.backend) : nullptr;
  EpisodeObserver observer(task, judge, viewer.get());
  const auto ran = run(std::move(run_options), observer);
  if (!ran && ran.error().fault == Fault::interrupted) {
    (void)remove_run(kept);
    return tl::unexpected(ran.error());
  }
  if (observer.loss()) return tl::unexpected(*observer.loss());
  Ended ended = observer.end();
  if (!ran) ended.outcome = tl::unexpected(ended.outcome ? ran.error() : ended.outcome.error());

  const EpisodeVerdict verdict = ended.crashed
                                     ? EpisodeVerdict{.cause = "crashed", .judged = task.judged()}
                                     : verdict_of(task, ended.outcome, judge);
  if (verdict.success) {
    KAZ_TRY(remove_run(kept));
  } else if (!ended.crashed) {
    KAZ_TRY(keep_files(files, kept));
  }
  return episode_json(number, scenario, ended, verdict, judge);
}

}  // namespace kaz::tools

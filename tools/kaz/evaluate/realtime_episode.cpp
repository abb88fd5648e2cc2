// One episode in real time: the robot in one process, the behaviour in another, a pty between them.
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <bit>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <unistd.h>

#include "sim/runtime/mcap_reader.h"
#include "tools/kaz/color_file.h"
#include "tools/kaz/evaluate/child.h"
#include "tools/kaz/evaluate/episode.h"
#include "tools/kaz/evaluate/judge.h"
#include "tools/kaz/paths.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using std::chrono::seconds;

constexpr seconds kReady{60}, kMost{400}, kEnd{30};

std::string text_of(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string last_line(const std::string& text) {
  const auto end = text.find_last_not_of("\n");
  if (end == std::string::npos) return "it said nothing";
  const auto begin = text.find_last_of('\n', end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1, end - begin);
}

// For how long at most the ball was clear of the floor without a break, s, by what the simulator
// recorded. It has gone on after the behaviour ended and switched the motors off.
Result<double> longest_held(const std::string& recording, double radius_m) {
  const auto file = sim::McapRecording::load(recording);
  if (!file) return tl::unexpected(file.error());
  std::uint64_t on_floor = 0;  // when it last was; it starts there
  double longest = 0;
  for (const auto& message : file->messages) {
    const auto topic = file->topics.find(message.channel);
    if (topic == file->topics.end() || topic->second != "/truth/ball" || message.data.size() < 24)
      continue;
    std::uint64_t bits = 0;
    for (std::size_t i = 24; i-- > 16;) bits = bits << 8 | message.data[i];
    if (std::bit_cast<double>(bits) < radius_m + kClearOfFloor_m) on_floor = message.time_ns;
    longest = std::max(longest, 1e-9 * static_cast<double>(message.time_ns - on_floor));
  }
  return longest;
}

// Both programs' arguments.
struct Commands {
  std::vector<std::string> simulator, behaviour;
};
Result<Commands> commands(const CampaignOptions& options, const Scenario& scenario,
                          const trials::RobotFolder& files, const std::string& folder) {
  const auto color = ball_color(scenario.ball_color);
  if (!color) return tl::unexpected(color.error());
  const std::string color_file = folder + "/color.json";
  std::ofstream(color_file) << color_json(color->range).dump(1) << "\n";
  const RigOptions& rig = options.rig;
  const std::string board = folder + "/board", eyes = folder + "/eyes";
  Commands both{{"sim",
                 "--serial",
                 board,
                 "--cameras",
                 eyes,
                 "--world",
                 files.world(),
                 "--robot-file",
                 files.robot(),
                 "--mcu",
                 rig.engine,
                 "--eyes",
                 rig.eyes,
                 "--sensors",
                 rig.sensors,
                 "--seed",
                 std::to_string(scenario.seed),
                 "--supply",
                 std::to_string(scenario.supply_volts),
                 "--record",
                 folder + "/recording.mcap"},
                {"run", options.behavior, "--robot", "serial:" + board, "--camera", eyes, "--color",
                 color_file, "--radius", std::to_string(scenario.ball_radius_m), "--json"}};
  if (rig.imu) both.simulator.push_back("--imu");
  for (const auto& [name, value] : options.settings) {
    both.behaviour.push_back("--set");
    both.behaviour.push_back(name + "=" + value);
  }
  return both;
}

// The result that a `kaz run --json` left in its log, after what else it said.
Json result_of(const std::string& log) {
  const auto begin = log.rfind("\n{\n");
  const auto at = begin != std::string::npos ? begin + 1 : log.starts_with("{\n") ? 0 : log.size();
  Json result = Json::parse(log.substr(at), nullptr, false);
  return result.is_object() ? result : Json::object();
}

}  // namespace

Result<Json> run_realtime_episode(const CampaignOptions& options, std::uint64_t number,
                                  const std::string& failures) {
  const Scenario scenario = Scenario::draw(options.variation, options.seed, number);
  const auto robot = data_file("robot/kaz/kaz.urdf");
  if (!robot) return tl::unexpected(robot.error());
  const auto files = scenario_files(scenario, fs::path(*robot).parent_path().string());
  if (!files) return tl::unexpected(files.error());
  char name[32];
  std::snprintf(name, sizeof name, "%06llu", static_cast<unsigned long long>(number));
  const std::string kept = (fs::path(failures) / name).string();
  std::error_code wrong;
  fs::remove_all(kept, wrong);
  if (!fs::create_directories(kept, wrong))
    return fail(Fault::environment, kept + ": cannot be made: " + wrong.message());
  const auto both = commands(options, scenario, *files, kept);
  if (!both) return tl::unexpected(both.error());

  const std::string sim_log = kept + "/sim.txt", run_log = kept + "/run.txt";
  auto simulator = Child::begin(both->simulator, sim_log);
  if (!simulator) return tl::unexpected(simulator.error());
  const auto begun = std::chrono::steady_clock::now();
  while (!simulator->ended() && text_of(sim_log).find("ready") == std::string::npos) {
    if (std::chrono::steady_clock::now() - begun > kReady) break;
    ::usleep(50'000);
  }
  if (text_of(sim_log).find("ready") == std::string::npos)
    return fail(Fault::environment, "kaz sim did not begin: " + last_line(text_of(sim_log)));
  auto behaviour = Child::begin(both->behaviour, run_log);
  if (!behaviour) return tl::unexpected(behaviour.error());
  const auto status = behaviour->wait(kMost);
  if (!status) {
    behaviour->signal(SIGINT);
    behaviour->wait(kEnd);
  }
  simulator->signal(SIGINT);
  if (!simulator->wait(kEnd))
    return fail(Fault::environment, "kaz sim did not end; its log is " + sim_log);

  const Json result = result_of(text_of(run_log));
  const auto held = longest_held(kept + "/recording.mcap", scenario.ball_radius_m);
  if (!held) return tl::unexpected(held.error());
  std::string cause = result.value("cause", std::string());
  if (cause.empty()) cause = status ? "error" : "time";
  if (result.value("outcome", "") == "done")
    cause = options.behavior == "catch-ball" && *held < 3 ? "not held" : "";
  Json figures = Json::object();
  for (const char* figure : {"found_s", "catch_s", "held_s", "hand_load", "hand_gap_deg"})
    if (result.contains(figure) && result[figure].is_number()) figures[figure] = result[figure];
  const std::string told = last_line(text_of(run_log));
  const std::string simulated =
      last_line(text_of(sim_log).substr(0, text_of(sim_log).rfind("recording ")));
  if (cause.empty()) fs::remove_all(kept, wrong);
  return Json{{"episode", number},
              {"scenario", scenario_json(scenario)},
              {"success", cause.empty()},
              {"cause", cause},
              {"sentence", result.value("sentence", told)},
              {"seconds", result.value("duration_s", 0.0)},
              {"rtf", result.value("rtf", 0.0)},
              {"figures", figures},
              {"truth", {{"fell", cause == "fell"}, {"longest_held_s", *held}}},
              {"simulator", simulated}};
}

}  // namespace kaz::tools

// One episode in real time: the robot in one process, the behavior in another, a pty between them.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <type_traits>

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include "host/behavior/plugin.h"
#include "shared/base/bounded_json.hpp"
#include "shared/base/files.hpp"
#include "tools/base/child.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/paths.h"
#include "tools/eval/episode.h"
#include "tools/eval/learned_color.h"
#include "tools/vision/color_file.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using std::chrono::seconds;

constexpr seconds kReady{60}, kEnd{30};
// More than the longest behavior gives itself by default.
constexpr seconds kMost{700};

std::string text_of(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string last_line(const std::string& text) {
  const auto end = text.find_last_not_of("\n");
  if (end == std::string::npos) return "the program printed nothing";
  const auto begin = text.find_last_of('\n', end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1, end - begin);
}

// Asks `kaz sim` how it goes.
class Control {
 public:
  static Result<Control> open(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    Control control(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    if (path.size() >= sizeof address.sun_path)
      return fail(Fault::usage,
                  path + ": the path is too long for a socket; set TMPDIR to a shorter path");
    std::strcpy(address.sun_path, path.c_str());
    const timeval limit{5, 0};
    ::setsockopt(control.socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    if (::connect(control.socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) !=
        0)
      return fail(Fault::environment, path + ": " + std::strerror(errno));
    return control;
  }
  Control(Control&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
  Control& operator=(Control&&) = delete;
  ~Control() {
    if (socket_ >= 0) ::close(socket_);
  }

  // Nothing where it has ended.
  std::optional<Json> status() {
    auto status = answer("status\n");
    if (!status || !status->contains("time_s")) return std::nullopt;
    return status;
  }
  void watch_touches() { answer("touches\n"); }

 private:
  explicit Control(int socket) : socket_(socket) {}
  std::optional<Json> answer(std::string_view request) {
    const auto size = static_cast<ssize_t>(request.size());
    if (::send(socket_, request.data(), request.size(), MSG_NOSIGNAL) != size) return std::nullopt;
    std::string line;
    for (char c = 0; c != '\n'; line += c)
      if (::recv(socket_, &c, 1, 0) != 1) return std::nullopt;
    Json reply = parse_bounded_json<Json>(line).value_or(nullptr);
    if (!reply.is_object()) return std::nullopt;
    return reply;
  }
  int socket_;
};

// Of a `status` after `touches`.
Truth truth_of(const Json& status) {
  Truth truth{.time = from_seconds(status["time_s"].get<double>())};
  const auto three = [](const Json& list) {
    return Eigen::Vector3d(list[0].get<double>(), list[1].get<double>(), list[2].get<double>());
  };
  const auto pose = [&](const Json& json) -> Eigen::Isometry3d {
    const Eigen::Vector3d angles = three(json["roll_pitch_yaw_rad"]);
    return Eigen::Translation3d(three(json["position_m"])) *
           Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX());
  };
  truth.trunk = pose(status["trunk"]);
  if (!status["left_eye"].is_null()) truth.left_eye = pose(status["left_eye"]);
  if (!status["l_ankle_pitch"].is_null()) truth.left_foot = pose(status["l_ankle_pitch"]);
  if (!status["r_ankle_pitch"].is_null()) truth.right_foot = pose(status["r_ankle_pitch"]);
  if (!status["ball_m"].is_null()) truth.ball = three(status["ball_m"]);
  for (const Json& one : status.value("touched", Json::array())) {
    const auto thing = one["thing"].get<std::string>();
    if (!thing.starts_with(kObstacleName)) continue;
    truth.touch = {thing, one["by"].get<std::string>(), one["at_s"].get<double>()};
    break;
  }
  if (status.contains("unconverged_steps"))
    truth.unconverged_steps = status["unconverged_steps"].get<std::int64_t>();
  return truth;
}

// Passes the states that `kaz sim` reports during the run to the judge. States with motors off count only if
// the motors come on again later, because a behavior switches the motors off at its end.
class RealTimeLooks {
 public:
  explicit RealTimeLooks(Judge& judge) : judge_(judge) {}

  void add(const Json& status) {
    const Truth truth = truth_of(status);
    worst_gap_s_ = had_motors_ ? std::max(worst_gap_s_, kaz::seconds(truth.time - latest_)) : 0;
    latest_ = truth.time;
    if (!status["motors"].get<bool>()) {
      without_motors_.push_back(truth);
      return;
    }
    had_motors_ = true;
    for (const Truth& earlier : without_motors_) judge_.look(earlier);
    without_motors_.clear();
    judge_.look(truth);
  }
  void end() {
    if (!had_motors_)
      for (const Truth& truth : without_motors_) judge_.look(truth);
    judge_.end();
  }
  // Longest time of the robot without a look, s.
  double worst_gap_s() const { return worst_gap_s_; }

 private:
  Judge& judge_;
  std::vector<Truth> without_motors_;
  bool had_motors_ = false;
  Time latest_{};
  double worst_gap_s_ = 0;
};

std::string board_of(const trials::RobotFolder& files) {
  return fs::path(files.robot()).replace_filename("board").string();
}

std::string bytes_of(const std::string& hex) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  return bytes;
}

// Returns an archive (robot_options.h) that appends options to the command line `to`, which must outlive the
// archive.
auto command_line_writer(std::vector<std::string>& to) {
  return [&to]<class T>(const sim::OptionText& text, const T& value, const auto&...) {
    if (text.option == nullptr) return;
    if constexpr (std::is_enum_v<T>) {
      to.insert(to.end(), {text.option, to_string(value)});
    } else if constexpr (std::is_same_v<T, bool>) {
      if (value) to.emplace_back(text.option);
    } else if constexpr (std::is_same_v<T, std::string>) {
      if (!value.empty()) to.insert(to.end(), {text.option, value});
    } else if constexpr (std::is_arithmetic_v<T>) {
      const bool given = !std::is_same_v<T, int> || value != 0;
      if (given) to.insert(to.end(), {text.option, std::to_string(value)});
    }
  };
}

// Both programs' arguments.
struct Commands {
  std::vector<std::string> simulator, behavior;
};
Result<Commands> commands(const CampaignOptions& options, const DrawnEpisode& drawn,
                          const trials::RobotFolder& files, const std::string& folder) {
  const Scenario& scenario = drawn.scenario;
  const bool sees = options.backend.eyes != sim::EyeKind::none;
  const std::string color_file = folder + "/color.json";
  if (sees) {
    const auto color = KAZ_TRY(learned_ball_color(scenario, options.backend));
    KAZ_TRY(write_whole_file(color_file, color_json(color).dump(1) + "\n"));
  }
  BackendOptions robot = options.backend;
  robot.world = files.world();
  robot.robot_file = files.robot();
  robot.seed = scenario.seed;
  robot.supply_volts = scenario.supply_volts;
  // Short paths: a socket's has at most 107 characters.
  const std::string board = board_of(files), eyes = board + ".eyes";
  Commands both{{"sim", "--serial", board, "--record", folder + "/recording.mcap"},
                {"run", options.behavior, "--robot", "serial:" + board, "--json"}};
  robot.visit(command_line_writer(both.simulator));
  if (sees) {
    both.simulator.insert(both.simulator.end(), {"--cameras", eyes});
    both.behavior.insert(both.behavior.end(), {"--camera", eyes, "--color", color_file, "--radius",
                                               std::to_string(scenario.ball_radius_m)});
  }
  if (const auto memory = KAZ_TRY(episode_memory(options, scenario, files.robot()));
      !memory.empty()) {
    const std::string file = board + ".memory";
    KAZ_TRY(write_whole_file(file, bytes_of(memory)));
    both.simulator.insert(both.simulator.end(), {"--memory", file});
  }
  for (const auto& [name, value] : drawn.settings) {
    both.behavior.push_back("--set");
    both.behavior.push_back(name + "=" + value);
  }
  return both;
}

// What both programs leave in the episode's folder, and the folder where nothing else is in it.
void remove_files(const std::string& folder) {
  std::error_code ignored;
  for (const char* name :
       {"color.json", "recording.mcap", "recording.mcap.part", "run.txt", "sim.txt"})
    fs::remove(fs::path(folder) / name, ignored);
  fs::remove(folder, ignored);
}

// The result that a `kaz run --json` left in its log, after what else it said.
Json result_of(const std::string& log) {
  const auto begin = log.rfind("\n{\n");
  const auto at = begin != std::string::npos ? begin + 1 : log.starts_with("{\n") ? 0 : log.size();
  Json result = parse_bounded_json<Json>(log.substr(at)).value_or(nullptr);
  return result.is_object() ? result : Json::object();
}

// Numbers of a result are the behavior's measurements, but for those of the run.
std::vector<std::pair<std::string, double>> measurements_of(const Json& result) {
  std::vector<std::pair<std::string, double>> all;
  for (const auto& [name, value] : result.items())
    if (value.is_number() && name != "duration_s" && name != "rtf")
      all.emplace_back(name, value.get<double>());
  return all;
}

double number_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? found->get<double>() : 0;
}

// How both programs ended.
struct Ends {
  std::optional<int> behavior;  // exit status of `kaz run`, none if time ran out
  bool ended_early;             // `kaz sim`, during the run
  int simulator;                // its exit status
  double worst_gap_s;           // RealTimeLooks
};

// The machine was late by a second, as a run at a port counts it (run_lateness.h): then neither a failure
// nor a success is the robot's.
std::string lateness(const Json& last, const Json& result, double worst_gap_s) {
  constexpr double kMax_s = 1, kMaxShare = 0.02;
  const Json late = result.value("lateness", Json::object());
  const double host_s = number_of(late, "host_late_s");
  const double worst_s = number_of(late, "host_worst_late_s");
  const double lag_s = std::max(number_of(last, "lost_s"), number_of(last, "worst_late_s"));
  if (lag_s > kMax_s)
    return "the machine was too slow: kaz sim lagged " + std::to_string(lag_s) + " s behind";
  if (worst_s > kMax_s || (host_s > kMax_s && host_s > kMaxShare * number_of(result, "duration_s")))
    return "the machine was too slow: kaz run waited " + std::to_string(std::max(worst_s, host_s)) +
           " s";
  if (worst_gap_s > kMax_s)
    return "the machine was too slow: no state of the robot arrived for " +
           std::to_string(worst_gap_s) + " s";
  return {};
}

// Why an episode does not count for or against the robot; empty where it does. `last`: last reply of
// `kaz sim`; `result`: of `kaz run`.
std::string machine_trouble(const Ends& ends, const Json& last, const Json& result) {
  constexpr int kLost = static_cast<int>(Fault::environment);
  if (ends.ended_early)
    return "kaz sim ended with " + std::to_string(ends.simulator) + " during the run";
  if (ends.simulator == kLost) return "kaz sim could not write its recording";
  if (ends.behavior == static_cast<int>(Fault::usage)) return "kaz run could not start";
  if (ends.behavior == kLost && result.value("outcome", "") == "environment")
    return result.value("sentence", std::string());
  if (ends.behavior == kLost) return "kaz run lost its port, its camera or its files";
  for (const int number : {SIGHUP, SIGINT, SIGKILL, SIGTERM, SIGBUS, SIGXCPU, SIGXFSZ})
    if (ends.behavior == 128 + number)
      return "kaz run was ended by signal " + std::to_string(number);
  if (ends.behavior && *ends.behavior > 128) return {};  // it crashed, on any machine
  return lateness(last, result, ends.worst_gap_s);
}

}  // namespace

Result<Json> run_realtime_episode(const CampaignOptions& options, std::uint64_t number,
                                  const std::string& failures) {
  const auto known = KAZ_TRY(behavior::named_behavior(options.behavior));
  const auto drawn = KAZ_TRY(draw_episode(options, number));
  const Scenario& scenario = drawn.scenario;
  const auto values = KAZ_TRY(behavior::OptionValues::parse(known.options, drawn.settings));
  const auto judged = KAZ_TRY(options.judged_behavior());
  const Task task = KAZ_TRY(task_of(judged, values));
  const auto robot = KAZ_TRY(data_file("robot/kaz/kaz.urdf"));
  const auto files = KAZ_TRY(scenario_files(scenario, fs::path(robot).parent_path().string()));
  char name[32];
  std::snprintf(name, sizeof name, "%06llu", static_cast<unsigned long long>(number));
  const std::string kept = (fs::path(failures) / name).string();
  std::error_code wrong;
  remove_files(kept);
  fs::create_directories(kept, wrong);
  if (wrong) return fail(Fault::environment, "cannot create '" + kept + "': " + wrong.message());
  const auto both = KAZ_TRY(commands(options, drawn, files, kept));
  // Both programs end with this process's objects.
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  const auto interrupted = [&] {
    remove_files(kept);
    return tl::unexpected(host::Interrupt::error());
  };

  const std::string sim_log = kept + "/sim.txt", run_log = kept + "/run.txt";
  auto simulator = KAZ_TRY(Child::begin(both.simulator, sim_log));
  const auto begun = std::chrono::steady_clock::now();
  while (!simulator.ended() && text_of(sim_log).find("ready") == std::string::npos) {
    if (std::chrono::steady_clock::now() - begun > kReady) break;
    if (interrupt.requested()) return interrupted();
    ::usleep(50'000);
  }
  if (text_of(sim_log).find("ready") == std::string::npos)
    return fail(Fault::environment, "kaz sim did not start: " + last_line(text_of(sim_log)));
  auto control = KAZ_TRY(Control::open(board_of(files) + ".ctl"));
  control.watch_touches();
  Judge judge({.ball_radius_m = scenario.ball_radius_m, .lies = scenario.lies.has_value()});
  RealTimeLooks looks(judge);
  Json last = Json::object();
  const auto look = [&] {
    if (const auto status = control.status()) looks.add(last = *status);
  };
  look();  // where it starts
  auto behavior = KAZ_TRY(Child::begin(both.behavior, run_log));
  const auto run_begun = std::chrono::steady_clock::now();
  while (!behavior.ended() && std::chrono::steady_clock::now() - run_begun < kMost) {
    if (interrupt.requested()) return interrupted();
    look();
    ::usleep(100'000);
  }
  const auto status = behavior.ended();
  if (!status) {
    behavior.signal(SIGINT);
    behavior.wait(kEnd);
  }
  looks.end();
  const bool simulator_ended = simulator.ended().has_value();
  simulator.signal(SIGINT);
  if (!simulator.wait(kEnd))
    return fail(Fault::environment, "kaz sim did not end; its log is " + sim_log);
  const Json result = result_of(text_of(run_log));
  if (const std::string why = machine_trouble(
          {status, simulator_ended, *simulator.ended(), looks.worst_gap_s()}, last, result);
      !why.empty())
    return fail(Fault::environment, why + "; logs are in " + kept);

  // Above 128: a signal, none of the machine's.
  const std::string broken_off = !status ? "time" : *status > 128 ? "crashed" : "";
  const std::string log_line = last_line(text_of(run_log));
  const std::string sentence = result.value("sentence", log_line);
  Result<behavior::Outcome> outcome = fail(Fault::failed, sentence);
  if (result.contains("outcome"))
    outcome = behavior::Outcome{result["outcome"] == "done", sentence, measurements_of(result),
                                result.value("cause", std::string())};
  EpisodeVerdict verdict = verdict_of(task, outcome, judge);
  if (!broken_off.empty() && verdict.cause != "fell" && verdict.cause != "touched")
    verdict = {.cause = broken_off, .judged = verdict.judged};
  Json results = Json::object();
  for (const auto& [key, value] : measurements_of(result)) results[key] = value;
  Json simulator_json = Json::object();
  for (const char* key : {"overruns", "lost_s", "pairs_dropped", "unconverged_steps"})
    if (last.contains(key)) simulator_json[key] = last[key];
  if (verdict.success) remove_files(kept);
  Json episode{{"episode", number},          {"scenario", scenario_json(scenario)},
               {"success", verdict.success}, {"claim", verdict.claim},
               {"cause", verdict.cause},     {"sentence", sentence},
               {"measurements", results},    {"truth", judge.json()},
               {"simulator", simulator_json}};
  if (!verdict.judged) episode["judged"] = false;
  if (result.contains("duration_s")) {
    episode["seconds"] = result["duration_s"];
    add_pushes(episode, scenario, judge);
  }
  if (result.contains("rtf")) episode["rtf"] = result["rtf"];
  return episode;
}

}  // namespace kaz::tools

// One episode in real time: the robot in one process, the behaviour in another, a pty between them.
// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include "shared/base/files.hpp"
#include "tools/app/base/interrupt_signals.h"
#include "tools/app/base/paths.h"
#include "tools/app/evaluate/child.h"
#include "tools/app/evaluate/episode.h"
#include "tools/app/evaluate/judge.h"
#include "tools/app/vision/color_file.h"

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

// Asks `kaz sim` how it goes.
class Control {
 public:
  static Result<Control> open(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    Control control(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    if (path.size() >= sizeof address.sun_path)
      return fail(Fault::usage,
                  path + ": the path is too long for a socket; set TMPDIR to a shorter one");
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
    if (::send(socket_, "status\n", 7, MSG_NOSIGNAL) != 7) return std::nullopt;
    std::string line;
    for (char c = 0; c != '\n'; line += c)
      if (::recv(socket_, &c, 1, 0) != 1) return std::nullopt;
    Json status = Json::parse(line, nullptr, false);
    if (!status.is_object() || !status.contains("time_s")) return std::nullopt;
    return status;
  }

 private:
  explicit Control(int socket) : socket_(socket) {}
  int socket_;
};

// For how long at most the ball was clear of the floor without a break, in the simulator's time.
class Held {
 public:
  explicit Held(double radius_m) : clear_m_(radius_m + kClearOfFloor_m) {}
  void see(const Json& status) {
    const double now = status["time_s"].get<double>();
    const Json& ball = status["ball_m"];
    if (ball.is_null() || ball[2].get<double>() < clear_m_) {
      lifted_s_ = -1;
      return;
    }
    if (lifted_s_ < 0) lifted_s_ = now;
    longest_ = std::max(longest_, now - lifted_s_);
  }
  double longest() const { return longest_; }

 private:
  double clear_m_, longest_ = 0;
  double lifted_s_ = -1;  // since when; negative: it is not
};

std::string board_of(const trials::RobotFolder& files) {
  return fs::path(files.robot()).replace_filename("board").string();
}

// Both programs' arguments.
struct Commands {
  std::vector<std::string> simulator, behaviour;
};
Result<Commands> commands(const CampaignOptions& options, const Scenario& scenario,
                          const trials::RobotFolder& files, const std::string& folder) {
  const auto color = KAZ_TRY(ball_color(scenario.ball_color));
  const std::string color_file = folder + "/color.json";
  KAZ_TRY(write_whole_file(color_file, color_json(color.range).dump(1) + "\n"));
  const BackendOptions& backend = options.backend;
  // Short paths: a socket's has at most 107 characters.
  const std::string board = board_of(files), eyes = board + ".eyes";
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
                 to_string(backend.mcu),
                 "--eyes",
                 to_string(backend.eyes),
                 "--renderer",
                 to_string(backend.renderer),
                 "--sensors",
                 to_string(backend.sensors),
                 "--seed",
                 std::to_string(scenario.seed),
                 "--supply",
                 std::to_string(scenario.supply_volts),
                 "--record",
                 folder + "/recording.mcap"},
                {"run", options.behavior, "--robot", "serial:" + board, "--camera", eyes, "--color",
                 color_file, "--radius", std::to_string(scenario.ball_radius_m), "--json"}};
  if (backend.imu) both.simulator.push_back("--imu");
  for (const auto& [name, value] : options.settings) {
    both.behaviour.push_back("--set");
    both.behaviour.push_back(name + "=" + value);
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
  Json result = Json::parse(log.substr(at), nullptr, false);
  return result.is_object() ? result : Json::object();
}

// Why an episode does not count for or against the robot; empty where it does. `behaviour`: exit status
// of `kaz run`, none if time ran out; `simulator`: that of `kaz sim`; `last`: its last reply; `result`: of
// `kaz run`.
std::string machine_trouble(std::optional<int> behaviour, bool ended_early, int simulator,
                            const Json& last, const Json& result) {
  constexpr int kLost = static_cast<int>(Fault::environment);
  constexpr double kMaxLag_s = 1;  // in all; or at once, which only a stop of the process is
  if (ended_early) return "kaz sim ended with " + std::to_string(simulator) + " during the run";
  if (simulator == kLost) return "kaz sim could not keep its recording";
  if (behaviour == static_cast<int>(Fault::usage)) return "kaz run could not begin";
  if (behaviour == kLost && result.value("outcome", "") == "environment")
    return result.value("sentence", std::string());
  if (behaviour == kLost) return "kaz run lost port, camera or files";
  for (const int number : {SIGHUP, SIGINT, SIGKILL, SIGTERM, SIGBUS, SIGXCPU, SIGXFSZ})
    if (behaviour == 128 + number) return "kaz run was ended by signal " + std::to_string(number);
  const double lag_s = last.contains("lost_s") ? last["lost_s"].get<double>() : 0;
  if (!behaviour && lag_s > kMaxLag_s)
    return "the machine was too slow: kaz sim lagged " + std::to_string(lag_s) + " s behind";
  const double stop_s = last.contains("worst_late_s") ? last["worst_late_s"].get<double>() : 0;
  if (behaviour != 0 && stop_s > kMaxLag_s)
    return "kaz sim stood still for " + std::to_string(stop_s) + " s during the run";
  return {};
}

}  // namespace

Result<Json> run_realtime_episode(const CampaignOptions& options, std::uint64_t number,
                                  const std::string& failures, const KeepEpisode&) {
  const Scenario scenario = Scenario::draw(options.variation, options.seed, number);
  const auto robot = KAZ_TRY(data_file("robot/kaz/kaz.urdf"));
  const auto files = KAZ_TRY(scenario_files(scenario, fs::path(robot).parent_path().string()));
  char name[32];
  std::snprintf(name, sizeof name, "%06llu", static_cast<unsigned long long>(number));
  const std::string kept = (fs::path(failures) / name).string();
  std::error_code wrong;
  remove_files(kept);
  fs::create_directories(kept, wrong);
  if (wrong) return fail(Fault::environment, kept + ": cannot be made: " + wrong.message());
  const auto both = KAZ_TRY(commands(options, scenario, files, kept));
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
    return fail(Fault::environment, "kaz sim did not begin: " + last_line(text_of(sim_log)));
  auto behaviour = KAZ_TRY(Child::begin(both.behaviour, run_log));
  auto control = KAZ_TRY(Control::open(board_of(files) + ".ctl"));
  Held held(scenario.ball_radius_m);
  Json last = Json::object();
  const auto run_begun = std::chrono::steady_clock::now();
  while (!behaviour.ended() && std::chrono::steady_clock::now() - run_begun < kMost) {
    if (interrupt.requested()) return interrupted();
    if (const auto status = control.status()) held.see(last = *status);
    ::usleep(100'000);
  }
  const auto status = behaviour.ended();
  if (!status) {
    behaviour.signal(SIGINT);
    behaviour.wait(kEnd);
  }
  const bool simulator_ended = simulator.ended().has_value();
  simulator.signal(SIGINT);
  if (!simulator.wait(kEnd))
    return fail(Fault::environment, "kaz sim did not end; its log is " + sim_log);
  const Json result = result_of(text_of(run_log));
  if (const std::string why =
          machine_trouble(status, simulator_ended, *simulator.ended(), last, result);
      !why.empty())
    return fail(Fault::environment, why + "; logs are in " + kept);

  std::string cause = result.value("cause", std::string());
  // Above 128: a signal, none of the machine's.
  if (cause.empty()) cause = !status ? "time" : *status > 128 ? "crashed" : "error";
  if (result.value("outcome", "") == "done")
    cause = options.behavior == "catch-ball" && held.longest() < 3 ? "not held" : "";
  Json results = Json::object();
  for (const char* key : {"found_s", "catch_s", "held_s", "hand_load", "hand_gap_deg"})
    if (result.contains(key) && result[key].is_number()) results[key] = result[key];
  const std::string log_line = last_line(text_of(run_log));
  Json simulator_json = Json::object();
  for (const char* key : {"overruns", "lost_s", "pairs_dropped", "unconverged_steps"})
    if (last.contains(key)) simulator_json[key] = last[key];
  if (cause.empty()) remove_files(kept);
  Json episode{{"episode", number},
               {"scenario", scenario_json(scenario)},
               {"success", cause.empty()},
               {"cause", cause},
               {"sentence", result.value("sentence", log_line)},
               {"measurements", results},
               {"truth", {{"fell", cause == "fell"}, {"longest_held_s", held.longest()}}},
               {"simulator", simulator_json}};
  if (result.contains("duration_s")) episode["seconds"] = result["duration_s"];
  if (result.contains("rtf")) episode["rtf"] = result["rtf"];
  return episode;
}

}  // namespace kaz::tools

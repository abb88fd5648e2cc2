// Hands episodes to processes and keeps what they say.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/evaluate/campaign.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iterator>

#include "host/behavior/plugin.h"
#include "shared/base/files.hpp"
#include "shared/base/one_line.hpp"
#include "tools/app/base/interrupt_signals.h"
#include "tools/app/evaluate/episode.h"
#include "tools/app/evaluate/episode_file.h"
#include "tools/app/evaluate/summary.h"
#include "tools/figure/figure.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string episode_file(std::uint64_t number) {
  char name[48];
  std::snprintf(name, sizeof name, "episodes/%06llu.json", static_cast<unsigned long long>(number));
  return name;
}

using Parse = Result<Json> (*)(const std::string& text, const std::string& name);

Result<Json> read_json(const std::string& path, Parse parse) {
  constexpr std::size_t max_bytes = 64 << 20;
  const auto text = KAZ_TRY(read_whole_file(path, max_bytes, "kaz evaluate writes such files"));
  return parse(text, path);
}

Result<void> write_json(const std::string& path, const Json& json) {
  const std::string text = json.dump(1) + "\n";
  return figure::write_file(path,
                            {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

// The episodes that are in a folder already.
Result<Episodes> read_episodes(const std::string& folder) {
  Episodes all;
  std::error_code none;
  for (fs::directory_iterator at(folder + "/episodes", none), end; !none && at != end;
       at.increment(none)) {
    if (at->path().extension() != ".json") continue;
    auto one = KAZ_TRY(read_json(at->path().string(), parse_episode));
    const auto number = one["episode"].get<std::uint64_t>();
    all[number] = std::move(one);
  }
  return all;
}

struct Job {
  pid_t pid = -1;
  std::uint64_t number = 0;
};

// The episode in a process of its own: what breaks there breaks nothing else, and each has its own
// world and renderer. It writes its file and ends.
Result<Job> begin(const CampaignOptions& options, const OutputFolder& folder,
                  std::uint64_t number) {
  std::fflush(nullptr);
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid < 0)
    return fail(Fault::environment, std::string("no process for an episode: ") +
                                        std::strerror(errno) + "; give fewer --jobs");
  if (pid > 0) return Job{pid, number};
  // Ctrl-C is the parent's: it ends its children itself, by SIGTERM. They end with it, however it ends.
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);
  InterruptSignals::forget_parent();
  const auto episode = (options.realtime ? run_realtime_episode : run_episode)(
      options, number, folder.path("failures"));
  int status = 0;
  if (!episode && episode.error().fault == Fault::interrupted) {
    status = exit_status(episode.error());  // an episode that has not ended is none
  } else if (!episode) {
    std::fprintf(stderr, "kaz evaluate: episode %llu: %s\n",
                 static_cast<unsigned long long>(number),
                 one_line(episode.error().message).c_str());
    status = static_cast<int>(episode.error().fault);
  } else if (auto written = write_json(folder.path(episode_file(number)), *episode); !written) {
    std::fprintf(stderr, "kaz evaluate: %s\n", one_line(written.error().message).c_str());
    status = static_cast<int>(written.error().fault);
  }
  std::fflush(nullptr);
  ::_exit(status);
}

// What there is of an episode whose process was lost.
Json broken(const CampaignOptions& options, std::uint64_t number, int status) {
  const std::string how = WIFSIGNALED(status)
                              ? std::string("ended by signal ") + std::to_string(WTERMSIG(status))
                              : "ended with " + std::to_string(WEXITSTATUS(status));
  return {{"episode", number},
          {"scenario", scenario_json(Scenario::draw(options.variation, options.seed, number))},
          {"success", false},
          {"cause", "crashed"},
          {"sentence", "its process " + how},
          {"figures", Json::object()},
          {"truth", Json::object()}};
}

class Runner {
 public:
  Runner(const CampaignOptions& options, const OutputFolder& folder, Episodes& episodes)
      : options_(options),
        folder_(folder),
        episodes_(episodes),
        progress_("kaz evaluate", options.json) {}

  // Children may remove their files, and then have to go.
  ~Runner() {
    for (const Job& child : children_) ::kill(child.pid, SIGTERM);
    for (int i = 0; i < 25 && !children_.empty(); ++i) {
      std::erase_if(children_,
                    [](const Job& child) { return ::waitpid(child.pid, nullptr, WNOHANG) != 0; });
      if (!children_.empty()) ::usleep(20'000);
    }
    for (const Job& child : children_) ::kill(child.pid, SIGKILL);
    for (const Job& child : children_) ::waitpid(child.pid, nullptr, 0);
  }

  Result<void> run(const std::vector<std::uint64_t>& numbers, const host::Interrupt& interrupt) {
    total_ = episodes_.size() + numbers.size();
    for (auto next = numbers.begin(); next != numbers.end() || !children_.empty();) {
      if (interrupt.requested())
        return fail(Fault::interrupted, "interrupted; what has ended is kept in " +
                                            folder_.folder() + ", and the same command goes on");
      if (next != numbers.end() && children_.size() < static_cast<std::size_t>(options_.jobs)) {
        auto child = KAZ_TRY(begin(options_, folder_, *next++));
        children_.push_back(child);
        continue;
      }
      if (auto taken = take_ended(); !taken) return taken;
      ::usleep(20'000);
    }
    progress_.done();
    return {};
  }

 private:
  Result<void> take_ended() {
    for (std::size_t i = 0; i < children_.size();) {
      int status = 0;
      if (::waitpid(children_[i].pid, &status, WNOHANG) == 0) {
        ++i;
        continue;
      }
      const std::uint64_t number = children_[i].number;
      children_.erase(children_.begin() + static_cast<std::ptrdiff_t>(i));
      if (auto kept = keep(number, status); !kept) return kept;
    }
    return {};
  }

  Result<void> keep(std::uint64_t number, int status) {
    const std::string path = folder_.path(episode_file(number));
    // 2 and 3: it was never begun, and no other will be. Above 128: a signal that was not from here.
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
    if (code != 0 && code < static_cast<int>(Fault::interrupted))
      return fail(static_cast<Fault>(WEXITSTATUS(status)),
                  "episode " + std::to_string(number) + " could not be run (above)");
    if (!WIFEXITED(status) || code != 0) {
      if (auto written = write_json(path, broken(options_, number, status)); !written)
        return written;
    }
    auto episode = KAZ_TRY(read_json(path, parse_episode));
    episodes_[number] = std::move(episode);
    std::uint64_t good = 0;
    for (const auto& [n, e] : episodes_) good += e["success"].get<bool>() ? 1 : 0;
    progress_.update(
        static_cast<double>(episodes_.size()) / static_cast<double>(total_),
        std::to_string(good) + " of " + std::to_string(episodes_.size()) + " succeeded");
    return {};
  }

  const CampaignOptions& options_;
  const OutputFolder& folder_;
  Episodes& episodes_;
  Progress progress_;
  std::size_t total_ = 0;
  std::vector<Job> children_;
};

Result<void> make_folder(const std::string& path) {
  std::error_code wrong;
  fs::create_directories(path, wrong);
  if (wrong) return fail(Fault::environment, "cannot make '" + path + "': " + wrong.message());
  return {};
}

// That the folder is empty or of this campaign.
Result<void> claim(const OutputFolder& folder, const Json& campaign) {
  for (const char* part : {"episodes", "failures"}) {
    if (auto made = make_folder(folder.path(part)); !made) return made;
  }
  const std::string path = folder.path("campaign.json");
  if (!fs::exists(path)) return write_json(path, campaign);
  const auto there = KAZ_TRY(read_json(path, parse_campaign));
  if (there == campaign) return {};
  for (const auto& [key, value] : campaign.items()) {
    if (there.contains(key) && there[key] == value) continue;
    return fail(Fault::usage, "'" + folder.folder() + "' holds another campaign (its " + key +
                                  " is " + (there.contains(key) ? there[key].dump() : "missing") +
                                  ", here " + value.dump() + "): choose another --out");
  }
  return fail(Fault::usage,
              "'" + folder.folder() + "' holds another campaign: choose another --out");
}

}  // namespace

Json campaign_json(const CampaignOptions& o) {
  const auto pair = [](const Interval& i) { return Json{i.min, i.max}; };
  return {{"behavior", o.behavior},
          {"settings", o.settings},
          {"realtime", o.realtime},
          {"seed", o.seed},
          {"mcu", to_string(o.backend.mcu)},
          {"image", o.backend.image},
          {"sensors", to_string(o.backend.sensors)},
          {"imu", o.backend.imu},
          {"eyes", to_string(o.backend.eyes)},
          {"eye_width", o.backend.eye_width},
          {"dynamics", o.backend.dynamics},
          {"physics_step_ms", o.backend.physics_step_ms},
          {"friction", pair(o.variation.friction)},
          {"supply_volts", pair(o.variation.supply_volts)},
          {"ball_distance_m", pair(o.variation.ball_distance_m)},
          {"bearing_deg", o.variation.bearing_deg},
          {"radii_m", o.variation.radii_m},
          {"colors", o.variation.colors},
          {"mass_sigma", o.variation.mass_sigma},
          {"lamp_height_deg", pair(o.variation.lamp_height_deg)},
          {"lamp", pair(o.variation.lamp)},
          {"shade", pair(o.variation.shade)}};
}

Result<bool> run_campaign(const CampaignOptions& options) {
  const auto known = KAZ_TRY(behavior::named_behavior(options.behavior));
  const auto values = behavior::OptionValues::parse(known.options, options.settings);
  if (!values) return tl::unexpected(values.error());
  if (options.realtime && (known.name == "go-forward" || known.name.starts_with("turn-")))
    return fail(Fault::usage, options.behavior +
                                  " is judged by where the robot truly is, which a robot in "
                                  "another process does not tell: leave --realtime out");
  if (options.shard > options.episodes)
    return fail(Fault::usage, "--shard " + std::to_string(options.shard) + "/" +
                                  std::to_string(options.shards) + " has none of the " +
                                  std::to_string(options.episodes) +
                                  " episodes; give more --episodes or fewer parts");
  const auto folder = KAZ_TRY(OutputFolder::open(options.out));
  const Json campaign = campaign_json(options);
  KAZ_TRY(claim(folder, campaign));
  auto episodes = KAZ_TRY(read_episodes(folder.folder()));
  std::vector<std::uint64_t> missing;
  for (std::uint64_t n = options.shard - 1; n < options.episodes; n += options.shards) {
    if (!episodes.contains(n)) missing.push_back(n);
  }
  if (!episodes.empty() && !options.json)
    std::fprintf(stderr, "kaz evaluate: %zu episodes are there already, %zu to go\n",
                 episodes.size(), missing.size());
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  if (auto ran = Runner(options, folder, episodes).run(missing, interrupt); !ran) {
    const bool interrupted = ran.error().fault == Fault::interrupted;
    if (interrupted) KAZ_TRY(summarize(campaign, episodes, folder, options.json, true));
    return tl::unexpected(ran.error());
  }
  return summarize(campaign, episodes, folder, options.json);
}

Result<bool> merge_campaigns(const std::vector<std::string>& folders, const std::string& out,
                             bool json) {
  Json campaign;
  Episodes all;
  for (const std::string& folder : folders) {
    if (!fs::exists(folder + "/campaign.json"))
      return fail(Fault::usage,
                  "'" + folder + "' is no folder of kaz evaluate: it has no campaign.json");
    const auto other = KAZ_TRY(read_json(folder + "/campaign.json", parse_campaign));
    if (campaign.is_null()) campaign = other;
    if (campaign != other)
      return fail(Fault::usage, "'" + folder + "' and '" + folders.front() +
                                    "' are of different campaigns: parts differ by --shard alone");
    auto episodes = KAZ_TRY(read_episodes(folder));
    for (auto& [number, episode] : episodes) {
      const auto [at, added] = all.emplace(number, episode);
      Json one = at->second, two = episode;
      one.erase("rtf");
      two.erase("rtf");
      if (!added && one != two)
        return fail(Fault::failed, "episode " + std::to_string(number) + " ended differently in '" +
                                       folder +
                                       "' than in a folder before it: were the programs the same?");
    }
  }
  if (all.empty()) return fail(Fault::usage, "the folders hold no episode");
  const auto folder = KAZ_TRY(OutputFolder::open(out));
  KAZ_TRY(claim(folder, campaign));
  for (const auto& [number, episode] : all) {
    KAZ_TRY(write_json(folder.path(episode_file(number)), episode));
  }
  for (const std::string& from : folders) {
    std::error_code ignored;
    if (fs::exists(from + "/failures"))
      fs::copy(from + "/failures", folder.path("failures"),
               fs::copy_options::recursive | fs::copy_options::update_existing, ignored);
  }
  return summarize(campaign, all, folder, json);
}

}  // namespace kaz::tools

// Hands episodes to processes and keeps what they say.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/campaign.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <optional>
#include <set>

#include "host/behavior/plugin.h"
#include "shared/base/bounded_json.hpp"
#include "shared/base/files.hpp"
#include "shared/base/one_line.hpp"
#include "tools/base/interrupt_signals.h"
#include "tools/eval/episode.h"
#include "tools/eval/episode_file.h"
#include "tools/eval/judge.h"
#include "tools/eval/parts.h"
#include "tools/eval/summary.h"
#include "tools/eval/work_folder.h"
#include "tools/run/option_json.h"

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
  // A sentence may hold bytes that are no UTF-8.
  return write_whole_file(path, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

const OutputKind& campaign_output() {
  static const OutputKind kind{"evaluate",
                               {"campaign.json", "result.json", "report.html", "junit.xml",
                                "episodes.csv", "episodes", "failures"}};
  return kind;
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
    if (at->path().filename() != fs::path(episode_file(number)).filename())
      return fail(Fault::usage, at->path().string() + ": contains episode " +
                                    std::to_string(number) +
                                    ", which does not match the file's name; remove the file");
    all[number] = std::move(one);
  }
  return all;
}

struct Job {
  pid_t pid = -1;
  std::uint64_t number = 0;
  int why = -1;  // pipe: the sentence of an error, empty without one
};

// Runs it in the process of its own. The exit status is that of an error, whose sentence goes to `why`.
int run_job(const CampaignOptions& options, const OutputFolder& folder, std::uint64_t number,
            int why) {
  Result<void> done;
  try {
    const std::string path = folder.path(episode_file(number));
    const auto episode = (options.realtime ? run_realtime_episode : run_episode)(
        options, number, folder.path("failures"));
    done = episode ? write_json(path, *episode) : Result<void>(tl::unexpected(episode.error()));
  } catch (const std::exception& error) {  // std::bad_alloc, say
    done = fail(Fault::environment, error.what());
  }
  if (done) return 0;
  const std::string sentence = done.error().message.substr(0, 4000);  // a pipe holds that much
  (void)!::write(why, sentence.data(), sentence.size());
  return exit_status(done.error());
}

// Why a signal that ended an episode is the machine's; empty where it is a crash of behavior or program.
std::string machine_signal(int number) {
  for (const int crash : {SIGSEGV, SIGABRT, SIGFPE, SIGILL, SIGTRAP, SIGSYS})
    if (number == crash) return {};
  return "the process of the episode was ended by signal " + std::to_string(number);
}

// The episode in a process of its own: what breaks there breaks nothing else, and each has its own
// world and renderer. It writes its file and ends; its temporary files are in `temporary`.
Result<Job> begin(const CampaignOptions& options, const OutputFolder& folder,
                  const std::string& temporary, std::uint64_t number) {
  std::fflush(nullptr);
  int why[2] = {-1, -1};
  const pid_t parent = ::getpid();
  const pid_t pid = ::pipe2(why, O_CLOEXEC) == 0 ? ::fork() : -1;
  if (pid < 0)
    return fail(Fault::environment, std::string("cannot start a process for an episode: ") +
                                        std::strerror(errno) + "; give fewer --jobs");
  if (pid > 0) {
    ::close(why[1]);
    return Job{pid, number, why[0]};
  }
  // Ctrl-C is the parent's: it ends its children itself, by SIGTERM. They end with it, however it ends.
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);
  InterruptSignals::forget_earlier();
  ::setenv("TMPDIR", temporary.c_str(), 1);
  const int status = run_job(options, folder, number, why[1]);
  std::fflush(nullptr);
  ::_exit(status);
}

// What there is of an episode whose process has crashed.
Result<Json> broken(const CampaignOptions& options, std::uint64_t number, int status) {
  const std::string how = WIFSIGNALED(status)
                              ? "ended by signal " + std::to_string(WTERMSIG(status))
                              : std::string("ended without a result");
  const auto drawn = KAZ_TRY(draw_episode(options, number));
  return Json{{"episode", number},
              {"scenario", scenario_json(drawn.scenario)},
              {"success", false},
              {"claim", false},
              {"cause", "crashed"},
              {"sentence", "its process " + how},
              {"measurements", Json::object()},
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
    for (const Job& child : children_) ::close(child.why);
  }

  Result<void> run(const std::vector<std::uint64_t>& numbers, const host::Interrupt& interrupt) {
    if (numbers.empty()) return {};
    total_ = episodes_.size() + numbers.size();
    work_.emplace(KAZ_TRY(WorkFolder::make()));
    for (auto next = numbers.begin();
         (next != numbers.end() && lost_in_a_row_ < kMaxLostInARow) || !children_.empty();) {
      if (interrupt.requested())
        return fail(Fault::interrupted, "interrupted; completed episodes are in " +
                                            folder_.folder() +
                                            ", and the same command continues the evaluation");
      if (next != numbers.end() && lost_in_a_row_ < kMaxLostInARow &&
          children_.size() < static_cast<std::size_t>(options_.jobs)) {
        auto child = KAZ_TRY(begin(options_, folder_, work_->path(), *next++));
        children_.push_back(child);
        work_->add_user(child.pid);
        continue;
      }
      if (auto taken = take_ended(); !taken) return taken;
      ::usleep(20'000);
    }
    progress_.done();
    return {};
  }

  const LostEpisodes& lost() const { return lost_; }

 private:
  // Then the machine cannot run episodes: no more are begun.
  static constexpr int kMaxLostInARow = 3;

  Result<void> take_ended() {
    for (std::size_t i = 0; i < children_.size();) {
      int status = 0;
      if (::waitpid(children_[i].pid, &status, WNOHANG) == 0) {
        ++i;
        continue;
      }
      const Job job = children_[i];
      children_.erase(children_.begin() + static_cast<std::ptrdiff_t>(i));
      work_->remove_user(job.pid);
      std::string why(4000, '\0');
      const ssize_t length = ::read(job.why, why.data(), why.size());
      ::close(job.why);
      why.resize(length > 0 ? static_cast<std::size_t>(length) : 0);
      if (auto kept = keep(job.number, status, why); !kept) return kept;
    }
    return {};
  }

  void lose(std::uint64_t number, const std::string& why) {
    ++lost_in_a_row_;
    lost_[number] = why;
    progress_.done();
    std::fprintf(stderr, "kaz evaluate: episode %llu is lost because of a machine error: %s\n",
                 static_cast<unsigned long long>(number), why.c_str());
  }

  Result<void> keep(std::uint64_t number, int status, const std::string& why) {
    const std::string path = folder_.path(episode_file(number));
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
    if (code == static_cast<int>(Fault::environment)) {
      lose(number, why);
      return {};
    }
    // Above 128: a signal that was not from here.
    if (code > static_cast<int>(Fault::interrupted)) {
      lose(number, "the process of the episode was ended by signal " +
                       std::to_string(code - static_cast<int>(Fault::interrupted)));
      return {};
    }
    // The episode never began, and no other episode would.
    if (code != 0)
      return fail(static_cast<Fault>(code), "episode " + std::to_string(number) + ": " + why);
    if (WIFSIGNALED(status)) {
      if (const std::string signal = machine_signal(WTERMSIG(status)); !signal.empty()) {
        lose(number, signal);
        return {};
      }
    }
    if (!fs::exists(path)) {
      const auto crashed = KAZ_TRY(broken(options_, number, status));
      KAZ_TRY(write_json(path, crashed));
    }
    auto episode = KAZ_TRY(read_json(path, parse_episode));
    episodes_[number] = std::move(episode);
    lost_in_a_row_ = 0;
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
  std::optional<WorkFolder> work_;  // while there are episodes to run; goes after their processes
  std::size_t total_ = 0;
  std::vector<Job> children_;
  LostEpisodes lost_;
  int lost_in_a_row_ = 0;
};

// Not an error of the evaluation: what is decided stays and counts.
Error lost_error(const LostEpisodes& lost, std::size_t wanted) {
  std::vector<std::uint64_t> numbers;
  for (const auto& [number, why] : lost) numbers.push_back(number);
  return {Fault::environment,
          std::to_string(lost.size()) + " of " + std::to_string(wanted) +
              " episodes were lost to machine errors (" + numbers_text(numbers) +
              "; the first: " + lost.begin()->second +
              "); the rates exclude lost episodes, and the same command runs lost episodes again"};
}

Result<Part> read_part(const std::string& folder, const Episodes& episodes) {
  const std::string path = folder + "/result.json";
  Json result;
  if (fs::exists(path)) result = KAZ_TRY(read_json(path, parse_result));
  return part_of(folder, episodes, result);
}

Result<void> make_folder(const std::string& path) {
  std::error_code wrong;
  fs::create_directories(path, wrong);
  if (wrong) return fail(Fault::environment, "cannot create '" + path + "': " + wrong.message());
  return {};
}

// Each file appears whole or not at all. One that is there already stays.
Result<void> copy_files(const fs::path& from, const fs::path& to) {
  std::error_code wrong;
  for (fs::recursive_directory_iterator at(from, wrong), end; !wrong && at != end;
       at.increment(wrong)) {
    const fs::path target = to / at->path().lexically_relative(from),
                   part = target.string() + ".part";
    if (at->symlink_status().type() == fs::file_type::directory)
      KAZ_TRY(make_folder(target.string()));
    if (at->symlink_status().type() != fs::file_type::regular || fs::exists(target)) continue;
    if (!fs::copy_file(at->path(), part, fs::copy_options::overwrite_existing, wrong)) {
      const int error = wrong.value();
      fs::remove(part, wrong);
      return write_failure(target.string(), "copy " + at->path().string() + " there", error);
    }
    KAZ_TRY(put_in_place(part.string(), target.string()));
  }
  if (wrong && fs::exists(from))
    return fail(Fault::environment, from.string() + ": cannot be read: " + wrong.message());
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
    return fail(Fault::usage,
                "'" + folder.folder() + "' contains another evaluation (its " + key + " is " +
                    (there.contains(key) ? json_sample(there[key]) : "missing") + ", here " +
                    json_sample(value) + "): choose another folder with --out");
  }
  return fail(Fault::usage, "'" + folder.folder() +
                                "' contains another evaluation: choose another folder with --out");
}

// The summary will be a new one.
Result<void> remove_summary(const OutputFolder& folder) {
  for (const char* name : {"result.json", "report.html", "junit.xml", "episodes.csv"}) {
    const std::string path = folder.path(name);
    if (::unlink(path.c_str()) != 0 && errno != ENOENT) return write_failure(path, "remove", errno);
  }
  return {};
}

// The folder's report is of all episodes there, and none other may be there than what is asked for.
Result<void> refuse_more(const CampaignOptions& options, const OutputFolder& folder,
                         const Episodes& episodes) {
  std::vector<std::uint64_t> others;
  for (const auto& [number, episode] : episodes) {
    if (number >= options.episodes || number % options.shards != options.shard - 1)
      others.push_back(number);
  }
  if (others.empty()) return {};
  const std::string part = options.shards == 1 ? ""
                                               : " --shard " + std::to_string(options.shard) + "/" +
                                                     std::to_string(options.shards);
  return fail(Fault::usage, "'" + folder.folder() + "' contains episodes outside --episodes " +
                                std::to_string(options.episodes) + part + " (numbers " +
                                numbers_text(others) +
                                "): run these episodes too, or choose another folder with --out");
}

// The folder of a merge holds what an earlier one has put there: all of it is of the parts.
Result<void> refuse_others(const OutputFolder& folder, const Episodes& all) {
  const auto there = KAZ_TRY(read_episodes(folder.folder()));
  std::vector<std::uint64_t> others;
  for (const auto& [number, episode] : there) {
    if (!all.contains(number)) others.push_back(number);
  }
  if (others.empty()) return {};
  return fail(Fault::usage, "'" + folder.folder() + "' contains episodes (" + numbers_text(others) +
                                ") that are not in any of the parts: give the folder of these "
                                "episodes too, or choose another folder with --out");
}

// A plug-in that is to be judged as one of Kaz's behaviors, or one of these with a measure of its own.
Result<void> check_judge(const CampaignOptions& options) {
  const bool plugin = behavior::names_plugin(options.behavior);
  const auto judged = options.judged_behavior();
  const bool measured = judged && judged->evaluation.criterion != behavior::Criterion::claim;
  if (options.judged_as.empty() && !plugin && !measured)
    return fail(Fault::usage,
                options.behavior + " has no success criterion; evaluate another behavior");
  if (options.judged_as.empty()) return {};
  if (!plugin)
    return fail(Fault::usage, "--judge is only valid with plug-ins: " + options.behavior +
                                  " has its own criterion");
  if (measured) return {};
  return fail(Fault::usage,
              "--judge: '" + options.judged_as +
                  "' has no success criterion; give a behavior from docs/howto/evaluate.md");
}

}  // namespace

Result<behavior::Behavior> CampaignOptions::judged_behavior() const {
  return judged_as.empty() ? behavior::named_behavior(behavior)
                           : behavior::find_behavior(judged_as);
}

Json campaign_json(const CampaignOptions& o) {
  const auto pair = [](const Interval& i) { return Json{i.min, i.max}; };
  Json worlds = Json::array();
  for (const WorldKind kind : o.variation.worlds) worlds.push_back(to_string(kind));
  Json json{{"behavior", o.behavior},
            {"settings", o.settings},
            {"realtime", o.realtime},
            {"seed", o.seed}};
  BackendOptions robot = o.backend;
  const auto writer = option_json_writer(json);
  robot.visit_mcu(writer);
  robot.visit_image(writer);
  robot.visit_sensors(writer);
  robot.visit_eyes(writer);
  robot.visit_dynamics(writer);
  json.update(Json{{"friction", pair(o.variation.friction)},
                   {"supply_volts", pair(o.variation.supply_volts)},
                   {"ball_distance_m", pair(o.variation.ball_distance_m)},
                   {"bearing_deg", o.variation.bearing_deg},
                   {"radii_m", o.variation.radii_m},
                   {"colors", o.variation.colors},
                   {"mass_sigma", o.variation.mass_sigma},
                   {"lamp_height_deg", pair(o.variation.lamp_height_deg)},
                   {"lamp", pair(o.variation.lamp)},
                   {"shade", pair(o.variation.shade)},
                   {"worlds", worlds},
                   {"density", pair(o.variation.density)},
                   {"max_obstacles", o.variation.max_obstacles},
                   {"goal_distance_m", pair(o.variation.goal_distance_m)}});
  if (!o.judged_as.empty()) json["judged_as"] = o.judged_as;
  if (o.calibrated) json["calibrated"] = true;
  if (const Pushes& pushes = o.variation.pushes; pushes.impulse_ns > 0)
    json["pushes"] = {{"impulse_ns", pushes.impulse_ns},
                      {"from_s", pushes.from_s},
                      {"since", pushes.from_first_step ? "first step" : "start"},
                      {"every_s", pushes.every_s},
                      {"to", to_string(pushes.to)}};
  if (o.variation.props.max > 0) json["props"] = pair(o.variation.props);
  if (o.variation.floors != Variation{}.floors) json["floors"] = o.variation.floors;
  return json;
}

Result<bool> run_campaign(const CampaignOptions& options) {
  const auto known = KAZ_TRY(behavior::named_behavior(options.behavior));
  const auto values = behavior::OptionValues::parse(known.options, options.settings);
  if (!values) return tl::unexpected(values.error());
  KAZ_TRY(check_judge(options));
  if (options.shard > options.episodes)
    return fail(Fault::usage, "--shard " + std::to_string(options.shard) + "/" +
                                  std::to_string(options.shards) + " contains none of the " +
                                  std::to_string(options.episodes) +
                                  " episodes; give more --episodes or fewer parts");
  const auto folder = KAZ_TRY(open_campaign(options.out));
  const Json campaign = campaign_json(options);
  KAZ_TRY(claim(folder, campaign));
  auto episodes = KAZ_TRY(read_episodes(folder.folder()));
  KAZ_TRY(refuse_more(options, folder, episodes));
  KAZ_TRY(remove_summary(folder));
  std::vector<std::uint64_t> missing;
  for (std::uint64_t n = options.shard - 1; n < options.episodes; n += options.shards) {
    if (!episodes.contains(n)) missing.push_back(n);
  }
  if (!episodes.empty() && !options.json)
    std::fprintf(stderr, "kaz evaluate: %zu episodes are already done, %zu remain\n",
                 episodes.size(), missing.size());
  Extent extent{.planned = {options.episodes, options.shard, options.shards}};
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  Runner runner(options, folder, episodes);
  if (auto ran = runner.run(missing, interrupt); !ran) {
    extent.interrupted = ran.error().fault == Fault::interrupted;
    extent.signal = received_signal_name();
    if (extent.interrupted)
      KAZ_TRY(summarize(campaign, episodes, runner.lost(), folder, options.json, extent));
    return tl::unexpected(ran.error());
  }
  if (runner.lost().empty()) return summarize(campaign, episodes, {}, folder, options.json, extent);
  // Of lost episodes alone there is nothing to summarize. What cannot be written then is the same trouble.
  if (!episodes.empty())
    (void)summarize(campaign, episodes, runner.lost(), folder, options.json, extent);
  return tl::unexpected(lost_error(runner.lost(), missing.size()));
}

namespace {

struct Merge {
  Json campaign;
  Episodes episodes;
  std::vector<Part> parts;
};

Result<Merge> read_parts(const std::vector<std::string>& folders) {
  Merge merge;
  std::set<fs::path> read;
  for (const std::string& folder : folders) {
    std::error_code none;
    if (!read.insert(fs::weakly_canonical(folder, none)).second)
      return fail(Fault::usage, "'" + folder + "' is given twice: give each part once");
    if (!fs::exists(folder + "/campaign.json"))
      return fail(Fault::usage,
                  "'" + folder + "' is not a folder of kaz evaluate: campaign.json is missing");
    const auto other = KAZ_TRY(read_json(folder + "/campaign.json", parse_campaign));
    if (merge.campaign.is_null()) merge.campaign = other;
    if (merge.campaign != other)
      return fail(Fault::usage,
                  "'" + folder + "' and '" + folders.front() +
                      "' are from different evaluations: parts may only differ in --shard");
    auto episodes = KAZ_TRY(read_episodes(folder));
    merge.parts.push_back(KAZ_TRY(read_part(folder, episodes)));
    for (auto& [number, episode] : episodes) {
      const auto [at, added] = merge.episodes.emplace(number, episode);
      Json one = at->second, two = episode;
      one.erase("rtf");
      two.erase("rtf");
      if (!added && one != two)
        return fail(Fault::failed,
                    "episode " + std::to_string(number) + " has different results in '" + folder +
                        "' and in an earlier folder: run all parts with the same program");
    }
  }
  if (merge.episodes.empty()) return fail(Fault::usage, "the folders contain no episodes");
  KAZ_TRY(check_one_plan(merge.parts));
  return merge;
}

Result<bool> write_merge(const Merge& merge, const std::vector<std::string>& folders,
                         const OutputFolder& folder, bool json) {
  KAZ_TRY(claim(folder, merge.campaign));
  KAZ_TRY(refuse_others(folder, merge.episodes));
  KAZ_TRY(remove_summary(folder));
  for (const auto& [number, episode] : merge.episodes) {
    KAZ_TRY(write_json(folder.path(episode_file(number)), episode));
  }
  for (const std::string& from : folders)
    KAZ_TRY(copy_files(from + "/failures", folder.path("failures")));
  const Shortage shortage = find_shortage(merge.parts);
  const auto any = KAZ_TRY(
      summarize(merge.campaign, merge.episodes, shortage.lost, folder, json, shortage.extent));
  if (!shortage.sentence.empty()) return fail(Fault::environment, shortage.sentence);
  return any;
}

}  // namespace

Result<OutputFolder> open_campaign(const std::string& out) {
  return OutputFolder::open(out, campaign_output());
}

Result<bool> merge_campaigns(const std::vector<std::string>& folders, const std::string& out,
                             bool json) {
  const auto merge = KAZ_TRY(read_parts(folders));
  for (const std::string& from : folders) {
    if (std::error_code none; fs::equivalent(from, out, none))
      return fail(Fault::usage,
                  "--out: '" + out + "' is one of the folders to merge; give another folder");
  }
  const auto folder = KAZ_TRY(open_campaign(out));
  return write_merge(merge, folders, folder, json);
}

Result<bool> merge_campaigns(const std::vector<std::string>& folders, const OutputFolder& out,
                             bool json) {
  const auto merge = KAZ_TRY(read_parts(folders));
  return write_merge(merge, folders, out, json);
}

}  // namespace kaz::tools

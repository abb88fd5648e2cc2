// `kaz evaluate`: many episodes of a behaviour, and how many succeed.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <sstream>

#include "tools/app/base/arguments.h"
#include "tools/app/base/provenance.h"
#include "tools/app/evaluate/campaign.h"
#include "tools/app/evaluate/given_options.h"
#include "tools/app/evaluate/hosts.h"
#include "tools/app/evaluate/slurm.h"
#include "tools/app/session/balance_setting.h"
#include "tools/app/session/plugin_guard.h"
#include "tools/kaz/options.h"
#include "tools/kaz/verbs.h"
#include "tools/kaz/watch_options.h"

namespace kaz::tools {
namespace {

struct Arguments {
  CampaignOptions campaign;
  std::vector<std::string> settings;
  std::string shard = "1/1";
  int slurm_tasks = 0;
  std::string sbatch, hosts;
  int hosts_tasks = 0;
  std::vector<double> friction, supply, distance, lamp, shade, goal_distance, density, props;
  std::vector<std::string> worlds{to_string(WorldKind::clutter)};
};

constexpr const char* kExitStatus =
    "Exit status: 0 at least one episode succeeded, 1 none did, 2 wrong usage, 3 episodes lost "
    "(disk, "
    "port, process).\n";

// --NAME FROM TO, both within `bounds`; `by_default`: what `given` stays without it.
void add_interval(CLI::App& verb, const std::string& name, std::vector<double>& given,
                  const Interval& by_default, const Interval& bounds, const std::string& text,
                  const std::string& unit = "") {
  char range[80];
  std::snprintf(range, sizeof range, "%g %g", by_default.min, by_default.max);
  verb.add_option(name, given, text)
      ->check(between(bounds.min, bounds.max, unit))
      ->expected(2)
      ->allow_extra_args(false)
      ->type_name("FROM TO")
      ->default_str(range);
}

// Each is drawn as often as the others: a repeated one is a slip.
template <class T>
Result<void> no_repetition(const std::string& option, std::vector<T> values) {
  std::ranges::sort(values);
  if (std::ranges::adjacent_find(values) == values.end()) return {};
  return fail(Fault::usage, option + ": a value stands in the list twice, give it once");
}

// Values with commas between, or the option repeated. Words after it belong to no option.
template <class T>
CLI::Option* add_list(CLI::App& verb, const std::string& name, std::vector<T>& to,
                      const std::string& text) {
  return verb.add_option(name, to, text)
      ->type_name("LIST")
      ->delimiter(',')
      ->expected(1)
      ->allow_extra_args(false)
      ->take_all()
      ->capture_default_str();
}

std::vector<std::string> given_options(const CLI::App& verb) {
  std::vector<std::string> given;
  for (const CLI::Option* option : verb.get_options()) {
    if (option->count() > 0 && !option->get_lnames().empty())
      given.push_back("--" + option->get_lnames().front());
  }
  return given;
}

Result<void> check_tasks(const std::string& option, int tasks, std::uint64_t episodes) {
  if (tasks <= 0 || static_cast<std::uint64_t>(tasks) <= episodes) return {};
  return fail(Fault::usage, option + " " + std::to_string(tasks) +
                                ": that is more tasks than there are --episodes (" +
                                std::to_string(episodes) + ")");
}

// Behaviors whose pushes are timed from the start.
constexpr std::string_view kWithoutSteps[] = {"get-up", "search-ball", "stand", "track-ball"};

Result<Outcome> start(Arguments a, const WatchArguments& watch,
                      const std::vector<std::string>& options) {
  CampaignOptions& c = a.campaign;
  auto settings = KAZ_TRY(parse_settings(a.settings));
  KAZ_TRY(load_balance(c.behavior, settings));
  c.settings = settings;
  const auto shard = KAZ_TRY(parse_shard(a.shard));
  c.shard = shard.part;
  c.shards = shard.parts;
  const struct {
    const char* option;
    const std::vector<double>& given;
    Interval& to;
  } intervals[] = {{"--friction", a.friction, c.variation.friction},
                   {"--supply", a.supply, c.variation.supply_volts},
                   {"--ball-distance", a.distance, c.variation.ball_distance_m},
                   {"--lamp", a.lamp, c.variation.lamp},
                   {"--shade", a.shade, c.variation.shade},
                   {"--goal-distance", a.goal_distance, c.variation.goal_distance_m},
                   {"--density", a.density, c.variation.density},
                   {"--props", a.props, c.variation.props}};
  for (const auto& [option, given, to] : intervals) {
    const auto interval = KAZ_TRY(parse_interval(option, given, to));
    to = interval;
  }
  for (const std::string& color : c.variation.colors) {
    KAZ_TRY(ball_color(color));
  }
  for (const std::string& floor : c.variation.floors) {
    if (std::ranges::count(floor_names(), floor) == 0)
      return fail(Fault::usage,
                  "'" + floor + "' is no floor: there are wood, carpet, checker, plain");
  }
  KAZ_TRY(no_repetition("--floors", c.variation.floors));
  c.variation.worlds = KAZ_TRY(parse_world_kinds(a.worlds));
  KAZ_TRY(no_repetition("--worlds", c.variation.worlds));
  KAZ_TRY(no_repetition("--colors", c.variation.colors));
  KAZ_TRY(no_repetition("--radii", c.variation.radii_m));
  KAZ_TRY(check_given(c, options));
  if (const auto balance = settings.find("balance");
      balance != settings.end() && balance->second != "none" && !c.backend.imu)
    return fail(Fault::usage,
                "--set balance needs the board's gyro and accelerometer: leave --no-imu out, or "
                "give balance=none");
  if (std::ranges::count(kWithoutSteps, c.task()) > 0) {
    c.variation.pushes.from_first_step = false;
    if (std::ranges::count(options, "--push-from") == 0) c.variation.pushes.from_s = 1;
  }
  // Drawing pictures is most of an episode's time: none for who does not look.
  if (std::ranges::count(options, "--eyes") == 0 &&
      !KAZ_TRY(guarded_behavior(c.behavior, "kaz evaluate")).needs_camera)
    c.backend.eyes = sim::EyeKind::none;
  KAZ_TRY(check_tasks("--slurm", a.slurm_tasks, c.episodes));
  KAZ_TRY(check_tasks("--parallel-tasks", a.hosts_tasks, c.episodes));
  if (a.slurm_tasks > 0) {
    SlurmOptions slurm{a.slurm_tasks, {}, command_words()};
    std::istringstream words(a.sbatch);
    for (std::string word; words >> word;) slurm.submit.push_back(word);
    const auto succeeded = KAZ_TRY(run_on_slurm(c, slurm));
    return Outcome(succeeded);
  }
  if (!a.hosts.empty()) {
    const auto succeeded = KAZ_TRY(run_on_hosts(c, {a.hosts, a.hosts_tasks, command_words()}));
    return Outcome(succeeded);
  }
  const auto succeeded = KAZ_TRY(evaluate_watched(watch, c));
  return Outcome(succeeded);
}

// Errors: options before `merge`, which are of episodes to be run.
Result<void> check_nothing_given(const CLI::App& evaluate) {
  for (const CLI::Option* option : evaluate.get_options()) {
    if (option->count() > 0)
      return fail(Fault::usage, option->get_name() +
                                    " before merge: it runs no episode; leave it out, or give what "
                                    "is merge's (--out, --json) behind it");
  }
  return {};
}

void add_merge(CLI::App& evaluate, Action& action) {
  auto* verb = evaluate.add_subcommand("merge", "join the parts of an evaluation");
  struct Merge {
    std::vector<std::string> folders;
    std::string out;
    bool json = false;
  };
  auto arguments = std::make_shared<Merge>();
  verb->add_option("DIR", arguments->folders, "folders of the parts")->required()->type_name("");
  verb->add_option("--out", arguments->out, "folder for the whole")->required()->type_name("DIR");
  verb->add_flag("--json", arguments->json, "print result.json");
  verb->footer(
      "Parts are those of one evaluation: the same options but for --shard, --jobs and --out; "
      "others are refused, also those of another --episodes. "
      "Episodes that are missing, as a part is not there or was interrupted, are named; "
      "result.json "
      "is then of the others and contains \"interrupted\": true.\n"
      "Exit status: 0 at least one episode succeeded, 1 none did, 2 wrong usage, 3 episodes are "
      "missing.\n"
      "Examples:\n"
      "  kaz evaluate search-ball --episodes 8 --shard 1/2 --out one\n"
      "  kaz evaluate search-ball --episodes 8 --shard 2/2 --out two\n"
      "  kaz evaluate merge one two --out all");
  verb->callback([&action, &evaluate, arguments] {
    action = [&evaluate, arguments]() -> Result<Outcome> {
      KAZ_TRY(check_nothing_given(evaluate));
      const auto succeeded =
          KAZ_TRY(merge_campaigns(arguments->folders, arguments->out, arguments->json));
      return Outcome(succeeded);
    };
  });
}

}  // namespace

void add_evaluate(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand("evaluate",
                                      "run a behaviour in many random worlds and count successes");
  auto arguments = std::make_shared<Arguments>();
  CampaignOptions& c = arguments->campaign;
  c.backend.eyes = sim::EyeKind::real;
  c.backend.imu = true;
  // The virtual robot of kaz run, but for what each episode draws or fixes.
  add_sim_options(*verb, c.backend);
  verb->get_option("--eyes")->description(verb->get_option("--eyes")->get_description() +
                                          " (none is the default of these)");
  for (const char* fixed : {"--world", "--robot-file", "--image", "--faults", "--dynamics",
                            "--physics-step", "--supply", "--eye-width", "--seed"})
    verb->remove_option(verb->get_option(fixed));
  verb->add_option("BEHAVIOUR", c.behavior,
                   "(required) as of kaz run: a name, or a plug-in (./NAME.so)")
      ->type_name("");
  verb->add_option("--episodes", c.episodes, "how many, of all parts")
      ->check(between(1, 1000000))
      ->capture_default_str();
  verb->add_option("--seed", c.seed, "of what differs; the same seed gives the same episodes")
      ->transform(whole_number())
      ->type_name("N")
      ->capture_default_str();
  verb->add_option("--jobs", c.jobs, "episodes at the same time")
      ->check(between(1, 256))
      ->capture_default_str();
  verb->add_option("--out", c.out,
                   "(required) folder for result.json, episodes.csv, junit.xml and recordings of "
                   "failures; the same "
                   "command goes on where it was interrupted")
      ->type_name("DIR");
  verb->add_option("--shard", arguments->shard,
                   "part I of N: independent, repeatable, to be merged")
      ->type_name("I/N")
      ->capture_default_str();
  add_settings(*verb, arguments->settings, "an option of the behaviour (kaz run NAME --help)");
  const Variation& v = c.variation;
  add_interval(*verb, "--friction", arguments->friction, v.friction, {0.01, 10},
               "friction coefficient of the floor, drawn from this range");
  add_interval(*verb, "--supply", arguments->supply, v.supply_volts, {kMinSupply_v, kMaxSupply_v},
               "supply of the board, V, drawn from this range", "V");
  add_interval(*verb, "--ball-distance", arguments->distance, v.ball_distance_m, {0.05, 20},
               "distance of the ball from the feet, m, drawn from this range", "m");
  verb->add_option("--bearing", c.variation.bearing_deg,
                   "largest angle between the ball, or a goal, and straight ahead, degrees")
      ->check(between(0.0, 180.0))
      ->capture_default_str()
      ->type_name("DEGREES");
  add_list(*verb, "--radii", c.variation.radii_m, "radii of balls, m, with commas between")
      ->check(between(0.005, 0.5, "m"));
  add_list(*verb, "--colors", c.variation.colors,
           "colours of balls, with commas between: red, green, blue");
  add_list(*verb, "--floors", c.variation.floors,
           "patterns of floors, with commas between: wood, carpet, checker, plain");
  add_interval(
      *verb, "--props", arguments->props, v.props, {0, 20},
      "so many boxes, cans and large balls stand about, drawn from this range, every third "
      "of the ball's colour; none on the straight way to the ball");
  add_interval(*verb, "--lamp", arguments->lamp, v.lamp, {0.01, 100},
               "factor on the light of the lamp, drawn from this range; the lamp stands anywhere "
               "around, 35 to 80 degrees up");
  add_interval(*verb, "--shade", arguments->shade, v.shade, {0.01, 100},
               "factor on the light where the lamp does not reach, drawn from this range");
  std::string kinds;
  for (const WorldKindInfo& info : world_kinds())
    kinds += (kinds.empty() ? "" : ", ") + std::string(info.name);
  add_list(
      *verb, "--worlds", arguments->worlds,
      "of navigate: kinds of worlds, with commas between, which the episodes have in turn: all, "
      "or of " +
          kinds);
  add_interval(*verb, "--density", arguments->density, v.density, {0, 1},
               "of navigate: how hard the worlds are, drawn from this range: more or narrower, "
               "0 to 1");
  verb->add_option(
          "--obstacles", c.variation.max_obstacles,
          "of navigate: up to so many boxes and cans stand about in worlds with clutter, at least "
          "half as many")
      ->check(between(0, 30))
      ->type_name("N")
      ->capture_default_str();
  add_interval(
      *verb, "--goal-distance", arguments->goal_distance, v.goal_distance_m, {0.3, 2.5},
      "of navigate, without --set goal=X,Y: distance of the goal, m, drawn from this range", "m");
  verb->add_option("--mass-sigma", c.variation.mass_sigma,
                   "standard deviation of each link's mass, as a share of it")
      ->check(between(0.0, 0.3))
      ->capture_default_str();
  Pushes& pushes = c.variation.pushes;
  auto* push = verb->add_option("--push", pushes.impulse_ns,
                                "pushes on the trunk, of so many N s each (default: none)")
                   ->check(between(0.01, 5.0, "N s"))
                   ->type_name("NS");
  add_choice(*verb, "--push-to", kPushTo, pushes.to,
             "where they go; sides, around: drawn for each push")
      ->needs(push);
  verb->add_option("--push-from", pushes.from_s,
                   "when the first one is, s since the robot's first step; of stand, get-up, "
                   "search-ball and track-ball since the start (there 1 by default)")
      ->check(between(0.0, 600.0, "s"))
      ->capture_default_str()
      ->type_name("S")
      ->needs(push);
  verb->add_option("--push-every", pushes.every_s, "time between them, s")
      ->check(between(0.1, 600.0, "s"))
      ->capture_default_str()
      ->type_name("S")
      ->needs(push);
  verb->add_flag("--calibrated", c.calibrated,
                 "of --sensors as-built: each robot's joints are calibrated before, as by kaz "
                 "calibrate joints");
  verb->add_option("--judge", c.judged_as,
                   "of a plug-in: the behaviour of Kaz that it is judged as; else it may not fall, "
                   "and its own word counts")
      ->type_name("NAME");
  verb->add_flag("--realtime", c.realtime,
                 "in real time, kaz sim and kaz run as processes of their own with a pty between "
                 "them; needs two processors for each job");
  auto* slurm =
      verb->add_option("--slurm", arguments->slurm_tasks,
                       "run it on a Slurm cluster, as a job array of so many tasks; DIR is on a "
                       "disk that all nodes have, and so is kaz; --jobs are the processors of a "
                       "task")
          ->check(between(1, 100000))
          ->type_name("TASKS");
  verb->add_option("--sbatch", arguments->sbatch,
                   "options for sbatch, in one text: \"--partition=day --time=60\"")
      ->needs(slurm)
      ->type_name("OPTIONS");
  auto* hosts =
      verb->add_option("--parallel-hosts", arguments->hosts,
                       "run it on the machines of this file by GNU parallel, a line each: :, "
                       "which is this one, or what ssh takes, with 8/ before it for 8 "
                       "processors; they have DIR and kaz at the same place")
          ->type_name("FILE");
  verb->add_option("--parallel-tasks", arguments->hosts_tasks,
                   "in so many parts; by default 100, or an episode each")
      ->check(between(1, 100000))
      ->needs(hosts)
      ->type_name("TASKS");
  hosts->excludes(slurm);
  for (const char* other : {"--shard", "--realtime"})
    verb->get_option(other)->excludes(slurm)->excludes(hosts);
  verb->add_flag("--json", c.json, "print result.json, no progress");
  auto watch = std::make_shared<WatchArguments>();
  add_watch_options(*verb, *watch);
  verb->get_option("--view")->excludes(slurm)->excludes(hosts);
  verb->footer(
      "Each episode has its own robot (masses, sensors), floor (friction, pattern), start, light, "
      "supply and ball (place, radius, colour), all from --seed and the episode's number. Success "
      "is judged by the simulator's truth alone; what the behaviour claims is compared with it. "
      "An episode of catch-ball takes some 15 s on one processor, with --realtime 50 s.\n" +
      std::string(kExitStatus) +
      "Examples:\n"
      "  kaz evaluate search-ball --episodes 20 --jobs 2 --out searched\n"
      "  kaz evaluate catch-ball --episodes 5 --out caught --pace 1 --view   # in a browser\n"
      "  kaz evaluate ./wave.so --episodes 4 --out waved\n"
      "  kaz evaluate ./my_catch.so --judge catch-ball --episodes 20 --out mine\n"
      "  kaz evaluate catch-ball --props 3 10 --floors wood,plain --lamp 0.03 0.12 --shade 0.03 "
      "0.12 --out dark\n"
      "  kaz evaluate catch-ball --sensors as-built --calibrated --episodes 20 --out built\n"
      "  kaz evaluate catch-ball --realtime --episodes 10 --out live\n"
      "  kaz evaluate navigate --episodes 20 --seed 3 --jobs 2 --out walked\n"
      "  kaz evaluate navigate --worlds all --episodes 120 --mcu native --out kinds\n"
      "  kaz evaluate navigate --worlds corridor,u-trap --density 0.7 1 --episodes 10 --out "
      "narrow\n"
      "  kaz evaluate navigate --worlds moving-box --episodes 400 --mcu native --out moving\n"
      "  kaz evaluate stand --mcu native --episodes 10000 --slurm 100 --out stood\n"
      "  kaz evaluate stand --mcu native --episodes 10000 --parallel-hosts hosts.txt --out stood\n"
      "  kaz evaluate navigate --set goal=ball --obstacles 4 --episodes 10 --out caught\n"
      "  kaz evaluate track-ball --set seconds=5 --episodes 10 --mcu native --out tracked --json");
  verb->callback([&action, arguments, watch, verb] {
    if (!verb->get_subcommands().empty()) return;
    action = [arguments, watch, verb]() -> Result<Outcome> {
      if (arguments->campaign.behavior.empty())
        return fail(Fault::usage,
                    "say which behaviour, as in kaz evaluate search-ball --out found");
      if (arguments->campaign.out.empty())
        return fail(Fault::usage, "--out is missing: the folder for what is found");
      return start(*arguments, *watch, given_options(*verb));
    };
  });
  add_merge(*verb, action);
}

}  // namespace kaz::tools

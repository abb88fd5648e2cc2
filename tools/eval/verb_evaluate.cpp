// `kaz evaluate`: many episodes of a behavior, and how many succeed.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <sstream>

#include "host/behavior/plugin.h"
#include "tools/base/arguments.h"
#include "tools/base/provenance.h"
#include "tools/cli/options.h"
#include "tools/cli/verbs.h"
#include "tools/cli/watch_options.h"
#include "tools/eval/campaign.h"
#include "tools/eval/given_options.h"
#include "tools/eval/hosts.h"
#include "tools/eval/slurm.h"

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
    "Exit status: 0 at least one episode succeeded, 1 no episode succeeded, 2 wrong usage, 3 at "
    "least one episode has no result because the machine failed (disk, port, process).\n";

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
  return fail(Fault::usage, option + ": a value is in the list twice; give each value once");
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
                                ": must be at most the number of --episodes (" +
                                std::to_string(episodes) + ")");
}

Result<ExitStatus> start(Arguments a, const WatchArguments& watch,
                         const std::vector<std::string>& options) {
  CampaignOptions& c = a.campaign;
  auto settings = KAZ_TRY(parse_settings(a.settings));
  KAZ_TRY(behavior::load_settings(c.behavior, settings));
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
      return fail(Fault::usage, "--floors " + floor + ": give wood, carpet, checker or plain");
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
                "give --set balance=none");
  if (const auto judged = c.judged_behavior(); judged && !judged->evaluation.walks) {
    c.variation.pushes.from_first_step = false;
    if (std::ranges::count(options, "--push-from") == 0) c.variation.pushes.from_s = 1;
  }
  // Drawing pictures is most of an episode's time: none for who does not look.
  if (std::ranges::count(options, "--eyes") == 0 &&
      !KAZ_TRY(behavior::named_behavior(c.behavior)).needs_camera)
    c.backend.eyes = sim::EyeKind::none;
  KAZ_TRY(check_tasks("--slurm", a.slurm_tasks, c.episodes));
  KAZ_TRY(check_tasks("--parallel-tasks", a.hosts_tasks, c.episodes));
  if (a.slurm_tasks > 0) {
    SlurmOptions slurm{a.slurm_tasks, {}, command_words()};
    std::istringstream words(a.sbatch);
    for (std::string word; words >> word;) slurm.submit.push_back(word);
    const auto succeeded = KAZ_TRY(run_on_slurm(c, slurm));
    return ExitStatus(succeeded);
  }
  if (!a.hosts.empty()) {
    const auto succeeded = KAZ_TRY(run_on_hosts(c, {a.hosts, a.hosts_tasks, command_words()}));
    return ExitStatus(succeeded);
  }
  const auto succeeded = KAZ_TRY(evaluate_watched(watch, c));
  return ExitStatus(succeeded);
}

// Errors: options before `merge`, which are of episodes to be run.
Result<void> check_nothing_given(const CLI::App& evaluate) {
  for (const CLI::Option* option : evaluate.get_options()) {
    if (option->count() > 0)
      return fail(Fault::usage, option->get_name() +
                                    " is not valid before merge, because merge runs no episode; "
                                    "give --out and --json after merge, and leave out other "
                                    "options");
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
  verb->add_option("--out", arguments->out, "folder for the complete evaluation")
      ->required()
      ->type_name("DIR");
  verb->add_flag("--json", arguments->json, "print result.json");
  verb->footer(
      "All parts must have the same options, except --shard, --jobs and --out. If a part of the "
      "evaluation is missing or was interrupted, Kaz lists the missing episodes. result.json then "
      "covers only the completed episodes and contains \"interrupted\": true.\n"
      "Exit status: 0 at least one episode succeeded, 1 no episode succeeded, 2 wrong usage, 3 at "
      "least one episode is missing.\n"
      "Examples:\n"
      "  kaz evaluate search-ball --episodes 8 --shard 1/2 --out one\n"
      "  kaz evaluate search-ball --episodes 8 --shard 2/2 --out two\n"
      "  kaz evaluate merge one two --out all");
  verb->callback([&action, &evaluate, arguments] {
    action = [&evaluate, arguments]() -> Result<ExitStatus> {
      KAZ_TRY(check_nothing_given(evaluate));
      const auto succeeded =
          KAZ_TRY(merge_campaigns(arguments->folders, arguments->out, arguments->json));
      return ExitStatus(succeeded);
    };
  });
}

// Adds the options of the virtual robot, the episodes and their parts.
void add_campaign_options(CLI::App& verb, Arguments& arguments) {
  CampaignOptions& c = arguments.campaign;
  // The virtual robot of kaz run, but for what each episode draws or fixes.
  add_sim_options(verb, c.backend);
  verb.get_option("--eyes")->description(verb.get_option("--eyes")->get_description() +
                                         " (the default for such behaviors)");
  for (const char* fixed : {"--world", "--robot-file", "--mesh-collision", "--skip-missing-meshes",
                            "--strict", "--verbose", "--image", "--faults", "--dynamics",
                            "--physics-step", "--supply", "--eye-width", "--seed"})
    verb.remove_option(verb.get_option(fixed));
  verb.add_option("BEHAVIOR", c.behavior,
                  "(required) behavior, as in kaz run: a name, or a plug-in (./NAME.so)")
      ->type_name("");
  verb.add_option("--episodes", c.episodes, "number of episodes, in all parts together")
      ->check(between(1, 1000000))
      ->capture_default_str();
  verb.add_option("--seed", c.seed,
                  "seed of all random choices; the same seed gives the same episodes")
      ->transform(whole_number())
      ->type_name("N")
      ->capture_default_str();
  verb.add_option("--jobs", c.jobs, "number of episodes that run in parallel")
      ->check(between(1, 256))
      ->capture_default_str();
  verb.add_option("--out", c.out,
                  "(required) folder for result.json, episodes.csv, junit.xml and recordings of "
                  "failures; the same command continues an interrupted evaluation")
      ->type_name("DIR");
  verb.add_option("--shard", arguments.shard,
                  "run only part I of N; kaz evaluate merge joins the parts")
      ->type_name("I/N")
      ->capture_default_str();
  add_settings(verb, arguments.settings, "an option of the behavior (kaz run NAME --help)");
}

// Adds the options of the choices that each episode draws.
void add_variation_options(CLI::App& verb, Arguments& arguments) {
  Variation& v = arguments.campaign.variation;
  add_interval(verb, "--friction", arguments.friction, v.friction, {0.01, 10},
               "friction coefficient of the floor, drawn from this range");
  add_interval(verb, "--supply", arguments.supply, v.supply_volts,
               {sim::kMinSupply_v, sim::kMaxSupply_v},
               "supply of the board, V, drawn from this range", "V");
  add_interval(verb, "--ball-distance", arguments.distance, v.ball_distance_m, {0.05, 20},
               "distance of the ball from the feet, m, drawn from this range", "m");
  verb.add_option(
          "--bearing", v.bearing_deg,
          "maximum bearing of the ball or the goal, degrees. The bearing is the angle to the left "
          "or right of the direction straight ahead")
      ->check(between(0.0, 180.0, "degrees"))
      ->capture_default_str()
      ->type_name("DEGREES");
  add_list(verb, "--radii", v.radii_m, "radii of balls, m, separated by commas")
      ->check(between(0.005, 0.5, "m"));
  add_list(verb, "--colors", v.colors, "colors of balls, separated by commas: red, green, blue");
  add_list(verb, "--floors", v.floors,
           "patterns of floors, separated by commas: wood, carpet, checker, plain");
  add_interval(
      verb, "--props", arguments.props, v.props, {0, 20},
      "number of boxes, cans and large balls in the world, drawn from this range. Every third "
      "object has the ball's color, and no object is on the straight path to the ball");
  add_interval(verb, "--lamp", arguments.lamp, v.lamp, {0.01, 100},
               "factor for the brightness of the lamp, drawn from this range; the lamp is in a "
               "random direction, at an elevation of 35 to 80 degrees");
  add_interval(verb, "--shade", arguments.shade, v.shade, {0.01, 100},
               "factor for the brightness of shadows, drawn from this range");
  std::string kinds;
  for (const WorldKindInfo& info : world_kinds())
    kinds += (kinds.empty() ? "" : ", ") + std::string(info.name);
  add_list(verb, "--worlds", arguments.worlds,
           "only with " + course_behaviors() +
               ": kinds of worlds, separated by commas; the episodes use the kinds "
               "in turn. Give the word 'all', or names from this list: " +
               kinds);
  add_interval(verb, "--density", arguments.density, v.density, {0, 1},
               "only with " + course_behaviors() +
                   ": difficulty of the worlds, drawn from this range; a higher "
                   "difficulty means more obstacles or narrower gaps");
  verb.add_option(
          "--obstacles", v.max_obstacles,
          "only with " + course_behaviors() +
              ": maximum number of boxes and cans in the worlds 'clutter', "
              "'patterned-floor', 'plain-floor' and 'dark'. The world 'two-balls' has at most "
              "N / 2 boxes and cans. In all five worlds, the minimum number of boxes and cans "
              "is half of their maximum number")
      ->check(between(0, 30))
      ->type_name("N")
      ->capture_default_str();
  add_interval(
      verb, "--goal-distance", arguments.goal_distance, v.goal_distance_m, {0.3, 2.5},
      "distance from the robot's start to the goal, m, drawn from this range. The option is only "
      "valid with " +
          course_behaviors() + ". The option is not valid with --set goal=X,Y",
      "m");
  verb.add_option("--mass-sigma", v.mass_sigma,
                  "standard deviation of each link's mass, as a fraction of the mass")
      ->check(between(0.0, 0.3))
      ->capture_default_str();
}

void add_push_options(CLI::App& verb, Pushes& pushes) {
  auto* push = verb.add_option("--push", pushes.impulse_ns,
                               "impulse of each push on the trunk, N s (default: no pushes)")
                   ->check(between(0.01, 5.0, "N s"))
                   ->type_name("NS");
  add_choice(verb, "--push-to", kPushTo, pushes.to,
             "direction of the pushes, as seen by the robot at its start. With 'sides', each push "
             "goes at random to the left or right. With 'around', each push has a random direction")
      ->needs(push);
  verb.add_option(
          "--push-from", pushes.from_s,
          "time from the robot's first step to the first push. For the behaviors 'stand', "
          "'get-up', 'search-ball' and 'track-ball', the time counts from the start of the run, "
          "and the default is 1 s")
      ->check(between(0.0, 600.0, "s"))
      ->capture_default_str()
      ->type_name("S")
      ->needs(push);
  verb.add_option("--push-every", pushes.every_s, "time between pushes, s")
      ->check(between(0.1, 600.0, "s"))
      ->capture_default_str()
      ->type_name("S")
      ->needs(push);
}

// Adds the options of Slurm and GNU parallel.
void add_cluster_options(CLI::App& verb, Arguments& arguments) {
  auto* slurm =
      verb.add_option(
              "--slurm", arguments.slurm_tasks,
              "run on a Slurm cluster, as a job array with this number of tasks. The folder "
              "of --out and the program kaz must be on a disk that all nodes share. --jobs is the "
              "number of processors for each task")
          ->check(between(1, 100000))
          ->type_name("TASKS");
  verb.add_option("--sbatch", arguments.sbatch,
                  "options for sbatch, as one argument, such as \"--partition=day --time=60\"")
      ->needs(slurm)
      ->type_name("OPTIONS");
  auto* hosts =
      verb.add_option(
              "--parallel-hosts", arguments.hosts,
              "run with GNU parallel, on the machines that this file lists. Each line names one "
              "machine: an ssh destination, or ':' for this machine. To use 8 processors of a "
              "machine, put 8/ before its name, as in 8/lab1. DIR and kaz must have the same paths "
              "on all machines")
          ->type_name("FILE");
  verb.add_option("--parallel-tasks", arguments.hosts_tasks,
                  "number of parts (default: 100, or the number of episodes if that is smaller)")
      ->check(between(1, 100000))
      ->needs(hosts)
      ->type_name("TASKS");
  hosts->excludes(slurm);
  for (const char* other : {"--shard", "--realtime"})
    verb.get_option(other)->excludes(slurm)->excludes(hosts);
}

}  // namespace

void add_evaluate(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand("evaluate",
                                      "run a behavior in many random worlds and count successes");
  auto arguments = std::make_shared<Arguments>();
  CampaignOptions& c = arguments->campaign;
  c.backend.eyes = sim::EyeKind::real;
  c.backend.imu = true;
  add_campaign_options(*verb, *arguments);
  add_variation_options(*verb, *arguments);
  add_push_options(*verb, c.variation.pushes);
  verb->add_flag("--calibrated", c.calibrated,
                 "with --sensors as-built: calibrate each robot's joints before the episode, as "
                 "kaz calibrate joints does");
  verb->add_option("--judge", c.judged_as,
                   "for a plug-in: apply the success criterion of the built-in behavior NAME. "
                   "Without --judge, an episode succeeds if the plug-in reports success and the "
                   "robot does not fall")
      ->type_name("NAME");
  verb->add_flag("--realtime", c.realtime,
                 "run in real time, with kaz sim and kaz run as separate processes connected by a "
                 "pty; needs two processors for each job");
  add_cluster_options(*verb, *arguments);
  verb->add_flag("--json", c.json, "print result.json, without progress messages");
  auto watch = std::make_shared<WatchArguments>();
  add_watch_options(*verb, *watch);
  for (const char* cluster : {"--slurm", "--parallel-hosts"})
    verb->get_option("--view")->excludes(verb->get_option(cluster));
  verb->footer(
      "Each episode has its own robot (masses, sensors), floor (friction, pattern), start, light, "
      "supply and ball (place, radius, color). These random choices depend only on --seed and the "
      "episode's number. Only the simulator's ground truth decides success; the behavior's own "
      "result is compared with the ground truth. An episode of catch-ball takes about 15 s on one "
      "processor, or 50 s with --realtime.\n" +
      std::string(kExitStatus) +
      "Examples:\n"
      "  kaz evaluate search-ball --episodes 20 --jobs 2 --out searched\n"
      "  kaz evaluate catch-ball --episodes 5 --out caught --pace 1 --view   # in a browser\n"
      "  kaz evaluate ./wave.so --episodes 4 --out waved\n"
      "  kaz evaluate ./my_catch.so --judge catch-ball --episodes 20 --out mine\n"
      "  kaz evaluate catch-ball --props 3 10 --floors wood,plain --lamp 0.03 0.12 --shade 0.03 "
      "0.12 \\\n      --out dark\n"
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
    action = [arguments, watch, verb]() -> Result<ExitStatus> {
      if (arguments->campaign.behavior.empty())
        return fail(
            Fault::usage,
            "BEHAVIOR is missing; give a behavior, as in kaz evaluate search-ball --out results");
      if (arguments->campaign.out.empty())
        return fail(Fault::usage,
                    "--out is missing; give a folder for the results, as in --out results");
      return start(*arguments, *watch, given_options(*verb));
    };
  });
  add_merge(*verb, action);
}

}  // namespace kaz::tools

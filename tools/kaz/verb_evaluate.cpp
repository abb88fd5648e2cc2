// `kaz evaluate`: many episodes of a behaviour, and how many succeed.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/base/arguments.h"
#include "tools/app/evaluate/campaign.h"
#include "tools/kaz/options.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {
namespace {

struct Arguments {
  CampaignOptions campaign;
  std::vector<std::string> settings;
  std::string shard = "1/1";
  std::vector<double> friction, supply, distance, lamp, shade;
  bool blind_to_turns = false;
};

Result<Outcome> start(Arguments a) {
  CampaignOptions& c = a.campaign;
  const auto settings = KAZ_TRY(parse_settings(a.settings));
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
                   {"--shade", a.shade, c.variation.shade}};
  for (const auto& [option, given, to] : intervals) {
    const auto interval = KAZ_TRY(parse_interval(option, given, to));
    to = interval;
  }
  for (const std::string& color : c.variation.colors) {
    KAZ_TRY(ball_color(color));
  }
  c.backend.imu = !a.blind_to_turns;
  const auto succeeded = KAZ_TRY(run_campaign(c));
  return Outcome(succeeded);
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
      "Parts are those of one evaluation: the same options but for --shard, --jobs and --out.\n"
      "Examples:\n"
      "  kaz evaluate search-ball --episodes 8 --shard 1/2 --out one\n"
      "  kaz evaluate search-ball --episodes 8 --shard 2/2 --out two\n"
      "  kaz evaluate merge one two --out all");
  verb->callback([&action, arguments] {
    action = [arguments]() -> Result<Outcome> {
      const auto succeeded =
          KAZ_TRY(merge_campaigns(arguments->folders, arguments->out, arguments->json));
      return Outcome(succeeded);
    };
  });
}

}  // namespace

void add_evaluate(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "evaluate",
      "many episodes of a behaviour on robots and worlds that differ; how many succeed");
  auto arguments = std::make_shared<Arguments>();
  CampaignOptions& c = arguments->campaign;
  c.backend.eyes = sim::EyeKind::real;
  verb->add_option("BEHAVIOUR", c.behavior, "as of kaz run: a name, or a plug-in (./NAME.so)")
      ->type_name("");
  verb->add_option("--episodes", c.episodes, "how many")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  verb->add_option("--seed", c.seed, "of what differs; the same seed gives the same episodes")
      ->check(CLI::Range(0ull, 1000000000000ull))
      ->capture_default_str();
  verb->add_option("--jobs", c.jobs, "episodes at the same time")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  verb->add_option("--out", c.out,
                   "folder for result.json, episodes.csv and recordings of failures; the same "
                   "command goes on where it was interrupted")
      ->type_name("DIR");
  verb->add_option("--shard", arguments->shard,
                   "part I of N: independent, repeatable, to be merged")
      ->type_name("I/N")
      ->capture_default_str();
  verb->add_option("--set", arguments->settings, "an option of the behaviour: NAME=VALUE")
      ->type_name("NAME=VALUE");
  verb->add_option("--friction", arguments->friction, "of the floor, from and to (0.6 0.8)")
      ->expected(2)
      ->type_name("NUMBER");
  verb->add_option("--supply", arguments->supply, "volts, from and to (9.5 10.5)")
      ->expected(2)
      ->type_name("NUMBER");
  verb->add_option("--ball-distance", arguments->distance, "m from the feet, from and to (0.3 0.8)")
      ->expected(2)
      ->type_name("NUMBER");
  verb->add_option("--bearing", c.variation.bearing_deg,
                   "of the ball, degrees to either side of straight ahead at most")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  verb->add_option("--radii", c.variation.radii_m, "of balls, m")
      ->check(CLI::Range(0.005, 0.5))
      ->capture_default_str();
  verb->add_option("--colors", c.variation.colors, "of balls: red, green, blue")
      ->capture_default_str();
  verb->add_option(
          "--lamp", arguments->lamp,
          "factor on the light of the lamp, from and to (0.5 1.3); it stands anywhere around, "
          "35 to 80 degrees up")
      ->expected(2)
      ->type_name("NUMBER");
  verb->add_option("--shade", arguments->shade,
                   "factor on the light where the lamp does not reach, from and to (0.6 1.3)")
      ->expected(2)
      ->type_name("NUMBER");
  verb->add_option("--mass-sigma", c.variation.mass_sigma, "of each link's mass, as a share of it")
      ->check(CLI::Range(0.0, 0.3))
      ->capture_default_str();
  add_choice(*verb, "--mcu", sim::kMcuKinds, c.backend.mcu,
             "microcontroller of the servo board: h8 or native");
  add_choice(*verb, "--eyes", sim::kEyeKinds, c.backend.eyes, "ideal or real");
  add_choice(*verb, "--sensors", sim::kSensorSets, c.backend.sensors, "nominal, ideal or as-built");
  verb->add_flag("--realtime", c.realtime,
                 "in real time, kaz sim and kaz run as processes of their own with a pty between "
                 "them; wants two processors for each job");
  verb->add_flag("--no-imu", arguments->blind_to_turns, "a board without gyro and accelerometer");
  verb->add_flag("--json", c.json, "print result.json, no progress");
  verb->footer(
      "Each episode has its own robot (masses, sensors), floor (friction, pattern), start, light, "
      "supply and ball\n(place, radius, colour), all from --seed and the episode's number. Success "
      "is judged "
      "by the simulator's truth:\nno fall, and what the behaviour claims is so.\n"
      "Exit status: 0; 1 where no episode succeeded.\n"
      "Examples:\n"
      "  kaz evaluate search-ball --episodes 20 --jobs 2 --out searched\n"
      "  kaz evaluate ./wave.so --episodes 4 --out waved\n"
      "  kaz evaluate catch-ball --realtime --episodes 10 --out live\n"
      "  kaz evaluate track-ball --set seconds=5 --episodes 10 --mcu native --out tracked --json");
  verb->callback([&action, arguments, verb] {
    if (!verb->get_subcommands().empty()) return;
    action = [arguments]() -> Result<Outcome> {
      if (arguments->campaign.behavior.empty())
        return fail(Fault::usage,
                    "say which behaviour, as in kaz evaluate search-ball --out found");
      if (arguments->campaign.out.empty())
        return fail(Fault::usage, "--out is missing: the folder for what is found");
      return start(*arguments);
    };
  });
  add_merge(*verb, action);
}

}  // namespace kaz::tools

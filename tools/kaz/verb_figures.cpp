// `kaz figures`: the paper's figures, each of one run of the virtual robot.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "tools/app/figures/figures.h"
#include "tools/kaz/options.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {
namespace {

// What has no effect on figures of a recording, which has its own.
constexpr const char* kOfRuns[] = {"--world", "--goal",      "--yard",     "--mcu",
                                   "--image", "--sensors",   "--imu",      "--no-imu",
                                   "--eyes",  "--eye-width", "--renderer", "--seed"};

// Errors: an option of figures that --only leaves out.
Result<void> check_drawn(const CLI::App& verb, const std::vector<int>& only) {
  const std::pair<const char*, std::vector<int>> kOf[] = {{"--world", {5, 6}},
                                                          {"--goal", {5, 6}},
                                                          {"--yard", {7}},
                                                          {"--imu", {3, 5, 6, 8}},
                                                          {"--no-imu", {3, 5, 6, 8}}};
  for (const auto& [option, figures] : kOf) {
    const bool drawn = only.empty() || std::ranges::any_of(figures, [&only](int figure) {
                         return std::ranges::count(only, figure) > 0;
                       });
    if (verb.count(option) > 0 && !drawn)
      return fail(Fault::usage, std::string(option) + " is only valid with figure" +
                                    (figures.size() == 1   ? " 7"
                                     : figures.size() == 2 ? "s 5 and 6"
                                                           : "s 3, 5, 6 and 8") +
                                    ", which --only leaves out; leave " + option + " out too");
  }
  return {};
}

}  // namespace

void add_figures(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand("figures", "draw the paper's figures, each from one run");
  auto options = std::make_shared<FiguresOptions>();
  auto only = std::make_shared<std::vector<int>>();
  options->backend.world = "boxes";
  options->backend.eyes = sim::EyeKind::real;
  options->backend.imu = true;
  std::vector<std::string> numbers;
  for (const int number : figure_numbers()) numbers.push_back(std::to_string(number));
  verb->add_option("--out", options->out,
                   "folder for the figures, figures.html, result.json and the runs")
      ->type_name("DIR")
      ->capture_default_str();
  verb->add_option("--only", *only, "draw only these figures, separated by commas")
      ->delimiter(',')
      ->check(CLI::IsMember(numbers).description(""))
      ->type_name(CLI::detail::join(numbers, "|"))
      ->expected(1)
      ->allow_extra_args(false)
      ->take_all();
  verb->add_option("--recording", options->recording,
                   "recording.mcap of your own run. Kaz repeats the run with the recorded seed, "
                   "and draws the figures from the repeated run")
      ->type_name("FILE");
  verb->add_option("--goal", options->goal,
                   "goal of the run in figures 5 and 6; the same values are valid as for --goal of "
                   "`kaz run navigate`")
      ->type_name("X,Y[,DEGREES]|ball")
      ->capture_default_str();
  verb->add_option("--yard", options->yard, "world of figure 7, with boxes on a floor")
      ->type_name("NAME|FILE")
      ->capture_default_str();
  add_sim_options(*verb, options->backend);
  for (const char* useless :
       {"--robot-file", "--faults", "--supply", "--dynamics", "--physics-step"})
    verb->remove_option(verb->get_option(useless));
  verb->get_option("--world")->description(
      "world of figures 5 and 6, with a ball behind obstacles");
  verb->add_flag("--json", options->json,
                 "print result.json on standard output, without progress messages");
  verb->footer(
      "Figure 3 shows a run of track-ball. Figures 5 and 6 show navigate, figure 7 shows a sweep "
      "of the head, and figure 8 shows catch-ball. kaz figures does not draw figures 1, 2 and 4, "
      "because they show no run. Drawing all "
      "figures takes a few minutes. Each run has its own folder, such as DIR/navigate, which "
      "contains the recording (about 1.3 MB per second).\n"
      "Exit status: 0 all requested figures were drawn; 1 a run failed, or a run has too few data "
      "for a figure. Even if one figure cannot be drawn, Kaz draws the other figures.\n"
      "Examples:\n"
      "  kaz figures\n"
      "  kaz figures --only 3,6 --seed 7 --out seven\n"
      "  kaz figures --only 7 --mcu native --json\n"
      "  kaz run navigate --goal 0.6,-0.15 --world boxes --eyes real --imu --out there\n"
      "  kaz figures --recording there/recording.mcap --out drawn");
  verb->callback([&action, options, only, verb] {
    action = [options, only, verb]() -> Result<Outcome> {
      options->only = {only->begin(), only->end()};
      for (const char* option : kOfRuns) {
        if (!options->recording.empty() && verb->count(option) > 0)
          return fail(Fault::usage, std::string(option) +
                                        " is set by the recording; leave it out with --recording");
      }
      KAZ_TRY(check_drawn(*verb, *only));
      return make_figures(*options);
    };
  });
}

}  // namespace kaz::tools

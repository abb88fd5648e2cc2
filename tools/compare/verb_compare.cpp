// `kaz compare`: two recordings side by side, and what differs.
// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tools/cli/options.h"
#include "tools/cli/verbs.h"
#include "tools/compare/compare.h"

namespace kaz::tools {

void add_compare(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "compare", "compare the joints, supply, link and pictures of two recordings");
  auto arguments = std::make_shared<CompareOptions>();
  verb->add_option("A", arguments->a, "recording.mcap of a run, or the run's folder")
      ->required()
      ->type_name("");
  verb->add_option("B", arguments->b, "the other recording")->required()->type_name("");
  verb->add_option("--out", arguments->out, "folder for report.html, plots and result.json")
      ->type_name("DIR");
  verb->add_flag("--all", arguments->all, "also print the measures that do not differ");
  verb->add_flag("--json", arguments->json, "print result.json, with all measures, instead of text")
      ->excludes("--all");
  verb->footer(
      "The recordings may come from a real and a virtual robot, or from runs before and after a "
      "change. The comparison uses only data that every recording contains: the messages on the "
      "serial line and the reports of the behavior. In each recording, Kaz measures how well "
      "each joint's angle follows the joint's command: lag, offset and scatter. Kaz compares these "
      "values of recording A with the values of recording B. Kaz also compares the supply, the "
      "link (such as round-trip times) and the pictures (such as their delays). A measure differs "
      "if two conditions are met: Welch's test rejects equality at the 0.1 % level, and the "
      "difference exceeds the measure's resolution.\n"
      "Exit status: 0 no measure differs, 1 a measure differs, 2 wrong usage.\n"
      "Examples:\n"
      "  kaz run go-forward --set distance=0.1 --mcu native --out before\n"
      "  kaz run go-forward --set distance=0.1 --mcu native --supply 8 --out weaker\n"
      "  kaz compare before weaker --out difference");
  verb->callback([&action, arguments] {
    action = [arguments]() -> Result<ExitStatus> {
      return ExitStatus(KAZ_TRY(compare_recordings(*arguments)));
    };
  });
}

}  // namespace kaz::tools

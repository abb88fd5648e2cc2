// `kaz compare`: two recordings side by side, and what differs.
// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tools/app/compare/compare.h"
#include "tools/kaz/options.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {

void add_compare(CLI::App& program, Action& action) {
  auto* verb =
      program.add_subcommand("compare", "compare two recordings: joints, supply, link, pictures");
  auto arguments = std::make_shared<CompareOptions>();
  verb->add_option("A", arguments->a, "recording.mcap of a run, or its folder")
      ->required()
      ->type_name("");
  verb->add_option("B", arguments->b, "the other recording")->required()->type_name("");
  verb->add_option("--out", arguments->out, "folder for report.html, its plots and result.json")
      ->type_name("DIR");
  verb->add_flag("--all", arguments->all, "print also the measures that do not differ");
  verb->add_flag("--json", arguments->json, "print result.json instead, with all measures")
      ->excludes("--all");
  verb->footer(
      "Compares a real robot with a virtual one, or runs before and after a change. Only data on "
      "the wire and reports of the behavior are used, which every recording has. Measures are each "
      "joint's lag, offset and scatter against its command, the supply, round trips, and delays of "
      "pictures. A measure differs if the difference is larger than the scatter within the runs "
      "can explain (Welch's test, 0.1 %).\n"
      "Exit status: 0 nothing differs, 1 a measure differs, 2 wrong usage.\n"
      "Examples:\n"
      "  kaz run go-forward --set distance=0.1 --mcu native --out before\n"
      "  kaz run go-forward --set distance=0.1 --mcu native --supply 8 --out weaker\n"
      "  kaz compare before weaker --out difference");
  verb->callback([&action, arguments] {
    action = [arguments]() -> Result<Outcome> {
      return Outcome(KAZ_TRY(compare_recordings(*arguments)));
    };
  });
}

}  // namespace kaz::tools

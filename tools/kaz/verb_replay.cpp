// `kaz replay`: runs a recording again and tells the first difference.
// SPDX-License-Identifier: Apache-2.0
#include "tools/kaz/replay.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {

void add_replay(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "replay", "run a recording of kaz run or kaz demo again and tell the first difference");
  struct Arguments {
    ReplayOptions replay;
    std::vector<std::string> settings;
  };
  auto arguments = std::make_shared<Arguments>();
  verb->add_option("FILE", arguments->replay.file, "recording.mcap of a run")
      ->required()
      ->type_name("");
  verb->add_option("--seed", arguments->replay.seed, "another seed than the recording's");
  verb->add_option("--set", arguments->settings, "another option of the behaviour: NAME=VALUE")
      ->type_name("NAME=VALUE");
  verb->add_flag("--json", arguments->replay.json, "print the result as JSON on standard output");
  verb->footer(
      "Host and simulation run again with the recording's options, and each message is compared.\n"
      "Exit status 0: identical; 1: they differ.\n"
      "Examples:\n"
      "  kaz replay kaz-demo/recording.mcap\n"
      "  kaz replay kaz-demo/recording.mcap --set seconds=5 --json");
  verb->callback([&action, arguments] {
    action = [arguments]() -> Result<Outcome> {
      for (const auto& setting : arguments->settings) {
        const auto equals = setting.find('=');
        if (equals == std::string::npos || equals == 0)
          return fail(Fault::usage,
                      "--set " + setting + ": give NAME=VALUE, as in --set seconds=20");
        arguments->replay.settings[setting.substr(0, equals)] = setting.substr(equals + 1);
      }
      const auto identical = replay(arguments->replay);
      if (!identical) return tl::unexpected(identical.error());
      return Outcome(*identical);
    };
  });
}

}  // namespace kaz::tools

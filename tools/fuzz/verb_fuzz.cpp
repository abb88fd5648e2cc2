// `kaz fuzz`: a hostile host against a board, and a judge beside it.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "tools/cli/options.h"
#include "tools/cli/verbs.h"
#include "tools/fuzz/campaign.h"

namespace kaz::tools {

void add_fuzz(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "fuzz", "send hostile requests to a board and check the board's motors and replies");
  auto arguments = std::make_shared<FuzzOptions>();
  verb->add_option("--target,--robot,--port", arguments->target,
                   std::string("native or h8, simulated in this process, or ") + kPortText)
      ->capture_default_str()
      ->type_name("native|h8|KIND:PATH");
  add_address(*verb, arguments->address);
  auto* seconds =
      verb->add_option("--seconds", arguments->seconds,
                       "duration of the run; a case that is running at the end is still completed")
          ->check(between(0.001, 1e7, "s"))
          ->capture_default_str()
          ->type_name("SECONDS");
  auto* cases =
      verb->add_option(
              "--cases", arguments->cases,
              "number of cases to run; unlike --seconds, this option makes the result repeatable")
          ->transform(whole_number_above_zero())
          ->excludes(seconds)
          ->type_name("N");
  verb->add_option(
          "--seed", arguments->seed,
          "seed of the cases; on native and h8, also the seed of the noise and the random faults")
      ->transform(whole_number())
      ->capture_default_str()
      ->type_name("N");
  auto* corpus =
      verb->add_option("--corpus", arguments->corpus,
                       "folder of cases with which the search begins. Kaz creates the "
                       "folder if it is missing. If a new case makes the board react in a "
                       "new way, Kaz adds the case to the folder")
          ->type_name("DIR");
  auto* out = verb->add_option("--out", arguments->out, "file for a failing case")
                  ->capture_default_str()
                  ->type_name("FILE");
  verb->add_option(
          "--replay", arguments->replay,
          "run only the case in this file, and list the steps of the case; every file is "
          "a valid case, because every sequence of bytes decodes to a sequence of requests")
      ->type_name("FILE")
      ->excludes(seconds)
      ->excludes(cases)
      ->excludes(corpus)
      ->excludes(out);
  verb->add_option("--image", arguments->image, "firmware image for h8: an S-record or COFF file")
      ->type_name("FILE");
  verb->add_flag(
      "--body", arguments->body,
      "simulate the robot's whole body in a world, not only the motors; no faults are injected");
  verb->add_flag("--allow-motion", arguments->allow_motion,
                 "required for a board at a port, because the robot's joints may move at random. "
                 "Suspend the robot, or disconnect the motors' supply, and stay beside the robot");
  verb->add_flag("--wear-flash", arguments->wear_flash,
                 "for a board at a port: also send requests that write the board's flash");
  verb->add_flag("--json", arguments->json, "print the result as JSON, without progress messages");
  verb->footer(
      "Kaz checks the replies of each board. With --target native or --target h8, Kaz also checks "
      "the motors in each tick. With --target h8, Kaz also computes each tick with the native "
      "board. The outputs of the h8 board and of the native board must be equal. IF THE BOARD IS "
      "AT A PORT, ITS JOINTS MOVE. A failing case is shortened and written to --out. After the "
      "last case "
      "or after Ctrl-C, Kaz restores the settings of a board at a port. If the run was killed, use "
      "the command `kaz recover` to restore the settings. Each case chooses its own faults of "
      "line, power and sensors (docs/reference/simulator.md). The page docs/howto/fuzzing.md lists "
      "the criteria of the checks.\n"
      "A feature is a way in which the board reacts, such as a reply with a certain status or a "
      "refusal with a certain reason. With --target native or --target h8, each combination of "
      "states inside the board is a feature, too. An example of such a combination is a shutdown "
      "while joints are at their limits and a request is queued. Kaz keeps each case that shows a "
      "new feature, and makes later cases by changing the kept cases.\n"
      "Exit status: 0 no case failed; 1 a case failed; 2 wrong usage; 3 port error, or the result "
      "is undecided.\n"
      "Examples:\n"
      "  kaz fuzz --seconds 60\n"
      "  kaz fuzz --target h8 --cases 200 --seed 7\n"
      "  kaz fuzz --body --seconds 60\n"
      "  kaz fuzz --robot serial:/dev/ttyUSB0 --allow-motion --seconds 600\n"
      "  kaz fuzz --replay kaz-fuzz-failure");
  verb->callback([&action, arguments, verb] {
    arguments->seed_given = verb->count("--seed") > 0;
    action = [arguments] { return fuzz(*arguments); };
  });
}

}  // namespace kaz::tools

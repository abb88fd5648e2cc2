// `kaz fuzz`: a hostile host against a board, and a judge beside it.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "tools/fuzz/campaign.h"
#include "tools/kaz/options.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {

void add_fuzz(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "fuzz",
      "a hostile host against a board: whatever it sends, motors and replies stay in order");
  auto arguments = std::make_shared<FuzzOptions>();
  verb->add_option("--target", arguments->target, "native, h8, or the path of a port")
      ->capture_default_str();
  add_address(*verb, arguments->address);
  verb->add_option("--seconds", arguments->seconds, "how long")
      ->check(positive())
      ->capture_default_str();
  verb->add_option("--cases", arguments->cases, "so many cases instead, for a result that repeats")
      ->check(whole_number_above_zero());
  verb->add_option("--seed", arguments->seed, "of the cases")
      ->check(whole_number())
      ->capture_default_str();
  verb->add_option(
          "--corpus", arguments->corpus,
          "folder of cases to begin with; those that show something new are added; made if it "
          "is not there")
      ->type_name("DIR");
  verb->add_option("--replay", arguments->replay, "run this case alone, and list what it does")
      ->type_name("FILE");
  verb->add_option("--out", arguments->out, "where to put a case that goes wrong")
      ->capture_default_str()
      ->type_name("FILE");
  verb->add_option("--image", arguments->image, "firmware image for h8: S-record or COFF");
  verb->add_flag("--body", arguments->body,
                 "with the robot's body in its world instead of motors alone; no faults");
  verb->add_flag("--wear-flash", arguments->wear_flash,
                 "at a port: also requests that write the board's flash");
  verb->add_flag("--json", arguments->json, "print the result as JSON, no progress");
  verb->footer(
      "Native and h8 run in this process; each tick is judged, and each tick of h8 is computed by\n"
      "native too. At a port the replies are judged. THE JOINTS OF A ROBOT AT A PORT MOVE: hang "
      "it\n"
      "up, or take the motors' supply away. Exit status 1 and a file with the shortened case "
      "where\n"
      "something is wrong. The board at a port is left as it was found, also by Ctrl-C (kaz "
      "recover).\n"
      "Cases choose their own faults of line, power and sensors "
      "(docs/reference/faults.md).\n"
      "docs/howto/fuzzing.md says what is judged.\n"
      "Examples:\n"
      "  kaz fuzz --seconds 60\n"
      "  kaz fuzz --target h8 --cases 200 --seed 7\n"
      "  kaz fuzz --body --seconds 60\n"
      "  kaz fuzz --target /dev/ttyUSB0 --seconds 600\n"
      "  kaz fuzz --replay kaz-fuzz-failure");
  verb->callback([&action, arguments] { action = [arguments] { return fuzz(*arguments); }; });
}

}  // namespace kaz::tools

// `kaz recover`: brings a board back, whatever address an interrupted run has left it at.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "tools/board/recover.h"
#include "tools/cli/options.h"
#include "tools/cli/verbs.h"

namespace kaz::tools {

void add_recover(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "recover",
      "find a board at any address, switch its motors off, clear its faults and set its address");
  auto arguments = std::make_shared<RecoverOptions>();
  add_required_port(*verb, arguments->port);
  const auto add_number = [&](const char* name, std::optional<std::uint8_t>& to, const char* text) {
    verb->add_option_function<int>(
            name, [&to](int number) { to = static_cast<std::uint8_t>(number); }, text)
        ->check(between(1, KZ_ADDRESS_LAST))
        ->type_name("N");
  };
  add_number("--address", arguments->address,
             "new address of the board (default: the address in --from, or 1)");
  add_number("--found-at", arguments->found_at,
             "current address of the board to recover, if several boards are on the line");
  verb->add_option_function<std::string>(
          "--shared-line",
          [arguments](const std::string& text) { arguments->shared_line = text == "on"; },
          "whether the board shares its line with other boards: on or off (default: unchanged)")
      ->check(CLI::IsMember({"on", "off"}).description(""))
      ->type_name("on|off");
  verb->add_option("--from", arguments->from,
                   "file in which an interrupted run noted the board's settings. The last message "
                   "of the interrupted run names this file. Kaz also restores the calibration, "
                   "gains and limits in this file")
      ->type_name("FILE");
  verb->add_flag(
          "--port-changed", arguments->port_changed,
          "use the notes in --from even if the notes name another port. Give --port-changed if the "
          "same board is now at a new port")
      ->needs("--from");
  verb->add_flag("--json", arguments->json, "print the result as JSON");
  verb->footer(
      "Kaz searches all 14 addresses, switches the motors off and resets the board. The reset "
      "clears latched faults. Then Kaz sets the board's address. With --from, the calibration in "
      "the notes replaces the calibration in the board's flash. Without --from, the calibration in "
      "the flash does not change.\n"
      "Exit status: 0 recovered, 1 a setting was not restored or a fault remains, 2 wrong usage, 3 "
      "port error.\n"
      "Examples:\n"
      "  kaz recover --robot serial:/dev/ttyUSB0\n"
      "  kaz recover --robot serial:/dev/ttyUSB0 --from "
      "~/.local/state/kaz/board_dev_ttyUSB0-4711.json\n"
      "  kaz recover --robot serial:/dev/ttyUSB0 --found-at 9 --address 2 --json\n"
      "  kaz recover --robot serial:/dev/ttyUSB0 --address 3 --shared-line off");
  verb->callback([&action, arguments] { action = [arguments] { return recover(*arguments); }; });
}

}  // namespace kaz::tools

// `kaz conformance`: the protocol certificate of a board, case by case.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "tools/base/arguments.h"
#include "tools/board/conformance.h"
#include "tools/cli/options.h"
#include "tools/cli/verbs.h"

namespace kaz::tools {
namespace {

// Options that belong to a servo board are refused with a servo bus, and the reverse. Takes the protocol
// from --robot.
Result<void> check_kind(const CLI::App& verb, ConformanceOptions& arguments) {
  if (!arguments.bus && names_servo_bus(arguments.port))
    arguments.bus = KAZ_TRY(parse_bus(arguments.port)).protocol;
  if (arguments.bus) {
    for (const char* option : {"--address", "--virtual", "--image", "--allow-flash", "--seed"})
      if (verb.count(option) > 0)
        return fail(Fault::usage,
                    std::string(option) + " is not valid with a servo bus; leave it out");
  } else {
    for (const char* option : {"--id", "--baud", "--allow-eeprom", "--alone", "--release"})
      if (verb.count(option) > 0)
        return fail(Fault::usage,
                    std::string(option) +
                        " is only valid with a servo bus, such as --robot feetech:/dev/ttyACM0");
  }
  return {};
}

// Adds the options of a servo on a bus. `arguments` must outlive `verb`.
void add_bus_options(CLI::App& verb, ConformanceOptions& arguments) {
  auto* bus = verb.add_option_function<std::string>(
      "--bus",
      [&arguments](const std::string& protocol) {
        arguments.bus =
            protocol == "feetech" ? servo_bus::Protocol::feetech : servo_bus::Protocol::dynamixel;
      },
      "check a servo on a servo bus instead of a board. The cases check whether the servo follows "
      "its manufacturer's documentation");
  bus->check(CLI::IsMember({"feetech", "dynamixel"}).description(""))
      ->type_name("feetech|dynamixel");
  verb.add_option("--id", arguments.id, "id of the servo on the bus")
      ->check(between(0, 253))
      ->capture_default_str()
      ->type_name("N");
  verb.add_option("--baud", arguments.baud,
                  "baud rate of the bus (default: factory setting, which is 1000000 for Feetech "
                  "and 57600 for ROBOTIS)")
      ->check(between(1200L, 10000000L))
      ->type_name("BAUD");
  verb.add_flag("--allow-eeprom", arguments.allow_eeprom,
                "on a bus: also run the cases that write the EEPROM. Writing wears the EEPROM; "
                "each value is restored");
  verb.add_flag(
      "--alone", arguments.alone,
      "on a bus with only this servo: also run the cases that send requests to all servos");
  verb.add_flag("--release", arguments.release,
                "on a bus: switch off the servo's torque before the cases run; hold the arm, "
                "because the joint goes limp");
}

}  // namespace

void add_conformance(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "conformance",
      "run test cases that check whether a board follows docs/reference/protocol.md");
  auto arguments = std::make_shared<ConformanceOptions>();
  auto* port =
      add_port(*verb, arguments->port,
               std::string(kPortText) + "; or " + kBusText + "; give --robot or --virtual");
  add_address(*verb, arguments->address)->needs(port);
  add_choice(*verb, "--virtual", sim::kMcuKinds, arguments->mcu,
             "check a virtual board on a bench, in simulated time: h8 executes the firmware image; "
             "native runs the firmware's C code, compiled for this machine")
      ->excludes(port);
  add_bus_options(*verb, *arguments);
  verb->add_option("--image", arguments->image, "firmware image for h8: an S-record or COFF file")
      ->type_name("FILE");
  verb->add_flag("--allow-motion", arguments->allow_motion,
                 "at a port: also run the cases that move joints or drive motors. Give the robot "
                 "space to move, and stay beside the robot");
  verb->add_flag("--allow-flash", arguments->allow_flash,
                 "at a port: also run the cases that write the calibration and the address to "
                 "flash. Writing wears the flash");
  verb->add_option("--filter", arguments->run.filter,
                   "select only the cases whose id or statement matches this regular expression")
      ->type_name("REGEX");
  verb->add_option("--seed", arguments->run.seed, "seed of the cases' random bytes")
      ->transform(whole_number())
      ->type_name("N")
      ->capture_default_str();
  auto* list =
      verb->add_flag("--list", arguments->list,
                     "print the cases and run none; with --filter, print only the matching cases");
  for (const char* of_a_run :
       {"--robot", "--virtual", "--image", "--allow-motion", "--allow-flash", "--seed", "--id",
        "--baud", "--allow-eeprom", "--alone", "--release"})
    verb->get_option(of_a_run)->excludes(list);
  verb->add_option("--junit", arguments->junit,
                   "write JUnit XML to FILE, or to standard output (-)")
      ->type_name("FILE")
      ->excludes(list);
  verb->add_option_function<std::string>(
          "--json",
          [arguments](const std::string& file) { arguments->json = file.empty() ? "-" : file; },
          "write the report as JSON to FILE. Without FILE, or if FILE is '-', print the JSON on "
          "standard output, and print no other text there. With --list, write the list of cases "
          "instead of the report")
      ->expected(0, 1)
      ->type_name("[FILE]");
  verb->add_option("--html", arguments->html,
                   "write one HTML page to FILE, or to standard output (-)")
      ->type_name("FILE")
      ->excludes(list);
  verb->footer(
      "A virtual board passes all cases. At a port, Kaz leaves out the cases that disturb the "
      "supply, the sensors or the serial line. After the last case or after Ctrl-C, Kaz restores "
      "the settings of a board at a port. If the run was killed, kaz recover restores the "
      "settings. If a case fails while this machine is too slow, the case runs again, up to three "
      "times. If the machine is too slow each time, the case is undecided. All cases take a few "
      "seconds on a virtual board, one or two minutes at a port, and about four minutes with "
      "--allow-flash.\n"
      "With --bus, the servo's torque must be off. By default, the servo does not move, and the "
      "cases write only to RAM and restore each value. The cases take half a minute.\n"
      "Exit status: 0 all cases that ran passed; 1 a case failed; 2 wrong usage, or no case was "
      "selected; 3 port error, or a case is undecided.\n"
      "Examples:\n"
      "  kaz conformance --virtual h8 --html report.html\n"
      "  kaz conformance --robot serial:/dev/ttyUSB0 --junit conformance.xml\n"
      "  kaz conformance --virtual native --filter 'SAFE-|watchdog'\n"
      "  kaz conformance --robot feetech:/dev/ttyACM0 --id 3\n"
      "  kaz conformance --robot dynamixel:/dev/ttyUSB0@1000000 --json report.json\n"
      "  kaz conformance --list");
  verb->callback([&action, arguments, verb] {
    action = [arguments, verb]() -> Result<ExitStatus> {
      KAZ_TRY(check_kind(*verb, *arguments));
      return run_conformance(*arguments);
    };
  });
}

}  // namespace kaz::tools

// `kaz bus`: servos of Feetech's and ROBOTIS's on a serial line.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "shared/base/number_text.hpp"
#include "tools/base/arguments.h"
#include "tools/bus/record_motion.h"
#include "tools/bus/scan.h"
#include "tools/cli/options.h"
#include "tools/cli/verbs.h"

namespace kaz::tools {
namespace {

// "7" or "1-20", into `options`.
CLI::Validator ids_of(const std::shared_ptr<BusScanOptions>& options) {
  return CLI::Validator(
      [options](const std::string& text) -> std::string {
        const auto dash = text.find('-');
        const auto first = parse_number<int>(text.substr(0, dash));
        const auto last =
            dash == std::string::npos ? first : parse_number<int>(text.substr(dash + 1));
        if (!first || !last || *first < 0 || *last > 252 || *first > *last)
          return "give an id or a range from 0 to 252, such as 1-20";
        options->first_id = *first;
        options->last_id = *last;
        return "";
      },
      "");
}

// --robot and --robot-file, both needed.
void add_robot(CLI::App& verb, BackendOptions& options) {
  verb.add_option("--robot", options.robot, kBusText)->required()->type_name("KIND:PATH");
  verb.add_option("--robot-file", options.robot_file,
                  "URDF of the robot; bus.json in the same folder assigns servos to joints")
      ->required()
      ->type_name("FILE");
}

template <class Options>
Result<void> check_robot(const Options& options) {
  if (names_servo_bus(options.backend.robot)) return {};
  return fail(
      Fault::usage,
      "--robot " + options.backend.robot +
          ": give a servo bus, such as feetech:/dev/ttyACM0 or dynamixel:/dev/ttyUSB0@1000000");
}

void add_record(CLI::App& bus, Action& action) {
  auto* verb =
      bus.add_subcommand("record", "record a motion that you make by hand, for kaz run play");
  auto options = std::make_shared<MotionRecordOptions>();
  add_robot(*verb, options->backend);
  verb->add_option("--out", options->out, "file for the recorded poses (docs/howto/watch.md)")
      ->required()
      ->type_name("FILE");
  verb->add_option(
          "--seconds", options->seconds,
          "duration; the recording leaves out the time without motion at the start and the end")
      ->check(between(1.0, 120.0, "s"))
      ->capture_default_str()
      ->type_name("S");
  verb->add_flag("--release", options->release,
                 "switch off the servos' torque before the recording starts; hold the robot, "
                 "because it goes limp");
  verb->add_flag("--json", options->json,
                 "print a summary of the recording as JSON, without progress messages");
  verb->footer(
      "The servos do not drive the joints: move the robot by hand. If playing the recorded poses "
      "would move a joint faster than 4 rad/s, Kaz stretches the times of all poses in the file. "
      "After Ctrl-C, no file is written.\n"
      "Exit status: 0 the file is written; 1 no joint moved, or a joint was outside its limits; 2 "
      "wrong usage; 3 port error.\n"
      "Examples:\n"
      "  kaz bus record --robot feetech:/dev/ttyACM0 --robot-file so101.urdf --out wave.json\n"
      "  kaz run play --poses wave.json --robot feetech:/dev/ttyACM0 --robot-file so101.urdf");
  verb->callback([&action, options] {
    action = [options]() -> Result<ExitStatus> {
      KAZ_TRY(check_robot(*options));
      return record_motion(*options);
    };
  });
}

void add_bus_status(CLI::App& bus, Action& action) {
  auto* verb = bus.add_subcommand(
      "status", "print each servo's angle, torque, load, current, voltage, temperature and errors");
  auto options = std::make_shared<BusStatusOptions>();
  add_robot(*verb, options->backend);
  verb->add_flag("--json", options->json, "print the readings as JSON");
  verb->footer(
      "This verb only reads registers: no servo moves.\n"
      "Exit status: 0 all servos answer without errors, 1 a servo does not answer or reports an "
      "error, 2 wrong usage, 3 port error.\n"
      "Examples:\n"
      "  kaz bus status --robot feetech:/dev/ttyACM0 --robot-file so101.urdf\n"
      "  watch -n 0.5 kaz bus status --robot feetech:/dev/ttyACM0 --robot-file so101.urdf");
  verb->callback([&action, options] {
    action = [options]() -> Result<ExitStatus> {
      KAZ_TRY(check_robot(*options));
      return print_bus_status(*options);
    };
  });
}

}  // namespace

void add_bus(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "bus", "find, examine and record Feetech and ROBOTIS servos on a serial line");
  verb->require_subcommand(1);
  verb->footer(
      "Examples:\n"
      "  kaz bus scan --robot serial:/dev/ttyACM0\n"
      "  kaz bus status --robot feetech:/dev/ttyACM0 --robot-file so101.urdf");
  add_record(*verb, action);
  add_bus_status(*verb, action);
  auto* scan = verb->add_subcommand(
      "scan", "find servos at every id and baud rate, and diagnose the servos and the wiring");
  auto options = std::make_shared<BusScanOptions>();
  auto ids = std::make_shared<std::string>();
  add_port(*scan, options->robot,
           std::string(kBusText) + "; with PATH alone, Kaz tries both protocols")
      ->required();
  scan->add_option("--protocol", options->protocol,
                   "protocol to try, if --robot does not name the protocol (default: both)")
      ->check(CLI::IsMember({"feetech", "dynamixel"}).description(""))
      ->type_name("feetech|dynamixel");
  scan->add_option(
          "--baud", options->bauds,
          "baud rates to try, separated by commas (default: all rates that the servos support)")
      ->delimiter(',')
      ->check(between(1200L, 10000000L))
      ->type_name("BAUD,BAUD");
  scan->add_option("--ids", *ids, "id or range of ids to try (default: 0-252)")
      ->check(ids_of(options))
      ->type_name("N-N");
  scan->add_option("--readings", options->readings,
                   "number of readings for each servo that is found")
      ->check(between(1, 10000))
      ->capture_default_str()
      ->type_name("N");
  scan->add_flag("--json", options->json, "print the servos as JSON");
  scan->footer(
      "The scan only reads registers: no servo moves, and no register is written. Each id takes 8 "
      "ms at each baud rate; a scan with both protocols takes a minute. --protocol and --baud "
      "shorten the scan.\n"
      "Exit status: 0 servos were found, and there is no problem; 1 no servo was found, or there "
      "is a problem with a servo or the wiring; 2 wrong usage; 3 port error.\n"
      "Examples:\n"
      "  kaz bus scan --robot serial:/dev/ttyACM0\n"
      "  kaz bus scan --robot feetech:/dev/ttyACM0@1000000 --ids 1-6\n"
      "  kaz bus scan --robot serial:arm --readings 1000 --json     # port of kaz sim --bus");
  scan->callback([&action, options, ids] {
    (void)ids;  // CLI11 writes the option's text there
    action = [options] { return run_bus_scan(*options); };
  });
}

}  // namespace kaz::tools

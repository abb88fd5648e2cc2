// `kaz bus`: servos of Feetech's and ROBOTIS's on a serial line.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <string>

#include "shared/base/number_text.hpp"
#include "tools/app/base/arguments.h"
#include "tools/app/bus/record_motion.h"
#include "tools/app/bus/scan.h"
#include "tools/kaz/options.h"
#include "tools/kaz/verbs.h"

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
          return "give an id or a range within 0 to 252, as 1-20";
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
                  "URDF of the robot; bus.json beside it says which servo is which joint")
      ->required()
      ->type_name("FILE");
}

template <class Options>
Result<void> check_robot(const Options& options) {
  if (names_servo_bus(options.backend.robot)) return {};
  return fail(Fault::usage, "--robot " + options.backend.robot +
                                ": give a bus of servos, as feetech:/dev/ttyACM0 or "
                                "dynamixel:/dev/ttyUSB0@1000000");
}

void add_record(CLI::App& bus, Action& action) {
  auto* verb = bus.add_subcommand("record", "record a motion by hand, for kaz run play");
  auto options = std::make_shared<MotionRecordOptions>();
  add_robot(*verb, options->backend);
  verb->add_option("--out", options->out, "file of poses (docs/howto/watch.md)")
      ->required()
      ->type_name("FILE");
  verb->add_option("--seconds", options->seconds, "how long; rest at both ends is cut off")
      ->check(between(1.0, 120.0))
      ->capture_default_str()
      ->type_name("S");
  verb->add_flag("--release", options->release,
                 "a torque that is on is switched off at the beginning; hold the robot");
  verb->add_flag("--json", options->json, "print what was recorded as JSON, no progress");
  verb->footer(
      "Nothing is driven: move the robot by hand. A motion faster than 4 rad/s is written slower. "
      "Ctrl-C: nothing is written.\n"
      "Exit status: 0 written, 1 nothing moved, or a joint was outside of its limits, 2 wrong "
      "usage, 3 port error.\n"
      "Examples:\n"
      "  kaz bus record --robot feetech:/dev/ttyACM0 --robot-file so101.urdf --out wave.json\n"
      "  kaz run play --poses wave.json --robot feetech:/dev/ttyACM0 --robot-file so101.urdf");
  verb->callback([&action, options] {
    action = [options]() -> Result<Outcome> {
      KAZ_TRY(check_robot(*options));
      return record_motion(*options);
    };
  });
}

void add_bus_status(CLI::App& bus, Action& action) {
  auto* verb = bus.add_subcommand(
      "status", "print each servo's angle, torque, load, current, voltage, heat and errors");
  auto options = std::make_shared<BusStatusOptions>();
  add_robot(*verb, options->backend);
  verb->add_flag("--json", options->json, "print it as JSON");
  verb->footer(
      "Reads only.\n"
      "Exit status: 0 all answer and report no error, 1 one does not, 2 wrong usage, 3 port "
      "error.\n"
      "Examples:\n"
      "  kaz bus status --robot feetech:/dev/ttyACM0 --robot-file so101.urdf\n"
      "  watch -n 0.5 kaz bus status --robot feetech:/dev/ttyACM0 --robot-file so101.urdf");
  verb->callback([&action, options] {
    action = [options]() -> Result<Outcome> {
      KAZ_TRY(check_robot(*options));
      return print_bus_status(*options);
    };
  });
}

}  // namespace

void add_bus(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "bus", "servos of Feetech's and ROBOTIS's on a serial line: find, look at, record");
  verb->require_subcommand(1);
  verb->footer(
      "Examples:\n  kaz bus scan --robot serial:/dev/ttyACM0\n  kaz bus status --robot "
      "feetech:/dev/ttyACM0 "
      "--robot-file so101.urdf");
  add_record(*verb, action);
  add_bus_status(*verb, action);
  auto* scan = verb->add_subcommand(
      "scan", "look for servos at every id and rate, and for what is wrong with them and the wire");
  auto options = std::make_shared<BusScanOptions>();
  auto ids = std::make_shared<std::string>();
  add_port(*scan, options->robot, std::string(kBusText) + "; PATH alone tries both protocols")
      ->required();
  scan->add_option("--protocol", options->protocol,
                   "feetech or dynamixel, where --robot does not say it; both if not given")
      ->check(CLI::IsMember({"feetech", "dynamixel"}))
      ->type_name("feetech|dynamixel");
  scan->add_option("--baud", options->bauds,
                   "rates, with commas between; all that the servos can be set to if not given")
      ->delimiter(',')
      ->check(between(1200L, 10000000L))
      ->type_name("BAUD,BAUD");
  scan->add_option("--ids", *ids, "an id or a range of them; 0-252 if not given")
      ->check(ids_of(options))
      ->type_name("N-N");
  scan->add_option("--readings", options->readings, "readings of each servo that is found")
      ->check(between(1, 10000))
      ->capture_default_str()
      ->type_name("N");
  scan->add_flag("--json", options->json, "print the servos as JSON");
  scan->footer(
      "Reads only: nothing moves, no register is written. An id and a rate take 8 ms, all of both "
      "protocols a minute; --protocol and --baud shorten it.\n"
      "Exit status: 0 servos are there and nothing is wrong, 1 none is, or something is wrong, 2 "
      "wrong usage, 3 port error.\n"
      "Examples:\n"
      "  kaz bus scan --robot serial:/dev/ttyACM0\n"
      "  kaz bus scan --robot feetech:/dev/ttyACM0@1000000 --ids 1-6\n"
      "  kaz bus scan --robot serial:arm --readings 1000 --json     # of kaz sim --bus");
  scan->callback([&action, options, ids] {
    (void)ids;  // CLI11 writes the option's text there
    action = [options] { return run_bus_scan(*options); };
  });
}

}  // namespace kaz::tools

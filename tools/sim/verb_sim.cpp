// `kaz sim`: a virtual robot for other processes.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "tools/cli/options.h"
#include "tools/cli/verbs.h"
#include "tools/cli/watch_options.h"
#include "tools/sim/serve.h"
#include "tools/sim/serve_bus.h"

namespace kaz::tools {
namespace {

// What a motor stand does not have, among the options given; empty if there is none.
std::string not_of_a_stand(const CLI::App& verb) {
  static constexpr std::pair<const char*, const char*> kAbsent[] = {
      {"--world", "world"},
      {"--suspended", "robot"},
      {"--robot-file", "robot"},
      {"--mesh-collision", "robot"},
      {"--skip-missing-meshes", "robot"},
      {"--strict", "robot"},
      {"--verbose", "robot"},
      {"--imu", "IMU"},
      {"--no-imu", "IMU"},
      {"--dynamics", "robot"},
      {"--physics-step", "robot"},
      {"--eyes", "eyes"},
      {"--eye-width", "eyes"},
      {"--renderer", "eyes"},
      {"--cameras", "eyes"},
      {"--record-pictures", "eyes"},
      {"--write-calibration", "eyes"}};
  for (const auto& [option, what] : kAbsent) {
    if (verb.get_option(option)->count() > 0)
      return std::string(option) + ": a motor stand has no " + what + "; leave " + option +
             " or --stand out";
  }
  return "";
}

// Returns an error if an option needs another option in a simulator of a robot; otherwise an empty text.
std::string not_of_a_robot(const CLI::App& verb) {
  if (verb.get_option("--motor")->count() > 0)
    return "--motor needs --stand or --bus; leave --motor out";
  for (const char* taker : {"--cameras", "--record", "--view", "--write-calibration"})
    if (verb.get_option(taker)->count() > 0) return "";
  for (const char* name : {"--eyes", "--eye-width", "--renderer"})
    if (verb.get_option(name)->count() > 0)
      return std::string(name) +
             " needs --cameras PATH, --record FILE or --view, which use the eyes' pictures";
  return "";
}

std::string not_of_a_calibration(const CLI::App& verb) {
  static const std::set<std::string> kTaken = {
      "--write-calibration", "--world", "--robot-file", "--eyes",
      "--eye-width",         "--mcu",   "--image"};
  for (const CLI::Option* option : verb.get_options()) {
    const std::string name = option->get_name();
    if (option->count() > 0 && !kTaken.contains(name))
      return name +
             " needs --serial: without --serial, only the calibration is written; give --serial "
             "PATH, or leave " +
             name + " out";
  }
  return "";
}

// The error for the first given option that --bus does not support; empty if all are supported.
std::string not_of_a_bus(const CLI::App& verb) {
  static const std::set<std::string> kTaken = {
      "--bus",       "--serial",         "--robot-file",
      "--world",     "--dynamics",       "--supply",
      "--suspended", "--mesh-collision", "--skip-missing-meshes",
      "--motor",     "--strict",         "--verbose"};
  for (const CLI::Option* option : verb.get_options()) {
    const std::string name = option->get_name();
    if (option->count() > 0 && !kTaken.contains(name))
      return name + ": not supported with --bus" + (name.starts_with("--view") ? " yet" : "") +
             "; leave " + name + " or --bus out";
  }
  return "";
}

ServeBusOptions bus_options(const CLI::App& verb, const ServeOptions& arguments,
                            const std::string& protocol) {
  ServeBusOptions options;
  options.protocol = protocol;
  options.suspended = arguments.backend.suspended;
  options.serial = arguments.real_time.serial_path;
  options.robot_file = arguments.backend.robot_file;
  options.dynamics = arguments.backend.dynamics;
  options.motor = arguments.backend.motor;
  options.reading = arguments.backend.reading;
  options.verbose = arguments.backend.verbose;
  if (verb.get_option("--world")->count() > 0) options.world = arguments.backend.world;
  if (verb.get_option("--supply")->count() > 0)
    options.supply_volts = arguments.backend.supply_volts;
  return options;
}

}  // namespace

void add_sim(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand("sim",
                                      "run a virtual robot in real time for other processes, with "
                                      "a serial port, a camera socket and a control socket");
  auto arguments = std::make_shared<ServeOptions>();
  verb->add_option("--serial", arguments->real_time.serial_path,
                   "path for a symbolic link to the board's serial port, which is a pty (required "
                   "unless --write-calibration is given)")
      ->type_name("PATH");
  verb->add_option("--cameras", arguments->real_time.cameras_path,
                   "path of the Unix socket that publishes the stereo pairs")
      ->type_name("PATH");
  auto* fast = verb->add_flag("--fast", arguments->real_time.fast,
                              "run as fast as possible, not in real time");
  verb->add_option("--clock", arguments->real_time.clock_path,
                   "take the simulated time from an external clock. Kaz creates a Unix socket at "
                   "this path, and the clock sends times to this socket. The simulation advances "
                   "to the latest time that the clock has sent, and then waits for the next time")
      ->type_name("PATH")
      ->excludes(fast);
  verb->add_option("--memory", arguments->memory,
                   "file that keeps the board's calibration and address between runs. Kaz writes "
                   "the file when Ctrl-C, SIGTERM or SIGHUP ends the simulator, but not if the "
                   "simulator is killed")
      ->type_name("FILE");
  verb->add_flag("--erased", arguments->backend.erased,
                 "start with an empty flash, as in a new chip (to try kaz flash)");
  verb->add_flag("--boot", arguments->boot, "start with the board's mode switch set to boot mode");
  verb->add_option("--write-calibration", arguments->calibration,
                   "write the eyes' calibration in OpenCV's format (YAML); without --serial, write "
                   "only this file")
      ->type_name("FILE");
  arguments->backend.visit_suspended(OptionAdder(*verb));
  auto* record = verb->add_option("--record", arguments->backend.recording,
                                  "record everything into this file (MCAP), until Ctrl-C")
                     ->type_name("FILE");
  auto* stand = verb->add_flag(
      "--stand", arguments->backend.stand,
      "simulate a motor stand instead of a robot, with a disc on the shaft of each motor. kaz "
      "bench operates the stand's clamp, scale, weight and supply through the control socket");
  auto bus = std::make_shared<std::string>();
  verb->add_option("--bus", *bus,
                   "simulate a servo bus instead of a servo board. The file bus.json in the folder "
                   "of the URDF (--robot-file) lists the servos (docs/howto/own-arm.md)")
      ->check(CLI::IsMember({"feetech", "dynamixel"}).description(""))
      ->type_name("feetech|dynamixel");
  add_motor_options(*verb, arguments->backend);
  for (const char* option : {"--motor-file", "--disc"}) verb->get_option(option)->needs(stand);
  add_sim_options(*verb, arguments->backend);
  add_record_pictures(*verb, arguments->backend);
  verb->get_option("--record-pictures")->needs(record);
  auto watch = std::make_shared<WatchArguments>();
  add_watch_options(*verb, *watch, false);
  verb->footer(
      "The symbolic link that --serial names behaves like a serial port with a board at the other "
      "end. The path of the control socket is the path in --serial, followed by '.ctl'. The "
      "control socket accepts one command per line, such as reset, mode, power, plug, fault, stand "
      "and status. The command `help` lists all commands. Ctrl-C ends the simulator, which then "
      "removes its link and sockets.\n"
      "Exit status: 0 ended by Ctrl-C, SIGTERM or SIGHUP.\n"
      "Examples:\n"
      "  kaz sim --serial board --cameras board.eyes\n"
      "  kaz sim --serial board --erased   # then kaz flash write\n"
      "  kaz sim --serial board --stand   # kaz bench motor --robot serial:board --stand "
      "ctl:board.ctl\n"
      "  kaz sim --serial board --view   # also in a browser\n"
      "  kaz sim --bus feetech --robot-file sim/robots/so101/so101.urdf --serial arm\n"
      "  kaz sim --bus dynamixel --robot-file sim/robots/mini/mini.urdf --serial mini --suspended\n"
      "  kaz sim --eyes real --write-calibration eyes.yml\n"
      "  kaz sim --serial board --record run.mcap   # Foxglove, PlotJuggler and `mcap info` open "
      "it\n"
      "  kaz run track-ball --robot serial:board --camera board.eyes   # in another terminal");
  verb->callback([&action, arguments, watch, verb, bus] {
    if (!bus->empty()) {
      action = [wrong = not_of_a_bus(*verb), options = bus_options(*verb, *arguments, *bus)] {
        return wrong.empty() ? serve_bus(options) : Result<bool>(fail(Fault::usage, wrong));
      };
      return;
    }
    const bool runs = !arguments->real_time.serial_path.empty() || arguments->calibration.empty();
    const std::string wrong = arguments->backend.stand ? not_of_a_stand(*verb)
                              : runs                   ? not_of_a_robot(*verb)
                                                       : not_of_a_calibration(*verb);
    action = [arguments, watch, wrong]() -> Result<bool> {
      if (!wrong.empty()) return fail(Fault::usage, wrong);
      return serve_watched(*watch, *arguments);
    };
  });
}

}  // namespace kaz::tools

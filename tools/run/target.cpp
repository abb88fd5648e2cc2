// Parses --robot.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/target.h"

#include "tools/base/arguments.h"

namespace kaz::tools {
namespace {

constexpr std::string_view kBoards = "boards:";

Result<Target> bus_target(const BackendOptions& options) {
  if (options.robot_file.empty())
    return fail(Fault::usage, "--robot " + options.robot +
                                  " needs --robot-file FILE: give the robot's URDF; bus.json must "
                                  "be in the same folder as the URDF");
  const auto bus = KAZ_TRY(parse_bus(options.robot));
  if (options.address != KZ_ADDRESS_DEFAULT)
    return fail(Fault::usage,
                "--address is only valid with a board: the ids of servos are in bus.json; leave "
                "out --address");
  if (options.reaction == host::Reaction::limp)
    return fail(Fault::usage,
                "--when-lost limp is not valid with a servo bus: servos have no link watchdog "
                "and hold their position when the host is lost; leave out --when-lost");
  return BusTarget{*bus.protocol, bus.port};
}

Result<Target> boards_target(const BackendOptions& options) {
  if (options.address != KZ_ADDRESS_DEFAULT)
    return fail(Fault::usage, "--address: each board of --robot " + options.robot +
                                  " has its address in the file; leave out --address");
  const std::string file = options.robot.substr(kBoards.size());
  return BoardsTarget{file, KAZ_TRY(read_boards(file))};
}

}  // namespace

Result<Target> target_of(const BackendOptions& options) {
  const std::string& text = options.robot;
  if (!options.at_port()) return SimulatedTarget{};
  if (host::names_port_kind(text))
    return PortTarget{KAZ_TRY(host::parse_port_address("--robot", text)), options.address};
  if (names_servo_bus(text)) return bus_target(options);
  if (text.starts_with(kBoards)) return boards_target(options);
  return fail(Fault::usage,
              "--robot " + text +
                  ": no such kind of robot; give sim, serial:PATH[@BAUD] such as "
                  "serial:/dev/ttyUSB0, can:INTERFACE, tcp:HOST:PORT, rfc2217:HOST:PORT, "
                  "boards:FILE, feetech:PATH[@BAUD] or dynamixel:PATH[@BAUD]");
}

}  // namespace kaz::tools

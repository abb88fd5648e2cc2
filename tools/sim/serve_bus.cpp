// `kaz sim --bus`: a servo bus with a robot's servos for other processes.
// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/serve_bus.h"

#include <cstdio>

#include "sim/runtime/serving/bus_server.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/paths.h"
#include "tools/run/robot_joints.h"
#include "tools/sim/serve.h"
#include "tools/sim/stop_flag.h"

namespace kaz::tools {

Result<bool> serve_bus(const ServeBusOptions& options) {
  if (options.robot_file.empty())
    return fail(Fault::usage,
                "--robot-file is missing; give the URDF of the robot whose servos are on the bus, "
                "such as sim/robots/so101/so101.urdf");
  if (options.serial.empty())
    return fail(Fault::usage, "--serial is missing; give a path for the link to the bus's port");
  KAZ_TRY(check_place("--serial", options.serial));
  const auto file = KAZ_TRY(servo_bus::load_bus_file(options.robot_file));
  if (options.protocol != servo_bus::name_of(file.protocol))
    return fail(Fault::usage, "--bus " + options.protocol + ": bus.json in the folder of " +
                                  options.robot_file + " has servos of the protocol " +
                                  std::string(servo_bus::name_of(file.protocol)) +
                                  "; give that protocol, or another robot file");
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  const auto world = KAZ_TRY(world_file(options.world));
  print_unused("kaz sim", {options.robot_file, options.world, options.reading, options.verbose});
  sim::WorldOptions world_options;
  world_options.dynamics = options.dynamics;
  world_options.motor = options.motor;
  world_options.hung = options.suspended;
  world_options.reading = options.reading;
  auto bus = KAZ_TRY(sim::VirtualBus::load(world, options.robot_file, world_options));
  if (options.supply_volts) bus->set_supply_volts(*options.supply_volts);
  sim::BusServerOptions serving;
  serving.serial_path = options.serial;
  serving.report = [](const std::string& line) {
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
  };
  auto server = KAZ_TRY(sim::BusServer::open(*bus, serving));
  std::printf("ready: %zu servos on %s, control on %s.ctl; Ctrl-C ends\n", bus->servos(),
              options.serial.c_str(), options.serial.c_str());
  std::fflush(stdout);
  const StopFlag stop(interrupt);
  const auto statistics = KAZ_TRY(server->run(stop.flag()));
  std::printf(
      "ended after %.1f s; bytes from the host: %llu, to the host: %llu, lost: %llu; overruns: "
      "%llu, "
      "largest delay: %.1f ms\n",
      statistics.simulated_s, static_cast<unsigned long long>(statistics.bytes_from_host),
      static_cast<unsigned long long>(statistics.bytes_to_host),
      static_cast<unsigned long long>(statistics.bytes_lost),
      static_cast<unsigned long long>(statistics.overruns), 1e3 * statistics.worst_late_s);
  if (const auto warning = bus->world().diagnostics().summary(); !warning.empty())
    std::printf("warning: %s\n", warning.c_str());
  return true;
}

}  // namespace kaz::tools

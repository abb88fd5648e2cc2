// The server of `kaz sim --bus`: a servo bus for other processes, paced by the wall clock.
// SPDX-License-Identifier: Apache-2.0
//
// The port is a pty, a control socket is beside it (bus_commands.h). The servos hear the host at the rate
// that it has set. What they answer reaches the host when the wire falls silent, or a USB packet is full, as
// with an adapter; never before it would have passed the wire.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "shared/base/result.hpp"
#include "sim/bus/virtual_bus.h"

namespace kaz::sim {

struct BusServerOptions {
  std::string serial_path;  // symbolic link to the pty; the control socket is serial_path + ".ctl"
  // One line for the user: host connected, gone, its rate; overruns. Without newline.
  std::function<void(const std::string&)> report;
};

struct BusServerStatistics {
  double simulated_s = 0;
  std::uint64_t overruns = 0;  // steps that ended more than 20 ms late
  double lost_s = 0;           // total time by which the bus fell behind the wall clock
  double worst_late_s = 0;
  std::uint64_t bytes_from_host = 0, bytes_to_host = 0;
  std::uint64_t bytes_lost = 0;  // that the host did not read
};

class BusServer {
 public:
  // Creates pty, link and socket; the destructor removes them. Errors: why a path cannot be used.
  static Result<std::unique_ptr<BusServer>> open(VirtualBus& bus, const BusServerOptions& options);
  ~BusServer();

  // Serves until `stop` is set, also by a signal handler. Error: the physics broke down.
  Result<BusServerStatistics> run(const std::atomic<bool>& stop);

 private:
  struct Parts;
  explicit BusServer(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace kaz::sim

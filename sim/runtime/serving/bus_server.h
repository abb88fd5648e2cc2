// Serves a servo bus to other processes (`kaz sim --bus`), paced by the wall clock.
// SPDX-License-Identifier: Apache-2.0
//
// A pty serves as the host's serial port. A control socket receives commands (bus_commands.h). The servos
// receive bytes at the bit rate that the host has set. Like a real USB adapter, the server first collects the
// bytes of a reply. When the wire becomes idle, or when 64 bytes are collected, the server passes the bytes
// to the host. The host gets each byte of a reply only after the end of this byte on the wire.
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
  // Receives messages for the user, such as: the host closed the port; the host changed the bit rate; an
  // overrun occurred. Each message is one line without newline.
  std::function<void(const std::string&)> report;
};

struct BusServerStatistics {
  double simulated_s = 0;
  std::uint64_t overruns = 0;  // number of steps that ended more than 20 ms late
  double lost_s = 0;           // total time by which the bus fell behind the wall clock
  double worst_late_s = 0;
  std::uint64_t bytes_from_host = 0, bytes_to_host = 0;
  std::uint64_t bytes_lost = 0;  // bytes that the host did not read
};

class BusServer {
 public:
  // Creates pty, link and socket; the destructor removes these files. Fails if a path cannot be used. `bus`
  // must outlive the server.
  static Result<std::unique_ptr<BusServer>> open(VirtualBus& bus, const BusServerOptions& options);
  ~BusServer();

  // Serves until `stop` is true. A signal handler may set `stop`. Returns Fault::failed if the physics fails.
  Result<BusServerStatistics> run(const std::atomic<bool>& stop);

 private:
  struct Parts;
  explicit BusServer(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace kaz::sim

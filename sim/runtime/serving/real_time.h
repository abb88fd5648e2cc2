// What `kaz sim` runs: a simulation paced by the wall clock for other processes.
// SPDX-License-Identifier: Apache-2.0
//
// The serial line is a pty, stereo pairs come from a Unix socket, a control socket stands beside
// the pty. docs/simulator.md.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "shared/base/result.hpp"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::sim {

struct RealTimeOptions {
  std::string serial_path;   // symbolic link to the pty; the control socket is serial_path + ".ctl"
  std::string cameras_path;  // Unix socket of shared/base/camera_stream.hpp; none if empty
  bool fast = false;         // as fast as the machine allows instead of paced
  // A program that does what none should hangs the board until reset, instead of ending run().
  bool keep_hung = false;
  // Of a motor stand: what answers `stand ...` on the control socket (control_server.h).
  std::function<Result<nlohmann::ordered_json>(const std::string&)> stand;
  // One line for the user: host connected, silent, gone; motors off; overruns. Without newline.
  std::function<void(const std::string&)> report;
};

struct RealTimeStatistics {
  double simulated_s = 0;
  std::uint64_t overruns = 0;  // steps that ended later than their time by more than 20 ms
  double lost_s = 0;           // by how much the world fell behind the wall clock in all
  double worst_late_s = 0;
  std::uint64_t pairs_left_out = 0;
};

class RealTimeServer {
 public:
  // Makes pty, link and sockets. They are removed by the destructor. Errors: a path that cannot be
  // used, and why.
  static Result<std::unique_ptr<RealTimeServer>> open(Simulation& simulation,
                                                      const RealTimeOptions& options);
  ~RealTimeServer();

  // Serves until `stop`, which a signal handler may set. Error: the simulation's.
  Result<RealTimeStatistics> run(const std::atomic<bool>& stop);

 private:
  struct Parts;
  explicit RealTimeServer(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace kaz::sim

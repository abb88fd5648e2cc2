// The server of `kaz sim`: a simulation for other processes, paced by the wall clock or another machine's.
// SPDX-License-Identifier: Apache-2.0
//
// The serial line is a pty, stereo pairs come from a Unix socket, a control socket is beside the pty
// (docs/reference/simulator.md).
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
  std::string
      clock_path;  // Unix socket of the clock that paces it (followed_clock.h); the wall's if empty
  bool fast = false;  // as fast as the machine allows instead of paced
  // True: an illegal operation of the firmware hangs the board until reset instead of ending run().
  bool keep_hung = false;
  // Motor stand: handles `stand ...` on the control socket (control_server.h).
  std::function<Result<nlohmann::ordered_json>(const std::string&)> stand;
  // Each pair as it is exposed, its pixels perhaps still being drawn, while `wants_pairs` says so, with
  // readers of cameras_path or without.
  std::function<void(const vision::StereoPair&)> on_pair;
  std::function<bool()> wants_pairs;
  // One line for the user: host connected, silent, gone; motors off; overruns. Without newline.
  std::function<void(const std::string&)> report;
};

struct RealTimeStatistics {
  double simulated_s = 0;
  std::uint64_t overruns = 0;  // steps that ended more than 20 ms late
  double lost_s = 0;           // total time by which the world fell behind the wall clock
  double worst_late_s = 0;
  std::uint64_t pairs_dropped = 0;
};

class RealTimeServer {
 public:
  // Creates pty, link and sockets; the destructor removes them. Errors: why a path cannot be used.
  static Result<std::unique_ptr<RealTimeServer>> open(Simulation& simulation,
                                                      const RealTimeOptions& options);
  ~RealTimeServer();

  // Serves until `stop` is set, also by a signal handler. Error: that of the simulation.
  Result<RealTimeStatistics> run(const std::atomic<bool>& stop);

 private:
  struct Parts;
  explicit RealTimeServer(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace kaz::sim

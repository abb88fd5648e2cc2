// Serves a simulation to other processes (`kaz sim`), paced by the clock of this machine or of another
// machine.
// SPDX-License-Identifier: Apache-2.0
//
// A pty serves as the host's serial port. A control socket receives commands (control_server.h). A Unix
// socket delivers stereo pairs (docs/reference/simulator.md).
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
  std::string cameras_path;  // Unix socket of shared/base/camera_stream.hpp; empty: no socket
  // Unix socket of the clock that paces the simulation (followed_clock.h). Empty: the wall clock paces the
  // simulation.
  std::string clock_path;
  bool fast = false;  // if true, the simulation runs as fast as the machine allows, without pacing
  // True: after an illegal operation of the firmware, the board hangs until reset. False: the illegal
  // operation ends run().
  bool keep_hung = false;
  // Handles the command `stand ...` on the control socket, for a motor stand (control_server.h).
  std::function<Result<nlohmann::ordered_json>(const std::string&)> stand;
  // If `wants_pairs` returns true, `on_pair` receives each pair at the time of the pair's exposure. `on_pair`
  // also receives pairs while the socket at cameras_path has no readers. When `on_pair` receives a pair,
  // rendering of the pixels can still be in progress.
  std::function<void(const vision::StereoPair&)> on_pair;
  std::function<bool()> wants_pairs;
  // Receives messages for the user, for example about the host, the motors, the power supply, or overruns.
  // Each message is one line without newline.
  std::function<void(const std::string&)> report;
};

struct RealTimeStatistics {
  double simulated_s = 0;
  std::uint64_t overruns = 0;  // number of steps that ended more than 20 ms late
  double lost_s = 0;           // sum of the delays of the steps that ended more than 20 ms late
  double worst_late_s = 0;
  std::uint64_t pairs_dropped = 0;
};

class RealTimeServer {
 public:
  // Creates pty, link and sockets; the destructor removes these files. Fails if a path cannot be used.
  // `simulation` must outlive the server.
  static Result<std::unique_ptr<RealTimeServer>> open(Simulation& simulation,
                                                      const RealTimeOptions& options);
  ~RealTimeServer();

  // Serves until `stop` is true. A signal handler may set `stop`. Fails if the simulation or the followed
  // clock fails.
  Result<RealTimeStatistics> run(const std::atomic<bool>& stop);

 private:
  struct Parts;
  explicit RealTimeServer(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace kaz::sim

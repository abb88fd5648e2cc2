// Measures how late this program and the simulator behind the port were during a run in real time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <thread>

#include "host/link/interrupt.h"
#include "host/link/lateness.h"
#include "host/link/wall_clock.h"

namespace kaz::tools {

struct RunLateness {
  // Lag of the simulator; empty at a real port, or if the simulator did not reply.
  std::optional<double> simulator_lost_s;
  double host_late_s = 0, host_worst_late_s = 0;
  // Reason why the robot may not be the cause of a failed run. Example: "the program at the other end fell
  // behind by 4200 ms". Empty if this program and the simulator were on time.
  std::string excuse;
};

// The measurement begins with the construction of this object. A thread that only waits measures how long the
// system delays this process. The times of a behavior's requests do not show this delay, because a behavior
// may compute between its requests.
class RunLatenessMeter {
 public:
  // Largest lateness that a run tolerates. Applies to a single delay of this program, and to the total lag of
  // the simulator.
  static constexpr Time kBorne = std::chrono::seconds(1);

  // `link` is the connection to the port; link.name() is the path of the port. `link` and `interrupt` must
  // outlive this object.
  RunLatenessMeter(host::Link& link, host::Interrupt& interrupt);
  // Measures the simulator's lag with the function `simulator`; null: does not measure this lag.
  RunLatenessMeter(host::Link& link, host::LatenessMeter::TimeLost simulator);
  ~RunLatenessMeter();
  RunLatenessMeter(const RunLatenessMeter&) = delete;
  RunLatenessMeter& operator=(const RunLatenessMeter&) = delete;

  // Ends the measurement and returns its result. Call end() once.
  RunLateness end();

 private:
  host::LatenessMeter::TimeLost remembered();
  void stop();

  host::WallClock clock_;
  host::LatenessMeter::TimeLost simulator_;
  std::optional<Time> lost_before_, lost_;
  host::LatenessMeter meter_;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

}  // namespace kaz::tools

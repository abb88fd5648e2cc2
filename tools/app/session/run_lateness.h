// Measures how late this program, and the simulator behind its port, were during a run in real time.
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
  std::optional<double> simulator_lost_s;  // empty at a real port, or without replies
  double host_late_s = 0, host_worst_late_s = 0;
  // Why a failure is inconclusive, as "the program at the other end fell behind by 4200 ms". Empty if both
  // were on time.
  std::string excuse;
};

// Measures from its construction on. A behavior may compute between its requests, so the times of its calls
// do not show how long the system delays this process. A thread that only waits measures that.
class RunLatenessMeter {
 public:
  // Lateness that a run tolerates: a single delay of this program, or the total lag of the simulator.
  static constexpr Time kBorne = std::chrono::seconds(1);

  // `link` names the port. `link` and `interrupt` must outlive it.
  RunLatenessMeter(host::Link& link, host::Interrupt& interrupt);
  // Uses another measure of the simulator's lag; null: none.
  RunLatenessMeter(host::Link& link, host::LatenessMeter::TimeLost simulator);
  ~RunLatenessMeter();
  RunLatenessMeter(const RunLatenessMeter&) = delete;
  RunLatenessMeter& operator=(const RunLatenessMeter&) = delete;

  // Ends the measurement. Call it once.
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

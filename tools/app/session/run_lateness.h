// How late this program, and the simulator behind its port, were during a run in real time.
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
  std::optional<double> simulator_lost_s;  // none at a real port, or where it does not reply
  double host_late_s = 0, host_worst_late_s = 0;
  // Why a failure proves nothing against the robot, as "the program at the other end fell behind by 4200 ms";
  // empty if both were punctual.
  std::string excuse;
};

// Measures from its construction on. A behaviour computes between its requests for as long as it likes, so
// its own calls do not show how late it is kept: a thread that only waits does.
class RunLatenessMeter {
 public:
  // Lateness that a robot bears: of a second, at once or in all (then 2 % of the time at least, too).
  static constexpr Time kBorne = std::chrono::seconds(1);

  // `link` names the port; link and interrupt must outlive it.
  RunLatenessMeter(host::Link& link, host::Interrupt& interrupt);
  // With another measure of the simulator's lag; null: there is none.
  RunLatenessMeter(host::Link& link, host::LatenessMeter::TimeLost simulator);
  ~RunLatenessMeter();
  RunLatenessMeter(const RunLatenessMeter&) = delete;
  RunLatenessMeter& operator=(const RunLatenessMeter&) = delete;

  // To be called once.
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

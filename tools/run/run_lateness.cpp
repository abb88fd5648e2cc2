// How late this program, and the simulator behind its port, were during a run in real time.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/run_lateness.h"

#include <chrono>
#include <utility>

#include "shared/base/time.hpp"
#include "tools/base/time_lost.h"

namespace kaz::tools {
namespace {

// Long, as the meter sums what is above a millisecond: of ordinary wake-ups that stays below 2 % of the time.
constexpr Time kStep = std::chrono::milliseconds(100);

}  // namespace

RunLatenessMeter::RunLatenessMeter(host::Link& link, host::Interrupt& interrupt)
    : RunLatenessMeter(link, time_lost_behind(link.name(), interrupt)) {}

RunLatenessMeter::RunLatenessMeter(host::Link& link, host::LatenessMeter::TimeLost simulator)
    : simulator_(std::move(simulator)), meter_(link, clock_, remembered()), thread_([this] {
        while (!ended_) (void)meter_.sleep_until(meter_.now() + kStep);
      }) {}

RunLatenessMeter::~RunLatenessMeter() {
  stop();
}

// The meter asks at its begin and at its end.
host::LatenessMeter::TimeLost RunLatenessMeter::remembered() {
  if (!simulator_) return nullptr;
  return [this]() -> Result<Time> {
    auto lost = simulator_();
    if (lost && !lost_before_)
      lost_before_ = *lost;
    else if (lost)
      lost_ = *lost;
    return lost;
  };
}

void RunLatenessMeter::stop() {
  ended_ = true;
  if (thread_.joinable()) thread_.join();
}

RunLateness RunLatenessMeter::end() {
  stop();
  RunLateness lateness;
  lateness.excuse = meter_.excuse(kBorne);
  if (lost_ && lost_before_) lateness.simulator_lost_s = seconds(*lost_ - *lost_before_);
  lateness.host_late_s = seconds(meter_.total());
  lateness.host_worst_late_s = seconds(meter_.longest());
  return lateness;
}

}  // namespace kaz::tools

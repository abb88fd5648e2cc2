// A run's lateness: that of the simulator behind the port, and of this program.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tools/run/run_lateness.h"

namespace kaz::tools {
namespace {

using std::chrono::milliseconds;

struct NoLink final : host::Link {
  std::string name() const override { return "board"; }
  Result<void> write(std::span<const std::uint8_t>) override { return {}; }
  Result<std::size_t> read(std::span<std::uint8_t>, Time) override { return 0; }
};

// A simulator that has lost `before`, and then `lost` more.
RunLateness with_simulator(Time before, Time lost) {
  NoLink link;
  bool begun = false;
  RunLatenessMeter meter(link, [&]() -> Result<Time> {
    return before + (std::exchange(begun, true) ? lost : Time::zero());
  });
  return meter.end();
}

TEST(RunLateness, ASimulatorMayLagForASecond) {
  const RunLateness lateness = with_simulator(milliseconds(5000), milliseconds(1400));
  EXPECT_NEAR(lateness.simulator_lost_s.value(), 1.4, 1e-9) << "since the run began";
  EXPECT_EQ(lateness.excuse, "the program at the other end fell behind by 1400 ms");
  const RunLateness little = with_simulator(milliseconds(5000), milliseconds(900));
  EXPECT_NEAR(little.simulator_lost_s.value(), 0.9, 1e-9);
  EXPECT_EQ(little.excuse.find("fell behind"), std::string::npos) << little.excuse;
}

TEST(RunLateness, ARealBoardHasNoSimulator) {
  NoLink link;
  RunLatenessMeter meter(link, nullptr);
  const RunLateness lateness = meter.end();
  EXPECT_FALSE(lateness.simulator_lost_s);
  EXPECT_GE(lateness.host_worst_late_s, 0);
}

}  // namespace
}  // namespace kaz::tools

// A simulated motor stand, and the host's connection to the stand's board and tools.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "hil/bench/motor/motor_bench.h"
#include "host/link/interruptible.h"
#include "sim/stand/stand_commands.h"
#include "tools/lockstep/lockstep.h"

namespace kaz::lockstep {

class StandBackend {
 public:
  // `simulation`: result of make_stand(). `pressing_s`: duration of a press against the scale, s. `interrupt`
  // ends all waits. `interrupt` may be null and must outlive this object.
  explicit StandBackend(std::unique_ptr<sim::Simulation> simulation, double pressing_s = 0.1,
                        const host::Interrupt* interrupt = nullptr);

  sim::Simulation& simulation() { return *simulation_; }
  host::Link& link() { return link_; }
  host::Clock& clock() { return clock_; }
  hil::Stand& stand() { return stand_; }

  // Runs the motor measurements in simulated time.
  Result<void> run(const hil::MotorBenchOptions& options, hil::BenchJudge& judge);

 private:
  std::unique_ptr<sim::Simulation> simulation_;
  LockstepClock raw_clock_{*simulation_};
  LockstepLink raw_link_{*simulation_};
  host::InterruptibleClock clock_;
  host::InterruptibleLink link_;
  hil::CommandStand stand_;
};

}  // namespace kaz::lockstep

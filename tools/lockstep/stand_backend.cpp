// An emulated board with its motors on a stand.
// SPDX-License-Identifier: Apache-2.0
#include "tools/lockstep/stand_backend.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace kaz::lockstep {

StandBackend::StandBackend(std::unique_ptr<sim::Simulation> simulation, double pressing_s,
                           const host::Interrupt* interrupt)
    : simulation_(std::move(simulation)),
      clock_(raw_clock_, interrupt),
      link_(raw_link_, raw_clock_, interrupt),
      stand_(
          "virtual",
          [this](const std::string& line) { return sim::answer_stand(*simulation_, line); }, clock_,
          pressing_s) {}

Result<void> StandBackend::run(const hil::MotorBenchOptions& options, hil::BenchJudge& judge) {
  auto robot = KAZ_TRY(host::Robot::connect(link_, clock_, hil::bench_connection()));
  return hil::bench_motor(robot, &stand_, options, judge);
}

}  // namespace kaz::lockstep

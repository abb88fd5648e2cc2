// Runs one fuzzing case on a simulated board in this process, in lockstep, and judges every tick.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "hil/fuzz/grammar.h"
#include "hil/fuzz/runner.h"
#include "host/link/interrupt.h"
#include "shared/base/result.hpp"
#include "sim/mcu/mcu_kind.h"

namespace kaz::fuzz {

struct EngineVerdict;

struct EngineOptions {
  sim::McuKind mcu = sim::McuKind::native;  // with h8, each tick is compared with native code
  std::string image;                        // firmware image for h8
  std::uint64_t seed = 1;
  // Paths of the world and of the suspended robot. If the paths are empty, motors without a body are
  // simulated.
  std::string world_path, robot_path;
  hil::fuzz::GrammarOptions grammar;
  // An interrupt ends the case with an error; may be null.
  const host::Interrupt* interrupt = nullptr;
  EngineVerdict* broken_off = nullptr;  // same as RunnerOptions::broken_off
};

struct EngineVerdict : hil::fuzz::CaseVerdict {
  long long ticks = 0;
  std::uint16_t worst_busy_8states = 0;  // h8: longest tick, in units of 8 states
  // H8: engine that executed the firmware, such as "translator".
  std::string emulator_engine;
  // h8: number of executed instructions, and number of executed instructions that were translated code.
  long long instructions = 0, translated_instructions = 0;
  double worst_overshoot_rad = 0;  // largest angle by which a driven joint exceeded its soft limit
};

// Runs one case. Returns Fault::usage if the image for h8 has no symbols of the tick. Other errors come from
// the simulation and the runner.
Result<EngineVerdict> run_engine_case(const hil::fuzz::Genome& genome,
                                      const EngineOptions& options);

}  // namespace kaz::fuzz

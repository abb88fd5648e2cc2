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
  sim::McuKind mcu = sim::McuKind::native;  // h8: each tick is compared with native
  std::string image;                        // firmware, for h8
  std::uint64_t seed = 1;
  // Files of the world and of the suspended robot. If empty: motors without a body.
  std::string world_path, robot_path;
  hil::fuzz::GrammarOptions grammar;
  const host::Interrupt* interrupt = nullptr;  // ends the case with its error; may be null
  EngineVerdict* broken_off = nullptr;         // RunnerOptions::broken_off
};

struct EngineVerdict : hil::fuzz::Verdict {
  long long ticks = 0;
  std::uint16_t worst_busy_8states = 0;  // h8: longest tick, in units of 8 states
  std::string emulator_engine;           // h8: engine that executed, such as "translator"
  // h8: executed instructions, and those of them that were translated code.
  long long instructions = 0, translated_instructions = 0;
  double worst_overshoot_rad = 0;  // furthest that a driven joint went past its soft limit
};

// Returns Fault::usage if the image of h8 has no tick symbols; else errors of simulation and runner.
Result<EngineVerdict> run_engine_case(const hil::fuzz::Genome& genome,
                                      const EngineOptions& options);

}  // namespace kaz::fuzz

// One case of the fuzzer on a board in this process, in lockstep, with every tick judged.
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
  sim::McuKind mcu = sim::McuKind::native;  // h8: native computes each of its ticks again
  std::string image;                        // firmware, for h8
  std::uint64_t seed = 1;
  // The robot and its world, suspended by its trunk; motors without a body if empty.
  std::string world_path, robot_path;
  hil::fuzz::GrammarOptions grammar;
  const host::Interrupt* interrupt = nullptr;  // ends a case with its error
  EngineVerdict* broken_off = nullptr;         // RunnerOptions::broken_off
};

struct EngineVerdict : hil::fuzz::Verdict {
  long long ticks = 0;
  std::uint16_t worst_busy_8states = 0;  // h8: the longest tick
  std::string emulator_engine;           // h8: what executed, "translator"
  // h8: executed, and how many of them as translated code.
  long long instructions = 0, translated_instructions = 0;
  double worst_overshoot_rad = 0;  // how far a driven joint went past its soft limit
};

Result<EngineVerdict> run_engine_case(const hil::fuzz::Genome& genome,
                                      const EngineOptions& options);

}  // namespace kaz::fuzz

// Proof that the two engines are one program.
// SPDX-License-Identifier: Apache-2.0
//
// The firmware image runs in the emulator under random host traffic and potentiometers, each of its
// tick inputs goes to the native build of shared/servo, and outputs and state must come out equal;
// what the chip's pins show in the tick after must be what was put out, and the waveform at TxD0,
// decoded by a receiver that knows nothing of the channel, must be the bytes that were put out.
// Design, sections 1 and 3.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/h8s/chip/options.h"

namespace kaz::sim {

class H8Mcu;

struct CompareOptions {
  std::string image_path;       // S-record with symbols beside it, or COFF
  std::int64_t ticks = 100000;  // to compare
  std::uint64_t seed = 1;
  std::int64_t state_every = 1;  // compare the whole servo state every so many ticks
  h8s::Engine engine = h8s::Engine::translator;  // the emulator's; the default is what users get
  std::function<void(std::int64_t done, std::int64_t total)> progress;
  std::function<void(H8Mcu&)> prepare_h8;  // for tests: a chip that is not as it should be
};

struct CompareDifference {
  std::string field;  // "output.pw[3]", "state.joints[2].goal", "pins.pw[3]", "line.byte"
  std::int64_t native = 0, h8 = 0;
};

// What the board was seen to do, by its own replies: traffic that is only refused proves little.
struct CompareCoverage {
  std::map<std::uint8_t, std::int64_t> replies;    // by type, telemetry among them
  std::map<std::uint8_t, std::int64_t> refusals;   // by KZ_REFUSED_*
  std::map<std::uint8_t, std::int64_t> shutdowns;  // replies that tell of a KZ_SHUTDOWN_*
  std::map<std::uint8_t, std::int64_t> actions;    // KZ_ACTION_* that were asked for
};

struct CompareReport {
  std::int64_t ticks = 0;  // compared
  std::string engine;      // of the emulator, that which executed: "translator"
  // Executed by the emulated chip, and how many of them as translated host code.
  std::int64_t instructions = 0, translated_instructions = 0;
  // Traffic that these ticks saw.
  std::int64_t bytes_received = 0, bytes_sent = 0, frames_sent_to_board = 0;
  std::uint16_t worst_busy_8states = 0;
  std::int64_t missed_ticks = 0, resets = 0;
  std::int64_t pins_compared = 0;  // ticks whose pins were held against the output before
  std::int64_t line_bytes = 0;     // decoded at TxD0, and equal to what ticks put out
  CompareCoverage coverage;
  double chip_s = 0;

  // The first tick that differs, all its differences, and what it saw.
  std::optional<std::uint32_t> tick;
  std::vector<CompareDifference> differences;
  std::string input_hex;  // the tick's input as the H8 has it in memory

  bool equal() const { return differences.empty(); }
  // Several lines: the first difference side by side, or that there is none.
  std::string text() const;
};

// Errors: an image that cannot be read or has no tick symbols, a chip that stopped.
Result<CompareReport> compare_engines(const CompareOptions& options);

}  // namespace kaz::sim

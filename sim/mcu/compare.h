// Compares the native engine with the firmware image in the emulator, tick by tick.
// SPDX-License-Identifier: Apache-2.0
//
// The firmware image runs in the emulator under random host traffic and potentiometers. Each of its tick
// inputs is passed to the native build of shared/servo; outputs and state must be equal. In the following
// tick the chip's pins must show the output, and the bytes decoded from the waveform at TxD0 must be those
// of the output.
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
  std::function<bool()>
      stop;  // looked at often; true ends the comparison with the report until then
  std::function<void(H8Mcu&)> prepare_h8;  // for tests: plants a fault in the chip
};

struct CompareDifference {
  // "output.pw[3]", "state.joint[2].goal", "pins.pw[3]", "line.byte"; of a frame that is being sent
  // its message and field, "identify_reply.build_id".
  std::string field;
  std::int64_t native = 0, h8 = 0;
};

// Coverage by the board's own replies: traffic that is only refused shows little.
struct CompareCoverage {
  std::map<std::uint8_t, std::int64_t> replies;    // by type, telemetry among them
  std::map<std::uint8_t, std::int64_t> refusals;   // by KZ_REFUSED_*
  std::map<std::uint8_t, std::int64_t> shutdowns;  // replies with a KZ_SHUTDOWN_*
  std::map<std::uint8_t, std::int64_t> actions;    // KZ_ACTION_* requested
};

struct CompareReport {
  std::int64_t ticks = 0;  // compared
  bool stopped = false;    // by CompareOptions::stop
  std::string engine;      // of the emulator, as executed: "translator"
  // Executed by the emulated chip, and how many of them as translated host code.
  std::int64_t instructions = 0, translated_instructions = 0;
  // Traffic during these ticks.
  std::int64_t bytes_received = 0, bytes_sent = 0, frames_sent_to_board = 0;
  std::uint16_t worst_busy_8states = 0;
  std::int64_t missed_ticks = 0, resets = 0;
  std::int64_t pins_compared = 0;  // ticks whose pins were compared with the previous output
  std::int64_t line_bytes = 0;     // decoded at TxD0 and equal to the ticks' output
  CompareCoverage coverage;
  double chip_s = 0;

  // The first tick that differs, all its differences, and its input.
  std::optional<std::uint32_t> tick;
  std::vector<CompareDifference> differences;
  std::string input_hex;  // the tick's input as laid out in the H8's memory

  bool equal() const { return differences.empty(); }
  // Several lines: the first difference side by side, or a statement that there is none.
  std::string text() const;
};

// Errors: an image that cannot be read, has no tick symbols or is of other sources, a chip that stopped.
Result<CompareReport> compare_engines(const CompareOptions& options);

// Returns Fault::usage if the header in the chip's flash names other sources than this program's: every
// comparison would then end at the build id. An image without a header passes.
Result<void> check_same_sources(const H8Mcu& h8, const std::string& image_path);

}  // namespace kaz::sim

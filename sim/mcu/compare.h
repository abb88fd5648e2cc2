// Compares the native engine with the firmware image in the emulator, tick by tick.
// SPDX-License-Identifier: Apache-2.0
//
// The firmware image runs in the emulator under random host traffic and potentiometer voltages. In each
// tick, the native build of shared/servo gets the same input as the firmware. The outputs and states of the
// two engines must be equal. The output of a tick contains the pin levels that the chip must have in the
// next tick. The output also contains the bytes that the chip must send. The bytes decoded from the waveform
// at TxD0 must equal these bytes.
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
  // Path of a COFF file or of an S-record file. The symbols of an S-record file are read from the file with
  // the same name and the extension `.coff`.
  std::string image_path;
  std::int64_t ticks = 100000;  // number of ticks to compare
  std::uint64_t seed = 1;
  std::int64_t state_every = 1;  // number of ticks between two comparisons of the whole servo state
  // Engine of the emulator. The default is the engine that users run.
  h8s::Engine engine = h8s::Engine::translator;
  // Called every 1,000 ticks.
  std::function<void(std::int64_t done, std::int64_t total)> progress;
  // Polled once per simulated millisecond. If `stop` returns true, the comparison ends, and compare_engines()
  // returns the report up to this time.
  std::function<bool()> stop;
  std::function<void(H8Mcu&)> prepare_h8;  // for tests: injects a fault into the chip
};

struct CompareDifference {
  // Name of the value that differs, for example "output.pw[3]", "state.joint[2].goal", "pins.pw[3]" or
  // "line.byte". If the engines send different values in a field of a frame, `field` names the message and
  // the frame's field, for example "identify_reply.build_id".
  std::string field;
  // Values of the two engines. If `field` is "line.byte" and `native` is -1, the firmware in the emulator
  // has sent a byte that the native build has not sent. If `field` is "line.missing" or "line.cut_off", `h8`
  // is -1, because the firmware in the emulator has not sent the byte `native`.
  std::int64_t native = 0, h8 = 0;
};

// Numbers of replies and actions in the compared ticks. If the board refuses most requests, the comparison
// covers little of the code.
struct CompareCoverage {
  // Number of frames from the board for each message type (replies and telemetry).
  std::map<std::uint8_t, std::int64_t> replies;
  std::map<std::uint8_t, std::int64_t> refusals;  // number of refusals for each reason KZ_REFUSED_*
  // Number of replies during a shutdown, for each reason KZ_SHUTDOWN_*.
  std::map<std::uint8_t, std::int64_t> shutdowns;
  std::map<std::uint8_t, std::int64_t> actions;  // number of requested actions for each KZ_ACTION_*
};

struct CompareReport {
  std::int64_t ticks = 0;  // number of ticks compared
  bool stopped = false;    // CompareOptions::stop ended the comparison
  std::string engine;      // engine that the emulator used, such as "translator"
  // Number of instructions of the emulated chip, and number of instructions that ran as translated host code.
  std::int64_t instructions = 0, translated_instructions = 0;
  // Traffic during the compared ticks, as seen from the board.
  std::int64_t bytes_received = 0, bytes_sent = 0, frames_sent_to_board = 0;
  std::uint16_t worst_busy_8states = 0;
  std::int64_t missed_ticks = 0, resets = 0;
  // Number of ticks in which the pins were compared with the previous tick's output.
  std::int64_t pins_compared = 0;
  std::int64_t line_bytes = 0;  // number of bytes at TxD0 that equal the bytes in the native output
  CompareCoverage coverage;
  double chip_s = 0;  // simulated time of the chip

  // Number of the first tick that differs, all differences in that tick, and the input of that tick.
  std::optional<std::uint32_t> tick;
  std::vector<CompareDifference> differences;
  std::string input_hex;  // the input in hexadecimal, in the layout of the H8's memory

  bool equal() const { return differences.empty(); }
  // Returns a text of several lines: the coverage if equal(), otherwise the differences of the first tick
  // that differs.
  std::string text() const;
};

// Compares the engines up to the first tick that differs. A difference is reported as a result, not as an
// error. Returns Fault::usage if the image cannot be read, has no tick symbols or was built from other
// sources than this program. Returns Fault::failed if the chip stops on an error or runs no ticks.
Result<CompareReport> compare_engines(const CompareOptions& options);

// The header of the firmware image contains a build id. Compares this build id with the build id of this
// program. Returns Fault::usage if the two build ids differ. Without this check, the comparison of two
// different builds would fail at the first reply that contains the build id. An image without a header
// passes the check.
Result<void> check_same_sources(const H8Mcu& h8, const std::string& image_path);

}  // namespace kaz::sim

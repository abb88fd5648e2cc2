// Compares the two engines as whole boards: seeded conversations, on the wire and at the pins.
// SPDX-License-Identifier: Apache-2.0
//
// The firmware image runs in the emulator, the native engine beside it; both are whole boards. Both receive
// the same bytes at the same times and the same voltages. The emulated chip's bytes are decoded from the
// waveform at TxD0. The replies must be equal byte by byte, each begins on both boards within one
// tick, and the pins agree in every millisecond. Differences by design are in wire_differences.h.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/mcu/h8_mcu.h"
#include "sim/mcu/native_mcu.h"

namespace kaz::sim {

struct WireOptions {
  std::string image_path;
  std::int64_t conversations = 100;  // of a second each
  std::uint64_t seed = 1;
  std::int64_t first = 0;  // conversations before it are skipped
  std::function<void(std::int64_t done, std::int64_t total)> progress;
  std::function<bool()>
      stop;  // looked at often; true ends the comparison with the report until then
  // For tests: the other board, and a fault planted in the chip.
  std::function<std::unique_ptr<Mcu>(const NativeOptions&)> make_other =
      [](const NativeOptions& o) { return make_native(o); };
  std::function<void(H8Mcu&)> prepare_h8;
};

struct WireDifference {
  std::int64_t conversation = 0;  // `first` for running it alone
  double ms = 0;                  // since its beginning
  std::string what;               // one sentence
  std::string h8, native;         // side by side; empty where the sentence is complete
  std::string requests;           // the last ones before, oldest first
};

struct WireReport {
  std::string emulator_engine;  // as executed: "translator"
  std::uint64_t seed = 0;
  std::int64_t conversations = 0;
  bool stopped = false;          // by WireOptions::stop
  std::int64_t different = 0;    // conversations
  std::int64_t ended_early = 0;  // conversations: replies one tick apart (wire_differences.h)
  std::vector<WireDifference> differences;  // the first one of each of the first few conversations
  std::int64_t requests = 0, fewest_requests = 0;
  std::int64_t replies = 0, bytes = 0,
               masked = 0;         // frames equal but for fields that differ by design
  std::int64_t pins_compared = 0;  // milliseconds
  std::int64_t resets = 0;
  States largest_lag = 0;                        // between the first bytes of a reply
  States largest_reset_lag = 0;                  // between requested resets
  States h8_start = 0;                           // from power-on to the first tick
  std::map<std::string, std::int64_t> kinds;     // what was sent (wire_host.h)
  std::map<std::uint8_t, std::int64_t> by_type;  // replies
  double chip_s = 0;

  // Replies one tick apart are rare (2 in 10,000 conversations); more of them are a difference.
  std::int64_t max_ended_early() const { return 1 + conversations / 1000; }
  bool equal() const { return different == 0 && ended_early <= max_ended_early(); }
  std::string text() const;
};

// Errors: an image that cannot be read or never ticks, a chip that stopped.
Result<WireReport> compare_wire(const WireOptions& options);

}  // namespace kaz::sim

// Compares the two engines as whole boards, on the wire and at the pins, in random conversations.
// SPDX-License-Identifier: Apache-2.0
//
// The emulated board executes the firmware image, the native board runs the firmware's C code. Both boards
// receive the same bytes at the same times and have the same input voltages. The emulated chip's bytes are
// decoded from the waveform at TxD0. The replies of the boards must be equal byte by byte and begin within
// one tick of each other. The pin levels must be equal in every millisecond. wire_differences.h lists the
// intended differences between the boards.
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
  std::int64_t conversations = 100;  // number of conversations; each takes one second
  std::uint64_t seed = 1;
  std::int64_t first = 0;  // number of the first conversation to run
  // Called after each conversation.
  std::function<void(std::int64_t done, std::int64_t total)> progress;
  // Polled before each conversation. If `stop` returns true, the comparison ends, and compare_wire() returns
  // the report up to this time.
  std::function<bool()> stop;
  // For tests: `make_other` makes the board that is compared with the emulated board, and `prepare_h8`
  // injects a fault into the emulated chip.
  std::function<std::unique_ptr<Mcu>(const NativeOptions&)> make_other =
      [](const NativeOptions& o) { return make_native(o); };
  std::function<void(H8Mcu&)> prepare_h8;
};

struct WireDifference {
  // Number of the conversation. To run only this conversation, set WireOptions::first to this number and
  // WireOptions::conversations to 1.
  std::int64_t conversation = 0;
  double ms = 0;     // time since the conversation began
  std::string what;  // description of the difference, one sentence
  // Behavior of the emulated board and of the native board. If `what` already describes the behavior of a
  // board, the text for this board is empty.
  std::string h8, native;
  std::string requests;  // the last requests before the difference, oldest first
};

struct WireReport {
  std::string emulator_engine;  // engine that the emulator used, such as "translator"
  std::uint64_t seed = 0;
  std::int64_t conversations = 0;
  bool stopped = false;        // WireOptions::stop ended the comparison
  std::int64_t different = 0;  // number of conversations with a difference
  // Number of conversations that ended early. If a request waits for free space in the transmit ring buffer,
  // one board can answer one tick later than the other board. Then the conversation ends early
  // (wire_differences.h).
  std::int64_t ended_early = 0;
  // Contains one element for each of the first 5 conversations with a difference. The element describes the
  // first difference in the conversation.
  std::vector<WireDifference> differences;
  // requests: number of requests in all conversations. fewest_requests: smallest number of requests in one
  // conversation.
  std::int64_t requests = 0, fewest_requests = 0;
  // Number of equal frames from the boards, number of bytes in these frames, and number of frames that differ
  // only by design.
  std::int64_t replies = 0, bytes = 0, masked = 0;
  std::int64_t pins_compared = 0;  // number of milliseconds compared
  std::int64_t resets = 0;
  // largest_lag: longest time between the first bytes of the two boards' replies to the same request.
  // largest_reset_lag: longest time between the resets of the two boards after the same request.
  States largest_lag = 0;
  States largest_reset_lag = 0;
  States h8_start = 0;  // time from power-on to the first tick
  // Number of items sent, by kind (WireHost::kinds()).
  std::map<std::string, std::int64_t> kinds;
  std::map<std::uint8_t, std::int64_t> by_type;  // number of replies by message type
  double chip_s = 0;                             // simulated time of the chip

  // If `ended_early` is larger than max_ended_early(), equal() returns false. Conversations that end early
  // are rare: 2 in 10,000.
  std::int64_t max_ended_early() const { return 1 + conversations / 1000; }
  bool equal() const { return different == 0 && ended_early <= max_ended_early(); }
  std::string text() const;
};

// Runs the conversations. A difference is reported as a result, not as an error. Returns Fault::usage if the
// image cannot be read or was built from other sources than this program. Returns Fault::failed if the chip
// stops on an error or runs no ticks.
Result<WireReport> compare_wire(const WireOptions& options);

}  // namespace kaz::sim

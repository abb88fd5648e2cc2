// A board as it was found, and the way back there: for runs that alter boards.
// SPDX-License-Identifier: Apache-2.0
//
// Kept are address, link watchdog, gains, limits and calibration, in RAM and in flash. Not kept: motors,
// which are off afterwards or left alone, and what a reset forgets: counters, a latched shutdown, telemetry.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/link/link.h"
#include "shared/board/board.h"
#include "shared/protocol/messages.h"

namespace kaz::host {

// In the units of messages.def.
struct KeptJoint {
  std::uint16_t kp = 0, kd = 0, dead_band = 0;
  std::uint8_t friction = 0;
  std::uint16_t ramp = 0;
  std::int16_t lower = 0, upper = 0;
  std::int16_t centre = 0, scale = 0;                // calibration in use
  std::int16_t stored_centre = 0, stored_scale = 0;  // that of flash; only if `flash`
  bool operator==(const KeptJoint&) const = default;
};

struct BoardState {
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  bool shared_line = false;  // other boards are on its line
  std::uint8_t watchdog_10ms = 0, reaction = 0;
  bool flash = false;             // the calibration in flash is known
  std::uint16_t stored_copy = 0;  // its number; 0: none is stored
  std::array<KeptJoint, KZ_JOINTS> joints{};
  bool operator==(const BoardState&) const = default;
};

// Reads a board except its flash; changes nothing. Errors: nothing answers at the address (environment; the
// sentence names boards at others), the link is gone, the program was interrupted.
Result<BoardState> read_board(Link& link, Clock& clock, std::uint8_t address);
// Adds the calibration in flash. Motors go off and the board is reset: only after a reset the calibration in
// use is the one in flash.
Result<void> read_flash(Link& link, Clock& clock, BoardState& state);

// Ends a sentence on a calibration that is stored and was not before: the command that erases it; or, where
// the firmware has no image, which is that of a simulator with --mcu native, how long it stays.
std::string how_calibration_goes(const kz_identify_reply& identity, const std::string& port,
                                 std::uint8_t address);

struct PutBackOptions {
  Time patience = std::chrono::seconds(8);  // a loader takes 3 s, a write to flash up to 3 s
  bool flash =
      false;  // address and flash may have changed: begin with a reset, search all addresses
  bool reset = false;  // begin with a reset, which clears a latched shutdown; implied by `flash`
  bool motors_off = true;                 // false: motors are left as they are
  bool settings = true;                   // watchdog, gains, limits, calibration in RAM
  std::vector<std::uint8_t> others = {};  // other boards of the line: left alone
};

struct PutBack {
  std::uint8_t found_at = 0;      // the board's address at the beginning; 0: nowhere
  std::uint16_t status = 0;       // of the board at the end
  std::vector<std::string> done;  // what was put back: "address 3 to 1"
  // What was not; empty: the board is as it was, and confirms that its motors are off if they were to be.
  std::vector<std::string> left;
  std::vector<std::string> notes;
};

// Searches the board, which may be at any address, starting, in its loader or deaf, switches its motors
// off, and puts `state` back. Tries until it succeeds or the time is over; a link that is gone is opened
// again. `link` and `clock` must not be those that an interrupt has ended.
PutBack put_back(Link& link, Clock& clock, const BoardState& state, const PutBackOptions& options);

}  // namespace kaz::host

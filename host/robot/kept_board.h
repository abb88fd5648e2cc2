// Saves and restores the state of a board, for programs that change settings of the board during a run.
// SPDX-License-Identifier: Apache-2.0
//
// The saved state consists of the address, the link watchdog, gains, limits, and the calibrations in RAM and
// in flash. The saved state does not include which motors are on. The function put_back() switches all motors
// off, unless PutBackOptions::motors_off is false. Counters, a latched shutdown and telemetry settings are
// not saved, because a reset clears them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "host/link/link.h"
#include "shared/board/board.h"
#include "shared/protocol/messages.h"

namespace kaz::host {

// Saved settings of one joint, in the units of messages.def.
struct KeptJoint {
  std::uint16_t kp = 0, kd = 0, dead_band = 0;
  std::uint8_t friction = 0;
  std::uint16_t ramp = 0;
  std::int16_t lower = 0, upper = 0;
  std::int16_t centre = 0, scale = 0;  // calibration in use
  // Calibration in flash; valid if BoardState::flash is true.
  std::int16_t stored_centre = 0, stored_scale = 0;
  bool operator==(const KeptJoint&) const = default;
};

struct BoardState {
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  bool shared_line = false;  // other boards share the board's line
  std::uint8_t watchdog_10ms = 0, reaction = 0;
  bool flash = false;             // the calibration in flash was read
  std::uint16_t stored_copy = 0;  // sequence number of the calibration in flash; 0: none is stored
  std::array<KeptJoint, KZ_JOINTS> joints{};
  bool operator==(const BoardState&) const = default;
};

// Reads the state of a board, but not the calibration in its flash. Changes nothing on the board. Fails
// (environment) if no board answers at the address; the message names boards at other addresses. Also fails
// if the link is lost or the program is interrupted.
Result<BoardState> read_board(Link& link, Clock& clock, std::uint8_t address);
// Adds the calibration in flash to `state`. Switches the motors off and resets the board, because the board
// loads the calibration in flash only at a reset.
Result<void> read_flash(Link& link, Clock& clock, BoardState& state);

// Returns text to append to a message about a newly stored calibration. This text names the command that
// erases the calibration. Firmware without an image (`kaz sim --mcu native`) has no such command. In this
// case, the text states how long the calibration is kept.
std::string how_calibration_goes(const kz_identify_reply& identity, const std::string& port,
                                 std::uint8_t address);

struct PutBackOptions {
  // Timeout of put_back(). A board in its loader does not answer for 3 s. A write to flash takes up to 3 s.
  // The default timeout allows for 3 s in the loader and then 3 s for a write to flash.
  Time patience = std::chrono::seconds(8);
  // True: the program may have changed the address or the flash. So put_back() first resets the board, and
  // searches for the board at all addresses.
  bool flash = false;
  // True: put_back() first resets the board. The reset clears a latched shutdown. `flash` implies `reset`.
  bool reset = false;
  // False: put_back() switches motors off only if `flash` or `reset` is true.
  bool motors_off = true;
  // True: put_back() restores watchdog, gains, limits and calibration in RAM.
  bool settings = true;
  // Addresses of other boards on the line, which put_back() does not change.
  std::vector<std::uint8_t> others = {};
};

struct PutBack {
  std::uint8_t found_at = 0;  // the board's address at the start; 0: not found
  std::uint16_t status = 0;   // status of the board at the end
  // Items that were restored. Example: "address 3 to 1" means that put_back() changed the address from 3 to
  // 1.
  std::vector<std::string> done;
  // Items that were not restored. If `left` is empty, the board has its saved state again. With
  // PutBackOptions::motors_off, an empty `left` also means that the board has confirmed that all motors are
  // off.
  std::vector<std::string> left;
  // Remarks for the user.
  std::vector<std::string> notes;
};

// Finds the board, switches its motors off, and restores `state`. At the time of the call, the board may be
// starting, running its loader, or unresponsive. With PutBackOptions::flash, the board may be at any address.
// Retries until success or timeout, and reopens a lost link. Before the call, suspend interrupts (class
// CleanUp in interrupt.h), so that an interrupt cannot end a wait on `link` or `clock`.
PutBack put_back(Link& link, Clock& clock, const BoardState& state, const PutBackOptions& options);

}  // namespace kaz::host

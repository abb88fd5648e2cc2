// `kaz recover`: restores a board after an interrupted run, even if the board's address has changed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/link/link.h"
#include "shared/base/result.hpp"
#include "tools/kept/kept_file.h"

namespace kaz::tools {

struct RecoverOptions {
  std::string port = {};  // port of the board, as for parse_port()
  // Address to set; empty: the address in the notes, or 1 without notes.
  std::optional<std::uint8_t> address = {};
  // Present address of the board, if several boards reply.
  std::optional<std::uint8_t> found_at = {};
  // Setting to write; empty: the setting in the notes, or unchanged without notes.
  std::optional<bool> shared_line = {};
  // File with the notes of an interrupted run; empty: no notes.
  std::string from = {};
  // True: the notes are accepted although they name another port, because the board is the same.
  bool port_changed = false;
  bool json = false;
};

struct Recovered {
  std::uint8_t found_at = 0, address = 0;
  bool shared_line = false;
  std::uint16_t status_before = 0, status = 0;  // KZ_STATUS_*, KZ_SHUTDOWN_*
  std::vector<std::string> done, left, notes;
};

// Finds the board, switches its motors off, resets it and sets its address. Waits up to `patience` for a
// board that is starting or is in its loader. If `kept` is given, also restores all settings in these notes,
// including the calibration in flash. Without notes the calibration in flash stays unchanged. Fails (usage or
// environment) if no board is found, or if another board has the address to set. Also fails if several boards
// are found and none is selected.
Result<Recovered> recover_board(host::Link& link, host::Clock& clock, const RecoverOptions& options,
                                const std::optional<KeptFile>& kept,
                                Time patience = std::chrono::seconds(6));

// Runs `kaz recover`, and prints the found board and the completed steps. Returns false if the board still
// has a fault, or if a setting could not be restored.
Result<bool> recover(const RecoverOptions& options);

}  // namespace kaz::tools

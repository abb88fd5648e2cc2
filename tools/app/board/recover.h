// `kaz recover`: restores a board, whatever address an interrupted run has left it at.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/link/link.h"
#include "shared/base/result.hpp"
#include "tools/app/kept/kept_file.h"

namespace kaz::tools {

struct RecoverOptions {
  std::string port = {};                      // for parse_port()
  std::optional<std::uint8_t> address = {};   // final address; empty: from the notes, else 1
  std::optional<std::uint8_t> found_at = {};  // present address, if there are several boards
  std::optional<bool> shared_line = {};       // empty: as in the notes, else unchanged
  std::string from = {};                      // notes of an interrupted run; empty: none
  bool port_changed = false;  // the notes describe this board, but name another port
  bool json = false;
};

struct Recovered {
  std::uint8_t found_at = 0, address = 0;
  bool shared_line = false;
  std::uint16_t status_before = 0, status = 0;  // KZ_STATUS_*, KZ_SHUTDOWN_*
  std::vector<std::string> done, left, notes;
};

// Finds the board, switches its motors off, resets it and sets its address. Waits up to `patience` for a
// board that starts or is in its loader. With `kept` it also restores all settings in those notes, including
// the calibration in flash. Without them the calibration stays. Fails (usage or environment) if no board is
// found, if there are several and none is selected, or if another board has the address.
Result<Recovered> recover_board(host::Link& link, host::Clock& clock, const RecoverOptions& options,
                                const std::optional<KeptFile>& kept,
                                Time patience = std::chrono::seconds(6));

// Runs the command, and prints what was found and done. Returns false if a fault remains, or if something
// could not be restored.
Result<bool> recover(const RecoverOptions& options);

}  // namespace kaz::tools

// `kaz recover`: brings a board back, whatever address an interrupted run has left it at.
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
  std::string port = {};                      // as parse_port_address() has it
  std::optional<std::uint8_t> address = {};   // where it is to be; that of the notes, else 1
  std::optional<std::uint8_t> found_at = {};  // which board, where there are several
  std::optional<bool> shared_line = {};       // as in the notes, else as it is
  std::string from = {};                      // notes of an interrupted run; empty: none
  bool port_changed = false;  // the notes are of this board, but name another port
  bool json = false;
};

struct Recovered {
  std::uint8_t found_at = 0, address = 0;
  bool shared_line = false;
  std::uint16_t status_before = 0, status = 0;  // KZ_STATUS_*, KZ_SHUTDOWN_*
  std::vector<std::string> done, left, notes;
};

// Finds the board, waiting `patience` for one that starts or is in its loader, switches its motors off,
// resets it and gives it its address; with `kept` all that those notes have. Its calibration in flash stays,
// except that of `kept` is put back. Errors: no board, several of which none is chosen, the address is
// another board's (usage, environment).
Result<Recovered> recover_board(host::Link& link, host::Clock& clock, const RecoverOptions& options,
                                const std::optional<KeptFile>& kept,
                                Time patience = std::chrono::seconds(6));

// The verb; prints what was found and done. False: a fault remains, or something could not be put back.
Result<bool> recover(const RecoverOptions& options);

}  // namespace kaz::tools

// `kaz monitor`: joints, supply, tick and link in a terminal, and keys to move the joints.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::tools {

// Runs until q or Ctrl-C, at PATH[@BAUD]. Errors: usage, no terminal, no board at the port.
Result<bool> monitor(const std::string& port);

}  // namespace kaz::tools

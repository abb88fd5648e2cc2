// Questions to the user at the keyboard.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/link/interrupt.h"
#include "shared/base/result.hpp"

namespace kaz::tools {

// Prints `prompt` on standard error and returns the typed line without its end. Ctrl-C ends the wait with
// Fault::interrupted. At the end of standard input it fails with Fault::usage and the message `nobody`.
Result<std::string> prompt_user(const std::string& prompt, const host::Interrupt& interrupt,
                                const std::string& nobody);

}  // namespace kaz::tools

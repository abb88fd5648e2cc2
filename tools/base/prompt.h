// Prompts the user for input at the keyboard.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/link/interrupt.h"
#include "shared/base/result.hpp"

namespace kaz::tools {

// Prints `prompt` on standard error and returns the typed line without its line break. Fails with
// Fault::interrupted after Ctrl-C. Fails with Fault::usage and the message `nobody` at the end of standard
// input.
Result<std::string> prompt_user(const std::string& prompt, const host::Interrupt& interrupt,
                                const std::string& nobody);

}  // namespace kaz::tools

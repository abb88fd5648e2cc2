// Questions to whoever sits at the keyboard.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/link/interrupt.h"
#include "shared/base/result.hpp"

namespace kaz::tools {

// Prints `prompt` on standard error and returns the line that is typed, without its end. Ctrl-C ends the
// wait. Error (usage): standard input has ended; `nobody` is the sentence.
Result<std::string> prompt_user(const std::string& prompt, const host::Interrupt& interrupt,
                                const std::string& nobody);

}  // namespace kaz::tools

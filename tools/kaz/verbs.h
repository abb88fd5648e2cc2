// Verbs of the command line. Each adds itself to the program, and sets the action when it is chosen.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

#include "tools/app/base/outcome.h"

namespace kaz::tools {

// Runs after the whole command line has been parsed. The fault of an Error is the exit status
// (shared/base/result.hpp).
using Action = std::function<Result<Outcome>()>;

// Declares add_NAME of each verb, which verb_NAME.cpp defines.
#define KAZ_VERB(name, interrupt) void add_##name(CLI::App& program, Action& action);
#include "tools/kaz/verbs.def"
#undef KAZ_VERB

}  // namespace kaz::tools

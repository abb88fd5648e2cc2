// The verbs of the command line. Each adds itself to the program and, when chosen, sets what to do.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

#include "tools/app/base/outcome.h"

namespace kaz::tools {

// Runs after the whole command line was parsed. The fault of an Error is the exit status
// (shared/base/result.hpp).
using Action = std::function<Result<Outcome>()>;

// add_NAME of each verb, in verb_NAME.cpp.
#define KAZ_VERB(name, interrupt) void add_##name(CLI::App& program, Action& action);
#include "tools/kaz/verbs.def"
#undef KAZ_VERB

}  // namespace kaz::tools

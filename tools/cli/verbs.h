// Verbs of the command line. Each verb adds itself to the program. A chosen verb sets the action to run.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

#include "tools/base/exit_status.h"

namespace kaz::tools {

// The action runs after the whole command line has been parsed. If the action returns an Error, the fault of
// the Error determines the exit status (shared/base/result.hpp).
using Action = std::function<Result<ExitStatus>()>;

// Declares add_NAME for each verb. The file verb_NAME.cpp in the folder of the verb defines this function.
#define KAZ_VERB(name, folder) void add_##name(CLI::App& program, Action& action);
#include "tools/cli/verbs.def"
#undef KAZ_VERB

}  // namespace kaz::tools

// Date, version, machine and command line of this program run, for reports.
// SPDX-License-Identifier: Apache-2.0
//
// These values are never written to a recording, because the recording for a seed must be the same on any
// machine at any time.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hil/report/provenance.h"

namespace kaz::tools {

// Stores the command line. Call set_command_line() once, from main().
void set_command_line(int argc, const char* const* argv);
// Returns the words of the command line without the program's name.
const std::vector<std::string>& command_words();

// Returns the provenance of this run. Its `date` is the time at which provenance() was called.
hil::Provenance provenance();
// Returns the value of the member `provenance` in JSON reports.
nlohmann::ordered_json provenance_json();

}  // namespace kaz::tools

// Date, version, machine and command line of this program run, for reports.
// SPDX-License-Identifier: Apache-2.0
//
// They are never part of a recording: the same seed must give the same bytes at any time on any machine.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hil/report/provenance.h"

namespace kaz::tools {

// Stores the command line. Call it once, from main().
void set_command_line(int argc, const char* const* argv);
// Returns the words of the command line without the program.
const std::vector<std::string>& command_words();

// `date` is the time of the call.
hil::Provenance provenance();
// Value of `provenance` in JSON reports.
nlohmann::ordered_json provenance_json();

}  // namespace kaz::tools

// Date, version, machine and command line of this run of the program, for its reports. Never part of a
// recording: the same seed gives the same bytes at any time on any machine.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hil/report/provenance.h"

namespace kaz::tools {

// Once, from main().
void set_command_line(int argc, const char* const* argv);
// Its words, without the program.
const std::vector<std::string>& command_words();

// The date is that of the call.
hil::Provenance provenance();
// Under `provenance` in JSON.
nlohmann::ordered_json provenance_json();

}  // namespace kaz::tools

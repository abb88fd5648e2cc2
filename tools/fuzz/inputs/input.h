// What the targets share: the input as a text or a file, and the judgement of an error.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "tools/fuzz/target.h"

namespace kaz::fuzz {

std::string text_of(Bytes bytes);

// A file in a temporary folder that goes with the process, overwritten by the next call with the same
// name. Returns its path.
std::string input_file(Bytes bytes, const std::string& name);
// The folder of input_file(), for sockets.
std::string input_folder();

// An error must be one sentence, or one line, that names `source`, and blame the input (usage) unless
// another fault is expected.
Complaint judge_error(const Error& error, const std::string& source, Fault fault = Fault::usage);

}  // namespace kaz::fuzz

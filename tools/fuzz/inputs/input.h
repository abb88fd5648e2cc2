// Common to the fuzz targets of inputs: input as text or file, and the check of an error.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "tools/fuzz/target.h"

namespace kaz::fuzz {

std::string text_of(Bytes bytes);

// Writes the input to a file in a temporary folder, and returns its path. The next call with the same name
// overwrites it. The folder is removed at exit. Ends the process if writing fails.
std::string input_file(Bytes bytes, const std::string& name);
// Returns the folder of input_file(), for sockets.
std::string input_folder();

// Checks that an error is one line that names `source`, and that it has the expected fault. The default is
// Fault::usage, which blames the input.
Complaint judge_error(const Error& error, const std::string& source, Fault fault = Fault::usage);

}  // namespace kaz::fuzz

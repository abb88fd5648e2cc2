// Functions for all fuzz targets of inputs: convert the input to a text or a file, and check an error.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"
#include "tools/fuzz/target.h"

namespace kaz::fuzz {

std::string text_of(Bytes bytes);

// Writes the input to a file in a temporary folder, and returns its path. The next call with the same name
// overwrites the file. The folder is removed at exit. Ends the process if the file cannot be written.
std::string input_file(Bytes bytes, const std::string& name);
// Returns the folder of input_file(). Targets create sockets in this folder.
std::string input_folder();

// Checks that the message of an error is one line that contains `source`, and that the fault is `fault`. The
// default fault, Fault::usage, is right for errors in the input.
Complaint judge_error(const Error& error, const std::string& source, Fault fault = Fault::usage);

}  // namespace kaz::fuzz

// `kaz status`: reads the state of a board; moves and changes nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/result.hpp"

namespace kaz::tools {

struct StatusOptions {
  std::string port;  // PATH[@BAUD]
  bool json = false;
};

// Prints the state. False: a shutdown is latched.
Result<bool> print_status(const StatusOptions& arguments);

}  // namespace kaz::tools

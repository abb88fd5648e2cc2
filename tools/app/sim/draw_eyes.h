// `kaz eyes`: pictures of both eyes and an external view.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tools/app/session/backend.h"

namespace kaz::tools {

struct EyesOptions {
  BackendOptions backend;
  std::string out = "kaz-eyes";  // folder
};

// Writes the pictures of the simulated robot at its start.
Result<bool> draw_eyes(EyesOptions arguments);

}  // namespace kaz::tools

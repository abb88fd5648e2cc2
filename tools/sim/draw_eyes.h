// `kaz eyes`: draws the pictures of both eyes and an external view.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tools/run/backend.h"

namespace kaz::tools {

struct EyesOptions {
  BackendOptions backend;
  std::string out = "kaz-eyes";  // folder for the pictures
};

// Writes the pictures of a simulated robot in its start pose.
Result<bool> draw_eyes(EyesOptions arguments);

}  // namespace kaz::tools

// Example of a vision module: computes the brightness of pictures. Linked from docs/explanation/vision.md.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "vision/pipeline/module.h"

namespace kaz::vision {

struct Brightness {
  double left = 0, right = 0;  // mean code of the picture, 0..255
};

// Creates the module "brightness", whose result has the type Brightness.
std::unique_ptr<Module> make_brightness_module();

}  // namespace kaz::vision

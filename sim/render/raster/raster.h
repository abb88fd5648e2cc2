// Renderer without OpenGL: a rasterizer that uses the vector instructions of the processor.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "shared/base/result.hpp"
#include "sim/render/instruction_set.h"
#include "sim/render/renderer.h"

namespace kaz::sim {

// Makes the rasterizer for an instruction set. The function is_available() must return true for `set`.
std::unique_ptr<Renderer> make_raster_with(InstructionSet set);

}  // namespace kaz::sim

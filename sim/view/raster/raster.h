// Renderer without OpenGL: a rasteriser for the processor's vectors.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "shared/base/result.hpp"
#include "sim/view/renderer.h"

namespace kaz::sim {

// Pictures are the same bytes with each of them.
enum class InstructionSet { plain, avx2, avx512 };

// False where the processor, or the compiler's target, has not got it.
bool is_available(InstructionSet set);

// `set` must be available.
std::unique_ptr<Renderer> make_raster_with(InstructionSet set);

}  // namespace kaz::sim

// From samples to pixels.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace kaz::sim {

// RGBA samples, `width` x `height` of them, to RGB pixels: the mean light of n x n samples each
// (light is the square of a code, as in shaders.h).
void pack_rgb(std::span<const std::uint8_t> rgba, int width, int height, int n,
              std::vector<std::uint8_t>& rgb);

}  // namespace kaz::sim

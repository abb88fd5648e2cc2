// Procedural textures with their mip levels: the same bytes on every machine.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::sim {

// Square RGBA pictures, each half as wide as the one before, the last 1 x 1. Periodic in both
// directions. They multiply the base colour of a visual; white leaves it unchanged.
struct Texture {
  int size = 0;         // px of level 0, a power of two
  double repeat_m = 1;  // length of one period on the surface
  std::vector<std::vector<std::uint8_t>> levels;
};

inline constexpr std::array<const char*, 3> kTextureNames{"checker", "wood", "carpet"};

// "checker" (squares of 0.1 m), "wood" (planks of 0.08 m along x), "carpet" (short loops).
Result<Texture> make_texture(const std::string& name);

}  // namespace kaz::sim

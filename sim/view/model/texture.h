// Procedural textures with their mip levels, with the same bytes on every machine.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::sim {

// Square RGBA pictures, each half as wide as the previous one, the last 1 x 1. They are periodic in both
// directions and multiply the base color of a visual; white leaves it unchanged.
struct Texture {
  int size = 0;         // px of level 0, a power of two
  double repeat_m = 1;  // length of one period on the surface
  std::vector<std::vector<std::uint8_t>> levels;
};

inline constexpr std::array<const char*, 3> kTextureNames{"checker", "wood", "carpet"};

// Makes "checker" (squares of 0.1 m), "wood" (planks of 0.08 m along x) or "carpet" (short loops). Returns
// Fault::usage for other names.
Result<Texture> make_texture(const std::string& name);

}  // namespace kaz::sim

// Procedural textures with mip levels. The bytes are the same on every machine.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::sim {

// A texture is a series of square RGBA pictures, the mip levels. Each level is half as wide as the previous
// level; the last level is 1 x 1. The pictures are periodic in both directions. The base color of a visual is
// multiplied by the color of the texture; white leaves the base color unchanged.
struct Texture {
  int size = 0;         // width of level 0 in px, a power of two
  double repeat_m = 1;  // length of one period of the texture on the surface, m
  std::vector<std::vector<std::uint8_t>> levels;
};

inline constexpr std::array<const char*, 3> kTextureNames{"checker", "wood", "carpet"};

// Makes "checker" (squares of 0.1 m), "wood" (planks of 0.08 m along x) or "carpet" (short loops). Returns
// Fault::usage for other names.
Result<Texture> make_texture(const std::string& name);

}  // namespace kaz::sim

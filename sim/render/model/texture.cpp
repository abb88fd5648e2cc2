// Checker, wood and carpet from integer noise.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/model/texture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kaz::sim {

namespace {

constexpr int kSize = 512;

// Hash of three integers to 32 bits (finaliser of MurmurHash3).
std::uint32_t hash(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
  std::uint32_t h = x * 0x9E3779B1U ^ y * 0x85EBCA77U ^ seed * 0xC2B2AE3DU;
  h = (h ^ (h >> 16)) * 0x85EBCA6BU;
  h = (h ^ (h >> 13)) * 0xC2B2AE35U;
  return h ^ (h >> 16);
}

double unit_noise(int x, int y, std::uint32_t seed) {
  return hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), seed) * 0x1p-32;
}

// Value noise, 0..1, with `cells_x` x `cells_y` lattice points a period; x and y in 0..1.
double smooth_noise(double x, double y, int cells_x, int cells_y, std::uint32_t seed) {
  const double fx = x * cells_x, fy = y * cells_y;
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  const auto ease = [](double t) { return t * t * (3 - 2 * t); };
  const double tx = ease(fx - ix), ty = ease(fy - iy);
  const auto at = [&](int dx, int dy) {
    return unit_noise((ix + dx) % cells_x, (iy + dy) % cells_y, seed);
  };
  const double top = at(0, 0) + tx * (at(1, 0) - at(0, 0));
  const double bottom = at(0, 1) + tx * (at(1, 1) - at(0, 1));
  return top + ty * (bottom - top);
}

using Tone = std::array<double, 3>;  // 0..1, red green blue

Tone grey(double v) {
  return {v, v, v};
}

Tone checker(int x, int y) {
  const bool dark = (x < kSize / 2) != (y < kSize / 2);
  const double speckle = 0.02 * (unit_noise(x, y, 1) - 0.5);
  // A joint between the tiles, 1.5 mm wide.
  const int in_x = x % (kSize / 2), in_y = y % (kSize / 2);
  if (std::min(in_x, in_y) < 2 || std::max(in_x, in_y) >= kSize / 2 - 2)
    return grey(0.52 + speckle);
  const double cloud = 0.05 * (smooth_noise(x / double{kSize}, y / double{kSize}, 8, 8, 2) - 0.5);
  return grey((dark ? 0.60 : 0.95) + cloud + speckle);
}

Tone wood(int x, int y) {
  constexpr int kPlanks = 8, kWidth = kSize / kPlanks;
  const int plank = y / kWidth, in_plank = y % kWidth;
  const std::uint32_t seed = 10 + static_cast<std::uint32_t>(plank);
  const int shift = static_cast<int>(unit_noise(plank, 0, 3) * kSize);
  const int along = (x + shift) % kSize;
  const double u = along / double{kSize}, v = y / double{kSize};
  // Grain: stretched noise bent by slower noise, and fine pores.
  const double bend = 0.03 * smooth_noise(u, v, 5, 24, seed);
  const double grain = smooth_noise(u, std::fmod(v + bend, 1.0), 4, 160, seed + 20);
  const double pores = smooth_noise(u, v, 48, 256, seed + 40);
  double light = 0.80 + 0.12 * unit_noise(plank, along < kSize / 2 ? 1 : 2, 4) +
                 0.14 * (grain - 0.5) + 0.07 * (pores - 0.5);
  const bool seam = in_plank < 1 || in_plank >= kWidth - 1;
  const int half = along % (kSize / 2);
  const bool end = half < 1 || half >= kSize / 2 - 1;
  if (seam || end) light *= 0.55;
  return {light, light * (0.97 + 0.03 * grain), light * (0.93 + 0.05 * grain)};
}

Tone carpet(int x, int y) {
  const double u = x / double{kSize}, v = y / double{kSize};
  const double loops = smooth_noise(u, v, 128, 128, 5), fibres = unit_noise(x, y, 6);
  const double wear = smooth_noise(u, v, 6, 6, 7);
  return grey(0.72 + 0.30 * (loops - 0.5) + 0.16 * (fibres - 0.5) + 0.06 * (wear - 0.5));
}

// Next mip level: averages light, i.e. squared codes (lighting.h).
std::vector<std::uint8_t> half_size(const std::vector<std::uint8_t>& fine, int fine_size) {
  const int size = fine_size / 2;
  std::vector<std::uint8_t> coarse(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) *
                                   4);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      for (int c = 0; c < 4; ++c) {
        double light = 0;
        for (int k = 0; k < 4; ++k) {
          const int at = ((2 * y + k / 2) * fine_size + 2 * x + k % 2) * 4 + c;
          const double code = fine[static_cast<std::size_t>(at)];
          light += 0.25 * code * code;
        }
        coarse[static_cast<std::size_t>((y * size + x) * 4 + c)] =
            static_cast<std::uint8_t>(std::sqrt(light) + 0.5);
      }
    }
  }
  return coarse;
}

}  // namespace

Result<Texture> make_texture(const std::string& name) {
  Texture texture;
  texture.size = kSize;
  Tone (*tone)(int, int) = nullptr;
  if (name == "checker") {
    tone = checker;
    texture.repeat_m = 0.2;
  } else if (name == "wood") {
    tone = wood;
    texture.repeat_m = 0.64;
  } else if (name == "carpet") {
    tone = carpet;
    texture.repeat_m = 0.4;
  } else {
    return fail(Fault::usage, "texture `" + name + "` does not exist: use checker, wood or carpet");
  }
  std::vector<std::uint8_t> level(std::size_t{kSize} * kSize * 4);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const Tone t = tone(x, y);
      std::uint8_t* texel = &level[static_cast<std::size_t>(y * kSize + x) * 4];
      for (std::size_t c = 0; c < 3; ++c) {
        texel[c] = static_cast<std::uint8_t>(std::clamp(t[c], 0.0, 1.0) * 255 + 0.5);
      }
      texel[3] = 255;
    }
  }
  texture.levels.push_back(std::move(level));
  for (int size = kSize; size > 1; size /= 2) {
    texture.levels.push_back(half_size(texture.levels.back(), size));
  }
  return texture;
}

}  // namespace kaz::sim

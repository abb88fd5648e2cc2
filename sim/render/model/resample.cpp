// Averages n x n samples in linear light and drops alpha.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/model/resample.h"

#include <cmath>
#include <cstring>

namespace kaz::sim {

void pack_rgb(std::span<const std::uint8_t> rgba, int width, int height, int n,
              std::vector<std::uint8_t>& rgb) {
  const auto samples = static_cast<std::size_t>(n);
  const std::size_t row = static_cast<std::size_t>(width);
  const std::size_t columns = row / samples, rows = static_cast<std::size_t>(height) / samples;
  rgb.resize(columns * rows * 3);
  if (n == 1) {
    const std::uint8_t* from = rgba.data();
    std::uint8_t* to = rgb.data();
    // Copies four bytes at a time; the next pixel overwrites the fourth.
    for (std::size_t i = 1; i < columns * rows; ++i, from += 4, to += 3) std::memcpy(to, from, 4);
    std::memcpy(to, from, 3);
    return;
  }
  for (std::size_t y = 0; y < rows; ++y)
    average_row(rgba.data() + y * samples * row * 4, width, n, rgb.data() + y * columns * 3);
}

void average_row(const std::uint8_t* rgba, int width, int n, std::uint8_t* rgb) {
  const auto samples = static_cast<std::size_t>(n), row = static_cast<std::size_t>(width);
  const float scale = 1.0F / static_cast<float>(samples * samples);
  for (std::size_t x = 0; x < row / samples; ++x) {
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint32_t light = 0;
      for (std::size_t dy = 0; dy < samples; ++dy) {
        for (std::size_t dx = 0; dx < samples; ++dx) {
          const std::uint32_t code = rgba[(dy * row + x * samples + dx) * 4 + c];
          light += code * code;
        }
      }
      rgb[x * 3 + c] =
          static_cast<std::uint8_t>(std::sqrt(static_cast<float>(light) * scale) + 0.5F);
    }
  }
}

}  // namespace kaz::sim
